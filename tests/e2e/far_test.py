"""A mesh far from 0 has the voxels of the same mesh at 0: from every format, on every lattice."""

import json
import struct
import unittest

from harness import BUNNY, Case, octahedron

AWAY = (691603.5, 5334762.25, 519.75)  # a place in the UTM zone of Munich, in meters


def bunny():
    """Returns the bunny with coordinates rounded to multiples of 2**-20, so that its move is exact in doubles."""
    lines = BUNNY.read_text().splitlines()
    vertices = [tuple(round(float(x) * 2**20) / 2**20 for x in line.split()[1:4]) for line in lines if line.startswith("v ")]
    triangles = [tuple(int(corner.split("/")[0]) - 1 for corner in line.split()[1:]) for line in lines if line.startswith("f ")]
    return vertices, triangles


def moved(vertices):
    return [tuple(x + d for x, d in zip(vertex, AWAY)) for vertex in vertices]


def obj(path, vertices, triangles):
    text = "".join("v %r %r %r\n" % vertex for vertex in vertices) + "".join("f %d %d %d\n" % tuple(n + 1 for n in t) for t in triangles)
    path.write_text(text)


def ply(path, vertices, triangles):
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n")
    path.write_bytes(head.encode() + b"".join(struct.pack("<3d", *v) for v in vertices)
                     + b"".join(struct.pack("<B3I", 3, *t) for t in triangles))


def gltf(path, vertices, triangles, translation):
    """Writes the mesh in float32, placed by two nested nodes."""
    buffer = b"".join(struct.pack("<3f", *v) for v in vertices) + b"".join(struct.pack("<3I", *t) for t in triangles)
    path.with_suffix(".bin").write_bytes(buffer)
    places = 12 * len(vertices)
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"translation": [translation[0], 0, 0], "children": [1]}, {"translation": [0, *translation[1:]], "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(buffer), "uri": path.with_suffix(".bin").name}],
        "bufferViews": [{"buffer": 0, "byteLength": places}, {"buffer": 0, "byteOffset": places, "byteLength": 12 * len(triangles)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3", "min": [-1] * 3, "max": [1] * 3},
                      {"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}]}))


class Far(Case):
    def test_the_digest_is_that_at_0(self):
        vertices, triangles = bunny()
        near = self.dir / "near.obj"
        obj(near, vertices, triangles)
        far = {name: self.dir / f"far.{name}" for name in ("obj", "ply", "gltf")}
        obj(far["obj"], moved(vertices), triangles)
        ply(far["ply"], moved(vertices), triangles)
        gltf(far["gltf"], vertices, triangles, AWAY)
        origin = ",".join(map(repr, AWAY))
        for lattice in ("cartesian", "bcc", "fcc", "hexagonal"):
            options = ["--lattice", lattice, "--voxel-size", "0.01"]
            wanted = self.voxelize(near, *options, "--origin", "0,0,0")
            for name, path in far.items():
                with self.subTest(lattice=lattice, format=name):
                    found = self.voxelize(path, *options, f"--origin={origin}")
                    self.assertEqual((found["voxels"], found["digest"]), (wanted["voxels"], wanted["digest"]))
                    self.assertEqual(found["certificate"]["quantization_bits"], 0)

    def test_parts_and_colors_are_those_at_0(self):
        vertices, triangles = octahedron(4)
        for name, by in (("near", (0, 0, 0)), ("far", AWAY)):
            lines = []
            for part in range(2):
                lines.append(f"o part{part}")
                lines += ["v %r %r %r %r %r 0.5" % (x + by[0] + 3 * part, y + by[1], z + by[2], part, n / 5) for n, (x, y, z) in enumerate(vertices)]
                lines += ["f %d %d %d" % tuple(n + 1 + 6 * part for n in t) for t in triangles]
            (self.dir / f"{name}.obj").write_text("\n".join(lines) + "\n")
        options = ["--voxel-size", "0.125", "--fields", "part,color"]
        near = self.voxelize(self.dir / "near.obj", *options, "--origin=0,0,0")
        far = self.voxelize(self.dir / "far.obj", *options, "--origin=" + ",".join(map(repr, AWAY)))
        self.assertGreater(near["voxels"], 1000)
        self.assertEqual((near["digest"], near["fields"]), (far["digest"], far["fields"]))


if __name__ == "__main__":
    unittest.main()
