"""Attributes of voxels: compared with all triangles, read back from every format, in parts, and from other encoders."""

import json
import random
import re
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


def table(csv, columns):
    """Returns the numbers of each voxel, without the names that follow."""
    lines = csv.read_text().splitlines()
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


class Attributes(Case):
    def colored(self):
        return write_colored_ply(self.dir / "colored.ply", *mountains())

    def test_colors_are_those_of_the_nearest_corner_of_the_nearest_triangle(self):
        vertices, colors, triangles = mountains()
        corners = numpy.array([[vertices[v] for v in t] for t in triangles])
        for options in (["--no-minimal"], ["--lattice", "bcc"], ["--cover", "supercover"]):
            with self.subTest(options):
                summary = self.voxelize(self.colored(), *GRID, "--attributes", "color", *options)
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

    def test_two_boxes_are_two_parts_in_every_format(self):
        outs = ["o.vdb", "o.csv", "o.npy", "o.ply"]
        for n in range(2):
            vertices, triangles = octahedron(8.0)
            write_obj(self.dir / f"{n}.obj", ([(x + 30 * n, y, z) for x, y, z in vertices], triangles))
        done = latvox("voxelize", self.dir / "0.obj", self.dir / "1.obj", "--json", "--attributes", "part", *GRID,
                      *(word for name in outs for word in ("-o", self.dir / name)))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads(done.stdout)
        voxels = table(self.dir / "o.csv", "part")
        self.assertEqual(len(voxels), summary["voxels"])
        self.assertEqual({ijk: (int(ijk[0] > 15),) for ijk in voxels}, voxels)
        grid = pyopenvdb.read(str(self.dir / "o.vdb"), "voxels")
        self.assertEqual({item.min for item in grid.iterOnValues()}, set(voxels))
        self.assertEqual(grid["latvox_attributes"], "part")
        self.assertEqual(grid["latvox_attributes_digest"], summary["attributes"]["digest"])
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
        self.assertEqual(merged.returncode, 3, merged.stderr)
        self.assertIn("2 grids", merged.stderr)

    def test_parts_materials_and_colors_of_an_obj_together(self):
        text = ["o left", "usemtl wood"]
        for n, material in enumerate(("wood", "iron", "wood")):
            vertices, triangles = octahedron(4.0)
            text += [f"v {x + 20 * n} {y} {z} {n / 2} 0 1" for x, y, z in vertices]
            text += ["o right"] * (n == 2) + [f"usemtl {material}"]
            text += ["f " + " ".join(str(v + 1 + 6 * n) for v in t) for t in triangles]
        (self.dir / "m.obj").write_text("\n".join(text) + "\n")
        names = ("o.vdb", "o.csv", "o.npy", "o.ply")
        done = latvox("voxelize", self.dir / "m.obj", "--attributes", "material,color,part", *GRID,
                      *(word for name in names for word in ("-o", self.dir / name)))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        voxels = table(self.dir / "o.csv", "material,red,green,blue,part")
        expected = [(0, 0, 0, 255, 0), (1, 128, 0, 255, 0), (0, 255, 0, 255, 1)]
        self.assertEqual({ijk: expected[(ijk[0] + 10) // 20] for ijk in voxels}, voxels)
        grid = pyopenvdb.read(str(self.dir / "o.vdb"), "color")
        found = {item.min: tuple(item.value) for item in grid.iterOnValues()}
        self.assertEqual({ijk: tuple(round(255 * x) for x in color) for ijk, color in found.items()},
                         {ijk: carried[1:4] for ijk, carried in voxels.items()})  # fmt: skip
        # OpenVDB's expressions copy integer grids into the grid of colors.
        expression = "vec3f@color = {float(int@material), float(int@part), -1.0f};"
        subprocess.run(["vdb_ax", "-i", self.dir / "o.vdb", "-o", self.dir / "ax.vdb", "-s", expression],
                       capture_output=True, timeout=PATIENCE, check=True)  # fmt: skip
        grid = pyopenvdb.read(str(self.dir / "ax.vdb"), "color")
        self.assertEqual({item.min: tuple(item.value) for item in grid.iterOnValues()},
                         {ijk: (carried[0], carried[4], -1) for ijk, carried in voxels.items()})  # fmt: skip
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

    def test_parts_of_the_whole_and_dracos_own_encoder_give_the_same(self):
        mesh = self.colored()
        options = ["--resolution", "100", "--lattice", "fcc", "--quantization", "0", "--attributes", "color"]
        whole = self.voxelize(mesh, *options)
        voxels = table(self.dir / "out.csv", "red,green,blue")
        joined, digest = {}, 0
        for part in ("0/3", "1/3", "2/3"):
            digest += int(self.voxelize(mesh, *options, "--shard", part)["attributes"]["digest"], 16)
            joined |= table(self.dir / "out.csv", "red,green,blue")
        self.assertEqual(joined, voxels)
        self.assertEqual(f"{digest % 2**128:032x}", whole["attributes"]["digest"])
        for method in ("10", "0"):  # edgebreaker, sequential
            encode_drc(self.dir / "mesh.drc", mesh, "-cl", method)
            again = self.voxelize(self.dir / "mesh.drc", *options[:4], "--attributes", "color")
            self.assertEqual(again["attributes"], whole["attributes"])

    def test_a_surface_has_the_colors_of_its_voxels(self):
        self.voxelize(self.colored(), *GRID, "--attributes", "color", out="o.glb")
        data = (self.dir / "o.glb").read_bytes()
        (length,) = struct.unpack_from("<I", data, 12)
        scene, body = json.loads(data[20 : 20 + length]), data[28 + length :]
        accessor = scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
        self.assertEqual(accessor["count"], scene["accessors"][0]["count"])
        start = scene["bufferViews"][accessor["bufferView"]]["byteOffset"]
        found = numpy.frombuffer(body, "u1", 4 * accessor["count"], start).reshape(-1, 4)
        self.voxelize(self.colored(), *GRID, "--attributes", "color")
        voxels = table(self.dir / "out.csv", "red,green,blue")
        self.assertEqual({tuple(c) for c in found.tolist()}, {(*color, 255) for color in voxels.values()})
        info = gltf_info(self.dir / "o.glb")
        self.assertEqual((info["totalVertexCount"], info["maxAttributes"]), (accessor["count"], 2))
        others = by_three(self.dir / "o.glb")["colors"]
        self.assertEqual([tuple(round(255 * x) for x in c) for c in others], [tuple(c[:3]) for c in found.tolist()])

    def test_refusals_name_what_is_wrong(self):
        plain = write_obj(self.dir / "plain.obj", octahedron())
        encode_drc(self.dir / "plain.drc", plain)
        for status, says, words in (
            (3, "plain.obj: the mesh, or some of it, has no color", [plain, "--attributes", "part,color"]),
            (3, "colored.ply: the mesh, or some of it, has no material", [self.colored(), plain, "--attributes", "material"]),
            (3, "attributes: the mesh has no color", [self.dir / "plain.drc", "--attributes", "color"]),
            (2, "not together with fill.mode solid", [plain, "--attributes", "part", "--fill", "solid"]),
            (2, "not together with band", [plain, "--attributes", "part", "--band", "1"]),
            (2, "not together with algorithm brute-force", [plain, "--attributes", "part", "--algorithm", "brute-force"]),
            (2, '"hue" is not one of part, material, color', [plain, "--attributes", "part,hue"]),
            (2, "twice", [plain, "--attributes", "part,part"]),
            (2, "o.glb cannot hold part", [plain, "--attributes", "part", "-o", self.dir / "o.glb"]),
            (2, "--npy dense", [plain, "--attributes", "part", "--npy", "dense", "-o", self.dir / "o.npy"]),
            (3, "sent as it is", [self.dir / "plain.drc", plain, "--attributes", "color"]),
            (2, "o.nvdb cannot hold color", [plain, "--attributes", "color", "-o", self.dir / "o.nvdb"]),
        ):
            with self.subTest(says):
                done = latvox("voxelize", *words, "--resolution", "20", "-o", self.dir / "o.csv")
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(says, done.stderr)
                self.assertFalse((self.dir / "o.csv").exists())

    def test_a_batch_repeats_a_job_with_changed_attributes(self):
        self.colored()
        for attributes, skipped in (('"part"', 0), ('"part"', 1), ('["part", "color"]', 0)):
            job = f'{{"mesh": "colored.ply", "resolution": 20, "attributes": {attributes}}}\n'
            (self.dir / "jobs.jsonl").write_text(job)
            done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out", "--resume", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(json.loads(done.stdout)["skipped"], skipped, attributes)
        self.assertEqual(list(grids_of(self.dir / "out" / "colored.vdb")), ["color", "part", "voxels"])


if __name__ == "__main__":
    unittest.main()
