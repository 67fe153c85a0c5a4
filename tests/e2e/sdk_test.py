"""The installed SDK: find_package(latvox) finds it, client/examples build against it alone, and do what they say."""

import pathlib
import re
import subprocess
import unittest

import harness
from harness import BIN, BUNNY, encode_drc, latvox, server
from tls_test import TlsCase

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = BIN.parent


class Sdk(TlsCase):
    def cmake(self, *arguments):
        done = subprocess.run(["cmake", *map(str, arguments)], capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def example(self, name, *arguments):
        words = [self.dir / "build" / name, *map(str, arguments)]
        return subprocess.run(words, capture_output=True, text=True, timeout=harness.PATIENCE)

    def output(self, *words):
        done = self.example(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def setUp(self):
        super().setUp()
        self.cmake("--install", BUILD, "--prefix", self.dir / "prefix")
        headers = "".join(path.read_text() for path in (self.dir / "prefix/include").rglob("*.h"))
        self.assertNotRegex(headers, "#include [<\"](grpc|google/protobuf|latvox/v1)")
        source = self.dir / "source"  # where nothing of the repository is near
        source.mkdir()
        for path in (ROOT / "client/examples").iterdir():
            (source / path.name).write_bytes(path.read_bytes())
        self.cmake("-S", source, "-B", self.dir / "build", f"-DCMAKE_PREFIX_PATH={self.dir / 'prefix'}",
                   "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror", "-G", "Ninja")
        self.cmake("--build", self.dir / "build")
        self.mesh = encode_drc(self.dir / "bunny.drc", BUNNY)

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
            with self.subTest("shards"):
                voxels = whole()["voxels"]
                self.assertEqual(self.output("shards", latvoxd.address, self.mesh, 200, 5), f"{voxels} voxels in 5 parts\n")
            with self.subTest("structure"):
                columns = {(i, j) for i, j, k in harness.rows(self.dir / "out.csv")}
                self.assertEqual(self.output("structure", latvoxd.address, self.mesh, 200),
                                 f"{voxels} voxels over {len(columns)} columns\n")
                stopped = self.example("structure", latvoxd.address, self.mesh, 200, 10)
                self.assertEqual((stopped.returncode, stopped.stdout), (1, ""))
                self.assertIn("CANCELLED: enough", stopped.stderr)
            with self.subTest("to_vdb"):
                summary = whole("--lattice", "fcc", "--separability", 2)
                self.assertEqual(self.output("to_vdb", latvoxd.address, self.mesh, 200, self.dir / "out.vdb"),
                                 f"{summary['voxels']} voxels\n")
                self.assertIn(f"latvox_digest = {summary['digest']}", latvox("info", self.dir / "out.vdb").stdout)

            with self.subTest("a refusal names its field"):
                refused = self.example("hello", latvoxd.address, self.mesh, 70000)
                self.assertEqual(refused.returncode, 1)
                self.assertIn("field resolution, limit 65536", refused.stderr)

        token, tokens = self.dir / "token", self.dir / "tokens"
        token.write_text("alice-0123456789\n")
        tokens.write_text("alice alice-0123456789\n")
        tokens.chmod(0o600)
        with self.subTest("hello, by TLS"), self.server(*self.tls, "--token-file", tokens) as latvoxd:
            tls = [self.authority.root, token]
            self.assertIn("voxels in", self.output("hello", latvoxd.tcp, self.mesh, 20, *tls))
            token.write_text("mallory-0123456789\n")
            refused = self.example("hello", latvoxd.tcp, self.mesh, 20, *tls)
            self.assertEqual(refused.returncode, 1)
            self.assertIn("UNAUTHENTICATED", refused.stderr)
            refused = self.example("hello", latvoxd.tcp, self.mesh, 20)
            self.assertEqual(refused.returncode, 1)


if __name__ == "__main__":
    unittest.main()
