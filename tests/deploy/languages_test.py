"""The programs in client/examples/languages print the same line, and client/docs/languages.md shows them as they are.

e2e/sdk_test.py has the one in C++. Go, Java and Rust run if LATVOX_LANGUAGES is set: `tests/run --languages` installs
them. Nothing runs the one in C#.
"""

import os
import re
import shutil
import subprocess
import unittest

import debian_root
from gateway import ROOT, Gateway  # it adds the folder of harness to the path

import harness  # noqa: E402  isort: skip

PROGRAMS = ROOT / "client/examples/languages"
PAGE = ROOT / "client/docs/languages.md"
PROTO = ["protoc", "-I", ROOT / "proto", "latvox/v1/voxelizer.proto"]
# Debian 12 and 13 lack Rust's gRPC library; their successors have it.
RUST_PACKAGES = ["cargo", "protobuf-compiler", "librust-tonic-dev", "librust-tonic-build-dev", "librust-tokio-dev"]
RUST_ARCHIVE = debian_root.STATE / "rust.tar"
CRATES = """[source.crates-io]
replace-with = "debian"
[source.debian]
directory = "/usr/share/cargo/registry"
"""
HEAVY = unittest.skipUnless(os.environ.get("LATVOX_LANGUAGES"), "tests/run --languages runs it")


class Languages(harness.Case):
    def setUp(self):
        super().setUp()
        self.server = self.enterContext(harness.server(self.dir, "--listen", "127.0.0.1:0"))
        self.address = re.search(r"127\.0\.0\.1:[1-9]\d*", (self.dir / "latvoxd.log").read_text())[0]
        corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        lines = ["v {} {} {}\n".format(*corner) for corner in corners]
        lines += ["f {} {} {}\n".format(*(vertex + 1 for vertex in face)) for face in faces]
        (self.dir / "tetrahedron.obj").write_text("".join(lines))
        summary = self.voxelize(self.dir / "tetrahedron.obj", "--lattice", "bcc", "--resolution", 32)
        self.expected = f"{summary['voxels']} voxels, digest {summary['digest']}\n"

    def gateway(self):
        gateway = Gateway(self.dir, self.server.address)
        self.addCleanup(gateway.stop)
        return gateway

    def run_command(self, *words, patience=harness.PATIENCE, **environment):
        """Returns what a command prints; it must succeed."""
        done = subprocess.run([*map(str, words)], capture_output=True, text=True, timeout=patience, cwd=self.dir,
                              env=os.environ | environment)  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_python(self):
        self.run_command(*PROTO, f"--python_out={self.dir}")
        said = self.run_command("/usr/bin/python3", "-B", PROGRAMS / "tetrahedron.py", self.address, PYTHONPATH=str(self.dir))
        self.assertEqual(said, self.expected)

    def test_the_python_package(self):
        package = harness.BIN.parent / "client/python"
        if not (package / "latvox").is_dir():
            self.skipTest("the Python package is not built")
        program = PROGRAMS / "tetrahedron_package.py"
        said = self.run_command("/usr/bin/python3", "-B", program, self.address, PYTHONPATH=str(package))
        self.assertEqual(said, self.expected)

    def test_node(self):
        (self.dir / "node_modules").symlink_to(harness.NODE / "node_modules")
        shutil.copy(PROGRAMS / "tetrahedron.mjs", self.dir)
        said = self.run_command("node", "tetrahedron.mjs", self.address, ROOT / "proto")
        self.assertEqual(said, self.expected)

    def test_curl(self):
        said = self.run_command(PROGRAMS / "tetrahedron.sh", self.gateway().address)
        self.assertEqual(said, self.expected)

    @HEAVY
    def test_go(self):
        folder = self.dir / "src"
        folder.mkdir()
        name = "Mlatvox/v1/voxelizer.proto=example/latvoxv1"
        outputs = [f"--go_out={folder}", f"--go_opt={name}", f"--go-grpc_out={folder}", f"--go-grpc_opt={name}"]
        self.run_command(*PROTO, *outputs)
        go = {"GO111MODULE": "off", "GOCACHE": str(self.dir / "cache"), "GOPATH": f"{self.dir}:/usr/share/gocode", "GOFLAGS": ""}
        files = [PROGRAMS / "tetrahedron.go", ROOT / "tests/deploy/languages_codec.go"]
        for file in files:
            shutil.copy(file, self.dir)  # go builds the files of one folder
        names = [file.name for file in files]
        self.run_command("go", "build", "-o", self.dir / "tetrahedron", *names, patience=600, **go)
        self.assertEqual(self.run_command(self.dir / "tetrahedron", self.address), self.expected)

    @HEAVY
    def test_java(self):
        plugin = f"--plugin=protoc-gen-grpc-java={shutil.which('grpc_java_plugin')}"
        self.run_command(*PROTO, f"--java_out={self.dir}", plugin, f"--grpc-java_out={self.dir}")
        sources = [*(self.dir / "latvox/v1").glob("*.java"), PROGRAMS / "Tetrahedron.java"]
        jars, classes = "/usr/share/java/*", self.dir / "classes"
        self.run_command("javac", "-nowarn", "-cp", jars, "-d", classes, *sources, patience=600)
        said = self.run_command("java", "-cp", f"{classes}:{jars}", "Tetrahedron", self.address)
        self.assertEqual(said, self.expected)

    @HEAVY
    def test_rust(self):
        if os.geteuid() != 0:
            self.skipTest("a system with Rust's gRPC library needs root")
        archive = debian_root.archive(RUST_ARCHIVE, f"--include={','.join(RUST_PACKAGES)}", release="sid")
        root = debian_root.Root(self.dir / "debian", archive)
        folder = root.path / PROGRAMS.relative_to("/")
        shutil.copytree(PROGRAMS, folder)
        shutil.copytree(ROOT / "proto", root.path / (ROOT / "proto").relative_to("/"))
        (folder / ".cargo").mkdir()
        (folder / ".cargo/config.toml").write_text(CRATES)
        build = f"export CARGO_HOME=/tmp/cargo; cd {PROGRAMS}; cargo run --quiet --offline -- {self.address}"
        self.assertEqual(root.shell(build, timeout=600).stdout, self.expected)

    def test_the_page_shows_the_programs_as_they_are(self):
        blocks = re.findall(r"^```\w*\n(.*?)^```$", PAGE.read_text(), re.M | re.S)
        for program in sorted(PROGRAMS.iterdir()):
            with self.subTest(program.name):
                self.assertIn(program.read_text(), blocks)
        self.assertIn(self.expected, blocks)

    def test_the_requests_for_grpcurl_work(self):
        # Debian has no grpcurl. The gateway reads the same JSON.
        commands = re.findall(r"^grpcurl (.*?)([\w.]+/\w+)(?: <(\S+))?$", PAGE.read_text(), re.M)
        self.assertEqual(len(commands), 4)
        running = self.gateway()
        wanted = {"Check": "SERVING", "GetLimits": "maxMessageBytes", "VoxelizeSmall": self.expected.split()[-1]}
        for options, method, path in commands:
            with self.subTest(method):
                body = (PROGRAMS / path).read_text() if path else "{}"
                self.assertEqual("-d @" in options, bool(path))
                answer = self.run_command("curl", "--silent", "--fail-with-body", "--json", body, f"{running.url}/{method}")
                self.assertIn(wanted[method.partition("/")[2]], answer)


if __name__ == "__main__":
    unittest.main()
