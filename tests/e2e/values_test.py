"""Values of voxels: render draws them, slice lists them, compare compares them."""

import json
import unittest

import numpy
import pyopenvdb

from harness import Case, latvox, octahedron, write_obj
from picture_test import LATTICES, read_png

GRID = ["--voxel-size", "1", "--origin", "0,0,0", "--quantization", "0"]
ORANGE, SKY = (0xE6, 0x9F, 0x00), (0x56, 0xB4, 0xE9)  # the first two of the palette
INSIDE, OUTSIDE = (0x05, 0x30, 0x61), (0x67, 0x00, 0x1F)  # the ends of RdBu
SURFACE, FAR = (0x44, 0x01, 0x54), (0xFD, 0xE7, 0x25)  # of viridis


def table(csv):
    """Returns (i, j, k) -> the further columns of a .csv file, and their names."""
    header, *lines = csv.read_text().splitlines()
    voxels = {}
    for line in lines:
        words = line.split(",")
        voxels[tuple(map(int, words[:3]))] = words[6:]
    assert len(voxels) == len(lines), "a voxel stands twice"
    return voxels, header.split(",")[6:]


def has_hole(lines):
    """Returns whether some background is not connected with the picture's corner."""
    empty = lines[0][0]
    outside = {(x, y) for y, line in enumerate(lines) for x, color in enumerate(line) if color == empty}
    ways = [(0, 0)]
    while ways:
        x, y = ways.pop()
        if (x, y) in outside:
            outside.remove((x, y))
            ways += [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]
    return bool(outside)


class ValuesCase(Case):
    def run_latvox(self, *words, status=0):
        done = latvox(*words)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def bodies(self):
        """Writes two octahedra, red and blue, of two parts and materials."""
        text = []
        for n, color in enumerate(("1 0 0", "0 0 1")):
            vertices, triangles = octahedron(8.0)
            text += [f"o {n}", f"usemtl m{n}"] + [f"v {x + 20 * n} {y} {z} {color}" for x, y, z in vertices]
            text += ["f " + " ".join(str(v + 1 + 6 * n) for v in t) for t in triangles]
        (self.dir / "two.obj").write_text("\n".join(text) + "\n")
        return self.dir / "two.obj"

    def mesh(self):
        return write_obj(self.dir / "ball.obj", octahedron(8.0))

    def ball(self, lattice, *options, out="band.vdb"):
        self.voxelize(self.mesh(), *GRID, "--lattice", lattice, "--band", "3", *options, out=out)
        return self.dir / out

    def sides(self, picture):
        """Returns the mean color of the left and of the right half's voxels."""
        width, _, lines = read_png(picture)
        found = []
        for half in (range(width // 2), range(width // 2, width)):
            colors = [line[x] for line in lines for x in half if line[x] != lines[0][0]]
            self.assertGreater(len(colors), 100)
            found.append(numpy.mean(colors, axis=0))
        return found

class Pictures(ValuesCase):
    def render(self, *options):
        done = self.run_latvox("render", self.dir / "a.vdb", "--size", "100", "--view", "0,0", "-o", self.dir / "c.png", *options)
        return self.sides(self.dir / "c.png"), done.stdout

    def test_voxels_have_the_colors_that_they_carry(self):
        for lattice in LATTICES:
            with self.subTest(lattice):
                self.voxelize(self.bodies(), "--lattice", lattice, "--fields", "part,color,material", *GRID, out="a.vdb")
                (left, right), says = self.render()
                self.assertIn("colored by color", says)
                self.assertTrue(left[0] > 10 * left[2] and right[2] > 10 * right[0], (left, right))
        for by in ("part", "material"):
            (left, right), _ = self.render("--color-by", by)
            self.assertTrue(left[0] > left[1] > 3 * left[2] and right[0] < right[1] < right[2], (left, right))
        for plain in (["--color-by", "none"], ["--color", "769ed2"]):
            (left, right), _ = self.render(*plain)
            self.assertTrue(abs(left - right).max() < 12 and left[0] < left[1] < left[2], (left, right))

    def test_voxelize_draws_the_same(self):
        for mesh, options in ((self.bodies(), ["--fields", "color"]), (self.mesh(), ["--band", "3", "--signed"])):
            self.voxelize(mesh, *GRID, *options, "-o", self.dir / "a.vdb", out="a.png")
            self.run_latvox("render", self.dir / "a.vdb", "-o", self.dir / "b.png")
            self.assertEqual((self.dir / "a.png").read_bytes(), (self.dir / "b.png").read_bytes())

    def test_colors_that_a_picture_cannot_show_are_refused(self):
        self.voxelize(self.bodies(), *GRID, "--fields", "part", out="a.vdb")
        out = ["-o", self.dir / "x.png"]
        for status, says, words in (
            (3, "a.vdb: the voxels have no color, which --color-by requires", ["render", "a.vdb", "--color-by", "color"]),
            (3, "the voxels have no distance", ["slice", "a.vdb", "--axis=x", "--index=0", "--color-by", "distance"]),
            (3, "the voxels have no distance", ["render", "a.vdb", "--color-by", "distance"]),
            (2, "--color-by", ["render", "a.vdb", "--color-by", "link"]),
            (2, "cannot be combined with --color-by part", ["render", "a.vdb", "--color-by", "part", "--color", "ff0000"]),
        ):
            with self.subTest(says):
                command, file, *options = words
                self.assertIn(says, self.run_latvox(command, self.dir / file, *options, *out, status=status).stderr)
                self.assertFalse((self.dir / "x.png").exists())

    def test_bands_show_their_surface_and_their_distances(self):
        for lattice, sign in (("cartesian", True), ("bcc", False), ("fcc", True), ("hexagonal", True)):
            with self.subTest(lattice):
                self.ball(lattice, *["--signed"] * sign, "-o", self.dir / "whole.csv")
                self.check_surface()
                self.check_layer(sign)

    def check_surface(self):
        """Seen from z, the octahedron is a square on its corner."""
        done = self.run_latvox("render", self.dir / "band.vdb", "-o", self.dir / "c.png", "--size=96", "--view=0,0")
        self.assertIn("in the band; the picture shows those at the surface", done.stdout)
        _, _, lines = read_png(self.dir / "c.png")
        self.assertFalse(has_hole(lines))
        share = sum(color != lines[0][0] for line in lines for color in line) / (0.92 * 96) ** 2
        self.assertTrue(0.42 < share < 0.7, share)

    def check_layer(self, sign):
        whole, _ = table(self.dir / "whole.csv")
        done = self.run_latvox("slice", self.dir / "band.vdb", "--axis=z", "--index=1", "--size=200",
                               "-o", self.dir / "a.csv", "-o", self.dir / "a.png")  # fmt: skip
        self.assertIn("colored by distance, from " + ("-3 (blue, inside)" if sign else "0 (violet)"), done.stdout)
        layer, columns = table(self.dir / "a.csv")
        self.assertEqual(columns, ["distance"])
        self.assertEqual(layer, {ijk: values for ijk, values in whole.items() if ijk[2] == 1})
        colors = [color for line in read_png(self.dir / "a.png")[2] for color in line]
        near = lambda color: sum(max(abs(x - y) for x, y in zip(c, color)) < 60 for c in colors)
        for color in (INSIDE, OUTSIDE) if sign else (SURFACE, FAR):
            self.assertGreater(near(color), 100, color)
        self.assertEqual(colors.count((0, 0, 0)) > 50, sign)

    def test_a_layer_may_be_plain(self):
        self.ball("cartesian")
        self.run_latvox("slice", self.dir / "band.vdb", "--axis=z", "--index=1", "-o", self.dir / "b.png", "--size=100", "--color-by=none")
        self.assertGreater(sum(c == (0x99, 0xB5, 0xD9) for line in read_png(self.dir / "b.png")[2] for c in line), 1000)

    def test_layers_of_attributes_list_and_show_them(self):
        self.voxelize(self.bodies(), *GRID, "--fields", "part,color", "-o", self.dir / "whole.csv", out="a.vdb")
        cut = ["slice", self.dir / "a.vdb", "--axis=z", "--index=0", "--size=300"]
        for by, ends in ((None, ((255, 0, 0), (0, 0, 255))), ("part", (ORANGE, SKY))):
            words = ["-o", self.dir / "a.csv", "-o", self.dir / "a.png"] + (["--color-by", by] if by else [])
            self.assertIn(f"colored by {by or 'color'}\n", self.run_latvox(*cut, *words).stdout)
            layer, columns = table(self.dir / "a.csv")
            self.assertEqual(columns, ["part", "red", "green", "blue", "part_name"])
            whole, _ = table(self.dir / "whole.csv")
            self.assertEqual(layer, {ijk: values for ijk, values in whole.items() if ijk[2] == 0})
            width, _, lines = read_png(self.dir / "a.png")
            for n, color in enumerate(ends):
                count = [sum(c == color for line in lines for c in line[side]) for side in (slice(0, width // 2), slice(width // 2, width))]
                self.assertGreater(count[n], 500)
                self.assertEqual(count[1 - n], 0)


class Compare(ValuesCase):
    def compare(self, a, b, *options, status):
        return json.loads(self.run_latvox("compare", a, b, "--json", *options, status=status).stdout)

    def test_distances_that_differ_are_counted(self):
        a, b = self.ball("bcc"), self.dir / "b.vdb"
        report = self.compare(a, a, status=0)
        self.assertEqual(report["distances"], {"differ": 0, "greatest": 0, "at": None})
        grid = pyopenvdb.read(str(a), "distance")
        accessor, places = grid.getAccessor(), sorted(item.min for item in grid.iterOnValues())[::50]
        was = [accessor.getValue(ijk) for ijk in places]
        for n, (ijk, value) in enumerate(zip(places[:-1], was)):
            accessor.setValueOn(ijk, value + (0.5 if n == 3 else 0.125))
        accessor.setValueOff(places[-1], 0)
        pyopenvdb.write(str(b), grids=[grid])
        report = self.compare(a, b, status=1)
        self.assertEqual((report["only_a"], report["only_b"], report["fields"]), (1, 0, []))
        self.assertEqual(report["distances"], {"differ": len(places) - 1, "greatest": 0.5, "at": list(places[3])})
        self.assertRegex(self.run_latvox("compare", a, b, status=1).stdout,
                         rf"\n{len(places) - 1} of the distances in both differ, by 0.5 at most, at {','.join(map(str, places[3]))}\n")  # fmt: skip

    def test_a_band_and_a_set_have_voxels_in_common(self):
        band = self.ball("fcc")
        self.voxelize(self.dir / "ball.obj", *GRID, "--lattice", "fcc", out="set.vdb")
        for pair in ((band, self.dir / "set.vdb"), (self.dir / "set.vdb", band)):
            done = self.run_latvox("compare", *pair, status=3)
            self.assertRegex(done.stderr, r"band.vdb is a band of distances, \S*set.vdb is a set of voxels; --voxels")
        report = self.compare(band, self.dir / "set.vdb", "--voxels", status=1)
        self.assertEqual((report["only_b"], report["both"], report["distances"]), (0, report["voxels"]["b"], None))
        self.assertEqual(self.compare(band, band, "--voxels", status=0)["only_a"], 0)

    def test_distances_of_bands_and_of_other_sets_are_compared(self):
        """A band with further fields, or voxels of another set with distances, has distances as well."""
        mesh, options = self.mesh(), [*GRID, "--lattice", "fcc"]
        self.voxelize(mesh, *options, "--band", "3", out="alone.vdb")
        self.voxelize(mesh, *options, "--band", "3", "--fields", "part,distance", out="both.vdb")
        self.voxelize(mesh, *options, "--fields", "distance", out="surface.vdb")
        for other, only_a in (("both.vdb", 0), ("surface.vdb", 1)):
            report = self.compare(self.dir / "alone.vdb", self.dir / other, "-o", self.dir / "out.vdb", status=1)
            self.assertEqual((report["only_a"] > 0, report["only_b"]), (only_a > 0, 0))
            self.assertEqual((report["distances"]["differ"], report["distances"]["greatest"]), (0, 0))
            difference = pyopenvdb.readGridMetadata(str(self.dir / "out.vdb"), "difference")
            self.assertEqual(difference["latvox_difference_b"], str(self.dir / other))

    def test_a_band_with_colors_is_drawn_with_them(self):
        band = ["--voxel-size", "0.5", "--band", "2v", "--fields", "material,distance"]
        self.voxelize(self.bodies(), *band, out="a.vdb")
        self.voxelize(self.bodies(), *band, out="voxelized.png")
        text = self.run_latvox("render", self.dir / "a.vdb", "-o", self.dir / "rendered.png").stdout
        self.assertIn("in the band; the picture shows those at the surface", text)
        self.run_latvox("convert", self.dir / "a.vdb", "-o", self.dir / "converted.png")
        pictures = [(self.dir / f"{name}.png").read_bytes() for name in ("voxelized", "rendered", "converted")]
        self.assertEqual(pictures[0], pictures[1])
        self.assertEqual(pictures[0], pictures[2])
        hues = {(r > b) - (r < b) for line in read_png(self.dir / "rendered.png")[2] for r, g, b, *_ in line}
        self.assertLessEqual({1, -1}, hues, "orange and sky blue")

    def test_attributes_that_differ_are_counted(self):
        mesh = self.bodies()
        for name, attributes in (("a", "part,color"), ("b", "part,color"), ("c", "part")):
            self.voxelize(mesh, *GRID, "--fields", attributes, out=f"{name}.vdb")
            mesh.write_text(mesh.read_text().replace("0 0 1\n", "0 1 1\n"))
        a, b, c = (self.dir / f"{name}.vdb" for name in "abc")
        self.assertEqual(self.compare(a, a, status=0)["values"], {"part": 0, "color": 0})
        report = self.compare(a, b, status=1)
        self.assertEqual(report["values"]["part"], 0)
        self.assertEqual(2 * report["values"]["color"], report["both"])  # all of the second body
        self.assertIn("\ncolor: ", self.run_latvox("compare", a, b, status=1).stdout)
        self.assertEqual(self.compare(a, b, "--voxels", status=0)["values"], {})
        report = self.compare(a, c, status=1)
        self.assertEqual(report["values"], {"part": 0})
        self.assertIn({"name": "grids", "a": "part,color", "b": "part"}, report["fields"])


if __name__ == "__main__":
    unittest.main()
