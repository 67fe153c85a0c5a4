"""`latvox compare -o` writes the voxels that differ, as a grid and as a picture."""

import json
import subprocess
import unittest

import numpy
import pyopenvdb

from harness import PATIENCE, Case, latvox, octahedron, write_obj

GRID = ["--voxel-size", "1", "--origin", "0,0,0", "--quantization", "0"]


def values(vdb, name):
    return {item.min: item.value for item in pyopenvdb.read(str(vdb), name).iterOnValues()}


def pixels(png):
    """Returns the rows of a picture, by ImageMagick."""
    done = subprocess.run(["convert", png, "-depth", "8", "rgb:-"], capture_output=True, timeout=PATIENCE, check=True)
    return numpy.frombuffer(done.stdout, "u1").reshape(-1, 3)


class Difference(Case):
    def setUp(self):
        super().setUp()
        for name, radius in (("a", 8.0), ("b", 9.0)):
            write_obj(self.dir / f"{name}.obj", octahedron(radius))

    def compare(self, *options, a="a.vdb", b="b.vdb"):
        return latvox("compare", self.dir / a, self.dir / b, *options)

    def write(self, *options):
        voxels = []
        for name in "ab":
            self.voxelize(self.dir / f"{name}.obj", "-o", self.dir / f"{name}.vdb", *GRID, *options, out=f"{name}.csv")
            voxels.append({tuple(map(int, line.split(",")[:3])) for line in (self.dir / f"{name}.csv").read_text().splitlines()[1:]})
        return voxels

    def sliced(self, vdb):
        """Returns (i, j, k) -> name of the part of all layers, by `latvox slice`."""
        found = {}
        box = json.loads(latvox("info", "--json", vdb).stdout)["index_box"]
        for k in range(box["min"][2], box["max"][2]):
            done = latvox("slice", vdb, "--axis", "k", "--index", k, "-o", self.dir / "s.csv")
            self.assertEqual(done.returncode, 0, done.stderr)
            for line in (self.dir / "s.csv").read_text().splitlines()[1:]:
                i, j, k_, *_, part, name = line.split(",")
                found[int(i), int(j), int(k_)] = (int(part), name)
        return found

    def test_the_grid_tells_who_has_the_voxel(self):
        for options in ([], ["--lattice", "bcc"]):
            with self.subTest(options):
                a, b = self.write(*options)
                self.assertTrue(a - b and b - a)
                done = self.compare("-o", self.dir / "d.vdb")
                self.assertEqual((done.returncode, done.stderr), (1, ""))
                self.assertIn(f"wrote {self.dir / 'd.vdb'}\ndifferent\n", done.stdout)
                only = {ijk: (1, "only in A") for ijk in a - b} | {ijk: (2, "only in B") for ijk in b - a}
                self.assertEqual(self.sliced(self.dir / "d.vdb"), only)
                grid = pyopenvdb.read(str(self.dir / "d.vdb"), "voxels")
                self.assertEqual({item.min for item in grid.iterOnValues()}, set(only))
                self.assertEqual((grid["latvox_difference_a"], grid["latvox_difference_b"]),
                                 (str(self.dir / "a.vdb"), str(self.dir / "b.vdb")))  # fmt: skip
                source = pyopenvdb.read(str(self.dir / "a.vdb"), "voxels")
                self.assertEqual(grid.transform.indexToWorld((3, 4, 5)), source.transform.indexToWorld((3, 4, 5)))

    def test_distances_that_differ_are_a_grid_of_differences(self):
        a, b = self.write("--band", "2v")
        tables = [{tuple(map(int, (r := line.split(","))[:3])): float(r[6]) for line in (self.dir / f"{n}.csv").read_text().splitlines()[1:]}
                  for n in "ab"]  # fmt: skip
        self.assertEqual(self.compare("-o", self.dir / "d.vdb").returncode, 1)
        changed = {ijk for ijk in a & b if tables[0][ijk] != tables[1][ijk]}
        self.assertTrue(changed)
        found = values(self.dir / "d.vdb", "difference")
        self.assertEqual(set(found), changed)
        for ijk, difference in found.items():
            self.assertAlmostEqual(difference, tables[1][ijk] - tables[0][ijk], places=5)
        kinds = {ijk: (3, "other values") for ijk in changed}
        kinds |= {ijk: (1, "only in A") for ijk in a - b} | {ijk: (2, "only in B") for ijk in b - a}
        self.assertEqual(self.sliced(self.dir / "d.vdb"), kinds)
        self.assertEqual(self.compare("--voxels", "-o", self.dir / "v.vdb").returncode, 1)
        self.assertEqual({part for part, _ in self.sliced(self.dir / "v.vdb").values()}, {1, 2})

    def test_attributes_that_differ_are_marked(self):
        for name in "ab":
            vertices, triangles = octahedron(8.0)
            write_obj(self.dir / "half.obj", (vertices, triangles[:4]))
            write_obj(self.dir / "rest.obj", (vertices, triangles[4:]))
            meshes = ("half.obj", "rest.obj") if name == "a" else ("rest.obj", "half.obj")
            done = latvox("voxelize", *(self.dir / m for m in meshes), "-o", self.dir / f"{name}.vdb", *GRID, "--fields", "part")
            self.assertEqual(done.returncode, 0, done.stderr)
        done = self.compare("--json", "-o", self.dir / "d.vdb")
        told = json.loads(done.stdout)
        self.assertEqual((done.returncode, told["only_a"], told["only_b"]), (1, 0, 0))
        self.assertEqual(told["outputs"], [str(self.dir / "d.vdb")])
        found = self.sliced(self.dir / "d.vdb")
        self.assertEqual(set(found.values()), {(3, "other values")})
        self.assertEqual(len(found), told["values"]["part"])

    def test_the_picture_shows_all_voxels_in_three_colors(self):
        self.write()
        done = self.compare("-o", self.dir / "d.png", "-o", self.dir / "d.vdb")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(": gray in both, red only in A, blue only in B, orange other values\n", done.stdout)
        colors = pixels(self.dir / "d.png").astype(int)
        red = (colors[:, 0] > colors[:, 2] + 60).sum()
        blue = (colors[:, 2] > colors[:, 0] + 60).sum()
        self.assertGreater(blue, 1000)  # the larger octahedron
        self.assertEqual(self.compare("-o", self.dir / "e.png", a="b.vdb", b="a.vdb").returncode, 1)
        swapped = pixels(self.dir / "e.png").astype(int)
        self.assertGreater((swapped[:, 0] > swapped[:, 2] + 60).sum(), 1000)
        self.assertLess(red, blue)
        self.assertEqual(self.compare("-o", self.dir / "same.png", b="a.vdb").returncode, 0)
        same = pixels(self.dir / "same.png").astype(int)
        self.assertGreater(len(same), 1024 * 1024)  # a legend is below the voxels
        self.assertLess(abs(same[: 1024 * 1024, 0] - same[: 1024 * 1024, 2]).max(), 40)
        for color in (0xB8B8B8, 0xCA2A36, 0x2166AC):
            self.assertIn([color >> 16, color >> 8 & 255, color & 255], same[1024 * 1024 :].tolist())

    def test_equal_files_have_an_empty_difference(self):
        self.write()
        done = self.compare("-o", self.dir / "d.vdb", b="a.vdb")
        self.assertEqual((done.returncode, done.stdout.splitlines()[-1]), (0, "equal"))
        self.assertEqual(json.loads(latvox("info", "--json", self.dir / "d.vdb").stdout)["voxels"], 0)

    def test_refusals_leave_the_old_file(self):
        self.write()
        (self.dir / "d.vdb").write_text("old")
        self.voxelize(self.dir / "b.obj", "--voxel-size", "1.5", out="c.vdb")
        for status, says, words in (
            (3, "differ: their difference has no place in one grid", [self.dir / "c.vdb", "-o", self.dir / "d.vdb"]),
            (3, "no such file", [self.dir / "none.vdb", "-o", self.dir / "d.vdb"]),
            (2, "is the compared file itself", [self.dir / "b.vdb", "-o", self.dir / "a.vdb"]),
            (2, "is given twice", [self.dir / "b.vdb", "-o", self.dir / "d.png", "-o", self.dir / "d.png"]),
            (2, 'extension ".csv" is not one of .vdb .png', [self.dir / "b.vdb", "-o", self.dir / "d.csv"]),
            (1, "cannot be written", [self.dir / "b.vdb", "-o", self.dir / "d.vdb", "-o", self.dir / "none" / "d.png"]),
        ):
            with self.subTest(says):
                done = latvox("compare", self.dir / "a.vdb", *words)
                self.assertEqual((done.returncode, done.stdout), (status, ""), done.stderr)
                self.assertIn(says, done.stderr)
                self.assertEqual((self.dir / "d.vdb").read_text(), "old")
        self.assertFalse(list(self.dir.glob("*.part")) + list(self.dir.glob(".*.part")))


if __name__ == "__main__":
    unittest.main()
