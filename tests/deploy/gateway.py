"""Runs the gateway as a user does, and calls it."""

import contextlib
import hashlib
import json
import pathlib
import re
import signal
import socket
import ssl
import struct
import subprocess
import sys
import time
import urllib.error
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

from harness import PATIENCE  # noqa: E402

GATEWAY = ROOT / "deploy/gateway"
SERVICE = "/latvox.v1.Voxelizer/"
KINDS = ["connect", "connect+json", "grpc-web"]


def protocol(directory):
    """Returns the file that the gateway reads, made as its README says."""
    path = directory / "protocol.binpb"
    if not path.exists():
        subprocess.run([GATEWAY / "protocol", path], check=True)
    return path


class Gateway:
    """A gateway on a port of its own; its log is gateway.log."""

    def __init__(self, directory, upstream, *options, program=GATEWAY / "main.js"):
        self.set, self.path = protocol(directory), directory / "gateway.log"
        self.secure = "--tls-cert" in options
        words = [program, "--listen", "127.0.0.1:0", "--upstream", upstream, "--protocol", self.set, *options]
        with open(self.path, "wb") as log:
            self.process = subprocess.Popen(words, stdout=log, stderr=log)
        address = self.await_log(r"event=listening address=(\S+)")
        self.address = address
        self.url = f"{'https' if self.secure else 'http'}://{address}"

    def place(self):
        """Returns host and port."""
        host, port = self.address.split(":")
        return host, int(port)

    def connect(self):
        """Returns a new connection."""
        connection = socket.create_connection(self.place(), timeout=PATIENCE)
        return ssl._create_unverified_context().wrap_socket(connection) if self.secure else connection

    def metrics(self):
        """Returns the text that Prometheus reads. Needs --metrics-listen 127.0.0.1:0."""
        address = self.await_log(r"event=metrics address=(\S+)")
        return urllib.request.urlopen(f"http://{address}/metrics", timeout=PATIENCE).read().decode()

    def log(self):
        return self.path.read_text()

    def await_log(self, pattern, count=1):
        deadline = time.monotonic() + PATIENCE
        while len(found := re.findall(pattern, self.log())) < count:
            assert time.monotonic() < deadline, f"no {pattern} in {self.log()}"
            assert self.process.poll() is None or found, self.log()
            time.sleep(0.02)
        return found[count - 1]

    def stop(self):
        """Returns the exit status."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(PATIENCE)

    def memory(self):
        """Returns the most memory that the process had, in bytes."""
        return 1024 * int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{self.process.pid}/status").read_text())[1])

    def post(self, method, request, headers={}, body=None):
        """Returns status, headers and the answer of a unary call in JSON, without any library."""
        data = json.dumps(request).encode() if body is None else body
        asked = urllib.request.Request(
            self.url + SERVICE + method, data, {"Content-Type": "application/json", **headers}
        )
        try:
            with urllib.request.urlopen(asked, timeout=PATIENCE) as answer:
                return answer.status, answer.headers, json.load(answer)
        except urllib.error.HTTPError as answer:
            return answer.code, answer.headers, json.load(answer)

    def call(self, *calls):
        """Returns what gateway_client.mjs tells about each call by npm's packages."""
        words = {"url": self.url, "set": str(self.set), "calls": calls}
        done = subprocess.run(["node", pathlib.Path(__file__).with_name("gateway_client.mjs")], input=json.dumps(words),
                              capture_output=True, text=True, timeout=PATIENCE)  # fmt: skip
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    def by_all(self, method, request, **options):
        """Returns what is told about the same call by each protocol."""
        return self.call(*({"protocol": kind, "method": method, "request": request, **options} for kind in KINDS))


@contextlib.contextmanager
def gateway(directory, upstream, *options, errors=(), **more):
    """`errors`: events of the log that may have level error."""
    running = Gateway(directory, upstream, *map(str, options), **more)
    try:
        yield running
        code = running.process.poll()
        assert (running.stop() if code is None else code) == 0, running.log()
        assert set(re.findall(r"level=error event=(\w+)", running.log())) <= set(errors), running.log()
        assert "MaxListeners" not in running.log(), running.log()
    finally:
        running.process.kill()
        running.process.wait()


def raw(mesh):
    """Returns the description and the bytes of RawMesh."""
    vertices, triangles = mesh
    data = b"".join(struct.pack("<3d", *vertex) for vertex in vertices) + b"".join(
        struct.pack("<3I", *t) for t in triangles
    )
    about = {"vertices": len(vertices), "triangles": len(triangles), "positions": "POSITION_TYPE_FLOAT64"}
    return about, data, hashlib.sha256(data).digest()
