"""Shared by the tests of mesh formats: a mesh, files of it, and the expected values."""

import csv
import functools
import json
import struct
import zipfile

from harness import Case, float32, latvox, octahedron, server, write_obj

# All of its extents, and those of its turns, differ.
CORNERS = [(0.1, 0.2, 0.3), (2.7, 0.2, 0.4), (0.3, 4.1, 0.1), (0.2, 0.9, 7.3)]
MESH = ([tuple(map(float32, v)) for v in CORNERS], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
GRID = ["--voxel-size", "0.25", "--origin", "0,0,0", "--quantization", "0"]
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
RELATIONS = (
    '<Relationships><Relationship Id="r" Target="/3D/3dmodel.model" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def mapped(mesh, move):
    return [tuple(map(float32, move(*v))) for v in mesh[0]], mesh[1]


def joined(*meshes):
    vertices, triangles = [], []
    for more_vertices, more_triangles in meshes:
        triangles += [tuple(n + len(vertices) for n in t) for t in more_triangles]
        vertices += more_vertices
    return vertices, triangles


def moved(n):
    """Returns octahedron n of a row that do not touch."""
    vertices, triangles = octahedron(4.0)
    return [(x + 20 * n, y, z) for x, y, z in vertices], triangles


def write_named_obj(path, parts, place=0):
    """`parts`: name, material. The first is at this place."""
    lines = []
    for n, (part, material) in enumerate(parts):
        vertices, triangles = moved(place + n)
        lines += ([f"o {part}"] if part else []) + [f"usemtl {material}"]
        lines += [f"v {x} {y} {z}" for x, y, z in vertices]
        lines += ["f " + " ".join(str(v + 1 + 6 * n) for v in t) for t in triangles]
    path.write_text("\n".join(lines) + "\n")
    return path


def mesh_xml(mesh):
    vertices = "\n".join('<vertex x="%.9g" y="%.9g" z="%.9g"/>' % v for v in mesh[0])
    triangles = "\n".join('<triangle v1="%d" v2="%d" v3="%d"/>' % t for t in mesh[1])
    return f"<mesh><vertices>\n{vertices}\n</vertices><triangles>\n{triangles}\n</triangles></mesh>"


def model(resources, build, attributes=""):
    return f'<model xmlns="{CORE}" {attributes}><resources>{resources}</resources><build>{build}</build></model>'


def write_3mf(path, text, **parts):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", RELATIONS)
        archive.writestr("3D/3dmodel.model", text)
        for name, part in parts.items():
            archive.writestr(f"3D/{name}.model", part)
    return path


def write_off(path, mesh):
    lines = ["OFF", f"{len(mesh[0])} {len(mesh[1])} 0", *("%.9g %.9g %.9g" % v for v in mesh[0]), *("3 %d %d %d" % t for t in mesh[1])]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_gltf(path, mesh):
    """Returns a .glb with two nodes: one moves the mesh by (1, 0, 0), the other leaves it in place."""
    body = b"".join(struct.pack("<3f", *v) for v in mesh[0]) + b"".join(struct.pack("<3H", *t) for t in mesh[1])
    split, low, high = 12 * len(mesh[0]), *([f(v[m] for v in mesh[0]) for m in range(3)] for f in (min, max))
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "translation": [1, 0, 0]}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(body)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": split},
            {"buffer": 0, "byteOffset": split, "byteLength": len(body) - split},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(mesh[0]), "type": "VEC3", "min": low, "max": high},
            {"bufferView": 1, "componentType": 5123, "count": 3 * len(mesh[1]), "type": "SCALAR"},
        ],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body += bytes(-len(body) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(body), b"BIN\0") + body
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path


class InputCase(Case):
    @functools.cached_property
    def server(self):
        """Returns the options that name this test's server. Refused requests need none."""
        return ["--server", self.enterContext(server(self.dir)).address]

    def digest(self, *arguments, stdin=None):
        with open(stdin or "/dev/null", "rb") as file:
            command = "voxelize", *arguments, *GRID, "--json", "-o", self.dir / "out.csv", *self.server
            done = latvox(*command, stdin=file)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["digest"]

    def carried(self, *arguments):
        """Returns the distinct numbers of the voxels, without names of parts and materials."""
        self.digest(*arguments)
        with (self.dir / "out.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        numbers = [name for name in rows[0] if name in ("part", "material", "red", "green", "blue")]
        return {tuple(int(row[name]) for name in numbers) for row in rows}

    def assert_warns(self, says, path):
        done = latvox("voxelize", path, *GRID, "-o", self.dir / "out.csv", *self.server)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, says)

    def expected(self, mesh):
        return self.digest(write_obj(self.dir / "expected.obj", mesh))

    def assert_refused(self, code, says, *arguments, stdin=None):
        with open(stdin or "/dev/null", "rb") as file:
            done = latvox("voxelize", *arguments, *GRID, "-o", self.dir / "out.csv", stdin=file)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, says)
