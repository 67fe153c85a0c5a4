"""haproxy accepts deploy/haproxy/haproxy.cfg, whose health check has the bytes that the fault suite tests."""

import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "faults"))

import haproxy  # noqa: E402

CONFIG = ROOT / "deploy/haproxy/haproxy.cfg"


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


if __name__ == "__main__":
    unittest.main()
