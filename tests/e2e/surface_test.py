"""Surfaces (.glb) enclose exactly the voxels: checked by their volume, their edges, and an independent validator."""

import collections
import json
import struct
import unittest

from harness import BUNNY, Case, gltf_info, octahedron, write_obj

FACETS = {"cartesian": 6, "bcc": 14, "fcc": 12, "hexagonal": 8}


def read_glb(path):
    """Returns the document, corners in world coordinates, and triangles."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    document = json.loads(data[20 : 20 + size])
    if "meshes" not in document:
        return document, [], []
    binary = data[28 + size :]
    views = [binary[v.get("byteOffset", 0) :][: v["byteLength"]] for v in document["bufferViews"]]
    place = document["nodes"][0]["translation"]
    corners = [tuple(x + p for x, p in zip(corner, place)) for corner in struct.iter_unpack("<3f", views[0])]
    return document, corners, list(struct.iter_unpack("<3I", views[1]))


def volume(corners, triangles):
    """Returns the volume by the divergence theorem, about a corner, so that little cancels."""
    o = corners[0]
    sum_ = 0.0
    for triangle in triangles:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
            tuple(x - y for x, y in zip(corners[n], o)) for n in triangle
        )
        sum_ += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return sum_ / 6


class Surface(Case):
    def surface(self, mesh, *options):
        summary = self.voxelize(mesh, *options, out="out.glb")
        return summary, *read_glb(self.dir / "out.glb")

    def assert_encloses(self, summary, corners, triangles):
        (a, b, c) = (summary["basis"][n : n + 3] for n in (0, 3, 6))
        cell = abs(
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )
        self.assertAlmostEqual(volume(corners, triangles) / cell / summary["voxels"], 1, places=4)
        # Closed: every edge is passed equally often in both directions.
        size = cell ** (1 / 3)
        key = [tuple(round(x / size * 1000) for x in corner) for corner in corners]
        passes = collections.Counter()
        for p, q, r in triangles:
            for one, other in ((p, q), (q, r), (r, p)):
                passes[key[one], key[other]] += 1
                passes[key[other], key[one]] -= 1
        self.assertFalse([edge for edge, count in passes.items() if count], "the surface is open")

    def test_a_single_voxel_is_its_lattices_cell(self):
        speck = write_obj(self.dir / "speck.obj", octahedron(0.01))
        for lattice, facets in FACETS.items():
            with self.subTest(lattice):
                summary, _, corners, triangles = self.surface(
                    speck, "--lattice", lattice, "--separability", 2, "--voxel-size", 1, "--origin", "0,0,0", "--quantization", 0)
                self.assertEqual(summary["voxels"], 1)
                normals = set()
                for triangle in triangles:
                    p, q, r = (corners[n] for n in triangle)
                    u, v = ([x - y for x, y in zip(s, p)] for s in (q, r))
                    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
                    length = sum(x * x for x in n) ** 0.5
                    normals.add(tuple(round(x / length, 3) + 0.0 for x in n))
                self.assertEqual(len(normals), facets)
                self.assert_encloses(summary, corners, triangles)

    def test_the_bunny_is_enclosed_on_any_lattice(self):
        skew = ["--basis", "0.05,0,0,0.02,0.06,0,0.01,-0.02,0.07"]
        for options in [["--lattice", name, "--resolution", 40] for name in FACETS] + [skew]:
            with self.subTest(options):
                summary, document, corners, triangles = self.surface(BUNNY, *options)
                self.assert_encloses(summary, corners, triangles)
                self.assertEqual(document["extras"]["digest"], summary["digest"])
                info = gltf_info(self.dir / "out.glb")
                self.assertEqual(info["totalTriangleCount"], len(triangles))

    def test_no_voxel_is_a_scene_without_a_mesh(self):
        _, document, corners, triangles = self.surface(
            BUNNY, "--lattice", "bcc", "--resolution", 20, "--region", "1000,0,0,1001,1,1")
        self.assertEqual((corners, triangles), ([], []))
        self.assertNotIn("meshes", document)
        gltf_info(self.dir / "out.glb")

    def test_the_surface_goes_in_again(self):
        first, *_ = self.surface(BUNNY, "--lattice", "bcc", "--resolution", 60)
        (self.dir / "out.glb").rename(self.dir / "again.glb")
        again = self.voxelize(self.dir / "again.glb", "--lattice", "bcc", "--resolution", 60, "--quantization", 0)
        self.assertGreater(again["voxels"], first["voxels"])
        self.assertTrue(again["certificate"]["closed"])

    def test_memory_does_not_grow_with_the_surface(self):
        path, peaks, sizes = self.dir / "a.glb", [], []
        for resolution in ("128", "512"):
            peaks.append(self.peak_memory("voxelize", BUNNY, "--resolution", resolution, "-o", path))
            sizes.append(path.stat().st_size)
        self.assertGreater(sizes[1], sizes[0] + 80e6)
        # The bricks, and 2 bytes for each voxel, take some 3 MB.
        self.assertLess(peaks[1], peaks[0] + 8e6, (peaks, sizes))


if __name__ == "__main__":
    unittest.main()
