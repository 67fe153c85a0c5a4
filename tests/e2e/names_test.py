"""The names that mesh files give to parts and materials reach grids, tables, summaries and legends."""

import csv
import json
import struct
import unittest

import pyopenvdb

from harness import Case, encode_drc, latvox, octahedron, write_obj
from inputs import mesh_xml, model, moved, write_3mf, write_named_obj

GRID = ["--voxel-size", "1", "--origin", "0,0,0", "--quantization", "0"]


def write_scene(path, nodes, materials):
    """Writes a .glb. `nodes`: the fields of each node, and its material."""
    body, views, accessors = b"", [], []

    def add(data, **accessor):
        nonlocal body
        views.append({"buffer": 0, "byteOffset": len(body), "byteLength": len(data)})
        accessors.append({"bufferView": len(views) - 1, **accessor})
        body += data
        return len(accessors) - 1

    meshes = []
    for n, (_, material) in enumerate(nodes):
        vertices, triangles = moved(n)
        low, high = ([f(v[m] for v in vertices) for m in range(3)] for f in (min, max))
        position = add(b"".join(struct.pack("<3f", *v) for v in vertices), componentType=5126, count=6, type="VEC3", min=low, max=high)
        indices = add(b"".join(struct.pack("<3I", *t) for t in triangles), componentType=5125, count=24, type="SCALAR")
        meshes.append({"name": f"mesh {n}", "primitives": [{"attributes": {"POSITION": position}, "indices": indices, "material": material}]})
    root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
            "nodes": [{"mesh": n, **fields} for n, (fields, _) in enumerate(nodes)], "meshes": meshes, "materials": materials,
            "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(body)}]}  # fmt: skip
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4s4I4s", b"glTF", 2, 28 + len(text) + len(body), len(text), 0x4E4F534A, b"")[:20] + text
                     + struct.pack("<2I", len(body), 0x004E4942) + body)  # fmt: skip
    return path


def write_objects(path, names):
    """Writes a .3mf with a base material for each object."""
    bases = "".join(f'<base name="base {n}" displaycolor="#00FF00"/>' for n in range(len(names)))
    resources, items = f'<basematerials id="1">{bases}</basematerials>', ""
    for n, name in enumerate(names):
        title = f'name="{name}" ' if name else ""
        resources += f'<object id="{n + 2}" {title}type="model" pid="1" pindex="{n}">{mesh_xml(moved(n))}</object>'
        items += f'<item objectid="{n + 2}"/>'
    return write_3mf(path, model(resources, items))


class Names(Case):
    def check(self, meshes, parts, materials):
        """Voxelizes the meshes. Part n is around x = 20 n. `materials` has the name of each part's material; None: the
        file gives none."""
        attributes = "part" if materials is None else "part,material"
        files = [word for name in ("a.vdb", "a.csv") for word in ("-o", self.dir / name)]
        done = latvox("voxelize", *meshes, *files, *GRID, "--fields", attributes, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)["fields"]
        self.assertEqual(told["part"]["names"], parts)
        voxels = pyopenvdb.read(str(self.dir / "a.vdb"), "voxels")
        self.assertEqual(json.loads(voxels["latvox_part_names"]), parts)
        with open(self.dir / "a.csv", newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual({row["part_name"] for row in table}, set(parts))
        for row in table:
            part = (int(row["i"]) + 10) // 20
            self.assertEqual((int(row["part"]), row["part_name"]), (part, parts[part]))
            if materials is not None:
                self.assertEqual(row["material_name"], materials[part])
                self.assertEqual(told["material"]["names"][int(row["material"])], materials[part])
                self.assertEqual(json.loads(voxels["latvox_material_names"]), told["material"]["names"])
        return table

    def test_objects_and_materials_of_an_obj(self):
        mesh = write_named_obj(self.dir / "m.obj", [("left", "wood"), ("a, \"quoted\" one", "iron"), ("right", "wood")])
        self.check([mesh], ["left", 'a, "quoted" one', "right"], ["wood", "iron", "wood"])
        self.check([write_named_obj(self.dir / "m.obj", [(None, "wood"), ("right", "iron")])], ["", "right"], ["wood", "iron"])

    def test_nodes_and_materials_of_a_scene(self):
        nodes = [({"name": "node"}, 1), ({}, 0), ({"name": 7}, 1)]
        mesh = write_scene(self.dir / "m.glb", nodes, [{"name": "iron"}, {}])
        self.check([mesh], ["node", "mesh 1", "mesh 2"], ["", "iron", ""])

    def test_objects_and_base_materials_of_a_3mf(self):
        self.check([write_objects(self.dir / "m.3mf", ["first", None, "third"])], ["first", "", "third"], ["base 0", "base 1", "base 2"])

    def test_solids_of_an_stl(self):
        text = ""
        for n, name in enumerate(("one", "two words")):
            vertices, triangles = moved(n)
            facets = "".join("facet normal 0 0 0 outer loop " + " ".join("vertex {} {} {}".format(*vertices[v]) for v in t)
                             + " endloop endfacet\n" for t in triangles)  # fmt: skip
            text += f"solid {name}\n{facets}endsolid {name}\n"
        (self.dir / "m.stl").write_text(text)
        self.check([self.dir / "m.stl"], ["one", "two words"], None)

    def test_of_several_files_those_without_names_have_their_own(self):
        plain = [write_obj(self.dir / f"{n}.obj", moved(n)) for n in range(2)]
        self.check(plain, ["0.obj", "1.obj"], None)
        named = write_named_obj(self.dir / "named.obj", [("left", "x"), ("right", "y")], place=1)
        self.check([plain[0], named], ["0.obj", "left", "right"], None)

    def test_without_names_nothing_changes(self):
        encode_drc(self.dir / "m.drc", write_obj(self.dir / "m.obj", octahedron(4.0)))
        summary = self.voxelize(self.dir / "m.obj", "-o", self.dir / "a.vdb", *GRID, "--fields", "part", out="a.csv")
        self.assertEqual(sorted(summary["fields"]["part"]), ["digest"])
        self.assertEqual((self.dir / "a.csv").read_text().splitlines()[0], "i,j,k,x,y,z,part")
        self.assertNotIn("names", latvox("info", self.dir / "a.vdb").stdout)

    def test_slices_pages_and_batches_have_the_names(self):
        mesh = write_named_obj(self.dir / "m.obj", [("left", "wood"), ("right", "iron")])
        (self.dir / "jobs.jsonl").write_text(json.dumps({"mesh": str(mesh), "voxel_size": 1, "fields": ["material", "part"], "out": ["b.vdb", "b.csv", "b.html"]}) + "\n")
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.dir / "out" / "b.csv", newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual({(row["part_name"], row["material_name"]) for row in table}, {("left", "wood"), ("right", "iron")})
        slice_ = latvox("slice", self.dir / "out" / "b.vdb", "--axis", "k", "--index", table[0]["k"], "-o", self.dir / "s.csv")
        self.assertEqual(slice_.returncode, 0, slice_.stderr)
        with open(self.dir / "s.csv", newline="") as file:
            self.assertEqual(list(csv.DictReader(file)), [row for row in table if row["k"] == table[0]["k"]])
        self.assertEqual(latvox("view", self.dir / "out" / "b.vdb", "-o", self.dir / "v.html").returncode, 0)
        for path in (self.dir / "v.html", self.dir / "out" / "b.html"):
            page = path.read_text()
            for label in ("part 0 (left): ", "part 1 (right): ", "material 0 (wood): ", "material 1 (iron): "):
                self.assertIn(label, page)
        info = latvox("info", mesh).stdout
        self.assertRegex(info, r"part names +left,right\nmaterials +2\nmaterial names +wood,iron\n")


if __name__ == "__main__":
    unittest.main()
