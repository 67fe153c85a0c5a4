"""Commands on .vdb files: pictures and slices show the voxels in their places, and differences are found."""

import csv
import itertools
import json
import os
import struct
import subprocess
import unittest
import zlib

import pyopenvdb

from harness import BIN, BUNNY, Case, latvox, octahedron, rows

OK, OTHER, USAGE, BAD_INPUT = range(4)
LATTICES = {
    "cartesian": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "bcc": ((1.2, 0, 0), (0, 1.2, 0), (0.6, 0.6, 0.6)),
    "fcc": ((0.8, 0.8, 0), (0.8, 0, 0.8), (0, 0.8, 0.8)),
    "hexagonal": ((1, 0, 0), (0.5, 0.75**0.5, 0), (0, 0, 1)),
}


def write_octahedron(path, basis, radius=12):
    """Writes the lattice points of an octahedron. Returns their world positions by lattice coordinates."""
    grid = pyopenvdb.BoolGrid()
    grid.name = "voxels"
    grid.transform = pyopenvdb.createLinearTransform([[*vector, 0] for vector in basis] + [[0, 0, 0, 1]])
    accessor, points = grid.getAccessor(), {}
    for ijk in itertools.product(range(-2 * radius, 2 * radius + 1), repeat=3):
        point = [sum(n * vector[m] for n, vector in zip(ijk, basis)) for m in range(3)]
        if sum(map(abs, point)) <= radius:
            accessor.setValueOn(ijk, True)
            points[ijk] = point
    pyopenvdb.write(str(path), grids=[grid])
    return points


def read_png(path):
    """Returns width, height and the rows of an 8-bit .png: (r, g, b), or (r, g, b, opacity)."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "not a .png"
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack_from(">IIBB", body)
            assert depth == 8 and color in (2, 6)
            size = {2: 3, 6: 4}[color]
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    lines, before, raw = [], bytes(size * width), zlib.decompress(packed)
    for y in range(height):
        kind, *line = raw[y * (size * width + 1) : (y + 1) * (size * width + 1)]
        for n in range(size * width):
            a, b, c = (line[n - size] if n >= size else 0), before[n], (before[n - size] if n >= size else 0)
            paeth = min((a, b, c), key=lambda x: abs(a + b - c - x))
            line[n] = (line[n] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        lines.append([tuple(line[n : n + size]) for n in range(0, size * width, size)])
        before = line
    return width, height, lines


class Picture(Case):
    def render(self, *arguments, out="out.png"):
        done = latvox("render", *arguments, "-o", self.dir / out)
        self.assertEqual(done.returncode, OK, done.stderr)
        return read_png(self.dir / out)

    def covered(self, lines):
        background = lines[0][0]
        return [(x, y) for y, line in enumerate(lines) for x, color in enumerate(line) if color != background]

    def test_every_lattice_shows_the_shape(self):
        for lattice, basis in LATTICES.items():
            with self.subTest(lattice):
                write_octahedron(self.dir / "a.vdb", basis, 10)
                # Seen from z, the shape is a square on its corner, half of its box.
                width, height, lines = self.render(self.dir / "a.vdb", "--size", 96, "--view", "0,0")
                self.assertEqual((width, height), (96, 96))
                seen = self.covered(lines)
                box = [f(p[m] for p in seen) for m in (0, 1) for f in (min, max)]
                for low, high in (box[:2], box[2:]):
                    self.assertAlmostEqual(high - low, 0.92 * 96, delta=12)
                share = len(seen) / ((box[1] - box[0]) * (box[3] - box[2]))
                self.assertTrue(0.45 < share < 0.68, share)
                self.assertGreater(len({lines[y][x] for x, y in seen}), 30)
                # Lit from above on the left.
                brightness = lambda x, y: sum(sum(lines[y + d][x + e]) for d in range(-3, 4) for e in range(-3, 4))
                self.assertGreater(brightness(36, 36), 1.2 * brightness(60, 60))

    def test_any_axis_may_point_up(self):
        corners = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 4)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        box = self.dir / "box.obj"
        box.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {' '.join(str(v + 1) for v in f)}\n" for f in faces))
        self.voxelize(box, "--resolution", "33", out="box.vdb")

        def extent(*options):
            _, _, lines = self.render(self.dir / "box.vdb", "--size", 96, "--view", "0,0", *options)
            return [max(c) - min(c) for c in zip(*self.covered(lines))]

        wide = {axis: extent(*(["--view-up", axis] if axis else [])) for axis in ("", "x", "y", "z")}
        self.assertEqual(wide[""], wide["y"])
        ratio = {axis: size[0] / size[1] for axis, size in wide.items()}
        self.assertLess(abs(ratio["y"] - 1 / 2), 0.15, wide)  # x to the right, y up
        self.assertLess(abs(ratio["z"] - 1 / 4), 0.15, wide)
        self.assertLess(abs(ratio["x"] - 4 / 1), 1.2, wide)  # z to the right

        self.voxelize(box, "--resolution", "33", "--up-axis", "z", out="up.png")
        self.assertEqual(latvox("render", self.dir / "box.vdb", "-o", self.dir / "same.png", "--view-up", "z").returncode, OK)
        self.assertEqual((self.dir / "up.png").read_bytes(), (self.dir / "same.png").read_bytes())

    def test_options_do_what_they_say(self):
        write_octahedron(self.dir / "a.vdb", LATTICES["fcc"], 9)
        size = ["--size", 64]
        _, _, first = self.render(self.dir / "a.vdb", *size)
        _, _, aside = self.render(self.dir / "a.vdb", *size, "--view", "120,-10")
        _, _, red = self.render(self.dir / "a.vdb", *size, "--color", "d04010")
        self.assertNotEqual(self.covered(first), self.covered(aside))
        self.assertEqual(self.covered(first), self.covered(red))
        total = lambda lines, m: sum(lines[y][x][m] for x, y in self.covered(lines))
        self.assertGreater(total(first, 2), total(first, 0))
        self.assertGreater(total(red, 0), 2 * total(red, 2))

    def test_backgrounds(self):
        write_octahedron(self.dir / "a.vdb", LATTICES["bcc"], 9)
        for name, background in [("white", (255, 255, 255)), ("black", (0, 0, 0)), ("#20a0f0", (32, 160, 240)), ("20a0F0", (32, 160, 240))]:
            _, _, lines = self.render(self.dir / "a.vdb", "--size", 64, "--background", name)
            self.assertEqual(lines[0][0], background)
            inside = lines[32][32]
        _, _, lines = self.render(self.dir / "a.vdb", "--size", 64, "--background", "transparent")
        self.assertEqual((lines[0][0][3], lines[32][32]), (0, (*inside, 255)))
        self.assertTrue(any(0 < color[3] < 255 for line in lines for color in line), "the rim is smooth")
        done = latvox("slice", self.dir / "a.vdb", "--background", "transparent", "-o", self.dir / "a.png", "--size", 200)
        self.assertEqual(done.returncode, OK, done.stderr)
        shown = {color[3] for line in read_png(self.dir / "a.png")[2] for color in line}
        self.assertTrue({0, 255} < shown)

    def test_crops(self):
        write_octahedron(self.dir / "a.vdb", LATTICES["cartesian"], 9)
        grid = pyopenvdb.read(str(self.dir / "a.vdb"), "voxels")
        for x in range(60):
            grid.getAccessor().setValueOn((x, 0, 0), True)
        pyopenvdb.write(str(self.dir / "a.vdb"), grids=[grid])
        width, height, lines = self.render(self.dir / "a.vdb", "--size", 200, "--view", "10,10", "--crop")
        self.assertLess(abs(width - 200), 3)
        self.assertLess(height, 120)
        seen = self.covered(lines)
        for m, size in enumerate((width, height)):
            for margin in (min(p[m] for p in seen), size - 1 - max(p[m] for p in seen)):
                self.assertTrue(1 <= margin <= 5, margin)
        # A layer's frame is that of all layers, or its own.
        sizes = []
        for options in ([], ["--crop"]):
            done = latvox("slice", self.dir / "a.vdb", "--index", 4, "--size", 300, "-o", self.dir / "a.png", *options)
            self.assertEqual(done.returncode, OK, done.stderr)
            sizes.append(read_png(self.dir / "a.png")[:2])
        self.assertLess(sizes[0][1], 0.5 * sizes[0][0])
        self.assertEqual(sizes[1], (300, 300))

    def test_legends(self):
        parts = []
        for n in (0, 1):
            parts.append(self.dir / f"{n}.obj")
            parts[-1].write_text("\n".join([f"v {x + 3 * n} {y} {z}" for x, y, z in octahedron()[0]] + ["f " + " ".join(str(1 + v) for v in t) for t in octahedron()[1]]) + "\n")
        options = ["--resolution", 40, "--fields", "part", "-o", self.dir / "a.vdb"]
        self.assertEqual(latvox("voxelize", *parts, *options).returncode, OK)
        bare = self.render(self.dir / "a.vdb", "--size", 300)
        width, height, lines = self.render(self.dir / "a.vdb", "--size", 300, "--legend")
        self.assertEqual(width, 300)
        self.assertTrue(310 < height < 400)
        self.assertEqual(lines[:300], bare[2], "the picture itself stays")
        below = [color for line in lines[300:] for color in line]
        for color in [(0xE6, 0x9F, 0), (0x56, 0xB4, 0xE9)]:  # of parts 0 and 1
            self.assertGreaterEqual(below.count(color), 64)
        # Slices have one, too. The scale bar is a round number of units.
        done = latvox("slice", self.dir / "a.vdb", "--size", 600, "--legend", "--axis", "z", "-o", self.dir / "s.png")
        self.assertEqual(done.returncode, OK, done.stderr)
        width, height, lines = read_png(self.dir / "s.png")
        colored = [x for line in lines[: height - 40] for x, color in enumerate(line) if max(color) - min(color) > 60]
        dark = [max(len(run) for run in "".join("#" if max(color) < 60 else " " for color in line).split(" ")) for line in lines]
        done = latvox("slice", self.dir / "a.vdb", "--axis", "z", "-o", self.dir / "s.csv")
        self.assertEqual(done.returncode, OK, done.stderr)
        with open(self.dir / "s.csv") as table:
            shown = [float(row["x"]) for row in csv.DictReader(table)]
        voxel = json.loads(latvox("info", "--json", self.dir / "a.vdb").stdout)["metadata"]["latvox_voxel_size"]
        unit = (max(colored) - min(colored)) / (max(shown) - min(shown) + float(voxel))
        self.assertLess(min(abs(max(dark) / unit / length - 1) for length in (0.5, 1, 2)), 0.03)

    def test_bytes_depend_on_no_thread(self):
        write_octahedron(self.dir / "a.vdb", LATTICES["bcc"])
        self.assertEqual(latvox("render", self.dir / "a.vdb", "--size", 300, "-o", self.dir / "all.png").returncode, OK)
        one = [BIN / "latvox", "render", self.dir / "a.vdb", "--size", "300", "-o", self.dir / "one.png"]
        subprocess.run(one, check=True, stdout=subprocess.DEVNULL, preexec_fn=lambda: os.sched_setaffinity(0, [0]))
        self.assertEqual((self.dir / "all.png").read_bytes(), (self.dir / "one.png").read_bytes())

    def test_voxelize_draws_the_same(self):
        self.voxelize(BUNNY, "--lattice", "fcc", "--resolution", 50, "-o", self.dir / "a.vdb", out="a.png")
        self.assertEqual(latvox("render", self.dir / "a.vdb", "-o", self.dir / "b.png").returncode, OK)
        self.assertEqual((self.dir / "a.png").read_bytes(), (self.dir / "b.png").read_bytes())


class Slice(Case):
    def test_layers_are_those_of_the_file(self):
        for lattice, basis in LATTICES.items():
            points = write_octahedron(self.dir / "a.vdb", basis, 5)
            for n, axis in enumerate("xyzijk"):
                m = n % 3
                with self.subTest(lattice, axis=axis):
                    done = latvox("slice", self.dir / "a.vdb", "--axis", axis, "--index", "-1", "-o", self.dir / "a.csv")
                    self.assertEqual(done.returncode, OK, done.stderr)
                    layer = {ijk: point for ijk, point in points.items() if ijk[m] == -1}
                    found = rows(self.dir / "a.csv")
                    self.assertEqual(found.keys(), layer.keys())
                    for ijk, point in layer.items():
                        self.assertLess(max(abs(x - y) for x, y in zip(point, found[ijk])), 1e-12)

    def test_the_middle_layer_is_the_default(self):
        points = write_octahedron(self.dir / "a.vdb", LATTICES["fcc"], 8)
        for options, m in [([], 2), (["--axis", "i"], 0)]:
            done = latvox("slice", self.dir / "a.vdb", "-o", self.dir / "a.csv", *options)
            self.assertEqual(done.returncode, OK, done.stderr)
            middle = (min(ijk[m] for ijk in points) + max(ijk[m] for ijk in points) + 1) // 2
            self.assertEqual(rows(self.dir / "a.csv").keys(), {ijk for ijk in points if ijk[m] == middle})

    def test_pictures_show_as_much_as_there_is(self):
        points = write_octahedron(self.dir / "a.vdb", LATTICES["fcc"], 8)
        for index in (0, 5):
            done = latvox("slice", self.dir / "a.vdb", "--axis=x", f"--index={index}", "--size=240", "-o", self.dir / "a.png")
            self.assertEqual(done.returncode, OK, done.stderr)
            width, height, lines = read_png(self.dir / "a.png")
            self.assertEqual(max(width, height), 240)
            # Cells are blue, the background is not.
            inside = sum(b - r > 20 for line in lines for r, _, b in line)
            voxels = sum(ijk[0] == index for ijk in points)
            if index == 0:
                cell = inside / voxels
            self.assertAlmostEqual(inside / voxels / cell, 1, delta=0.08)


class Compare(Case):
    def compare(self, *arguments):
        done = latvox("compare", *arguments, "--json")
        self.assertEqual(done.stderr, "")
        return done.returncode, json.loads(done.stdout)

    def test_differences_are_those_that_were_made(self):
        a, b = self.dir / "a.vdb", self.dir / "b.vdb"
        points = write_octahedron(a, LATTICES["bcc"], 8)
        self.assertEqual(self.compare(a, a)[0], OK)
        grid = pyopenvdb.read(str(a), "voxels")
        gone, new = [(0, 0, 0), (1, 1, 1)], [(100, -20, 3)]
        for ijk in gone:
            grid.getAccessor().setValueOff(ijk, False)
        for ijk in new:
            grid.getAccessor().setValueOn(ijk, True)
        pyopenvdb.write(str(b), grids=[grid])
        status, report = self.compare(a, b)
        self.assertEqual((status, report["equal"]), (1, False))
        self.assertEqual((report["only_a"], report["only_b"], report["both"]), (2, 1, len(points) - 2))
        self.assertEqual(report["box"], {"min": [0, -20, 0], "max": [101, 2, 4]})
        self.assertEqual({(*d["ijk"], d["only"]) for d in report["first"]}, {(0, 0, 0, "a"), (1, 1, 1, "a"), (100, -20, 3, "b")})
        self.assertAlmostEqual(report["jaccard"], (len(points) - 2) / (len(points) + 1))
        self.assertEqual(report["voxels"], {"a": len(points), "b": len(points) - 1})
        self.assertEqual((report["fields"], report["same_places"]), ([], True))

    def test_fields_differ_without_a_voxel_that_does(self):
        a, b = self.dir / "a.vdb", self.dir / "b.vdb"
        write_octahedron(a, LATTICES["bcc"], 4)
        grid = pyopenvdb.read(str(a), "voxels")
        grid["latvox_lattice"] = "bcc"
        pyopenvdb.write(str(b), grids=[grid])
        status, report = self.compare(a, b)
        self.assertEqual((status, report["only_a"] + report["only_b"]), (1, 0))
        self.assertEqual(report["fields"], [{"name": "latvox_lattice", "a": "", "b": "bcc"}])
        self.assertEqual(self.compare(a, b, "--voxels")[0], OK)
        grid.transform.translate((0, 0, 1))
        pyopenvdb.write(str(b), grids=[grid])
        status, report = self.compare(a, b, "--voxels")
        self.assertEqual((status, report["same_places"]), (1, False))
        done = latvox("compare", a, b)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"origin: .* in A, .* in B\nthe lattices differ: (.*\n)*different\n$")


class Errors(Case):
    def setUp(self):
        super().setUp()
        self.vdb = self.dir / "a.vdb"
        write_octahedron(self.vdb, LATTICES["cartesian"], 5)
        self.no_vdb = self.dir / "octahedron.obj"
        self.no_vdb.write_text("v 0 0 0\n")

    def refused(self, status, pattern, *arguments):
        names = sorted(self.dir.iterdir())
        done = latvox(*arguments)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertRegex(done.stderr, pattern)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertEqual(sorted(self.dir.iterdir()), names, "something was left behind")

    def test_render(self):
        out = ["-o", self.dir / "out.png"]
        for options, status, pattern in [
            ([self.vdb], USAGE, "--out"),
            ([self.vdb, "-o", self.dir / "out.jpg"], USAGE, r"out\.jpg.*\.png"),
            ([self.vdb, *out, "--size", "15"], USAGE, "--size.*15.*16 to 8192"),
            ([self.vdb, *out, "--view", "10,91"], USAGE, "--view.*10,91.*90"),
            ([self.vdb, *out, "--color", "red"], USAGE, "--color.*red.*RRGGBB"),
            ([self.dir / "none.vdb", *out], BAD_INPUT, "none.vdb: no such file"),
            ([self.no_vdb, *out], BAD_INPUT, "octahedron.obj: is neither a .vdb nor a .nvdb file, .*; latvox voxelize reads meshes"),
            ([self.vdb, "-o", self.dir / "none" / "out.png"], OTHER, "none/out.png: cannot be written"),
        ]:
            with self.subTest(pattern):
                self.refused(status, pattern, "render", *options)

    def test_compare_and_slice(self):
        out, none = ["-o", self.dir / "out.png"], self.dir / "none.vdb"
        for status, pattern, *arguments in [
            (USAGE, "required", "compare", self.vdb),
            (BAD_INPUT, "none.vdb: no such file", "compare", self.vdb, none),
            (BAD_INPUT, "is neither a .vdb nor a .nvdb file", "compare", self.no_vdb, self.vdb),
            (USAGE, "--axis.*w", "slice", self.vdb, "--axis", "w", "--index", "0", *out),
            (USAGE, "--index.*1.5", "slice", self.vdb, "--axis", "x", "--index", "1.5", *out),
            (USAGE, "--background.*pink.*RRGGBB", "slice", self.vdb, "--background", "pink", *out),
            (BAD_INPUT, "--index 6 .* -5 to 5 across x", "slice", self.vdb, "--axis", "x", "--index", "6", *out),
            (BAD_INPUT, "none.vdb: no such file", "slice", none, "--axis", "x", "--index", "6", *out),
        ]:
            with self.subTest(pattern, command=arguments[0]):
                self.refused(status, pattern, *arguments)

    def test_an_existing_file_stays_until_the_new_one_is_complete(self):
        out = self.dir / "out.png"
        out.write_bytes(b"old")
        self.refused(BAD_INPUT, "octahedron.obj", "render", self.no_vdb, "-o", out)
        self.assertEqual(out.read_bytes(), b"old")
        self.assertEqual(latvox("render", self.vdb, "--size", 40, "-o", out).returncode, OK)
        self.assertEqual(read_png(out)[:2], (40, 40))


if __name__ == "__main__":
    unittest.main()
