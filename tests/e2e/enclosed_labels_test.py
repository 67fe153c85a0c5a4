"""`--set enclosed --labels` with the real tool: open bodies that overlap, shards that are joined, batches, leaks."""

import csv
import json
import unittest

from harness import Case, latvox
from labels_test import BODIES, faces

GRID = ("--voxel-size", "1", "--origin", "0.45,0.52,0.56")
LABELS = ("--set", "enclosed-interior", "--labels", "part")


def write_open_boxes(path, size):
    """Writes the bodies with a slit of a third of a voxel in one side of each, that no step fits through."""
    lines = []
    for n, (name, (low, high)) in enumerate(BODIES.items()):
        corners = [[size * (low, high)[c >> a & 1][a] for a in range(3)] for c in range(8)]
        middle = [list(corner) for corner in corners[:4]]  # the lower side in z, without a strip along x
        lines.append(f"o {name}")
        for c in (2, 3):
            middle[c][1] -= 0.3
        lines += ["v " + " ".join(map(str, v)) for v in corners + middle]
        triangles = [t for t in faces() if not set(t) <= {0, 1, 2, 3}] + [(8, 10, 11), (8, 11, 9)]
        lines += ["f " + " ".join(str(v + 1 + 12 * n) for v in t) for t in triangles]
    path.write_text("\n".join(lines) + "\n")
    return path


class EnclosedLabels(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_open_boxes(self.dir / "open.obj", 3)

    def read(self, name):
        with (self.dir / name).open() as file:
            return {tuple(int(row[a]) for a in "ijk"): row["part_name"] for row in csv.DictReader(file)}

    def parts(self, *options, out="labels.csv"):
        self.voxelize(self.mesh, *GRID, *LABELS, *options, out=out)
        return self.read(out)

    def alone(self, name):
        """The enclosed set of one body, from a file with its triangles alone."""
        lines = self.mesh.read_text().splitlines()
        first = lines.index(f"o {name}")
        count = len(lines) // len(BODIES)
        skipped = 12 * list(BODIES).index(name)
        kept = [f"f {' '.join(str(int(v) - skipped) for v in line.split()[1:])}" if line[0] == "f" else line
                for line in lines[first : first + count]]  # fmt: skip
        (self.dir / "alone.obj").write_text("\n".join(kept) + "\n")
        self.voxelize(self.dir / "alone.obj", *GRID, "--set", "enclosed-interior", out="alone.csv")
        with (self.dir / "alone.csv").open() as file:
            return {tuple(int(row[a]) for a in "ijk") for row in csv.DictReader(file)}

    def test_each_label_has_the_set_of_its_triangles_alone(self):
        for options, order in (((), ["base", "lid", "pin"]), (("--priority", "base,pin"), ["lid", "pin", "base"])):
            expected = {}
            for name in order:
                expected |= dict.fromkeys(self.alone(name), name)
            self.assertGreater(len(expected), 500)
            self.assertEqual(self.parts(*options), expected)

    def test_joined_shards_and_batches_are_the_whole(self):
        self.mesh = write_open_boxes(self.dir / "open.obj", 12)
        whole = self.voxelize(self.mesh, *GRID, *LABELS, "--priority", "lid", out="whole.vdb")
        parts = []
        for n in range(3):
            parts.append(self.dir / f"{n}.vdb")
            self.voxelize(self.mesh, *GRID, *LABELS, "--priority", "lid", "--shard", f"{n}/3", out=f"{n}.vdb")
        done = latvox("merge", *parts, "-o", self.dir / "joined.vdb")
        self.assertEqual(done.returncode, 0, done.stderr)
        same = latvox("compare", self.dir / "joined.vdb", self.dir / "whole.vdb")
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        line = {"mesh": str(self.mesh), "voxel_size": 1, "origin": [0.45, 0.52, 0.56], "set": "enclosed-interior",
                "labels": "part", "priority": ["lid"], "out": "batch.vdb"}  # fmt: skip
        (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        same = latvox("compare", self.dir / "batch.vdb", self.dir / "whole.vdb")
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        self.assertGreater(whole["voxels"], 500 * 12**3)

    def test_a_leaking_label_is_named(self):
        lines = self.mesh.read_text().splitlines()
        lines = [line for n, line in enumerate(lines) if not (line[0] == "f" and n >= len(lines) - 4)]  # two sides of pin
        self.mesh.write_text("\n".join(lines) + "\n")
        report = self.voxelize(self.mesh, *GRID, *LABELS, "--leak-from", "24,9,9")
        self.assertIn("LABEL_ENCLOSES_NOTHING", [warning["code"] for warning in report["warnings"]])
        labels = {of["label"]: of for of in report["certificate"]["walk"]["labels"]}
        self.assertEqual(sorted(labels), [0, 1, 2])
        self.assertEqual(labels[2]["cavities"], 0)
        cell = report["voxel_size"] ** 3
        self.assertEqual([round(of["volume"] / cell) for of in labels.values()], [of["points"] for of in labels.values()])
        self.assertEqual(labels[2]["leak"]["kind"], "leak")
        self.assertEqual(labels[0]["leak"]["kind"], "enclosed")

    def test_a_point_in_no_label_s_box_is_told(self):
        for point, told in (("-500,9,9", True), ("1234567.5,9,9", True), ("9,9,9", False)):
            done = latvox("voxelize", self.mesh, *GRID, *LABELS, f"--leak-from={point}", "-o", self.dir / "a.csv")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(f"no leak: {point} lies in no label's box\n" in done.stdout, told, done.stdout)

    def test_of_nine_leaks_the_last_is_not_searched(self):
        lines, triangles = [], [t for t in faces() if not set(t) <= {0, 1, 2, 3}]  # open below
        for n in range(9):
            corners = [[(10 + n) * (1 if c >> a & 1 else -1) for a in range(3)] for c in range(8)]
            lines += [f"o box{n}", *("v " + " ".join(map(str, v)) for v in corners)]
            lines += ["f " + " ".join(str(v + 1 + 8 * n) for v in t) for t in triangles]
        self.mesh.write_text("\n".join(lines) + "\n")
        report = self.voxelize(self.mesh, *GRID, *LABELS, "--priority", "box3", "--leak-from", "0,0,0")
        labels = report["certificate"]["walk"]["labels"]
        self.assertEqual(len(labels), 9)
        self.assertEqual({of["label"] for of in labels if "leak" not in of}, {0}, "that of the lowest priority")
        self.assertEqual({of["leak"]["kind"] for of in labels if "leak" in of}, {"leak"})

    def test_other_sets_refuse_labels(self):
        done = latvox("voxelize", self.mesh, *GRID, "--labels", "part", "-o", self.dir / "a.csv")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--labels: needs --set solid, supercover-solid, interior, enclosed or enclosed-interior", done.stderr)


if __name__ == "__main__":
    unittest.main()
