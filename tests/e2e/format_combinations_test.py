"""`latvox convert` writes pairs of set, field, lattice and format, and readers of others find the voxels and their values."""

import dataclasses
import itertools
import pathlib
import unittest

import numpy

from bodies import BODIES, write_bodies
from format_table_test import DENSE, FIELDS, LISTS, OF_LINKS, SETS, WRITTEN, ask, formats
from harness import Case, box, latvox
from voxel_readers import FLOAT_GRIDS, Grid, Rows, box_of, by_npm, links_of, of_table, rows_of

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
# What one conversion writes: names of fields, and where format_table_test.QUESTIONS asks for them.
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
        written, by_npm_later = 0, {}
        for case, ((group, lattice), choices) in enumerate(self.by_voxels().items()):
            whole = self.whole(group, lattice)
            for number, (choice, forms) in enumerate(choices):
                with self.subTest(group, lattice=lattice, fields=choice, formats=forms):
                    written += len(forms)
                    stem = f"c{case}_{number}"
                    # A .vdb takes four times as long to load, so a third of the conversions begin with one.
                    self.convert("w.vdb" if (case + number) % 3 == 0 else "w.nvdb", choice, forms, stem)
                    for form in forms:
                        path = self.dir / f"{stem}{'.npy' if form == DENSE else form}"
                        names = self.fields(choice, whole)
                        with self.subTest(form):
                            if form in BY_NPM:
                                by_npm_later[path] = (form, whole, names, (group, lattice))
                            else:
                                self.check(form, path, whole, names)
        for path, found in by_npm([*by_npm_later]).items():  # at once, because each start of node takes a while
            form, whole, names, (group, lattice) = by_npm_later[pathlib.Path(path)]
            with self.subTest(group, lattice=lattice, fields=names, format=form):
                self.check_npm(form, found, whole, names)
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
        """Writes w.vdb and w.nvdb with all fields. Returns the call's own table of them, by ascending lattice coordinates."""
        fields = ",".join("fraction:4" if name == "fraction" else name for name in SINGLE)
        options = [*SETS[group], *CUBES[lattice]]
        if group == "region":
            options[options.index("0,0,0")] = INSIDE
        if group in LABELED:
            options += ["--labels", "part"]
            fields += ",label_fractions:4"
        files = [word for name in ("w.vdb", "w.nvdb", "w.npz", "w.npy") for word in ("-o", self.dir / name)]
        summary = self.voxelize(self.dir / "m.obj", *files, *options, "--fields", fields, out="w.csv")
        with numpy.load(self.dir / "w.npz") as arrays:
            grid = Grid(arrays["origin"], arrays["basis"], arrays["neighbors"])
        rows = rows_of(self.dir / "w.npy", grid)
        self.assertEqual(len(rows.ijk), summary["voxels"])
        self.assertEqual({*rows.values}, {*SINGLE, *(["label_fractions"] if group in LABELED else [])})
        order = numpy.lexsort(rows.ijk.T)
        xyz = rows_of(self.dir / "w.csv", grid).xyz
        return Whole(grid, Rows(rows.ijk[order], xyz[order], {name: values[order] for name, values in rows.values.items()}))

    def convert(self, source, choice, forms, stem):
        outputs = [word for form in forms for word in ("-o", self.dir / f"{stem}{'.npy' if form == DENSE else form}")]
        options = [*([] if choice == "all" else ["--fields", choice]), *(["--npy", "dense"] if DENSE in forms else [])]
        done = latvox("convert", self.dir / source, *outputs, *options)
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
    unittest.main()
