"""Every algorithm runs, reports its name, and claims no more than was counted. The exact one has no tunnels and no
redundant voxels to count."""

import unittest

from harness import BUNNY, Case, latvox

ALGORITHMS = ("exact", "brute-force", "incremental", "optimized-incremental")
LATTICES = (("cartesian", 0), ("cartesian", 1), ("cartesian", 2), ("bcc", 0), ("fcc", 0))


class Algorithms(Case):
    def run_one(self, algorithm, lattice, k, *options, out="out.vdb"):
        options = ["--lattice", lattice, "--separability", k, "--resolution", 64, "--algorithm", algorithm, *options]
        return self.voxelize(BUNNY, *options, out=out)

    def test_every_algorithm_on_every_lattice_with_its_counts(self):
        for lattice, k in LATTICES:
            exact = self.run_one("exact", lattice, k, "--verify")
            for algorithm in ALGORITHMS:
                with self.subTest(lattice=lattice, separability=k, algorithm=algorithm):
                    summary = self.run_one(algorithm, lattice, k, "--verify")
                    certificate = summary["certificate"]
                    self.assertEqual(certificate["algorithm"], algorithm)
                    self.assertTrue(certificate["verified"])
                    tunnels, redundant = certificate["tunnels"], certificate["redundant"]
                    self.assertEqual(certificate["tunnel_free"], tunnels == 0)
                    self.assertEqual(certificate["minimal"], tunnels == redundant == 0)
                    if algorithm == "exact":
                        self.assertEqual((tunnels, redundant), (0, 0))
                        self.assertEqual(summary["digest"], exact["digest"])
                    else:
                        # Each algorithm digitizes the whole bunny, and none thins.
                        self.assertGreater(summary["voxels"], 0.8 * exact["voxels"])
                        self.assertLess(summary["voxels"], 2 * exact["voxels"])
                        self.assertGreater(redundant, 0)
                    if algorithm == "brute-force":
                        self.assertEqual(tunnels, 0, "it holds every voxel of the crossing rule")

    def test_a_tunnel_is_counted_once_however_many_triangles_cross_it(self):
        corners = "v 0.2 -1.5 0.8\nv -0.8 1.8 -1.2\nv 1.0 -1.3 1.9\n"
        for faces in ("f 1 2 3\n", "f 1 2 3\nf 1 2 3\nf 1 3 2\n"):
            mesh = self.dir / "mesh.obj"
            mesh.write_text(corners + faces)
            summary = self.voxelize(mesh, "--voxel-size", 1, "--origin", "0,0,0", "--separability", 2, "--quantization", 0,
                                    "--algorithm", "incremental", "--verify")  # fmt: skip
            self.assertEqual(summary["certificate"]["tunnels"], 1)

    def test_only_the_exact_algorithm_claims_without_counting(self):
        for algorithm in ALGORITHMS:
            with self.subTest(algorithm):
                certificate = self.run_one(algorithm, "bcc", 0)["certificate"]
                self.assertEqual((certificate["tunnels"], certificate["redundant"]), (None, None))
                claimed = algorithm == "exact"
                self.assertEqual((certificate["tunnel_free"], certificate["minimal"]), (claimed, claimed))

    def test_the_file_and_the_text_name_the_algorithm(self):
        out = self.dir / "out.vdb"
        done = latvox("voxelize", BUNNY, "-o", out, "--resolution", 32, "--algorithm", "incremental")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("k = 0, incremental", done.stdout)
        self.assertIn("latvox_algorithm = incremental", latvox("info", out).stdout)


if __name__ == "__main__":
    unittest.main()
