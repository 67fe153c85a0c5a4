"""`--set solid` with the real tool: counts, refusals, the content of files, and parts that make the whole."""

import csv
import json
import math
import unittest

from harness import Case, box, latvox, octahedron, rows, write_obj
from inputs import joined, mesh_xml, model, write_3mf

LATTICES = ("cartesian", "bcc", "fcc", "hexagonal")


def torus(rings=48, segments=24, radius=3.0, tube=1.0):
    """Returns a mesh of quads cut in two: closed, oriented outwards, not convex."""
    vertices, triangles = [], []
    for r in range(rings):
        for s in range(segments):
            u, v = 2 * math.pi * r / rings, 2 * math.pi * s / segments
            ring = radius + tube * math.cos(v)
            vertices.append((ring * math.cos(u), ring * math.sin(u), tube * math.sin(v)))
            a, b = r * segments + s, (r + 1) % rings * segments + s
            c, d = (r + 1) % rings * segments + (s + 1) % segments, r * segments + (s + 1) % segments
            triangles += [(a, b, c), (a, c, d)]
    return vertices, triangles


def volume(mesh):
    vertices, triangles = mesh

    def determinant(a, b, c):
        return (
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        )

    return abs(sum(determinant(*(vertices[n] for n in t)) for t in triangles)) / 6


class Solids(Case):
    def setUp(self):
        super().setUp()
        self.torus = write_obj(self.dir / "torus.obj", torus())
        vertices, triangles = octahedron()
        self.open = write_obj(self.dir / "open.obj", (vertices, triangles[1:]))

    def test_a_solid_has_its_meshs_volume_on_every_lattice(self):
        for lattice in LATTICES:
            grid = ("--lattice", lattice, "--voxel-size", "0.1")
            surface = self.voxelize(self.torus, *grid, "--placement", "cells")
            self.assertEqual(surface["certificate"]["set"], "surface")
            on_surface = set(rows(self.dir / "out.csv"))
            solid = self.voxelize(self.torus, *grid, "--set", "solid", out="solid.csv")
            inside = self.voxelize(self.torus, *grid, "--set", "interior", out="inside.csv")
            inner = set(rows(self.dir / "inside.csv"))
            with self.subTest(lattice):
                # The number of points inside follows from the volume. The voxels of the surface may count or not; in a
                # mesh as round as this one, their effect nearly cancels.
                expected = volume(torus()) / 0.1**3
                self.assertLess(abs(inside["voxels"] - expected), 0.05 * surface["voxels"])
                self.assertEqual(set(rows(self.dir / "solid.csv")), inner | on_surface)
                self.assertEqual(solid["voxels"], len(inner | on_surface))
                self.assertTrue(solid["certificate"]["tunnel_free"])
                self.assertFalse(inside["certificate"]["tunnel_free"])

    def test_a_mesh_that_is_not_closed_is_refused_unless_forced(self):
        options = ("--resolution", "33", "--set", "interior")
        out = self.dir / "out.csv"
        done = latvox("voxelize", self.open, "-o", out, *options)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, r"mesh: it is not closed, and \d+ lattice lines along k end unbalanced")
        self.assertFalse(out.exists())
        forced = self.voxelize(self.open, *options, "--force-open")
        columns = {(i, j) for i, j, _ in rows(out)}
        closed = self.voxelize(write_obj(self.dir / "closed.obj", octahedron()), *options, out="closed.csv")
        whole = {(i, j) for i, j, _ in rows(self.dir / "closed.csv")}
        self.assertEqual(closed["certificate"]["unbalanced_lines"], 0)
        self.assertEqual(forced["certificate"]["unbalanced_lines"], len(whole - columns))
        self.assertGreater(len(whole - columns), 100)
        self.assertEqual(
            {v for v in rows(self.dir / "closed.csv") if v[:2] in columns}, set(rows(out)), "other lines changed"
        )

    def test_options_that_exclude_each_other_are_wrong_usage(self):
        for words, says in (
            (("--verify", "--set", "solid"), "--verify: not together with --set solid"),
            (("--set", "solid", "--algorithm", "incremental"), "--set solid: not together with --algorithm incremental"),
            (("--rule", "winding"), "--rule: needs --set solid"),
            (("--force-open",), "--set solid"),
        ):
            done = latvox("voxelize", self.torus, "-o", self.dir / "out.csv", "--resolution", "20", *words)
            self.assertEqual(done.returncode, 2, words)
            self.assertIn(says, done.stderr)

    def test_files_say_how_they_were_filled_and_parts_make_the_whole(self):
        options = ("--lattice", "bcc", "--resolution", "200", "--set", "solid", "--rule", "winding")
        whole = self.voxelize(self.torus, *options, out="whole.vdb")
        info = latvox("info", self.dir / "whole.vdb")
        for line in ("latvox_set", "latvox_interior_rule", "latvox_unbalanced_lines"):
            self.assertIn(line, info.stdout)
        parts = []
        for index in range(2):
            self.voxelize(self.torus, *options, "--shard", f"{index}/2", out=f"part{index}.vdb")
            parts.append(self.dir / f"part{index}.vdb")
        done = latvox("merge", *parts, "-o", self.dir / "merged.vdb", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["digest"], whole["digest"])
        hollow = (*options[:4], "--placement", "cells", "--shard", "1/2")
        self.voxelize(self.torus, *hollow, out="part1.vdb")
        done = latvox("merge", *parts, "-o", self.dir / "merged.vdb")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("latvox_", done.stderr)

    def test_bodies_that_overlap_are_united_and_a_cavity_stays_hollow(self):
        low, high = box((0, 0, 0), (10, 10, 10)), box((5, 0, 0), (15, 10, 10))
        inner = box((3, 3, 3), (7, 7, 7))
        cavity = (inner[0], [(a, c, b) for a, b, c in inner[1]])
        turned = (high[0], [(a, c, b) for a, b, c in high[1][:1]] + high[1][1:])
        solid = ("--voxel-size", "0.5", "--set", "interior")
        for bodies, rule, voxels in (
            ((low, high), "winding", 24000 // 2),
            ((low, cavity), "winding", 8000 - 512),
            ((low, turned), "parity", 8000),
        ):
            mesh = write_obj(self.dir / "m.obj", joined(*bodies))
            whole = self.voxelize(mesh, *solid, out="whole.vdb")
            self.assertEqual((whole["voxels"], whole["certificate"]["rule"]), (voxels, rule))
            self.assertEqual(whole["placement"], "cells")
            explicit = self.voxelize(mesh, *solid, "--rule", rule, "--placement", "cells")
            self.assertEqual(explicit["digest"], whole["digest"])
            parts = []
            for name, part in (("a", "--region=-99,-99,-99,9,99,99"), ("b", "--region=9,-99,-99,99,99,99")):
                done = self.voxelize(mesh, *solid, part, out=f"{name}.vdb")
                self.assertEqual(done["certificate"]["rule"], rule)
                parts.append(self.dir / f"{name}.vdb")
            self.assertEqual(self.merged(parts), whole["digest"])
            parts = []
            for index in range(3):
                self.voxelize(mesh, *solid, "--shard", f"{index}/3", out=f"{index}.vdb")
                parts.append(self.dir / f"{index}.vdb")
            self.assertEqual(self.merged(parts), whole["digest"])

    def merged(self, parts):
        done = latvox("merge", *parts, "-o", self.dir / "merged.vdb", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["digest"]

    def test_3mf_unites_its_items_by_the_positive_rule(self):
        low, high = box((0, 0, 0), (10, 10, 10)), box((5, 0, 0), (15, 10, 10))
        resources = "".join(f'<object id="{n}">{mesh_xml(mesh)}</object>' for n, mesh in ((1, low), (2, high)))
        mesh = write_3mf(self.dir / "m.3mf", model(resources, '<item objectid="1"/><item objectid="2"/>'))
        solid = ("--voxel-size", "0.5", "--set", "interior")
        united = self.voxelize(mesh, *solid)
        self.assertEqual((united["voxels"], united["certificate"]["rule"]), (12000, "positive"))
        self.assertEqual(self.voxelize(mesh, *solid, "--rule", "parity")["voxels"], 8000)

    def test_other_sets_have_the_inside_of_the_solid_where_bodies_overlap(self):
        mesh = write_obj(self.dir / "m.obj", joined(box((0, 0, 0), (10, 10, 10)), box((5, 0, 0), (15, 10, 10))))
        grid = ("--voxel-size", "1", "--placement", "cells")
        whole = self.voxelize(mesh, *grid, "--set", "interior")["voxels"]
        self.assertEqual(whole, 1500)
        fields = ("--fields", "distance,fraction:2", "--signed")
        for points in (("--band", "6v"), ("--set", "enclosed")):
            for rule, inside in {"auto": whole, "winding": whole, "positive": whole, "parity": 1000}.items():
                with self.subTest(points, rule=rule):
                    summary = self.voxelize(mesh, *grid, *points, *fields, "--rule", rule, out="a.csv")
                    self.assertEqual(summary["certificate"]["rule"], "winding" if rule == "auto" else rule)
                    with open(self.dir / "a.csv") as file:
                        carried = list(csv.DictReader(file))
                    self.assertEqual(sum(float(row["distance"]) < 0 for row in carried), inside)
                    self.assertEqual(sum(int(row["fraction"]) for row in carried), 8 * inside)
        outside = self.voxelize(mesh, *grid, "--set", "links", "--side", "outside")
        parity = self.voxelize(mesh, *grid, "--set", "links", "--side", "outside", "--rule", "parity")
        self.assertLess(outside["voxels"], parity["voxels"])
        self.voxelize(mesh, *grid, "--band", "2v", "--signed", "--rule", "positive", out="a.vdb")
        self.assertIn("latvox_interior_rule = positive\n", latvox("info", self.dir / "a.vdb").stdout)

    def test_cells_keep_a_plate_that_points_lose(self):
        plate = write_obj(self.dir / "plate.obj", box((0, 0, 0), (96, 0.8, 96)))
        solid = ("--resolution", "96", "--set", "interior")
        cells = self.voxelize(plate, *solid)
        self.assertEqual((cells["voxels"], cells["placement"], cells["voxel_size"]), (96 * 96, "cells", 1))
        self.assertEqual(cells["origin"], [0.5, 0.5, 0.5])
        self.assertEqual(self.voxelize(plate, *solid, "--origin", "0.5,0.5,0.5")["digest"], cells["digest"])
        self.assertEqual(self.voxelize(plate, *solid, "--region=0,0,0,96,1,96")["digest"], cells["digest"])
        self.voxelize(plate, *solid, out="a.vdb")
        self.assertIn('"placement":"cells"', latvox("info", self.dir / "a.vdb").stdout)
        points = self.voxelize(plate, *solid, "--placement", "points")
        self.assertEqual((points["placement"], points["origin"]), ("points", [0, 0, 0]))
        self.assertAlmostEqual(points["voxel_size"], 96 / 95)
        self.assertEqual(self.voxelize(plate, "--resolution", "96")["placement"], "points")
        self.assertEqual(self.voxelize(plate, "--resolution", "96", "--placement", "cells")["placement"], "cells")
        done = latvox("voxelize", plate, *solid, "-o", self.dir / "a.csv")
        self.assertIn("voxel size 1, interior, placement cells\n", done.stdout)

    def test_jobs_of_a_batch_take_the_same_words(self):
        job = {"mesh": str(self.torus), "resolution": 30, "out": "a.csv"}
        fill = {"set": "interior", "rule": "winding", "force_open": True}
        lines = [job | fill, {"mesh": str(self.open), "resolution": 30, "out": "b.csv", "set": "solid"}]
        jobs = self.dir / "jobs.jsonl"
        jobs.write_text("".join(json.dumps(line) + "\n" for line in lines))
        done = latvox("batch", jobs, "--out", self.dir / "out")
        self.assertEqual(done.returncode, 3, done.stderr)
        alone = self.voxelize(
            self.torus, "--resolution", 30, "--set", "interior", "--rule", "winding"
        )
        self.assertEqual(len(rows(self.dir / "out" / "a.csv")), alone["voxels"])
        self.assertFalse((self.dir / "out" / "b.csv").exists())


if __name__ == "__main__":
    unittest.main()
