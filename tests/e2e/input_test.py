"""However a mesh comes in, the voxels are those of its triangles: formats, standard input, several files, --up."""

import base64
import functools
import json
import struct
import unittest
import zipfile

from harness import Case, encode_drc, float32, latvox, server, write_obj, write_ply, write_stl

# No two extents or turns of it are alike.
CORNERS = [(0.1, 0.2, 0.3), (2.7, 0.2, 0.4), (0.3, 4.1, 0.1), (0.2, 0.9, 7.3)]
MESH = ([tuple(map(float32, v)) for v in CORNERS], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
GRID = ["--voxel-size", "0.25", "--origin", "0,0,0", "--quantization", "0"]
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
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


def write_gltf(path, mesh):
    """As .glb: a node that moves the mesh by (1, 0, 0), and one that has it as it is."""
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
        """The options that name a server of this test; what is refused needs none."""
        return ["--server", self.enterContext(server(self.dir)).address]

    def digest(self, *arguments, stdin=None):
        with open(stdin or "/dev/null", "rb") as file:
            command = "voxelize", *arguments, *GRID, "--json", "-o", self.dir / "out.csv", *self.server
            done = latvox(*command, stdin=file)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["digest"]

    def expected(self, mesh):
        return self.digest(write_obj(self.dir / "expected.obj", mesh))

    def assert_refused(self, code, says, *arguments, stdin=None):
        with open(stdin or "/dev/null", "rb") as file:
            done = latvox("voxelize", *arguments, *GRID, "-o", self.dir / "out.csv", stdin=file)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, says)


class Input(InputCase):
    def test_every_format_says_the_same_by_name_and_on_standard_input(self):
        wanted = self.expected(MESH)
        obj = self.dir / "expected.obj"
        whole = model(f'<object id="1">{mesh_xml(MESH)}</object>', '<item objectid="1"/>')
        for path in (
            obj,
            write_ply(self.dir / "mesh.ply", MESH),
            write_stl(self.dir / "mesh.stl", MESH),
            encode_drc(self.dir / "mesh.drc", obj),
            write_3mf(self.dir / "mesh.3mf", whole),
        ):
            with self.subTest(path.name):
                self.assertEqual(self.digest(path), wanted)
                self.assertEqual(self.digest("-", stdin=path), wanted)
        with self.subTest("glb"):
            glb = write_gltf(self.dir / "mesh.glb", MESH)
            both = self.expected(joined(MESH, mapped(MESH, lambda x, y, z: (x + 1, y, z))))
            self.assertEqual(self.digest(glb), both)
            self.assertEqual(self.digest("-", stdin=glb), both)

    def test_the_format_can_be_told(self):
        wanted = self.expected(MESH)
        write_ply(self.dir / "mesh.obj", MESH)
        self.assert_refused(3, "mesh.obj: ", self.dir / "mesh.obj")
        self.assertEqual(self.digest(self.dir / "mesh.obj", "--input-format", "ply"), wanted)
        obj = self.dir / "expected.obj"
        self.assert_refused(3, "standard input: not a PLY file", "-", "--input-format", "ply", stdin=obj)

    def test_standard_input_that_is_no_mesh_is_refused(self):
        (self.dir / "text").write_text("this is no mesh\n")
        self.assert_refused(3, "standard input: .*--input-format", "-", stdin=self.dir / "text")
        self.assert_refused(3, "standard input: is empty", "-")
        self.assert_refused(2, "- is given twice", "-", "-")

    def test_several_meshes_are_one(self):
        other = mapped(MESH, lambda x, y, z: (x + 1.5, y + 0.5, z - 2))
        paths = write_obj(self.dir / "a.obj", MESH), write_ply(self.dir / "b.ply", other)
        wanted = self.expected(joined(MESH, other))
        self.assertEqual(self.digest(*paths), wanted)
        self.assertEqual(self.digest(encode_drc(self.dir / "a.drc", paths[0]), "-", stdin=paths[1]), wanted)

    def test_up_and_scale_move_the_vertices(self):
        path = write_obj(self.dir / "a.obj", MESH)
        for options, move in (
            (["--up", "z"], lambda x, y, z: (x, y, z)),
            (["--up", "y"], lambda x, y, z: (x, -z, y)),
            (["--up", "x"], lambda x, y, z: (-z, y, x)),
            (["--scale", "0.3"], lambda x, y, z: (0.3 * x, 0.3 * y, 0.3 * z)),
            (["--up", "y", "--scale", "1.7"], lambda x, y, z: (1.7 * x, -1.7 * z, 1.7 * y)),
        ):
            with self.subTest(options):
                wanted = self.expected(mapped(MESH, move))
                self.assertEqual(self.digest(path, *options), wanted)
                self.assertEqual(self.digest(encode_drc(self.dir / "a.drc", path), *options), wanted)
        self.assert_refused(3, "a.obj: vertex 1 .2.7 .* is not finite", path, "--scale", "1e39")

    def test_encode_writes_what_voxelize_reads(self):
        path, drc = write_obj(self.dir / "mesh.obj", MESH), self.dir / "mesh.drc"
        for options in [], ["--up", "y", "--scale", "0.5"]:
            with self.subTest(options):
                done = latvox("encode", path, *options, "-o", drc)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertRegex(done.stdout, rf"^{path}: 4 triangles\nwrote {drc}, \d+ bytes, lossless\n$")
                self.assertEqual(self.digest(drc), self.digest(path, *options))
        self.assertEqual(latvox("encode", path, path, "-o", drc).stdout.split()[3], "8")
        coarse = self.dir / "coarse.drc"
        self.assertEqual(latvox("encode", drc, "-o", coarse, "--quantization", 5).returncode, 0)
        self.assertEqual(self.voxelize(coarse, *GRID)["certificate"]["quantization_bits"], 5)
        done = latvox("encode", drc, "-o", drc)
        self.assertEqual((done.returncode, done.stderr), (2, f'latvox: --out: "{drc}" is the mesh itself\n'))

    def test_jobs_take_the_same(self):
        write_obj(self.dir / "a.obj", MESH)
        job = {"mesh": "a.obj", "voxel_size": 0.25, "origin": [0, 0, 0], "quantization": 0, "out": "a.csv"}
        wanted = self.expected(mapped(MESH, lambda x, y, z: (2 * x, -2 * z, 2 * y)))
        for scale, status in ((2, "done"), (2, "skipped"), (3, "done")):
            line = job | {"up": "y", "scale": scale, "weld_report": True, "input_format": "obj"}
            (self.dir / "jobs.jsonl").write_text(json.dumps(line))
            done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir, "--resume", *self.server)
            self.assertEqual(done.returncode, 0, done.stderr)
            result = json.loads((self.dir / "results.jsonl").read_text().splitlines()[-1])
            self.assertEqual(result["status"], status)
            if scale == 2 and status == "done":
                self.assertEqual(result["summary"]["digest"], wanted)
                self.assertEqual(result["summary"]["mesh"]["weld_report"]["vertices"], 4)


def parts(path):
    """The JSON and the buffer of a .glb."""
    data = path.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + size]), data[28 + size :]


class Gltf(InputCase):
    BROKEN = (MESH[0], [*MESH[1][:2], (1, 2, 9), MESH[1][3]])
    SAYS = r"a.gl\w+: meshes\[0\].primitives\[0\]: vertex index 9 of triangle 2 is not within the 4 vertices"

    def test_an_index_out_of_range_is_named_wherever_it_stands(self):
        glb = write_gltf(self.dir / "a.glb", self.BROKEN)
        self.assert_refused(3, self.SAYS, glb)
        self.assert_refused(3, "standard input: meshes.*vertex index 9", "-", stdin=glb)
        document, body = parts(glb)
        data = "data:application/octet-stream;base64," + base64.b64encode(body).decode()
        (self.dir / "a.bin").write_bytes(body)
        for uri in (data, "a.bin"):
            document["buffers"][0]["uri"] = uri
            (self.dir / "a.gltf").write_text(json.dumps(document))
            self.assert_refused(3, self.SAYS, self.dir / "a.gltf")

    def test_errors_name_place_and_limit(self):
        glb = write_gltf(self.dir / "a.glb", MESH)
        whole = glb.read_bytes()
        document, _ = parts(glb)
        count = json.dumps(document).replace('"count": 12', '"count": 11')
        for name, data, says in (
            ("a.glb", whole[:-20], r"a.glb: ends at byte \d+, within a chunk of \d+ bytes"),
            ("a.glb", whole[:15], "a.glb: ends at byte 15, within a chunk's header"),
            ("a.gltf", count.encode(), r"primitives\[0\]: 11 corners of triangles are not a multiple of 3"),
            ("a.gltf", b'{"asset":\n  oops}', "a.gltf: JSON: .*line 2, column 3"),
            ("a.gltf", json.dumps(document).replace('"indices": 1', '"indices": 7').encode(), "7 is out of bounds"),
        ):
            with self.subTest(says):
                (self.dir / name).write_bytes(data)
                self.assert_refused(3, says, self.dir / name)

    def test_a_draco_stream_is_named_by_the_server_s_refusal(self):
        (self.dir / "a.drc").write_bytes(b"DRACO" + bytes(20))
        done = latvox("voxelize", self.dir / "a.drc", *GRID[:-2], "-o", self.dir / "out.csv", *self.server)
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, "a.drc: mesh: ")


class ThreeMf(InputCase):
    def test_units_items_and_components_place_objects(self):
        objects = (
            f'<object id="1" type="model">{mesh_xml(MESH)}</object>'
            '<object id="2"><components><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 1 0 0"/>'
            '<component objectid="1"/></components></object>'
        )
        items = '<item objectid="2"/><item objectid="1" transform="2 0 0 0 1 0 0 0 1 0 0 0.5"/><!-- not placed: 3 -->'
        path = write_3mf(self.dir / "a.3mf", model(objects, items, 'unit="centimeter"'))
        wanted = joined(
            mapped(MESH, lambda x, y, z: (10 * (1 - y), 10 * x, 10 * z)),
            mapped(MESH, lambda x, y, z: (10 * x, 10 * y, 10 * z)),
            mapped(MESH, lambda x, y, z: (20 * x, 10 * y, 10 * (z + 0.5))),
        )
        self.assertEqual(self.digest(path), self.expected(wanted))

    def test_objects_may_lie_in_other_files_of_the_archive(self):
        attributes = f'xmlns:p="{PRODUCTION}" requiredextensions="p"'
        objects = '<object id="1"><components><component p:path="/3D/more.model" objectid="1"/></components></object>'
        more = model(f'<object id="1">{mesh_xml(MESH)}</object>', "")
        path = write_3mf(self.dir / "a.3mf", model(objects, '<item objectid="1"/>', attributes), more=more)
        self.assertEqual(self.digest(path), self.expected(MESH))

    def test_errors_name_part_line_and_element(self):
        good = f'<object id="1">{mesh_xml(MESH)}</object>'
        item = '<item objectid="1"/>'
        tenfold = '<object id="{}"><components>' + '<component objectid="{}"/>' * 10 + "</components></object>"
        nest = "".join(tenfold.format(n, *[n + 1] * 10) for n in range(1, 12)) + '<object id="12"/>'
        itself = '<object id="1"><components><component objectid="1"/></components></object>'
        for text, code, says in (
            (model(good.replace('v3="1"', 'v3="4"'), item), 3, 'line 7: <triangle>: v3="4" of triangle 0 .* 4 vert'),
            (model(good.replace('z="', 'z="x', 1), item), 3, 'line 2: <vertex>: z="x.*" of vertex 0 is not a finite'),
            (model(good, '<item objectid="7"/>'), 3, 'line 11: <item>: objectid="7" is no object'),
            (model(good, '<item objectid="1" transform="1 0 0"/>'), 3, "<item>: transform has 3 numbers, not 12"),
            (model(good, ""), 3, "the build has no item"),
            (model(good, item, 'unit="league"'), 3, 'unit "league" is not one of'),
            (model(good, item, 'xmlns:b="urn:beams" requiredextensions="b"'), 3, r'extension "b" \(urn:beams\)'),
            (model(itself, item), 3, "nest deeper than 64"),
            (model(nest, item), 5, "more than 1048576 objects"),
            ("<model", 3, "3dmodel.model, line 1: is not XML"),
        ):
            with self.subTest(says):
                self.assert_refused(code, f"a.3mf: .*{says}", write_3mf(self.dir / "a.3mf", text))

    def test_an_archive_that_is_damaged_is_refused(self):
        text = model(f'<object id="1">{mesh_xml(MESH)}</object>', '<item objectid="1"/>')
        path = write_3mf(self.dir / "a.3mf", text)
        whole = path.read_bytes()
        elsewhere = whole.replace(b"3D/3dmodel", b"3D/3dmodal")
        for name, data in (("cut", whole[:-30]), ("text", b"PK\3\4 and no more"), ("elsewhere", elsewhere)):
            with self.subTest(name):
                path.write_bytes(data)
                self.assert_refused(3, "a.3mf: ", path)


class WeldReport(InputCase):
    def test_it_counts_what_is_wrong_with_a_mesh(self):
        vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0), (0, -1, 0)]
        triangles = [
            (0, 2, 1), (0, 4, 3), (1, 2, 3), (2, 0, 3),  # closed, once 4 is 1
            (0, 1, 4),  # degenerate likewise
            (0, 1, 5),  # a third triangle on edge 0-1, with two open edges
        ]
        path = write_obj(self.dir / "a.obj", (vertices, triangles))
        wanted = {"vertices": 6, "triangles": 6, "duplicate_vertices": 1, "degenerate_triangles": 1, "open_edges": 2,
                  "non_manifold_edges": 1, "inconsistent_edges": 0}
        summary = self.voxelize(path, *GRID, *self.server, "--weld-report")
        self.assertEqual(summary["mesh"]["weld_report"], wanted)
        self.assertNotIn("weld_report", self.voxelize(path, *GRID, *self.server)["mesh"])
        turned = write_obj(self.dir / "b.obj", (vertices, [(1, 2, 0), *triangles[1:4]]))
        report = self.voxelize(turned, *GRID, *self.server, "--weld-report")["mesh"]["weld_report"]
        self.assertEqual((report["open_edges"], report["inconsistent_edges"]), (0, 3))
        done = latvox("voxelize", path, *GRID, "--weld-report", "-o", self.dir / "out.csv", *self.server)
        says = "of 6 vertices, 1 are duplicates; of 6 triangles, 1 are degenerate; edges: 2 open, 1 non-manifold"
        self.assertIn(says, done.stdout)

    def test_it_leaves_a_draco_stream_as_it_is(self):
        drc = encode_drc(self.dir / "a.drc", write_obj(self.dir / "a.obj", MESH))
        options = *GRID[:-2], *self.server
        with_report, without = self.voxelize(drc, *options, "--weld-report"), self.voxelize(drc, *options)
        self.assertEqual(with_report["bytes"]["sent"], without["bytes"]["sent"])
        self.assertEqual(with_report["mesh"]["weld_report"]["open_edges"], 0)


if __name__ == "__main__":
    unittest.main()
