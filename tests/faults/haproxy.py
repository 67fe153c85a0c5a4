"""haproxy in front of several servers: each call goes to the next serving one."""

import contextlib
import socket
import subprocess
import time

from http2 import DATA, END_HEADERS, END_STREAM, HEADERS, PREFACE, call_fields, frame
from stage import free_port, harness

# Streams may be silent for half an hour, while a job computes or its client stands still. A call is tried again at
# another server if none of its bytes was sent yet. A server that drains gets no more calls, and finishes those that it
# has.
CONFIG = """
global
    maxconn 4000
defaults
    mode http
    timeout connect 1s
    timeout client 30m
    timeout server 30m
    retries 3
    option redispatch
frontend calls
    bind 127.0.0.1:{port} proto h2
{rules}
    default_backend servers
backend servers
    balance roundrobin
    option tcp-check
    tcp-check connect
    tcp-check send-binary {question}
    tcp-check expect binary {answer}
    default-server proto h2 check inter 200ms fall 1 rise 1
"""


# Against clients that attack; also in deploy/haproxy/haproxy.cfg.
RULES = [
    "stick-table type ipv6 size 100k expire 30s store conn_cur,conn_rate(10s),http_req_rate(1s)",
    "tcp-request connection track-sc0 src",
    "tcp-request connection reject if { sc_conn_cur(0) gt 1000 } or { sc_conn_rate(0) gt 2000 }",
    "http-request deny deny_status 429 if { sc_http_req_rate(0) gt 500 }",
    "http-request del-header -bin -m end",
]


def health_check():
    """A call of grpc.health.v1.Health.Check as bytes of HTTP/2, and the answer's body for SERVING. haproxy's own HTTP
    checks cannot send a gRPC message, because it begins with zeros."""
    call = frame(HEADERS, END_HEADERS, 1, call_fields(b"/grpc.health.v1.Health/Check", b"haproxy"))
    empty = bytes(5)  # an empty message asks about the whole server
    question = PREFACE + call + frame(DATA, END_STREAM, 1, empty)
    return question.hex(), bytes([0, 0, 0, 0, 2, 8, 1]).hex()


@contextlib.contextmanager
def haproxy(directory, servers):
    """Starts haproxy, and yields its address."""
    port = free_port()
    question, answer = health_check()
    rules = "\n".join(f"    {rule}" for rule in RULES)
    lines = [CONFIG.format(port=port, rules=rules, question=question, answer=answer)]
    lines += [f"    server s{n} {server.address}\n" for n, server in enumerate(servers)]
    config = directory / "haproxy.cfg"
    config.write_text("".join(lines))
    with open(directory / "haproxy.log", "ab") as log:
        process = subprocess.Popen(["haproxy", "-db", "-f", config], stdout=log, stderr=log)
    try:
        wait_until_open(process, port, directory / "haproxy.log")
        yield f"127.0.0.1:{port}"
        assert process.poll() is None, (directory / "haproxy.log").read_text()
    finally:
        process.kill()
        process.wait()


def wait_until_open(process, port, log):
    deadline = time.monotonic() + harness.PATIENCE
    while time.monotonic() < deadline:
        assert process.poll() is None, log.read_text()
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
            return
        time.sleep(0.02)
    raise AssertionError("haproxy does not listen")
