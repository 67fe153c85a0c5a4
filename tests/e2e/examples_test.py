"""The clients in client/examples share no code with latvox, and find the same voxels."""

import os
import pathlib
import subprocess
import unittest

from harness import BUNNY, PATIENCE, Case, rows, server

ROOT = pathlib.Path(__file__).resolve().parents[2]
LATTICES = ("cartesian", "bcc", "fcc", "hexagonal")


class Examples(Case):
    def run_example(self, *command, **environment):
        """Runs an example. Returns the voxels that it prints, and the last word of its output: the digest."""
        words = list(map(str, command))
        done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, env=os.environ | environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], "i,j,k")
        voxels = {tuple(map(int, line.split(","))) for line in lines[1:]}
        self.assertEqual(len(voxels), len(lines) - 1, "a voxel came twice")
        return voxels, done.stderr.split()[-1]

    def expected(self, address, mesh, lattice):
        # The examples send numbers of 32 bits, as Draco holds them.
        options = ["--resolution", "60", "--lattice", lattice, "--separability", "2", "--upload", "draco", "--quantization", "0"]
        summary = self.voxelize(mesh, *options, "--server", address)
        return set(rows(self.dir / "out.csv")), summary["digest"]

    def assert_tells_usage(self, *command, **environment):
        for words in ([], ["ADDRESS", "MESH", "many"], ["ADDRESS", "MESH", "60", "cubic"]):
            done = subprocess.run([*map(str, command), *words], capture_output=True, text=True, timeout=PATIENCE,
                                  env=os.environ | environment)
            self.assertNotEqual(done.returncode, 0)
            self.assertRegex(done.stderr, r"^Usage: .* \[cartesian\|bcc\|fcc\|hexagonal\] .*\n$")

    def test_python(self):
        protoc = ["protoc", "-I", ROOT / "proto", f"--python_out={self.dir}", "latvox/v1/voxelizer.proto"]
        subprocess.run(protoc, check=True, timeout=PATIENCE)
        example = ROOT / "client/examples/voxelize.py"
        self.assert_tells_usage(example, PYTHONPATH=str(self.dir))
        with server(self.dir) as latvoxd:
            for lattice in LATTICES:
                with self.subTest(lattice):
                    found = self.run_example(example, latvoxd.address, BUNNY, 60, lattice, PYTHONPATH=str(self.dir))
                    self.assertEqual(found, self.expected(latvoxd.address, BUNNY, lattice))

    def test_polygons_are_refused(self):
        (self.dir / "quad.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
        protoc = ["protoc", "-I", ROOT / "proto", f"--python_out={self.dir}", "latvox/v1/voxelizer.proto"]
        subprocess.run(protoc, check=True, timeout=PATIENCE)
        (self.dir / "node_modules").symlink_to(ROOT / "tests/node/node_modules")
        copy = self.dir / "voxelize.mjs"
        copy.write_bytes((ROOT / "client/examples/voxelize.mjs").read_bytes())
        places = {"PYTHONPATH": str(self.dir), "LATVOX_PROTO": str(ROOT / "proto")}
        for command in ([ROOT / "client/examples/voxelize.py"], ["node", copy]):
            done = subprocess.run([*map(str, command), "127.0.0.1:1", self.dir / "quad.obj", "9"], capture_output=True,
                                  text=True, timeout=PATIENCE, env=os.environ | places)  # fmt: skip
            self.assertEqual(done.returncode, 1)
            self.assertIn("f 1 2 3 4: this example reads triangles with numbers from 1 on", done.stderr)

    def test_node(self):
        # Node searches for packages in the folders above the program.
        example = self.dir / "client/examples/voxelize.mjs"
        example.parent.mkdir(parents=True)
        example.write_bytes((ROOT / "client/examples/voxelize.mjs").read_bytes())
        (self.dir / "proto").symlink_to(ROOT / "proto")
        (self.dir / "node_modules").symlink_to(ROOT / "tests/node/node_modules")
        self.assert_tells_usage("node", example)
        with server(self.dir) as latvoxd:
            for lattice in LATTICES:
                with self.subTest(lattice):
                    found = self.run_example("node", example, latvoxd.address, BUNNY, 60, lattice)
                    self.assertEqual(found, self.expected(latvoxd.address, BUNNY, lattice))


if __name__ == "__main__":
    unittest.main()
