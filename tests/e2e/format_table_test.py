"""The table of formats in client/docs/voxel-files.md is what `latvox` writes and refuses. Pairs of set, field, lattice and
format are written by `latvox convert`, and readers of others find the voxels and their values.

`format_table_test.py --write` writes the table into the page, with LATVOX_BIN set as for the tests.
"""

import csv
import dataclasses
import functools
import itertools
import json
import pathlib
import re
import sys
import tempfile
import unittest

import h5py
import nibabel
import numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLUnstructuredGridReader

from bodies import BODIES, write_bodies
from harness import Case, box, latvox
from inputs import write_named_obj
from voxel_readers import FLOAT_GRIDS, Grid, Rows, box_of, by_npm, links_of, of_table, rows_of

PAGE = pathlib.Path(__file__).resolve().parents[2] / "client/docs/voxel-files.md"
HEAD = "| format | sets | fields | several fields | lattices | `--dims`, `--pad` |\n|---|---|---|---|---|---|\n"
DENSE = "`.npy`, `--npy dense`"
WRITTEN, USAGE, NO_MESH = 0, 2, 3
SOLID = ["--set", "solid"]
SETS = {name: ["--set", name] for name in "surface supercover links solid supercover-solid interior enclosed enclosed-interior".split()}
SETS |= {"region": ["--set", "region", "--seed", "0,0,0"], "band": ["--set", "band", "--band", "2v"]}
FIELDS = {name: ["--fields", name] for name in "part material color distance triangle point normal".split()}
FIELDS |= {"fraction": [*SOLID, "--fields", "fraction:4"]}
FIELDS |= {"label_fractions": [*SOLID, "--labels", "part", "--fields", "label_fractions:4", "--array", "label_fractions"]}
OF_LINKS = "links", "link_triangles", "link_crossings"
FIELDS |= {name: ["--fields", name] for name in OF_LINKS}
SEVERAL = {"one type": ["--fields", "part,triangle"], "any": ["--fields", "part,distance"], "links": ["--fields", ",".join(OF_LINKS)]}
LATTICES = {"Cartesian": [], "stretched Cartesian": ["--voxel-size", "1,1,2"], "skewed": ["--basis", "1,0,0,0.2,1,0,0,0.1,1"]}
LATTICES |= {name.upper(): ["--lattice", name] for name in ("bcc", "fcc")} | {"hexagonal": ["--lattice", "hexagonal"]}
QUESTIONS = {"sets": SETS, "fields": FIELDS, "several": SEVERAL, "lattices": LATTICES, "shape": {"yes": ["--pad", "1"]}}
SIZE = ["--voxel-size", "1"]
LISTS = ".links.csv", ".links.npz"


@functools.cache
def formats():
    """Returns the extensions that the error of another one names, and a dense .npy."""
    names = latvox("voxelize", "m.obj", "-o", "a.xyz").stderr.rpartition("is not one of ")[2].split()
    return [*names[: names.index(".npy") + 1], DENSE, *names[names.index(".npy") + 1 :]]


def words(group, name, form):
    """Returns the options of a question to a format. Lists of links need a field of links."""
    options = QUESTIONS[group][name]
    extra = ["--npy", "dense"] if form == DENSE else []
    return [*options, *extra, *(["--fields", "links"] if form in LISTS and "--fields" not in options else [])]


def file_of(directory, form):
    return directory / f"a{'.npy' if form == DENSE else form}"


@functools.cache
def ask():
    """Returns the formats that accept each question, by group and name. Without a mesh, such a call ends with its absence."""
    with tempfile.TemporaryDirectory() as empty:
        return dict(answers_in(pathlib.Path(empty)))


def answers_in(directory):
    for group, questions in QUESTIONS.items():
        for name in questions:
            open_forms = formats() if group == "shape" else [form for form in formats() if form not in (DENSE, *LISTS)]
            accepted = []
            if group != "shape":  # a refused file is named, and the others are asked again
                for form in (DENSE, *LISTS):
                    done = latvox("voxelize", directory / "none.obj", "-o", file_of(directory, form), *words(group, name, form))
                    assert done.returncode in (USAGE, NO_MESH), (group, name, form, done.stderr)
                    accepted += [form] if done.returncode == NO_MESH else []
                while open_forms:
                    outputs = [word for form in open_forms for word in ("-o", file_of(directory, form))]
                    done = latvox("voxelize", directory / "none.obj", *outputs, *words(group, name, ""))
                    if done.returncode == NO_MESH:
                        break
                    assert done.returncode == USAGE, (group, name, done.stderr)
                    open_forms.remove(re.search(r"/a(\.[a-z0-9.]*[a-z0-9])(:| cannot)", done.stderr)[1])
                accepted += open_forms
            else:
                for form in open_forms:
                    done = latvox("voxelize", directory / "none.obj", "-o", file_of(directory, form), *words(group, name, form))
                    assert done.returncode in (USAGE, NO_MESH), (group, name, form, done.stderr)
                    accepted += [form] if done.returncode == NO_MESH else []
            yield (group, name), accepted


def cell(group, form, answers):
    """Returns all names, or all except a few, or the few."""
    names = QUESTIONS[group]
    accepted = [name for name in names if form in answers[group, name]]
    refused = [name for name in names if name not in accepted]
    if group == "several":
        return {"": "no", "one type": "of one type", "links": "of links"}.get(" ".join(accepted), "yes")
    if group == "shape":
        return "yes" if accepted else "no"
    if not refused:
        return "all"
    if len(refused) < len(accepted):
        return "all except " + listed(refused)
    return listed(accepted) or "none"


def listed(names):
    """Returns the names, with one for the fields of links."""
    return ", ".join(names).replace(", ".join(OF_LINKS), "those of links")


def table(answers):
    rows = []
    for form in formats():
        cells = [cell(group, form, answers) for group in QUESTIONS]
        rows.append(" | ".join(["| " + (form if form == DENSE else f"`{form}`"), *cells]) + " |\n")
    return HEAD + "".join(rows)


def write_colored(path):
    """Writes two bodies with materials in two colors."""
    path.with_suffix(".mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n")
    text = write_named_obj(path, [("a", "red"), ("b", "blue")]).read_text()
    path.write_text("mtllib " + path.with_suffix(".mtl").name + "\n" + text)
    return path


def by_vtk(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def count_csv(path):
    with open(path) as lines:
        return sum(1 for _ in csv.reader(lines)) - 1


def count_h5(path):
    with h5py.File(path) as file:
        return len(file["sets/voxels/ijk"])


# Readers of others that count voxels. Tests of the other formats have theirs.
COUNTS = {
    ".csv": count_csv,
    ".npy": lambda path: len(numpy.load(path)),
    ".npz": lambda path: int(numpy.load(path)["data"].sum()),
    ".h5": count_h5,
    ".vtu": lambda path: by_vtk(vtkXMLUnstructuredGridReader(), path).GetNumberOfCells(),
    ".cells.vtu": lambda path: by_vtk(vtkXMLUnstructuredGridReader(), path).GetNumberOfCells(),
    ".vti": lambda path: int(numpy.asarray(by_vtk(vtkXMLImageDataReader(), path).GetCellData().GetArray("data")).sum()),
}
# Without a field, elements are 0 and 1.
PLAIN_COUNTS = {
    DENSE: lambda path: int(numpy.load(path).sum()),
    ".nii": lambda path: int(numpy.asarray(nibabel.load(path).dataobj).sum()),
    ".nii.gz": lambda path: int(numpy.asarray(nibabel.load(path).dataobj).sum()),
}


class Table(Case):
    @classmethod
    def setUpClass(cls):
        cls.answers = ask()

    def test_the_page_has_the_table_that_the_tool_gives(self):
        found = HEAD + PAGE.read_text().partition(HEAD)[2].partition("\n\n")[0] + "\n"
        self.assertEqual(found, table(self.answers), "format_table_test.py --write")

    def test_what_the_tool_accepts_it_writes(self):
        mesh = write_colored(self.dir / "m.obj")
        for (group, name), accepted in self.answers.items():
            jobs = [[form for form in accepted if form not in (DENSE, *LISTS)], [form for form in accepted if form == DENSE]]
            for job in [*jobs, [form for form in accepted if form in LISTS]]:
                if job:
                    with self.subTest(group, name=name, formats=job):
                        self.check_files(mesh, job, words(group, name, job[0]))

    def check_files(self, mesh, job, options):
        outputs = [word for form in job for word in ("-o", file_of(self.dir, form))]
        done = latvox("voxelize", mesh, *outputs, *([] if {"--voxel-size", "--basis"} & {*options} else SIZE), *options, "--json")
        self.assertEqual(done.returncode, WRITTEN, done.stderr)
        report = json.loads(done.stdout)
        self.assertGreater(report["voxels"], 0)
        for form in job:
            path = file_of(self.dir, form)
            count = COUNTS.get(form) or (None if "--fields" in options or "band" in options else PLAIN_COUNTS.get(form))
            self.assertGreater(path.stat().st_size, 0, form)
            if count:
                self.assertEqual(count(path), report["voxels"], form)
            path.unlink()


BOXES = ".npz", ".vti", DENSE, ".nrrd", ".mha", ".mhd", ".nii", ".nii.gz"
ROWS = ".vdb", ".nvdb", ".csv", ".npy", ".npz", ".vtu", ".cells.vtu", ".h5"
BY_NPM = ".ply", ".glb", ".binvox", ".vox"
FEW = 3  # formats that a call writes at least
UNREAD = ".png", ".html"  # no reader of others finds voxels in them, so the other test writes them alone
CUBES = {  # the lattices, with axes and extents that no exchange of axes keeps
    "Cartesian": ["--voxel-size", "1.1"],
    "stretched Cartesian": ["--voxel-size", "1.1,0.9,1.3", "--origin", "0.3,-3,1"],
    "skewed": ["--basis", "1.2,0,0.1,0.2,1.1,0,0,0.3,1.3", "--origin", "0.3,-3,1"],
    "BCC": ["--lattice", "bcc", "--voxel-size", "1.3"],
    "FCC": ["--lattice", "fcc", "--voxel-size", "1.3"],
    "hexagonal": ["--lattice", "hexagonal", "--voxel-size", "1.1"],
}
INSIDE = "7.33,2.71,-0.19"  # of the second body, by a voxel on each lattice
SINGLE = [name for name in FIELDS if name != "label_fractions"]
# What one conversion writes: names of fields, and where QUESTIONS asks for them.
CHOICES = {"none": ("sets", "surface"), **{name: ("fields", name) for name in FIELDS}}
CHOICES |= {names: ("several", "one type") for names in ("part,material,triangle", "distance,point,normal", "fraction,label_fractions")}
CHOICES |= {",".join(OF_LINKS): ("several", "links"), "all": ("several", "any")}
LABELED = "solid", "supercover-solid", "interior"  # label_fractions need a labeled solid
LABELS = "part", "material", "triangle", "link_triangles"  # images have one more, and 0 without a voxel
WITHOUT = {name: -1 for name in (*LABELS, "link_crossings")} | {name: numpy.nan for name in ("distance", "point", "normal", "links")}


def needs_labels(choice):
    return "label_fractions" in choice


def possible(answers):
    """Returns the formats that hold a choice of fields, by set, lattice and choice, as the page's table tells."""
    found = {}
    for group in SETS:
        for lattice in CUBES:
            for choice, question in CHOICES.items():
                if needs_labels(choice) and group not in LABELED:
                    continue
                forms = [form for form in formats() if form in answers["lattices", lattice] and form in answers[question] and form not in UNREAD]
                # A band has distances by itself. Without them, all formats hold it.
                forms = [form for form in forms if form in answers["sets", group] or group == "band"]
                found[group, lattice, choice] = [form for form in forms if form not in LISTS or {*choice.split(",")} <= {*OF_LINKS}]
    return found


def pairs(key, form):
    return {*itertools.combinations(key, 2), *((form, name) for name in key)}


def cover(answers):
    """Returns the formats to write by set, lattice and choice, so that each possible pair of two of the four is there."""
    forms_of, jobs, some = possible(answers), {}, 0
    fresh = {key: set().union(*(pairs(key, form) for form in forms)) for key, forms in forms_of.items()}
    open_pairs = set().union(*fresh.values())
    while open_pairs:
        for still in fresh.values():
            still &= open_pairs
        key = max(fresh, key=lambda key: len(fresh[key]))
        forms = [form for form in forms_of[key] if any((form, name) in open_pairs for name in key)]
        if len(forms) < FEW:  # turns go on, so that triples come as well
            others = [form for form in forms_of[key] if form not in forms]
            forms += [others[(some + n) % len(others)] for n in range(FEW - len(forms))]
            some += FEW
        if ".npy" in forms and DENSE in forms:  # a call writes one of them
            forms.remove(DENSE)
        jobs.setdefault(key, []).append(forms)
        open_pairs.difference_update(*(pairs(key, form) for form in forms))
    return jobs


class Combinations(Case):
    @classmethod
    def setUpClass(cls):
        cls.jobs = cover(ask())

    def setUp(self):
        super().setUp()
        turned = {name: slanted(box(*corners)) for name, corners in BODIES.items()}
        text = write_bodies(self.dir / "m.obj", turned).read_text()
        for name, material in zip(BODIES, ("red", "blue", "red"), strict=True):
            text = text.replace(f"o {name}\n", f"o {name}\nusemtl {material}\n")
        (self.dir / "m.mtl").write_text("newmtl red\nKd 1 0.3 0\nnewmtl blue\nKd 0 0.2 1\n")
        (self.dir / "m.obj").write_text("mtllib m.mtl\n" + text)

    def test_readers_of_others_find_each_pair_of_set_field_lattice_and_format(self):
        written = 0
        for (group, lattice), choices in self.by_voxels().items():
            whole = self.whole(group, lattice)
            by_npm_later = {}
            for number, (choice, forms) in enumerate(choices):
                with self.subTest(group, lattice=lattice, fields=choice, formats=forms):
                    written += len(forms)
                    self.convert(choice, forms, f"c{number}")
                    for form in forms:
                        path = self.dir / f"c{number}{'.npy' if form == DENSE else form}"
                        with self.subTest(form):
                            if form in BY_NPM:
                                by_npm_later[path] = (form, choice)
                            else:
                                self.check(form, path, whole, self.fields(choice, whole))
            for path, found in by_npm([*by_npm_later]).items():
                form, choice = by_npm_later[pathlib.Path(path)]
                with self.subTest(group, lattice=lattice, fields=choice, format=form):
                    self.check_npm(form, found, whole, self.fields(choice, whole))
        self.assertGreater(written, 10 * len(CUBES))

    def by_voxels(self):
        """Returns choices and formats by set and lattice. No set and lattice is left out."""
        found = {(group, lattice): [] for group in SETS for lattice in CUBES}
        for (group, lattice, choice), lists in self.jobs.items():
            found[group, lattice] += [(choice, forms) for forms in lists]
        self.assertTrue(all(found.values()))
        return found

    def fields(self, choice, whole):
        return [] if choice == "none" else list(whole.rows.values) if choice == "all" else choice.split(",")

    def whole(self, group, lattice):
        """Writes w.vdb with all fields. Returns the call's own table of it, by lattice coordinates in ascending order."""
        fields = ",".join("fraction:4" if name == "fraction" else name for name in SINGLE)
        options = [*SETS[group], *CUBES[lattice]]
        if group == "region":
            options[options.index("0,0,0")] = INSIDE
        if group in LABELED:
            options += ["--labels", "part"]
            fields += ",label_fractions:4"
        files = [word for name in ("w.vdb", "w.npz", "w.npy") for word in ("-o", self.dir / name)]
        summary = self.voxelize(self.dir / "m.obj", *files, *options, "--fields", fields, out="w.csv")
        with numpy.load(self.dir / "w.npz") as arrays:
            grid = Grid(arrays["origin"], arrays["basis"], arrays["neighbors"])
        rows = rows_of(self.dir / "w.npy", grid)
        self.assertEqual(len(rows.ijk), summary["voxels"])
        self.assertEqual({*rows.values}, {*SINGLE, *(["label_fractions"] if group in LABELED else [])})
        order = numpy.lexsort(rows.ijk.T)
        xyz = rows_of(self.dir / "w.csv", grid).xyz
        return Whole(grid, Rows(rows.ijk[order], xyz[order], {name: values[order] for name, values in rows.values.items()}))

    def convert(self, choice, forms, stem):
        outputs = [word for form in forms for word in ("-o", self.dir / f"{stem}{'.npy' if form == DENSE else form}")]
        options = [*([] if choice == "all" else ["--fields", choice]), *(["--npy", "dense"] if DENSE in forms else [])]
        done = latvox("convert", self.dir / "w.vdb", *outputs, *options)
        self.assertEqual(done.returncode, WRITTEN, done.stderr)

    def check(self, form, path, whole, fields):
        self.assertGreater(path.stat().st_size, 0)
        if form in LISTS:
            self.check_links(links_of(path, whole.grid), whole.rows, fields)
        if form in ROWS:
            self.check_rows(form, rows_of(path, whole.grid), whole, fields)
        if form in BOXES:
            self.check_box(form, *box_of(path), whole, fields)

    def check_rows(self, form, found, whole, fields, digits=1e-9):
        wanted = whole.rows
        ijk = whole.lattice_points(found.xyz) if found.ijk is None else found.ijk
        order = numpy.lexsort(ijk.T)
        numpy.testing.assert_array_equal(ijk[order], wanted.ijk)
        if found.xyz is not None:
            numpy.testing.assert_allclose(found.xyz[order], wanted.xyz, rtol=0, atol=digits)
        if form in (".vdb", ".nvdb"):  # no reader of others reads grids of integers
            fields = [name for name in fields if name in FLOAT_GRIDS or name == "links"]
        self.assertEqual({*found.values}, {*fields})
        for name in fields:
            numpy.testing.assert_array_equal(numpy.float32(found.values[name][order]), numpy.float32(wanted.values[name]), name)

    def check_box(self, form, arrays, affine, whole, fields):
        """An array has the values of its voxels at their places, and elsewhere the value that stands for none."""
        rows = whole.rows
        at = rows.ijk - rows.ijk.min(axis=0)
        shape = tuple(at.max(axis=0) + 1)
        if affine is not None:
            xyz = at @ affine[:3, :3].T + affine[:3, 3]
            numpy.testing.assert_allclose(xyz, rows.xyz, rtol=0, atol=1e-5 if ".nii" in form else 1e-9)
        of_rows = {"data": numpy.ones((len(at), 1))} | {name: rows.values[name] for name in fields}
        image = form not in (".npz", ".vti", DENSE)
        wanted = {}
        for name, values in of_rows.items():
            wanted[name] = numpy.full((*shape, values.shape[1]), WITHOUT.get(name, 0), numpy.float32)
            wanted[name][tuple(at.T)] = values
            if image and name in LABELS:
                wanted[name] += 1
            if image and name == "link_crossings":
                wanted[name] = numpy.maximum(wanted[name], 0)
        if form == ".npz":  # its arrays of links are rows
            wanted = {name: array for name, array in wanted.items() if name not in OF_LINKS}
        if "image" in arrays:
            wanted = {"image": numpy.concatenate([wanted[name] for name in fields or ["data"]], axis=3)}
        self.assertEqual({*arrays}, {*wanted})
        for name, array in wanted.items():
            numpy.testing.assert_array_equal(numpy.float32(arrays[name].reshape(*arrays[name].shape[:3], -1)), array, name)

    def check_links(self, found, rows, fields):
        self.assertEqual({*found}, {*fields})
        crossed = (rows.values["link_crossings"] > 0).any(axis=1)
        for name in fields:
            at = [*map(tuple, rows.ijk[crossed].tolist())]
            self.assertEqual({*found[name]}, {*at})
            numpy.testing.assert_array_equal(numpy.float32([found[name][p] for p in at]), numpy.float32(rows.values[name][crossed]), name)

    def check_npm(self, form, found, whole, fields):
        if form == ".ply":  # three has positions as floats
            columns = {name: numpy.array(values, float) for name, values in found.items()}
            self.check_rows(form, of_table(columns, whole.grid), whole, fields, 1e-5)
        elif form == ".glb":
            self.check_surface(found, whole, fields)
        elif form == ".binvox":
            self.check_binvox(found, whole.rows)
        else:
            self.check_vox(found, whole.rows, fields)

    def check_surface(self, found, whole, fields):
        """A closed surface has the volume of the voxels' cells. Behind each facet is a voxel, and before it is none."""
        corners = numpy.array(found["corners"]).reshape(-1, 3, 3)
        a, b, c = corners.transpose(1, 0, 2)
        normals = numpy.cross(b - a, c - a)
        cell = abs(numpy.linalg.det(whole.grid.basis))
        self.assertAlmostEqual(numpy.einsum("ij,ij", a, normals) / 6 / cell / len(whole.rows.ijk), 1, places=4)
        normals /= numpy.linalg.norm(normals, axis=1)[:, None]
        voxels = {tuple(p): n for n, p in enumerate(whole.rows.ijk.tolist())}
        behind, before = (whole.nearest(corners.mean(axis=1) - side * 1e-2 * normals) for side in (1, -1))
        self.assertEqual({tuple(p) for p in before.tolist()} & {*voxels}, set())
        at = [voxels[tuple(p)] for p in behind.tolist()]
        colors = numpy.array(found["colors"]).reshape(-1, 3, 3) if fields else numpy.zeros((0, 3, 3))
        self.assertEqual(len(found["colors"]), len(found["corners"]) if fields else 0)
        if fields:
            numpy.testing.assert_array_equal(colors, colors[:, :1].repeat(3, axis=1))
            self.check_colors(fields[0], whole.rows.values[fields[0]][at], colors[:, 0], linear=True)

    def check_colors(self, field, values, colors, linear=False):
        """Each part or material has a color of its own, and colors are those of the field."""
        if field == "color":
            wanted = values / 255
            if linear:
                wanted = numpy.where(wanted <= 0.04045, wanted / 12.92, ((wanted + 0.055) / 1.055) ** 2.4)
            numpy.testing.assert_allclose(colors, wanted, rtol=0, atol=1 / 255 if linear else 0)
            return
        found = {(*value, *color) for value, color in zip(values.tolist(), colors.tolist(), strict=True)}
        self.assertEqual([len(found)] * 2, [len({each[0] for each in found}), len({each[1:] for each in found})])

    def check_binvox(self, found, rows):
        low, high = rows.xyz.min(axis=0), rows.xyz.max(axis=0)
        places, cell = numpy.array([[v[name] for name in "xyz"] for v in found["voxels"]]), found["scale"] / found["dimension"]["depth"]
        corner = [found["translate"][name] for name in ("depth", "width", "height")]
        xyz = corner + (places + 0.5) * cell
        order = numpy.lexsort(places.T)
        numpy.testing.assert_allclose(xyz[order], rows.xyz, rtol=0, atol=1e-9)
        self.assertTrue((low < high).all())

    def check_vox(self, found, rows, fields):
        """A .vox has no place in the world."""
        voxels = found["xyzi"]["values"]
        places = numpy.array([[v[name] for name in "xyz"] for v in voxels])
        order = numpy.lexsort(places.T)
        numpy.testing.assert_array_equal(places[order], rows.ijk - rows.ijk.min(axis=0))
        if fields:
            palette = [found["rgba"]["values"][voxels[n]["i"] - 1] for n in order]
            colors = numpy.array([[color[name] for name in "rgb"] for color in palette]) / 255
            self.check_colors(fields[0], rows.values[fields[0]], colors)


@dataclasses.dataclass
class Whole:
    grid: Grid
    rows: Rows

    def lattice_points(self, xyz):
        return numpy.rint((xyz - self.grid.origin) @ numpy.linalg.inv(self.grid.basis)).astype(int)

    def nearest(self, xyz):
        """Returns the lattice points whose cells hold these positions."""
        low = numpy.floor((xyz - self.grid.origin) @ numpy.linalg.inv(self.grid.basis)).astype(int)
        candidates = low[:, None] + numpy.array([*itertools.product(range(-1, 3), repeat=3)])
        away = numpy.linalg.norm(candidates @ self.grid.basis + self.grid.origin - xyz[:, None], axis=2)
        return candidates[range(len(xyz)), away.argmin(axis=1)]


def slanted(mesh):
    return [(x + 0.13 * y, y + 0.21 * z, z - 0.17 * x) for x, y, z in mesh[0]], mesh[1]


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        new = table(ask())
        before, head, rest = PAGE.read_text().partition(HEAD)
        assert head, f"{PAGE} has no table"
        PAGE.write_text(before + new + rest[rest.index("\n\n") + 1 :])
    else:
        unittest.main()
