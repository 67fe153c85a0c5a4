"""Metrics over HTTP count what happened. Dashboard and alert rules of deploy/ use existing metrics."""

import contextlib
import json
import pathlib
import re
import shutil
import signal
import subprocess
import time
import unittest
import urllib.request

import harness
from harness import BUNNY, Case, latvox

ROOT = pathlib.Path(__file__).resolve().parents[2]
DASHBOARD = json.loads((ROOT / "deploy/grafana/dashboard.json").read_text())
PROMETHEUS = ROOT / "deploy/prometheus"
BUILD = pathlib.Path(harness.BIN).parent


@contextlib.contextmanager
def watched_server(directory, *options):
    """Runs a latvoxd with TLS and metrics; `scrape()` fetches these."""
    key, certificate = directory / "key.pem", directory / "certificate.pem"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "3",
                    "-subj", "/CN=x", "-keyout", key, "-out", certificate], check=True, capture_output=True)
    with harness.server(directory, "--metrics-listen", "127.0.0.1:0", "--tls-cert", certificate, "--tls-key", key, *options) as server:
        address = harness.await_log(directory, r"event=metrics address=(\S+)")
        server.scrape = lambda: urllib.request.urlopen(f"http://{address}/metrics", timeout=harness.PATIENCE).read().decode()
        yield server


def samples(text):
    """Returns name{labels, sorted} -> value."""
    found = {}
    for line in text.splitlines():
        if line and not line.startswith("#"):
            name, labels, value = re.fullmatch(r"([\w:]+)(?:\{(.*)\})? (\S+)", line).groups()
            found[name + "{" + ",".join(sorted((labels or "").split(","))) + "}"] = float(value)
    return found


def work(case, server):
    """Makes good, bad and refused requests."""
    remote = ["--server", server.address]
    summary = case.voxelize(BUNNY, "--lattice", "bcc", "--resolution", 64, *remote)
    bad = latvox("voxelize", BUNNY, "-o", case.dir / "no.csv", "--basis", "1,0,0,0,1,0,1,1,0", *remote)
    case.assertEqual(bad.returncode, 3, bad.stderr)
    refused = latvox("voxelize", BUNNY, "-o", case.dir / "no.csv", "--lattice", "bcc", "--resolution", 4096, *remote)
    case.assertEqual(refused.returncode, 5, refused.stderr)
    (case.dir / "line.txt").write_text("0,0 4,9\n")
    drawn = latvox("pixelize", case.dir / "line.txt", "-o", case.dir / "line.csv", "--lattice", "square", "--resolution", 40, "--json", *remote)
    case.assertEqual(drawn.returncode, 0, drawn.stderr)
    case.assertEqual(latvox("limits", *remote).returncode, 0)
    return summary, json.loads(drawn.stdout)


class Metrics(Case):
    def test_they_count_what_happened(self):
        with watched_server(self.dir, "--max-visited-points", "100000") as server:
            summary, drawn = work(self, server)
            found = samples(server.scrape())
        for name, value in {
            'latvox_requests_total{code="OK",method="Voxelize"}': 1,
            'latvox_requests_total{code="INVALID_ARGUMENT",method="Voxelize"}': 1,
            'latvox_requests_total{code="RESOURCE_EXHAUSTED",method="Voxelize"}': 1,
            'latvox_requests_total{code="OK",method="Pixelize"}': 1,
            'latvox_requests_total{code="OK",method="GetLimits"}': 1,
            'latvox_rejections_total{reason="BAD_SPEC"}': 1,
            'latvox_rejections_total{reason="LIMIT_EXCEEDED"}': 1,
            "latvox_voxels_total{}": summary["voxels"],
            "latvox_pixels_total{}": drawn["pixels"],
            'latvox_request_duration_seconds_count{method="Voxelize"}': 1,
            'latvox_stage_duration_seconds_count{stage="pixelize"}': 1,
            "latvox_jobs_running{}": 0,
            "latvox_jobs_queued{}": 0,
            "latvox_jobs_paused{}": 0,
            "latvox_jobs_max{}": 16,
        }.items():
            with self.subTest(name):
                self.assertEqual(found.get(name), value)
        for stage in ("upload", "queue", "decode", "voxelize", "stream"):
            self.assertGreaterEqual(found[f'latvox_stage_duration_seconds_count{{stage="{stage}"}}'], 1)
        self.assertGreaterEqual(found["latvox_triangles_total{}"], 69666)
        self.assertGreaterEqual(found['latvox_received_bytes_total{method="Voxelize"}'], summary["mesh"]["triangles"] / 2)
        self.assertGreater(found["latvox_memory_limit_bytes{}"], found["latvox_memory_budget_bytes{}"])
        self.assertLess(found["process_resident_memory_bytes{}"], found["latvox_memory_limit_bytes{}"])
        soonest = found["process_start_time_seconds{}"] + 2.9 * 86400
        self.assertGreater(found["latvox_tls_certificate_expiry_timestamp_seconds{}"], soonest)
        self.assertLess(found["latvox_tls_certificate_expiry_timestamp_seconds{}"], soonest + 0.2 * 86400)

    def test_a_job_whose_client_does_not_read_is_paused(self):
        with watched_server(self.dir) as server:
            def wait_for(name):
                end = time.monotonic() + harness.PATIENCE
                while samples(server.scrape())[f"latvox_jobs_{name}{{}}"] != 1:
                    self.assertLess(time.monotonic(), end, name)
                    time.sleep(0.05)

            job = ["--resolution", "8192", "-o", self.dir / "never.csv", "--server", server.address]
            client = subprocess.Popen([harness.BIN / "latvox", "voxelize", BUNNY, *job])
            try:
                wait_for("running")
                client.send_signal(signal.SIGSTOP)
                wait_for("paused")
            finally:
                client.kill()
                client.wait()

    def test_an_address_that_cannot_be_had_is_named(self):
        with watched_server(self.dir) as server:
            address = harness.await_log(self.dir, r"event=metrics address=(\S+)")
            command = [harness.BIN / "latvoxd", "--listen", "127.0.0.1:0", "--metrics-listen", address]
            done = subprocess.run(command, capture_output=True, text=True, timeout=harness.PATIENCE)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, f"cannot listen on {address} for metrics")
            self.assertIsNone(server.poll())


# Prometheus's own; tests/deploy/gateway_operations_test.py has a gateway.
ELSEWHERE = re.compile("up$|latvox_gateway_")
WORDS = set("or sum by rate absent histogram_quantile max min count le changes time instance method code reason stage job cause".split())



def expressions():
    """Yields those of deploy/prometheus and deploy/grafana."""
    rules = (PROMETHEUS / "alerts.yaml").read_text()
    block = re.findall(r"expr: (?:\|\n((?: {10,}.*\n)+)|(.*)\n)", rules)
    yield from ((lines or line) for lines, line in block)
    yield from (target["expr"] for panel in DASHBOARD["panels"] for target in panel.get("targets", []))


def metrics_of(expression):
    without_labels = re.sub(r"\{[^}]*\}|\[[^\]]*\]|\"[^\"]*\"|by \([^)]*\)", " ", expression)
    return set(re.findall(r"[a-zA-Z_]\w+", without_labels)) - WORDS


def metrics_of_page():
    """Returns those that operators are told to look at."""
    rows = re.findall(r"^\| (`latvox_.*?) \|", (ROOT / "server/docs/operations.md").read_text(), re.M)
    return set(re.findall(r"`(latvox_\w+)`", " ".join(rows)))


class Deploy(Case):
    """deploy/prometheus and deploy/grafana."""

    def test_every_metric_that_they_name_is_there(self):
        with watched_server(self.dir, "--max-visited-points", "100000") as server:
            work(self, server)
            there = {name.partition("{")[0] for name in samples(server.scrape())}
        named = {name for name in set().union(*map(metrics_of, expressions())) if not ELSEWHERE.match(name)}
        self.assertGreater(len(named), 20, named)
        self.assertEqual(named - there, set())

    def test_every_reason_that_they_name_is_one_of_the_servers(self):
        source = "".join(path.read_text() for path in (ROOT / "server").rglob("*.cc"))
        named = [word for text in expressions() for words in re.findall(r'latvox_rejections_total\{reason=~?"([^"]*)"', text) for word in words.split("|")]
        self.assertGreater(len(named), 2)
        self.assertEqual([word for word in named if f'"{word}"' not in source], [])

    def test_every_reason_and_code_is_counted_from_the_start(self):
        source = "".join(path.read_text() for path in (ROOT / "server").rglob("*.[ch]*"))
        reasons = set(re.findall(r'\{"([A-Z]+(?:_[A-Z]+)*)", "', source)) | {"TOO_MANY_JOBS", "TOO_MANY_JOBS_OF_CLIENT"}
        self.assertGreater(len(reasons), 10)
        table = (ROOT / "proto/latvox/v1/voxelizer.proto").read_text()
        self.assertEqual([reason for reason in reasons if f"\n//   {reason} " not in table], [])
        with watched_server(self.dir) as server:
            found = samples(server.scrape())
        self.assertEqual([reason for reason in reasons if found.get(f'latvox_rejections_total{{reason="{reason}"}}') != 0], [])
        self.assertEqual(found['latvox_requests_total{code="INTERNAL",method="PutMesh"}'], 0)

    def test_they_show_every_metric_that_operators_are_told_to_look_at(self):
        told = metrics_of_page()
        self.assertGreater(len(told), 10)
        named = set().union(*map(metrics_of, expressions()))
        histograms = {name.removesuffix("_bucket") for name in named}
        self.assertEqual(told - named - histograms, set())

    def test_the_dashboards_panels_have_places_of_their_own(self):
        taken, ids = set(), [panel["id"] for panel in DASHBOARD["panels"]]
        self.assertEqual(len(ids), len(set(ids)))
        for panel in DASHBOARD["panels"]:
            place = panel["gridPos"]
            cells = {(place["x"] + x, place["y"] + y) for x in range(place["w"]) for y in range(place["h"])}
            self.assertFalse(cells & taken, panel["title"])
            self.assertLessEqual(max(x for x, _ in cells), 23)
            taken |= cells


class Promtool(Case):
    """Checks by Prometheus's own tool."""

    @classmethod
    def setUpClass(cls):
        fetched = subprocess.run([ROOT / "tests/e2e/fetch-promtool", BUILD / "promtool"], capture_output=True, text=True)
        if fetched.returncode != 0:
            raise unittest.SkipTest(f"SKIPPED: no promtool, and Debian's cannot be fetched: {fetched.stderr}")
        cls.promtool = fetched.stdout.strip()

    def check(self, *arguments, **options):
        done = subprocess.run([self.promtool, *map(str, arguments)], capture_output=True, text=True, **options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done

    def test_configuration_and_rules_are_good(self):
        for name in ("prometheus.yaml", "compose.yaml"):
            self.check("check", "config", PROMETHEUS / name)
        self.check("check", "rules", PROMETHEUS / "alerts.yaml")

    def test_each_alert_fires_for_its_trouble_and_none_without(self):
        shutil.copy(PROMETHEUS / "alerts.yaml", self.dir)
        shutil.copy(ROOT / "tests/e2e/alerts.test.yaml", self.dir)
        self.check("test", "rules", self.dir / "alerts.test.yaml")
        rules = set(re.findall(r"alert: (\w+)", (PROMETHEUS / "alerts.yaml").read_text()))
        tried = set(re.findall(r'alertname="(\w+)"', (ROOT / "tests/e2e/alerts.test.yaml").read_text()))
        self.assertEqual(rules, tried)

    def test_the_dashboards_expressions_can_be_read(self):
        lines = ["groups:", "  - name: dashboard", "    rules:"]
        for panel in DASHBOARD["panels"]:
            for target in panel.get("targets", []):
                expression = re.sub(r"\$__rate_interval", "5m", target["expr"])
                lines += ["      - record: a", f"        expr: {json.dumps(expression)}", f"        labels: {{n: '{len(lines)}'}}"]
        (self.dir / "dashboard.yaml").write_text("\n".join(lines) + "\n")
        self.check("check", "rules", self.dir / "dashboard.yaml")

    def test_prometheus_reads_the_served_metrics(self):
        with watched_server(self.dir) as server:
            text = server.scrape()
        # prometheus-cpp's metrics about itself break the conventions.
        ours = "".join(line + "\n" for line in text.splitlines() if "exposer_" not in line)
        said = self.check("check", "metrics", input=ours)
        self.assertEqual(said.stdout + said.stderr, "")


if __name__ == "__main__":
    unittest.main()
