"""The gateway's page in Chromium: a mesh is dropped, its voxels are those of the tool, a link repeats the request."""

import base64
import json
import struct
import unittest
import zlib

from page_case import PageCase, binary_ply, ply, stl

from harness import write_obj

COLORS = [(230, 40, 30), (40, 60, 220), (250, 210, 20), (30, 160, 60)]


def texture(width=2, height=2):
    """Returns a .png of pixels in COLORS."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    colors = [[COLORS[(2 * y + x) % len(COLORS)] for x in range(width)] for y in range(height)]
    rows = b"".join(b"\0" + b"".join(map(bytes, row)) for row in colors)
    head = chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def textured(mesh, *size):
    """Returns a .gltf that shows texture(*size) along x and z, without blur."""
    vertices, triangles = mesh
    parts = [
        b"".join(struct.pack("<3f", *v) for v in vertices),
        b"".join(struct.pack("<2f", x / 14 + 0.5, z / 14 + 0.5) for x, _, z in vertices),
        b"".join(struct.pack("<3I", *t) for t in triangles),
        texture(*size),
    ]
    at = [sum(map(len, parts[:n])) for n in range(4)]
    views = [{"buffer": 0, "byteOffset": at[n], "byteLength": len(part)} for n, part in enumerate(parts)]
    about = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0, "sampler": 0, "name": "skin"}], "samplers": [{"magFilter": 9728, "minFilter": 9728}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}], "bufferViews": views,
        "buffers": [{"byteLength": sum(map(len, parts)),
                     "uri": f"data:application/octet-stream;base64,{base64.b64encode(b''.join(parts)).decode()}"}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                       "min": [-7] * 3, "max": [7] * 3},
                      {"bufferView": 1, "componentType": 5126, "count": len(vertices), "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}],
    }  # fmt: skip
    return json.dumps(about).encode()


def painted(mesh, materials):
    """Returns a .gltf of a primitive for each material, None without one, which share the triangles."""
    vertices, triangles = mesh
    points, corners = b"".join(struct.pack("<3f", *v) for v in vertices), b"".join(
        struct.pack("<3I", *t) for t in triangles
    )
    each = len(triangles) // len(materials)
    used = [{} if material is None else {"material": material} for material in materials]
    about = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "materials": [{"name": "first"}, {"name": "second"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": n + 1, **material}
                                   for n, material in enumerate(used)]}],
        "buffers": [{"byteLength": len(points + corners),
                     "uri": f"data:application/octet-stream;base64,{base64.b64encode(points + corners).decode()}"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(points)},
                        {"buffer": 0, "byteOffset": len(points), "byteLength": len(corners)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                       "min": [-7] * 3, "max": [7] * 3},
                      *({"bufferView": 1, "byteOffset": 12 * each * n, "componentType": 5125, "count": 3 * each,
                         "type": "SCALAR"} for n in range(len(materials)))],
    }  # fmt: skip
    return json.dumps(about).encode()


def glb(mesh):
    """Returns a .glb whose node moves the mesh by 5 along x."""
    vertices, triangles = mesh
    points, corners = b"".join(struct.pack("<3f", *v) for v in vertices), b"".join(
        struct.pack("<3H", *t) for t in triangles
    )
    about = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [5, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(points + corners)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(points)},
                        {"buffer": 0, "byteOffset": len(points), "byteLength": len(corners)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                       "min": [-7] * 3, "max": [7] * 3},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"}],
    }  # fmt: skip
    text = json.dumps(about).encode()
    text += b" " * (-len(text) % 4)
    chunks = (
        struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(points + corners), b"BIN\0")
        + points
        + corners
    )
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def text_stl(mesh):
    """Returns a text STL file."""
    vertices, triangles = mesh
    corners = [["vertex %g %g %g" % vertices[v] for v in triangle] for triangle in triangles]
    facets = ["\n".join(["facet normal 0 0 0", "outer loop", *three, "endloop", "endfacet"]) for three in corners]
    return "\n".join(["solid a", *facets, "endsolid a", ""]).encode()


class Page(PageCase):
    def test_a_dropped_mesh_becomes_voxels_and_its_link_repeats_them(self):
        direct = self.direct(
            write_obj(self.dir / "a.obj", self.mesh), "--lattice", "bcc", "--resolution", 40, "--fields", "distance"
        )
        tab = self.tab("#lattice=bcc&resolution=40&fields=distance")
        empty = self.picture(tab, "empty")
        self.drop(tab, "a.stl", stl(self.mesh))
        rows = self.shown(tab)
        self.assertEqual((rows["digest"], rows["voxels"]), (direct["digest"], f"{direct['voxels']:,}"))
        full = self.picture(tab, "desktop-light")
        self.assertGreater((full[:, 300:1000] != empty[:, 300:1000]).any(axis=2).mean(), 0.1)
        self.assert_csv(tab)
        uploads = self.gateway.log().count("method=UploadMesh")
        self.theme(tab, "dark")
        self.picture(tab, "desktop-dark")
        again = self.tab(tab.run("location.hash"), width=390, height=844, phone=True)
        self.assertEqual(self.shown(again)["digest"], direct["digest"])
        self.assertEqual(self.gateway.log().count("method=UploadMesh"), uploads, "a link uses the stored mesh")
        self.assertLessEqual(again.run("document.documentElement.scrollWidth"), 390)
        for theme in ("light", "dark"):
            self.theme(again, theme)
            self.picture(again, f"phone-{theme}")
        again.run("document.getElementById('stage').scrollIntoView()")
        self.picture(again, "phone-dark-viewer")

    def test_bricks_are_shown_while_they_arrive(self):
        tab = self.tab("#resolution=500&set=supercover")
        tab.run(
            """{
          window.told = [];
          const [status, viewer] = ["status", "viewer"].map((id) => document.getElementById(id));
          const look = () => told.push([status.innerText, !viewer.hidden]);
          new MutationObserver(look).observe(status, { childList: true });
        }"""
        )
        self.drop(tab, "a.stl", stl(self.mesh))
        voxels = self.shown(tab)["voxels"]
        partial = [
            text.removesuffix(" voxels so far")
            for text, viewer in tab.run("told")
            if text.endswith(" so far") and viewer
        ]
        self.assertGreater(len(partial), 1, tab.run("told"))
        self.assertNotEqual(partial[0], voxels)

    def test_colors_of_vertices_are_those_of_the_tool(self):
        (self.dir / "a.ply").write_bytes(ply(self.mesh, COLORS))
        options = ["--lattice", "fcc", "--resolution", 40, "--fields", "color,part"]
        direct = self.direct(self.dir / "a.ply", *options)
        tab = self.tab("#lattice=fcc&resolution=40&fields=color,part")
        self.drop(tab, "a.ply", ply(self.mesh, COLORS))
        self.assertEqual(self.shown(tab)["digest"], direct["digest"])
        self.assert_csv(tab)
        picture = self.picture(tab, "colors")[:, 330:1000, :3].astype(int)
        red = (picture[..., 0] > 120) & (picture[..., 1] < 90) & (picture[..., 2] < 90)
        self.assertGreater(red.mean(), 0.01)
        again = self.tab(tab.run("location.hash"))
        self.assertEqual(self.shown(again)["digest"], direct["digest"])
        self.assert_csv(again)
        self.drop(again, "a.stl", stl(self.mesh))
        self.assertEqual(self.error(again), 'fields: "color" is not in a.stl, which has part')
        again.run("document.querySelector('[value=color]').click()")
        again.run("document.forms[0].requestSubmit()")
        again.rest()
        self.shown(again)
        self.assertTrue(again.run("document.querySelector('[value=color]').disabled"))

    def test_faces_of_a_ply_have_four_corners_or_colors(self):
        cube = [(x, y, z) for x in (0.0, 5.0) for y in (0.0, 5.0) for z in (0.0, 5.0)]
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        tab = self.tab("#resolution=20&fields=color")
        for mesh, colored in (((cube, quads), "vertex"), (self.mesh, "face")):
            with self.subTest(colored):
                data = ply(mesh, COLORS, colored)
                (self.dir / "a.ply").write_bytes(data)
                direct = self.direct(self.dir / "a.ply", "--resolution", 20, "--fields", "color")
                self.drop(tab, "a.ply", data)
                self.assertEqual(self.shown(tab)["digest"], direct["digest"])
        self.assert_csv(tab)
        self.drop(tab, "a.ply", ply((cube, quads), COLORS, "face"))
        self.assertIn("a.ply: faces of four corners have colors", self.error(tab))

    def test_colors_of_textures_are_those_of_the_tool(self):
        (self.dir / "a.gltf").write_bytes(textured(self.mesh))
        self.direct(self.dir / "a.gltf", "--resolution", 60, "--fields", "color")
        tab = self.tab("#resolution=60&fields=color")
        self.drop(tab, "a.gltf", textured(self.mesh))
        self.shown(tab)
        self.picture(tab, "texture")
        found, wanted = (
            {line.rpartition(",")[0].rsplit(",", 5)[0]: line.split(",")[-3:] for line in path.read_text().splitlines()}
            for path in (self.saved(tab, "csv"), self.dir / "direct.csv")
        )
        self.assertEqual(found.keys(), wanted.keys())
        pure = {tuple(map(str, color)) for color in COLORS}
        self.assertLessEqual({*map(tuple, found.values())} - {("red", "green", "blue")}, pure)
        # The tool mixes the colors of voxels along the borders of pixels.
        equal = [found[key] == color for key, color in wanted.items() if tuple(color) in pure]
        self.assertGreater(len(equal), 0.9 * len(wanted))
        self.assertGreater(sum(equal), 0.99 * len(equal))
        again = self.tab(tab.run("location.hash"))
        self.shown(again)
        self.assertEqual(again.run("document.getElementById('status').innerText"),
                         "A link has no textures: drop a.gltf once more for all of its colors.")  # fmt: skip

    def test_a_texture_is_as_large_as_every_canvas_may_be(self):
        tab = self.tab("#resolution=20&fields=color")
        self.drop(tab, "a.gltf", textured(self.mesh, 16384, 1))
        self.shown(tab)
        lines = self.saved(tab, "csv").read_text().splitlines()[1:]
        self.assertLessEqual({tuple(map(int, line.split(",")[-3:])) for line in lines}, set(COLORS))
        for width, height in ((16385, 1), (1, 16385)):
            self.drop(tab, "a.gltf", textured(self.mesh, width, height))
            self.assertEqual(
                self.error(tab),
                f'a.gltf: texture "skin" has {width} × {height} pixels, more than 16384 on a side; use the tool latvox',
            )

    def test_numbers_of_materials_are_those_of_the_tool(self):
        data = painted(self.mesh, [None, 1, 0, None])
        (self.dir / "a.gltf").write_bytes(data)
        self.direct(self.dir / "a.gltf", "--resolution", 20, "--fields", "material")
        tab = self.tab("#resolution=20&fields=material")
        self.drop(tab, "a.gltf", data)
        self.shown(tab)
        self.assert_csv(tab)

    def test_own_vectors_are_a_lattice(self):
        basis, obj = "0.5,0.1,0,0,0.4,0.1,0.6,0.05,0.45", write_obj(self.dir / "a.obj", self.mesh)
        for more, options in (("&resolution=40", ["--resolution", 40]), ("&resolution=", [])):
            direct = self.direct(obj, "--basis", basis, *options)
            tab = self.tab(f"#lattice=basis&basis={basis}{more}")
            self.drop(tab, "a.obj", obj.read_bytes())
            self.assertEqual(self.shown(tab)["digest"], direct["digest"])
            again = self.tab(tab.run("location.hash"))
            self.assertEqual(self.shown(again)["digest"], direct["digest"])
        self.picture(again, "own-lattice")
        again.run("document.forms[0].elements.basis.value = '1, 2, x'")
        again.run("document.forms[0].requestSubmit()")
        again.rest()
        self.assertEqual(self.error(again),
                         'basis: "1, 2, x" is not nine numbers a1,a2,a3,b1,b2,b3,c1,c2,c3')  # fmt: skip
        hidden = "['run', 'cancel', 'progress', 'result'].map((id) => document.getElementById(id).hidden)"
        self.assertEqual(again.run(hidden), [False, True, True, True])
        again.run("document.forms[0].elements.basis.value = '1 0 0 0 1 0 1 1 0'")
        again.run("document.forms[0].requestSubmit()")
        again.rest()
        self.assertIn("(BAD_SPEC)", self.error(again))

    def test_the_npz_has_the_arrays_of_the_tool(self):
        (self.dir / "a.ply").write_bytes(ply(self.mesh, COLORS))
        fields = "distance,color,part,triangle"
        options = ["--lattice", "bcc", "--resolution", 30, "--fields", fields]
        self.direct(self.dir / "a.ply", *options, out="direct.npz")
        tab = self.tab(f"#lattice=bcc&resolution=30&fields={fields}")
        self.drop(tab, "a.ply", ply(self.mesh, COLORS))
        self.shown(tab)
        self.assert_npz(tab)

    def test_an_npz_of_too_many_bytes_is_refused(self):
        # Two voxels far apart, and a field of 32 labels.
        told = self.tab().run(
            """import('./npz.js').then(({ npzOf }) => {
          const bricks = new Uint8Array(2 * 76), view = new DataView(bricks.buffer);
          const columns = Array.from({ length: 32 }, (_, n) => `fraction_${n}`);
          for (let m = 0; m < 3; ++m) view.setInt32(76 + 4 * m, 32, true);
          bricks[12] = bricks[88] = 1;
          const labels = { name: 'label_fractions', values: new Uint16Array(64), empty: 0, columns };
          try {
            npzOf(bricks, {}, [labels], {});
          } catch ({ message }) {
            return message;
          }
        })"""
        )
        wanted = "arrays over 257 × 257 × 257 points have 1103348569 bytes, more than 1073741824"
        self.assertEqual(told, f".npz: {wanted}; the .csv has all voxels")

    def test_keys_formats_cells_and_errors(self):
        tab = self.tab("#resolution=30")
        counts = tab.run(
            """import('./cell.js').then(({ facetsOf }) => [
          [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[2, 0, 0], [0, 2, 0], [1, 1, 1]], [[1, 1, 0], [1, 0, 1], [0, 1, 1]],
          [[1, 0, 0], [0.5, Math.sqrt(3) / 2, 0], [0, 0, 1]], [[1, 0, 0], [5, 1, 0], [-7, 4, 1]],
        ].map((basis) => facetsOf(basis).map(({ corners }) => corners.length).sort().join('')))"""
        )
        self.assertEqual(counts, ["4" * 6, "4" * 6 + "6" * 8, "4" * 12, "4" * 6 + "66", "4" * 6])
        plain = self.direct(write_obj(self.dir / "a.obj", self.mesh), "--resolution", 30)["digest"]
        for name, data in (
            ("b.obj", (self.dir / "a.obj").read_bytes()),
            ("c.glb", glb(self.mesh)),
            ("d.ply", ply(self.mesh)),
            ("d.ply", binary_ply(self.mesh)),
            ("e.stl", text_stl(self.mesh)),
        ):
            with self.subTest(name):
                self.drop(tab, name, data)
                self.assertEqual(self.shown(tab)["digest"], plain)
        tab.run("document.forms[0].elements.k.value = 2")
        for kind in ("keyDown", "keyUp"):
            tab.call(
                "Input.dispatchKeyEvent", type=kind, key="Enter", code="Enter", windowsVirtualKeyCode=13, modifiers=2
            )
        tab.rest()
        self.assertEqual(
            self.shown(tab)["digest"],
            self.direct(self.dir / "a.obj", "--resolution", 30, "--separability", 2)["digest"],
        )
        lost = self.tab(f"#resolution=30&name=lost.stl&mesh={'ab' * 32}&raw=3,1,float32")
        self.assertEqual(
            self.error(lost),
            "The server no longer has lost.stl: drop the file once more.",
        )


if __name__ == "__main__":
    unittest.main()
