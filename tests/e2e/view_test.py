"""`latvox view`: the page shows the file's content in Chromium, without a network."""

import csv
import filecmp
import json
import math
import pathlib
import re
import subprocess
import tempfile
import time
import unittest

import numpy
import pyopenvdb

from browser import Browser, Tab, decode
from harness import BUNNY, PATIENCE, Case, await_true, children, latvox, octahedron, rows, write_obj
from picture_test import LATTICES, write_octahedron
from silhouettes import CELLS, places, silhouette, write_shape

ROOT = pathlib.Path(__file__).resolve().parents[2]
OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED = range(6)
NORMAL = (-45, 35.264)  # azimuth and elevation; seen against it, nothing below a layer across k of FCC hides any of it
PLACE = f"#axis=k&azimuth={NORMAL[0]}&elevation={NORMAL[1]}"


def rgb(color):
    return numpy.array([int(color[n : n + 2], 16) for n in (1, 3, 5)])


def inner(mask, steps):
    """Returns the pixels of the mask that are at least this far from its rim."""
    for _ in range(steps):
        mask = mask & numpy.roll(mask, 1, 0) & numpy.roll(mask, -1, 0) & numpy.roll(mask, 1, 1) & numpy.roll(mask, -1, 1)
    return mask


class OnPage(Case):
    """A test with a tab, self.tab."""

    def text(self, name):
        return self.tab.run(f"document.getElementById('{name}').innerText")

    def point(self, x, y):
        """Moves the pointer over the canvas. Returns the names and values that the page then shows."""
        box = self.tab.run("(({ x, y }) => [x, y])(document.querySelector('canvas').getBoundingClientRect())")
        self.tab.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + box[0], y=y + box[1])
        self.tab.run("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))")
        shown = self.tab.run("document.getElementById('hover').hidden ? '' : document.getElementById('hover').innerText")
        return dict(re.split(r" {2,}", line.strip()) for line in shown.splitlines())


class View(OnPage):
    """All tests share one browser, which stays until the last test."""

    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.TemporaryDirectory(prefix="latvox-")
        cls.addClassCleanup(cls.home.cleanup)
        cls.browser = Browser(pathlib.Path(cls.home.name))

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        deadline = time.monotonic() + PATIENCE
        while children():
            assert time.monotonic() < deadline, f"processes left over: {children()}"
            time.sleep(0.02)

    def assert_no_process_left(self):
        """Checked at the end of the class instead."""

    def setUp(self):
        super().setUp()
        self.page = self.dir / "page.html"
        self.tab = None

    def view(self, vdb, *options, place="", width=700, height=300, **device):
        done = latvox("view", vdb, "-o", self.page, *options)
        self.assertEqual(done.returncode, OK, done.stderr)
        self.tab = Tab(self.browser, width, height, **device)
        self.addCleanup(self.tab.call, "Page.close")
        self.open(place)

    def open(self, place):
        self.tab.open(f"file://{self.page}{place}")
        self.assertEqual(self.tab.complaints(), [])
        # The test would take anything over the canvas for voxels.
        self.tab.run("for (const name of ['axes', 'tools', 'said']) document.getElementById(name).style.visibility = 'hidden'")

    def canvas(self):
        """Returns the pixels of the canvas, and which of them are not background."""
        box = self.tab.run("(({ x, y, width, height }) => [x, y, width, height])(document.querySelector('canvas').getBoundingClientRect())")
        scale = self.tab.run("devicePixelRatio")
        x, y, width, height = (round(scale * n) for n in box)
        pixels = self.tab.picture()[y : y + height, x : x + width].astype(int)
        return pixels, (pixels != pixels[0, 0]).any(axis=2)

    def assert_shows(self, cells, lattice, azimuth, elevation, seen=None, error=0.02, **how):
        seen = self.canvas()[1] if seen is None else seen
        page, size = json.loads(self.tab.run("JSON.stringify(data)")), seen.shape[::-1]
        expected = silhouette(cells, LATTICES[lattice], CELLS[lattice], page, size, azimuth, elevation, **how)
        self.assertGreater(expected.sum(), 500)
        self.assertLess((seen != expected).sum() / expected.sum(), error)

    def assert_colors(self, colors, error=0.1):
        """Checks colors; `colors`: cell -> red, green, blue, of a layer across k of FCC, seen along its normal."""
        pixels, seen = self.canvas()
        page = json.loads(self.tab.run("JSON.stringify(data)"))
        at = places(colors, LATTICES["fcc"], [(0, 0, 0)], page, seen.shape[::-1], *NORMAL)
        wrong = sum(abs(pixels[int(y), int(x)] - wanted).max() > 8 for ((x, y),), wanted in zip(at, colors.values()))
        self.assertGreater(len(colors), 30)
        self.assertLess(wrong / len(colors), error)

    def test_every_lattice_shows_its_cells(self):
        for lattice, basis in LATTICES.items():
            with self.subTest(lattice):
                cells = write_shape(self.dir / "a.vdb", basis)
                self.view(self.dir / "a.vdb", place="#azimuth=25&elevation=35")
                self.assertEqual(self.text("voxels"), str(len(cells)))
                self.assert_shows(cells, lattice, 25, 35)
                pixels, seen = self.canvas()
                self.assertGreater(len(numpy.unique(pixels[seen], axis=0)), 4, "shades")
                # While it moves, the page draws a point for each voxel, with no gap between them.
                self.tab.run("view.draw('points')")
                self.assert_shows(cells, lattice, 25, 35, error=0.35)
                self.assertLess((inner(seen, 4) & ~self.canvas()[1]).sum() / seen.sum(), 0.003)

    def test_any_axis_may_point_up(self):
        for options, metadata, up in [
            (["--view-up", "x"], {}, "x"),
            (["--view-up", "z"], {}, "z"),
            ([], {"latvox_request": '{"lattice":"fcc","up_axis":"y"}'}, "z"),
            (["--view-up", "y"], {"latvox_request": '{"lattice":"fcc","up_axis":"y"}'}, "y"),
        ]:
            with self.subTest(options=options, **metadata):
                cells = write_shape(self.dir / "a.vdb", LATTICES["fcc"], **metadata)
                self.view(self.dir / "a.vdb", *options, place="#azimuth=0&elevation=20")
                self.assert_shows(cells, "fcc", 0, 20, up=up)
                upright = self.tab.run("'xyz'[data.axes.findIndex(([x, y, z]) => y === 1)]")
                self.assertEqual(upright, up)

    def test_a_mesh_that_was_turned_stands_upright(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        for options, up in [(["--up-axis", "y"], "z"), ([], "y")]:
            self.voxelize(mesh, "--resolution", 6, *options, out="a.vdb")
            self.view(self.dir / "a.vdb")
            self.assertEqual(self.tab.run("'xyz'[data.axes.findIndex(([x, y, z]) => y === 1)]"), up)

    def test_counts_and_certificate_are_those_of_the_file(self):
        summary = self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", 24, out="a.vdb")
        self.view(self.dir / "a.vdb")
        for name in ("voxels", "shown"):
            self.assertEqual(self.text(name), f"{summary['voxels']:,}")
        self.assertEqual(self.text("bricks"), str(summary["bricks"]))
        # Only outer facets, not those between voxels.
        facets = int(self.text("facets").replace(",", "")) / summary["voxels"]
        self.assertTrue(2 < facets < 5, facets)
        self.assertFalse(self.tab.run("document.getElementById('about').open"))
        self.tab.run("document.getElementById('about').open = true")
        self.assertRegex(self.text("certificate"), f"digest\\s+{summary['digest']}")
        self.assertRegex(self.text("certificate"), r"lattice\s+bcc")
        # Long numbers are short, and a click copies them in full.
        self.tab.run("navigator.clipboard.writeText = (text) => Promise.resolve(void (window.copied = text))")
        size = pyopenvdb.read(str(self.dir / "a.vdb"), "voxels")["latvox_voxel_size"]
        cell = "[...document.querySelectorAll('#certificate tr')].find((row) => row.cells[0].innerText === 'voxel_size').cells[1]"
        shown = self.tab.run(f"({cell}.firstChild.click(), {cell}.innerText)")
        self.assertLess(len(shown), 11)
        self.assertAlmostEqual(float(shown), size, delta=1e-5 * size)
        self.assertEqual(float(self.tab.run("copied")), size)

    def test_a_layer_is_that_of_latvox_slice(self):
        cells = write_shape(self.dir / "a.vdb", LATTICES["fcc"])
        place = PLACE + "&layer=1"
        self.view(self.dir / "a.vdb", place=place + "&which=only")
        command = self.text("slice").split()
        self.assertEqual(command, "latvox slice --axis z --index 1".split())
        done = latvox("slice", self.dir / "a.vdb", *command[2:], "-o", self.dir / "slice.csv")
        self.assertEqual(done.returncode, OK, done.stderr)
        layer = list(rows(self.dir / "slice.csv"))
        for name in ("inlayer", "shown"):
            self.assertEqual(self.text(name), str(len(layer)))
        self.assert_shows(layer, "fcc", *NORMAL)

        self.open(place)
        below = [ijk for ijk in cells if ijk[2] <= 1]
        self.assertEqual(self.text("shown"), str(len(below)))
        self.assert_shows(below, "fcc", *NORMAL)
        for detail in ("facets", "points"):
            self.tab.run(f"view.draw('{detail}')")
            pixels, _ = self.canvas()
            marked = pixels[..., 0] > pixels[..., 2] + 20
            self.assert_shows(layer, "fcc", *NORMAL, seen=marked, error=0.03 if detail == "facets" else 0.4)

    def test_a_plane_of_the_world_cuts_everywhere(self):
        for lattice, normal, offset in [("bcc", (1, 0, 0), 0.3), ("fcc", (0, 1, 0), -0.4), ("hexagonal", (1, -2, 0.5), 0.7)]:
            with self.subTest(lattice):
                cells = write_shape(self.dir / "a.vdb", LATTICES[lattice])
                world = {ijk: sum(n * numpy.array(v) for n, v in zip(ijk, LATTICES[lattice])) for ijk in cells}
                height = {ijk: at @ normal / numpy.linalg.norm(normal) for ijk, at in world.items()}
                below = [ijk for ijk in cells if height[ijk] <= offset]
                name = "xyz"[normal.index(1)] if 1 == numpy.linalg.norm(normal) else ",".join(map(str, normal))
                self.view(self.dir / "a.vdb", place=f"#axis={name}&offset={offset}&azimuth=60&elevation=40")
                self.assertLess(len(below), len(cells))
                self.assertEqual(self.text("shown"), str(len(below)))
                self.assert_shows(below, lattice, 60, 40)
                # The slider's ends keep one layer at least, and all.
                ends = "['min', 'max'].map((end) => { const it = document.getElementById('layer'); it.value = it[end]; it.dispatchEvent(new Event('input')); return document.getElementById('shown').innerText; })"
                least, most = self.tab.run(ends)
                self.assertEqual(most, str(len(cells)))
                self.assertEqual(least, str(sum(h < min(height.values()) + 1e-6 for h in height.values())))
        self.tab.run("(document.getElementById('normal').value = '1,2', document.getElementById('normal').dispatchEvent(new Event('change')))")
        self.assertFalse(self.tab.run("document.getElementById('normal').validity.valid"))
        self.assertEqual(self.text("shown"), str(len(cells)))

    def test_a_cut_through_small_cells_is_smooth(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        self.voxelize(mesh, "--lattice", "fcc", "--resolution", 90, "--set", "solid", out="a.vdb")
        self.view(self.dir / "a.vdb", place="#axis=k&layer=45&azimuth=-20&elevation=20")
        pixels, _ = self.canvas()
        marked = pixels[..., 0] > pixels[..., 2] + 20
        marked = inner(marked, 4)
        self.assertGreater(marked.sum(), 1000)
        self.assertLess(pixels[marked].std(axis=0).max(), 8)

    def test_a_hollow_that_is_cut_open_has_no_specks(self):
        self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", 160, out="a.vdb")
        self.view(self.dir / "a.vdb", place="#axis=i&layer=0&azimuth=80&elevation=20", width=900, height=500)
        pixels, seen = self.canvas()
        light, marked = pixels.sum(axis=2), pixels[..., 0] > pixels[..., 2] + 20
        darkest = numpy.min([numpy.roll(light, shift, axis) for shift in (-1, 1) for axis in (0, 1)], axis=0)
        shown = inner(seen & ~marked, 3)
        self.assertGreater(shown.sum(), 20000)
        self.assertLess((shown & (light < darkest - 120)).sum(), 10)

    def test_the_pointer_reads_the_voxel_in_front(self):
        basis, view = LATTICES["bcc"], (25, 35)
        cells = write_shape(self.dir / "a.vdb", basis)
        self.view(self.dir / "a.vdb", place="#azimuth=25&elevation=35")
        seen, page = self.canvas()[1], json.loads(self.tab.run("JSON.stringify(data)"))
        outlines = list(places(cells, basis, CELLS["bcc"], page, seen.shape[::-1], *view))
        a, e = map(math.radians, view)
        world = numpy.array(cells) @ basis
        near = world @ (math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a))
        middles = numpy.array([outline.mean(0) for outline in outlines])
        read = 0
        for y, x in numpy.argwhere(seen)[::997]:
            shown = self.point(int(x), int(y))
            if not shown:
                continue  # the corner of a pixel at the silhouette
            n = cells.index(tuple(int(n) for n in shown["i, j, k"].split(", ")))
            self.assertTrue((outlines[n].min(0) <= (x + 1, y + 1)).all() and (outlines[n].max(0) >= (x, y)).all())
            self.assertLess(abs(world[n] - [float(n) for n in shown["x, y, z"].split(", ")]).max(), 1e-4)
            under = abs(middles - (x, y)).max(1) < 3
            self.assertGreater(near[n] + 1.5, near[under].max(initial=-99), "another voxel hides it")
            read += 1
        self.assertGreater(read, 5)
        self.assertEqual(self.point(3, 3), {})

    def test_the_pointer_reads_values(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        self.voxelize(mesh, "--resolution", 16, "--band", "3v", out="a.vdb")
        self.view(self.dir / "a.vdb", place="#axis=k&azimuth=0&elevation=5")
        grid = pyopenvdb.readAll(str(self.dir / "a.vdb"))[0][0]
        values = {tuple(item.min): item.value for item in grid.citerOnValues()}
        self.tab.run("navigator.clipboard.writeText = (text) => Promise.resolve(void (window.copied = text))")
        read = set()
        for x in range(120, 260, 20):
            if shown := self.point(x, 140):
                ijk = tuple(int(n) for n in shown["i, j, k"].split(", "))
                self.assertAlmostEqual(float(shown["distance"]), values[ijk], delta=1e-5)
                self.tab.key("c")
                copied = dict(part.split(" = ") for part in self.tab.run("copied").split("; "))
                self.assertEqual(numpy.float32(copied["distance"]), numpy.float32(values[ijk]))
                self.assertEqual(copied["i, j, k"], ",".join(map(str, ijk)))
                read.add(ijk)
        self.assertGreater(len(read), 2)

    def test_the_pointer_reads_names(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        mesh.write_text("o tail of\n" + mesh.read_text())
        self.voxelize(mesh, "--resolution", 8, "--fields", "part", out="a.vdb")
        self.view(self.dir / "a.vdb", place="#azimuth=0&elevation=5")
        self.assertEqual(self.point(189, 150)["part"], "0 (tail of)")

    def test_tools(self):
        cells = write_shape(self.dir / "a.vdb", LATTICES["cartesian"])
        self.view(self.dir / "a.vdb", place="#azimuth=25&elevation=35")
        click = lambda name: (self.tab.run(f"document.getElementById('{name}').click()"), self.tab.rest())
        self.tab.run("view.look(80, -20, 3)")
        self.tab.rest()
        click("home")
        self.assert_shows(cells, "cartesian", 25, 35)
        self.tab.run("view.look(25, 35, 2)")
        self.tab.rest()
        with_edges, seen = self.canvas()
        click("edges")
        without, _ = self.canvas()
        self.assertEqual(self.tab.run("document.getElementById('edges').ariaPressed"), "false")
        self.assertGreater((with_edges[seen].sum(axis=1) < without[seen].sum(axis=1) - 30).mean(), 0.05)
        self.assertFalse((with_edges[seen] > without[seen] + 2).any(), "edges are dark lines")
        for key in ("?", "?"):
            self.tab.key(key)
        self.assertFalse(self.tab.run("document.getElementById('help').open"))
        click("ask")
        self.assertIn("Home", self.text("help"))
        self.tab.run("document.querySelector('#help button').click()")
        # The saved picture is what the page shows.
        self.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self.dir))
        click("save")
        await_true("no picture", (self.dir / "a.png").exists)
        self.assertEqual(abs(decode((self.dir / "a.png").read_bytes()).astype(int) - without).max(), 0)

    def test_a_band_is_cut_open_and_colored_by_distance(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        self.voxelize(mesh, "--lattice", "fcc", "--resolution", 16, "--band", "3v", "--signed", out="a.vdb")
        self.view(self.dir / "a.vdb", place=PLACE)
        grid = pyopenvdb.readAll(str(self.dir / "a.vdb"))[0][0]
        values = {tuple(item.min): item.value for item in grid.citerOnValues()}
        layer = int(self.text("at").partition("= ")[2])
        self.assertEqual(layer, (min(k for _, _, k in values) + max(k for _, _, k in values) + 1) // 2)
        low, zero, high = map(float, self.text("legend").split())
        self.assertEqual((low, zero), (-high, 0))
        self.assertAlmostEqual(high, grid.metadata["latvox_band_width"], delta=1e-3 * high)
        ramp = numpy.array([rgb(color) for color, _ in json.loads(self.tab.run("JSON.stringify(data.paints[0].legend)"))])
        self.assertGreater(ramp[0, 2], 2 * ramp[0, 0], "blue inside")
        self.assertGreater(ramp[-1, 0], 2 * ramp[-1, 2], "red outside")
        shade = lambda value: [numpy.interp(value, numpy.linspace(low, high, len(ramp)), ramp[:, m]) for m in range(3)]
        colors = {ijk: shade(value) for ijk, value in values.items() if ijk[2] == layer}
        self.assert_colors(colors)
        self.tab.run("view.draw('points')")
        self.assert_colors(colors, error=0.3)

    def test_attributes_are_colors(self):
        parts = []
        for n, (move, tint) in enumerate([(0, "1 0 0"), (1.2, "0 1 0")]):
            vertices, triangles = octahedron()
            lines = [f"v {x + move} {y} {z} {tint}" for x, y, z in vertices]
            parts.append(self.dir / f"{n}.obj")
            parts[-1].write_text("\n".join(lines + ["f " + " ".join(str(1 + v) for v in t) for t in triangles]) + "\n")
        options = ["--lattice", "fcc", "--resolution", 24, "--fields", "part,color", "-o", self.dir / "a.vdb", "-o", self.dir / "a.csv"]
        self.assertEqual(latvox("voxelize", *parts, *options).returncode, OK)
        with open(self.dir / "a.csv") as lines:
            numbers = {tuple(int(row[n]) for n in "ijk"): int(row["part"]) for row in csv.DictReader(lines)}
        layer = sorted(k for _, _, k in numbers)[len(numbers) // 2]
        cut = {ijk: part for ijk, part in numbers.items() if ijk[2] == layer}
        self.view(self.dir / "a.vdb", place=f"{PLACE}&layer={layer}")
        self.assertEqual(self.tab.run("[...document.getElementById('by').options].map((it) => it.text)"), ["color", "part", "none"])
        self.assert_colors({ijk: [(255, 0, 0), (0, 255, 0)][part] for ijk, part in cut.items()})
        self.open(f"{PLACE}&layer={layer}&by=part")
        counts = [list(numbers.values()).count(part) for part in (0, 1)]
        self.assertEqual(self.text("legend").splitlines(), [f"part {n} ({n}.obj): {count} voxels" for n, count in enumerate(counts)])
        shown = [rgb(color) for color, _ in json.loads(self.tab.run("JSON.stringify(data.paints[1].legend)"))]
        self.assertGreater(abs(numpy.subtract(*shown)).max(), 64)
        self.assert_colors({ijk: shown[part] for ijk, part in cut.items()})
        for x in range(150, 240, 15):
            if shown := self.point(x, 150):
                part = numbers[tuple(int(n) for n in shown["i, j, k"].split(", "))]
                self.assertEqual((shown["part"], shown["color"]), (f"{part} ({part}.obj)", ["#ff0000", "#00ff00"][part]))
        self.assertIn("part", shown)
        self.open(f"{PLACE}&layer={layer}&by=none")
        self.assertEqual(self.text("legend"), "")
        pixels, seen = self.canvas()
        self.assertGreater((pixels[..., 2] > pixels[..., 0])[seen].mean(), 0.5)

    def test_fields_of_the_nearest_triangle_are_colors(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        self.voxelize(mesh, "--lattice", "fcc", "--resolution", 24, "--fields", "normal,triangle,point", "-o", self.dir / "a.csv", out="a.vdb")
        with open(self.dir / "a.csv") as lines:
            table = {tuple(int(row[n]) for n in "ijk"): row for row in csv.DictReader(lines)}
        layer = sorted(k for _, _, k in table)[len(table) // 2]
        self.view(self.dir / "a.vdb", place=f"{PLACE}&layer={layer}&by=normal")
        names = self.tab.run("[...document.getElementById('by').options].map((it) => it.text)")
        self.assertEqual(set(names), {"normal", "triangle", "point", "none"})
        normals = {ijk: [float(row[name]) for name in ("nx", "ny", "nz")] for ijk, row in table.items()}
        self.assert_colors({ijk: (numpy.array(n) + 1) / 2 * 255 for ijk, n in normals.items() if ijk[2] == layer})
        seen = 0
        for x in range(150, 240, 15):
            if shown := self.point(x, 150):
                ijk, seen = tuple(int(n) for n in shown["i, j, k"].split(", ")), seen + 1
                self.assertEqual(shown["triangle"], table[ijk]["triangle"])
                for name, columns in (("normal", ("nx", "ny", "nz")), ("point", ("u", "v"))):
                    found = [float(number) for number in shown[name].split(", ")]
                    numpy.testing.assert_allclose(found, [float(table[ijk][column]) for column in columns], rtol=1e-5)
        self.assertGreater(seen, 0)

    def test_fractions_of_labels_are_colors(self):
        parts = [write_obj(self.dir / "lid.obj", octahedron()), write_obj(self.dir / "pin.obj", octahedron(0.5))]
        options = ["--resolution", 16, "--set", "solid", "--labels", "part", "--fields", "label_fractions:4"]
        done = latvox("voxelize", *parts, *options, "-o", self.dir / "a.vdb", "-o", self.dir / "a.csv")
        self.assertEqual(done.returncode, OK, done.stderr)
        with open(self.dir / "a.csv") as lines:
            table = {tuple(int(row[n]) for n in "ijk"): row for row in csv.DictReader(lines)}
        layer = sorted(k for _, _, k in table)[len(table) // 2]
        self.view(self.dir / "a.vdb", place=f"#axis=k&layer={layer}&which=only&azimuth=0&elevation=5&by=label_fractions")
        names = ["label_fractions", "fraction_0 (lid.obj)", "fraction_1 (pin.obj)"]
        self.assertEqual(self.tab.run("[...document.getElementById('by').options].map((it) => it.text)"), ["part", *names, "none"])
        voxels = [sum(int(row[f"fraction_{n}"]) for row in table.values()) / 64 for n in (0, 1)]
        wanted = [f"label {n} ({name}.obj): {voxels[n]:.1f} voxels" for n, name in enumerate(("lid", "pin"))]
        self.assertEqual(self.text("legend").replace(",", "").splitlines(), [*wanted, "elsewhere"])
        read = set()
        for x in range(120, 260, 20):
            if shown := self.point(x, 150):
                row = table[tuple(int(n) for n in shown["i, j, k"].split(", "))]
                self.assertEqual([shown[name] for name in names[1:]], [row["fraction_0"], row["fraction_1"]])
                self.assertNotIn("label_fractions", shown)
                read.add(row["fraction_1"])
        self.assertGreater(len(read), 1)

    def test_slow_pages_draw_points_until_they_rest(self):
        cells = write_shape(self.dir / "a.vdb", LATTICES["bcc"])
        self.view(self.dir / "a.vdb")
        drawn = """(async () => {
          view.cost = 400;  // milliseconds
          const seen = new Set();
          for (let n = 0; n < 5; ++n) {
            view.look(10 * n, 22, view.controls.getDistance());
            await new Promise(requestAnimationFrame);
            seen.add(view.drawn);
          }
          return [...seen];
        })()"""
        self.assertEqual(self.tab.run(drawn)[-1], "points")
        self.tab.rest()
        self.assertEqual(self.tab.run("view.drawn"), "facets")
        self.assert_shows(cells, "bcc", 40, 22)
        self.assertEqual(self.tab.run("(view.cost = 1, view.change(), new Promise(requestAnimationFrame).then(() => view.drawn))"), "facets")

    def test_a_device_that_is_lost_comes_back(self):
        cells = write_shape(self.dir / "a.vdb", LATTICES["fcc"])
        self.view(self.dir / "a.vdb")
        event = "new Promise((resolve) => view.renderer.domElement.addEventListener('webglcontext%s', resolve))"
        for does, name, told in [("Loss", "lost", "lost; waiting"), ("Restore", "restored", "^$")]:
            self.tab.run(f"(() => {{ const done = {event % name}; view.renderer.forceContext{does}(); return done.then(() => 1); }})()")
            self.tab.rest()
            self.assertRegex(self.text("error"), told)
        self.assert_shows(cells, "fcc", 30, 22)
        self.assertEqual(len(self.tab.complaints()), 2)  # three.js reports it, too

    def test_no_voxel_is_an_empty_page(self):
        pyopenvdb.write(str(self.dir / "a.vdb"), grids=[pyopenvdb.BoolGrid()])
        self.view(self.dir / "a.vdb")
        self.assertEqual((self.text("voxels"), self.text("facets")), ("0", "0"))
        self.assertFalse(self.canvas()[1].any())

    def test_keys_turn_and_come_nearer(self):
        cells = write_shape(self.dir / "a.vdb", LATTICES["hexagonal"])
        self.view(self.dir / "a.vdb", place="#azimuth=10&elevation=20")
        self.tab.run("document.querySelector('canvas').focus()")
        for key in ("ArrowRight", "ArrowRight", "ArrowUp", "+"):
            self.tab.key(key)
        self.tab.run("document.activeElement.blur()")  # without the line about the focus
        self.tab.rest()
        self.assert_shows(cells, "hexagonal", 30, 30, distance=0.8)
        self.tab.run("document.querySelector('canvas').focus()")
        self.tab.key("Home")
        self.tab.run("document.activeElement.blur()")
        self.tab.rest()
        self.assert_shows(cells, "hexagonal", 10, 20)
        self.tab.run("document.getElementById('layer').focus()")
        highest = int(self.tab.run("document.getElementById('layer').value"))
        self.tab.key("ArrowLeft")
        self.assertEqual(self.text("at"), f"k = {highest - 1}")

    def test_a_phone(self):
        cells = write_shape(self.dir / "a.vdb", LATTICES["bcc"])
        self.view(self.dir / "a.vdb", width=390, height=700, scale=2, phone=True)
        self.assertEqual(self.tab.run("[devicePixelRatio, document.documentElement.scrollWidth]"), [2, 390])
        self.assert_shows(cells, "bcc", 30, 22)
        before = self.canvas()[1].sum()
        hidden = """[...document.querySelectorAll('#counts td, #panel summary, #layer')].filter((it) => {
          const { left, right, bottom, height } = it.getBoundingClientRect();
          return left < 0 || right > innerWidth || bottom > innerHeight || height < 16;
        }).length"""
        self.assertEqual(self.tab.run(hidden), 0)
        self.tab.run("document.querySelector('summary').click()")
        self.assertEqual(self.tab.run("document.documentElement.scrollWidth"), 390)
        # Two fingers that part, then one that draws.
        self.tab.touch(*[[(195 - d, 200), (195 + d, 200)] for d in range(30, 100, 10)])
        self.tab.rest()
        nearer = self.canvas()[1]
        self.assertGreater(nearer.sum(), 1.3 * before)
        self.tab.touch(*[[(150 + d, 200)] for d in range(0, 100, 10)])
        self.tab.rest()
        self.assertGreater((self.canvas()[1] != nearer).sum(), 0.02 * nearer.sum())

    def test_light_dark_and_another_size(self):
        cells = write_shape(self.dir / "a.vdb", LATTICES["cartesian"])
        style = "((it) => [it.color, getComputedStyle(document.getElementById('panel')).backgroundColor])(getComputedStyle(%s))"
        for dark in (False, True):
            self.view(self.dir / "a.vdb", dark=dark)
            pixels, _ = self.canvas()
            self.assertEqual(pixels[0, 0].sum() < 3 * 64, dark)
            for what in ("document.body", "document.querySelector('th')", "document.querySelector('.quiet')"):
                colors = [[int(n) / 255 for n in re.findall(r"\d+", color)[:3]] for color in self.tab.run(style % what)]
                light = sorted(sum(w * c**2.2 for w, c in zip((0.2126, 0.7152, 0.0722), color)) + 0.05 for color in colors)
                self.assertGreater(light[1] / light[0], 4.5, what)
        self.tab.resize(900, 500)
        self.tab.rest()
        self.assert_shows(cells, "cartesian", 30, 22)
        self.assertGreater(self.canvas()[1].shape[1], 500)


class Flat(OnPage):
    """Without WebGL the page draws one layer."""

    def test_a_layer_can_be_seen_and_read(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        self.voxelize(mesh, "--lattice", "fcc", "--resolution", 24, "--band", "3v", "--signed", out="a.vdb")
        self.assertEqual(latvox("view", self.dir / "a.vdb", "-o", self.dir / "a.html").returncode, OK)
        grid = pyopenvdb.readAll(str(self.dir / "a.vdb"))[0][0]
        values = {tuple(item.min): item.value for item in grid.citerOnValues()}
        browser = Browser(self.dir, "--disable-gpu", "--disable-3d-apis")
        self.addCleanup(browser.close)
        self.tab = Tab(browser, 700, 300)
        for place, inside in [("#axis=k", lambda ijk: ijk[2] == layer), ("#axis=1,1,0&offset=0.1", lambda ijk: True)]:
            self.tab.open(f"file://{self.dir}/a.html{place}")
            self.assertEqual(self.tab.complaints(), [])
            self.assertRegex(self.text("error"), "no WebGL 2, so the page shows one layer")
            if place == "#axis=k":
                layer = int(self.text("at").partition("= ")[2])
                self.assertEqual(self.text("shown"), str(sum(k == layer for _, _, k in values)))
            self.tab.run("document.getElementById('edges').click()")
            pixels = self.tab.picture().astype(int)
            low, _, high = map(float, self.text("legend").split())
            ramp = numpy.array([rgb(color) for color, _ in json.loads(self.tab.run("JSON.stringify(data.paints[0].legend)"))])
            left = self.tab.run("document.querySelector('canvas').getBoundingClientRect().x")
            read, wrong = set(), 0
            for x in range(10, 370, 12):
                for y in range(10, 290, 40):
                    shown = self.point(x, y)
                    color = pixels[y, x + int(left)]
                    if not shown:
                        continue
                    ijk = tuple(int(n) for n in shown["i, j, k"].split(", "))
                    self.assertTrue(inside(ijk))
                    self.assertAlmostEqual(float(shown["distance"]), values[ijk], delta=1e-5)
                    wanted = [numpy.interp(values[ijk], numpy.linspace(low, high, len(ramp)), ramp[:, m]) for m in range(3)]
                    wrong += abs(color - wanted).max() > 12
                    read.add(ijk)
            self.assertGreater(len(read), 20)
            self.assertLess(wrong / len(read), 0.2)  # smooth borders


class Page(Case):
    def test_errors_and_what_is_left_of_them(self):
        page = self.dir / "page.html"
        page.write_text("old")
        no_vdb = self.dir / "a.obj"
        no_vdb.write_text("v 0 0 0\n")
        write_octahedron(self.dir / "a.vdb", LATTICES["cartesian"], 2)
        for status, pattern, *arguments in [
            (USAGE, "--out", self.dir / "a.vdb"),
            (USAGE, r"page\.png.*\.html", self.dir / "a.vdb", "-o", self.dir / "page.png"),
            (USAGE, "--view-up", self.dir / "a.vdb", "-o", page, "--view-up", "w"),
            (BAD_INPUT, "none.vdb: no such file", self.dir / "none.vdb", "-o", page),
            (BAD_INPUT, "a.obj: is neither a .vdb nor a .nvdb file", no_vdb, "-o", page),
        ]:
            with self.subTest(pattern):
                done = latvox("view", *arguments)
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertRegex(done.stderr, pattern)
        grid = pyopenvdb.BoolGrid()
        for far in (0, 70000):
            grid.getAccessor().setValueOn((0, far, 0), True)
        pyopenvdb.write(str(self.dir / "far.vdb"), grids=[grid])
        many = pyopenvdb.BoolGrid()
        many.copyFromArray(numpy.indices((200, 200, 201)).sum(axis=0) % 2 == 0)
        pyopenvdb.write(str(self.dir / "many.vdb"), grids=[many])
        skew = pyopenvdb.BoolGrid()
        skew.getAccessor().setValueOn((0, 0, 0), True)
        skew.transform = pyopenvdb.createLinearTransform([[1, 0, 0, 0], [0, 1, 0, 0], [9.3, 0, 1, 0], [0, 0, 0, 1]])
        pyopenvdb.write(str(self.dir / "skew.vdb"), grids=[skew])
        for name, pattern in [("skew", "the step -?9,0,-?1 to a neighbor exceeds the limit of 8 of a page"),
                              ("far", "70001 voxels on axis j exceed the limit of 65536 of a page; .*--bounds"),
                              ("many", "4020000 voxels exceed the limit of 4000000 of a page; .*--bounds.*--resolution")]:  # fmt: skip
            done = latvox("view", self.dir / f"{name}.vdb", "-o", page)
            self.assertEqual(done.returncode, REFUSED, done.stderr)
            self.assertRegex(done.stderr, f"{name}.vdb: {pattern}")
        self.assertEqual(page.read_text(), "old")
        self.assertEqual(sorted(p.name for p in self.dir.iterdir()), ["a.obj", "a.vdb", "far.vdb", "many.vdb", "page.html", "skew.vdb"])

    def test_voxelize_and_batch_write_the_page_of_the_grid(self):
        mesh = write_obj(self.dir / "a.obj", octahedron())
        for options in (["--lattice", "bcc"], ["--band", "2v"], ["--fields", "part"], ["--up-axis", "y"]):
            with self.subTest(options):
                self.voxelize(mesh, "--resolution", 9, *options, "-o", self.dir / "a.vdb", out="a.html")
                self.assertEqual(latvox("view", self.dir / "a.vdb", "-o", self.dir / "b.html").returncode, OK)
                viewed = (self.dir / "b.html").read_text().replace('"title":"a.vdb"', '"title":"a"')
                self.assertEqual((self.dir / "a.html").read_text(), viewed)
        jobs = self.dir / "jobs.jsonl"
        jobs.write_text(json.dumps({"mesh": str(mesh), "resolution": 9, "up_axis": "y", "out": "c.html"}) + "\n")
        self.assertEqual(latvox("batch", jobs, "--out", self.dir).returncode, OK)
        self.assertEqual((self.dir / "c.html").read_text().replace('"title":"c"', '"title":"a"'), viewed)
        self.assertEqual([it.name for it in self.dir.iterdir() if it.name.startswith(".")], [])

    def test_nothing_is_loaded_from_elsewhere(self):
        write_octahedron(self.dir / "a.vdb", LATTICES["fcc"], 3)
        self.assertEqual(latvox("view", self.dir / "a.vdb", "-o", self.dir / "page.html").returncode, OK)
        page = (self.dir / "page.html").read_text()
        self.assertNotRegex(page, r"<(script|link|img|iframe)[^>]*\s(src|href)=")
        self.assertIn("Permission is hereby granted, free of charge", page)
        self.assertNotIn("{{", re.sub(r"<script>.*?</script>", "", page, flags=re.S))

    def test_the_library_is_what_its_packages_make(self):
        view = ROOT / "client" / "tool" / "view"
        with open(self.dir / "three.js", "wb") as out:
            subprocess.run([view / "bundle"], check=True, stdout=out, timeout=PATIENCE)
        self.assertTrue(filecmp.cmp(self.dir / "three.js", view / "three.js", shallow=False), "run client/tool/view/bundle")


if __name__ == "__main__":
    unittest.main()
