"""glTF, text or binary: which parts are read, and which are refused, with the place in the message."""

import base64
import json
import struct
import unittest

from harness import latvox, write_obj
from inputs import GRID, MESH, InputCase, joined, mapped, write_gltf


def parts(path):
    """Returns the JSON and the buffer of a .glb."""
    data = path.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def write_document(path, document, body):
    """Returns a .gltf with the buffer inside it."""
    uri = "data:application/octet-stream;base64," + base64.b64encode(body).decode()
    path.write_text(json.dumps(document | {"buffers": [{"byteLength": len(body), "uri": uri}]}))
    return path


SPARSE, CORNERS_AT = 48, 88  # bytes of the buffer below: indices of changed positions; corners


def sparse_gltf():
    """Returns MESH with sparse accessors, and its buffer: two of four positions, and all corners, are changes."""
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
        """Returns MESH with a skin without inverseBindMatrices, which are optional."""
        document, body = parts(write_gltf(self.dir / "rigged.glb", MESH))
        document["nodes"] = [{"mesh": 0, "skin": 0}, {"name": "joint"}]
        document["skins"] = [{"joints": [1]}]
        return write_document(path, document, body)

    def test_skins_and_morph_targets_are_applied(self):
        """The file's only joint moves the mesh by (2, 0, 0), and half a target moves it by (0, 3, 0)."""
        document, body = parts(write_gltf(self.dir / "a.glb", MESH))
        count = len(MESH[0])
        body += struct.pack("<6f", 0, 6, 0, 0, 6, 0) * (count // 2) + bytes(4 * count) + b"\xff\0\0\0" * count
        sizes = [12 * count, 4 * count, 4 * count]
        for n, size in enumerate(sizes):
            document["bufferViews"].append({"buffer": 0, "byteOffset": len(body) - sum(sizes[n:]), "byteLength": size})
        document["accessors"] += [
            {"bufferView": 2, "componentType": 5126, "count": count, "type": "VEC3"},
            {"bufferView": 3, "componentType": 5121, "count": count, "type": "VEC4"},
            {"bufferView": 4, "componentType": 5121, "normalized": True, "count": count, "type": "VEC4"},
        ]
        primitive = document["meshes"][0]["primitives"][0]
        primitive["attributes"] |= {"JOINTS_0": 3, "WEIGHTS_0": 4}
        primitive["targets"] = [{"POSITION": 2}]
        document["meshes"][0]["weights"] = [0.5]
        document["nodes"] = [{"mesh": 0, "skin": 0, "translation": [50, 0, 0]}, {"translation": [2, 0, 0]}]
        document["skins"] = [{"joints": [1]}]
        path = write_document(self.dir / "a.gltf", document | {"scenes": [{"nodes": [0, 1]}]}, body)
        self.assertEqual(self.digest(path), self.expected(mapped(MESH, lambda x, y, z: (x + 2, y + 3, z))))
        write_document(path, document | {"animations": [{}]}, body)
        self.assert_warns("a.gltf: 1 animations are not applied", path)

    def test_a_rig_and_a_refusal_stop_no_other_job(self):
        self.rigged(self.dir / "rigged.gltf")
        document, body = parts(write_gltf(self.dir / "a.glb", MESH))
        write_document(self.dir / "refused.gltf", document | {"extensionsRequired": ["ACME_shape"]}, body)
        write_obj(self.dir / "a.obj", MESH)
        job = {"voxel_size": 0.25, "origin": [0, 0, 0], "quantization": 0}
        lines = (json.dumps(job | {"mesh": name, "out": name + ".csv"}) for name in ("refused.gltf", "rigged.gltf", "a.obj"))
        (self.dir / "jobs.jsonl").write_text("\n".join(lines))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir, *self.server)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, "jobs.jsonl:1: .*refused.gltf: extensionsRequired: ACME_shape is not supp")
        self.assertEqual((self.dir / "rigged.gltf.csv").read_text(), (self.dir / "a.obj.csv").read_text())

    def test_quantized_positions_in_a_file_beside_it(self):
        """Exporters write them like this: shorts in steps of 8 bytes, which a node scales back."""
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
        options = ["--fields", "color,material"]
        self.assertEqual(self.carried(write_document(self.dir / "a.gltf", document, body), *options),
                         {(137, 255, 0, 0), (255, 188, 225, 1)})  # fmt: skip
        document["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        document |= {"textures": [{"source": 0}], "images": [{"uri": "data:image/png;base64,"}]}
        textured = write_document(self.dir / "a.gltf", document, body)
        self.assert_warns('material "q" has a texture, which is not read', textured)
        del document["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"]
        del primitive["material"]
        partial = write_document(self.dir / "a.gltf", document, body)
        self.assertEqual(self.carried(partial, *options), {(255, 255, 255, 1), (255, 188, 225, 0)})
        self.assert_warns("4 of 8 triangles have neither colors nor a material, and are white", partial)

    def test_instances_are_placed(self):
        """Two instances by an extension that is used, and not required."""
        document, body = parts(write_gltf(self.dir / "a.glb", MESH))
        document["nodes"] = [{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}]
        document["scenes"] = [{"nodes": [0]}]
        document["bufferViews"].append({"buffer": 0, "byteOffset": len(body), "byteLength": 24})
        document["accessors"].append({"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"})
        body += struct.pack("<6f", 0, 0, 0, 5, 1, 0)
        document["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
        wanted = joined(MESH, mapped(MESH, lambda x, y, z: (x + 5, y + 1, z)))
        self.assertEqual(self.digest(write_document(self.dir / "a.gltf", document, body)), self.expected(wanted))


if __name__ == "__main__":
    unittest.main()
