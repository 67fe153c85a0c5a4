"""The example of the security page works as it stands, with ports and paths of this test."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "faults"))
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

from harness import BIN, BUNNY, PATIENCE, Case, latvox  # noqa: E402
from stage import free_port  # noqa: E402

PAGE = ROOT / "server" / "docs" / "security.md"
OK, REFUSED, UNREACHABLE = 0, 5, 4


def blocks():
    """Returns the example's configuration, its commands, and the caller's command."""
    example = PAGE.read_text().partition("### Example: a server for strangers\n")[2]
    return re.findall(r"^```(?:bash)?\n(.*?)^```$", example, re.DOTALL | re.MULTILINE)[:3]


class Strangers(Case):
    def setUp(self):
        super().setUp()
        self.outside, self.inside = free_port(), free_port()
        self.config, self.commands, self.call = (
            text.replace(":50151", f":{self.inside}").replace("/etc/haproxy", str(self.dir)) for text in blocks()
        )
        self.config = self.config.replace("bind :443", f"bind 127.0.0.1:{self.outside}")
        certificate, key = self.dir / "certificate", self.dir / "key"
        openssl = "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 3 -subj /CN=localhost"
        names = ["-addext", "subjectAltName=DNS:localhost"]
        subprocess.run([*openssl.split(), *names, "-keyout", key, "-out", certificate], check=True, capture_output=True)
        (self.dir / "server.pem").write_text(certificate.read_text() + key.read_text())
        (self.dir / "strangers.cfg").write_text(self.config)
        (self.dir / "bunny.obj").symlink_to(BUNNY)

    def start(self):
        """Runs the example's commands; the processes get their own group, which ends with the test."""
        path = {"PATH": f"{BIN}:/usr/sbin:{os.environ['PATH']}"}
        # haproxy goes to the background, and writes its number.
        commands = self.commands.replace("haproxy -D", "haproxy -D -p haproxy.pid").replace("&\n", "& echo $! > latvoxd.pid\n")
        with open(self.dir / "log", "wb") as log:
            subprocess.run(["bash", "-ec", commands], cwd=self.dir, env=os.environ | path, stdout=log, stderr=log, check=True)
        for name in ("haproxy", "latvoxd"):
            self.addCleanup(os.kill, int((self.dir / f"{name}.pid").read_text()), signal.SIGTERM)

    def latvox(self, command, **more):
        return latvox(*command, "--server", f"localhost:{self.outside}", "--tls-ca", self.dir / "certificate", **more)

    def test_the_example(self):
        if not shutil.which("haproxy", path="/usr/sbin:" + os.environ["PATH"]):
            self.fail("haproxy is missing")
        self.start()
        deadline = time.monotonic() + PATIENCE
        while self.latvox(["health"]).returncode != OK:
            self.assertLess(time.monotonic(), deadline, (self.dir / "log").read_text())
            time.sleep(0.1)
        call = self.call.replace("example.org:443 --tls", f"localhost:{self.outside} --tls-ca certificate").split()
        self.assertEqual(call[:2], ["latvox", "voxelize"])
        done = latvox(*call[1:], cwd=self.dir)
        self.assertEqual(done.returncode, OK, done.stderr)
        self.assertGreater((self.dir / "bunny.vdb").stat().st_size, 0)
        limits = self.latvox(["limits", "--json", "--token-file", self.dir / "alice.token"])
        self.assertIn('"max_job_seconds": 600', limits.stdout)
        self.assertEqual(self.latvox(["limits"]).returncode, REFUSED)
        plain = latvox("health", "--server", f"localhost:{self.outside}", "--timeout", 5)
        self.assertEqual(plain.returncode, UNREACHABLE, plain.stderr)


if __name__ == "__main__":
    unittest.main()
