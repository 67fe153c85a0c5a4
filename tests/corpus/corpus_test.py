"""The installed packages' meshes are read as other programs read them; and a corpus that differs is noticed."""

import contextlib
import io
import pathlib
import unittest
import unittest.mock

import corpus
import exceptions
import readers
from compare import compare

BOX = {"triangles": 12, "min": [0, 0, 0], "max": [1, 2, 4], "colors": None}
RED = {"min": [255, 0, 0], "max": [255, 0, 0], "mean": [255, 0, 0]}


class Comparison(unittest.TestCase):
    def test_finds_triangles_bounds_and_colors_that_differ(self):
        colored = {**BOX, "colors": RED}
        for ours, theirs, says in (
            (BOX, {**BOX, "triangles": 11}, "triangles: 12, reference 11"),
            (BOX, {**BOX, "max": [1, 2, 4.00001]}, "bounds: "),
            (BOX, {**BOX, "min": [0, -0.00001, 0]}, "bounds: "),
            (colored, BOX, "colors: "),
            (BOX, colored, "colors: none; "),
            (colored, {**BOX, "colors": {**RED, "mean": [253.9, 0, 0]}}, "colors: "),
            (BOX, {"error": "bad"}, "only latvox reads it: 12 triangles; reference: bad"),
            ({"error": "bad"}, BOX, "only the reference reads it: 12 triangles; latvox: bad"),
        ):
            self.assertTrue(compare(ours, theirs).startswith(says), compare(ours, theirs))

    def test_allows_the_rounding_of_floats_and_colors(self):
        colored = {**BOX, "colors": RED}
        self.assertIsNone(compare(colored, {**colored, "max": [1, 2, 4.000001], "colors": {**RED, "mean": [254.2, 0, 0]}}))
        self.assertIsNone(compare({"error": "bad"}, {"error": "wrong"}))


class Exceptions(unittest.TestCase):
    ENTRIES = exceptions.parse("p a*.obj\ntriangles: 1,*\nBroken.\n\nq *\nbounds: *\nOther.\n")

    def kind(self, name, ours, theirs):
        return corpus.Result(name, ours, theirs, "three.js", self.ENTRIES).kind()

    def test_explain_only_the_difference_that_they_state(self):
        one, two = {**BOX, "triangles": 1}, {**BOX, "triangles": 2}
        self.assertEqual(self.kind("p a1.obj", one, two), "explained")
        self.assertEqual(self.kind("p a1.obj", two, one), "unexplained")
        self.assertEqual(self.kind("p b1.obj", one, two), "unexplained")
        self.assertEqual(self.kind("p b1.obj", one, one), "equal")
        self.assertEqual(self.kind("p b1.obj", {"error": "bad"}, {"error": "bad"}), "refused by both")

    def test_that_no_longer_apply_are_noticed(self):
        outdated = lambda results, packages: exceptions.outdated(results, self.ENTRIES, packages)  # noqa: E731
        self.assertEqual(outdated([("p a1.obj", "triangles: 1, reference 2")], {"p"}), [])
        self.assertEqual(outdated([("p a1.obj", None)], {"p"}), ["p a1.obj: an exception, and the readers agree"])
        self.assertEqual(outdated([], {"p"}), ["p a*.obj: an exception for no file"])
        self.assertEqual(outdated([], {"r"}), [])

    def test_of_another_release_of_debian_need_no_file(self):
        for release, complaints in ((exceptions.RELEASE, ["p *: an exception for no file"]), ("another", [])):
            entries = exceptions.parse(f"p * [{release}]\n*\nBroken.\n")
            self.assertTrue(entries[0].names("p a.obj"))
            self.assertEqual(exceptions.outdated([], entries, {"p"}), complaints)


class Programs(unittest.TestCase):
    def test_that_hang_or_end_are_replaced(self):
        with unittest.mock.patch.multiple(readers, SECONDS=1, COMMANDS={"hangs": ["sleep", "60"], "ends": ["true"]}):
            for name, says in (("hangs", "took more than 1 seconds"), ("ends", "ended without an answer")):
                reader = readers.Reader(name)
                self.assertEqual([reader.read("x")["error"] for _ in range(2)], [says, says])
                self.assertIsNone(reader.process)


class InstalledPackages(unittest.TestCase):
    def test_are_read_as_other_programs_read_them(self):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            status = corpus.main([])
        self.assertEqual(status, 0, printed.getvalue())
        self.assertRegex(printed.getvalue(), r"\| \.gltf \| \d\d")

    def test_have_references_for_every_format_that_latvox_reads(self):
        page = (pathlib.Path(__file__).parents[2] / "client/docs/inputs.md").read_text()
        table = page.split("## Mesh files")[1].split("\n\n- ")[0]
        formats = {word.strip(",`") for line in table.splitlines() if line.startswith("| `.") for word in line.split("|")[1].split()}
        self.assertEqual(formats, set(readers.READERS))


if __name__ == "__main__":
    unittest.main()
