"""Starts deploy/compose.yaml: jobs through its balancer, a server killed under load, and Prometheus, which sees all of
it."""

import json
import os
import re
import signal
import subprocess
import sys
import time
import unittest

import yaml

import containers
from containers import IMAGE, ROOT, await_true, inspect, podman, run
from harness import BIN, BUNNY, Case, latvox

# haproxy and Prometheus from Debian; no registry is needed.
HAPROXY, PROMETHEUS = "localhost/latvox-test-haproxy", "localhost/latvox-test-prometheus"
FILE = ROOT / "deploy/compose.yaml"
SERVICES = ("latvoxd-1", "latvoxd-2", "haproxy", "prometheus")
JOBS = [
    ["--lattice", "bcc", "--resolution", "4000"],
    ["--lattice", "cartesian", "--resolution", "4000"],
    ["--lattice", "fcc", "--resolution", "3000"],
    ["--lattice", "hexagonal", "--resolution", "3000"],
]
PATIENCE = 300  # seconds: four such jobs share two cores with everything else
QUERY = """
import sys, urllib.parse, urllib.request
url = "http://127.0.0.1:9090/api/v1/" + sys.argv[1]
print(urllib.request.urlopen(url, timeout=10).read().decode())
"""


class Stack(Case):
    """A network, and images for all services, as `environment` names them."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        containers.debian(HAPROXY, "--include=haproxy", change=["USER haproxy"])
        containers.debian(
            PROMETHEUS,
            "--include=prometheus,wget",
            '--customize-hook=install --directory --owner=65534 --group=65534 "$1/prometheus"',
            change=["USER 65534", 'ENTRYPOINT ["/usr/bin/prometheus"]'],
        )

    def setUp(self):
        super().setUp()
        self.inside = self.enterContext(containers.network_namespace())
        self.environment = os.environ | {"HAPROXY_IMAGE": HAPROXY, "PROMETHEUS_IMAGE": PROMETHEUS}


class Compose(Stack):
    def setUp(self):
        super().setUp()
        self.project = self.inside[1].rpartition("-")[2]
        os.chown(self.dir, 1234, 1234)
        self.environment |= {
            "LATVOX_IMAGE": IMAGE,
            "LATVOX_CPUS": "1",
            "LATVOX_MEMORY": "1g",
            "LATVOX_DATA": str(self.dir),
            "LATVOX_USER": "1234:1234",
        }

    def compose(self, *arguments):
        command = [*self.inside, "podman-compose", "--file", FILE, "--project-name", self.project, *arguments]
        return run(*command, env=self.environment, timeout=PATIENCE).stdout

    def bring_up(self):
        self.addCleanup(self.take_down)
        self.compose("up", "--detach", "--no-build", "haproxy", "prometheus")
        for service in SERVICES:
            await_true(f"{service} does not become healthy: {self.logs(service)}", lambda s=service: self.is_healthy(s))
        health = [*self.inside, BIN / "latvox", "health", "--server", "127.0.0.1:50151"]
        await_true("the balancer has no server", lambda: run(*health, check=False).returncode == 0)

    def take_down(self):
        self.compose("down", "--timeout", "40", "--volumes")
        for network in ("servers", "outside"):
            podman("network", "rm", "--force", self.name(network))

    def name(self, what):
        return f"{self.project}_{what}"

    def container(self, service):
        return self.name(service) + "_1"

    def logs(self, service):
        done = run("podman", "logs", "--tail", "20", self.container(service))
        return done.stdout + done.stderr

    def is_healthy(self, service):
        return run(*self.inside, "podman", "healthcheck", "run", self.container(service), check=False).returncode == 0

    def prometheus(self, path):
        answer = json.loads(run(*self.inside, "/usr/bin/python3", "-c", QUERY, path).stdout)
        self.assertEqual(answer["status"], "success")
        return answer["data"]

    def up(self):
        """Returns the targets that Prometheus could scrape: instance -> up."""
        result = self.prometheus("query?query=up")["result"]
        return {sample["metric"]["instance"]: sample["value"][1] for sample in result}

    def begin(self, n):
        command = [BIN / "latvox", "voxelize", BUNNY, "-o", self.dir / f"{n}.png", *JOBS[n], "--json"]
        client = subprocess.Popen(
            [*self.inside, *map(str, command), "--server", "127.0.0.1:50151", "--retries", "100"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        for cleanup in (client.stdout.close, client.stderr.close, client.wait, client.kill):
            self.addCleanup(cleanup)
        return client

    def finish(self, client):
        out, err = client.communicate(timeout=PATIENCE)
        self.assertEqual(client.returncode, 0, err)
        return json.loads(out)

    def digests(self):
        """Returns the digests of JOBS, computed without any server of the compose file."""
        found = []
        for options in JOBS:
            done = latvox("voxelize", BUNNY, "-o", self.dir / "expected.png", *options, "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            found.append(json.loads(done.stdout)["digest"])
        return found

    def running(self, service):
        """Returns the process of a service's container; 0: none."""
        return inspect(self.container(service))["State"]["Pid"]

    def jobs_running(self, pid):
        """Returns the number of jobs that the server of this process reports: at work, or waiting for their clients."""
        ask = "import urllib.request as r; print(r.urlopen('http://127.0.0.1:9464/metrics').read().decode())"
        metrics = run("nsenter", f"--net=/proc/{pid}/ns/net", sys.executable, "-c", ask).stdout
        return sum(map(int, re.findall(r"^latvox_jobs_(?:running|paused) (\d+)", metrics, re.MULTILINE)))

    def test_the_file_is_valid(self):
        run("docker-compose", "--file", FILE, "config", "--quiet")
        run("docker-compose", "--file", FILE, "config", "--quiet", env=self.environment)

    def test_its_image_is_built_once_and_processes_are_limited(self):
        services = yaml.safe_load(FILE.read_text())["services"]
        long_running = [service for service in services.values() if "restart" in service]
        self.assertEqual([name for name, service in services.items() if "restart" in service], [*SERVICES, "gateway"])
        self.assertTrue(all(service["pids_limit"] > 0 for service in long_running))  # podman-compose ignores it
        self.assertEqual([name for name, service in services.items() if "build" in service], ["latvoxd-1", "gateway"])

    def test_it_comes_up_and_does_the_example(self):
        self.bring_up()
        (self.dir / "mesh.obj").write_bytes(BUNNY.read_bytes())
        self.compose("run", "--rm", "--no-deps", "-T", "job")
        self.assertEqual((self.dir / "mesh.vdb").stat().st_uid, 1234)
        through = latvox("info", self.dir / "mesh.vdb")
        direct = self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", "256", "--upload", "draco", out="direct.vdb")
        self.assertIn(str(direct["voxels"]), through.stdout.replace(",", ""))
        everything = {"latvoxd-1:9464": "1", "latvoxd-2:9464": "1", "haproxy:8405": "1"}
        await_true("Prometheus does not see all", lambda: self.up() == everything)
        groups = self.prometheus("rules")["groups"]
        self.assertIn("LatvoxDown", [rule["name"] for group in groups for rule in group["rules"]])
        for service in SERVICES:
            with self.subTest(service):
                host = inspect(self.container(service))["HostConfig"]
                self.assertTrue(host["ReadonlyRootfs"])
                self.assertIn("no-new-privileges", host["SecurityOpt"])
                self.assertEqual(inspect(self.container(service))["EffectiveCaps"] or [], [])
                self.assertGreater(host["Memory"], 0)
        host = inspect(self.container("latvoxd-1"))["HostConfig"]
        self.assertEqual((host["Memory"], host["NanoCpus"]), (1 << 30, 10**9))

    def test_a_server_killed_under_load_loses_nothing(self):
        self.bring_up()
        clients = [self.begin(n) for n in range(len(JOBS))]
        killed = self.running("latvoxd-1")
        await_true("it has no job", lambda: self.jobs_running(killed) > 0)
        self.assertTrue(all(client.poll() is None for client in clients), "a job has ended already")
        os.kill(killed, signal.SIGKILL)
        started = time.monotonic()
        await_true("it is not started again", lambda: self.running("latvoxd-1") not in (0, killed))
        print(f"compose: a killed server is there again after {time.monotonic() - started:.1f} s")
        summaries = [self.finish(client) for client in clients]
        self.assertEqual([summary["digest"] for summary in summaries], self.digests())
        self.assertGreater(sum(summary["resumed"] for summary in summaries), 0)
        await_true("it is not healthy again", lambda: self.is_healthy("latvoxd-1"))


if __name__ == "__main__":
    containers.require("podman-compose", "docker-compose")
    unittest.main()
