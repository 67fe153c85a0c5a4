"""The field fraction: formats, sets, parts and refusals."""

import json
import unittest

import numpy

from harness import BUNNY, Case, box, latvox, write_obj

GRID = ["--voxel-size", "1", "--origin", "0,0,0"]


class Fraction(Case):
    def brick(self):
        """Writes a box with faces on quarters of voxels: 5.25 x 4.5 x 3.75 voxels."""
        return write_obj(self.dir / "brick.obj", box((0.25, 0.25, 0.25), (5.5, 4.75, 4)))

    def test_of_a_box_is_its_volume_in_every_format(self):
        options = [*GRID, "--set", "supercover-solid", "--fields", "fraction:4"]
        others = [word for name in ("a.npy", "a.npz", "a.ply", "a.vdb") for word in ("-o", self.dir / name)]
        summary = self.voxelize(self.brick(), *options, *others)
        self.assertEqual(summary["fields"]["fraction"]["n"], 4)
        header = (self.dir / "out.csv").read_text().splitlines()[0]
        self.assertEqual(header, "i,j,k,x,y,z,fraction")
        table = numpy.genfromtxt(self.dir / "out.csv", delimiter=",", skip_header=1)
        self.assertEqual(table[:, 6].sum(), 21 * 18 * 15)
        self.assertEqual(table[:, 6].max(), 64)
        npy = numpy.load(self.dir / "a.npy")
        self.assertEqual(npy["fraction"].dtype, numpy.uint16)
        numpy.testing.assert_array_equal(npy["fraction"], table[:, 6])
        with numpy.load(self.dir / "a.npz") as arrays:
            dense = arrays["fraction"]
            self.assertEqual((dense.dtype, dense.sum()), (numpy.uint16, 21 * 18 * 15))
            numpy.testing.assert_array_equal(dense[arrays["data"] != 0], npy["fraction"])
        self.assertIn(b"property ushort fraction\n", (self.dir / "a.ply").read_bytes())
        info = latvox("info", self.dir / "a.vdb").stdout
        self.assertRegex(info, r"latvox_fraction_n\W+4")
        self.assertIn("fraction:4", info)

    def test_parts_and_encodings_are_as_the_whole(self):
        options = ["--resolution", "40", "--lattice", "bcc", "--set", "solid", "--fields", "fraction:3"]
        whole, *others = (self.voxelize(BUNNY, *options, "--encoding", e, out="whole.csv") for e in
                          ("packed", "masks", "packed-zstd"))  # fmt: skip
        for other in others:
            self.assertEqual(other["fields"], whole["fields"])
        parts = set()
        for part in ("0/2", "1/2"):
            self.voxelize(BUNNY, *options, "--shard", part)
            parts |= set((self.dir / "out.csv").read_text().splitlines()[1:])
        self.assertEqual(parts, set((self.dir / "whole.csv").read_text().splitlines()[1:]))
        self.assertGreater(len(parts), 5000)
        line = {"mesh": str(BUNNY), "out": "b.csv", "resolution": 40, "lattice": "bcc", "set": "solid",
                "fields": ["fraction:3"]}  # fmt: skip
        (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.dir / "out/results.jsonl").read_text())
        self.assertEqual(result["summary"]["fields"], whole["fields"])

    def test_what_does_not_fit_is_refused(self):
        needs = "fraction needs a number of points along each axis, such as fraction:8"
        for fields, more, status, says in (
            ("fraction", [], 2, needs),
            ("fraction:x", [], 2, needs),
            ("fraction:1", [], 2, '--fields: "fraction:1": 1 is not a whole number from 2 to 16'),
            ("fraction:17", [], 2, '--fields: "fraction:17": 17 is not a whole number from 2 to 16'),
            ("fraction:2,fraction:2", [], 2, '"fraction" is given twice'),
            ("fraction:2,fraction:4", [], 2, '--fields: "fraction" is given twice'),
            ("fraction:2,label_fractions:4", [], 2, "need the same number of points, not 2 and 4"),
            ("fraction:2", ["-o", "a.vox"], 2, "--fields: a.vox cannot hold fraction"),
            ("fraction:2,part", ["-o", "a.vox"], 2, "--fields: a.vox cannot hold fraction,part"),
            ("fraction:2", ["-o", "a.binvox"], 2, "--fields: a.binvox cannot hold fraction"),
            ("fraction:2", ["--set", "solid", "--force-open"], 2,
             "--fields fraction: not together with --force-open, which fills a mesh that is not closed"),
        ):  # fmt: skip
            with self.subTest(fields=fields, more=more):
                done = latvox("voxelize", self.brick(), *GRID, "--json", "-o", "a.csv", "--fields", fields, *more,
                              cwd=self.dir)  # fmt: skip
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(says, done.stderr.replace('\\"', '"'))
        open_mesh = write_obj(self.dir / "open.obj", ([(0, 0, 0), (9, 0, 0), (0, 9, 0)], [(0, 1, 2)]))
        done = latvox("voxelize", open_mesh, *GRID, "--json", "--fields", "fraction:2", "-o", self.dir / "a.csv")
        self.assertEqual((done.returncode, "a fraction asks for" in done.stderr), (3, True), done.stderr)


if __name__ == "__main__":
    unittest.main()
