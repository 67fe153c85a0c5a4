"""Links in .vdb and .nvdb files: convert, merge, compare, slice, render and view read them back."""

import collections
import csv
import json
import unittest

import numpy
import pyopenvdb

from harness import BUNNY, Case, latvox, octahedron, write_obj
from picture_test import read_png

FIELDS = "links,link_triangles,link_crossings"
SKEWED = ["--basis", "0.1,0,0.01,0.02,0.12,0,0,0.03,0.15", "--origin", "0.5,-3,1"]
JOBS = {
    "D3Q27": ["--resolution", "20", "--set", "links", "--fields", FIELDS],
    "D3Q7, a side": ["--resolution", "24", "--separability", "2", "--set", "links", "--side", "outside", "--fields", "links"],
    "BCC": ["--lattice", "bcc", "--resolution", "24", "--set", "links", "--fields", FIELDS],
    "skewed": [*SKEWED, "--set", "links", "--fields", "link_triangles,link_crossings"],
    "solid with others": ["--resolution", "24", "--set", "solid", "--fields", "part,normal,links,link_crossings,fraction:4"],
    "band": ["--resolution", "24", "--band", "2v", "--fields", "distance,links"],
    "nothing": ["--resolution", "24", "--region", "900,0,0,901,1,1", "--set", "links", "--fields", "links"],
}
GRAY = (0xBB, 0xBB, 0xBB)


class LinkGrids(Case):
    def write(self, job, *names, mesh=BUNNY):
        return self.voxelize(mesh, *job, *(word for name in names[1:] for word in ("-o", self.dir / name)), out=names[0])

    def convert(self, name, *outputs, options=()):
        words = [word for output in outputs for word in ("-o", self.dir / output)]
        done = latvox("convert", self.dir / name, *words, *options)
        self.assertEqual(done.returncode, 0, done.stderr)

    def fails(self, command, *words, says, status=3):
        done = latvox(command, *words, cwd=self.dir)
        self.assertEqual((done.returncode, says in done.stderr), (status, True), done.stderr)

    def equal(self, a, b, msg=None):
        """Compares bytes, without printing them."""
        self.assertTrue((self.dir / a).read_bytes() == (self.dir / b).read_bytes(), f"{a} is not {b}: {msg}")

    def compare(self, a, b, status):
        done = latvox("compare", "--json", self.dir / a, self.dir / b)
        self.assertEqual(done.returncode, status, done.stderr + done.stdout)
        return json.loads(done.stdout)

    def test_converted_files_are_those_of_voxelize(self):
        (self.dir / "again").mkdir()
        for name, job in JOBS.items():
            with self.subTest(name):
                compared = ["vdb", "nvdb", "html"]
                if name == "D3Q27":
                    compared += ["npy", "npz", "ply", "vtu", "cells.vtu", "h5", "png", "links.csv", "links.npz"]
                formats = ["csv", *compared]
                self.write(job, *(f"a.{end}" for end in formats))
                for source in ("a.vdb", "a.nvdb"):
                    self.convert(source, *(f"again/a.{end}" for end in formats))
                    for end in compared:
                        self.equal(f"again/a.{end}", f"a.{end}", source)
                    # Rows of a grid are in the order of bricks, those of a call in the order of the stream.
                    tables = [sorted((self.dir / place / "a.csv").read_text().splitlines()) for place in ("again", ".")]
                    self.assertTrue(tables[0] == tables[1], source)

    def test_other_programs_read_the_crossed_links(self):
        self.write([*JOBS["BCC"][:-1], "links"], "a.vdb", "a.npz")  # pyopenvdb has no integer grids
        with numpy.load(self.dir / "a.npz") as arrays:
            links, ijk, neighbors = arrays["links"], arrays["ijk"], arrays["neighbors"]
        grids = {grid.name: grid for grid in pyopenvdb.readAllGridMetadata(str(self.dir / "a.vdb"))}
        names = ["_".join(map(str, q)) for q in neighbors.tolist()]
        self.assertEqual(set(grids), {"voxels", *(f"link_{name}" for name in names)})
        self.assertEqual(grids["link_1_0_0"]["latvox_fields"], "links")
        for n, name in enumerate(names):
            grid = pyopenvdb.read(str(self.dir / "a.vdb"), f"link_{name}")
            found = {value.min: value.value for value in grid.citerOnValues()}
            crossed = ~numpy.isnan(links[:, n])
            self.assertEqual(found, dict(zip(map(tuple, ijk[crossed].tolist()), links[crossed, n].tolist())))
            self.assertEqual(grid.background, 0)

    def test_some_fields_of_a_file(self):
        self.write(JOBS["solid with others"], "a.vdb", "a.npz")
        self.convert("a.vdb", "b.vdb", "b.links.csv", options=["--fields", "link_crossings"])
        metadata = json.loads(latvox("info", "--json", self.dir / "b.vdb").stdout)["metadata"]
        self.assertEqual(metadata["latvox_fields"], "link_crossings")
        self.assertNotIn("latvox_links_digest", metadata)
        with numpy.load(self.dir / "a.npz") as arrays, (self.dir / "b.links.csv").open() as file:
            self.assertEqual(len(list(csv.DictReader(file))), (arrays["link_crossings"] > 0).sum())
        self.fails("convert", "a.vdb", "-o", "a.links.csv", says="a.links.csv: cannot hold part,normal,links,link_crossings,fraction; .vdb")
        self.fails("convert", "a.vdb", "-o", "a.links.csv", "--fields", "none", says="a.links.csv: cannot hold voxels without links; .vdb")
        self.fails("convert", "a.vdb", "-o", "a.csv", "--fields", "link_triangles", says="a.vdb: has no field link_triangles")
        self.fails("convert", "b.vdb", "-o", "a.glb", says="a.glb: cannot hold link_crossings; .vdb .nvdb .csv")

    def test_shards_are_the_whole_byte_for_byte(self):
        mesh = write_obj(self.dir / "octahedron.obj", octahedron(8))
        for name in ("D3Q27", "BCC", "skewed", "solid with others", "band"):
            job = ["--voxel-size", "0.3" if name != "skewed" else "0.4", *JOBS[name]]
            job = [word for n, word in enumerate(job) if word != "--resolution" and (n == 0 or job[n - 1] != "--resolution")]
            with self.subTest(name):
                self.write(job, "whole.vdb", mesh=mesh)
                for extension in ("vdb", "nvdb"):
                    parts = [f"part{n}.{extension}" for n in range(3)]
                    for n, part in enumerate(parts):
                        self.write([*job, "--shard", f"{n}/3"], part, mesh=mesh)
                    done = latvox("merge", *(self.dir / part for part in parts), "-o", self.dir / "merged.vdb")
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.equal("merged.vdb", "whole.vdb", extension)

    def test_regions_that_overlap_within_bricks_are_the_whole(self):
        mesh = write_obj(self.dir / "octahedron.obj", octahedron(8))
        boxes = ("-999,-999,-999,5,999,999", "3,-999,-999,999,12,999", "3,9,-999,999,999,999", "900,0,0,901,1,1")
        for name in ("D3Q27", "BCC"):
            with self.subTest(name):
                job = ["--voxel-size", "0.3", *[word for word in JOBS[name] if word not in ("--resolution", "20", "24")]]
                self.write(job, "whole.vdb", mesh=mesh)
                for n, box in enumerate(boxes):
                    self.write([*job, f"--region={box}"], f"part{n}.vdb", mesh=mesh)
                done = latvox("merge", *(self.dir / f"part{n}.vdb" for n in range(4)), "-o", self.dir / "merged.vdb")
                self.assertEqual(done.returncode, 0, done.stderr)
                report = self.compare("merged.vdb", "whole.vdb", 1)
                self.assertLessEqual({field["name"] for field in report["fields"]}, {"latvox_region", "latvox_minimal"})
                self.assertEqual((report["only_a"], report["only_b"]), (0, 0))
                self.assertEqual(report["values"], dict.fromkeys(FIELDS.split(","), 0))

    def test_parts_with_other_links_are_refused(self):
        job = [word for word in JOBS["D3Q7, a side"] if word not in ("--separability", "2")]
        for n, k in enumerate("21"):
            self.write([*job, "--separability", k, "--shard", f"{n}/2"], f"part{n}.vdb")
        self.fails("merge", "part0.vdb", "part1.vdb", "-o", "a.vdb", says="latvox_separability is 1, but 2 in")

    def changed(self, name, byte):
        """Writes a copy with another byte at the end of the last grid, whose shares they are. Returns its name."""
        data = bytearray((self.dir / name).read_bytes())
        data[-2] ^= byte
        (self.dir / f"changed-{name}").write_bytes(data)
        return f"changed-{name}"

    def test_compare_counts_links_that_differ(self):
        self.write(JOBS["D3Q7, a side"], "a.vdb", "a.nvdb")
        report = self.compare("a.vdb", "a.nvdb", 0)
        self.assertEqual((report["values"], report["links"]), ({"links": 0}, {"crossed_in_one": 0, "greatest": 0}))
        other = self.changed("a.vdb", 1)
        report = self.compare("a.vdb", other, 1)
        self.assertEqual((report["equal"], report["values"], report["links"]["crossed_in_one"]), (False, {"links": 1}, 0))
        self.assertGreater(report["links"]["greatest"], 0)
        self.assertEqual(report["fields"], [])
        text = latvox("compare", self.dir / "a.vdb", self.dir / other).stdout
        self.assertRegex(text, "links: 1 of the voxels in both differ; links crossed in one file alone: 0; greatest difference of shares: 0[.0-9e-]+\n")
        done = latvox("compare", self.dir / "a.vdb", self.dir / other, "-o", self.dir / "difference.vdb")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(pyopenvdb.read(str(self.dir / "difference.vdb"), "voxels").activeVoxelCount(), 1)
        self.assertEqual(self.compare("a.vdb", "difference.vdb", 1)["links"], None)
        self.fails("merge", other, "-o", "b.vdb", says="is damaged: its voxels have digest")

    def test_compare_counts_links_that_are_crossed_in_one_file(self):
        """A plate ends. Voxels beside its rim stay in the set, because the plate of the other file is longer."""
        for name, end in ("a", 6), ("b", 6.5):
            mesh = write_obj(self.dir / f"{name}.obj", ([(0, 0, 0.5), (end, 0, 0.5), (0, end, 0.5)], [(0, 1, 2)]))
            job = ["--voxel-size", "1", "--origin", "0.25,0.25,0", "--band", "3", "--separability", "0", "--fields", "links"]
            self.write(job, f"{name}.vdb", f"{name}.npz", mesh=mesh)
        with numpy.load(self.dir / "a.npz") as a, numpy.load(self.dir / "b.npz") as b:
            crossed = [{(*ijk, n) for ijk, row in zip(each["ijk"].tolist(), each["links"]) for n in numpy.flatnonzero(~numpy.isnan(row))}
                       for each in (a, b)]  # fmt: skip
            both = set(map(tuple, a["ijk"].tolist())) & set(map(tuple, b["ijk"].tolist()))
        differ = {link for link in crossed[0] ^ crossed[1] if link[:3] in both}
        report = self.compare("a.vdb", "b.vdb", 1)
        self.assertGreater(len(differ), 0)
        self.assertEqual(report["links"]["crossed_in_one"], len(differ))
        self.assertEqual(report["values"]["links"], len({link[:3] for link in differ}))

    def test_files_with_other_neighbors_differ(self):
        for k in "20":
            self.write(["--resolution", "16", "--set", "links", "--separability", k, "--fields", "links"], f"{k}.vdb")
        report = self.compare("2.vdb", "0.vdb", 1)
        fields = {field["name"]: field for field in report["fields"]}
        self.assertEqual(fields["neighbors"]["a"], "-1,0,0 0,-1,0 0,0,-1 0,0,1 0,1,0 1,0,0")
        self.assertEqual((report["values"], report["links"]), ({}, None))

    def picture(self, command, *options, text):
        """Draws a.vdb. Returns the number of pixels of each color."""
        done = latvox(command, self.dir / "a.vdb", "-o", self.dir / "a.png", "--size", "300", *options)
        self.assertEqual((done.returncode, text in done.stdout), (0, True), done.stderr + done.stdout)
        return collections.Counter(tuple(color) for line in read_png(self.dir / "a.png")[2] for color in line)

    def test_pictures_show_the_least_share_the_first_triangle_and_the_most_crossings(self):
        mesh = write_obj(self.dir / "octahedron.obj", octahedron(5.25))
        self.write(["--voxel-size", "1", "--origin", "0,0,0", "--separability", "2", "--set", "solid", "--fields", FIELDS],
                   "a.vdb", "a.npz", "a.png", "a.html", mesh=mesh)  # fmt: skip
        layer = ["--axis", "z", "--index", "0", "-o", self.dir / "a.csv"]
        shares = self.picture("slice", *layer, "--color-by", "links", "--legend", text=", colored by links")
        # Along the axes, the octahedron is a quarter of a step beyond the last voxel inside.
        quarter = (59, 82, 139)  # of viridis, at 1/4
        self.assertGreater(min(shares[GRAY], shares[quarter]), 1000)
        with (self.dir / "a.csv").open() as file, numpy.load(self.dir / "a.npz") as arrays:
            table = list(csv.DictReader(file))
            names = ["_".join(map(str, q)) for q in arrays["neighbors"].tolist()]
            by_place = dict(zip(map(tuple, arrays["ijk"].tolist()), arrays["links"]))
        self.assertGreater(len(table), 50)
        for row in table:
            found = numpy.array([float(row[f"link_{name}"]) for name in names], dtype="f4")
            numpy.testing.assert_array_equal(found, by_place[tuple(int(row[c]) for c in "ijk")])
        triangles = self.picture("slice", *layer, "--color-by", "link_triangles", text=", colored by link_triangles")
        self.assertGreater(len([color for color, pixels in triangles.items() if pixels > 500 and color != GRAY]), 3)
        crossings = self.picture("slice", *layer, "--color-by", "link_crossings", text=", colored by link_crossings")
        self.assertGreater(min(crossings[GRAY], crossings[0x56, 0xB4, 0xE9]), 1000)  # the palette's second
        self.assertEqual(crossings[GRAY], triangles[GRAY])
        self.picture("render", "--color-by", "links", text=", colored by links")
        for command in ("view", "convert"):
            done = latvox(command, self.dir / "a.vdb", "-o", self.dir / "b.html")
            self.assertEqual(done.returncode, 0, done.stderr)
            page = (self.dir / "b.html").read_text()
            for name in FIELDS.split(","):
                self.assertIn(f'{{"name":"{name}",', page)
            self.assertIn('"no crossed link: ', page)
        self.write(["--resolution", "9"], "a.vdb")
        self.fails("slice", "a.vdb", "-o", "b.png", "--color-by", "links", says="a.vdb: the voxels have no links, which --color-by requires")

    def grids(self):
        """Writes D3Q7's links as a.vdb. Returns the grids by name. (pyopenvdb has no integer grids.)"""
        self.write(JOBS["D3Q7, a side"], "a.vdb")
        return {grid.name: pyopenvdb.read(str(self.dir / "a.vdb"), grid.name) for grid in pyopenvdb.readAllGridMetadata(str(self.dir / "a.vdb"))}

    def test_files_that_contradict_themselves_are_refused(self):
        grids = self.grids()

        def refuses(says, **changes):
            pyopenvdb.write(str(self.dir / "b.vdb"), [grid for grid in {**grids, **changes}.values() if grid is not None])
            self.fails("convert", "b.vdb", "-o", "b.csv", says=says)

        def changed(name, value, ijk=None):
            grid = grids[name].deepCopy()
            grid.getAccessor().setValueOn(ijk or next(grid.citerOnValues()).min, value)
            return grid

        refuses('b.vdb: lacks the grid "link_-1_0_0"', **{"link_-1_0_0": None})
        for share in (0, -0.5, 1.5, float("nan"), float("inf")):
            refuses('b.vdb: the grid "link_0_0_1" has values that are no links', link_0_0_1=changed("link_0_0_1", share))
        refuses('the grid "link_0_0_1" has voxels that the grid "voxels" lacks', link_0_0_1=changed("link_0_0_1", 0.5, (999, 0, 0)))
        zero = grids["link_0_0_1"].deepCopy()
        zero.name = "link_0_0_0"
        refuses("b.vdb: has grids of a link with the step 0,0,0", link_0_0_0=zero)
        vector = pyopenvdb.Vec3SGrid()
        vector.name = "link_0_0_1"
        refuses('the grid "link_0_0_1" is a Tree_vec3s_5_4_3, not a Tree_float_5_4_3', link_0_0_1=vector)
        many = {}
        for n in range(2, 13):
            for step in (n, -n):
                many[f"link_0_0_{step}"] = grids["link_0_0_1"].deepCopy()
                many[f"link_0_0_{step}"].name = f"link_0_0_{step}"
        refuses("b.vdb: has grids of links to 28 neighbors, the limit is 26", **many)

    def test_the_memory_follows_the_links(self):
        """Together, 78 grids of this surface would take 1.3 GB."""
        job = ["--resolution", "400", "--set", "links", "--side", "outside"]
        plain = self.peak_memory("voxelize", BUNNY, *job, "-o", self.dir / "a.vdb")
        for name in ("a.vdb", "a.nvdb"):
            self.assertLess(self.peak_memory("voxelize", BUNNY, *job, "--fields", FIELDS, "-o", self.dir / name), plain + 6e8)


if __name__ == "__main__":
    unittest.main()
