"""The image under the limits of deploy/docs/image.md: the same digests as without it, a drain at SIGTERM, streams that
resume after kill -9."""

import json
import os
import signal
import subprocess
import time
import unittest

import containers
from containers import IMAGE, Container, await_true, podman, run
from harness import BIN, BUNNY, PATIENCE, Case, latvox

SERVER = "127.0.0.1:50151"
CONFINED = ["--read-only", "--cap-drop=all", "--security-opt=no-new-privileges"]
LIMITED = [*CONFINED, "--memory=512m", "--cpus=1", "--pids-limit=64"]
SHORT = ["--lattice", "bcc", "--resolution", "256"]
LONG = ["--lattice", "bcc", "--resolution", "3000", "--fields", "normal"]  # the stream takes seconds


class Image(Case):
    def setUp(self):
        super().setUp()
        self.inside = self.enterContext(containers.network_namespace())

    def start(self, *arguments, image_options=("--insecure", "--threads", "1")):
        """Starts a server in the test's network, under limits."""
        server = Container("--network=host", *LIMITED, *arguments, IMAGE, *image_options, prefix=self.inside)
        self.addCleanup(server.remove)
        self.await_healthy(server)
        return server

    def await_healthy(self, server):
        await_true("the server does not become healthy", lambda: self.client("health").returncode == 0)
        self.assertTrue(server.state()["Running"], server.logs())

    def client(self, command, *arguments):
        return run(*self.inside, BIN / "latvox", command, *arguments, "--server", SERVER, check=False)

    def metric(self, name):
        return float(run(*self.inside, "/usr/bin/python3", "-c", FETCH, name).stdout)

    def begin(self, *arguments):
        """Starts a client, and returns it in the middle of its long stream."""
        command = [*self.inside, BIN / "latvox", "voxelize", BUNNY, "-o", self.dir / "out.png", *LONG, "--json"]
        client = subprocess.Popen(
            [*map(str, command), "--server", SERVER, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        for cleanup in (client.stdout.close, client.stderr.close, client.wait, client.kill):
            self.addCleanup(cleanup)
        await_true("no job is at work", lambda: self.metric("latvox_jobs_running") > 0)
        time.sleep(1)  # into the stream
        self.assertIsNone(client.poll(), "the long job has ended already")
        return client

    def finish(self, client):
        out, err = client.communicate(timeout=4 * PATIENCE)
        self.assertEqual(client.returncode, 0, err)
        return json.loads(out)

    def expected(self, options):
        done = latvox("voxelize", BUNNY, "-o", self.dir / "expected.png", *options, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["digest"]

    def test_a_job_under_limits_is_the_same_job(self):
        server = self.start()
        done = self.client("voxelize", BUNNY, "-o", self.dir / "out.vdb", *SHORT, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["digest"], self.expected(SHORT))
        self.assertEqual(podman("top", server.id, "pid", "huser").splitlines()[1].split(), ["1", "65532"])
        self.assertNotIn("unconfined", server.logs())

    def test_memory_budget_and_threads_are_the_containers(self):
        self.start(image_options=("--insecure", "--metrics-listen", "127.0.0.1:9464"))
        self.assertEqual(self.metric("latvox_decoder_processes"), 2)  # always two; one core is allowed
        limits = json.loads(self.client("limits", "--json").stdout)
        # Three quarters of 512 MiB, less the memory that is not for jobs; see server/listen/shares.cc.
        self.assertEqual(limits["memory_budget_bytes"], (384 - 128 - 48 - 48) << 20)

    def test_plain_text_for_others_has_to_be_asked_for(self):
        done = run("podman", "run", "--rm", "--network=none", *CONFINED, IMAGE, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("refusing to listen on 0.0.0.0:50151", done.stderr)

    def test_the_tool_finds_the_libraries_that_it_loads_late(self):
        self.dir.chmod(0o777)
        (self.dir / "bunny.obj").write_bytes(BUNNY.read_bytes())
        tool = ["podman", "run", "--rm", "--network=none", *CONFINED, f"--volume={self.dir}:/work", "--workdir=/work"]
        tool += ["--tmpfs=/tmp", "--entrypoint=latvox", IMAGE, "voxelize"]
        run(*tool, "bunny.obj", "-o", "bunny.h5", *SHORT)
        self.assertEqual(json.loads(latvox("info", self.dir / "bunny.h5", "--json").stdout)["metadata"]["latvox_digest"], self.expected(SHORT))
        done = run(*tool, "http://127.0.0.1:1/bunny.obj", "-o", "bunny.csv", *SHORT, check=False)
        self.assertIn("http://127.0.0.1:1/bunny.obj", done.stderr)
        self.assertNotIn("cannot be loaded", done.stderr)

    def test_there_is_no_shell(self):
        done = run("podman", "run", "--rm", "--network=none", *CONFINED, "--entrypoint", "sh", IMAGE, check=False)
        self.assertEqual(done.returncode, 127, done.stderr)

    def test_the_tool_reads_and_writes_what_is_mounted(self):
        (self.dir / "bunny.obj").write_bytes(BUNNY.read_bytes())
        os.chown(self.dir, 1234, 1234)
        output = podman(
            "run", "--rm", "--network=none", *LIMITED, "--tmpfs=/tmp", "--user=1234:1234", f"--volume={self.dir}:/data",
            "--entrypoint=latvox", IMAGE, "voxelize", "bunny.obj", "-o", "bunny.vdb", *SHORT, "--json",
        )  # fmt: skip
        self.assertEqual(json.loads(output)["digest"], self.expected(SHORT))
        self.assertEqual((self.dir / "bunny.vdb").stat().st_uid, 1234)
        self.voxelize(BUNNY, *SHORT, out="local.vdb")
        through, local = (latvox("info", self.dir / name).stdout for name in ("bunny.vdb", "local.vdb"))
        self.assertEqual(through.replace("bunny.vdb", "local.vdb"), local)

    def test_sigterm_drains(self):
        server = self.start(image_options=DRAINING)
        ask = [*self.inside, "podman", "healthcheck", "run", server.id]
        run(*ask)
        client = self.begin()
        run("podman", "kill", "--signal=TERM", server.id)
        await_true("health does not change", lambda: run(*ask, check=False).returncode == 1)
        self.assertTrue(server.state()["Running"], "it did not wait for its job")
        self.assertEqual(self.finish(client)["resumed"], 0)
        self.assertEqual(server.wait(), 0, server.logs())
        self.assertIn("event=stopped", server.logs())

    def test_streams_go_on_after_kill_9(self):
        server = self.start(image_options=DRAINING)
        client = self.begin("--retries", "100")
        os.kill(server.state()["Pid"], signal.SIGKILL)
        self.assertEqual(server.wait(), 128 + signal.SIGKILL)
        server.start()
        summary = self.finish(client)
        self.assertGreaterEqual(summary["resumed"], 1)
        self.assertEqual(summary["digest"], self.expected(LONG))
        podman("stop", "--time", "60", server.id)
        self.assertEqual(server.state()["ExitCode"], 0, server.logs())


DRAINING = ("--insecure", "--threads", "1", "--grace", "120", "--metrics-listen", "127.0.0.1:9464")

FETCH = """
import re, sys, urllib.request
text = urllib.request.urlopen("http://127.0.0.1:9464/metrics", timeout=10).read().decode()
print(re.search(rf"^{sys.argv[1]} (\\S+)", text, re.M)[1])
"""

if __name__ == "__main__":
    containers.require()
    unittest.main()
