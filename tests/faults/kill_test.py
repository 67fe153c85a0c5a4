"""kill -9 of servers and of their decoders under load: every digest is right in the end."""

import os
import random
import signal
import threading
import unittest

import stage
from haproxy import haproxy
from stage import SECONDS, SEED, Faults, Server, Swarm, harness, percentile, select

CLIENTS = 24
JOBS = [
    "small bunny-64-bcc",
    "medium bunny-256-fcc",
    "medium bunny-512-cartesian",
    "large bunny-x4-512-cartesian",
    "large bunny-1024-bcc",
]
LOAD = max(4.0, SECONDS / 3)  # of each of the three ways
EVERY = 4.0 if stage.FULL else 1.2  # seconds from kill to kill


class Killer:
    """Kills one victim after the other. Restarts a server at once, as a supervisor would."""

    def __init__(self, kill):
        self.kills, self._kill, self._over = 0, kill, threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self):
        chance = random.Random(SEED)
        while not self._over.wait(EVERY * chance.uniform(0.7, 1.3)):
            self.kills += self._kill(self.kills)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()


class Kill(Faults):
    scenario = "kill"

    def servers(self, count):
        running = []
        for n in range(count):
            running.append(Server(self.dir, "--decode-always", name=f"latvoxd{n}"))
            self.addCleanup(running[-1].kill)
            harness.wait_until_healthy(running[-1].process)
        return running

    def load(self, what, address, kill):
        """Runs clients at `address` while `kill` does its work."""
        name = what.replace(" ", "-")
        with Swarm(self.dir, address, LOAD, clients=CLIENTS, roles=["good"], jobs=JOBS, name=name) as swarm:
            with Killer(kill) as killer:
                swarm.process.wait(LOAD + 200)
            records = swarm.wait(10)
        self.nothing_wrong(records, f"{what}: ")
        done = select(records, "done")
        self.figure(f"{what}: kills", killer.kills, "", "some", killer.kills > 0)
        self.all_done(records, f"{what}: ")
        if "server" in what:
            resumed = sum(r["resumed"] for r in done)
            self.figure(f"{what}: streams that went on after a break", resumed, "", "some", resumed > 0)
        times = [r["wait_ms"] for r in done]
        self.figure(f"{what}: p50 / p99", f"{percentile(times, 50):.0f} / {percentile(times, 99):.0f}", "ms")

    def test_killed_servers_behind_a_proxy(self):
        servers = self.servers(2)
        with haproxy(self.dir, servers) as address:
            self.load("servers behind haproxy", address, lambda n: self.kill_and_restart(servers[n % 2]))

    def test_killed_servers_at_two_addresses(self):
        servers = self.servers(2)
        self.load(
            "servers at two addresses",
            ",".join(s.address for s in servers),
            lambda n: self.kill_and_restart(servers[n % 2]),
        )

    def kill_and_restart(self, server):
        server.kill()
        server.start()
        return 1

    def test_killed_decoders(self):
        with stage.server(self.dir, "--decode-always") as server:
            self.load("decoders", server.address, lambda n: self.kill_decoder(server))
            self.assert_serves(server)

    def kill_decoder(self, server):
        workers = server.workers()
        for pid in workers[:1]:
            os.kill(pid, signal.SIGKILL)
        return len(workers[:1])


if __name__ == "__main__":
    unittest.main()
