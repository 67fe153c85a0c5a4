"""A tenant whose meshes are as costly as they can be starves nobody, and costs what the server expects."""

import contextlib
import datetime
import subprocess
import threading
import time
import unittest

import stage
from stage import BIN, MIB, SECONDS, Faults, Swarm, Watch, percentile, select
from tenants import burdens, write

SMALL = "small bunny-64-bcc"
LOAD = max(2.0, SECONDS / 20)
PROMISED = 3  # times the idle p99
ESTIMATED = 2  # times the estimate
FLOOR_MS = 50  # the time of a small job, which no estimate needs to know
FLOOR_BYTES = 16 * MIB  # that gRPC and the heap keep
CANCEL_MS = 50
GROSS, GROSS_MS = 30, 1000


def ended(line):
    """Returns when the server wrote a line of its log."""
    return datetime.datetime.fromisoformat(line["time"].replace("Z", "+00:00")).timestamp()


class Tenants(Faults):
    """The tenant comes through a Unix socket, and the others over TCP. So they are different clients."""

    scenario = "tenants"

    def command(self, mesh, options):
        fixed = ["--server", f"unix:{self.socket}", "--upload", "raw", "--json", "--retries", 0]
        return [BIN / "latvox", "voxelize", mesh, *map(str, [*options, *fixed])]

    def jobs(self, server, count=0):
        """Returns the log's lines of the tenant's jobs, once there are so many."""
        deadline = time.monotonic() + 30
        while True:
            lines = [line for line in server.lines("request") if line["peer"].startswith("unix") and "cpu_ms" in line]
            if len(lines) >= count or time.monotonic() > deadline:
                return lines
            time.sleep(0.01)

    def small_times(self, server, name):
        with Swarm(self.dir, server.address, LOAD, clients=1, roles=["good"], jobs=[SMALL], name=name) as swarm:
            records = swarm.wait(LOAD + 130)
        self.nothing_wrong(records, f"{name}: ")
        return [r["ms"] for r in select(records, "done")]

    @contextlib.contextmanager
    def repeated(self, command):
        """Runs a command again and again. Kills the last one in the end."""
        over, running = threading.Event(), []

        def run():
            while not over.is_set():
                with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
                    running[:] = [process]
                    process.wait()

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield
        finally:
            over.set()
            while thread.is_alive():
                for process in running:
                    process.kill()
                thread.join(0.1)

    def costs(self, server, what, command):
        """Runs one job, and compares its costs with the server's estimates."""
        before, rest = len(self.jobs(server)), stage.memory([server.pid])
        with Watch(server) as watch:
            done = subprocess.run(command, capture_output=True, text=True)
            time.sleep(0.2)
        self.figure(f"{what}: exit status", done.returncode, done.stderr[:100], "0", done.returncode == 0)
        job = self.jobs(server, before + 1)[-1]
        estimated, took = float(job["estimated_ms"]), float(job["cpu_ms"])
        self.bounded(
            f"{what}: CPU time {took:.0f} ms over the estimate of {estimated:.0f} ms",
            took / max(estimated, FLOOR_MS),
            "times",
            promised=ESTIMATED,
            fails_over=GROSS,
        )
        reserved, grown = int(job["reserved_bytes"]), max(0, watch.peak - rest)
        self.bounded(
            f"{what}: memory {grown / MIB:.0f} MiB over the reserved {reserved / MIB:.0f} MiB",
            grown / (reserved + FLOOR_BYTES),
            "times",
            promised=ESTIMATED,
            fails_over=10,
        )

    def beside(self, server, what, command, idle):
        with self.repeated(command):
            time.sleep(0.5)
            times = self.small_times(server, f"small requests beside {what}")
        self.figure(
            f"small requests beside {what}: p50 / p99, idle p99",
            f"{percentile(times, 50):.0f} / {percentile(times, 99):.0f}, {percentile(idle, 99):.0f}",
            "ms",
            "some",
            len(times) > 3,
        )
        ratio = percentile(times, 99) / percentile(idle, 99)
        self.bounded(f"small requests beside {what}: p99 over the idle p99", ratio, "times", promised=PROMISED, fails_over=GROSS)

    def cancel(self, server, what, command, seconds):
        """Kills the client in the middle of its job. The log's line comes when all work has ended."""
        before = len(self.jobs(server))
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            time.sleep(seconds)
            process.kill()
            killed = time.time()
        lines = self.jobs(server, before + 1)[before:]
        took = max(0, ended(lines[-1]) - killed) * 1000 if lines else float("inf")
        self.figure(f"{what}, its client gone: the job ended with", lines[-1]["code"] if lines else "nothing")
        self.bounded(f"{what}, its client gone: work went on for", took, "ms", promised=CANCEL_MS, fails_over=GROSS_MS)

    def test_costly_meshes(self):
        self.socket = self.dir / "tenant.socket"
        with stage.server(self.dir, "--listen", f"unix:{self.socket}") as server:
            idle = self.small_times(server, "small requests, idle")
            for what, burden in burdens().items():
                mesh = self.dir / "burden.ply"
                write(mesh, burden.triangles)
                command = self.command(mesh, burden.options)
                began = time.monotonic()
                self.costs(server, what, command)
                whole = time.monotonic() - began
                self.beside(server, what, command, idle)
                self.cancel(server, what, command, whole / 2)
            self.assert_serves(server)


if __name__ == "__main__":
    unittest.main()
