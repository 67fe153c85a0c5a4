"""numpy reads .npz files, and their affine places each voxel where the .csv has it."""

import itertools
import unittest
import zipfile

import numpy

from harness import BUNNY, Case, latvox, octahedron, write_obj

SKEWED = ["--basis", "0.2,0,0.01,0.02,0.25,0,0,0.03,0.3"]
GRID = ["--voxel-size", "1", "--origin", "0,0,0", "--quantization", "0"]


class Npz(Case):
    def write(self, mesh, *options):
        """Writes a.npz and a.csv. Returns the arrays by name and the table."""
        self.voxelize(mesh, "-o", self.dir / "a.npz", *options, out="a.csv")
        with numpy.load(self.dir / "a.npz") as arrays:
            table = numpy.genfromtxt(self.dir / "a.csv", delimiter=",", names=True, dtype=None)
            return dict(arrays), table

    def check_places(self, arrays, table, filled):
        """Each filled element is a voxel at its position, and there is no other."""
        at = numpy.argwhere(filled)
        ijk = at + arrays["index_min"]
        expected = {(r["i"], r["j"], r["k"]): (r["x"], r["y"], r["z"]) for r in table}
        self.assertEqual(set(map(tuple, ijk.tolist())), set(expected))
        positions = numpy.array([expected[tuple(v)] for v in ijk.tolist()])
        by_affine = (arrays["affine"] @ numpy.c_[at, numpy.ones(len(at))].T).T
        numpy.testing.assert_allclose(by_affine[:, :3], positions, rtol=0, atol=1e-12)
        self.assertTrue((by_affine[:, 3] == 1).all())
        numpy.testing.assert_allclose(arrays["origin"] + ijk @ arrays["basis"], positions, rtol=0, atol=1e-12)
        return at

    def test_the_affine_places_the_voxels_of_every_lattice(self):
        for options in (*(["--lattice", name, "--resolution", "40"] for name in ("cartesian", "bcc", "fcc", "hexagonal")),
                        SKEWED, [*SKEWED, "--origin", "0.5,-3,1", "--region=-6,9,-4,1,13,-1"]):  # fmt: skip
            with self.subTest(options):
                arrays, table = self.write(BUNNY, *options)
                data = arrays["data"]
                self.assertEqual((data.dtype, arrays["index_min"].dtype), (numpy.uint8, numpy.int32))
                self.assertEqual({arrays[n].dtype for n in ("affine", "basis", "origin")}, {numpy.dtype("<f8")})
                self.assertEqual(list(arrays), ["data", "ijk", "index_min", "affine", "basis", "origin"])
                self.assertEqual(arrays["ijk"].dtype, numpy.int32)
                numpy.testing.assert_array_equal(arrays["ijk"], numpy.c_[table["i"], table["j"], table["k"]])
                self.assertEqual(set(numpy.unique(data)), {0, 1})
                self.check_places(arrays, table, data)

    def test_the_box_is_that_of_the_summary(self):
        summary = self.voxelize(BUNNY, "--resolution", "40", "--lattice", "fcc", out="a.npz")
        with numpy.load(self.dir / "a.npz") as arrays:
            low, high = summary["index_box"]["min"], summary["index_box"]["max"]
            self.assertEqual(arrays["index_min"].tolist(), low)
            self.assertEqual(arrays["data"].shape, tuple(h - l for l, h in zip(low, high)))
            self.assertEqual(arrays["basis"].ravel().tolist(), summary["basis"])
            self.assertEqual(arrays["origin"].tolist(), summary["origin"])

    def test_the_box_is_that_of_the_voxels(self):
        for options in (["--set", "solid"], ["--set", "supercover"], ["--band", "1.5v"], ["--lattice", "bcc"],
                        ["--region=0,0,0,9,9,9"], ["--pad", "3"]):  # fmt: skip
            with self.subTest(options):
                summary = self.voxelize(BUNNY, "--resolution", "20", *options, out="a.npz")
                pad = 3 if "--pad" in options else 0
                with numpy.load(self.dir / "a.npz") as arrays:
                    ijk = arrays["ijk"]
                    low, high = ijk.min(axis=0), ijk.max(axis=0) + 1
                    self.assertEqual(summary["index_box"], {"min": low.tolist(), "max": high.tolist()})
                    self.assertEqual(arrays["data"].shape, tuple(high - low + 2 * pad))
                    self.assertEqual(arrays["index_min"].tolist(), (low - pad).tolist())

    def test_distances_are_an_array_of_their_own(self):
        arrays, table = self.write(BUNNY, "--resolution", "30", "--lattice", "bcc", "--band", "2v", "--signed")
        data = arrays["distance"]
        self.assertEqual(data.dtype, numpy.float32)
        at = self.check_places(arrays, table, arrays["data"])
        self.assertTrue((numpy.isnan(data) == (arrays["data"] == 0)).all())
        expected = {(r["i"], r["j"], r["k"]): numpy.float32(r["distance"]) for r in table}
        for a in at:
            self.assertEqual(data[tuple(a)], expected[tuple((a + arrays["index_min"]).tolist())])

    def test_attributes_are_arrays_of_their_own(self):
        text, count = ["o left", "usemtl wood"], 0
        for n in range(2):
            vertices, triangles = octahedron(5.0)
            text += [f"v {x + 20 * n} {y} {z} {n} 0.2 1" for x, y, z in vertices]
            text += ["o right", "usemtl iron"] * n + ["f " + " ".join(str(v + 1 + count) for v in t) for t in triangles]
            count += len(vertices)
        (self.dir / "m.obj").write_text("\n".join(text) + "\n")
        arrays, table = self.write(self.dir / "m.obj", *GRID, "--fields", "material,color,part")
        at = self.check_places(arrays, table, arrays["data"])
        self.assertEqual([arrays[n].dtype for n in ("part", "material", "color")],
                         [numpy.int32, numpy.int32, numpy.uint8])  # fmt: skip
        self.assertEqual(arrays["color"].shape, (*arrays["data"].shape, 3))
        carried = {(r["i"], r["j"], r["k"]): (r["part"], r["material"], r["red"], r["green"], r["blue"]) for r in table}
        self.assertEqual({v[0] for v in carried.values()}, {0, 1})
        for a in map(tuple, at.tolist()):
            ijk = tuple((numpy.array(a) + arrays["index_min"]).tolist())
            self.assertEqual((arrays["part"][a], arrays["material"][a], *arrays["color"][a]), carried[ijk])
        empty = arrays["data"] == 0
        for name, value in (("part", -1), ("material", -1), ("color", 0)):
            self.assertTrue((arrays[name][empty] == value).all(), name)

    def test_the_same_voxels_are_the_same_bytes(self):
        files = []
        for threads in ("1", "2"):
            self.voxelize(BUNNY, "--resolution", "60", "--threads", threads, out="a.npz")
            files.append((self.dir / "a.npz").read_bytes())
        self.assertEqual(*files)
        with zipfile.ZipFile(self.dir / "a.npz") as archive:
            self.assertIsNone(archive.testzip())

    def test_a_box_without_a_voxel_is_an_empty_array(self):
        self.voxelize(BUNNY, "--resolution", "20", "--region", "1000,0,0,1001,1,1", out="a.npz")
        with numpy.load(self.dir / "a.npz") as arrays:
            self.assertEqual((arrays["data"].shape, arrays["ijk"].shape), ((0, 0, 0), (0, 3)))

    def test_a_box_that_is_too_large_is_refused_and_leaves_the_old_file(self):
        (self.dir / "a.npz").write_text("old")
        for options, shape in ((["--resolution", "3000"], r"\d+ x \d+ x \d+"),
                               (["--resolution", "1200", "--band", "1v"], r"\d+ x \d+ x \d+")):  # fmt: skip
            done = latvox("voxelize", BUNNY, "-o", self.dir / "a.npz", *options)
            self.assertEqual(done.returncode, 5, done.stderr)
            self.assertRegex(done.stderr, rf"a.npz: a dense array of {shape} elements exceeds 4294967296 bytes")
            self.assertEqual({p.name: p.read_text() for p in self.dir.iterdir()}, {"a.npz": "old"})

    def test_a_npy_alone_warns_that_it_has_no_place(self):
        mesh = write_obj(self.dir / "m.obj", octahedron(5.0))
        for names, options, warns in ((["a.npy"], [], True), (["a.npy"], ["--npy", "dense"], True),
                                      (["a.png", "a.npy"], [], True), (["a.npy", "a.npz"], [], False),
                                      (["a.npy", "a.csv"], [], False), (["a.npy"], ["--json"], False),
                                      (["a.npz"], [], False)):  # fmt: skip
            with self.subTest(names=names, options=options):
                files = itertools.chain.from_iterable(("-o", self.dir / name) for name in names)
                done = latvox("voxelize", mesh, *files, *GRID, *options)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual("a.npy does not tell where its voxels are in the world; a .npz does" in done.stderr, warns)


if __name__ == "__main__":
    unittest.main()
