"""A huge job does not starve small ones, and small ones do not starve it."""

import time
import unittest

import stage
from stage import SECONDS, Faults, Swarm, percentile, select

SMALL = "small bunny-64-bcc"
HUGE = "huge bunny-8192-cartesian"
LOAD = max(2.0, SECONDS / 6)
PROMISED = 3
GROSS = 30
BULK = "latvoxd-bulk"


class Fairness(Faults):
    scenario = "fairness"

    def small_times(self, server, name):
        with Swarm(self.dir, server.address, LOAD, clients=1, roles=["good"], jobs=[SMALL], name=name) as swarm:
            records = swarm.wait(LOAD + 130)
        self.nothing_wrong(records, f"small requests, {name}: ")
        return [r["ms"] for r in select(records, "done")]

    def beside(self, server, what, job, idle):
        """Makes small requests while `job` runs repeatedly."""
        with Swarm(self.dir, server.address, LOAD + 0.5, clients=1, roles=["good"], jobs=[job], name=what) as swarm:
            time.sleep(0.5)
            times = self.small_times(server, f"beside {what}")
            records = swarm.wait(LOAD + 200)
        self.nothing_wrong(records, f"{what}: ")
        ratio = percentile(times, 99) / percentile(idle, 99)
        self.figure(
            f"small requests beside {what}: p50 / p99",
            f"{percentile(times, 50):.0f} / {percentile(times, 99):.0f}",
            "ms",
            "some",
            len(times) > 3,
        )
        self.bounded(
            f"small requests beside {what}: p99 over the idle p99", ratio, "times", promised=PROMISED, fails_over=GROSS
        )
        done = [r["ms"] for r in select(records, "done")]
        self.figure(f"{what}: done meanwhile", len(done), "", "it goes on", bool(done))
        if done:
            self.figure(f"{what}: p50", percentile(done, 50), "ms")

    def test_small_requests_beside_huge_ones(self):
        with stage.server(self.dir) as server:
            idle = self.small_times(server, "idle")
            self.figure(
                "small requests, idle: p50 / p99", f"{percentile(idle, 50):.0f} / {percentile(idle, 99):.0f}", "ms"
            )
            self.beside(server, "many voxels", HUGE, idle)
            self.beside(server, "many triangles", "huge bunny-x16-512-cartesian", idle)
            # gRPC's threads must not have it either; they inherit it from the threads that start them.
            nicer = {name for name, nice in server.niceness() if nice != 0}
            self.figure("threads of lower priority", ", ".join(nicer), "", BULK, nicer == {BULK})


if __name__ == "__main__":
    unittest.main()
