"""The gateway's image builds, holds its page and its licenses, and answers JSON and pages under limits."""

import json
import pathlib
import re
import signal
import subprocess
import unittest

import containers
from containers import ROOT, Container, await_true, inspect, podman, run
from harness import BIN, Case

IMAGE = "localhost/latvox-gateway"
FILE = "deploy/gateway/Dockerfile"
LARGEST = 400e6  # bytes; Debian and its Node take most of them
GATEWAY = "127.0.0.1:8080"
REQUEST = ROOT / "client/examples/languages/tetrahedron.json"
OPTIONS = ["--insecure", "--upstream", "127.0.0.1:50151"]
LIMITED = ["--read-only", "--cap-drop=all", "--security-opt=no-new-privileges", "--memory=512m", "--pids-limit=64"]


def npm_settings():
    """Writes the certificates by which this machine's npm reaches its registry, and returns the file."""
    path = containers.STATE / "work" / "npmrc"
    file = run("npm", "config", "get", "cafile").stdout.strip()
    found = re.findall(r"-----BEGIN.*?END CERTIFICATE-----", pathlib.Path(file).read_text(), re.S) if file != "null" else []
    path.write_text("".join(f"ca[]={json.dumps(certificate)}\n" for certificate in found))
    return path


class GatewayImage(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        containers.debian(containers.BASE)
        seconds = containers.build(ROOT, IMAGE, f"--secret=id=npmrc,src={npm_settings()}", file=FILE)
        print(f"gateway image: {inspect(IMAGE)['Size'] / 1e6:.1f} MB, built in {seconds:.0f} s")

    def setUp(self):
        super().setUp()
        self.inside = self.enterContext(containers.network_namespace())
        upstream = f"unix:{self.dir}/upstream"
        with open(self.dir / "latvoxd.log", "wb") as log:
            command = [*self.inside, BIN / "latvoxd", "--listen", "127.0.0.1:50151", "--listen", upstream]
            server = subprocess.Popen([*map(str, command)], stdout=log, stderr=log)
        for cleanup in (server.wait, server.terminate):
            self.addCleanup(cleanup)
        await_true("latvoxd does not start", lambda: run(BIN / "latvox", "health", "--server", upstream, check=False).returncode == 0)
        self.gateway = Container("--network=host", *LIMITED, IMAGE, *OPTIONS, prefix=self.inside)
        self.addCleanup(self.gateway.remove)
        await_true("the gateway does not listen", lambda: "event=listening" in self.gateway.logs())

    def curl(self, *words):
        return run(*self.inside, "curl", "--silent", "--fail-with-body", *words).stdout

    def test_it_answers(self):
        answer = self.curl("--json", f"@{REQUEST}", f"http://{GATEWAY}/latvox.v1.Voxelizer/VoxelizeSmall")
        summary = json.loads(answer)["summary"]
        (self.dir / "tetrahedron.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        expected = self.voxelize(self.dir / "tetrahedron.obj", "--lattice", "bcc", "--resolution", 32)
        self.assertEqual(summary["certificate"]["digest"], expected["digest"])
        self.assertIn("latvox", self.curl(f"http://{GATEWAY}/"))

    def test_it_ends_when_asked(self):
        podman("kill", "--signal", str(int(signal.SIGTERM)), self.gateway.id)
        self.assertEqual(self.gateway.wait(), 0, self.gateway.logs())

    def test_it_holds_what_it_says(self):
        self.assertLess(inspect(IMAGE)["Size"], LARGEST)
        config = inspect(IMAGE)["Config"]
        self.assertEqual(config["User"], "65532:65532")
        for path in "LICENSE", "sbom.spdx.json":
            run("podman", "exec", self.gateway.id, "test", "-s", f"/usr/share/doc/latvox/{path}")
        for name in ("npm", "protoc", "gcc"):
            self.assertNotEqual(run("podman", "exec", self.gateway.id, "which", name, check=False).returncode, 0, name)
        packages = json.loads(run("podman", "exec", self.gateway.id, "cat", "/usr/share/doc/latvox/sbom.spdx.json").stdout)
        self.assertIn("@connectrpc/connect-node", {package["name"] for package in packages["packages"]})


if __name__ == "__main__":
    containers.require("curl")
    unittest.main()
