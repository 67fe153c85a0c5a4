"""Programs of others read the images, and find the voxels and fields of the .npz at their positions."""

import json
import re
import subprocess
import unittest

import nibabel
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkMetaImageReader

from array_case import LATTICES, SPIDER, ArrayCase
from bodies import BODIES, write_bodies
from harness import BUNNY, PATIENCE, box, latvox, write_obj

IMAGES = ".nrrd", ".mha", ".mhd", ".nii", ".nii.gz"
ONE_EACH = {"part": "int32", "material": "int32", "color": "uint8", "distance": "float32", "triangle": "int32", "point": "float32",
            "normal": "float32", "fraction": "uint16"}  # fmt: skip


def by_teem(path):
    """Returns the array, components last, and the affine of an image that `teem-unu` reads, and the header that it writes."""
    done = subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", "raw", "-i", path], capture_output=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    head, _, data = done.stdout.partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    sizes = [int(x) for x in fields["sizes"].split()]
    types = {"unsigned char": "u1", "unsigned short": "<u2", "int": "<i4", "float": "<f4"}
    array = numpy.frombuffer(data, types[fields["type"]]).reshape(sizes, order="F")
    if len(sizes) == 4:
        array = numpy.moveaxis(array, 0, -1)
    vectors = [[float(x) for x in v.split(",")] for v in re.findall(r"\(([^)]+)\)", fields["space directions"])]
    origin = [float(x) for x in fields["space origin"].strip("()").split(",")]
    return array, affine_of(vectors, origin), fields


def affine_of(steps, origin):
    affine = numpy.eye(4)
    affine[:3, :3] = numpy.array(steps).T
    affine[:3, 3] = origin
    return affine


def by_vtk_meta(path):
    """VTK gives the elements; it ignores the direction of axes. So the affine comes from the header's lines."""
    reader = vtkMetaImageReader()
    assert reader.CanReadFile(str(path)), path
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    shape = image.GetDimensions()
    array = values.reshape(*shape[::-1], -1).transpose(2, 1, 0, 3)
    head = path.read_bytes().partition(b"ElementDataFile")[0].decode()
    fields = {key: [float(x) for x in value.split()] for key, value in re.findall(r"(\w+) = ([-0-9.e ]+)\n", head)}
    numpy.testing.assert_allclose(image.GetSpacing(), fields["ElementSpacing"], rtol=1e-12)
    steps = numpy.array(fields["TransformMatrix"]).reshape(3, 3) * numpy.array(fields["ElementSpacing"])[:, None]
    return (array if array.shape[3] > 1 else array[..., 0]), affine_of(steps, fields["Offset"])


def by_nibabel(path):
    image = nibabel.load(path)
    array = numpy.asanyarray(image.dataobj)
    if array.dtype.names:
        array = numpy.stack([array[name] for name in "RGB"], axis=-1)
    if array.ndim == 5:
        array = array[:, :, :, 0, :]
    assert image.header["sform_code"] == 2 and image.header["qform_code"] == 0
    return array, image.affine


def read(path):
    if path.suffix == ".nrrd":
        return by_teem(path)[:2]
    return by_nibabel(path) if ".nii" in path.name else by_vtk_meta(path)


class Science(ArrayCase):
    def check_images(self, arrays, name, dtype, extensions=IMAGES):
        for extension in extensions:
            array, affine = read(self.dir / f"a{extension}")
            self.assertEqual((array.dtype, array.shape), (numpy.dtype(dtype), arrays[name].shape), extension)
            shift = 1 if dtype == "int32" else 0  # labels begin with 1, and -1 becomes 0
            numpy.testing.assert_array_equal(array, arrays[name] + shift, extension)
            scale = abs(arrays["affine"]).max() * (6e-8 if ".nii" in extension else 1e-15)  # NIfTI has floats
            numpy.testing.assert_allclose(affine, arrays["affine"], rtol=0, atol=scale * 4, err_msg=extension)

    def test_images_have_the_voxels_of_every_lattice_at_their_places(self):
        for name, options in LATTICES.items():
            with self.subTest(name):
                arrays = self.write(BUNNY, IMAGES, *options)
                self.assertEqual(int(arrays["data"].sum()), self.summary["voxels"])
                self.check_images(arrays, "data", "uint8")

    def test_images_hold_one_field(self):
        for name, dtype in ONE_EACH.items():
            with self.subTest(name):
                closed = name == "fraction"
                field = ["--fields", "fraction:4", "--set", "solid"] if closed else ["--fields", name]
                arrays = self.write(BUNNY if closed else SPIDER, IMAGES, "--lattice", "bcc", "--resolution", "12", *field)
                self.check_images(arrays, name, dtype)
        kinds = by_teem(self.dir / "a.nrrd")[2]
        self.assertEqual((kinds["space"], kinds["content"]), ("left-posterior-superior", "fraction"))

    def test_images_hold_fields_of_one_type(self):
        for fields, dtype in ("part,material,triangle", "int32"), ("distance,point,normal", "float32"):
            with self.subTest(fields):
                arrays = self.write(SPIDER, IMAGES[:3], "--lattice", "bcc", "--resolution", "12", "--fields", fields)
                self.check_components(arrays, fields.split(","), dtype)

    def test_images_hold_the_fractions_of_all_labels(self):
        """A labeled solid carries its labels, too, which have another type."""
        mesh = write_bodies(self.dir / "boxes.obj", {name: box(*corners) for name, corners in BODIES.items()})
        solid = ["--set", "supercover-solid", "--labels", "part", "--voxel-size", "1"]
        self.write(mesh, [".vdb"], *solid, "--fields", "fraction:4,label_fractions:4")
        arrays = self.convert(IMAGES[:3], "--fields", "fraction,label_fractions")
        names = ["fraction", *(f"fraction_{n}" for n in range(len(BODIES)))]
        self.assertLessEqual(set(names), set(arrays))
        self.check_components(arrays, names, "uint16")
        alone = "--fields", "label_fractions:4", "--array", "label_fractions"
        self.check_components(self.write(mesh, [*IMAGES[:3], ".vdb"], *solid, *alone), names[1:], "uint16")

    def check_components(self, arrays, names, dtype):
        """Components of an element are those of the fields, one after the other."""
        columns = [arrays[name].reshape(*arrays["data"].shape, -1) for name in names]
        whole = numpy.concatenate(columns, axis=3)
        self.check_images({**arrays, "all": whole}, "all", dtype, IMAGES[:3])
        header = by_teem(self.dir / "a.nrrd")[2]
        self.assertEqual((header["content"], header["kinds"].split()[0]), (",".join(names), "list"))
        for extension in IMAGES[:3]:
            facts = json.loads(latvox("info", "--json", self.dir / f"a{extension}").stdout)
            self.assertEqual((facts["components"], facts["shape"]), (whole.shape[3], list(whole.shape[:3])))

    def test_images_and_dense_arrays_hold_a_component_for_each_label(self):
        mesh = write_bodies(self.dir / "boxes.obj", {name: box(*corners) for name, corners in BODIES.items()})
        solid = ["--set", "supercover-solid", "--labels", "part", "--voxel-size", "1", "--fields", "label_fractions:4"]
        alone = ["--array", "label_fractions", "--npy", "dense"]
        for labels in ([], ["--fraction-labels", "1"]):
            arrays = self.write(mesh, [".nii", ".nii.gz", ".npy"], *solid, *labels, *alone)
            names = sorted(name for name in arrays if name.startswith("fraction_"))
            arrays["all"] = numpy.stack([arrays[name] for name in names], axis=3)
            self.assertGreater(arrays["all"].max(), 0)
            numpy.testing.assert_array_equal(numpy.load(self.dir / "a.npy"), arrays["all"])
            if labels:
                arrays["all"] = arrays["all"][..., 0]  # an image of one component has no axis for it
            self.check_images(arrays, "all", "uint16", (".nii", ".nii.gz"))
            self.assertEqual(nibabel.load(self.dir / "a.nii").header["intent_name"], b"label_fractions")

    def test_images_and_dense_arrays_hold_a_component_for_each_link(self):
        for field, dtype, nothing in (("links", "float32", numpy.nan), ("link_triangles", "int32", -1), ("link_crossings", "int32", -1)):
            arrays = self.write(BUNNY, [*IMAGES, ".npy"], "--lattice", "bcc", "--resolution", "12", "--fields", field, "--npy", "dense")
            dense = numpy.full((*arrays["data"].shape, len(arrays["neighbors"])), nothing, dtype)
            dense[tuple((arrays["ijk"] - arrays["index_min"]).T)] = arrays[field]
            numpy.testing.assert_array_equal(numpy.load(self.dir / "a.npy"), dense)
            if field == "link_crossings":  # counts are no labels
                dense = numpy.maximum(dense, 0) - 1
            self.check_images({**arrays, "all": dense}, "all", dtype)
            neighbors = " ".join(",".join(map(str, row)) for row in arrays["neighbors"].tolist())
            self.assertIn(f"\nneighbors:={neighbors}\n".encode(), (self.dir / "a.nrrd").read_bytes())
            self.assertIn(f"\nComment = neighbors {neighbors}\n", (self.dir / "a.mhd").read_text())
            self.assertEqual(by_teem(self.dir / "a.nrrd")[2]["kinds"].split()[0], "list")
            self.assertEqual(json.loads(latvox("info", "--json", self.dir / "a.mha").stdout)["shape"], list(arrays["data"].shape))

    def test_labels_have_the_names_of_segments(self):
        arrays = self.write(SPIDER, [".nrrd", ".vdb"], "--resolution", "16", "--fields", "material")
        metadata = json.loads(latvox("info", "--json", self.dir / "a.vdb").stdout)["metadata"]
        names = json.loads(metadata["latvox_material_names"])
        self.check_images(arrays, "material", "int32", (".nrrd",))
        done = subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", "raw", "-i", self.dir / "a.nrrd"], capture_output=True, check=True)
        keys = dict(line.split(":=", 1) for line in done.stdout.partition(b"\n\n")[0].decode().splitlines() if ":=" in line)
        found = {int(keys[f"Segment{n}_LabelValue"]): keys[f"Segment{n}_Name"] for n in range(len(keys) // 4)}
        self.assertGreater(len(found), 2)
        self.assertEqual(found, {n + 1: name for n, name in enumerate(names) if name})
        self.assertEqual(json.loads(latvox("info", "--json", self.dir / "a.nrrd").stdout)["voxels"], self.summary["voxels"])

    def test_signed_distances_of_a_band(self):
        arrays = self.write(BUNNY, IMAGES, *LATTICES["fcc"], "--band", "2v", "--signed")
        self.assertLess(numpy.nanmin(arrays["distance"]), 0)
        self.check_images(arrays, "distance", "float32")

    def test_a_shape_is_exact_and_keeps_every_voxel_at_its_place(self):
        plain = self.write(BUNNY, [], "--resolution", "20")
        shaped = self.write(BUNNY, [*IMAGES, ".vti"], "--resolution", "20", "--dims", "32,24,28", "--pad", "1")
        self.assertEqual(shaped["data"].shape, (32, 24, 28))
        self.check_images(shaped, "data", "uint8")
        same = [{tuple(v) for v in numpy.argwhere(arrays["data"]) + arrays["index_min"]} for arrays in (plain, shaped)]
        self.assertEqual(*same)
        self.assertTrue(same[0])
        for size in ("16", "33"):
            dims = self.write(BUNNY, [".vti"], "--dims", ",".join([size] * 3), "--set", "solid")["data"]
            self.assertEqual(dims.shape, (int(size),) * 3)
            full = [numpy.ptp(numpy.nonzero(dims)[m]) + 1 for m in range(3)]
            self.assertEqual(max(full), int(size), "the longest side has as many voxels as fit")
        done = latvox("voxelize", BUNNY, "-o", self.dir / "b.nrrd", "--resolution", "20", "--dims", "32,24,9")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, r"b.nrrd: --dims: 9 along k is less than the \d+ points that the voxels take")
        self.assertFalse((self.dir / "b.nrrd").exists())

    def test_dims_choose_the_greatest_resolution_that_fits(self):
        cube = write_obj(self.dir / "cube.obj", box((0, 0, 0), (1, 1, 1)))
        for mesh, dims, options in (
            (cube, (32, 32, 32), ["--set", "solid"]),
            (cube, (32, 32, 32), ["--set", "supercover-solid"]),
            (cube, (32, 32, 32), ["--set", "links"]),
            (cube, (32, 32, 32), ["--lattice", "bcc", "--pad", "2"]),
            (cube, (40, 32, 36), ["--lattice", "fcc"]),
            (cube, (24, 32, 32), ["--lattice", "hexagonal", "--set", "enclosed"]),
            (BUNNY, (32, 32, 32), ["--band", "2v"]),
            (BUNNY, (48, 32, 99), ["--band", "0.1", "--signed"]),
        ):
            with self.subTest(dims=dims, options=options):
                shape = ["--dims", ",".join(map(str, dims))]
                summary = self.voxelize(mesh, *shape, *options, out="d.npz")
                with numpy.load(self.dir / "d.npz") as arrays:
                    self.assertEqual(arrays["data"].shape, dims)
                    self.assertEqual(int(arrays["data"].sum()), summary["voxels"])
                told = json.loads(latvox("voxelize", mesh, *shape, *options, "-o", self.dir / "d.vdb", "-o",
                                         self.dir / "e.npz", "--json").stdout)  # fmt: skip
                self.assertEqual(told["digest"], summary["digest"])
                info = json.loads(latvox("info", "--json", self.dir / "d.vdb").stdout)
                resolution = json.loads(info["metadata"]["latvox_request"])["resolution"]
                same = self.voxelize(mesh, "--resolution", resolution, *shape, *options, out="d.npz")
                self.assertEqual(same["digest"], summary["digest"], "the grid holds the resolution")
                done = latvox("voxelize", mesh, "--resolution", resolution + 1, *shape, *options, "-o", self.dir / "f.npz")
                self.assertEqual(done.returncode, 3, done.stderr)
                self.assertIn("f.npz: --dims: ", done.stderr)
        done = latvox("voxelize", cube, "--dims", "4,4,4", "--band", "3v", "-o", self.dir / "g.npz")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, r"at --resolution 2: --dims: 4 along i is less than the \d+ points that the voxels take")
        self.assertFalse((self.dir / "g.npz").exists())

    def test_parts_have_the_resolution_that_dims_give_the_whole(self):
        options = ["--dims", "150,150,150", "--lattice", "bcc"]

        def resolved(name, *part):
            summary = self.voxelize(BUNNY, *options, *part, "-o", self.dir / f"{name}.npz", out=f"{name}.vdb")
            metadata = json.loads(latvox("info", "--json", self.dir / f"{name}.vdb").stdout)["metadata"]
            return summary, json.loads(metadata["latvox_request"])["resolution"]

        whole, resolution = resolved("whole")
        low, high = whole["index_box"]["min"], whole["index_box"]["max"]
        region = ",".join(map(str, [*low, *high[:2], (low[2] + high[2]) // 2]))
        for part in (["--region", region], ["--bounds=-9,-9,-9,0,9,9"]):
            summary, found = resolved("part", *part)
            self.assertEqual(found, resolution, part)
            self.assertTrue(0 < summary["voxels"] < whole["voxels"])
        shards = [resolved(f"shard{n}", "--shard", f"{n}/3") for n in range(3)]
        self.assertEqual([found for _, found in shards], [resolution] * 3)
        self.assertEqual(sum(summary["voxels"] for summary, _ in shards), whole["voxels"])
        digest = sum(int(summary["digest"], 16) for summary, _ in shards)
        self.assertEqual(f"{digest % 2**128:032x}", whole["digest"])

    def test_a_side_beyond_nifti_1_makes_nifti_2(self):
        mesh = write_obj(self.dir / "long.obj", box((0, 0, 0), (40000, 1, 1)))
        for field, dtype in (("distance", "float32"), ("normal", "float32"), ("part", "int32")):
            arrays = self.write(mesh, [".nii", ".nii.gz"], "--voxel-size", "1", "--fields", field)
            self.assertEqual(arrays["data"].shape[0], 40000)
            self.check_images(arrays, field, dtype, (".nii", ".nii.gz"))
            for name in ("a.nii", "a.nii.gz"):
                self.assertIsInstance(nibabel.load(self.dir / name), nibabel.Nifti2Image)
                facts = json.loads(latvox("info", "--json", self.dir / name).stdout)
                self.assertEqual((facts["voxels"], facts["shape"]), (self.summary["voxels"], list(arrays["data"].shape)))

    def test_images_far_from_the_origin_are_at_their_places(self):
        """Floats move voxels of 0.1 there, which NIfTI-1 has: at 5e6 by a whole one."""
        for far, version in ((300, nibabel.Nifti1Image), (5e6, nibabel.Nifti2Image)):
            mesh = write_obj(self.dir / "far.obj", box((far + 0.03, -far, 7), (far + 1.03, 1 - far, 8)))
            arrays = self.write(mesh, IMAGES, "--voxel-size", "0.1,0.1,0.13")
            corners = [(*(shape[m] - 1 if n >> m & 1 else 0 for m in range(3)), 1) for shape in [arrays["data"].shape] for n in range(8)]
            for extension in IMAGES:
                with self.subTest(extension, far=far):
                    array, affine = read(self.dir / f"a{extension}")
                    numpy.testing.assert_array_equal(array, arrays["data"])
                    shifts = numpy.array(corners) @ (affine - arrays["affine"]).T
                    self.assertLess(abs(shifts).max(), 1e-3 * 0.1)
            for name in ("a.nii", "a.nii.gz"):
                self.assertIs(type(nibabel.load(self.dir / name)), version)

    def test_a_binvox_takes_memory_for_bricks_alone(self):
        mesh = write_obj(self.dir / "cube.obj", box((0, 0, 0), (1, 1, 1)))
        peak = self.peak_memory("voxelize", mesh, "--resolution", "400", "--set", "interior", "-o", self.dir / "a.binvox")
        self.assertLess(peak / 2**20, 200, "MB; a position for each voxel takes 768")
        facts = json.loads(latvox("info", "--json", self.dir / "a.binvox").stdout)
        self.assertEqual((facts["voxels"], facts["shape"]), (400**3, [400] * 3))

    def test_memory_does_not_grow_with_the_box(self):
        outputs = [word for e in (".vti", ".nrrd", ".nii") for word in ("-o", self.dir / f"a{e}")]
        peak = self.peak_memory("voxelize", BUNNY, "--resolution", "400", "--fields", "distance", *outputs)
        self.assertLess(peak, (self.dir / "a.nii").stat().st_size * 0.6)

    def test_a_dense_npy_holds_one_field(self):
        for name in ("distance", "color"):
            arrays = self.write(SPIDER, [".npy"], "--resolution", "12", "--fields", name, "--npy", "dense", "--pad", "2")
            numpy.testing.assert_array_equal(numpy.load(self.dir / "a.npy"), arrays[name])

    def test_files_of_one_array_hold_the_fields_that_array_selects(self):
        labeled = ["--resolution", "12", "--set", "solid", "--labels", "part", "--fields", "distance"]
        cube = write_obj(self.dir / "cube.obj", box((0, 0, 0), (1, 1, 1)))
        done = latvox("voxelize", cube, "-o", self.dir / "a.nrrd", *labeled)
        self.assertEqual(done.returncode, 2)
        self.assertIn("a.nrrd cannot hold distance,part; .vdb", done.stderr)
        self.assertIn("--array selects some", done.stderr)
        self.check_surfaces(cube, labeled)
        arrays = self.write(cube, [*IMAGES, ".vdb"], *labeled, "--array", "distance")
        self.assertLessEqual({"part", "distance"}, arrays.keys(), "other files hold all")
        self.check_images(arrays, "distance", "float32")
        arrays = self.convert(IMAGES, "--array", "part")
        self.assertLessEqual({"part", "distance"}, arrays.keys())
        self.check_images(arrays, "part", "int32")
        arrays = self.write(cube, [*IMAGES, ".binvox"], *labeled, "--array", "none")
        self.check_images(arrays, "data", "uint8")
        line = {"mesh": str(cube), "resolution": 12, "set": "solid", "labels": "part", "fields": ["distance"],
                "array": ["distance"], "out": "b.nii"}  # fmt: skip
        (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.write(cube, [".nii"], *labeled, "--array", "distance")
        self.assertEqual((self.dir / "a.nii").read_bytes(), (self.dir / "b.nii").read_bytes())
        line["array"] = "part"
        (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotEqual((self.dir / "a.nii").read_bytes(), (self.dir / "b.nii").read_bytes(), "it is another job")

    def check_surfaces(self, mesh, labeled):
        """Formats without an array have limits on fields, too."""
        outputs = ["-o", self.dir / "a.glb", "-o", self.dir / "a.vox", "-o", self.dir / "a.links.csv"]
        for array, forms in (("part", outputs[:4]), ("none", outputs[:4]), ("links", outputs[4:])):
            fields = ["--fields", "distance,links"]
            summary = self.voxelize(mesh, *labeled[:-2], *fields, "--array", array, *forms, out="a.csv")
            self.assertEqual(set(summary["fields"]), {"distance", "links", "part"})
        done = latvox("voxelize", mesh, *labeled, *outputs[:2])
        self.assertIn("a.glb cannot hold distance,part; .vdb", done.stderr)
        self.assertIn("and --array selects some for this file", done.stderr)
        self.voxelize(mesh, "--resolution", "12", "--band", "2v", "--array", "none", *outputs[:4])

    def test_a_binvox_has_the_shape_of_the_npz(self):
        arrays = self.write(BUNNY, [".binvox"], "--dims", "24,24,24")
        head, _, runs = (self.dir / "a.binvox").read_bytes().partition(b"data\n")
        pairs = numpy.frombuffer(runs, "u1").reshape(-1, 2)
        cells = numpy.repeat(pairs[:, 0], pairs[:, 1]).reshape(24, 24, 24).transpose(0, 2, 1)
        numpy.testing.assert_array_equal(cells, arrays["data"])
        self.assertIn(b"\ndim 24 24 24\n", head)

    def convert(self, extensions, *options):
        """Converts a.vdb to these. Returns the arrays of a.npz."""
        outputs = [word for extension in (".npz", *extensions) for word in ("-o", self.dir / f"a{extension}")]
        done = latvox("convert", self.dir / "a.vdb", *outputs, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"{self.summary['voxels']} voxels", done.stdout)
        with numpy.load(self.dir / "a.npz") as arrays:
            return dict(arrays)

    def test_convert_keeps_every_voxel_with_its_values(self):
        for name, lattice in (("skewed", ["--basis", "3,0,0.2,0.5,2,0,0,1,4"]), ("fcc", ["--lattice", "fcc", "--resolution", "12"])):
            with self.subTest(name):
                fields = "part,material,color,distance,normal,point,triangle"
                whole = self.write(SPIDER, [".vdb"], *lattice, "--fields", fields)
                again = self.convert([".vtu", ".csv", ".ply", ".npy"])
                self.assertEqual(set(whole), set(again))
                at = numpy.argwhere(whole["data"])
                there = at + whole["index_min"] - again["index_min"]
                self.assertEqual(int(again["data"].sum()), len(at))
                for field in ("data", *fields.split(",")):
                    numpy.testing.assert_array_equal(again[field][tuple(there.T)], whole[field][tuple(at.T)], field)
                numpy.testing.assert_allclose(again["origin"], whole["origin"], rtol=1e-15)
                numpy.testing.assert_array_equal(again["basis"], whole["basis"])
                self.check_images(self.convert(IMAGES, "--fields", "normal"), "normal", "float32")
                self.check_images(self.convert(IMAGES, "--fields", "none", "--pad", "1"), "data", "uint8")

    def test_convert_refuses_what_a_format_cannot_hold(self):
        self.write(BUNNY, [".vdb"], "--resolution", "12", "--lattice", "bcc", "--fields", "part,distance")
        for options, code, says in (
            (["-o", "a.mha"], 3, "a.mha: cannot hold part,distance; .vdb .nvdb .csv .npy .npz .ply .png .html .vtu .cells.vtu .h5 can, and --array selects some for this file"),
            (["-o", "b.npy", "--npy", "dense"], 3, "cannot hold part,distance"),
            (["-o", "b.csv", "-o", "a.vti"], 3, "a.vti: the format holds boxes along the axes only, those of --lattice cartesian; .vdb .nvdb .csv .npy .npz .ply .png .html .vtu .cells.vtu .h5 can hold these voxels"),
            (["-o", "b.csv", "--fields", "color"], 3, "a.vdb: has no field color"),
            (["-o", "b.csv", "--fields", "links"], 3, "a.vdb: has no field links"),
            (["-o", "b.csv", "--pad", "1"], 2, "--pad: needs an output with a shape"),
            (["-o", "b.links.csv"], 3, "b.links.csv: cannot hold part,distance; "),
            (["-o", "b.glb"], 3, " can, and --array selects some for this file"),
            (["-o", "b.vox", "--array", "none"], 3, "b.vox: the format holds cubes along the axes only, those of --lattice cartesian with one --voxel-size; .vdb .nvdb .csv .npy .npz .ply .png .html .glb .vtu .cells.vtu .h5 .nrrd .mha .mhd .nii .nii.gz can hold these voxels"),
            (["-o", "b.vox"], 3, "b.vox: the format holds cubes along the axes only"),
            (["-o", "b.nii", "--array", "color"], 3, "a.vdb: has no field color"),
            (["-o", "b.nii", "--fields", "part", "--array", "distance"], 2, "--array: distance is not among --fields"),
            (["-o", "b.csv", "--array", "part"], 2, "--array: needs an output that cannot hold all fields: .npy .glb"),
            (["-o", "b.nii", "--fields", "part", "--dims", "3,99,99"], 3, "b.nii: --dims: 3 along i is less than"),
        ):  # fmt: skip
            before = sorted(self.dir.iterdir())
            done = latvox("convert", self.dir / "a.vdb", *options, cwd=self.dir)
            self.assertEqual((done.returncode, done.stdout), (code, ""), (options, done.stderr))
            self.assertIn(says, done.stderr)
            self.assertEqual(sorted(self.dir.iterdir()), before)

    def test_equal_jobs_write_equal_bytes(self):
        files = []
        for threads in ("1", "2"):
            self.write(BUNNY, (".vti", ".vtu", *IMAGES), "--resolution", "20", "--threads", threads)
            files.append([(self.dir / f"a{e}").read_bytes() for e in (".vti", ".vtu", *IMAGES, ".raw")])
        self.assertEqual(*files)

    def test_a_box_without_a_voxel_is_readable(self):
        self.write(BUNNY, IMAGES, "--resolution", "20", "--region", "1000,0,0,1001,1,1")
        for extension in IMAGES:
            self.assertEqual(read(self.dir / f"a{extension}")[0].tolist(), [[[0]]], extension)


if __name__ == "__main__":
    unittest.main()
