"""Half-open connections: packets are dropped in a private network, so only one end knows that the connection is
dead."""

import contextlib
import ctypes
import os
import shutil
import subprocess
import sys
import time
import unittest
import urllib.request

import stage
from stage import Faults, Server, Swarm, harness, select

CLONE_NEWNET = 0x40000000
SKIP = 77  # ctest's code for it
KEEPALIVE = ["--keepalive-time", "1", "--keepalive-timeout", "1"]
SERVER_SECONDS = 6  # for the server to notice: 1 s + 1 s, and the machine's delay
CLIENT_SECONDS = 30  # for the SDK to notice, and to go on elsewhere
JOB = "huge bunny-8192-cartesian"
# A call must still run when its packets are dropped, however fast the machine is. It has a hundred batches and more,
# and pauses at each.
PAUSE = ["--pause-ms", 50]


def own_network():
    """A private loopback device, which ends with this process."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(CLONE_NEWNET) != 0:
        return os.strerror(ctypes.get_errno())
    for command in (["ip", "link", "set", "lo", "up"], ["iptables", "-w", "-L"]):
        if subprocess.run(command, stdout=subprocess.DEVNULL).returncode != 0:
            return f"{command[0]} does not work in a network namespace"
    return None


def iptables(*words):
    subprocess.run(["iptables", "-w", *map(str, words)], check=True)


class HalfOpen(Faults):
    scenario = "half_open"

    def drop(self, server, *ways):
        """From now on, drops packets "to" the server, or "from" it."""
        port = server.address.rpartition(":")[2]
        for way in ways:
            rule = ["INPUT", "-p", "tcp", "--dport" if way == "to" else "--sport", port, "-j", "DROP"]
            iptables("-A", *rule)
            self.addCleanup(iptables, "-D", *rule)

    def server(self, name="latvoxd"):
        metrics = f"127.0.0.1:{stage.free_port()}"
        running = Server(self.dir, *KEEPALIVE, "--metrics-listen", metrics, name=name)
        running.metrics = f"http://{metrics}/metrics"
        self.addCleanup(running.kill)
        harness.wait_until_healthy(running.process)
        return running

    def jobs(self, server):
        """Returns the number of jobs at work, or paused for their clients."""
        with urllib.request.urlopen(server.metrics) as answer:
            lines = answer.read().decode().splitlines()
        wanted = ("latvox_jobs_running ", "latvox_jobs_paused ")
        return sum(int(float(line.split()[1])) for line in lines if line.startswith(wanted))

    def wait_for_jobs(self, servers, count):
        """Waits until all jobs are there, and the first server has one of them."""
        end = time.monotonic() + harness.PATIENCE
        while (jobs := [self.jobs(server) for server in servers])[0] == 0 or sum(jobs) < count:
            self.assertLess(time.monotonic(), end, jobs)
            time.sleep(0.02)

    def test_the_server_ends_calls_of_lost_clients(self):
        cut = {way: self.server(f"latvoxd-{'-'.join(way)}") for way in (("to",), ("from",), ("to", "from"))}
        with contextlib.ExitStack() as swarms:
            for way, server in cut.items():
                name = "-".join(way)
                clients = Swarm(self.dir, server.address, 60, clients=2, roles=["slow"], jobs=[JOB], name=name)
                swarms.enter_context(clients)
            time.sleep(2)
            for way, server in cut.items():
                self.assertEqual(server.lines("request"), [])
                self.drop(server, *way)
            took = self.times_until_idle(cut, 2)
        for way, seconds in took.items():
            what = f"packets {' and '.join(way)} the server dropped: both calls ended by the server after"
            self.figure(what, seconds, "s", f"<= {SERVER_SECONDS}", seconds <= SERVER_SECONDS)
        used = sum(server.cpu() for server in cut.values())
        time.sleep(1)
        used = sum(server.cpu() for server in cut.values()) - used
        self.figure("their processor time in a second after", used, "s", "< 0.2", used < 0.2)

    def times_until_idle(self, servers, calls):
        """Returns the seconds until each server's log has this many calls."""
        start, took = time.monotonic(), {}
        while len(took) < len(servers) and time.monotonic() < start + 20:
            time.sleep(0.05)
            for key, server in servers.items():
                if key not in took and len(server.lines("request")) >= calls:
                    took[key] = time.monotonic() - start
        return {key: took.get(key, float("inf")) for key in servers}

    def test_the_client_goes_on_at_another_server(self):
        """The client's connected server is cut off in the middle; the other one has the rest."""
        servers = [self.server("latvoxd0"), self.server("latvoxd1")]
        addresses = ",".join(s.address for s in servers)
        with Swarm(
            self.dir,
            addresses,
            0.5,
            "--keepalive",
            2,
            *PAUSE,
            clients=4,
            roles=["good"],
            jobs=[JOB],
            name="elsewhere",
        ) as swarm:
            self.wait_for_jobs(servers, 4)
            self.drop(servers[0], "to", "from")
            start = time.monotonic()
            records = swarm.wait(150)
        self.nothing_wrong(records)
        took = time.monotonic() - start
        self.all_done(records, "cut off from one of two servers: ")
        resumed = sum(r["resumed"] for r in select(records, "done"))
        self.figure("cut off from one of two servers: streams that went on at the other", resumed, "", "some", resumed > 0)
        self.figure(
            "cut off from one of two servers: all done after", took, "s", f"<= {CLIENT_SECONDS}", took <= CLIENT_SECONDS
        )

    def test_the_client_says_so_if_there_is_no_other(self):
        server = self.server()
        options = ["--keepalive", 2, "--retries", 1, *PAUSE]
        with Swarm(
            self.dir, server.address, 0.5, *options, clients=2, roles=["good"], jobs=[JOB], name="alone"
        ) as swarm:
            self.wait_for_jobs([server], 2)
            self.drop(server, "to", "from")
            start = time.monotonic()
            records = swarm.wait(150)
        took = time.monotonic() - start
        said = sorted({r["detail"][:100] for r in records})
        self.figure(
            "cut off from the only server: it says",
            "; ".join(said),
            "",
            "UNAVAILABLE",
            bool(said) and all(s.startswith("UNAVAILABLE") for s in said),
        )
        self.figure("cut off from the only server: after", took, "s", f"<= {CLIENT_SECONDS}", took <= CLIENT_SECONDS)


if __name__ == "__main__":
    missing = [program for program in ("ip", "iptables") if shutil.which(program) is None]
    why = f"{', '.join(missing)} not installed" if missing else own_network()
    if why:
        print(
            f"SKIPPED: no network of its own: {why}; root's CAP_NET_ADMIN and CAP_SYS_ADMIN are needed", file=sys.stderr
        )
        sys.exit(SKIP)
    unittest.main()
