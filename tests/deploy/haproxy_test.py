"""haproxy accepts deploy/haproxy/haproxy.cfg, whose health check has the bytes that the fault suite tests. With haproxy, a
pod of deploy/kubernetes serves by IPv4 and by IPv6."""

import pathlib
import re
import subprocess
import sys
import unittest
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "e2e"), str(ROOT / "tests" / "faults")]

import haproxy  # noqa: E402
from harness import BIN, PATIENCE, Case, await_true, latvox  # noqa: E402
from stage import free_port  # noqa: E402

CONFIG = ROOT / "deploy/haproxy/haproxy.cfg"
SERVICE = ROOT / "deploy/kubernetes/overlays/service"


class Haproxy(unittest.TestCase):
    def test_the_configuration_is_valid(self):
        done = subprocess.run(["haproxy", "-c", "-f", CONFIG], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_health_check_is_that_of_the_fault_suite(self):
        text = CONFIG.read_text()
        sent = "".join(re.findall(r"^ *tcp-check send-binary (\w+)", text, re.M))
        expected = re.findall(r"^ *tcp-check expect binary (\w+)", text, re.M)
        self.assertEqual((sent, expected), (haproxy.health_check()[0], [haproxy.health_check()[1]]))

    def test_the_rules_against_hostile_clients_are_those_of_the_fault_suite(self):
        lines = [line.strip() for line in CONFIG.read_text().splitlines()]
        start = lines.index(haproxy.RULES[0])
        rules = [line for line in lines[start : lines.index("default_backend servers")] if not line.startswith("#")]
        self.assertEqual(rules, haproxy.RULES)

    def test_no_stream_is_cut_because_its_server_is_down_to_the_checks(self):
        self.assertNotIn("shutdown-sessions", CONFIG.read_text())


class Pod(Case):
    """The programs of a pod, with its configurations, except for the numbers of ports and the places of files."""

    def start(self, *command):
        log = self.enterContext(open(self.dir / "pod.log", "ab"))
        process = subprocess.Popen(command, stdout=log, stderr=log)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)

    def test_it_serves_by_both_families_of_addresses(self):
        certificate, secret = self.dir / "server.pem", "0123456789abcdef0123"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost", "-addext",
                        "subjectAltName=IP:127.0.0.1,IP:::1", "-keyout", f"{certificate}.key", "-out", certificate],
                       check=True, capture_output=True)  # fmt: skip
        for name, text in (("tokens", f"alice {secret}\n"), ("token", secret)):
            (self.dir / name).write_text(text)
            (self.dir / name).chmod(0o600)
        ports = {port: str(free_port()) for port in ("50151", "50152", "50153", "9464")}
        for name in "haproxy.cfg", "latvoxd.toml":
            text = re.sub("|".join(ports), lambda match: ports[match[0]], (SERVICE / name).read_text())
            text = re.sub(r"/run/secrets/latvox/(?:tls|tokens)", str(self.dir), text)
            (self.dir / name).write_text(text)
        self.start(BIN / "latvoxd", "--config", self.dir / "latvoxd.toml")
        self.start("haproxy", "-f", self.dir / "haproxy.cfg")
        for address in "127.0.0.1", "[::1]":
            with self.subTest(address):
                health = ["health", "--server", f"{address}:{ports['50152']}"]
                await_true("the health port does not answer", lambda: latvox(*health, check=False).returncode == 0)
                ask = ["limits", "--server", f"{address}:{ports['50151']}", "--tls-ca", certificate, "--token-file", self.dir / "token"]
                await_true("the service does not answer", lambda: "max_jobs" in latvox(*ask, check=False).stdout)
                told = urllib.request.urlopen(f"http://{address}:{ports['9464']}/metrics", timeout=PATIENCE).read().decode()
                self.assertIn("latvox_requests_total", told)


if __name__ == "__main__":
    unittest.main()
