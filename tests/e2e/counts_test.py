"""The voxel counts of the Stanford bunny, each confirmed by the service's independent verification.

The expected numbers come from another implementation of the same rule, with vertices on the same 1/256 grid and the
same ties. A vertex may be rounded differently there, so the counts agree only within 0.3 %.
"""

import unittest

from harness import BUNNY, Case

#          lattice      k     all   minimal
EXPECTED = [
    ("cartesian", 2, 133337, 132776),
    ("cartesian", 1, 197758, 196771),
    ("cartesian", 0, 226090, 224711),
    ("bcc", 0, 173081, 172363),
    ("fcc", 2, 157064, 156429),
    ("fcc", 0, 211571, 210474),
]


class Counts(Case):
    def test_every_lattice_holds_the_expected_voxels_without_tunnel_or_redundancy(self):
        for lattice, k, all_voxels, minimal_voxels in EXPECTED:
            for option, expected in (("--no-minimal", all_voxels), ("--minimal", minimal_voxels)):
                with self.subTest(lattice=lattice, separability=k, option=option):
                    self.check(lattice, k, option, expected)

    def check(self, lattice, k, option, expected):
        options = ["--lattice", lattice, "--separability", k, "--resolution", 256, "--quantization", 0]
        summary = self.voxelize(BUNNY, *options, option, "--verify", out="out.vdb")
        certificate = summary["certificate"]
        self.assertLess(abs(summary["voxels"] - expected), 0.003 * expected, summary["voxels"])
        self.assertEqual((summary["lattice"], summary["separability"]), (lattice, k))
        self.assertEqual(summary["mesh"]["triangles"], 69666)
        self.assertTrue(certificate["verified"])
        self.assertEqual(certificate["tunnels"], 0)
        self.assertEqual(certificate["minimal"], option == "--minimal")
        if option == "--minimal":
            self.assertEqual(certificate["redundant"], 0)
        else:
            self.assertGreater(certificate["redundant"], 0)

    def test_separability_has_its_cartesian_names(self):
        options = ["--lattice", "cartesian", "--resolution", 64]
        for k, name in ((0, 26), (1, 18), (2, 6)):
            digests = {self.voxelize(BUNNY, *options, "--separability", s)["digest"] for s in (k, name)}
            self.assertEqual(len(digests), 1, f"{k} and {name} differ")

    def test_every_k_is_the_same_on_bcc(self):
        options = ["--lattice", "bcc", "--resolution", 64]
        digests = {self.voxelize(BUNNY, *options, "--separability", k)["digest"] for k in (0, 1, 2)}
        self.assertEqual(len(digests), 1)


if __name__ == "__main__":
    unittest.main()
