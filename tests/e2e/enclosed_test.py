"""`--set enclosed` and `--set region` with the real tool: the example of the page, refusals, parts, batches."""

import json
import pathlib
import re
import unittest

from harness import Case, box, latvox, octahedron, rows, write_obj

PAGE = pathlib.Path(__file__).resolve().parents[2] / "client/docs/sets.md"
CABIN, TUNNEL = "2.1,0.9,1.3", "-2,1,2"


class Enclosed(Case):
    def setUp(self):
        super().setUp()
        for name, text in re.findall(r"cat > (\w+\.obj) <<'END'\n(.*?)END\n", PAGE.read_text(), re.S):
            (self.dir / name).write_text(text)
        self.car, self.tunnel = self.dir / "car.obj", self.dir / "tunnel.obj"
        self.grid = ("--voxel-size", "0.05")

    def test_a_leak_is_explained_and_closed(self):
        leaky = self.voxelize(self.car, *self.grid, "--set", "enclosed", "--leak-from", CABIN)
        leak = leaky["certificate"]["walk"]["leak"]
        self.assertEqual(leak["kind"], "leak")
        x, y, z = leak["narrowest_world"]
        self.assertTrue(1.3 < x < 2.95 and abs(y - 0.1) < 0.06 and 1.35 < z < 1.45, leak)
        self.assertEqual(leak["path"][0], leak["from"])
        self.assertEqual(len(leak["path"]), leak["steps"] + 1)
        closed = self.voxelize(self.car, *self.grid, "--set", "enclosed", "--close", "0.15", "--leak-from", CABIN)
        self.assertEqual(closed["certificate"]["walk"]["leak"]["kind"], "enclosed")
        walk = closed["certificate"]["walk"]
        self.assertEqual(walk["cavities"], 2)
        self.assertEqual([round(volume / 0.05**3) for volume in walk["largest_volumes"]], walk["largest_cavities"])
        self.assertGreater(closed["voxels"], leaky["voxels"])
        options = ["--set", "enclosed", "--close", "0", "--leak-from", CABIN, "-o", self.dir / "a.csv"]  # 0 closes none
        text = latvox("voxelize", self.car, *self.grid, *options)
        self.assertIn("through an opening around", text.stdout)
        self.assertIn(f"digest {leaky['digest']}", text.stdout)

    def test_the_largest_cavity_has_points_and_volume(self):
        cube = write_obj(self.dir / "cube.obj", box((0, 0, 0), (8, 8, 8)))
        options = ["--origin", "0.25,0.25,0.25", "--set", "enclosed", "-o", self.dir / "a.csv"]
        for lattice in ("cartesian", "fcc"):
            found = latvox("voxelize", cube, "--lattice", lattice, "--voxel-size", "0.5", *options)
            points, volume = re.search(r"1 enclosed part, the largest of (\d+) points, volume (\S+)\n", found.stdout).groups()
            self.assertAlmostEqual(float(volume), int(points) / 8, delta=1e-5 * float(volume))

    def test_a_hole_is_closed_by_its_width_and_the_longest_step(self):
        step, width = 0.1, 0.125
        for low in (0.3, 0.4, 0.43):  # of the hole, in the face z = 1
            vertices, triangles = box((0, 0, 0), (1, 1, 1))
            top = [n for n, v in enumerate(vertices) if v[2] == 1]
            triangles = [t for t in triangles if not set(t) <= set(top)]
            outer, inner = sorted(top, key=vertices.__getitem__), range(len(vertices), len(vertices) + 4)
            vertices += [(x, y, 1) for x in (low, low + width) for y in (low, low + width)]
            for a, b in ((0, 1), (1, 3), (3, 2), (2, 0)):
                triangles += [(outer[a], outer[b], inner[b]), (outer[a], inner[b], inner[a])]
            mesh = write_obj(self.dir / "hole.obj", (vertices, triangles))
            for k, longest in ((2, step), (0, 3**0.5 * step)):
                grid = ("--voxel-size", step, "--separability", k, "--origin", "0,0,0", "--set", "enclosed")
                cavities = [
                    self.voxelize(mesh, *grid, "--close", close)["certificate"]["walk"]["cavities"]
                    for close in (0, width + longest)
                ]
                self.assertEqual(cavities, [0, 1], (low, k))

    def test_a_point_outside_of_the_mesh_is_no_leak(self):
        cube = write_obj(self.dir / "cube.obj", box((0, 0, 0), (1, 1, 1)))
        ball = write_obj(self.dir / "ball.obj", octahedron())
        for mesh, point, text in (
            (cube, "5,5,5", "no leak: lattice point 59,59,59 lies outside of the mesh's box"),
            (ball, "0.9,0.9,0.9", "the mesh is closed, so the point lies outside of it"),
        ):
            done = latvox("voxelize", mesh, "--resolution", 12, "--set", "enclosed", "--leak-from", point, "-o", self.dir / "a.csv")
            self.assertIn(text, done.stdout)
        done = latvox("voxelize", cube, "--resolution", 12, "--set", "region", "--seed", "5,5,5", "-o", self.dir / "b.csv")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, "the nearest lattice point, .*, lies outside of the mesh's box")
        self.assertNotIn("opening", done.stderr)

    def test_the_fluid_around_a_car_is_not_in_its_cabin(self):
        fluid = ("--set", "region", "--seed", TUNNEL)
        open_car = self.voxelize(self.car, self.tunnel, *self.grid, *fluid, out="open.npy")
        closed = self.voxelize(self.car, self.tunnel, *self.grid, *fluid, "--close", "0.15", out="closed.npy")
        cabin = 1.0 * 1.6 * 0.4 / 0.05**3
        self.assertGreater(open_car["voxels"] - closed["voxels"], cabin)
        self.assertEqual(closed["certificate"]["set"], "region")
        self.assertFalse(closed["certificate"]["tunnel_free"])

    def test_bad_requests_name_what_is_wrong(self):
        for options, status, message in (
            (("--set", "region"), 2, "--set: region needs --seed X,Y,Z"),
            (("--set", "solid", "--seed", "0,0,0"), 2, "--seed: needs --set region, not solid"),
            (("--close", "1"), 2, "--close: needs --set enclosed, enclosed-interior or region, not surface"),
            (("--set", "region", "--seed", CABIN), 3, "through an opening around"),
            (("--set", "region", "--seed", CABIN), 3, "; --close may close it, and --allow-outside allows it"),
            (("--set", "region", "--seed", "2.025,0.025,0.725"), 3, "--seed: the nearest lattice point"),
            (("--set", "enclosed", "--close", "99"), 3, "--close 99: of half of it, a width of 49.5 reaches over"),
        ):
            with self.subTest(options):
                done = latvox("voxelize", self.car, *self.grid, *options, "-o", self.dir / "bad.csv")
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(message, done.stderr)

    def test_parts_and_batches_are_those_of_the_whole(self):
        whole = self.voxelize(self.car, *self.grid, "--set", "enclosed-interior", "--close", "0.15")
        voxels = set(rows(self.dir / "out.csv"))
        self.assertEqual(whole["certificate"]["set"], "enclosed-interior")
        parts = set()
        for shard in ("0/2", "1/2"):
            self.voxelize(self.car, *self.grid, "--set", "enclosed-interior", "--close", "0.15", "--shard", shard, out="part.csv")
            parts |= set(rows(self.dir / "part.csv"))
        self.assertEqual(parts, voxels)
        job = {"mesh": str(self.car), "voxel_size": 0.05, "set": "enclosed-interior", "close": 0.15, "out": "job.csv"}
        (self.dir / "jobs.jsonl").write_text(json.dumps(job) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "done")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(set(rows(self.dir / "done" / "job.csv")), voxels)

    def test_a_vdb_tells_what_was_asked(self):
        self.voxelize(self.car, *self.grid, "--set", "region", "--seed", "2,0.9,0.7", out="body.vdb")
        info = json.loads(latvox("info", self.dir / "body.vdb", "--json").stdout)
        self.assertIn('"seed":[2.0,0.9,0.7]', json.dumps(info).replace("\\", "").replace(" ", ""))

    def test_a_closed_box_is_its_solid(self):
        mesh = write_obj(self.dir / "box.obj", box((0, 0, 0), (1, 1, 1)))
        solid = self.voxelize(mesh, "--voxel-size", "0.1", "--set", "solid")
        enclosed = self.voxelize(mesh, "--voxel-size", "0.1", "--set", "enclosed")
        self.assertEqual(enclosed["digest"], solid["digest"])
        self.assertEqual(enclosed["placement"], "cells")


if __name__ == "__main__":
    unittest.main()
