"""`latvox view`: the page shows in Chromium, without a network, what the file holds."""

import filecmp
import os
import pathlib
import re
import subprocess
import unittest

import pyopenvdb

from harness import BUNNY, PATIENCE, Case, latvox
from picture_test import LATTICES, read_png, write_octahedron

ROOT = pathlib.Path(__file__).resolve().parents[2]
OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED = range(6)
WIDTH, HEIGHT = 800, 360
PANEL = 330  # pixels on the left, at most


class View(Case):
    def setUp(self):
        super().setUp()
        self.page = self.dir / "page.html"

    def view(self, vdb):
        done = latvox("view", vdb, "-o", self.page)
        self.assertEqual(done.returncode, OK, done.stderr)

    def chromium(self, what, place=""):
        """Runs the browser on the page; its standard output. No line of its console may be an error."""
        command = ["chromium", "--headless", "--no-sandbox", f"--user-data-dir={self.dir}/profile", "--disable-gpu-sandbox",
                   "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--host-resolver-rules=MAP * ~NOTFOUND",
                   "--disable-background-networking", "--no-first-run", "--enable-logging=stderr", "--hide-scrollbars",
                   f"--window-size={WIDTH},{HEIGHT}", "--virtual-time-budget=5000", what, f"file://{self.page}{place}"]  # fmt: skip
        environment = {**os.environ, "HOME": str(self.dir), "XDG_RUNTIME_DIR": str(self.dir)}
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, cwd=self.dir, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = [line for line in done.stderr.splitlines() if "CONSOLE" in line and "GPU stall" not in line]
        self.assertEqual(said, [], "the page's console")
        return done.stdout

    def told(self, place=""):
        """What the page says of the voxels: name -> number."""
        dom = self.chromium("--dump-dom", place)
        self.assertIn('data-drawn="yes"', dom)
        return {name: int(value) for name, value in re.findall(r'<td id="(\w+)">(\d+)', dom)}, dom

    def look(self, place=""):
        """The picture beside the panel: (x, y) -> colour of all that is not background."""
        self.chromium(f"--screenshot={self.dir}/page.png", place)
        width, height, lines = read_png(self.dir / "page.png")
        self.assertEqual((width, height), (WIDTH, HEIGHT))
        background = lines[HEIGHT - 1][WIDTH - 1]
        return {(x, y): c for y, line in enumerate(lines) for x, c in enumerate(line) if c != background and x > PANEL}

    def test_counts_are_those_of_the_file(self):
        summary = self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", 24, out="a.vdb")
        self.view(self.dir / "a.vdb")
        told, dom = self.told()
        self.assertEqual((told["voxels"], told["shown"]), (summary["voxels"],) * 2)
        self.assertEqual(told["bricks"], summary["bricks"])
        # A surface has facets on both sides, and not those between its voxels.
        self.assertTrue(4 * told["voxels"] < told["facets"] < 10 * told["voxels"], told)
        self.assertRegex(dom, f"digest</th><td>{summary['digest']}")
        self.assertRegex(dom, "lattice</th><td>bcc")

    def test_a_cut_shows_what_is_below(self):
        points = write_octahedron(self.dir / "a.vdb", LATTICES["fcc"], 6)
        self.view(self.dir / "a.vdb")
        told, _ = self.told("#axis=i&layer=-1")
        self.assertEqual(told["voxels"], len(points))
        self.assertEqual(told["shown"], sum(i <= -1 for i, _, _ in points))

    def test_the_shape_is_seen(self):
        write_octahedron(self.dir / "a.vdb", LATTICES["bcc"], 8)
        self.view(self.dir / "a.vdb")
        seen = self.look("#azimuth=0&elevation=0")
        # From z, a square on its corner: half of its box.
        (left, right), (top, bottom) = ((min(xs), max(xs)) for xs in zip(*seen))
        self.assertGreater(bottom - top, HEIGHT / 3)
        self.assertAlmostEqual((top + bottom) / 2, HEIGHT / 2, delta=3)
        self.assertAlmostEqual((right - left) / (bottom - top), 1, delta=0.1)
        self.assertTrue(0.4 < len(seen) / ((right - left) * (bottom - top)) < 0.65, len(seen))
        self.assertGreater(len(set(seen.values())), 20)
        cut = self.look("#azimuth=0&elevation=0&axis=j&layer=-3")
        self.assertLess(len(cut), 0.8 * len(seen))
        self.assertGreater(len(cut), 0.1 * len(seen))

    def test_errors_and_what_is_left_of_them(self):
        self.page.write_text("old")
        no_vdb = self.dir / "a.obj"
        no_vdb.write_text("v 0 0 0\n")
        write_octahedron(self.dir / "a.vdb", LATTICES["cartesian"], 2)
        for status, pattern, *arguments in [
            (USAGE, "--out", self.dir / "a.vdb"),
            (USAGE, r"page\.png.*\.html", self.dir / "a.vdb", "-o", self.dir / "page.png"),
            (BAD_INPUT, "none.vdb: no such file", self.dir / "none.vdb", "-o", self.page),
            (BAD_INPUT, "a.obj: is not a readable .vdb file", no_vdb, "-o", self.page),
        ]:
            with self.subTest(pattern):
                done = latvox("view", *arguments)
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertRegex(done.stderr, pattern)
        grid = pyopenvdb.BoolGrid()
        for far in (0, 70000):
            grid.getAccessor().setValueOn((0, far, 0), True)
        pyopenvdb.write(str(self.dir / "far.vdb"), grids=[grid])
        done = latvox("view", self.dir / "far.vdb", "-o", self.page)
        self.assertEqual(done.returncode, REFUSED, done.stderr)
        self.assertRegex(done.stderr, "far.vdb: 70001 voxels on axis j are over the 65536 of a page")
        self.assertEqual(self.page.read_text(), "old")
        self.assertEqual(sorted(p.name for p in self.dir.iterdir()), ["a.obj", "a.vdb", "far.vdb", "page.html"])


class Page(Case):
    def test_nothing_is_loaded_from_elsewhere(self):
        write_octahedron(self.dir / "a.vdb", LATTICES["fcc"], 3)
        self.assertEqual(latvox("view", self.dir / "a.vdb", "-o", self.dir / "page.html").returncode, OK)
        page = (self.dir / "page.html").read_text()
        self.assertNotRegex(page, r"<(script|link|img|iframe)[^>]*\s(src|href)=")
        self.assertIn("Permission is hereby granted, free of charge", page)
        self.assertNotIn("{{", re.sub(r"<script>.*?</script>", "", page, flags=re.S))

    def test_the_library_is_what_its_packages_make(self):
        view = ROOT / "client" / "view"
        with open(self.dir / "three.js", "wb") as out:
            subprocess.run([view / "bundle"], check=True, stdout=out, timeout=PATIENCE)
        self.assertTrue(filecmp.cmp(self.dir / "three.js", view / "three.js", shallow=False), "run client/view/bundle")


if __name__ == "__main__":
    unittest.main()
