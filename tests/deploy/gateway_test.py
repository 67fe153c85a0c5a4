"""The gateway: every protocol of browsers gets what gRPC gets, and nobody gets more than the limits."""

import base64
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from gateway import GATEWAY, ROOT, SERVICE, gateway, protocol
from gateway_case import BCC, BIG, DRAWING, GatewayCase, text

sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402
import metrics_test  # noqa: E402
from harness import Case, write_obj  # noqa: E402
from tls_test import Authority  # noqa: E402


def voxels(messages):
    """Returns the number of bits in all masks."""
    return sum(
        int.from_bytes(base64.b64decode(m["bricks"].get("masks", "")), "little").bit_count()
        for m in messages
        if "bricks" in m
    )


class Shared(GatewayCase):
    """All tests share one server and one gateway, cls.running; their logs are in cls.place."""

    OPTIONS = ()

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.place = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="latvox-")))
        cls.server = cls.enterClassContext(harness.server(cls.place))
        cls.running = cls.enterClassContext(gateway(cls.place, cls.server.address, *cls.OPTIONS))

    def assert_no_process_left(self):
        """They end with the class."""


class Protocols(Shared):
    def test_all_protocols_get_the_digest_of_a_direct_call(self):
        server, running = self.server, self.running
        obj = write_obj(self.dir / "a.obj", self.mesh)
        direct = self.voxelize(obj, "--lattice", "bcc", "--resolution", 40, "--server", server.address)
        self.upload(running)
        for told in running.by_all("VoxelizeStored", self.stored(**BCC)):
            self.assertNotIn("code", told)
            summary = told["messages"][-1]["summary"]
            self.assertEqual(summary["certificate"]["digest"], direct["digest"])
            self.assertEqual(voxels(told["messages"]), direct["voxels"])
        _, _, small = running.post("VoxelizeSmall", {"spec": {**BCC, "rawMesh": self.about}, "mesh": text(self.data)})
        self.assertEqual(small["summary"]["certificate"]["digest"], direct["digest"])
        drawn = [told["messages"][0]["digest"] for told in running.by_all("Pixelize", DRAWING)]
        curl = subprocess.run(["curl", "--silent", "--json", json.dumps(DRAWING), running.url + SERVICE + "Pixelize"],
                              capture_output=True, check=True)  # fmt: skip
        self.assertEqual({*drawn, json.loads(curl.stdout)["digest"]}, {drawn[0]})

    def test_the_commands_of_the_page_work(self):
        page = (ROOT / "deploy/docs/gateway.md").read_text()
        commands = [block for block in re.findall(r"^```bash\n(.*?)^```", page, re.M | re.S) if "curl " in block]
        said = []
        for command in commands:
            words = ["bash", "-euo", "pipefail", "-c", command.replace("http://127.0.0.1:8080", self.running.url)]
            done = subprocess.run(words, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), command)
            said.append(done.stdout)
        for answer, part in zip(said, ('"digest":', '"stored":true', '"set":"solid"'), strict=True):
            self.assertIn(part, answer)

    def test_errors_have_their_details(self):
        running = self.running
        wrong = {**DRAWING, "polylines": [{"xy": [0, 0, 3]}]}
        for told in running.by_all("Pixelize", wrong):
            self.assertEqual(
                (told["code"], told["message"]), ("InvalidArgument", "polylines[0].xy has 3 coordinates, which is odd")
            )
            info = self.detail(told)
            self.assertEqual(
                (info["reason"], info["metadata"]), ("BAD_SPEC", {"field": "polylines[0].xy", "value": "3"})
            )
        unknown = {"spec": {**BCC, "meshSha256": text(bytes(32)), "rawMesh": self.about}}
        for told in running.by_all("VoxelizeStored", unknown):
            self.assertEqual((told["code"], self.detail(told)["reason"]), ("NotFound", "MESH_NOT_FOUND"))
        self.assertEqual(running.post("Pixelize", wrong)[0], 400)
        status, _, answer = running.post("Pixelize", {**DRAWING, "shape": 3})
        self.assertEqual((status, "shape" in answer["message"]), (400, True), answer)
        status, _, answer = running.post("Voxelize", {}, {"Content-Type": "application/json"})
        self.assertIn("call UploadMesh and VoxelizeStored", answer["message"])

    def test_token_and_trace_are_passed_on(self):
        (self.dir / "tokens").write_text("alice 0123456789abcdef\n")
        token, trace = {"authorization": "Bearer 0123456789abcdef"}, "0af7651916cd43dd8448eb211c80319c"
        with harness.server(self.dir, "--token-file", self.dir / "tokens") as server, gateway(
            self.dir, server.address
        ) as running:
            for told in running.by_all("Pixelize", DRAWING):
                self.assertEqual((told["code"], self.detail(told)["reason"]), ("Unauthenticated", "UNAUTHENTICATED"))
            for told in running.by_all(
                "Pixelize", DRAWING, headers={**token, "traceparent": f"00-{trace}-b7ad6b7169203331-01"}
            ):
                self.assertNotIn("code", told)
                self.assertIn(trace, told["header"]["traceparent"])
            harness.await_log(self.dir, f"caller=alice trace_id={trace}", 3)
            running.await_log(f"trace_id={trace}", 3)
            self.assertEqual(urlopen(running.url + "/readyz"), (200, "serving\n"))
        self.assertNotIn("0123456789abcdef", (self.dir / "gateway.log").read_text())

    def test_a_gateway_with_tls_reaches_a_server_with_tls(self):
        authority = Authority(self.dir, "authority")
        certificate, key = authority.issue("server", "server", "subjectAltName=IP:127.0.0.1")
        with harness.server(self.dir, "--listen", "127.0.0.1:0", "--tls-cert", certificate, "--tls-key", key):
            address = harness.await_log(self.dir, r"event=listening address=(127\.0\.0\.1:\d+)")
            up = ["--upstream-tls", "--upstream-ca", authority.root]
            with gateway(self.dir, address, *up, "--tls-cert", certificate, "--tls-key", key) as running:
                for version in ("--http1.1", "--http2"):
                    words = ["curl", "--silent", "--show-error", version, "--cacert", authority.root]
                    words += ["--write-out", "%{http_version}", "--json", "{}", running.url + SERVICE + "GetLimits"]
                    done = subprocess.run(words, capture_output=True, text=True)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertIn('"maxJobs":', done.stdout)
                    self.assertTrue(
                        done.stdout.endswith({"--http1.1": "}1.1", "--http2": "}2"}[version]), done.stdout[-9:]
                    )

    def test_pages_of_other_origins_may_call_only_by_configuration(self):
        ask = {"Origin": "https://a.example", "Access-Control-Request-Method": "POST"}
        with harness.server(self.dir) as server:
            for allowed, may in (([], False), (["--cors-origin", "https://b.example,https://a.example"], True)):
                with self.subTest(allowed), gateway(self.dir, server.address, *allowed) as running:
                    status, headers = options(running, ask)
                    self.assertEqual(
                        (status, "access-control-allow-origin" in headers), (204, True) if may else (403, False)
                    )
                    self.assertEqual("access-control-max-age: 600\n" in headers, may)
                    _, headers, _ = running.post("GetLimits", {}, {"Origin": "https://a.example"})
                    self.assertEqual("access-control-allow-origin" in headers, may)


def options(running, headers):
    done = subprocess.run(["curl", "--silent", "--include", "--request", "OPTIONS", running.url + SERVICE + "GetLimits",
                           *(word for name, value in headers.items() for word in ("--header", f"{name}: {value}"))],
                          capture_output=True, text=True, check=True)  # fmt: skip
    return int(done.stdout.split()[1]), done.stdout.lower()


def urlopen(url):
    done = subprocess.run(
        ["curl", "--silent", "--write-out", "%{http_code}", url], capture_output=True, text=True, check=True
    )
    return int(done.stdout[-3:]), done.stdout[:-3]


class Streams(Shared):
    OPTIONS = ("--max-calls", 3)

    ENDED = (
        r"time=\S+T(\d+:\d+:\d+\.\d+)Z level=\w+ event=request "
        r".*method=VoxelizeStored .*code=(?:CANCELLED|DEADLINE_EXCEEDED)"
    )

    def setUp(self):
        super().setUp()
        self.upload(self.running)
        self.before = len(re.findall(self.ENDED, (self.place / "latvoxd.log").read_text()))

    def await_ended(self, count):
        """Waits until so many calls of this test have ended early, by latvoxd's log. Returns the last one's time."""
        hours, minutes, seconds = map(float, harness.await_log(self.place, self.ENDED, self.before + count).split(":"))
        return 3600 * hours + 60 * minutes + seconds

    def test_a_caller_that_leaves_ends_the_job_within_50_ms(self):
        least = 1
        for n in range(1, 11):  # other tests may have the processors for a while
            connection = self.stalled(self.running)
            time.sleep(0.3)
            before = time.time() % 86400  # by the same clock as the log
            connection.close()
            least = min(least, (self.await_ended(n) - before) % 86400)
            if least < 0.05:
                break
        self.assertLess(least, 0.05)
        self.running.await_log("method=VoxelizeStored .*code=CANCELLED")

    def test_a_slow_reader_takes_little_memory_and_others_go_on(self):
        connections = [self.stalled(self.running) for _ in range(3)]
        status, _, answer = self.running.post("GetLimits", {})
        self.assertEqual(
            (status, self.detail(answer)["reason"], self.detail(answer)["metadata"]["limit"]),
            (429, "TOO_MANY_JOBS", "3"),
        )
        self.detail(answer, "RetryInfo")
        connections[0].close()
        self.await_ended(1)
        time.sleep(2)
        self.assertEqual(self.running.post("GetLimits", {})[0], 200)
        self.assertLess(self.running.memory(), 400 << 20)
        for connection in connections[1:]:
            connection.close()
        self.await_ended(3)

    def test_a_deadline_ends_the_job(self):
        for told in self.running.by_all("VoxelizeStored", self.stored(**BIG, verify=True), timeout=300):
            self.assertEqual(told["code"], "DeadlineExceeded")
        self.await_ended(3)


class Limits(GatewayCase):
    def test_bodies_are_bounded(self):
        with harness.server(self.dir) as server, gateway(self.dir, server.address, "--max-body", "10KiB") as running:
            for more in ({}, {"Transfer-Encoding": "chunked"}):
                body = iter([b" " * 20000]) if more else b" " * 20000
                status, _, answer = running.post("Pixelize", None, more, body)
                self.assertEqual((status, self.detail(answer)["reason"]), (429, "LIMIT_EXCEEDED"))
                self.assertEqual(self.detail(answer)["metadata"], {"field": "body", "value": "20000", "limit": "10240"})
            many = {**DRAWING, "polylines": [{"xy": [0, 1] * 9000}]}
            for told in running.by_all("Pixelize", many):
                self.assertEqual((told["code"], self.detail(told)["reason"]), ("ResourceExhausted", "LIMIT_EXCEEDED"))

    def test_a_caller_that_does_not_read_the_end_is_dropped(self):
        spec = {**BCC, "resolution": 1000, "supercover": {}, "rawMesh": self.about}
        body = json.dumps({"spec": spec, "mesh": text(self.data)}).encode()
        head = f"POST {SERVICE}VoxelizeSmall HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\n"
        options = ["--stall-timeout", "0.2", "--metrics-listen", "127.0.0.1:0"]
        with harness.server(self.dir) as server, gateway(self.dir, server.address, *options) as running:
            with socket.socket() as connection:
                connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)  # the answer is larger than buffers
                connection.connect(running.place())
                connection.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
                running.await_log("method=VoxelizeSmall .*code=UNAVAILABLE .*error=\"stall-timeout: ")
            counted = metrics_test.samples(running.metrics())
        self.assertEqual(counted['latvox_gateway_rejections_total{reason="CLIENT_STALLED"}'], 1)

    def test_a_killed_server_ends_its_calls_as_unavailable(self):
        address = f"unix:{self.dir}/latvoxd.socket"
        with open(self.dir / "latvoxd.log", "wb") as log:
            process = subprocess.Popen([harness.BIN / "latvoxd", "--listen", address], stderr=log)
        process.address = address
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        harness.wait_until_healthy(process)
        with gateway(self.dir, address) as running:
            self.upload(running)
            connection = self.stalled(running)
            process.kill()
            end = b""
            while b'"error"' not in end:
                got = connection.recv(1 << 20)
                self.assertTrue(got, end)
                end = (end + got)[-2000:]
            self.assertIn(b'"code":"unavailable","message":"upstream: there is no connection to latvoxd"', end)

    def test_sigterm_lets_running_calls_end(self):
        with harness.server(self.dir) as server, gateway(self.dir, server.address, "--grace", 60) as running:
            self.upload(running)
            connection = self.stalled(running, resolution=1500)
            running.process.send_signal(signal.SIGTERM)
            running.await_log("event=stopping reason=SIGTERM calls=1 ")
            end = b""
            while got := connection.recv(1 << 20):
                end = (end + got)[-2000:]
            self.assertIn(b'"summary":{', end)
            self.assertEqual(running.process.wait(harness.PATIENCE), 0)

    def test_a_server_that_is_away_is_said_to_be_and_found_again(self):
        address = f"unix:{self.dir}/latvoxd.socket"
        with gateway(self.dir, address) as running:
            status, _, answer = running.post("GetLimits", {})
            self.assertEqual(
                (status, answer["code"], self.detail(answer)["metadata"]), (503, "unavailable", {"field": "upstream"})
            )
            self.assertEqual(urlopen(running.url + "/readyz")[0], 503)
            self.assertEqual(urlopen(running.url + "/healthz"), (200, "serving\n"))
            with harness.server(self.dir):
                self.assertEqual(running.post("GetLimits", {})[0], 200)


class Installed(Case):
    def test_an_installed_gateway_has_all_files_of_its_page(self):
        subprocess.run([GATEWAY / "install", self.dir], check=True)
        program = self.dir / "deploy/gateway/main.js"
        with gateway(self.dir, f"unix:{self.dir}/none", program=program) as running:
            names = ["", "viewer.html"]
            for name in names:
                status, text = urlopen(f"{running.url}/{name}")
                self.assertEqual(status, 200, name)
                quoted = re.findall(
                    r"""(?:src|href|from|import\()[=(\s]*["']\.?/?([\w./]+\.(?:js|css|html))["']""", text
                )
                names += [each for each in quoted if each not in names and "/" not in name]
            self.assertGreater(len(names), 20, names)
            for name in ("STLLoader", "OBJLoader", "PLYLoader", "GLTFLoader"):
                self.assertEqual(urlopen(f"{running.url}/three/loaders/{name}.js")[0], 200)
        self.assertLess(sum(path.stat().st_size for path in self.dir.rglob("*") if path.is_file()), 8 << 20)


class Options(Case):
    def test_wrong_options_are_named(self):
        file, large = (self.dir / name for name in ("gateway.toml", "large"))
        large.write_text("#" * (1 << 20) + "\n")
        for words, message in (
            (["--max-calls", "0"], "--max-calls: 0 is not between 1 and 100000"),
            (
                ["--listen", "0.0.0.0:80"],
                "--listen: 0.0.0.0 reaches other machines; give --tls-cert and --tls-key, or --insecure",
            ),
            (["--tls-cert", "a.pem"], "--tls-cert needs --tls-key"),
            (["--tls-cert", "a.pem", "--tls-key", "b.pem"], "a.pem: it cannot be read: ENOENT"),
            (["--tls-cert", large, "--tls-key", large], f"{large}: it has 1048577 bytes, more than 1048576"),
            (["--config", file], f"--config: {file}: it cannot be read: ENOENT"),
            (["--config", large], f"--config: {large}: it has 1048577 bytes, more than 1048576"),
            (["--config", self.dir], f"--config: {self.dir}: it is no regular file"),
        ):
            words = ["node", GATEWAY / "main.js", "--protocol", protocol(self.dir), *words]
            done = subprocess.run(words, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (2, f"latvox-gateway: {message}\n"))

    def test_wrong_lines_of_a_configuration_file_are_named(self):
        file = self.dir / "gateway.toml"
        kinds = "is no text, number, true or false, nor a list of them"
        for text, message in (
            ("max-calls = 0", ": max-calls: 0 is not between 1 and 100000"),
            ("max-cals = 1", ': unknown key "max-cals"'),
            ("max-calls = {a = 1}", f': max-calls: {{"a":1}} {kinds}'),
            ("insecure = [[true]]", f": insecure: [[true]] {kinds}"),
            ("grace = 2026-11-28", f": grace: 2026-11-28 {kinds}"),
            ("insecure = 1", ': insecure: "1" is not one of true, false'),
            ("\nmax-calls = = 1", ":2: Invalid TOML document: invalid value"),
        ):
            file.write_text(text)
            done = subprocess.run(["node", GATEWAY / "main.js", "--config", file], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (2, f"latvox-gateway: {file}{message}\n"))


if __name__ == "__main__":
    unittest.main()
