"""Anonymous connections that attack gRPC's HTTP/2 do not stop the server for others."""

import contextlib
import json
import pathlib
import socket
import subprocess
import sys
import time
import unittest

import attacker
import stage
from haproxy import haproxy
from http2 import PREFACE
from stage import MIB, SECONDS, Faults, Swarm, Watch, percentile, select

SMALL = "small bunny-64-bcc"
LOAD = max(1.5, SECONDS / 40)
PROMISED = 3
GROSS = 30
FLOOD = 150  # times, for attacks that are limited, not stopped: a host may cause an eighth of the machine's work
MOST_BYTES = 200 * MIB  # that an attack may add to the server's memory
HEADER_BLOCK = "header block"
GREETED_WITHIN = 1.0  # seconds; a server that is stopped greets nobody within 10 s


@contextlib.contextmanager
def attack(what, address, seconds, kind="plain"):
    """Attacks from another address. Yields a function that waits for the end and returns what was sent."""
    host, _, port = address.rpartition(":")
    program = pathlib.Path(attacker.__file__)
    process = subprocess.Popen(
        [sys.executable, program, what, host, port, str(seconds), kind], stdout=subprocess.PIPE, text=True
    )
    try:
        yield lambda: json.loads(process.communicate(timeout=seconds + 60)[0])
    finally:
        process.kill()
        process.wait()


def greeting(address, tls=False):
    """Returns the seconds until a new connection has the server's first bytes; infinite if none come."""
    host, _, port = address.rpartition(":")
    began = time.monotonic()
    try:
        with socket.create_connection((host, int(port)), 10) as plain:
            with attacker.tls(plain) if tls else plain as connection:
                connection.settimeout(10)
                connection.sendall(PREFACE)
                return time.monotonic() - began if connection.recv(9) else float("inf")
    except OSError:
        return float("inf")


class Attacks(Faults):
    scenario = "attacks"

    def small_times(self, address, name):
        with Swarm(self.dir, address, LOAD, clients=1, roles=["good"], jobs=[SMALL], name=name) as swarm:
            records = swarm.wait(LOAD + 130)
        self.nothing_wrong(records, f"{name}: ")
        return [r["ms"] for r in select(records, "done")]

    def greetings(self, address, tls=False):
        end, times = time.monotonic() + LOAD, []
        while time.monotonic() < end:
            times.append(greeting(address, tls) * 1000)
            time.sleep(0.02)
        return times

    def compare(self, name, what, idle, beside):
        self.figure(
            f"{name}: {what}, p50 / p99, idle p99",
            f"{percentile(beside, 50):.1f} / {percentile(beside, 99):.1f}, {percentile(idle, 99):.1f}",
            "ms",
            "some",
            len(beside) > 3,
        )
        ratio = percentile(beside, 99) / percentile(idle, 99)
        gross = GROSS if "header block" in name else FLOOD
        self.bounded(f"{name}: {what}, p99 over the idle p99", ratio, "times", promised=PROMISED, fails_over=gross)

    def assert_greets(self, name, address, tls=False):
        took = greeting(address, tls)
        self.figure(
            f"{name}: a new connection is greeted after", took * 1000, "ms", "<= 1000", took <= GREETED_WITHIN
        )

    def under(self, server, address, what, idle):
        """Makes small requests while others attack."""
        rest = stage.memory([server.pid])
        with attack(what, address, LOAD + 0.5) as ended, Watch(server) as watch:
            time.sleep(0.5)
            beside = self.small_times(address, f"beside {what}")
            self.assert_greets(what, address)
            sent = ended()
        self.compare(what, "small requests", idle, beside)
        self.figure(f"{what}: connections, bytes of the attack", f"{sent['connections']}, {sent['bytes']}")
        grown = (watch.peak - rest) / MIB
        self.figure(f"{what}: memory of the server, more", grown, "MiB", "<= 200", grown * MIB <= MOST_BYTES)

    def test_directly(self):
        with stage.server(self.dir) as server:
            idle = self.small_times(server.address, "idle")
            for what in attacker.ATTACKS:
                self.under(server, server.address, what, idle)
            closed = server.lines("connection_closed")
            self.figure("lines of the log about closed connections", len(closed), "", "some", bool(closed))
            self.assert_serves(server)

    def test_through_a_proxy(self):
        with stage.server(self.dir, "--behind-proxy") as server, haproxy(self.dir, [server]) as address:
            idle = self.small_times(address, "idle, through haproxy")
            for what in (HEADER_BLOCK, "rapid resets"):
                with attack(what, address, LOAD + 0.5) as ended:
                    time.sleep(0.5)
                    beside = self.small_times(address, f"beside {what}, through haproxy")
                    ended()
                self.compare(f"{what}, through haproxy", "small requests", idle, beside)
            self.assert_serves(server)

    def test_with_tls(self):
        key, certificate = self.dir / "key.pem", self.dir / "certificate.pem"
        command = "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 3 -subj /CN=x"
        subprocess.run([*command.split(), "-keyout", key, "-out", certificate], check=True, capture_output=True)
        plain = f"unix:{self.dir}/plain.socket"
        options = ["--listen", plain, "--tls-cert", certificate, "--tls-key", key]
        with stage.server(self.dir, *options, name="tls", healthy_at=plain) as server:
            idle = self.greetings(server.address, tls=True)
            for what in (HEADER_BLOCK, "header block in small frames", "rapid resets"):
                with attack(what, server.address, LOAD + 0.5, "tls") as ended:
                    time.sleep(0.5)
                    beside = self.greetings(server.address, tls=True)
                    ended()
                self.compare(f"{what}, with TLS", "greetings", idle, beside)
                self.assert_greets(f"{what}, with TLS", server.address, tls=True)
            closed = server.lines("connection_closed")
            self.figure("lines of the log, with TLS", len(closed), "", "some", bool(closed))

    def test_at_the_health_port(self):
        health = f"127.0.0.1:{stage.free_port()}"
        with stage.server(self.dir, "--health-listen", health) as server:
            idle, idle_greetings = self.small_times(server.address, "idle, health"), self.greetings(health)
            for what in (HEADER_BLOCK, "rapid resets"):
                with attack(what, health, 2 * LOAD + 0.5) as ended:
                    time.sleep(0.5)
                    beside, greetings = self.small_times(server.address, f"beside {what}, health"), self.greetings(health)
                    ended()
                self.compare(f"{what} at the health port", "small requests", idle, beside)
                self.compare(f"{what} at the health port", "greetings there", idle_greetings, greetings)


if __name__ == "__main__":
    unittest.main()
