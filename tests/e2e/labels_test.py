"""Labeled solids: the part of each voxel where bodies overlap, by priority, from every kind of call."""

import csv
import json
import unittest

from harness import Case, latvox

GRID = ["--voxel-size", "1", "--origin", "0.5,0.5,0.5", "--set", "interior"]
# Low and high corner of each body: the second overlaps the first, the third lies within both.
BODIES = {"base": ((0, 0, 0), (10, 10, 10)), "lid": ((6, 0, 0), (16, 10, 10)), "pin": ((7, 2, 2), (9, 4, 4))}


def faces():
    """The triangles of a box, by numbers of its corners in the order of z, y, x."""
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def write_boxes(path, left_out=0):
    """Writes the bodies as objects of a .obj. The last one lacks as many triangles."""
    lines = []
    for n, (name, corners) in enumerate(BODIES.items()):
        lines.append(f"o {name}")
        lines += [f"v {corners[c & 1][0]} {corners[c >> 1 & 1][1]} {corners[c >> 2][2]}" for c in range(8)]
        triangles = faces()[left_out:] if n + 1 == len(BODIES) else faces()
        lines += ["f " + " ".join(str(v + 1 + 8 * n) for v in t) for t in triangles]
    path.write_text("\n".join(lines) + "\n")
    return path


def expected(order):
    """The part of each lattice point; the first body of the order that contains it counts."""
    parts = {}
    for name in reversed(order):
        low, high = BODIES[name]
        for i in range(low[0], high[0]):
            parts |= {(i, j, k): name for j in range(low[1], high[1]) for k in range(low[2], high[2])}
    return parts


class Labels(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_boxes(self.dir / "boxes.obj")

    def parts(self, *options):
        self.voxelize(self.mesh, *GRID, *options, out="labels.csv")
        return self.read("labels.csv")

    def read(self, name):
        with (self.dir / name).open() as file:
            return {tuple(int(row[a]) for a in "ijk"): row["part_name"] for row in csv.DictReader(file)}

    def test_the_highest_priority_wins(self):
        self.assertEqual(self.parts("--labels", "part"), expected(["pin", "lid", "base"]))
        self.assertEqual(self.parts("--labels", "part", "--priority", "0"), expected(["base", "pin", "lid"]))
        self.assertEqual(self.parts("--fields", "part", "--priority", "lid,0"), expected(["lid", "base", "pin"]))

    def test_a_batch_and_parts_give_the_same(self):
        whole = self.parts("--labels", "part", "--priority", "lid,base")
        shards = [self.parts("--labels", "part", "--priority", "lid,base", "--shard", f"{n}/2") for n in range(2)]
        self.assertEqual(shards[0] | shards[1], whole)
        line = {"mesh": str(self.mesh), "voxel_size": 1, "origin": [0.5, 0.5, 0.5], "set": "interior", "labels": "part",
                "priority": ["lid", 0], "out": "batch.csv"}  # fmt: skip
        (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(self.read("batch.csv"), whole)

    def test_the_grid_tells_labels_and_priority(self):
        self.voxelize(self.mesh, *GRID, "--labels", "part", "--priority", "pin,1", out="labels.vdb")
        info = latvox("info", self.dir / "labels.vdb").stdout
        self.assertIn('"labels":"part"', info)
        self.assertIn('"priority":["pin","1"]', info)

    def test_an_open_label_is_named(self):
        write_boxes(self.mesh, left_out=2)
        done = latvox("voxelize", self.mesh, *GRID, "--labels", "part", "-o", self.dir / "a.csv")
        self.assertEqual(done.returncode, 3)
        self.assertIn("part 2 is not closed, and 4 of its lattice lines", done.stderr)
        forced = self.parts("--labels", "part", "--force-open")
        self.assertEqual(forced, expected(["lid", "base"]))

    def test_an_unknown_name_is_refused(self):
        done = latvox("voxelize", self.mesh, *GRID, "--labels", "part", "--priority", "nut", "-o", self.dir / "a.csv")
        self.assertEqual(done.returncode, 3)
        self.assertIn('--priority: "nut" is neither a number nor the name of a part', done.stderr)


if __name__ == "__main__":
    unittest.main()
