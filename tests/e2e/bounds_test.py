"""--bounds: a box of the world cuts the whole exactly, on every lattice."""

import json
import math
import re
import unittest
from fractions import Fraction

from harness import BUNNY, Case, latvox, octahedron, rows, write_obj

LATTICES = [["--lattice", name] for name in ("cartesian", "bcc", "fcc", "hexagonal")]
SKEW = ["--basis", "0.05,0,0,0.02,0.05,0,0.01,-0.02,0.06"]


def inside(summary, bounds):
    """Returns a test for lattice points in the box, in rational numbers."""
    basis, origin = ([Fraction(x) for x in summary[name]] for name in ("basis", "origin"))
    low, high = ([Fraction(x) for x in bounds[n : n + 3]] for n in (0, 3))

    def contains(ijk):
        world = [origin[m] + sum(ijk[n] * basis[3 * n + m] for n in range(3)) for m in range(3)]
        return all(low[m] <= world[m] <= high[m] for m in range(3))

    return contains


def option(bounds):
    return "--bounds=" + ",".join(map(repr, bounds))


class Bounds(Case):
    def test_a_part_is_the_whole_cut_at_the_box(self):
        for lattice in [*LATTICES, SKEW]:
            density = [] if lattice is SKEW else ["--resolution", "48"]
            whole = self.voxelize(BUNNY, *lattice, *density)
            everything = rows(self.dir / "out.csv")
            # Faces at the voxels' own positions, as written: a rounded digit would move a voxel out or in.
            places = sorted(everything.values())
            low, high = places[len(places) // 5], places[len(places) // 2]
            bounds = [f(low[m], high[m]) for f in (min, max) for m in range(3)]
            contains = inside(whole, bounds)
            expected = {ijk: world for ijk, world in everything.items() if contains(ijk)}
            with self.subTest(lattice):
                self.assertTrue(0 < len(expected) < len(everything))
                part = self.voxelize(BUNNY, *lattice, *density, option(bounds))
                self.assertEqual(rows(self.dir / "out.csv"), expected)
                self.assertEqual(part["voxels"], len(expected))
                self.assertEqual((part["basis"], part["origin"]), (whole["basis"], whole["origin"]))
                self.assertFalse(part["certificate"]["minimal"])

    def test_faces_belong_to_the_box(self):
        mesh = write_obj(self.dir / "octahedron.obj", octahedron(4))
        options = ["--voxel-size", "1", "--origin", "0,0,0", "--set", "supercover"]
        self.voxelize(mesh, *options)
        everything = rows(self.dir / "out.csv")
        for z in (3, 3.000000001, 2.999999999):
            self.voxelize(mesh, *options, option([-9, -9, z, 9, 9, 4]))
            expected = {ijk: world for ijk, world in everything.items() if z <= world[2] <= 4}
            self.assertEqual(rows(self.dir / "out.csv"), expected)
            self.assertEqual({world[2] for world in expected.values()}, {4} if z > 3 else {3, 4})

    def test_scale_and_up_come_before(self):
        mesh = write_obj(self.dir / "octahedron.obj", octahedron())
        options = ["--scale", "8", "--up-axis", "y", "--voxel-size", "0.5"]
        whole = self.voxelize(mesh, *options)
        everything = rows(self.dir / "out.csv")
        self.voxelize(mesh, *options, option([-8, -8, 4, 8, 8, 8]))
        self.assertEqual(rows(self.dir / "out.csv"), {z: x for z, x in everything.items() if x[2] >= 4})
        self.assertGreater(whole["voxels"], len(rows(self.dir / "out.csv")))

    def test_parts_merge_to_the_whole_and_go_with_regions_and_bands(self):
        options = ["--lattice", "bcc", "--resolution", "60"]
        whole = self.voxelize(BUNNY, *options)
        x, *_ = sorted(rows(self.dir / "out.csv").values())[whole["voxels"] // 2]
        for n, bounds in enumerate(([-9, -9, -9, x, 9, 9], [x, -9, -9, 9, 9, 9])):
            self.voxelize(BUNNY, *options, option(bounds), out=f"part{n}.vdb")
        done = latvox("merge", self.dir / "part0.vdb", self.dir / "part1.vdb", "-o", self.dir / "all.vdb", "--json")
        self.assertEqual(json.loads(done.stdout)["digest"], whole["digest"], done.stderr)
        box = whole["index_box"]
        region = [*box["min"], *box["max"][:2], (box["min"][2] + box["max"][2]) // 2]
        bounds = [x, -9, -9, 9, 9, 9]
        for more in ([], ["--band", "1.5v"], ["--set", "supercover"], ["--set", "solid"]):
            more += ["--region=" + ",".join(map(str, region))]
            self.voxelize(BUNNY, *options, *more)
            lines = (self.dir / "out.csv").read_text().splitlines()
            contains = inside(whole, bounds)
            expected = [line for line in lines[1:] if contains([int(word) for word in line.split(",")[:3]])]
            self.voxelize(BUNNY, *options, *more, option(bounds))
            self.assertEqual((self.dir / "out.csv").read_text().splitlines()[1:], expected, more)

    def test_voxels_outside_cost_little(self):
        mesh = write_obj(self.dir / "octahedron.obj", octahedron())
        options = ["--lattice", "fcc", "--resolution", "60000"]
        part = self.voxelize(mesh, *options, option([0.999, -0.001, -0.001, 1, 0.001, 0.001]), "--timeout", "30")
        self.assertTrue(100 < part["voxels"] < 100000, part["voxels"])
        box = part["index_box"]
        self.assertLess(max(high - low for low, high in zip(box["min"], box["max"])), 200)

    def test_a_box_beside_the_mesh_is_told(self):
        mesh = write_obj(self.dir / "octahedron.obj", octahedron(4))
        options = ["--lattice", "bcc", "--voxel-size", "1", "--origin", "0,0,0"]
        whole = self.voxelize(mesh, *options)
        region, bounds = "--region=40,0,0,41,1,1", "--bounds=-0.5,9.25,0,1,10,1"
        for given, says in (
            ([bounds], r"warning: no voxel lies in the bounds -0.5,9.25,0,1,10,1 \(the mesh lies in -4,-4,-4,4,4,4\)\n"),
            ([region], r"warning: no voxel lies in the region 40,0,0,41,1,1 \(the mesh lies about in ([-\d,]+)\)\n"),
            ([region, bounds], r"no voxel lies in the region .*\) and in the bounds .*\)\n"),
            (["--shard=0/9999", "--resolution=2"], None),
            ([option([-9] * 3 + [9] * 3)], None),
        ):
            with self.subTest(given):
                used = options[:2] if "--resolution=2" in given else options
                done = latvox("voxelize", mesh, *used, *given, "--json", "-o", self.dir / "out.vdb")
                self.assertEqual(done.returncode, 0, done.stderr)
                lines = [line for line in done.stderr.splitlines() if "warning: " in line]
                self.assertEqual(len(lines), 0 if says is None else 1, done.stderr)
                if says is None:
                    continue
                summary = json.loads(done.stdout)
                self.assertEqual(summary["voxels"], 0)
                (warning,) = summary["warnings"]
                self.assertEqual(warning["code"], "EMPTY_RESULT")
                self.assertIn("warning: " + warning["message"] + "\n", done.stderr)
                names = [word[2:].split("=")[0] for word in given]
                self.assertEqual(warning["element"], ", ".join(names))
                found = re.search(says, done.stderr)
                self.assertTrue(found, done.stderr)
                if found.groups():
                    # The mesh's box on this lattice: k = z / c, i = (x - z) / a, and j likewise.
                    a, c = whole["basis"][0], whole["basis"][8]
                    ij, k = math.ceil(8 / a), math.ceil(4 / c)
                    self.assertEqual(list(map(int, found[1].split(","))), [-ij, -ij, -k, ij + 1, ij + 1, k + 1])
        info = latvox("info", self.dir / "out.vdb").stdout
        self.assertNotIn("empty", info)
        self.voxelize(mesh, *options, bounds, out="out.vdb")
        info = latvox("info", self.dir / "out.vdb").stdout
        for line in ("active voxels  0", "active box     empty", "file_bbox_max = empty", "file_bbox_min = empty"):
            self.assertIn(line + "\n", info)
        self.assertRegex(info, r'latvox_warnings = \[\{"code":"EMPTY_RESULT","message":".*","element":"bounds"\}\]\n')
        (self.dir / "jobs.jsonl").write_text(
            json.dumps({"mesh": "octahedron.obj", "voxel_size": 1, "bounds": [9, 9, 9, 10, 10, 10], "out": "a.csv"}))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertIn("latvox: a.csv: warning: no voxel lies in the bounds 9,9,9,10,10,10 (the mesh", done.stderr)
        (line,) = (self.dir / "results.jsonl").read_text().splitlines()
        self.assertEqual([warning["code"] for warning in json.loads(line)["summary"]["warnings"]], ["EMPTY_RESULT"])

    def test_bad_bounds_are_refused(self):
        for bounds, says in (("0,0,0,1,1", "6 finite numbers"), ("0,0,1,1,1,0", "0 is below 1 on axis z")):
            done = latvox("voxelize", BUNNY, "-o", self.dir / "o.vdb", "--resolution", 9, "--bounds", bounds)
            self.assertEqual(done.returncode, 2)
            self.assertIn("--bounds", done.stderr)
            self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()
