"""Bands of distances: compared with closed forms, with OpenVDB's meshToVolume, and with their own parts."""

import json
import math
import unittest

import numpy
import pyopenvdb

from harness import Case, float32, latvox, read_points, write_obj

SNAP = 1 / 512 + 2**-20  # how far snapping moves a vertex in a lattice coordinate, in voxels


def box(low, high):
    """Returns a closed box with twelve triangles that face outwards."""
    vertices = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def distances_to_box(points, low, high):
    """Returns the signed distance, in closed form."""
    beyond = numpy.maximum(low - points, points - high)
    return numpy.linalg.norm(numpy.maximum(beyond, 0), axis=1) + numpy.minimum(beyond.max(axis=1), 0)


def torus(around, across):
    vertices, triangles = [], []
    for i in range(around):
        for j in range(across):
            a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
            r = 3 + math.cos(b)
            vertices.append(tuple(map(float32, (r * math.cos(a), r * math.sin(a), math.sin(b)))))
            n, e = i * across + j, (i + 1) % around * across + j
            up = (j + 1) % across - j
            triangles += [(n, e, e + up), (n, e + up, n + up)]
    return vertices, triangles


def rows(csv):
    """Returns (i, j, k) -> (position, distance) of a .csv file."""
    lines = csv.read_text().splitlines()
    assert lines[0] == "i,j,k,x,y,z,distance", lines[0]
    voxels = {}
    for line in lines[1:]:
        i, j, k, x, y, z, distance = line.split(",")
        voxels[int(i), int(j), int(k)] = ((float(x), float(y), float(z)), float(distance))
    assert len(voxels) == len(lines) - 1, "a voxel stands twice"
    return voxels


def values_of(grid):
    """Returns (i, j, k) -> value of a grid's active voxels."""
    values = {}
    for item in grid.iterOnValues():
        assert item.count == 1, item
        values[item.min] = item.value
    return values


class Band(Case):
    LOW, HIGH = numpy.array((0.0, 0.0, 0.0)), numpy.array((2.0, 1.5, 1.0))

    def box(self):
        write_obj(self.dir / "box.obj", box(self.LOW, self.HIGH))
        return self.dir / "box.obj"

    def test_distances_to_a_box_are_those_of_the_closed_form_and_none_is_missing(self):
        options = ["--voxel-size", "0.1", "--quantization", "0", "--band", "0.33"]
        for lattice in ("cartesian", "bcc", "fcc", "hexagonal"):
            signed = lattice in ("bcc", "hexagonal")
            with self.subTest(lattice):
                summary = self.voxelize(self.box(), *options, "--lattice", lattice, *(["--signed"] * signed))
                self.assertEqual((summary["band"]["width"], summary["fields"]["distance"]["signed"]), (0.33, signed))
                self.check_box(summary, rows(self.dir / "out.csv"), signed)

    def check_box(self, summary, voxels, signed):
        basis = numpy.array(summary["basis"]).reshape(3, 3)
        slack = SNAP * numpy.linalg.norm(basis, axis=1).sum() + 1e-7
        self.assertEqual(len(voxels), summary["voxels"])
        found = numpy.array([distance for _, distance in voxels.values()])
        exact = distances_to_box(numpy.array([position for position, _ in voxels.values()]), self.LOW, self.HIGH)
        # Where the surface is nearer than it may have moved, either side is right.
        near = numpy.abs(exact) <= slack
        self.assertLessEqual(numpy.abs(numpy.where(near, 0, found - (exact if signed else abs(exact)))).max(), slack)
        self.assertLessEqual(numpy.abs(found).max(), numpy.float32(0.33))
        lattice = numpy.indices((80, 80, 80)).reshape(3, -1).T - 30
        exact = numpy.abs(distances_to_box(lattice @ basis, self.LOW, self.HIGH))
        inside = {tuple(ijk) for ijk in lattice[exact < 0.33 - slack].tolist()}
        around = {tuple(ijk) for ijk in lattice[exact < 0.33 + slack].tolist()}
        self.assertLessEqual(inside, voxels.keys())
        self.assertLessEqual(voxels.keys(), around)

    # OpenVDB smooths its distances here, by up to a fifth of a voxel. tests/unit/core/band/band_openvdb_test.cc
    # compares them unsmoothed.
    def test_on_cubes_it_is_the_level_set_that_openvdb_makes(self):
        vertices, triangles = torus(48, 24)
        size = 0.09
        write_obj(self.dir / "torus.obj", (vertices, triangles))
        summary = self.voxelize(self.dir / "torus.obj", "--voxel-size", size, "--origin", "0,0,0", "--quantization", 0,
                                "--band", "3v", "--signed", out="out.vdb")  # fmt: skip
        (grid,), _ = pyopenvdb.readAll(str(self.dir / "out.vdb"))
        peer = pyopenvdb.FloatGrid.createLevelSetFromPolygons(
            numpy.array(vertices, dtype="f4"),
            triangles=numpy.array(triangles, dtype="u4"),
            transform=pyopenvdb.createLinearTransform(size),
            halfWidth=3,
        )
        self.assertEqual((grid.name, grid.gridClass, grid.valueTypeName), ("distance", peer.gridClass, "float"))
        self.assertEqual(grid.background, numpy.float32(3 * size))
        self.assertEqual(grid["latvox_distance_digest"], summary["fields"]["distance"]["digest"])
        ours, theirs = values_of(grid), values_of(peer)
        self.assertEqual(len(ours), summary["voxels"])
        slack = size * 0.25
        for ijk in ours.keys() | theirs.keys():
            if ijk in ours and ijk in theirs:
                if abs(theirs[ijk]) > slack:
                    self.assertAlmostEqual(ours[ijk], theirs[ijk], delta=slack, msg=ijk)
            else:
                self.assertAlmostEqual(abs((ours if ijk in ours else theirs)[ijk]), 3 * size, delta=slack, msg=ijk)
        # Also beyond the band: in the ring, in its hole, far away.
        for ijk in ((33, 0, 0), (0, 33, 0), (0, 0, 0), (200, 0, 0)):
            self.assertEqual(grid.getConstAccessor().getValue(ijk), peer.getConstAccessor().getValue(ijk), ijk)
        self.assertEqual(grid.getConstAccessor().getValue((33, 0, 0)), -numpy.float32(3 * size))

    def test_parts_and_encodings_are_those_of_the_whole(self):
        write_obj(self.dir / "torus.obj", torus(30, 15))
        options = [self.dir / "torus.obj", "--resolution", "150", "--lattice", "bcc", "--band", "2v", "--signed"]
        whole = self.voxelize(*options)
        table = rows(self.dir / "out.csv")
        for encoding in ("masks", "packed-zstd"):
            self.assertEqual(self.voxelize(*options, "--encoding", encoding)["fields"], whole["fields"])
            self.assertEqual(rows(self.dir / "out.csv"), table)
        joined, digest = {}, 0
        for part in ("0/3", "1/3", "2/3"):
            digest += int(self.voxelize(*options, "--shard", part)["fields"]["distance"]["digest"], 16)
            joined |= rows(self.dir / "out.csv")
        self.assertEqual(joined, table)
        self.assertEqual(f"{digest % 2**128:032x}", whole["fields"]["distance"]["digest"])

    def test_arrays_and_points_hold_the_distances(self):
        done = latvox("voxelize", self.box(), "--resolution", "20", "--band", "0.2", "--json",
                      *(word for name in ("o.csv", "o.npy", "o.ply") for word in ("-o", self.dir / name)))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        table = rows(self.dir / "o.csv")
        array = numpy.load(self.dir / "o.npy")
        self.assertEqual(len(array), json.loads(done.stdout)["voxels"])
        self.assertEqual({tuple(row["ijk"]): numpy.float32(row["distance"]) for row in array},
                         {ijk: numpy.float32(distance) for ijk, (_, distance) in table.items()})  # fmt: skip
        header, _, body = (self.dir / "o.ply").read_bytes().partition(b"end_header\n")
        self.assertIn(b"property float distance\n", header)
        points = numpy.frombuffer(body, dtype=[("xyz", "<f8", 3), ("ijk", "<i4", 3), ("distance", "<f4")])
        self.assertTrue((points["distance"] == array["distance"]).all() and (points["ijk"] == array["ijk"]).all())
        others = read_points(self.dir / "o.ply", *"ijk", "distance")
        self.assertEqual({tuple(ijk): (tuple(xyz), numpy.float32(distance)) for xyz, *ijk, distance in others},
                         {ijk: (xyz, numpy.float32(distance)) for ijk, (xyz, distance) in table.items()})  # fmt: skip

    def test_refusals_name_what_is_wrong(self):
        mesh = self.box()
        vertices, triangles = box(self.LOW, self.HIGH)
        write_obj(self.dir / "open.obj", (vertices, triangles[1:]))
        for status, says, words in (
            (3, "closed", [self.dir / "open.obj", "--band", "0.1", "--signed"]),
            (3, "the limit is 256", [mesh, "--band", "1000"]),
            (2, "--verify: not together with --band", [mesh, "--band", "0.1", "--verify"]),
            (2, "--signed", [mesh, "--signed"]),
            (2, "o.glb", [mesh, "--band", "0.1", "-o", self.dir / "o.glb"]),
        ):
            with self.subTest(says):
                done = latvox("voxelize", *words, "--resolution", "20", "-o", self.dir / "o.csv")
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(says, done.stderr)
                self.assertFalse((self.dir / "o.csv").exists())


if __name__ == "__main__":
    unittest.main()
