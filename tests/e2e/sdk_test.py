"""The installed SDK: find_package(latvox) finds it, client/examples build against it alone, and work as they say."""

import collections
import contextlib
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import harness
from harness import BIN, BUNNY, encode_drc, latvox, server
from tls_test import TlsCase

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = BIN.parent
PRIVATE = os.environ | {"LATVOX_LATVOXD": str(BIN / "latvoxd")}


def run(*words, **options):
    done = subprocess.run([*map(str, words)], capture_output=True, text=True, timeout=300, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}: {done.stdout}{done.stderr}")
    return done.stdout


def children(pid):
    """Returns the numbers of the processes that the threads of this process started."""
    return [int(word) for file in pathlib.Path(f"/proc/{pid}/task").glob("*/children") for word in file.read_text().split()]


def is_latvoxd(pid):
    with contextlib.suppress(OSError):
        return pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().startswith(str(BIN / "latvoxd").encode())
    return False


class Sdk(TlsCase):
    @classmethod
    def setUpClass(cls):
        cls.sdk = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="latvox-sdk-")))
        cls.include = cls.sdk / "prefix/include"
        run("cmake", "--install", BUILD, "--prefix", cls.sdk / "prefix")
        cls.doc = cls.sdk / "prefix/share/doc/latvox"
        source = cls.doc / "examples"
        cached = os.environ | {"CCACHE_BASEDIR": str(cls.sdk), "CCACHE_NOHASHDIR": "1"}
        said = run("cmake", "-S", source, "-B", cls.sdk / "build", f"-DCMAKE_PREFIX_PATH={cls.sdk / 'prefix'}", "-G", "Ninja",
            "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        assert not re.search("OpenVDB|Imath", said), said
        run("cmake", "--build", cls.sdk / "build", env=cached)

    def setUp(self):
        super().setUp()
        self.mesh = self.dir / "bunny.drc"  # as a new user builds it
        self.assertEqual(latvox("encode", BUNNY, "-o", self.mesh).returncode, 0)

    def example(self, name, *arguments):
        words = [self.sdk / "build" / name, *map(str, arguments)]
        return subprocess.run(words, capture_output=True, text=True, timeout=harness.PATIENCE)

    def output(self, *words):
        done = self.example(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_headers_need_neither_grpc_nor_protobuf_nor_each_other(self):
        headers = sorted(path.relative_to(self.include) for path in self.include.rglob("*.h"))
        headers.remove(pathlib.Path("latvox/grid/openvdb_grid.h"))  # for programs that have OpenVDB's headers
        self.assertIn(pathlib.Path("latvox/client.h"), headers)
        compiler = ["g++", "-std=c++20", "-Wall", "-Wextra", "-Werror", f"-I{self.include}", "-xc++"]
        everything = "".join(f'#include "{header}"\n' for header in headers)
        self.assertNotRegex(run(*compiler, "-M", "-", input=everything), "/grpc|google/protobuf|latvox/v1|/openvdb/")
        for header in headers:
            with self.subTest(header):
                run(*compiler, "-fsyntax-only", self.include / header)

    def test_pages_lead_to_installed_files(self):
        pages = sorted(self.doc.glob("*.md"))
        self.assertLess({"sdk.md", "tutorial.md", "protocol.md"}, {page.name for page in pages})
        links = 0
        for page in pages:
            text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.M | re.S)
            for link in re.findall(r"\]\(([^)#:]+)(?:#[\w-]*)?\)", text):
                links += 1
                with self.subTest(page=page.name, link=link):
                    self.assertTrue((page.parent / link).exists())
        self.assertGreater(links, 50)

    def test_the_protocol_is_installed_as_it_is_imported(self):
        proto = self.sdk / "prefix/share/latvox/proto"
        run("protoc", "-I", proto, f"--descriptor_set_out={self.dir / 'protocol.bin'}", "latvox/v1/voxelizer.proto",
            "google/rpc/status.proto", "google/rpc/error_details.proto")
        self.assertEqual((proto / "latvox/v1/voxelizer.proto").read_text(), (ROOT / "proto/latvox/v1/voxelizer.proto").read_text())

    def test_examples_find_what_the_tool_finds(self):
        with server(self.dir) as latvoxd:
            def whole(*options):
                return self.voxelize(self.mesh, "--resolution", 200, "--server", latvoxd.address, *options)

            with self.subTest("hello"):
                found = re.fullmatch(r"(\d+) voxels in (\d+) bricks, digest (\w+)\n",
                                     self.output("hello", latvoxd.address, self.mesh, 200))
                summary = whole("--lattice", "bcc")
                expected = (str(summary["voxels"]), str(summary["bricks"]), summary["digest"])
                self.assertEqual(found.groups(), expected)
            with self.subTest("own_mesh"):
                octahedron = harness.write_obj(self.dir / "octahedron.obj", harness.octahedron())
                summary = self.voxelize(octahedron, "--resolution", 90, "--server", latvoxd.address)
                self.assertEqual(self.output("own_mesh", latvoxd.address, 90),
                                 f"{summary['voxels']} voxels, digest {summary['digest']}\n")
            with self.subTest("tetrahedron"):
                page = (ROOT / "client/docs/languages.md").read_text()
                self.assertIn(f"```\n{self.output('tetrahedron', latvoxd.address)}```\n", page)
            with self.subTest("shards"):
                voxels = whole()["voxels"]
                self.assertEqual(self.output("shards", latvoxd.address, self.mesh, 200, 5), f"{voxels} voxels in 5 parts\n")
            with self.subTest("structure"):
                columns = {(i, j) for i, j, k in harness.rows(self.dir / "out.csv")}
                self.assertEqual(self.output("structure", latvoxd.address, self.mesh, 200),
                                 f"{voxels} voxels over {len(columns)} columns\n")
                stopped = re.fullmatch(r"at least (\d+) voxels over \d+ columns\n",
                                       self.output("structure", latvoxd.address, self.mesh, 2000, 10))
                self.assertLess(int(stopped[1]), 50 * voxels, "it has taken all")
            with self.subTest("meshes"):
                box = encode_drc(self.dir / "box.drc", harness.write_obj(self.dir / "box.obj", harness.octahedron()))
                bad = self.dir / "bad.drc"
                bad.write_text("not a mesh")
                done = self.example("meshes", latvoxd.address, 200, 3, self.mesh, bad, box, self.mesh)
                self.assertEqual(done.returncode, 1)
                line = f"{self.mesh}: {voxels} voxels"
                self.assertRegex(done.stdout, rf"^{line}\n{box}: \d+ voxels\n{line}\n$")
                self.assertRegex(done.stderr, rf"^{bad}: INVALID_ARGUMENT: .*\[latvox.field='")
            with self.subTest("to_vdb"):
                summary = whole("--lattice", "fcc", "--separability", 2)
                self.assertEqual(self.output("to_vdb", latvoxd.address, self.mesh, 200, self.dir / "out.vdb"),
                                 f"{summary['voxels']} voxels\n")
                self.assertIn(f"latvox_digest = {summary['digest']}", latvox("info", self.dir / "out.vdb").stdout)
            with self.subTest("a refusal names its field"):
                refused = self.example("hello", latvoxd.address, self.mesh, 70000)
                self.assertEqual(refused.returncode, 1)
                self.assertRegex(refused.stderr, r"^[A-Z_]+: .*\n$")
                for detail in "latvox.field='resolution'", "latvox.value='70000'", "latvox.limit='65536'":
                    self.assertIn(f"[{detail}]", refused.stderr)
            with self.subTest("a mesh that cannot be read is named"):
                empty = self.dir / "empty.drc"
                empty.touch()
                for path, wrong in (empty, "is empty"), (self.dir / "missing.drc", "cannot be opened"):
                    refused = self.example("hello", latvoxd.address, path, 200)
                    self.assertEqual(refused.returncode, 1)
                    self.assertRegex(refused.stderr, rf"^[A-Z_]+: {path}: {wrong}.*\n$")

    def test_a_mesh_file_becomes_voxels_without_a_running_server(self):
        voxels = self.voxelize(self.mesh, "--resolution", 40)["voxels"]  # encoded without loss, like the program's
        words = [self.sdk / "build/mesh_file", BUNNY, "40"]
        done = subprocess.run(words, capture_output=True, text=True, timeout=harness.PATIENCE, env=PRIVATE)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = [tuple(map(int, line.split(","))) for line in done.stdout.splitlines()]
        self.assertEqual(len(found), voxels)
        self.assertEqual(sorted(found), sorted(harness.rows(self.dir / "out.csv")))
        layers = {k: collections.Counter(j for _, j, layer in found if layer == k) for _, _, k in found}
        drawn = [line.count("#") for line in reversed(done.stderr.splitlines()) if "#" in line]
        self.assertIn(drawn, [[count for _, count in sorted(rows.items())] for rows in layers.values()])

    def test_a_private_server_ends_with_a_program_that_is_killed(self):
        program = subprocess.Popen([self.sdk / "build/mesh_file", BUNNY, "5000"], stdout=subprocess.DEVNULL, env=PRIVATE)
        self.addCleanup(program.wait)
        self.addCleanup(program.kill)
        servers = harness.await_true("no server", lambda: [child for child in children(program.pid) if is_latvoxd(child)])
        program.kill()
        harness.await_true("the server goes on", lambda: not any(map(is_latvoxd, servers)))

    def test_a_program_is_tested_without_a_server(self):
        self.assertEqual(self.output("fake_server"), "passed\n")

    def test_resume_goes_on_where_the_server_died(self):
        """Nobody reads the pipe. This blocks the program, and so the server, until the server is dead."""
        with server(self.dir, mortal=True) as mortal:
            words = [self.sdk / "build/resume", mortal.address, self.mesh, "3000"]
            said = self.dir / "said"
            with open(said, "w") as errors:
                program = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=errors, text=True)
            self.addCleanup(program.stdout.close)
            self.addCleanup(program.wait)
            self.addCleanup(program.kill)
            bricks = [program.stdout.readline()]
            mortal.kill()
            mortal.wait()
        with server(self.dir) as latvoxd:
            bricks += program.stdout
            self.assertEqual(program.wait(harness.PATIENCE), 0, said.read_text())
            expected = self.voxelize(self.mesh, "--resolution", 3000, "--server", latvoxd.address, out="out.png")
        self.assertRegex(said.read_text(), r"^goes on at unix:\S+ after: UNAVAILABLE: .*\n"
                               rf"{expected['bricks']} bricks, resumed 1 times, digest {expected['digest']}\n$")
        self.assertEqual(len(set(bricks)), len(bricks), "a brick came twice")
        self.assertEqual(len(bricks), expected["bricks"])

    def test_tls_shows_a_token_and_a_certificate(self):
        token, tokens = self.dir / "token", self.dir / "tokens"
        token.write_text("alice-0123456789\n")
        tokens.write_text("alice alice-0123456789\n")
        tokens.chmod(0o600)
        own = self.authority.issue("alice", "alice")
        with self.server(*self.tls, "--token-file", tokens, "--tls-client-ca", self.authority.root) as latvoxd:
            words = ["tls", latvoxd.tcp, self.mesh, self.authority.root, token]
            self.assertRegex(self.output(*words, *own), r"^\d+ voxels\n$")
            self.assertEqual(self.example(*words).returncode, 1, "without the certificate")
            token.write_text("mallory-0123456789\n")
            refused = self.example(*words, *own)
            self.assertEqual(refused.returncode, 1)
            self.assertIn("UNAUTHENTICATED", refused.stderr)


if __name__ == "__main__":
    unittest.main()
