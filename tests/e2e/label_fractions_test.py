"""The field label_fractions: overlapping boxes by their volumes, and a phantom's organs, in every format that holds it."""

import collections
import csv
import json
import unittest

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLUnstructuredGridReader

from bodies import BODIES, write_bodies
from harness import Case, box, latvox, octahedron
from picture_test import read_png

GRID = ["--voxel-size", "1", "--origin", "0,0,0", "--set", "supercover-solid", "--labels", "part"]
PALETTE = ((0xE6, 0x9F, 0x00), (0x56, 0xB4, 0xE9), (0x00, 0x9E, 0x73))  # of labels 0 to 2
NONE, ALL = (0x44, 0x01, 0x54), (0xFD, 0xE7, 0x25)  # of a label, in a cell


def quarters(order):
    """The number of points of a lattice with steps of 1/4 that each body has, if earlier ones cover later ones."""
    points, taken = {}, set()
    for name in order:
        low, high = (tuple(round(4 * x) for x in corner) for corner in BODIES[name])
        inside = {(i, j, k) for i in range(low[0], high[0]) for j in range(low[1], high[1]) for k in range(low[2], high[2])}
        points[name] = len(inside - taken)
        taken |= inside
    return points


def vtk_arrays(path, reader):
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput().GetCellData() if path.suffix == ".vti" else reader.GetOutput().GetPointData()
    names = [data.GetArrayName(n) for n in range(data.GetNumberOfArrays())]
    return {name: vtk_to_numpy(data.GetArray(name)) for name in names}


class LabelFractions(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_bodies(self.dir / "boxes.obj", {name: box(*corners) for name, corners in BODIES.items()})

    def table(self, name="out.csv", by_place=False):
        """Returns the columns of fractions, in the file's order or by i, j and k."""
        with (self.dir / name).open() as file:
            rows = list(csv.DictReader(file))
        if by_place:
            rows.sort(key=lambda row: tuple(int(row[axis]) for axis in "ijk"))
        return {column: numpy.array([int(row[column]) for row in rows]) for column in rows[0] if column.startswith("fraction")}

    def test_of_boxes_are_their_volumes_by_priority(self):
        for priority, order in (([], ["pin", "lid", "base"]), (["--priority", "base,lid"], ["base", "lid", "pin"])):
            with self.subTest(order=order):
                summary = self.voxelize(self.mesh, *GRID, *priority, "--fields", "fraction:4,label_fractions:4")
                self.assertEqual((summary["fields"]["label_fractions"]["labels"], summary["fields"]["label_fractions"]["n"]),
                                 ([0, 1, 2], 4))  # fmt: skip
                table, points = self.table(), quarters(order)
                self.assertEqual({name: table[f"fraction_{n}"].sum() for n, name in enumerate(BODIES)}, points)
                together = sum(table[f"fraction_{n}"] for n in range(3))
                numpy.testing.assert_array_equal(together, table["fraction"])

    def test_every_format_has_an_array_for_each_label(self):
        formats = [f"a.{end}" for end in ("npy", "npz", "vti", "vtu", "vdb", "h5", "nvdb")]
        more = [word for name in formats for word in ("-o", self.dir / name)]
        self.voxelize(self.mesh, *GRID, "--fields", "label_fractions:4", "--fraction-labels", "2,0,99", *more)
        table = self.table()
        self.assertEqual(list(table), ["fraction_2", "fraction_0", "fraction_99"])
        self.assertEqual((table["fraction_2"].sum(), table["fraction_99"].max()), (quarters(["pin"])["pin"], 0))
        self.voxelize(self.mesh, *GRID, "--fields", "label_fractions:4", "--fraction-labels", "pin,base,99", out="named.csv")
        self.assertEqual((self.dir / "named.csv").read_text(), (self.dir / "out.csv").read_text())
        npy = numpy.load(self.dir / "a.npy")
        arrays = vtk_arrays(self.dir / "a.vtu", vtkXMLUnstructuredGridReader())
        cells = vtk_arrays(self.dir / "a.vti", vtkXMLImageDataReader())
        latvox("convert", self.dir / "a.vdb", "-o", self.dir / "b.csv")
        placed, again = self.table(by_place=True), self.table("b.csv", by_place=True)
        with numpy.load(self.dir / "a.npz") as dense:
            for name, values in table.items():
                numpy.testing.assert_array_equal(npy[name], values)
                self.assertEqual((npy[name].dtype, dense[name].dtype), (numpy.uint16, numpy.uint16))
                numpy.testing.assert_array_equal(arrays[name], values)
                numpy.testing.assert_array_equal(dense[name][dense["data"] != 0], placed[name])
                numpy.testing.assert_array_equal(cells[name], dense[name].ravel(order="F"))
                numpy.testing.assert_array_equal(again[name], placed[name])
        latvox("convert", self.dir / "a.vdb", "-o", self.dir / "c.csv", "--fields", "label_fractions")
        self.assertEqual((self.dir / "c.csv").read_text().splitlines()[0], "i,j,k,x,y,z,fraction_2,fraction_0,fraction_99")
        info = latvox("info", self.dir / "a.vdb").stdout
        self.assertRegex(info, r"latvox_fraction_labels\W+2,0,99")
        self.assertIn('"fraction_labels":[2,0,99]', info)
        self.voxelize(self.mesh, *GRID, "--fields", "label_fractions:4", "--fraction-labels", "0,2,99", out="other.vdb")
        for other, status in (("a.vdb", 0), ("other.vdb", 1)):
            compared = latvox("compare", self.dir / "a.vdb", self.dir / other)
            self.assertEqual((compared.returncode, "latvox_fraction_labels" in compared.stdout), (status, status == 1), compared.stderr)

    def picture(self, command, *options, text, status=0):
        """Draws a.vdb. Returns the number of pixels of each color."""
        done = latvox(command, self.dir / "a.vdb", "-o", self.dir / "a.png", "--size", "300", *options)
        self.assertEqual((done.returncode, text in (done.stderr if status else done.stdout)), (status, True), done.stderr + done.stdout)
        return {} if status else collections.Counter(color for line in read_png(self.dir / "a.png")[2] for color in line)

    def test_pictures_mix_the_colors_of_labels_or_show_one(self):
        self.voxelize(self.mesh, *GRID, "--fields", "label_fractions:4", "-o", self.dir / "a.vdb")
        cut = ["--axis", "z", "--index", "2", "-o", self.dir / "layer.csv"]
        mixed = self.picture("slice", *cut, "--color-by", "label_fractions", text=", colored by label_fractions")
        with (self.dir / "out.csv").open() as file:
            rows = [row for row in csv.DictReader(file) if row["k"] == "2"]
        with (self.dir / "layer.csv").open() as file:
            self.assertCountEqual(list(csv.DictReader(file)), rows)
        points = {tuple(int(row[f"fraction_{n}"]) for n in range(3)) for row in rows}
        self.assertGreater(len(points), 5)
        for counts in points:
            parts = zip((*counts, 64 - sum(counts)), (*PALETTE, (255, 255, 255)))
            color = tuple(int(level / 64 + 0.5) for level in sum(n * numpy.array(color) for n, color in parts))
            self.assertGreater(mixed[color], 200, counts)
        lid = self.picture("slice", *cut, "--label", "lid", text=", colored by the fraction of lid")
        self.assertEqual(lid, self.picture("slice", *cut, "--color-by", "label_fractions", "--label", "1", text="fraction of 1"))
        self.assertTrue(lid[NONE] > 200 and lid[ALL] > 200)
        one, whole = ([tuple(color) for color in self.picture("render", *more, text=text)] for more, text in (
            (["--label", "pin"], "the fraction of pin"), (["--color-by", "label_fractions"], "by label_fractions")))  # fmt: skip
        self.assertNotEqual(one, whole)
        for command, more, status, says in (
            ("render", ["--label", "x"], 3, 'a.vdb: --label: "x" is neither a number nor the name of a part'),
            ("slice", ["--label", "9"], 3, "a.vdb: --label 9: the voxels have fractions of 0,1,2"),
            ("slice", ["--label", "1", "--color-by", "part"], 2, "--label: needs --color-by label_fractions, not part"),
            ("render", ["--label", "1", "--color", "ff0000"], 2, "--color: cannot be combined with --label"),
        ):
            self.picture(command, *more, text=says, status=status)
        self.voxelize(self.mesh, *GRID, out="a.vdb")
        for more in (["--label", "1"], ["--color-by", "label_fractions"]):
            self.picture("slice", *more, text="the voxels have no label_fractions, which", status=3)

    def test_a_batch_and_parts_are_as_the_whole(self):
        options = ["--resolution", "90", "--lattice", "bcc", "--set", "solid", "--labels", "part"]
        fields = ["--fields", "label_fractions:3", "--fraction-labels", "1,2"]
        whole = self.voxelize(self.mesh, *options, *fields, out="whole.csv")
        parts = set()
        for part in ("0/3", "1/3", "2/3"):
            self.voxelize(self.mesh, *options, *fields, "--shard", part)
            parts |= set((self.dir / "out.csv").read_text().splitlines())
        self.assertEqual(parts, set((self.dir / "whole.csv").read_text().splitlines()))
        line = {"mesh": str(self.mesh), "out": "b.csv", "resolution": 90, "lattice": "bcc", "set": "solid", "labels": "part",
                "fields": ["label_fractions:3"], "fraction_labels": [1, 2]}  # fmt: skip
        (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.dir / "out/results.jsonl").read_text())
        self.assertEqual(result["summary"]["fields"], whole["fields"])

    def test_organs_of_a_phantom_fill_its_body(self):
        organs = {"body": 20, "heart": 9, "lung": 12}
        meshes = {name: ([(x + 3 * n, y, z) for x, y, z in octahedron(side)[0]], octahedron(side)[1])
                  for n, (name, side) in enumerate(organs.items())}  # fmt: skip
        phantom = write_bodies(self.dir / "phantom.obj", meshes)
        for lattice in ("cartesian", "bcc", "fcc"):
            with self.subTest(lattice):
                options = ["--resolution", "40", "--lattice", lattice, "--set", "supercover-solid", "--rule", "winding"]
                self.voxelize(phantom, *options, "--priority", "heart", "--labels", "part", "--fields", "label_fractions:4", out="labels.csv")
                self.voxelize(phantom, *options, "--fields", "fraction:4", out="plain.csv")
                table = self.table("labels.csv")
                self.assertGreater(min(values.sum() for values in table.values()), 0)
                numpy.testing.assert_array_equal(sum(table.values()), self.table("plain.csv")["fraction"])

    def test_what_does_not_fit_is_refused(self):
        holds = ".vdb .nvdb .csv .npy .npz .ply .png .html .vti .vtu .cells.vtu .h5 can"
        for more, status, says in (
            (["--fields", "label_fractions"], 2, "label_fractions needs a number of points along each axis, such as label_fractions:8"),
            (["--fields", "label_fractions:1"], 2, '"label_fractions:1": 1 is not a whole number from 2 to 16'),
            (["--fields", "fraction:3,label_fractions:4"], 2, "need the same number of points, not 3 and 4"),
            (["--fields", "fraction:2", "--fraction-labels", "1"], 3, "--fraction-labels: needs label_fractions among --fields"),
            (["--fields", "label_fractions:2", "--fraction-labels", "1,x"], 3,
             '--fraction-labels: "x" is neither a number nor the name of a part'),
            (["--fields", "label_fractions:2", "--fraction-labels", "1,1"], 3, "--fraction-labels 1 occurs twice"),
            (["--fields", "label_fractions:2", "--fraction-labels", ",".join(map(str, range(33)))], 3,
             "--fraction-labels: 33 labels exceed 32"),
            (["--fields", "label_fractions:2", "--force-open"], 2, "not together with --force-open"),
            (["--fields", "label_fractions:2", "-o", "a.nrrd"], 2, f"a.nrrd cannot hold label_fractions,part; {holds}"),
            (["--fields", "label_fractions:2", "-o", "a.npy", "--npy", "dense"], 2, "a.npy cannot hold label_fractions,part; .vdb .nvdb .csv .npz"),
        ):  # fmt: skip
            with self.subTest(more=more):
                done = latvox("voxelize", self.mesh, *GRID, "--json", "-o", "a.csv", *more, cwd=self.dir)
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(says, done.stderr.replace('\\"', '"'))
        done = latvox("voxelize", self.mesh, "--json", "--set", "solid", "--fields", "label_fractions:2", "-o", "a.csv", cwd=self.dir)
        self.assertEqual((done.returncode, "--fields label_fractions: needs a solid with --labels" in done.stderr), (3, True), done.stderr)


if __name__ == "__main__":
    unittest.main()
