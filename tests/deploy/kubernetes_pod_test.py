"""Runs a Pod of each of deploy/kubernetes' overlays by `podman play kube`: it gets everything that the manifests ask
for, and needs no more."""

import hashlib
import json
import pathlib
import unittest

import containers
import yaml
from containers import IMAGE, ROOT, await_true, inspect, podman, run
from harness import BIN, BUNNY, Case, latvox

OVERLAYS = ROOT / "deploy" / "kubernetes" / "overlays"
OPTIONS = ["--lattice", "bcc", "--resolution", "64"]
TOKEN = "0123456789abcdef0123"
HAPROXY = "localhost/latvox-test-haproxy"  # from Debian; no registry is needed


def pod_of(path, kind):
    """Makes the Pod that an object of this kind creates, adapted to this machine's size."""
    made = next(document for document in yaml.safe_load_all(path.read_text()) if document["kind"] == kind)
    template = made["spec"]["template"]
    for container in template["spec"]["containers"]:
        container["image"] = HAPROXY if container["name"] == "haproxy" else IMAGE
        container["resources"] = {"limits": {"cpu": "1", "memory": "1Gi"}}
    for volume in template["spec"]["volumes"]:
        if "secret" in volume:
            volume["secret"]["optional"] = False  # the default; podman 4.3 crashes without it
            if "items" in volume["secret"]:  # podman 4.3 keeps the names of keys
                volume["secret"] = {"secretName": f"latvox-test-{volume['name']}", "optional": False}
    return {"apiVersion": "v1", "kind": "Pod", "metadata": {"name": made["metadata"]["name"]} | template["metadata"], "spec": template["spec"]}


class Pods(Case):
    def setUp(self):
        super().setUp()
        self.inside = self.enterContext(containers.network_namespace())

    def play(self, pod, *others):
        """Plays the Pod, and returns its first container. It uses a file, not standard input, because `--down` needs it,
        too."""
        file = self.dir / "pod.yaml"
        file.write_text("---\n".join(json.dumps(document, indent=1) + "\n" for document in (*others, pod)))
        network = f"{pod['metadata']['name']}-test"
        self.make("network", network)
        self.addCleanup(run, *self.inside, "podman", "play", "kube", "--down", file)
        run(*self.inside, "podman", "play", "kube", f"--network={network}", file)
        return f"{pod['metadata']['name']}-{pod['spec']['containers'][0]['name']}"

    def assert_confined(self, container, memory):
        found = inspect(container)
        self.assertEqual(found["Config"]["User"], "65532:65532")
        self.assertTrue(found["HostConfig"]["ReadonlyRootfs"])
        self.assertEqual((found["EffectiveCaps"], found["BoundingCaps"]), (None, None))
        self.assertIn("no-new-privileges", found["HostConfig"]["SecurityOpt"])
        self.assertEqual(found["HostConfig"]["Memory"], memory)

    def secret(self, name, **data):
        """Makes the Secret as `kubectl create secret` does, but in plain text, because podman 4.3 does not decode
        it."""
        file = self.dir / f"{name}.json"
        file.write_text(json.dumps({"apiVersion": "v1", "kind": "Secret", "metadata": {"name": name}, "data": data}))
        self.make("secret", name, file)
        self.remove_later("volume", name)

    def make(self, kind, name, *options):
        """Also removes the leftovers of a run that was killed."""
        run("podman", kind, "rm", name, check=False)
        podman(kind, "create", name, *options)
        self.remove_later(kind, name)

    def remove_later(self, kind, name):
        self.addCleanup(run, "podman", kind, "rm", name, check=False)

    def test_the_services_pod_serves_with_tls_and_tokens_and_tells_its_health_and_metrics(self):
        if not containers.exists(HAPROXY):
            containers.debian(HAPROXY, "--include=haproxy", change=["USER haproxy", "ENV PATH=/usr/sbin:/usr/bin"])
        certificate, key, token = (self.dir / name for name in ("certificate.pem", "key.pem", "alice.token"))
        request = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost"]
        run(*request, "-addext", "subjectAltName=DNS:localhost", "-keyout", key, "-out", certificate)
        token.write_text(TOKEN)
        token.chmod(0o600)
        self.secret("latvox-test-tls", **{"server.pem": certificate.read_text(), "server.pem.key": key.read_text()})
        self.secret("latvox-tokens", tokens=f"alice sha256:{hashlib.sha256(TOKEN.encode()).hexdigest()}\n")
        self.remove_later("volume", "latvoxd")
        self.remove_later("volume", "haproxy")
        files = {"latvoxd": "latvoxd.toml", "haproxy": "haproxy.cfg"}
        configurations = [
            {"apiVersion": "v1", "kind": "ConfigMap", "metadata": {"name": name}, "data": {file: (OVERLAYS / "service" / file).read_text()}}
            for name, file in files.items()
        ]
        container = self.play(pod_of(OVERLAYS / "service" / "deployment.yaml", "Deployment"), *configurations)

        def client(*words):
            return run(*self.inside, BIN / "latvox", *words, check=False)

        health = ["health", "--server", "127.0.0.1:50152"]
        await_true(podman("logs", container), lambda: client(*health).returncode == 0)
        self.assert_confined(container, 1 << 30)
        ask = ["voxelize", BUNNY, *OPTIONS, "-o", self.dir / "bunny.vdb", "--server", "localhost:50151", "--tls-ca", certificate]
        done = client(*ask)
        self.assertEqual(done.returncode, 5, f"without a token: {done.stderr}{run('podman', 'logs', 'latvox-haproxy').stderr}")
        done = client(*ask, "--token-file", token, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["digest"], self.expected())
        metrics = run(*self.inside, "/usr/bin/python3", "-c", FETCH_METRICS).stdout
        self.assertIn("latvox_requests_total", metrics)
        podman("stop", "--time", "60", container)
        self.assertEqual(inspect(container)["State"]["ExitCode"], 0, podman("logs", container))

    def expected(self):
        done = latvox("voxelize", BUNNY, *OPTIONS, "-o", self.dir / "expected.vdb", "--json")
        return json.loads(done.stdout)["digest"]

    def volume(self, name):
        self.make("volume", name)
        folder = pathlib.Path(podman("volume", "inspect", name, "--format", "{{.Mountpoint}}"))
        folder.chmod(0o777)  # as fsGroup does on Kubernetes
        return folder

    def test_a_worker_of_the_batch_farm_does_its_jobs(self):
        meshes, results = self.volume("latvox-meshes"), self.volume("latvox-results")
        (meshes / "bunny.obj").write_bytes(BUNNY.read_bytes())
        jobs = [{"mesh": "bunny.obj", "out": f"{n}.vdb", "lattice": "bcc", "resolution": 64} for n in range(4)]
        (meshes / "jobs.jsonl").write_text("".join(json.dumps(job) + "\n" for job in jobs))
        pod = pod_of(OVERLAYS / "batch" / "job.yaml", "Job")
        environment = pod["spec"]["containers"][0]["env"]
        self.assertEqual([variable["name"] for variable in environment], ["LATVOX_WORKER_COUNT"])
        environment[0]["value"] = "2"  # as kustomize does
        environment.append({"name": "JOB_COMPLETION_INDEX", "value": "1"})  # as the Job's controller does
        container = self.play(pod)
        status = int(podman("wait", container))
        self.assertEqual(status, 0, podman("logs", container))
        self.assert_confined(container, 1 << 30)
        lines = [json.loads(line) for line in (results / "results-1-of-2.jsonl").read_text().splitlines()]
        self.assertEqual({line["id"]: line["summary"]["digest"] for line in lines}, dict.fromkeys(("1.vdb", "3.vdb"), self.expected()))
        self.assertEqual({path.name for path in results.glob("*.vdb")}, {"1.vdb", "3.vdb"})


FETCH_METRICS = """
import urllib.request
print(urllib.request.urlopen("http://127.0.0.1:9464/metrics", timeout=10).read().decode())
"""

if __name__ == "__main__":
    containers.require("openssl")
    if not containers.exists(IMAGE):
        containers.skip(f"there is no image {IMAGE}: the test deploy.image_build makes it")
    unittest.main()
