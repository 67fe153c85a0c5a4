"""The set links and its fields: formats, sides, other sets, parts and refusals."""

import json
import unittest

import numpy

from harness import BUNNY, Case, latvox, octahedron, write_obj

FIELDS = "links,link_triangles,link_crossings"
GRID = ["--voxel-size", "1", "--origin", "0,0,0"]


class Links(Case):
    def ball(self):
        """Writes an octahedron with corners at +-5.25 on the axes."""
        return write_obj(self.dir / "ball.obj", octahedron(5.25))

    def read(self, mesh, *options):
        """Returns the arrays of the .npz."""
        self.voxelize(mesh, *options, out="links.npz")
        with numpy.load(self.dir / "links.npz") as arrays:
            return dict(arrays)

    def test_a_table_and_arrays_list_the_crossed_links(self):
        outputs = [word for e in ("npz", "links.csv", "links.npz") for word in ("-o", self.dir / f"a.{e}")]
        self.voxelize(BUNNY, *outputs, "--lattice", "bcc", "--resolution", "20", "--set", "links", "--fields", FIELDS, out="a.csv")
        table = numpy.genfromtxt(self.dir / "a.links.csv", delimiter=",", names=True)
        with numpy.load(self.dir / "a.npz") as whole, numpy.load(self.dir / "a.links.npz") as lists:
            voxel, neighbor = numpy.nonzero(~numpy.isnan(whole["links"]))
            self.assertGreater(len(voxel), 1000)
            same = {"ijk": whole["ijk"][voxel], "neighbor": neighbor, "neighbors": whole["neighbors"], "basis": whole["basis"],
                    "origin": whole["origin"], "share": whole["links"][voxel, neighbor],
                    "triangle": whole["link_triangles"][voxel, neighbor], "crossings": whole["link_crossings"][voxel, neighbor]}  # fmt: skip
            self.assertEqual(set(lists), {*same, "lengths"})
            for name, values in same.items():
                numpy.testing.assert_array_equal(lists[name], values, name)
            numpy.testing.assert_allclose(lists["lengths"], numpy.linalg.norm(whole["neighbors"] @ whole["basis"], axis=1), rtol=1e-14)
            numpy.testing.assert_array_equal(numpy.c_[table["i"], table["j"], table["k"]], lists["ijk"])
            numpy.testing.assert_array_equal(numpy.c_[table["di"], table["dj"], table["dk"]], lists["neighbors"][neighbor])
            for name in ("share", "triangle", "crossings"):
                numpy.testing.assert_array_equal(table[name].astype(lists[name].dtype), lists[name], name)
            numpy.testing.assert_allclose(table["distance"], lists["share"] * lists["lengths"][neighbor], rtol=1e-8)
        for name in ("a.links.csv", "a.links.npz"):
            self.assertEqual(json.loads(latvox("info", "--json", self.dir / name).stdout)["links"], len(voxel), name)
        self.voxelize(BUNNY, "--resolution", "20", "--fields", "link_crossings", out="b.links.csv")
        self.assertEqual((self.dir / "b.links.csv").read_text().split("\n")[0], "i,j,k,di,dj,dk,crossings")
        for fields, says in ((["--fields", "part,links"], "a.links.csv cannot hold part,links; .vdb .nvdb .csv .npy .npz .ply .png .html .vti .vtu .cells.vtu .h5 can, and --array selects some for this file"),
                             ([], "--fields: a.links.csv needs links, link_triangles or link_crossings")):  # fmt: skip
            done = latvox("voxelize", BUNNY, "-o", "a.links.csv", *fields, cwd=self.dir)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(says, done.stderr)

    def test_links_of_an_octahedron_are_where_they_must_be(self):
        arrays = self.read(self.ball(), *GRID, "--separability", "1", "--set", "links", "--fields", FIELDS)
        neighbors, ijk = arrays["neighbors"], arrays["ijk"]
        self.assertEqual(neighbors.tolist(), sorted(neighbors.tolist()))
        self.assertEqual(len(neighbors), 18)
        self.assertEqual((arrays["links"].shape, arrays["links"].dtype), ((len(ijk), 18), numpy.float32))
        inside = numpy.abs(ijk).sum(1) < 5.25
        across = numpy.abs(ijk[:, None] + neighbors).sum(2) < 5.25
        crossed = ~numpy.isnan(arrays["links"])
        self.assertTrue((arrays["link_crossings"] % 2 == (inside[:, None] != across)).all())
        self.assertTrue(((arrays["link_triangles"] >= 0) == crossed).all())
        self.assertTrue(crossed.any(1).all())
        # Along an axis from inside, the share is 5.25 - |i| - |j| - |k|.
        n = neighbors.tolist().index([0, 0, 1])
        up = inside & ~across[:, n]
        numpy.testing.assert_allclose(arrays["links"][up, n], 5.25 - numpy.abs(ijk[up]).sum(1), rtol=1e-6)
        self.assertGreater(up.sum(), 30)

    def test_formats_agree(self):
        options = ["--resolution", "20", "--lattice", "bcc", "--set", "links", "--side", "outside", "--fields", FIELDS]
        npz = self.read(BUNNY, *options)
        self.voxelize(BUNNY, *options, "-o", self.dir / "a.npy", "-o", self.dir / "a.ply", out="a.csv")
        table = numpy.genfromtxt(self.dir / "a.csv", delimiter=",", skip_header=1)
        header = (self.dir / "a.csv").read_text().splitlines()[0].split(",")
        names = ["_".join(map(str, q)) for q in npz["neighbors"].tolist()]
        expected = [f"{kind}_{name}" for kind in ("link", "link_triangle", "link_crossings") for name in names]
        self.assertEqual(header[6:], expected)
        rows = numpy.c_[npz["ijk"], npz["links"], npz["link_triangles"], npz["link_crossings"]]
        numpy.testing.assert_array_equal(table[:, [0, 1, 2, *range(6, 48)]].astype(numpy.float32), rows.astype("f4"))
        npy = numpy.load(self.dir / "a.npy")
        for name in ("ijk", "links", "link_triangles", "link_crossings"):
            numpy.testing.assert_array_equal(npy[name], npz[name])
        self.assertIn(b"property float link_-1_-1_1\n", (self.dir / "a.ply").read_bytes())

    def test_other_sets_carry_the_same_links(self):
        links = self.read(self.ball(), *GRID, "--separability", "2", "--set", "links", "--fields", "links")
        expected = dict(zip(map(tuple, links["ijk"].tolist()), links["links"]))
        for options in (["--set", "interior"], ["--band", "2v"], []):
            with self.subTest(options):
                found = self.read(self.ball(), *GRID, "--separability", "2", *options, "--fields", "links")
                nothing = numpy.full(6, numpy.nan)
                for ijk, row in zip(found["ijk"].tolist(), found["links"]):
                    numpy.testing.assert_array_equal(row, expected.get(tuple(ijk), nothing))
                self.assertIn(tuple(ijk), {tuple(v) for v in numpy.argwhere(found["data"]) + found["index_min"]})

    def test_encodings_and_batches_give_the_same(self):
        options = ["--resolution", "24", "--set", "links", "--fields", FIELDS]
        summaries = [self.voxelize(BUNNY, *options, "--encoding", e) for e in ("masks", "packed", "packed-zstd")]
        self.assertEqual(len({json.dumps([s["digest"], s["fields"]]) for s in summaries}), 1)
        self.assertLess(summaries[2]["bytes"]["received"], summaries[1]["bytes"]["received"] / 3)
        line = {"mesh": str(BUNNY), "out": "b.npz", "resolution": 24, "set": "links", "side": "both",
                "fields": FIELDS.split(",")}  # fmt: skip
        (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.dir / "out/results.jsonl").read_text())
        self.assertEqual(result["summary"]["digest"], summaries[0]["digest"])

    def test_what_does_not_fit_is_refused(self):
        for options, status, says in (
            (["--set", "links", "--fields", "links", "-o", "a.glb"], 2,
             "--fields: a.glb cannot hold links; .vdb .nvdb .csv .npy .npz .ply .png .html .vti .vtu .cells.vtu .h5 .links.csv "
             ".links.npz .nrrd .mha .mhd .nii .nii.gz can, and --array none leaves them out of this file"),
            (["--set", "surface", "--side", "inside"], 2, "--side: needs --set links, not surface"),
            (["--set", "links", "--minimal"], 2, "--minimal: not together with --set links, which is not thinned"),
            (["--set", "links", "--fields", "link_triangles", "--upload", "draco", "-o", "a.csv"], 2,
             "--fields: link_triangles needs --upload raw"),
        ):  # fmt: skip
            with self.subTest(options):
                done = latvox("voxelize", self.ball(), "--resolution", "9", "--json", *options, cwd=self.dir)
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(says, done.stderr)
        open_mesh = write_obj(self.dir / "open.obj", ([(0, 0, 0), (9, 0, 0), (0, 9, 0)], [(0, 1, 2)]))
        done = latvox("voxelize", open_mesh, "--resolution", "9", "--json", "--set", "links", "--side", "inside")
        self.assertEqual((done.returncode, "a side of links asks for" in done.stderr), (3, True), done.stderr)


if __name__ == "__main__":
    unittest.main()
