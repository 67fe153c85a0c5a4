"""The table of formats in client/docs/voxel-files.md is what `latvox` writes and refuses.

`format_table_test.py --write` writes the table into the page, with LATVOX_BIN set as for the tests.
"""

import csv
import functools
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

from harness import Case, latvox
from inputs import write_named_obj

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


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        new = table(ask())
        before, head, rest = PAGE.read_text().partition(HEAD)
        assert head, f"{PAGE} has no table"
        PAGE.write_text(before + new + rest[rest.index("\n\n") + 1 :])
    else:
        unittest.main()
