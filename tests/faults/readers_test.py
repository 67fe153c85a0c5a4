"""Clients that read slowly, or not at all, cost bounded memory, no thread, and no time of others."""

import os
import signal
import time
import unittest

import stage
from stage import MIB, SECONDS, Faults, Swarm, Watch, descendants, percentile, select, tally

READERS = 12
THREADS = 8  # that gRPC and oneTBB may start under load, however many readers there are
# Messages in the server's queue and in gRPC and the kernel, and the job itself.
BYTES_A_READER = 32 * MIB
BIG = "huge bunny-8192-cartesian"  # hundreds of megabytes: more than the buffers hold
LOAD = max(3.5, SECONDS / 4)
GROSS = 30
KEEPALIVE = ["--keepalive-time", "1", "--keepalive-timeout", "1"]


class Readers(Faults):
    scenario = "readers"

    def small_times(self, server, seconds, name):
        with Swarm(
            self.dir, server.address, seconds, clients=1, roles=["good"], jobs=["small bunny-64-bcc"], name=name
        ) as swarm:
            records = swarm.wait(seconds + 130)
        self.nothing_wrong(records, f"small requests, {name}: ")
        return [r["ms"] for r in select(records, "done")]

    def under(self, server, what, roles, jobs, count=READERS):
        """Makes small requests while readers of these roles hang on big ones. Compares times alone with times beside
        these readers."""
        alone = self.small_times(server, 1, f"{what}, before")
        rest, threads = stage.memory(descendants(server.pid)), server.threads()
        with Swarm(self.dir, server.address, LOAD, clients=count, roles=roles, jobs=jobs, name=what) as swarm, Watch(
            server
        ) as watch:
            time.sleep(1)
            cpu = server.cpu()
            times = self.small_times(server, LOAD - 1.5, f"{what}, beside")
            self.figure(f"{what}: processor time of the server, others served", server.cpu() - cpu, "s")
            records = swarm.wait(LOAD + 130)
        self.nothing_wrong(records, f"{what}: ")
        self.figure(f"{what}: their calls", tally(r["outcome"] for r in records))
        grown = (watch.peak - rest) / count
        self.figure(
            f"{what}: memory for each", grown / MIB, "MiB", f"<= {BYTES_A_READER // MIB}", grown <= BYTES_A_READER
        )
        self.figure(
            f"{what}: more threads",
            watch.most_threads - threads,
            "",
            f"<= {THREADS}, however many readers",
            watch.most_threads - threads <= THREADS,
        )
        self.figure(
            f"{what}: others' p50 / p99, alone", f"{percentile(alone, 50):.0f} / {percentile(alone, 99):.0f}", "ms"
        )
        self.figure(
            f"{what}: others' p50 / p99, beside them",
            f"{percentile(times, 50):.0f} / {percentile(times, 99):.0f}",
            "ms",
            "some served",
            len(times) > 3,
        )
        return alone, times

    def test_slow_and_stopped_readers(self):
        with stage.server(self.dir) as server:
            self.under(server, "slow and stopped readers", ["slow", "stopped"], [BIG])
            self.assert_serves(server)

    def test_slow_readers_do_not_keep_their_turns(self):
        """Twice as many readers as turns, but no more than the cores can serve."""
        with stage.server(self.dir, "--max-jobs", "2") as server:
            alone, beside = self.under(server, "slow readers on all turns", ["slow"], [BIG], count=4)
            ratio = percentile(beside, 50) / percentile(alone, 50)
            self.bounded("slow readers on all turns: others' p50 over that alone", ratio, "times", fails_over=GROSS)
            self.assert_serves(server)

    def test_stopped_processes_are_ended_by_keepalive(self):
        """Their kernel goes on accepting bytes, and nobody answers a ping."""
        with stage.server(self.dir, *KEEPALIVE) as server:
            with Swarm(self.dir, server.address, 60, clients=READERS, roles=["slow"], jobs=[BIG]) as swarm:
                time.sleep(2)
                clients = descendants(swarm.process.pid)[1:]
                self.assertEqual(len(clients), READERS)
                before = len(server.lines("request"))
                for pid in clients:
                    os.kill(pid, signal.SIGSTOP)
                stopped = time.monotonic()
                while len(server.lines("request")) < before + READERS and time.monotonic() < stopped + 20:
                    time.sleep(0.05)
                took = time.monotonic() - stopped
                ended = server.lines("request")[before:]
                self.figure("stopped processes: their calls ended", len(ended), "", f"{READERS}", len(ended) == READERS)
                self.figure("stopped processes: after (keepalive 1 s + 1 s)", took, "s", "<= 5", took <= 5)
            self.assert_serves(server)


if __name__ == "__main__":
    unittest.main()
