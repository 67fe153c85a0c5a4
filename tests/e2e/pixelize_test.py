"""Drawings become pixels: without tunnels or redundant pixels, the same from every file format, and with clear
errors."""

import json
import pathlib
import unittest
from urllib.parse import quote

import harness
import numpy
from browser import Browser, Tab
from harness import Case, latvox

OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED, STOPPED = range(7)
DRAWINGS = pathlib.Path(__file__).resolve().parent / "drawings"
NAMES = ("circle.svg", "star.svg", "word.svg", "shapes.svg")


def pixels(csv):
    """Returns (i, j) -> (x, y) of a .csv file, in the file's order."""
    lines = csv.read_text().splitlines()
    assert lines[0] == "i,j,x,y", lines[0]
    rows = [line.split(",") for line in lines[1:]]
    found = {(int(i), int(j)): (float(x), float(y)) for i, j, x, y in rows}
    assert list(found) == sorted(found) and len(found) == len(rows), "out of order, or twice"
    return found


class Pixelize(Case):
    def pixelize(self, drawing, *options):
        """Returns summary and pixels of a run that must succeed."""
        out = self.dir / "out.csv"
        done = latvox("pixelize", drawing, "-o", out, "--json", *options)
        self.assertEqual(done.returncode, OK, done.stderr)
        return json.loads(done.stdout), pixels(out)

    def test_drawings_have_neither_tunnels_nor_redundant_pixels(self):
        with harness.server(self.dir) as server:
            for name in NAMES:
                for lattice in ("square", "hexagonal"):
                    for k in (0, 1):
                        with self.subTest(name, lattice=lattice, separability=k):
                            options = ["--lattice", lattice, "--separability", k, "--server", server.address]
                            summary, found = self.pixelize(DRAWINGS / name, "--resolution", 150, *options)
                            certificate = summary["certificate"]
                            self.assertEqual((certificate["tunnels"], certificate["redundant"]), (0, 0))
                            self.assertEqual(summary["pixels"], len(found))
                            self.assertEqual((summary["lattice"], summary["separability"]), (lattice, k))
                            self.assertGreater(len(found), 300)
                            self.check_positions(summary, found)

    def check_positions(self, summary, found):
        (a, b, c, d), (x, y) = summary["basis"], summary["origin"]
        for (i, j), position in found.items():
            self.assertEqual(position, (x + i * a + j * c, y + i * b + j * d))

    def test_a_circle_holds_its_radius(self):
        """Every pixel's center lies within half a step of the circle of radius 4. The pixels go all around it."""
        summary, found = self.pixelize(DRAWINGS / "circle.svg", "--pixel-size", 0.1, "--separability", 1)
        for x, y in found.values():
            self.assertAlmostEqual((x * x + y * y) ** 0.5, 4, delta=0.075)
        self.assertEqual({(x > 0, y > 0) for x, y in found.values()}, {(s, t) for s in (True, False) for t in (True, False)})
        self.assertGreater(len(found), 2**0.5 * 4 * 40 - 8)  # at least one for each column and row of an octant

    def test_the_file_format_does_not_matter(self):
        for options in (["--resolution", 100], ["--basis", "0.25,0,0.1,0.2", "--origin", "1,-2"]):
            with self.subTest(options):
                one, other = (self.pixelize(DRAWINGS / f"star{suffix}", *options) for suffix in (".txt", ".svg"))
                self.assertEqual(one[1], other[1])
                self.assertEqual(one[0]["digest"], other[0]["digest"])
                for suffix in ".txt", ".svg":
                    with open(DRAWINGS / f"star{suffix}", "rb") as drawing:
                        done = latvox("pixelize", "-", *options, "-o", self.dir / "in.csv", "--json", stdin=drawing)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertEqual(json.loads(done.stdout)["digest"], one[0]["digest"])

    def test_a_browser_draws_the_same_curves(self):
        """Arcs, uses, nested drawings and all transforms: at ten pixels a unit, every pixel of either is within two of
        the other's."""
        self.pixelize(DRAWINGS / "shapes.svg", "--pixel-size", 0.1, "--origin", "0.05,0.05")
        ours = numpy.zeros((900, 1200), bool)
        for i, j in pixels(self.dir / "out.csv"):
            ours[j, i] = True
        style = "<style>* {fill: none; stroke: #000; stroke-width: 1px; vector-effect: non-scaling-stroke}</style>"
        drawing = (DRAWINGS / "shapes.svg").read_text().replace("<svg ", "<svg width='1200' height='900' ", 1)
        source = json.dumps("data:image/svg+xml," + quote(drawing.replace("<defs>", style + "<defs>", 1)))
        browser = Browser(self.dir)
        try:
            inks = Tab(browser, 1200, 900).run(f"""(async () => {{
              const image = new Image();
              image.src = {source};
              await image.decode();
              const canvas = Object.assign(document.createElement("canvas"), {{width: 1200, height: 900}});
              const context = canvas.getContext("2d");
              context.drawImage(image, 0, 0);
              const rgba = context.getImageData(0, 0, 1200, 900).data;
              return Array.from({{length: 1200 * 900}}, (_, n) => (rgba[4 * n + 3] > 127 ? 1 : 0)).join("");
            }})()""")
        finally:
            browser.close()
        theirs = (numpy.frombuffer(inks.encode(), numpy.uint8) == ord("1")).reshape(900, 1200)
        self.assertGreater(theirs.sum(), 5000)
        for found, wanted in ((ours, theirs), (theirs, ours)):
            near = numpy.zeros_like(wanted)
            for y, x in numpy.argwhere(wanted):
                near[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3] = True
            self.assertEqual(numpy.argwhere(found & ~near).tolist(), [])

    def test_algorithms_run_and_agree_as_they_should(self):
        digests = {}
        for algorithm in ("exact", "brute-force", "incremental", "ibanez"):
            options = ["--resolution", 80, "--lattice", "hexagonal", "--no-minimal", "--algorithm", algorithm]
            summary, found = self.pixelize(DRAWINGS / "word.svg", *options)
            self.assertEqual(summary["certificate"]["algorithm"], algorithm)
            self.assertEqual(summary["certificate"]["tunnels"], 0)
            digests[algorithm] = summary["digest"]
        self.assertEqual(digests["incremental"], digests["ibanez"])
        self.assertNotEqual(digests["exact"], digests["incremental"])

    def test_pictures_are_pictures(self):
        for name in NAMES:
            out = self.dir / "out.png"
            done = latvox("pixelize", DRAWINGS / name, "-o", out, "--resolution", 60, "--lattice", "hexagonal")
            self.assertEqual(done.returncode, OK, done.stderr)
            png = out.read_bytes()
            self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(max(int.from_bytes(png[n : n + 4], "big") for n in (16, 20)), 1024)
            self.assertGreater(len(png), 5000)


class Failures(Case):
    def bad(self, drawing, *options, code, says):
        """Checks that the run fails with `code` and one line matching `says`, and neither makes nor touches the
        output."""
        out = self.dir / "out.csv"
        for old in (None, b"what was here before"):
            if old:
                out.write_bytes(old)
            before = sorted(self.dir.iterdir())
            done = latvox("pixelize", drawing, "-o", out, *options)
            self.assertEqual(done.returncode, code, done.stderr)
            lines = done.stderr.splitlines()
            self.assertEqual(len(lines), 1, done.stderr)
            self.assertRegex(lines[0], says)
            self.assertEqual(sorted(self.dir.iterdir()), before)
            if old:
                self.assertEqual(out.read_bytes(), old)
        out.unlink()

    def test_bad_drawings_are_named(self):
        def write(name, text):
            (self.dir / name).write_text(text)
            return self.dir / name

        def svg(element):
            name = f"{len(list(self.dir.iterdir()))}.svg"
            return write(name, f'<svg xmlns="http://www.w3.org/2000/svg">\n{element}\n</svg>\n')

        for drawing, says in (
            (write("a.txt", "0,0 1,1\n0,0 1;1\n"), 'a.txt: line 2: "1;1" is not a point'),
            (write("b.txt", "0,0 1e999,1\n"), "b.txt: line 1: .*1e999.*finite"),
            (write("c.txt", "# nothing\n"), "c.txt: .*no curve"),
            (write("d.svg", "<svg><path"), "d.svg: line 1: is not XML"),
            (write("e.svg", "<html/>"), "e.svg: line 1: <html> is not svg"),
            (svg("<image/>"), "svg: line 2: <image> is not one of"),
            (svg("<text>a</text>"), "line 2: <text> has no outlines; convert text to paths"),
            (svg('<path d="M0 0A1 1 0 7 0 2 2"/>'), 'line 2: <path> path data has "7" where a flag, 0 or 1, is expected'),
            (svg('<path d="M0 0L1"/>'), "line 2: <path> path data ends"),
            (svg('<g transform="rotate()"/>'), "line 2: <g> transform .*rotate"),
            (svg('<rect width="1" height="1" rx="-0.5"/>'), "line 2: <rect> has a negative radius"),
            (svg('<line x2="5em"/>'), 'line 2: <line> x2 "5em"'),
            (svg('<polyline points="0 0 1"/>'), "line 2: <polyline> points"),
            (write("x.obj", "v 0 0 0\n"), r"x.obj: drawing format \"\.obj\""),
            (self.dir / "missing.svg", "missing.svg: no such file"),
        ):
            with self.subTest(says):
                self.bad(drawing, "--resolution", 9, code=BAD_INPUT, says=says)

    def test_bad_options_are_named(self):
        star = DRAWINGS / "star.txt"
        for options, says in (
            ([], "--pixel-size or --resolution"),
            (["--resolution", 1], "--resolution.*1"),
            (["--resolution", 9, "--separability", 2], "--separability.*2"),
            (["--resolution", 9, "--lattice", "bcc"], "--lattice.*bcc"),
            (["--resolution", 9, "--algorithm", "optimized-incremental"], "--algorithm.*optimized"),
            (["--basis", "1,0,0"], "--basis.*4 finite numbers"),
            (["--resolution", 9, "--origin", "1,2,3"], "--origin.*2 finite"),
            (["--resolution", 9, "--pixel-size", 1], "--resolution.*--pixel-size|--pixel-size.*--resolution"),
            (["--resolution", 9, "-o", self.dir / "out.vdb"], r"out\.vdb.*\.csv \.png"),
        ):
            with self.subTest(says):
                self.bad(star, *options, code=USAGE, says=says)

    def test_the_servers_limits_are_told(self):
        points = " ".join(f"{n},{n % 7}" for n in range(200))
        many = self.dir / "many.txt"
        many.write_text(points + "\n")
        with harness.server(self.dir, "--max-message-bytes", "4096") as server:
            remote = ["--server", server.address]
            self.bad(many, "--resolution", 9, *remote, code=REFUSED, says="points 200 exceeds 128")
            self.bad(DRAWINGS / "star.txt", "--resolution", 300, *remote, code=REFUSED, says=r"pixels \d+ exceeds 307")
            self.bad(DRAWINGS / "star.txt", "--resolution", 9000, *remote, code=REFUSED, says=r"crossings \d+ exceeds 4912")
        star = DRAWINGS / "star.txt"
        self.bad(star, "--pixel-size", 1e-6, code=REFUSED, says="pixel_size.*the limit is 131072")
        self.bad(star, "--basis", "1,1,2,2", code=BAD_INPUT, says="basis.*linearly dependent")
        self.bad(star, "--resolution", 9, "--server", f"unix:{self.dir}/nobody", code=UNREACHABLE, says="nobody")


if __name__ == "__main__":
    unittest.main()
