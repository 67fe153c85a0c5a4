"""Colors of voxels from textures whose pixels are known."""

import base64
import csv
import json
import math
import random
import shutil
import struct
import subprocess
import unittest

from harness import Case, gltf_info, latvox, server
from inputs import mesh_xml, model, write_3mf
from textures import Gltf, chunk, linear, mean, png, quad, srgb

chance = random.Random(7)
NOISE = [tuple(chance.randrange(256) for _ in range(3)) for _ in range(32 * 32)]
# One color for each voxel of the square.
BLOCKS = [tuple(chance.randrange(256) for _ in range(3)) for _ in range(8 * 8)]
RED, GREEN, BLUE, WHITE = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)
FOUR = [RED, GREEN, BLUE, WHITE]


class Textures(Case):
    def setUp(self):
        super().setUp()
        self.server = self.enterContext(server(self.dir)).address

    def run_tool(self, mesh, *options, out="out.csv", fields="color", edge=1):
        size = ["--voxel-size", edge, "--origin", f"{edge / 2},{edge / 2},0"]
        fields = ["--fields", fields] if fields else []
        return latvox("voxelize", mesh, *size, *fields, "--server", self.server, "-o", self.dir / out, "--json", *options)

    def colors(self, mesh, *options, **more):
        """Returns the color of each voxel (i, j)."""
        done = self.run_tool(mesh, *options, **more)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.summary = json.loads(done.stdout)
        with open(self.dir / "out.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        return {(int(r["i"]), int(r["j"])): tuple(int(r[c]) for c in ("red", "green", "blue")) for r in rows}

    def glb(self, gltf):
        return gltf.write(self.dir / "mesh.glb")

    def assert_near(self, found, wanted, most=0):
        self.assertEqual(found.keys(), wanted.keys())
        for at, color in wanted.items():
            self.assertLessEqual(max(abs(a - b) for a, b in zip(found[at], color)), most, (at, found[at], color))

    def assert_fails(self, mesh, code, says, *options):
        done = self.run_tool(mesh, *options)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, says)

    def test_a_color_is_the_mean_of_the_pixels_that_the_voxel_covers(self):
        path = self.glb(Gltf(png(NOISE, 32)))
        gltf_info(path)
        for edge, most in ((1, 0), (2, 0), (8, 0)):
            with self.subTest(edge=edge):
                count = 8 // edge
                size = 4 * edge
                wanted = {
                    (i, j): mean([NOISE[32 * (size * j + y) + size * i + x] for x in range(size) for y in range(size)])
                    for i in range(count)
                    for j in range(count)
                }
                self.assert_near(self.colors(path, edge=edge), wanted, most)

    def test_odd_sides_halve_to_the_same_mean(self):
        pixels = NOISE[: 31 * 33]
        path = self.glb(Gltf(png(pixels, 31)))
        self.assert_near(self.colors(path, edge=8), {(0, 0): mean(pixels)}, 1)

    def test_between_pixels_colors_are_interpolated_or_not(self):
        gltf = Gltf(png([RED, BLUE], 2))
        shares = [0, 0, 0.125, 0.375, 0.625, 0.875, 1, 1]  # of blue
        gltf.document["samplers"] = [{"wrapS": 33071, "wrapT": 33071}]
        smooth = {(i, j): (srgb(1 - s), 0, srgb(s)) for i, s in enumerate(shares) for j in range(8)}
        self.assert_near(self.colors(self.glb(gltf)), smooth)
        gltf.document["samplers"] = [{"magFilter": 9728}]
        self.assert_near(self.colors(self.glb(gltf)), {(i, j): RED if i < 4 else BLUE for i in range(8) for j in range(8)})

    def test_beyond_the_edges_the_sampler_decides(self):
        for name, wrap in (
            ("repeat", lambda n: n % 8),
            ("mirror", lambda n: n % 8 if n // 8 % 2 == 0 else 7 - n % 8),
            ("clamp", lambda n: min(max(n, 0), 7)),
        ):
            with self.subTest(name):
                gltf = Gltf(png(BLOCKS, 8))
                gltf.document["samplers"] = [{"wrapS": {"repeat": 10497, "mirror": 33648, "clamp": 33071}[name], "wrapT": 33071, "magFilter": 9728}]
                gltf.attributes["TEXCOORD_0"] = gltf.floats([(x / 8 - 1.5, y / 8 + 0.5) for x, y, _ in quad()[0]])
                wanted = {(i, j): BLOCKS[8 * min(j + 4, 7) + wrap(i - 12)] for i in range(8) for j in range(8)}
                self.assert_near(self.colors(self.glb(gltf)), wanted)

    def test_the_transform_turns_as_the_extension_says(self):
        """Its example shows the lower left quarter of the image, turned clockwise by 90 degrees."""
        gltf = Gltf(png(BLOCKS, 8))
        gltf.document["samplers"] = [{"magFilter": 9728}]
        gltf.document["extensionsUsed"] = ["KHR_texture_transform"]
        move = {"offset": [0, 1], "rotation": math.pi / 2, "scale": [0.5, 0.5]}
        gltf.texture["extensions"] = {"KHR_texture_transform": move}
        wanted = {(i, j): BLOCKS[8 * (7 - i // 2) + j // 2] for i in range(8) for j in range(8)}
        self.assert_near(self.colors(self.glb(gltf)), wanted)
        move.update(rotation=0, scale=[1, -1])
        self.assert_near(self.colors(self.glb(gltf)), {(i, j): BLOCKS[8 * (7 - j) + i] for i in range(8) for j in range(8)})

    def test_the_second_set_of_coordinates(self):
        gltf = Gltf(png(BLOCKS, 8))
        gltf.document["samplers"] = [{"magFilter": 9728}]
        gltf.attributes["TEXCOORD_1"] = gltf.floats([(y / 8, x / 8) for x, y, _ in quad()[0]])
        wanted = {(i, j): BLOCKS[8 * i + j] for i in range(8) for j in range(8)}
        gltf.texture["texCoord"] = 1
        self.assert_near(self.colors(self.glb(gltf)), wanted)
        gltf.texture.update(texCoord=0, extensions={"KHR_texture_transform": {"texCoord": 1}})
        self.assert_near(self.colors(self.glb(gltf)), wanted)
        del gltf.attributes["TEXCOORD_1"]
        self.assert_fails(self.glb(gltf), 3, r"mesh.glb: meshes\[0\].primitives\[0\]: .* vertices have no TEXCOORD_1")

    def test_factors_multiply_linear_intensities(self):
        gltf = Gltf(png([(188, 255, 100)], 1), baseColorFactor=[0.5, 0.25, 1, 1])
        tints = [(1, 1, 1), (0, 1, 1), (1, 1, 1), (0, 1, 1)]  # red falls along x
        gltf.attributes["COLOR_0"] = gltf.floats(tints)
        red, green, blue = linear(188) * 0.5, 0.25, linear(100)
        wanted = {(i, j): (srgb(red * (1 - (i + 0.5) / 8)), srgb(green), srgb(blue)) for i in range(8) for j in range(8)}
        self.assert_near(self.colors(self.glb(gltf)), wanted)

    def test_images_may_stand_anywhere(self):
        image = png(BLOCKS, 8)
        wanted = {(i, j): BLOCKS[8 * j + i] for i in range(8) for j in range(8)}
        (self.dir / "a b.png").write_bytes(image)
        for uri in ("a%20b.png", "data:image/png;base64," + base64.b64encode(image).decode()):
            gltf = Gltf(image)
            gltf.document["samplers"] = [{"magFilter": 9728}]
            gltf.document["images"] = [{"uri": uri}]
            self.assert_near(self.colors(self.glb(gltf)), wanted)

    def test_other_kinds_of_images(self):
        """ImageMagick writes them; JPEG rounds colors."""
        whole = self.dir / "whole.png"
        whole.write_bytes(png([c for row in range(64) for n in range(64) for c in [BLOCKS[row // 8 * 8 + n // 8]]], 64))
        wanted = {(i, j): BLOCKS[8 * j + i] for i in range(8) for j in range(8)}
        gray = {at: (c[1],) * 3 for at, c in wanted.items()}
        for name, options, colors, most in (
            ("a.jpg", ["-quality", "100", "-sampling-factor", "1x1"], wanted, 3),
            ("b.jpg", ["-interlace", "JPEG", "-quality", "100", "-sampling-factor", "1x1"], wanted, 3),
            ("a.webp", ["-define", "webp:lossless=true"], wanted, 0),
            ("a.png", ["-type", "Palette"], wanted, 0),
            ("b.png", ["-interlace", "PNG"], wanted, 0),
            ("c.png", ["-channel", "G", "-separate"], gray, 0),
        ):
            with self.subTest(name=name, options=options):
                subprocess.run(["convert", whole, *options, self.dir / name], check=True)
                gltf = Gltf(b"-")
                gltf.document["images"] = [{"uri": name}]
                if name.endswith("webp"):  # the other image is for readers without the extension
                    gltf.document["images"].insert(0, {"uri": "missing.png"})
                    gltf.document["textures"][0]["extensions"] = {"EXT_texture_webp": {"source": 1}}
                self.assert_near(self.colors(self.glb(gltf)), colors, most)
        wide = png([tuple(257 * n for n in c) for c in BLOCKS], 8, bits=16, more=chunk(b"gAMA", struct.pack(">I", 100000)))
        gltf = Gltf(wide)
        gltf.document["samplers"] = [{"magFilter": 9728}]
        self.assert_near(self.colors(self.glb(gltf)), wanted)

    def test_images_that_cannot_be_read_are_named(self):
        good = png(NOISE, 32)
        bomb = good[:8] + chunk(b"IHDR", struct.pack(">II", 10**6, 10**6) + good[24:29]) + good[33:]
        for image, code, says in (
            (good[:500], 3, r"mesh.glb: images\[0\]: is damaged \(PNG: .*\)"),
            (good[:100] + b"\xff" * 40 + good[140:], 3, r"images\[0\]: is damaged \(PNG: .*\)"),
            (b"GIF89a", 3, r"images\[0\]: is not PNG, JPEG or WebP"),
            (b"\xff\xd8\xff\xe0 nonsense", 3, r"images\[0\]: is damaged"),
            (b"RIFF\x10\0\0\0WEBPVP8 nonsense", 3, r"images\[0\]: is damaged"),
            (bomb, 5, r"images\[0\]: has 1000000 x 1000000 pixels, and all images may together have 268435456 more"),
        ):
            with self.subTest(says):
                self.assert_fails(self.glb(Gltf(image)), code, says)
        gltf = Gltf(good)
        gltf.document["images"] = [{"uri": "nowhere.png"}]
        self.assert_fails(self.glb(gltf), 3, r'material "m": textures\[0\]: images\[0\]: file "nowhere.png" cannot be read')
        plain = self.colors(self.glb(gltf), "--skip-bad")
        self.assertEqual(set(plain.values()), {WHITE})
        self.assertEqual(self.summary["warnings"][0]["code"], "BAD_ELEMENTS")
        self.assertEqual(set(self.colors(self.glb(Gltf(b"GIF89a")), "--skip-bad").values()), {WHITE})
        self.assert_fails(self.glb(Gltf(good)), 3, "--upload: textures and opacity need raw", "--upload", "draco")

    def test_obj_files_have_textures_in_their_materials(self):
        (self.dir / "blocks.png").write_bytes(png(BLOCKS, 8))
        corners, triangles = quad()
        lines = ["mtllib a.mtl", *("v %g %g %g" % c for c in corners), *("vt %g %g" % (x / 8, y / 8) for x, y, _ in corners)]
        mesh = self.dir / "mesh.obj"
        mesh.write_text("\n".join([*lines, "usemtl m", *("f " + " ".join(f"{n + 1}/{n + 1}" for n in t) for t in triangles)]) + "\n")
        squares = [(i, j) for i in range(8) for j in range(8)]
        for options, factor, texel in (
            ("", "", lambda i, j: (i, 7 - j)),
            ("-s 1 -1", "", lambda i, j: (i, j)),
            ("-clamp on -o 0.5 0 0", "", lambda i, j: (min(i + 4, 7), 7 - j)),
            ("-o 0.5", "Kd 0.5 1 1\n", lambda i, j: ((i + 4) % 8, 7 - j)),
        ):
            with self.subTest(options):
                # A texel's mean with its neighbors is itself only where both are equal: scale them up.
                subprocess.run(["convert", self.dir / "blocks.png", "-filter", "point", "-resize", "800%", self.dir / "big one.png"], check=True)
                (self.dir / "a.mtl").write_text(f"newmtl m\n{factor}map_Kd {options} big one.png\n")
                wanted = {}
                for i, j in squares:
                    x, y = texel(i, j)
                    red, green, blue = BLOCKS[8 * y + x]
                    wanted[i, j] = (srgb(linear(red) * linear(128)), green, blue) if factor else (red, green, blue)
                self.assert_near(self.colors(mesh), wanted)
        (self.dir / "a.mtl").write_text("newmtl m\nmap_Kd -mm 0 1 -blendu on big one.png\n")
        self.colors(mesh)
        self.assertEqual([w["message"] for w in self.summary["warnings"]],
                         ['mesh.obj: the texture of material "m" has the option -mm, which is not read'.replace("mesh.obj", str(mesh))])  # fmt: skip
        (self.dir / "a.mtl").write_text("newmtl m\nmap_Kd gone.png\n")
        self.assert_fails(mesh, 3, 'material "m": texture file "gone.png" does not exist')
        mesh.write_text(mesh.read_text().replace("1/1", "1/9"))
        self.assert_fails(mesh, 3, 'line 1[01]: texture index "9" of a face is not within the file\'s 4')

    def test_3mf_files_have_textures(self):
        material = 'xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"'
        places = "".join(f'<m:tex2coord u="{x / 8}" v="{y / 8}"/>' for x, y, _ in quad()[0])
        text = mesh_xml(quad())
        for corners in ("0 1 2", "2 1 3"):
            a, b, c = corners.split()
            text = text.replace(f'v1="{a}" v2="{b}" v3="{c}"', f'v1="{a}" v2="{b}" v3="{c}" pid="2" p1="{a}" p2="{b}" p3="{c}"')
        resources = f"""<m:texture2d id="1" path="/3D/a.model" contenttype="image/png" filter="nearest"/>
            <m:texture2dgroup id="2" texid="1">{places}</m:texture2dgroup><object id="3">{text}</object>"""
        path = write_3mf(self.dir / "a.3mf", model(resources, '<item objectid="3"/>', material), a=png(BLOCKS, 8))
        wanted = {(i, j): BLOCKS[8 * (7 - j) + i] for i in range(8) for j in range(8)}
        self.assert_near(self.colors(path), wanted)

    def test_turned_and_joined_meshes_keep_their_textures(self):
        gltf = Gltf(png(BLOCKS, 8))
        gltf.document["samplers"] = [{"magFilter": 9728}]
        gltf.document["nodes"] = [{"mesh": 0, "scale": [-1, 1, 1], "translation": [8, 0, 0]}, {"mesh": 0, "translation": [8, 0, 0]}]
        gltf.document["scenes"] = [{"nodes": [0, 1]}]
        wanted = {(i, j): BLOCKS[8 * j + (7 - i if i < 8 else i - 8)] for i in range(16) for j in range(8)}
        path = self.glb(gltf)
        self.assert_near(self.colors(path), wanted)
        other = shutil.copy(path, self.dir / "other.glb")
        self.assert_near(self.colors(path, other), wanted)
        self.assert_near(self.colors(other, path, "--scale", "0.5"),
                         {(i, j): mean([wanted[2 * i + a, 2 * j + b] for a in (0, 1) for b in (0, 1)]) for i in range(8) for j in range(4)})  # fmt: skip

    def test_shards_and_other_fields_have_the_same_colors(self):
        path = self.glb(Gltf(png(NOISE, 32)))
        edge = {"edge": 0.125}
        self.colors(path, **edge)
        whole = self.summary
        self.assertEqual(list(whole["fields"]), ["color"])
        digests = []
        for shard in ("0/2", "1/2"):
            self.colors(path, "--shard", shard, **edge)
            digests.append(int(self.summary["fields"]["color"]["digest"], 16))
        self.assertEqual(sum(digests) % 2**128, int(whole["fields"]["color"]["digest"], 16))
        self.colors(path, fields="triangle,color,part", **edge)
        self.assertEqual(list(self.summary["fields"]), ["triangle", "color", "part"])
        self.assertEqual(self.summary["fields"]["color"], whole["fields"]["color"])
        self.assertEqual(self.summary["digest"], whole["digest"])
        self.assertEqual(self.run_tool(path, out="a.vdb", **edge).returncode, 0)
        info = json.loads(latvox("info", self.dir / "a.vdb", "--json").stdout)
        self.assertIn(whole["fields"]["color"]["digest"], json.dumps(info))

    def test_an_alpha_cutoff_drops_what_is_transparent(self):
        leaf = [(*c, 255 if n % 2 == n // 8 % 2 else 64) for n, c in enumerate(BLOCKS)]
        gltf = Gltf(png(leaf, 8, color=6))
        gltf.document["samplers"] = [{"magFilter": 9728}]
        path = self.glb(gltf)
        self.assertEqual(len(self.colors(path)), 64)
        whole = self.summary
        kept = {(i, j): BLOCKS[8 * j + i] for i in range(8) for j in range(8) if (i + j) % 2 == 0}
        self.assert_near(self.colors(path, "--alpha-cutoff", "0.5"), kept)
        self.assertEqual((self.summary["voxels"], self.summary["dropped"]), (32, 32))
        self.assertFalse(self.summary["certificate"]["tunnel_free"] or self.summary["certificate"]["minimal"])
        self.assertNotEqual(self.summary["digest"], whole["digest"])
        self.assertEqual(len(self.colors(path, "--alpha-cutoff", "0.25")), 64)
        self.assertEqual(self.summary["digest"], whole["digest"])
        done = self.run_tool(path, "--alpha-cutoff", "0.5", out="a.vdb", fields=None)
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(latvox("info", self.dir / "a.vdb", "--json").stdout)
        self.assertEqual(info["voxels"], 32)
        self.assertIn(json.loads(done.stdout)["digest"], json.dumps(info))
        self.assert_fails(path, 2, "--alpha-cutoff: cannot be combined with --verify", "--alpha-cutoff", "0.5", "--verify")
        self.assert_fails(path, 2, '"2" is not a number from 0 to 1', "--alpha-cutoff", "2")
        gltf = Gltf(baseColorFactor=[1, 1, 1, 0.75])
        alphas = [(1, 1, 1, 1), (1, 1, 1, 0), (1, 1, 1, 1), (1, 1, 1, 0)]
        gltf.attributes["COLOR_0"] = gltf.floats(alphas)
        kept = self.colors(self.glb(gltf), "--alpha-cutoff", "0.375")
        self.assertEqual(set(kept), {(i, j) for i in range(4) for j in range(8)})
        self.colors(self.glb(gltf), "--alpha-cutoff", "0.9")
        self.assertEqual([w["code"] for w in self.summary["warnings"]], ["EMPTY_RESULT"])

    def test_a_batch_repeats_a_job_whose_image_has_changed(self):
        (self.dir / "blocks.png").write_bytes(png(BLOCKS, 8))
        corners, triangles = quad()
        lines = [*("v %g %g %g" % c for c in corners), "vt 0 0", "vt 1 1", "usemtl m", "f 1/1 2/2 3/1", "mtllib a.mtl"]
        (self.dir / "mesh.obj").write_text("\n".join(lines))
        (self.dir / "a.mtl").write_text("newmtl m\nmap_Kd blocks.png")
        job = {"mesh": "mesh.obj", "resolution": 8, "alpha_cutoff": 0.5}
        jobs = [job | {"fields": "color", "out": "a.csv"}, job | {"out": "b.csv"}]
        (self.dir / "jobs.jsonl").write_text("".join(json.dumps(job) + "\n" for job in jobs))
        for wanted, pixels in (((2, 0), BLOCKS), ((0, 2), BLOCKS), ((2, 0), [WHITE] * 64)):
            (self.dir / "blocks.png").write_bytes(png(pixels, 8))
            done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out", "--server", self.server, "--resume", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual((json.loads(done.stdout)["done"], json.loads(done.stdout)["skipped"]), wanted)


if __name__ == "__main__":
    unittest.main()
