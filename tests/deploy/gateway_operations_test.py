"""The gateway as its operators see it: metrics, and files that change while it runs."""

import json
import os
import pathlib
import re
import select
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error

from gateway import ROOT, gateway
from gateway_case import DRAWING, GatewayCase

sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402
import metrics_test  # noqa: E402
from tls_test import Authority  # noqa: E402

BROKEN = pathlib.Path(__file__).with_name("gateway_broken_metrics.mjs")
NOWHERE = "unix:/nowhere/latvoxd.socket"


class Metrics(GatewayCase):
    def test_they_count_what_happened(self):
        limits = ["--max-body", "10KiB", "--metrics-listen", "127.0.0.1:0"]
        with harness.server(self.dir) as server, gateway(self.dir, server.address, *limits) as running:
            self.upload(running)
            running.post("Pixelize", DRAWING)
            running.post("Pixelize", {**DRAWING, "resolution": 0})
            running.post("Pixelize", None, body=b" " * 20000)
            running.post("Voxelize", {})
            before = metrics_test.samples(running.metrics())
            connection = self.stalled(running)
            during = metrics_test.samples(running.metrics())
            connection.close()
            running.await_log("method=VoxelizeStored .*code=CANCELLED")
            after = metrics_test.samples(running.metrics())
        wanted = {
            'requests_total{code="OK",method="Pixelize"}': 1,
            'requests_total{code="INVALID_ARGUMENT",method="Pixelize"}': 1,
            'requests_total{code="RESOURCE_EXHAUSTED",method="Pixelize"}': 1,
            'requests_total{code="UNIMPLEMENTED",method="Voxelize"}': 1,
            'requests_total{code="INTERNAL",method="VoxelizeStored"}': 0,
            'request_duration_seconds_count{method="Pixelize"}': 1,
            'rejections_total{reason="LIMIT_EXCEEDED"}': 1,
            'rejections_total{reason="UNIMPLEMENTED"}': 1,
            'rejections_total{reason="TOO_MANY_JOBS"}': 0,
            "calls_running{}": 0,
            "calls_max{}": 256,
            "body_limit_bytes{}": 256 << 20,
            "connections_max{}": 1024,
            "upstreams{}": 1,
            "upstreams_down{}": 0,
        }
        self.assertEqual({name: before.get(f"latvox_gateway_{name}") for name in wanted}, wanted)
        sent = len(json.dumps(DRAWING)) + len(json.dumps({**DRAWING, "resolution": 0}))
        self.assertEqual(before['latvox_gateway_received_bytes_total{method="Pixelize"}'], sent)
        self.assertGreater(before['latvox_gateway_sent_bytes_total{method="Pixelize"}'], 100)
        self.assertGreater(before["process_resident_memory_bytes{}"], 20 << 20)
        self.assertEqual(during["latvox_gateway_calls_running{}"], 1)
        self.assertGreaterEqual(during["latvox_gateway_connections{}"], 1)
        self.assertGreater(during["latvox_gateway_body_bytes{}"], 100)
        self.assertEqual(after['latvox_gateway_requests_total{code="CANCELLED",method="VoxelizeStored"}'], 1)
        self.assertGreater(after['latvox_gateway_sent_bytes_total{method="VoxelizeStored"}'], 100)

    def test_the_page_of_operators_the_dashboard_and_the_rules_name_those_that_are_there(self):
        certificate, key = Authority(self.dir, "a").issue("server", "server", "subjectAltName=IP:127.0.0.1")
        options = ["--tls-cert", certificate, "--tls-key", key, "--metrics-listen", "127.0.0.1:0"]
        with gateway(self.dir, f"unix:{self.dir}/none", *options) as running:
            text = running.metrics()
            ask = ["curl", "--silent", "--insecure", running.url + "/metrics"]
            done = subprocess.run(ask, capture_output=True, text=True)
            self.assertEqual(done.stdout, "there is no /metrics\n", "they have a port of their own")
        ours = set(re.findall(r"^# TYPE (latvox_gateway_\w+)", text, re.M))
        self.assertEqual(ours, {name for name in metrics_test.metrics_of_page() if "_gateway_" in name})
        named = set().union(*map(metrics_test.metrics_of, metrics_test.expressions()))
        there = {name.partition("{")[0] for name in metrics_test.samples(text)}
        self.assertEqual({name for name in named if "_gateway_" in name} - there, set())
        for expression in metrics_test.expressions():
            reasons = re.findall(r'latvox_gateway_rejections_total\{reason=~?"([^"]*)"', expression)
            for reason in "|".join(reasons).split("|") if reasons else []:
                self.assertIn(f'latvox_gateway_rejections_total{{reason="{reason}"}}', text)

    def test_prometheus_reads_them(self):
        fetch = [ROOT / "tests/e2e/fetch-promtool", metrics_test.BUILD / "promtool"]
        fetched = subprocess.run(fetch, capture_output=True, text=True)
        if fetched.returncode != 0:
            self.skipTest(f"SKIPPED: no promtool, and Debian's cannot be fetched: {fetched.stderr}")
        with gateway(self.dir, f"unix:{self.dir}/none", "--metrics-listen", "127.0.0.1:0") as running:
            text = running.metrics()
        # Names of prom-client's own metrics break the conventions.
        ours = "".join(line + "\n" for line in text.splitlines() if "latvox_" in line)
        said = subprocess.run([fetched.stdout.strip(), "check", "metrics"], input=ours, capture_output=True, text=True)
        self.assertEqual((said.returncode, said.stdout + said.stderr), (0, ""))

    def test_one_that_cannot_be_read_does_not_end_the_gateway(self):
        options = ["--metrics-listen", "127.0.0.1:0"]
        with gateway(self.dir, NOWHERE, *options, program=BROKEN, errors=["metrics_failed"]) as running:
            for n in (1, 2):
                with self.assertRaises(urllib.error.HTTPError) as raised:
                    running.metrics()
                self.assertEqual((raised.exception.code, raised.exception.read()), (500, b"there is no figure\n"))
                running.await_log('event=metrics_failed error="there is no figure"', n)

    def test_idle_connections_leave_sooner_than_node_would_end_them(self):
        with gateway(self.dir, NOWHERE, "--metrics-listen", "127.0.0.1:0", program=BROKEN) as running:
            plain = self.connection(running.await_log(r"plain (\d+)"))
            idle = [self.connection(running.await_log(r"event=metrics address=\S+:(\d+)")) for _ in range(8)]
            for connection in idle:
                while connection.recv(4096):
                    pass
            self.assertEqual(select.select([plain], [], [], 0)[0], [])

    def connection(self, port):
        return self.enterContext(socket.create_connection(("127.0.0.1", int(port)), timeout=harness.PATIENCE))


def put(path, text):
    """Replaces a file at once, because the gateway may look at any moment."""
    new = path.with_name(path.name + ".new")
    new.write_text(text)
    os.replace(new, path)


class Reload(GatewayCase):
    ORIGIN = {"Origin": "https://a.example"}

    def replace(self, authority, path, key):
        """Puts a new pair of this authority into the files, as `mv` does."""
        made = authority.issue("next", "server", "subjectAltName=IP:127.0.0.1")
        for new, place in zip(made, (path, key)):
            os.replace(new, place)

    def shown(self, running):
        """Returns the certificate that a new connection gets."""
        return ssl.get_server_certificate(running.place())

    def test_new_connections_get_a_new_certificate_and_running_calls_go_on(self):
        authority = Authority(self.dir, "authority")
        certificate, key = authority.issue("server", "server", "subjectAltName=IP:127.0.0.1")
        options = ["--tls-cert", certificate, "--tls-key", key, "--metrics-listen", "127.0.0.1:0"]
        expiry = r"latvox_gateway_tls_certificate_expiry_timestamp_seconds (\d+)"
        errors = ["tls_certificate_kept"]
        with harness.server(self.dir) as server, gateway(self.dir, server.address, *options, errors=errors) as running:
            with gateway(pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())), server.address) as plain:
                self.upload(plain)
            connection = self.stalled(running, resolution=1500)
            first = self.shown(running)
            self.assertEqual(first, certificate.read_text())
            self.assertGreater(int(re.search(expiry, running.metrics())[1]), time.time())
            self.replace(authority, certificate, key)
            running.await_log("event=tls_certificate_read")
            second = self.shown(running)
            self.assertEqual(second, certificate.read_text())
            self.assertNotEqual(first, second)
            for version in ("--http1.1", "--http2"):
                words = ["curl", "--silent", version, "--cacert", authority.root, running.url + "/healthz"]
                self.assertEqual(subprocess.run(words, capture_output=True).stdout, b"serving\n")
            self.replace(Authority(self.dir, "other"), certificate, self.dir / "unused")
            kept = f"event=tls_certificate_kept error=\"{key}: "
            running.await_log(f"{kept}the key is not that of the certificate in {certificate}")
            key.write_text("no key")
            running.await_log(f"{kept}it holds no private key in PEM form without a passphrase")
            self.assertEqual(self.shown(running), second)
            # The answer has 10 MB, which no connection's buffers hold: the call waits for its reader.
            self.assertIn("\nlatvox_gateway_calls_running 1\n", running.metrics())
            end = b""
            while got := connection.recv(1 << 20):
                end = (end + got)[-2000:]
                if b'"summary":{' in end and end.endswith(b"0\r\n\r\n"):
                    break
            self.assertIn(b'"summary":{', end)

    def test_new_calls_trust_the_new_roots_of_latvoxd(self):
        authority, other = (Authority(self.dir, name) for name in ("authority", "other"))
        certificate, key = authority.issue("server", "server", "subjectAltName=IP:127.0.0.1")
        roots = self.dir / "roots.pem"
        roots.write_text(authority.root.read_text())
        with harness.server(self.dir, "--listen", "127.0.0.1:0", "--tls-cert", certificate, "--tls-key", key):
            address = harness.await_log(self.dir, r"event=listening address=(127\.0\.0\.1:\d+)")
            options = ["--upstream-tls", "--upstream-ca", roots]
            with gateway(self.dir, address, *options, errors=["upstream_tls_kept"]) as running:
                for n, (root, status) in enumerate([(authority, 200), (other, 503), (authority, 200)]):
                    if n > 0:
                        put(roots, root.root.read_text())
                        running.await_log("event=upstream_tls_read", n)
                    self.assertEqual(running.post("GetLimits", {})[0], status)
                for n, wrong in enumerate(["", "nothing"], 1):
                    put(roots, wrong)
                    running.await_log(f"event=upstream_tls_kept .*{roots}: it holds no certificate in PEM form", n)
                    self.assertEqual(running.post("GetLimits", {})[0], 200)

    def test_origins_and_log_level_follow_the_configuration_file(self):
        file = self.dir / "gateway.toml"
        file.write_text('cors-origin = ["https://b.example"]\nmax-calls = 7\n')
        errors = ["reload_failed"]

        def may(running):
            return "access-control-allow-origin" in running.post("GetLimits", {}, self.ORIGIN)[1]

        with harness.server(self.dir) as server, gateway(
            self.dir, server.address, "--config", file, "--metrics-listen", "127.0.0.1:0", errors=errors
        ) as running:
            self.assertIn("\nlatvox_gateway_calls_max 7\n", running.metrics())
            self.assertFalse(may(running))
            self.assertNotIn("level=debug", running.log())
            origins = 'cors-origin = ["https://b.example", "https://a.example"]'
            put(file, f'{origins}\nlog-level = "debug"\nmax-calls = 8\n')
            running.process.send_signal(signal.SIGHUP)
            running.await_log(f"level=info event=configuration_read path={file}")
            running.await_log("level=warning event=restart_needed options=max-calls")
            self.assertTrue(may(running))
            running.await_log("level=debug event=request method=GetLimits")
            put(file, "max-calls = 0")
            running.await_log(f'event=reload_failed error="{file}: max-calls: 0 is not between 1 and 100000"')
            self.assertTrue(may(running))
            file.unlink()
            running.await_log(f'event=reload_failed error="{file}: it cannot be read: ENOENT"')
            self.assertTrue(may(running))
            put(file, "#" * (1 << 20) + "\n")
            running.await_log(f'event=reload_failed error="{file}: it has 1048577 bytes, more than 1048576"')
            self.assertTrue(may(running))
            put(file, "cors-origin = []")
            running.await_log("event=configuration_read", 2)
            self.assertFalse(may(running))


if __name__ == "__main__":
    unittest.main()
