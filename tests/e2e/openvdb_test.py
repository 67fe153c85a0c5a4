"""OpenVDB's own reader finds the facts of the summary and of the .csv file in a .vdb file."""

import json
import unittest

import pyopenvdb

from harness import BUNNY, Case, latvox, rows

TOLERANCE = 1e-12  # relative: .csv has 17 significant digits, OpenVDB multiplies the same doubles in another order


class OpenVdb(Case):
    def test_grid_and_table_hold_the_same_voxels_at_the_same_positions(self):
        for options in (
            ["--lattice", "bcc", "--resolution", "64"],
            ["--lattice", "cartesian", "--resolution", "64", "--separability", "2"],
            ["--basis", "0.03,0,0.001,0.002,0.04,0,0,0.01,0.05", "--origin", "0.1,-0.2,0.3"],
        ):
            with self.subTest(options):
                self.check(options)

    def check(self, options):
        vdb, csv = self.dir / "out.vdb", self.dir / "out.csv"
        done = latvox("voxelize", BUNNY, "-o", vdb, "-o", csv, "--json", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        summary, table = json.loads(done.stdout), rows(csv)
        grids, _ = pyopenvdb.readAll(str(vdb))
        self.assertEqual(len(grids), 1)
        grid = grids[0]
        self.assertEqual(grid.activeVoxelCount(), summary["voxels"])
        self.assertEqual(len(table), summary["voxels"])
        scale = max(abs(x) for position in table.values() for x in position)
        accessor = grid.getConstAccessor()
        for ijk, position in table.items():
            self.assertTrue(accessor.isValueOn(ijk), ijk)
            for seen, written in zip(grid.transform.indexToWorld(ijk), position):
                self.assertLessEqual(abs(seen - written), TOLERANCE * scale, ijk)

    def test_the_summary_describes_the_grid(self):
        options = ["--basis", "0.5,0,0,0,0.25,0,0.25,0,0.125", "--origin", "0.25,0.5,-1"]
        summary = self.voxelize(BUNNY, *options)
        basis, origin = summary["basis"], summary["origin"]
        self.assertEqual(basis, [0.5, 0, 0, 0, 0.25, 0, 0.25, 0, 0.125])
        self.assertEqual(origin, [0.25, 0.5, -1])
        for ijk, position in rows(self.dir / "out.csv").items():
            expected = [origin[m] + sum(ijk[n] * basis[3 * n + m] for n in range(3)) for m in range(3)]
            self.assertEqual(list(position), expected)


if __name__ == "__main__":
    unittest.main()
