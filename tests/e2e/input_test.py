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
MATERIALS = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
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

    def carried(self, *arguments):
        """What voxels carry, each once."""
        self.digest(*arguments)
        lines = (self.dir / "out.csv").read_text().splitlines()[1:]
        return {tuple(map(int, line.split(",")[6:])) for line in lines}

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


def write_document(path, document, body):
    """As .gltf, the buffer within it."""
    uri = "data:application/octet-stream;base64," + base64.b64encode(body).decode()
    path.write_text(json.dumps(document | {"buffers": [{"byteLength": len(body), "uri": uri}]}))
    return path


SPARSE, CORNERS_AT = 48, 88  # bytes of the buffer below: which positions are changed; what corners are


def sparse_gltf():
    """MESH with sparse accessors, and its buffer: two positions of four, and all corners, are changes."""
    wrong = [MESH[0][0], (9, 9, 9), MESH[0][2], (-9, 9, 9)]
    body = b"".join(struct.pack("<3f", *v) for v in wrong) + bytes((1, 3, 0, 0))
    body += struct.pack("<6f", *MESH[0][1], *MESH[0][3]) + bytes(range(12))
    body += struct.pack("<12H", *(n for t in MESH[1] for n in t))

    def change(count, view):
        return {"count": count, "indices": {"bufferView": view, "componentType": 5121}, "values": {"bufferView": view + 1}}

    views = [(0, 48), (SPARSE, 2), (52, 24), (76, 12), (CORNERS_AT, 24)]
    return {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "bufferViews": [{"buffer": 0, "byteOffset": begin, "byteLength": length} for begin, length in views],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": change(2, 1)},
            {"componentType": 5123, "count": 12, "type": "SCALAR", "sparse": change(12, 3)},
        ],
    }, bytearray(body)


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
        document = json.loads(write_document(self.dir / "a.gltf", *parts(glb)).read_text())
        count = json.dumps(document).replace('"count": 12', '"count": 11')
        for name, data, says in (
            ("a.glb", whole[:-20], r"a.glb: ends at byte \d+, within a chunk of \d+ bytes"),
            ("a.glb", whole[:15], "a.glb: ends at byte 15, within a chunk's header"),
            ("a.gltf", count.encode(), r"primitives\[0\]: 11 corners of triangles are not a multiple of 3"),
            ("a.gltf", b'{"asset":\n  oops}', "a.gltf: JSON: .*line 2, column 3"),
            ("a.gltf", json.dumps(document).replace('"indices": 1', '"indices": 7').encode(), r"primitives\[0\]: indices 7 is not among the 2 acc"),
        ):
            with self.subTest(says):
                (self.dir / name).write_bytes(data)
                self.assert_refused(3, says, self.dir / name)

    def rigged(self, path):
        """MESH with a skin that has no inverseBindMatrices, which are optional."""
        document, body = parts(write_gltf(self.dir / "rigged.glb", MESH))
        document["nodes"] = [{"mesh": 0, "skin": 0}, {"name": "joint"}]
        document["skins"] = [{"joints": [1]}]
        return write_document(path, document, body)

    def test_skins_and_morph_targets_are_not_applied(self):
        rigged = self.rigged(self.dir / "a.gltf")
        self.assertEqual(self.digest(rigged), self.expected(MESH))
        document = json.loads(rigged.read_text())
        document["meshes"][0]["weights"] = [0.5]
        rigged.write_text(json.dumps(document))
        done = latvox("voxelize", rigged, *GRID, "-o", self.dir / "out.csv", *self.server)
        self.assertEqual(done.returncode, 0, done.stderr)
        says = r"^latvox: .*a.gltf: meshes\[0\] has morph targets of weights \[0.5\], which are not applied\n$"
        self.assertRegex(done.stderr, says)

    def test_a_rig_and_a_refusal_stop_no_other_job(self):
        self.rigged(self.dir / "rigged.gltf")
        document, body = parts(write_gltf(self.dir / "a.glb", MESH))
        write_document(self.dir / "refused.gltf", document | {"extensionsRequired": ["EXT_mesh_gpu_instancing"]}, body)
        write_obj(self.dir / "a.obj", MESH)
        job = {"voxel_size": 0.25, "origin": [0, 0, 0], "quantization": 0}
        lines = (json.dumps(job | {"mesh": name, "out": name + ".csv"}) for name in ("refused.gltf", "rigged.gltf", "a.obj"))
        (self.dir / "jobs.jsonl").write_text("\n".join(lines))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir, *self.server)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, "jobs.jsonl:1: .*refused.gltf: extensionsRequired: EXT_mesh_gpu_instancing is not supp")
        self.assertEqual((self.dir / "rigged.gltf.csv").read_text(), (self.dir / "a.obj.csv").read_text())

    def test_quantized_positions_in_a_file_beside_it(self):
        """As exporters write them: shorts in steps of 8 bytes, which a node scales back."""
        document, body = parts(write_gltf(self.dir / "a.glb", MESH))
        steps = [tuple(round(x * 4000) for x in v) for v in MESH[0]]
        quantized = b"".join(struct.pack("<4h", *v, 0) for v in steps)
        document["accessors"][0] |= {"componentType": 5122, "normalized": True}
        document |= {"scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "scale": [32767 / 4096] * 3}]}
        document["bufferViews"] = [
            {"buffer": 0, "byteLength": len(quantized), "byteStride": 8},
            {"buffer": 0, "byteOffset": len(quantized), "byteLength": 24},
        ]
        (self.dir / "my buf.bin").write_bytes(quantized + body[48:72])
        document["buffers"] = [{"uri": "my%20buf.bin", "byteLength": len(quantized) + 24}]
        extension = ["KHR_mesh_quantization"]
        (self.dir / "a.gltf").write_text(json.dumps(document | {"extensionsUsed": extension, "extensionsRequired": extension}))
        self.assertEqual(self.digest(self.dir / "a.gltf"), self.expected(([tuple(x / 4096 for x in v) for v in steps], MESH[1])))

    def test_a_draco_stream_is_named_by_the_server_s_refusal(self):
        (self.dir / "a.drc").write_bytes(b"DRACO" + bytes(20))
        done = latvox("voxelize", self.dir / "a.drc", *GRID[:-2], "-o", self.dir / "out.csv", *self.server)
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, "a.drc: mesh: ")

    def test_sparse_accessors_are_read(self):
        document, body = sparse_gltf()
        wanted = self.expected(MESH)
        self.assertEqual(self.digest(write_document(self.dir / "a.gltf", document, body)), wanted)
        del document["accessors"][0]["sparse"]
        self.assertNotEqual(self.digest(write_document(self.dir / "a.gltf", document, body)), wanted)

    def test_sparse_accessors_that_reach_beyond_are_named(self):
        for says, change in (
            (r"accessors\[0\]: sparse.indices: 4 at 1 is not below the count 4", lambda a, b: b.__setitem__(SPARSE + 1, 4)),
            ("accessors.1.: sparse.indices: needs bytes 0 to 13 of bufferView 3, which has 12",
             lambda a, b: a[1]["sparse"].update(count=13) or a[1].update(count=15)),
            ("accessors.0.: sparse: count 5 exceeds the accessor's 4", lambda a, b: a[0]["sparse"].update(count=5)),
            ("sparse.values: needs bytes 24 to 48 of bufferView 2, which has 24",
             lambda a, b: a[0]["sparse"]["values"].update(byteOffset=24)),
            ("sparse.indices: bufferView 9 is not among the 5", lambda a, b: a[0]["sparse"]["indices"].update(bufferView=9)),
            ("sparse.indices: bufferView: -1 is not a whole number from 0",
             lambda a, b: a[0]["sparse"]["indices"].update(bufferView=-1)),
            ("sparse.values: bufferView: 1.5 is not a whole", lambda a, b: a[0]["sparse"]["values"].update(bufferView=1.5)),
            ("accessors.0.: JSON: key 'indices' not found", lambda a, b: a[0]["sparse"].pop("indices")),
            ("sparse.indices: componentType 5126 is not one of", lambda a, b: a[0]["sparse"]["indices"].update(componentType=5126)),
            (r"needs bytes 0 to 51539607540 of bufferView 0", lambda a, b: a[0].update(count=2**32 - 1)),
            ("accessors.1.: count 4294967295 exceeds 4194304", lambda a, b: a[1].update(count=2**32 - 1)),
            (r"meshes\[0\].primitives\[0\]: vertex index 9 of triangle 0 is not", lambda a, b: b.__setitem__(CORNERS_AT, 9)),
        ):
            with self.subTest(says):
                document, body = sparse_gltf()
                change(document["accessors"], body)
                code = 5 if "4194304" in says else 3
                self.assert_refused(code, f"a.gltf: .*{says}", write_document(self.dir / "a.gltf", document, body))

    def test_a_material_s_color_is_that_of_its_parts(self):
        path = write_gltf(self.dir / "a.glb", MESH)
        document, body = parts(path)
        primitive = document["meshes"][0]["primitives"][0]
        document["meshes"].append({"primitives": [primitive | {"material": 1}]})
        document["nodes"][1]["mesh"] = 1
        primitive["material"] = 0
        factors = [0.25, 1, 0, 1], [1, 0.5, 0.75, 0.1]
        document["materials"] = [{"name": n, "pbrMetallicRoughness": {"baseColorFactor": f}} for n, f in zip("pq", factors)]
        options = ["--attributes", "color,material"]
        self.assertEqual(self.carried(write_document(self.dir / "a.gltf", document, body), *options),
                         {(64, 255, 0, 0), (255, 128, 191, 1)})  # fmt: skip
        document["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        document |= {"textures": [{"source": 0}], "images": [{"uri": "data:image/png;base64,"}]}
        says = 'a.gltf: the mesh, or some of it, has no color .material "q" has a texture, and textures are not sampled.'
        self.assert_refused(3, says, write_document(self.dir / "a.gltf", document, body), *options)
        del primitive["material"]
        self.assert_refused(3, "has no color", write_document(self.dir / "a.gltf", document, body), *options)


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

    BASES = '<basematerials id="5"><base name="a" displaycolor="#FF8000"/><base name="b" displaycolor="#0102037F"/>' \
            '<base name="c" displaycolor="red"/></basematerials>'
    COLORS = '<m:colorgroup id="6"><m:color color="#102030"/><m:color color="#405060FF"/></m:colorgroup>'

    def colored(self, *triangles, of_object=""):
        """MESH with attributes of the object and of its triangles, placed twice, beside groups of properties."""
        mesh = mesh_xml(MESH)
        for n, attributes in enumerate(triangles):
            corners = 'v1="%d" v2="%d" v3="%d"' % MESH[1][n]
            mesh = mesh.replace(corners, f"{corners} {attributes}")
        groups = self.BASES + self.COLORS + '<m:texture2dgroup id="7" texid="8"/>'
        extension = f'xmlns:m="{MATERIALS}" requiredextensions="m"'
        items = '<item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 9 0 0"/>'
        return write_3mf(self.dir / "a.3mf", model(f'{groups}<object id="1" {of_object}>{mesh}</object>', items, extension))

    def test_base_materials_and_colors_are_carried(self):
        orange, dark, slate, grey = (255, 128, 0), (1, 2, 3), (16, 32, 48), (64, 80, 96)
        path = self.colored('pid="5" p1="0"', of_object='pid="5" pindex="1"')
        self.assertEqual(self.carried(path, "--attributes", "color"), {orange, dark})
        self.assertEqual(self.carried(path, "--attributes", "material"), {(0,), (1,)})
        last = self.colored(of_object='pid="5" pindex="1"')
        self.assertEqual(self.carried(last, "--attributes", "material,color"), {(0, *dark)}, "not by first use")
        path = self.colored('pid="5" p1="0"', of_object='pid="5" pindex="1"')
        self.assertEqual(self.digest(path), self.expected(joined(MESH, mapped(MESH, lambda x, y, z: (x + 9, y, z)))))
        path = self.colored('p1="1"', of_object='pid="6" pindex="0"')
        self.assertEqual(self.carried(path, "--attributes", "color"), {slate, grey})
        self.assert_refused(3, "has no material$", path, "--attributes", "material")
        # Corners of one triangle: the vertices that it shares have other colors in others.
        path = self.colored('pid="6" p1="0" p2="1" p3="0"', of_object='pid="5" pindex="0"')
        self.assertEqual(self.carried(path, "--attributes", "color"), {orange, slate, grey})

    def test_properties_that_are_none_are_missed_where_they_are_asked_for(self):
        for says, attributes in (
            ("$", ""),
            ('3dmodel.model, line 7: <triangle>: pid="9" is no group', 'pid="9" p1="0"'),
            ('line 7: <triangle>: p1="3" is not within the 3 of <basematerials> 5', 'pid="5" p1="3"'),
            ('line 7: <triangle>: p1="" is not within', 'pid="5"'),
            ('line 7: <triangle>: p2="-1" is not within the 2 of <colorgroup> 6', 'pid="6" p1="0" p2="-1"'),
            ('line 1: <base>: "red" is no color', 'pid="5" p1="2"'),
            ('line 7: <triangle>: pid="7" is a <texture2dgroup>, and only basematerials and colorgroup are read', 'pid="7" p1="0"'),
        ):
            with self.subTest(says):
                path = self.colored(attributes)
                self.assert_refused(3, "a.3mf: the mesh, or some of it, has no color.*" + says, path, "--attributes", "color")
                self.assertEqual(self.carried(path), {()})

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
