"""SIGTERM under load: no client is let down, and the server ends."""

import signal
import time
import unittest

from haproxy import haproxy
from stage import FULL, Faults, Server, Swarm, harness, latvox, tally

GRACE = 2
AT_ONCE = 1  # seconds until a health check, a process of its own beside the load, says "not serving"
CLIENTS = 16
ROUNDS = 10 if FULL else 2
JOBS = ["small bunny-64-bcc", "medium bunny-256-fcc", "large bunny-1024-bcc"]
HUGE = "huge bunny-8192-cartesian"


class Drain(Faults):
    scenario = "sigterm"

    def start(self, name="latvoxd"):
        running = Server(self.dir, "--grace", str(GRACE), name=name)
        self.addCleanup(running.kill)
        harness.wait_until_healthy(running.process)
        return running

    def not_serving_after(self, server):
        """Returns the seconds from a SIGTERM until a health check says so. The process may have ended by then."""
        server.process.send_signal(signal.SIGTERM)
        start = time.monotonic()
        while latvox("health", "--server", server.address).returncode == 0:
            self.assertLess(time.monotonic(), start + 10)
        return time.monotonic() - start

    def test_jobs_finish_or_go_on_elsewhere(self):
        servers = [self.start("latvoxd0"), self.start("latvoxd1")]
        seconds = ROUNDS * 2
        waits, ends, codes = [], [], []
        with haproxy(self.dir, servers) as address:
            with Swarm(self.dir, address, seconds, clients=CLIENTS, roles=["good"], jobs=JOBS) as swarm:
                for n in range(ROUNDS):
                    time.sleep(1)
                    server = servers[n % 2]
                    start = time.monotonic()
                    waits.append(self.not_serving_after(server))
                    codes.append(server.process.wait(GRACE + 20))
                    ends.append(time.monotonic() - start)
                    server.start()
                    harness.wait_until_healthy(server.process)
                records = swarm.wait(200)
        self.nothing_wrong(records)
        self.bounded(
            "SIGTERM under load: health says so after at most", max(waits), "s", promised=AT_ONCE, fails_over=5
        )
        self.figure(
            "SIGTERM under load: ended after at most", max(ends), "s", f"<= {GRACE} + 6", max(ends) <= GRACE + 6
        )
        self.figure("SIGTERM under load: exit statuses", tally(codes), "", "0", set(codes) == {0})
        self.all_done(records, "SIGTERM under load: ")

    def test_a_job_that_does_not_end_is_ended(self):
        server = self.start()
        with Swarm(self.dir, server.address, 20, clients=4, roles=["stopped"], jobs=[HUGE]) as swarm:
            time.sleep(1.5)
            start = time.monotonic()
            server.process.send_signal(signal.SIGTERM)
            code = server.process.wait(GRACE + 20)
            took = time.monotonic() - start
            del swarm
        self.figure("SIGTERM with readers that stand still: exit status", code, "", "0", code == 0)
        self.figure(
            "SIGTERM with readers that stand still: ended after", took, "s", f"<= {GRACE} + 6", took <= GRACE + 6
        )

    def test_a_second_signal_ends_at_once(self):
        server = self.start()
        with Swarm(self.dir, server.address, 20, clients=4, roles=["stopped"], jobs=[HUGE]):
            time.sleep(1.5)
            server.process.send_signal(signal.SIGTERM)
            time.sleep(0.3)
            self.assertIsNone(server.process.poll(), "ended before the second signal")
            start = time.monotonic()
            server.process.send_signal(signal.SIGTERM)
            server.process.wait(GRACE + 20)
            took = time.monotonic() - start
        self.figure("second SIGTERM: ended after", took, "s", "<= 0.5", took <= 0.5)


if __name__ == "__main__":
    unittest.main()
