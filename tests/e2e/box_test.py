"""Boxes of cubes (.binvox, .vox) hold the voxels of the .csv, in their places."""

import struct
import unittest

from harness import BUNNY, Case, latvox, rows


def read_binvox(path):
    """Returns the world position of each voxel's center."""
    head, _, data = path.read_bytes().partition(b"\ndata\n")
    lines = dict(line.split(" ", 1) for line in head.decode().splitlines())
    assert lines["#binvox"] == "1"
    depth, height, width = map(int, lines["dim"].split())
    translate, scale = tuple(map(float, lines["translate"].split())), float(lines["scale"])
    cells = []
    at = 0
    for value, count in struct.iter_unpack("BB", data):
        assert value in (0, 1) and count > 0
        if value:
            cells += range(at, at + count)
        at += count
    assert at == depth * height * width
    positions = []
    for cell in cells:
        x, z, y = cell // (width * height), cell // width % height, cell % width
        positions.append(tuple((n + 0.5) / depth * scale + t for n, t in zip((x, y, z), translate)))
    return positions


def read_vox(path):
    data = path.read_bytes()
    assert struct.unpack_from("<4sI4sII", data) == (b"VOX ", 150, b"MAIN", 0, len(data) - 20)
    assert struct.unpack_from("<4sII", data, 20) == (b"SIZE", 12, 0)
    size = struct.unpack_from("<3I", data, 32)
    kind, length, _, count = struct.unpack_from("<4s3I", data, 44)
    assert (kind, length, len(data)) == (b"XYZI", 4 + 4 * count, 60 + 4 * count)
    return size, {voxel[:3] for voxel in struct.iter_unpack("4B", data[60:])}


class Boxes(Case):
    def outputs(self, *options):
        files = [word for name in ("a.csv", "a.binvox", "a.vox") for word in ("-o", self.dir / name)]
        done = latvox("voxelize", BUNNY, *files, "--lattice", "cartesian", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return rows(self.dir / "a.csv")

    def test_both_hold_the_voxels(self):
        for options in (["--resolution", 90], ["--voxel-size", "0.05", "--origin", "7,-3,100"]):
            with self.subTest(options):
                voxels = self.outputs(*options)
                found = read_binvox(self.dir / "a.binvox")
                self.assertEqual(len(found), len(voxels))
                # Lattice coordinates and positions give the same order, because both rise together.
                expected = [voxels[ijk] for ijk in sorted(voxels, key=lambda v: (v[0], v[2], v[1]))]
                for position, wanted in zip(found, expected):
                    for x, y in zip(position, wanted):
                        self.assertAlmostEqual(x, y, places=9)
                low = [min(v[m] for v in voxels) for m in range(3)]
                high = [max(v[m] for v in voxels) for m in range(3)]
                size, cells = read_vox(self.dir / "a.vox")
                self.assertEqual(size, tuple(h - l + 1 for l, h in zip(low, high)))
                self.assertEqual(cells, {tuple(x - l for x, l in zip(v, low)) for v in voxels})

    def test_long_runs_and_no_voxel(self):
        self.assertEqual(self.outputs("--resolution", 20, "--region", "1000,0,0,1001,1,1"), {})
        self.assertEqual(read_binvox(self.dir / "a.binvox"), [])
        self.assertEqual(read_vox(self.dir / "a.vox"), ((1, 1, 1), set()))

    def test_voxels_that_do_not_fit_are_refused_and_leave_no_file(self):
        for out, options, code, says in (
            ("a.binvox", ["--lattice", "bcc", "--resolution", 20], 2, "cubes along the axes"),
            ("a.vox", ["--basis", "0.1,0,0,0,0.1,0,0,0,0.2"], 2, "cubes along the axes"),
            ("a.binvox", ["--lattice", "cartesian", "--resolution", 20, "--pad", 2100], 5,
             "42[0-9]{2} voxels along [xyz] exceed the format's 4096; .vdb, .h5 and .vtu hold any number of voxels"),
        ):  # fmt: skip
            with self.subTest(options):
                done = latvox("voxelize", BUNNY, "-o", self.dir / out, *options)
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertRegex(done.stderr, f"{out}: .*{says}")
                self.assertEqual(list(self.dir.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
