"""--voxel-size SX,SY,SZ: a spacing of its own along each axis."""

import json
import unittest

from harness import BUNNY, Case, latvox, octahedron, rows, write_obj

SIZES = (0.25, 0.5, 0.125)
OPTION = ["--voxel-size", ",".join(map(str, SIZES)), "--origin", "0,0,0", "--quantization", "0"]


class Stretched(Case):
    # Factors that are powers of two move no vertex, so the voxels are the same.
    def test_on_cubes_it_is_the_mesh_compressed(self):
        vertices, triangles = octahedron(2)
        mesh = write_obj(self.dir / "mesh.obj", (vertices, triangles))
        small = [tuple(x / size for x, size in zip(v, SIZES)) for v in vertices]
        other = write_obj(self.dir / "other.obj", (small, triangles))
        for k in (26, 18, 6):
            unit = self.voxelize(other, "--voxel-size", 1, *OPTION[2:], "--separability", k)
            summary = self.voxelize(mesh, *OPTION, "--separability", k)
            self.assertEqual(summary["digest"], unit["digest"])
            self.assertEqual(summary["basis"], [SIZES[0], 0, 0, 0, SIZES[1], 0, 0, 0, SIZES[2]])
            self.assertEqual((summary["lattice"], unit["lattice"]), ("stretched-cartesian", "cartesian"))
        for (i, j, k), world in rows(self.dir / "out.csv").items():
            self.assertEqual(world, (i * SIZES[0], j * SIZES[1], k * SIZES[2]))

    def test_every_lattice_is_stretched_named_and_verified(self):
        for lattice in ("cartesian", "bcc", "fcc", "hexagonal"):
            options = ["--lattice", lattice, "--voxel-size"]
            summary = self.voxelize(BUNNY, *options, "0.04,0.05,0.1", "--verify", out="part.vdb")
            plain = self.voxelize(BUNNY, *options, "1", "--origin", "0,0,0")
            self.assertEqual(summary["lattice"], "stretched-" + lattice)
            for n, (stretched, unit) in enumerate(zip(summary["basis"], plain["basis"])):
                self.assertAlmostEqual(stretched, unit * (0.04, 0.05, 0.1)[n % 3], delta=1e-15)
            self.assertAlmostEqual(summary["voxel_size"], (0.04 * 0.05 * 0.1) ** (1 / 3))
            certificate = summary["certificate"]
            self.assertEqual((certificate["tunnels"], certificate["redundant"]), (0, 0))
            info = latvox("info", self.dir / "part.vdb").stdout
            self.assertIn(f"latvox_lattice = stretched-{lattice}\n", info)
            equal = self.voxelize(BUNNY, *options, "0.1,0.1,0.1")
            one = self.voxelize(BUNNY, *options, "0.1")
            self.assertEqual((equal["digest"], equal["lattice"]), (one["digest"], lattice))

    def test_jobs_take_it_as_an_array(self):
        write_obj(self.dir / "a.obj", octahedron(2))
        job = {"mesh": "a.obj", "voxel_size": SIZES, "origin": [0, 0, 0], "quantization": 0, "out": "a.csv"}
        (self.dir / "jobs.jsonl").write_text(json.dumps(job))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.dir / "results.jsonl").read_text())
        self.assertEqual(result["summary"]["digest"], self.voxelize(self.dir / "a.obj", *OPTION)["digest"])

    def test_incompatible_options_are_refused(self):
        for options, says in (
            (["--voxel-size", "1,2"], '"1,2" is not one or three finite numbers'),
            (["--voxel-size", "1,2,0"], "above 0"),
            (["--voxel-size", "1,2,3", "--basis", "1,0,0,0,1,0,0,0,1"], "--basis allows only one number"),
            (["--voxel-size", "1,2,3", "--lattice", "bcc", "--separability", "26"], "--separability: 26"),
        ):
            done = latvox("voxelize", BUNNY, "-o", self.dir / "o.vdb", *options)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, says)
        done = latvox("voxelize", BUNNY, "-o", self.dir / "o.binvox", "--voxel-size", "0.1,0.1,0.2")
        self.assertEqual(done.returncode, 2)
        self.assertIn("cubes along the axes only", done.stderr)


if __name__ == "__main__":
    unittest.main()
