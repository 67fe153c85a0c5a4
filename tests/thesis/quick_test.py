"""A quick run makes the page, its counts are those of the picture in README.md, and browsers show the page well."""

import contextlib
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "e2e"))

import picture  # noqa: E402
import plot  # noqa: E402
import verdict  # noqa: E402
from browser import Browser, Tab  # noqa: E402
from data import ALGORITHMS  # noqa: E402

READY = "new Promise((done) => document.readyState === 'complete' ? done() : addEventListener('load', done))"


def by_case(rows):
    return {(row["algorithm"], row["resolution"]): row for row in rows}


class QuickRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "thesis-quick"
        cls.done = subprocess.run([HERE / "run", "--quick", cls.directory], capture_output=True, text=True, timeout=500)
        cls.kept, cls.fresh = by_case(picture.read(HERE / "chapter5.csv")), by_case(picture.read(cls.directory / "chapter5.csv"))

    def test_it_ends_well_and_says_where_the_page_is(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        self.assertEqual(self.done.stdout.splitlines()[-1], str(self.directory / "index.html"))

    def test_the_kept_counts_are_those_of_a_fresh_run(self):
        """Voxels depend on nothing but the request, so these counts must be equal. Times are not compared."""
        self.assertEqual(len(self.fresh), 4 * 9)
        for case, row in self.fresh.items():
            for column in (name for name in row if name.startswith("quick_")):
                with self.subTest(case, column=column):
                    self.assertEqual(self.kept[case][column], row[column])

    def test_the_kept_means_are_near_those_of_a_fresh_run(self):
        """A quick run has 6 of the 72 angles. Each angle lies within 5 % of the mean, or the page's statement on
        outliers fails; so the two means differ by no more."""
        for algorithm in ALGORITHMS:
            kept, fresh = (float(rows[algorithm, "200"]["displaced_volume"]) for rows in (self.kept, self.fresh))
            self.assertLess(abs(kept / fresh - 1), 0.05, algorithm)

    def test_the_kept_picture_shows_the_kept_data(self):
        self.assertEqual((HERE / "chapter5.svg").read_text(), picture.draw(list(self.kept.values())))

    def test_rationals_find_the_errors_of_single_and_double_precision(self):
        rows = picture.read(self.directory / "precision.csv")
        self.assertGreater(len(rows), 0)
        for row in rows:
            wrong, exact = int(row["wrong"]), (row["placement"], row["precision"]) == ("rotated", "double")
            with self.subTest(row):
                self.assertGreater(int(row["voxels"]), 0)
                if exact:
                    self.assertEqual((row["doubled"], row["empty"], wrong), ("0", "0", 0))
        for precision in ("single", "double"):
            ties = [int(row["doubled"]) for row in rows if (row["placement"], row["precision"]) == ("ties", precision)]
            self.assertGreater(sum(ties), 0, precision)

    def test_every_chart_has_the_number_of_its_figure(self):
        page = (self.directory / "index.html").read_text()
        for number in [f"5.{n} ({part})" for n in range(10, 22) for part in "ab"]:
            self.assertEqual(page.count(f">Figure {number}: "), 1, number)

    def test_the_page_fits_a_phone_and_a_desk_in_light_and_dark(self):
        with tempfile.TemporaryDirectory() as directory, contextlib.closing(Browser(pathlib.Path(directory))) as browser:
            for width in (390, 1280):
                for dark in (False, True):
                    with self.subTest(width=width, dark=dark):
                        self.look(Tab(browser, width, 800, phone=width == 390, dark=dark), width, dark)

    def look(self, tab, width, dark):
        tab.call("Page.navigate", url=f"file://{self.directory}/index.html")
        self.assertLessEqual(tab.run(READY + ".then(() => document.documentElement.scrollWidth)"), width)
        wide = "[...document.querySelectorAll('.wide')].filter((box) => box.scrollWidth > box.clientWidth).length"
        if width == 390:
            self.assertGreater(tab.run(wide), 0)
        paper, ink = ("rgb(24, 24, 24)", "rgb(228, 228, 228)") if dark else ("rgb(255, 255, 255)", "rgb(34, 34, 34)")
        self.assertEqual(tab.run("getComputedStyle(document.body).backgroundColor"), paper)
        self.assertEqual(tab.run("getComputedStyle(document.querySelector('svg rect')).fill"), paper)
        self.assertEqual(tab.run("getComputedStyle(document.querySelector('svg text')).fill"), ink)
        tab.call("Page.close")


class Parts(unittest.TestCase):
    def test_a_spread_that_covers_its_limit_is_undecided(self):
        self.assertEqual(verdict.within([1, 2, 3], 1, 3), verdict.HOLDS)
        self.assertEqual(verdict.within([4, 5], 1, 3), verdict.FAILS)
        self.assertEqual(verdict.within([0.1, 0.9], 1, 3), verdict.FAILS)
        self.assertEqual(verdict.within([2, 4], 1, 3), verdict.UNDECIDED)
        self.assertEqual(verdict.within([0, 4], 1, 3), verdict.UNDECIDED)
        self.assertEqual(verdict.every([verdict.HOLDS, verdict.UNDECIDED]), verdict.UNDECIDED)
        self.assertEqual(verdict.every([verdict.HOLDS, verdict.UNDECIDED, verdict.FAILS]), verdict.FAILS)
        self.assertEqual(verdict.every([verdict.HOLDS]), verdict.HOLDS)

    def test_charts_clip_neither_points_nor_bands_nor_levels(self):
        for log, points, band, level in (
            (False, [(10, -17), (20, 9)], [(10, -40, 31), (20, 2, 12)], 52),
            (True, [(10, 0.002), (20, 30)], [(10, 0.0004, 700), (20, 5, 60)], 8000),
        ):
            chart = plot.Chart("", "", "", [plot.Series("", "#0072B2", points, band=band)], (level, ""), log)
            drawing = plot._Drawing(chart, 0, 0, 400, 300)
            values = [level, *(y for _, y in points), *(y for _, *both in band for y in both)]
            for value in values:
                self.assertLessEqual(drawing.top, drawing.y(value), value)
                self.assertLessEqual(drawing.y(value), drawing.bottom, value)


if __name__ == "__main__":
    unittest.main()
