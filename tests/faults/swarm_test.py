"""Two hundred unrelated clients at once, some of them rude."""

import os
import time
import unittest

import stage
from stage import MIB, SANITIZED, SECONDS, Faults, Swarm, Watch, percentile, select, tally

CLIENTS = 200
BUDGET = 1024 * MIB  # of the server without its decoders
DECODERS, DECODER_MEMORY = 2, 256 * MIB  # of each
ALL = BUDGET + DECODERS * DECODER_MEMORY
OPTIONS = ["--memory-budget", BUDGET, "--decoder-processes", DECODERS, "--decoder-memory", DECODER_MEMORY]
# Twenty roles: 5 % cancel, 5 % vanish, 5 % are hostile.
ROLES = ["cancel", "vanish", "hostile", "bare", "bare"] + 15 * ["good"]


class TwoHundredClients(Faults):
    scenario = "swarm"

    def test_two_hundred_clients_on_two_cores_get_their_results(self):
        with stage.server(self.dir, *map(str, OPTIONS)) as server:
            threads, descriptors = server.threads(), server.descriptors()
            before = server.cpu()
            with Watch(server) as watch, Swarm(
                self.dir, server.address, SECONDS, clients=CLIENTS, roles=ROLES
            ) as swarm:
                records = swarm.wait(SECONDS + 200)
            self.nothing_wrong(records)
            self.assert_everyone_is_served(records)
            self.tell_of(records)
            self.figure(
                "processor time, server : clients", f"{server.cpu() - before:.0f} : {self.clients_cpu(swarm):.0f}", "s"
            )
            for what, peak, most in (
                ("the server", watch.peak, BUDGET),
                ("one decoder", watch.peak_decoder, DECODER_MEMORY),
                ("all together", watch.peak_all, ALL),
            ):
                kept = None if SANITIZED else peak <= most
                self.figure(f"peak memory of {what}", peak / MIB, "MiB", f"<= {most // MIB}", kept)
            self.figure("looks at the memory", watch.samples, "", "some", watch.samples > 10)
            self.figure("most threads of the server", watch.most_threads, "", f"at rest {threads}")
            self.assert_serves(server)
            self.assert_rests(server, descriptors)

    def assert_everyone_is_served(self, records):
        """A refused client tries again until it is served, or the load ends. An accepted call is served at once."""
        tries = select(records, role=("good", "bare"))
        accepted = select(tries, accepted=True)
        self.figure(
            "jobs accepted of good and bare clients",
            tally(r["outcome"] for r in accepted),
            "",
            "done, all of them",
            bool(accepted) and len(select(accepted, "done")) == len(accepted),
        )
        last = {(r["client"], r["life"], r["call"]): r for r in tries}
        self.figure(
            f"calls of good and bare clients, in {len(tries)} tries",
            tally(r["outcome"] for r in last.values()),
            "",
            "done, or cut by the end of the load",
            len(select(last.values(), ("done", "cut"))) == len(last),
        )

    def tell_of(self, records):
        for role in sorted(set(ROLES)):
            self.figure(
                f"{ROLES.count(role) * CLIENTS // len(ROLES)} {role} clients",
                tally(r["outcome"] for r in select(records, role=role)),
            )
        for size in ("small", "medium", "large"):
            done = [r for r in select(records, "done", role=("good", "bare")) if r["job"].startswith(size)]
            self.figure(f"{size}: requests done", len(done), "", "some", bool(done))
            if done:
                for what, key in (("the accepted call", "ms"), ("with refusals and waits", "wait_ms")):
                    times = [r[key] for r in done]
                    self.figure(
                        f"{size}: {what}, p50 / p99", f"{percentile(times, 50):.0f} / {percentile(times, 99):.0f}", "ms"
                    )
        for role in ("cancel", "vanish", "hostile"):
            self.figure(
                f"{role}: did what they are for",
                len(select(records, ("stopped", "vanished", "rejected"), role=role)),
                "",
                "some",
                bool(select(records, ("stopped", "vanished", "rejected"), role=role)),
            )

    def clients_cpu(self, swarm):
        now = os.times()
        return now.children_user + now.children_system - swarm.before.children_user - swarm.before.children_system

    def assert_rests(self, server, descriptors):
        """No connection and no thread's work is left behind."""
        time.sleep(1)
        idle = server.cpu()
        time.sleep(1)
        self.figure("processor time in a second of rest", server.cpu() - idle, "s", "< 0.1", server.cpu() - idle < 0.1)
        left = server.descriptors() - descriptors
        self.figure("descriptors left open", left, "", "<= 8", left <= 8)


if __name__ == "__main__":
    unittest.main()
