"""--set supercover: every voxel whose cell meets the mesh. The real tool is compared with counts by hand and with
separating axes in Python's integers."""

import json
import unittest

from harness import BUNNY, Case, latvox, octahedron, read_obj, rows, write_obj

UNIT = 256  # lattice units a voxel
SIZE = 1 / 32  # a power of two, so Python finds the bunny's rounded vertices, too


def meets(corners, voxel):
    """Returns whether the closed cube around a voxel meets the closed triangle, by separating axes in lattice units."""
    v = [[x - UNIT * c for x, c in zip(corner, voxel)] for corner in corners]
    edges = [[b - a for a, b in zip(v[n], v[(n + 1) % 3])] for n in range(3)]
    units = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    axes = units + [cross(edges[0], edges[1])] + [cross(e, u) for e in edges for u in units]
    for axis in axes:
        reach = UNIT // 2 * sum(map(abs, axis))
        at = [sum(a * x for a, x in zip(axis, corner)) for corner in v]
        if min(at) > reach or max(at) < -reach:
            return False
    return True


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def supercover(mesh, low, high):
    """Returns the supercover's voxels with low <= ijk < high."""
    vertices, triangles = mesh
    snapped = [[round(x / SIZE * UNIT) for x in v] for v in vertices]
    found = set()
    for triangle in triangles:
        corners = [snapped[n] for n in triangle]
        spans = []
        for axis in range(3):
            at = [corner[axis] for corner in corners]
            first, last = -((UNIT // 2 - min(at)) // UNIT), (max(at) + UNIT // 2) // UNIT
            spans.append(range(max(first, low[axis]), min(last + 1, high[axis])))
        found |= {(i, j, k) for i in spans[0] for j in spans[1] for k in spans[2] if meets(corners, (i, j, k))}
    return found


class Supercover(Case):
    def test_a_triangle_between_two_layers_of_cells_touches_both(self):
        corners = [(0.5, 0.5, 0.5), (2.5, 0.5, 0.5), (0.5, 2.5, 0.5)]
        mesh = write_obj(self.dir / "triangle.obj", (corners, [(0, 1, 2)]))
        options = ["--voxel-size", 1, "--origin", "0,0,0", "--quantization", 0]
        self.voxelize(mesh, *options, "--set", "supercover")
        # There are 4 x 4 columns; those beyond the middle of the hypotenuse do not meet the triangle.
        columns = {(i, j) for i in range(4) for j in range(4)} - {(2, 3), (3, 2), (3, 3)}
        self.assertEqual(set(rows(self.dir / "out.csv")), {(i, j, k) for i, j in columns for k in (0, 1)})

    def test_the_bunny_has_the_voxels_that_integers_of_python_find(self):
        low, high = (-8, -6, -4), (10, 12, 14)
        options = ["--voxel-size", SIZE, "--origin", "0,0,0", "--quantization", 0, "--set", "supercover"]
        region = ",".join(map(str, low + high))
        self.voxelize(BUNNY, *options, "--region", region)
        expected = supercover(read_obj(BUNNY), low, high)
        self.assertGreater(len(expected), 300)
        self.assertEqual(set(rows(self.dir / "out.csv")), expected)

    def test_it_has_no_tunnel_for_any_k_and_says_what_it_is(self):
        digests = set()
        for k in (0, 1, 2):
            options = ["--lattice", "fcc", "--resolution", 64, "--set", "supercover", "--separability", k]
            summary = self.voxelize(BUNNY, *options, "--verify", out="out.vdb")
            certificate = summary["certificate"]
            self.assertEqual((certificate["set"], certificate["minimal"]), ("supercover", False))
            self.assertEqual((certificate["tunnels"], certificate["tunnel_free"]), (0, True))
            self.assertGreater(certificate["redundant"], 0)
            digests.add(summary["digest"])
        self.assertEqual(len(digests), 1)
        self.assertIn("latvox_set", latvox("info", self.dir / "out.vdb").stdout)
        separating = self.voxelize(BUNNY, "--resolution", 64)
        self.assertEqual(separating["certificate"]["set"], "surface")

    def test_shards_merge_to_the_whole_but_not_with_another_set(self):
        options = ["--lattice", "bcc", "--resolution", 80]
        whole = self.voxelize(BUNNY, *options, "--set", "supercover", out="whole.vdb")
        for n in (0, 1):
            self.voxelize(BUNNY, *options, "--set", "supercover", "--shard", f"{n}/2", out=f"part{n}.vdb")
        merge = ["merge", self.dir / "part0.vdb", "-o", self.dir / "merged.vdb", "--json"]
        merged = latvox(*merge, self.dir / "part1.vdb")
        self.assertEqual(json.loads(merged.stdout)["digest"], whole["digest"], merged.stderr)
        self.voxelize(BUNNY, *options, "--no-minimal", "--shard", "1/2", out="other.vdb")
        refused = latvox(*merge, self.dir / "other.vdb")
        self.assertEqual(refused.returncode, 3)
        self.assertIn("latvox_set is surface, but supercover", refused.stderr)

    def test_a_job_line_asks_for_it(self):
        write_obj(self.dir / "octahedron.obj", octahedron())
        alone = self.voxelize(self.dir / "octahedron.obj", "--resolution", 20, "--set", "supercover")
        jobs = self.dir / "jobs.jsonl"
        jobs.write_text(json.dumps({"mesh": "octahedron.obj", "resolution": 20, "set": "supercover"}) + "\n")
        done = latvox("batch", jobs, "--out", self.dir / "voxels")
        self.assertEqual(done.returncode, 0, done.stderr)
        line = json.loads((self.dir / "voxels" / "results.jsonl").read_text())
        self.assertEqual(line["summary"]["digest"], alone["digest"])
        self.assertEqual(line["summary"]["certificate"]["set"], "supercover")

    def test_contradicting_options_are_refused(self):
        for option, value in (("--minimal", None), ("--algorithm", "incremental")):
            words = ["--resolution", 20, "--set", "supercover", option, *([value] if value else [])]
            done = latvox("voxelize", BUNNY, "-o", self.dir / "out.vdb", *words)
            self.assertEqual(done.returncode, 2)
            self.assertIn(option.removeprefix("--"), done.stderr)
            self.assertIn("supercover", done.stderr)
        flat = "1,0.3,0,0.2,1.1,0,0.3,0.4,7000"
        done = latvox("voxelize", BUNNY, "-o", self.dir / "out.vdb", "--basis", flat, "--set", "supercover")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("basis: so flat or long", done.stderr)


if __name__ == "__main__":
    unittest.main()
