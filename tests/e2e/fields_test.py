"""Fields of voxels: compared with all triangles, read back from every format, in parts, and from other encoders."""

import csv
import json
import random
import re
import shutil
import struct
import subprocess
import unittest

import numpy
import pyopenvdb

from harness import PATIENCE, Case, by_three, encode_drc, gltf_info, latvox, octahedron, read_points, write_obj

GRID = ["--voxel-size", "1", "--origin", "0,0,0", "--quantization", "0"]  # snapping does not change whole numbers here


def write_colored_ply(path, vertices, colors, triangles):
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    body = b"".join(struct.pack("<3f3B", *v, *c) for v, c in zip(vertices, colors, strict=True))
    body += b"".join(struct.pack("<B3i", 3, *t) for t in triangles)
    path.write_bytes(header.encode() + body)
    return path


def mountains():
    """A height field with a color for each vertex."""
    chance = random.Random(4)
    side = 7
    vertices = [(6 * i, 6 * j, chance.randrange(12)) for i in range(side) for j in range(side)]
    colors = [tuple(chance.randrange(256) for _ in range(3)) for _ in vertices]
    triangles = []
    for n in (i * side + j for i in range(side - 1) for j in range(side - 1)):
        triangles += [(n, n + 1, n + side), (n + 1, n + side + 1, n + side)]
    chance.shuffle(triangles)
    return vertices, colors, triangles


def distances(point, corners):
    """Returns the distances from a point to many triangles, corners[t][n]."""
    a, b, c = corners.transpose(1, 0, 2).astype(float)
    best = numpy.full(len(a), numpy.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        edge = end - start
        along = numpy.clip(((point - start) * edge).sum(1) / (edge * edge).sum(1), 0, 1)
        best = numpy.minimum(best, numpy.linalg.norm(start + along[:, None] * edge - point, axis=1))
    normal = numpy.cross(b - a, c - a)
    normal /= numpy.linalg.norm(normal, axis=1)[:, None]
    over = numpy.ones(len(a), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        over &= (numpy.cross(end - start, point - start) * normal).sum(1) >= 0
    return numpy.where(over, abs(((point - a) * normal).sum(1)), best)


def table(path, columns):
    """Returns the numbers of each voxel, without the names that follow."""
    lines = path.read_text().splitlines()
    header = [name for name in lines[0].split(",") if not name.endswith("_name")]
    assert header == f"i,j,k,x,y,z,{columns}".split(","), lines[0]
    rows = [line.split(",") for line in lines[1:]]
    voxels = {tuple(map(int, row[:3])): tuple(map(int, row[6 : len(header)])) for row in rows}
    assert len(voxels) == len(rows), "a voxel stands twice"
    return voxels


def grids_of(vdb):
    """Returns name -> active voxels of a .vdb file's grids. Debian's pyopenvdb has no integer grids; vdb_print and
    vdb_ax have."""
    done = subprocess.run(["vdb_print", "-l", vdb], capture_output=True, text=True, timeout=PATIENCE, check=True)
    names = re.findall(r"^Name: (\w+)", done.stdout, re.M)
    counts = re.findall(r"^  Number of active voxels: +([\d,]+)", done.stdout, re.M)
    return {name: int(count.replace(",", "")) for name, count in zip(names, counts, strict=True)}


class Fields(Case):
    def colored(self):
        return write_colored_ply(self.dir / "colored.ply", *mountains())

    def test_colors_are_those_of_the_nearest_corner_of_the_nearest_triangle(self):
        vertices, colors, triangles = mountains()
        corners = numpy.array([[vertices[v] for v in t] for t in triangles])
        for options in (["--no-minimal"], ["--lattice", "bcc"], ["--set", "supercover"]):
            with self.subTest(options):
                summary = self.voxelize(self.colored(), *GRID, "--fields", "color", *options)
                basis = numpy.array(summary["basis"]).reshape(3, 3)
                exact = 1 if "bcc" in options else 0  # there snapping moves corners by up to 1/256 of a voxel
                voxels = table(self.dir / "out.csv", "red,green,blue")
                self.assertEqual(len(voxels), summary["voxels"])
                checked = 0
                for ijk, color in voxels.items():
                    self.check(numpy.array(ijk) @ basis, corners, triangles, vertices, colors, color, 0.02 * exact)
                    checked += 1
                self.assertGreater(checked, 500)

    def check(self, point, corners, triangles, vertices, colors, color, slack):
        far = distances(point, corners)
        nearest = [t for t, d in zip(triangles, far, strict=True) if d <= far.min() + 1e-9 + slack]
        to = {v: numpy.linalg.norm(numpy.array(vertices[v]) - point) for t in nearest for v in t}
        if slack:
            self.assertIn(color, [colors[v] for v in to], point)
        else:
            self.assertEqual(color, min(colors[v] for v in to if to[v] <= min(to.values()) + 1e-9), point)

    def test_every_field_of_every_set_is_that_of_the_nearest_triangle(self):
        vertices, triangles = octahedron(7.0)
        mesh = write_obj(self.dir / "m.obj", (vertices, triangles))
        corners = numpy.array([[vertices[v] for v in t] for t in triangles])
        fields = ["--fields", "distance,triangle,point,normal", "--signed"]
        for options in (["--set", "surface"], ["--set", "supercover"], ["--set", "solid"], ["--set", "interior"],
                        ["--set", "supercover-solid"], ["--band", "2.5"], ["--set", "enclosed"],
                        ["--set", "enclosed-interior"], ["--set", "region", "--seed", "0,0,0"], ["--set", "links"],
                        ["--set", "links", "--side", "outside"]):  # fmt: skip
            with self.subTest(options):
                summary = self.voxelize(mesh, *GRID, *fields, *options)
                self.assertEqual(list(summary["fields"]), ["distance", "triangle", "point", "normal"])
                with open(self.dir / "out.csv", newline="") as file:
                    rows = list(csv.DictReader(file))
                self.assertEqual(list(rows[0])[6:], "distance,triangle,u,v,nx,ny,nz".split(","))
                self.assertEqual(len(rows), summary["voxels"])
                for row in rows:
                    self.check_fields(row, corners)

    def check_fields(self, row, corners):
        point = numpy.array([float(row[n]) for n in "xyz"])
        distance, u, v = float(row["distance"]), float(row["u"]), float(row["v"])
        far = distances(point, corners)
        self.assertAlmostEqual(abs(distance), far.min(), delta=1e-6)
        self.assertEqual(int(row["triangle"]), int(numpy.argmax(far <= far.min() + 1e-9)))
        a, b, c = corners[int(row["triangle"])].astype(float)
        self.assertAlmostEqual(numpy.linalg.norm(a + u * (b - a) + v * (c - a) - point), far.min(), delta=1e-6)
        normal = numpy.cross(b - a, c - a)
        normal /= numpy.linalg.norm(normal)
        self.assertLess(abs(normal - [float(row[n]) for n in ("nx", "ny", "nz")]).max(), 1e-7)
        if far.min() > 1e-9:
            self.assertEqual(distance < 0, abs(point).sum() < 7)

    def test_every_format_keeps_every_field(self):
        names = ("o.vdb", "o.csv", "o.npy", "o.npz", "o.ply", "o.html")
        mesh = write_obj(self.dir / "m.obj", octahedron(7.0))
        done = latvox("voxelize", mesh, *GRID, "--set", "solid", "--fields", "distance,triangle,point,normal", "--json",
                      *(word for name in names for word in ("-o", self.dir / name)))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        array = numpy.load(self.dir / "o.npy")
        kinds = {"distance": ("<f4", ()), "triangle": ("<i4", ()), "point": ("<f4", (2,)), "normal": ("<f4", (3,))}
        for name, (kind, shape) in kinds.items():
            self.assertEqual((array.dtype[name].base.str, array.dtype[name].shape), (kind, shape))
        at = tuple(array["ijk"].T)
        with numpy.load(self.dir / "o.npz") as box:
            where = tuple(axis - low for axis, low in zip(at, box["index_min"], strict=True))
            self.assertEqual(int(box["data"].sum()), len(array))
            for name in kinds:
                self.assertTrue((box[name][where] == array[name]).all(), name)
        body = (self.dir / "o.ply").read_bytes().partition(b"end_header\n")[2]
        kind = [("distance", "<f4"), ("triangle", "<i4"), ("point", "<f4", 2), ("normal", "<f4", 3)]
        points = numpy.frombuffer(body, dtype=[("xyz", "<f8", 3), ("ijk", "<i4", 3), *kind])
        for name in ("ijk", *kinds):
            self.assertTrue((points[name] == array[name]).all(), name)
        grid = pyopenvdb.read(str(self.dir / "o.vdb"), "normal")
        found = {item.min: tuple(item.value) for item in grid.iterOnValues()}
        self.assertEqual(found, {tuple(r["ijk"].tolist()): tuple(r["normal"].tolist()) for r in array})
        self.assertEqual(grids_of(self.dir / "o.vdb"), dict.fromkeys(("voxels", *kinds), len(array)))
        compared = latvox("compare", self.dir / "o.vdb", self.dir / "o.vdb", "--json")
        self.assertEqual(json.loads(compared.stdout)["values"], {"triangle": 0, "point": 0, "normal": 0})
        for command in ("render", "view"):
            out = self.dir / ("r.png" if command == "render" else "r.html")
            self.assertEqual(latvox(command, self.dir / "o.vdb", "-o", out).returncode, 0)
        sliced = latvox("slice", self.dir / "o.vdb", "-o", self.dir / "s.csv")
        self.assertEqual(sliced.returncode, 0, sliced.stderr)
        self.assertEqual((self.dir / "s.csv").read_text().splitlines()[0], "i,j,k,x,y,z,distance,triangle,u,v,nx,ny,nz")

    def test_triangles_are_those_of_the_file_whatever_the_upload(self):
        mesh = write_obj(self.dir / "m.obj", octahedron(7.0))
        options = [*GRID[:4], "--fields", "triangle,point"]
        alone = self.voxelize(mesh, *options)["fields"]
        self.assertEqual(self.voxelize(mesh, *options, "--upload", "raw")["fields"], alone)
        parts = [int(self.voxelize(mesh, *options, "--shard", f"{n}/3")["fields"]["point"]["digest"], 16) for n in range(3)]
        self.assertEqual(f"{sum(parts) % 2**128:032x}", alone["point"]["digest"])
        encodings = [self.voxelize(mesh, *options, "--encoding", e)["fields"] for e in ("masks", "packed-zstd")]
        self.assertEqual(encodings, [alone, alone])

    def test_two_boxes_are_two_parts_in_every_format(self):
        outs = ["o.vdb", "o.csv", "o.npy", "o.ply"]
        for n in range(2):
            vertices, triangles = octahedron(8.0)
            write_obj(self.dir / f"{n}.obj", ([(x + 30 * n, y, z) for x, y, z in vertices], triangles))
        done = latvox("voxelize", self.dir / "0.obj", self.dir / "1.obj", "--json", "--fields", "part", *GRID,
                      *(word for name in outs for word in ("-o", self.dir / name)))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads(done.stdout)
        voxels = table(self.dir / "o.csv", "part")
        self.assertEqual(len(voxels), summary["voxels"])
        self.assertEqual({ijk: (int(ijk[0] > 15),) for ijk in voxels}, voxels)
        grid = pyopenvdb.read(str(self.dir / "o.vdb"), "voxels")
        self.assertEqual({item.min for item in grid.iterOnValues()}, set(voxels))
        self.assertEqual(grid["latvox_fields"], "part")
        self.assertEqual(grid["latvox_part_digest"], summary["fields"]["part"]["digest"])
        self.assertEqual(grids_of(self.dir / "o.vdb"), {name: summary["voxels"] for name in ("voxels", "part")})
        array = numpy.load(self.dir / "o.npy")
        self.assertEqual({tuple(row["ijk"]): (row["part"],) for row in array}, voxels)
        header, _, body = (self.dir / "o.ply").read_bytes().partition(b"end_header\n")
        self.assertIn(b"property int part\n", header)
        points = numpy.frombuffer(body, dtype=[("xyz", "<f8", 3), ("ijk", "<i4", 3), ("part", "<i4")])
        self.assertTrue((points["part"] == array["part"]).all() and (points["ijk"] == array["ijk"]).all())
        info = latvox("info", self.dir / "o.vdb")
        self.assertEqual(info.returncode, 0, info.stderr)
        self.assertRegex(info.stdout, "voxels.*bool")
        merged = latvox("merge", self.dir / "o.vdb", "-o", self.dir / "merged.vdb")
        self.assertEqual(merged.returncode, 0, merged.stderr)
        self.assertEqual((self.dir / "merged.vdb").read_bytes(), (self.dir / "o.vdb").read_bytes())

    def test_parts_materials_and_colors_of_an_obj_together(self):
        text = ["o left", "usemtl wood"]
        for n, material in enumerate(("wood", "iron", "wood")):
            vertices, triangles = octahedron(4.0)
            text += [f"v {x + 20 * n} {y} {z} {n / 2} 0 1" for x, y, z in vertices]
            text += ["o right"] * (n == 2) + [f"usemtl {material}"]
            text += ["f " + " ".join(str(v + 1 + 6 * n) for v in t) for t in triangles]
        (self.dir / "m.obj").write_text("\n".join(text) + "\n")
        names = ("o.vdb", "o.csv", "o.npy", "o.ply")
        done = latvox("voxelize", self.dir / "m.obj", "--fields", "material,color,part", *GRID,
                      *(word for name in names for word in ("-o", self.dir / name)))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        voxels = table(self.dir / "o.csv", "material,red,green,blue,part")
        expected = [(0, 0, 0, 255, 0), (1, 128, 0, 255, 0), (0, 255, 0, 255, 1)]
        self.assertEqual({ijk: expected[(ijk[0] + 10) // 20] for ijk in voxels}, voxels)
        grid = pyopenvdb.read(str(self.dir / "o.vdb"), "color")
        found = {item.min: tuple(item.value) for item in grid.iterOnValues()}
        self.assertEqual({ijk: tuple(round(255 * x) for x in color) for ijk, color in found.items()},
                         {ijk: carried[1:4] for ijk, carried in voxels.items()})  # fmt: skip
        self.check_expressions(voxels)
        count = len(voxels)
        self.assertEqual(grids_of(self.dir / "o.vdb"), dict.fromkeys(("voxels", "material", "color", "part"), count))
        array = numpy.load(self.dir / "o.npy")
        body = (self.dir / "o.ply").read_bytes().partition(b"end_header\n")[2]
        kind = [("material", "<i4"), ("color", "u1", 3), ("part", "<i4")]
        points = numpy.frombuffer(body, dtype=[("xyz", "<f8", 3), ("ijk", "<i4", 3), *kind])
        for rows in (array, points):
            self.assertEqual({tuple(r["ijk"]): (r["material"], *r["color"], r["part"]) for r in rows}, voxels)
        # meshio treats a uchar as signed, but not a uint8.
        rows = read_points(self.dir / "o.ply", *"ijk", "material", "red", "green", "blue", "part")
        self.assertEqual({(i, j, k): (material, *(c % 256 for c in color), part)
                          for _, i, j, k, material, *color, part in rows}, voxels)  # fmt: skip

    def check_expressions(self, voxels):
        """OpenVDB's expressions copy integer grids into the grid of colors."""
        if shutil.which("vdb_ax") is None:
            print("fields: expressions are NOT CHECKED, because there is no vdb_ax; Debian 12 has it")
            return
        expression = "vec3f@color = {float(int@material), float(int@part), -1.0f};"
        subprocess.run(["vdb_ax", "-i", self.dir / "o.vdb", "-o", self.dir / "ax.vdb", "-s", expression],
                       capture_output=True, timeout=PATIENCE, check=True)  # fmt: skip
        grid = pyopenvdb.read(str(self.dir / "ax.vdb"), "color")
        self.assertEqual({item.min: tuple(item.value) for item in grid.iterOnValues()},
                         {ijk: (carried[0], carried[4], -1) for ijk, carried in voxels.items()})  # fmt: skip

    def test_parts_of_the_whole_and_dracos_own_encoder_give_the_same(self):
        mesh = self.colored()
        options = ["--resolution", "100", "--lattice", "fcc", "--quantization", "0", "--fields", "color"]
        whole = self.voxelize(mesh, *options)
        voxels = table(self.dir / "out.csv", "red,green,blue")
        joined, digest = {}, 0
        for part in ("0/3", "1/3", "2/3"):
            digest += int(self.voxelize(mesh, *options, "--shard", part)["fields"]["color"]["digest"], 16)
            joined |= table(self.dir / "out.csv", "red,green,blue")
        self.assertEqual(joined, voxels)
        self.assertEqual(f"{digest % 2**128:032x}", whole["fields"]["color"]["digest"])
        for method in ("10", "0"):  # edgebreaker, sequential
            encode_drc(self.dir / "mesh.drc", mesh, "-cl", method)
            again = self.voxelize(self.dir / "mesh.drc", *options[:4], "--fields", "color")
            self.assertEqual(again["fields"], whole["fields"])

    def test_a_surface_has_the_colors_of_its_voxels(self):
        self.voxelize(self.colored(), *GRID, "--fields", "color", out="o.glb")
        data = (self.dir / "o.glb").read_bytes()
        (length,) = struct.unpack_from("<I", data, 12)
        scene, body = json.loads(data[20 : 20 + length]), data[28 + length :]
        accessor = scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
        self.assertEqual(accessor["count"], scene["accessors"][0]["count"])
        start = scene["bufferViews"][accessor["bufferView"]]["byteOffset"]
        found = numpy.frombuffer(body, "<u2", 4 * accessor["count"], start).reshape(-1, 4)
        self.voxelize(self.colored(), *GRID, "--fields", "color")
        voxels = table(self.dir / "out.csv", "red,green,blue")
        linear = lambda x: x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4
        expected = {(*(round(65535 * linear(x / 255)) for x in color), 65535) for color in voxels.values()}
        self.assertEqual({tuple(c) for c in found.tolist()}, expected)
        info = gltf_info(self.dir / "o.glb")
        self.assertEqual((info["totalVertexCount"], info["maxAttributes"]), (accessor["count"], 2))
        others = by_three(self.dir / "o.glb")["colors"]
        self.assertEqual([tuple(round(65535 * x) for x in c) for c in others], [tuple(c[:3]) for c in found.tolist()])
        self.voxelize(self.dir / "o.glb", *GRID, "--fields", "color")
        again = table(self.dir / "out.csv", "red,green,blue")
        self.assertLessEqual(set(again.values()), set(voxels.values()), "the tool reads its own colors")

    def test_a_surface_has_a_color_for_each_part(self):
        meshes = [write_obj(self.dir / f"{n}.obj", octahedron(n)) for n in (1, 2)]
        self.voxelize(*meshes, "--resolution", "12", "--fields", "part", "-o", self.dir / "o.glb", out="o.vox")
        self.assertEqual(len({tuple(color) for color in by_three(self.dir / "o.glb")["colors"]}), 2)
        self.voxelize(self.dir / "o.glb", "--resolution", "12", "--fields", "color")
        palette = (self.dir / "o.vox").read_bytes().rpartition(b"RGBA")[2][8:16]
        self.assertEqual(set(table(self.dir / "out.csv", "red,green,blue").values()), {tuple(palette[:3]), tuple(palette[4:7])})

    def test_refusals_name_what_is_wrong(self):
        plain = write_obj(self.dir / "plain.obj", octahedron())
        encode_drc(self.dir / "plain.drc", plain)
        for status, says, words in (
            (3, "plain.obj: the mesh, or some of it, has no color", [plain, "--fields", "part,color"]),
            (3, "colored.ply: the mesh, or some of it, has no material", [self.colored(), plain, "--fields", "material"]),
            (3, "fields: the mesh has no color", [self.dir / "plain.drc", "--fields", "color"]),
            (2, "--fields: not together with --algorithm brute-force", [plain, "--fields", "part", "--algorithm", "brute-force"]),
            (2, '"hue" is not one of part, material, color, distance, triangle, point, normal', [plain, "--fields", "part,hue"]),
            (2, "twice", [plain, "--fields", "part,part"]),
            (2, "o.glb cannot hold triangle", [plain, "--fields", "triangle", "-o", self.dir / "o.glb"]),
            (2, "o.npy cannot hold part,distance; .vdb .nvdb .csv .npz",
             [plain, "--fields", "part,distance", "--npy", "dense", "-o", self.dir / "o.npy"]),
            (3, "sent as it is", [self.dir / "plain.drc", plain, "--fields", "color"]),
            (2, "o.binvox cannot hold color", [plain, "--fields", "color", "-o", self.dir / "o.binvox"]),
        ):
            with self.subTest(says):
                done = latvox("voxelize", *words, "--resolution", "20", "-o", self.dir / "o.csv")
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(says, done.stderr)
                self.assertFalse((self.dir / "o.csv").exists())

    def test_a_batch_repeats_a_job_with_changed_attributes(self):
        self.colored()
        for attributes, skipped in (('"part"', 0), ('"part"', 1), ('["part", "color"]', 0)):
            job = f'{{"mesh": "colored.ply", "resolution": 20, "fields": {attributes}}}\n'
            (self.dir / "jobs.jsonl").write_text(job)
            done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out", "--resume", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(json.loads(done.stdout)["skipped"], skipped, attributes)
        self.assertEqual(list(grids_of(self.dir / "out" / "colored.vdb")), ["color", "part", "voxels"])


if __name__ == "__main__":
    unittest.main()
