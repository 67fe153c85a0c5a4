"""Programs of others read our files, and find the voxels of the .csv at their positions."""

import csv
import itertools
import json
import struct
import subprocess
import unittest

import numpy
import pyopenvdb

from harness import BUNNY, NODE, PATIENCE, Case, box, by_three, latvox, read_points, rows
from inputs import write_named_obj

BCC = ["--lattice", "bcc", "--resolution", "40"]
CUBES = ["--lattice", "cartesian", "--resolution", "40", "--origin", "0.5,-3,1"]


def run(*words, **options):
    command = list(map(str, words))
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True, **options).stdout


def grid_points(path):
    """Returns the active points of the first grid of a .vdb file, and that grid."""
    grid = pyopenvdb.readAll(str(path))[0][0]
    points = set()
    for item in grid.citerOnValues():
        assert item.value, item.min
        points |= {(i, j, k) for i in range(item.min[0], item.max[0] + 1) for j in range(item.min[1], item.max[1] + 1)
                   for k in range(item.min[2], item.max[2] + 1)}
    return points, grid


def active_values(path, name):
    """Returns lattice point -> value of a grid of a .vdb file."""
    grid = pyopenvdb.read(str(path), name)
    return {item.min: item.value for item in grid.citerOnValues()}


def nano_map(path):
    """Returns the matrix and shift from index to world of a .nvdb file's first grid: GridData's Map in NanoVDB.h."""
    data = path.read_bytes()
    grid = data.index(b"NanoVDB0", 16)  # the second one; the first is that of the file
    name_ends = grid + 40 + 256
    doubles = numpy.frombuffer(data, "<f8", 21, name_ends + 22 * 4)  # behind the same values as floats
    return doubles[:9].reshape(3, 3), doubles[18:]


def nano_text(path):
    """Returns the blind data of a .nvdb file's first grid: name and bytes, by GridData's and GridBlindMetaData's
    layout."""
    data = path.read_bytes()
    grid = data.index(b"NanoVDB0", 16)
    offset, count = struct.unpack_from("<qI", data, grid + 640)
    assert count == 1, count
    blind = grid + offset
    begin, size = struct.unpack_from("<qQ", data, blind)
    return data[blind + 32 :].partition(b"\0")[0], data[blind + begin : blind + begin + size]


def listed(found):
    """vox-reader gives a chunk that occurs once without a list."""
    return found if isinstance(found, list) else [] if found is None else [found]


class Formats(Case):
    def write(self, names, *options):
        """Writes these files in one run. Returns the summary and the .csv's voxels."""
        files = [word for name in ("a.csv", *names) for word in ("-o", self.dir / name)]
        done = latvox("voxelize", BUNNY, *files, "--json", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout), rows(self.dir / "a.csv")

    def by_node(self, script, name):
        """Returns the JSON that a script of node prints from the bytes of a file, `data`."""
        whole = f"const data = require('fs').readFileSync(process.argv[1]); {script}"
        return json.loads(run("node", "-e", whole, self.dir / name, cwd=NODE))

    def test_vdb_print_counts_the_voxels(self):
        summary, _ = self.write(["a.vdb"], *BCC)
        text = run("vdb_print", "-l", self.dir / "a.vdb")
        self.assertRegex(text, rf"\b{summary['voxels']}\b")
        self.assertIn("voxels", text)
        text = run("vdb_print", "-m", self.dir / "a.vdb")
        self.assertIn(summary["digest"], text)

    def test_a_vdb_tells_the_request_which_repeats_it(self):
        """latvox_request is a line of `latvox batch`, without the mesh's path."""
        for n, options in enumerate((
            [*BCC, "--no-minimal"],
            ["--basis", "0.2,0,0.01,0.02,0.25,0,0,0.03,0.3", "--origin", "0.1,-0.2,0.3", "--separability", "1"],
            ["--lattice", "fcc", "--resolution", "9", "--set", "interior", "--rule", "winding"],
            ["--voxel-size", "0.1", "--set", "supercover"],
            ["--voxel-size", "0.1", "--band", "2v", "--signed"],
            ["--resolution", "20", "--algorithm", "incremental", "--verify"],
            ["--voxel-size", "0.2", "--up-axis", "z", "--scale", "2", "--quantization", "14", "--input-format", "obj"],
            ["--voxel-size", "0.1", "--up-axis", "y", "--scale", "0.3", "--quantization", "0", "--band", "2v"],
            ["--voxel-size", "0.1", "--set", "solid", "--labels", "part", "--force-open", "--fields", "part,distance"],
            ["--voxel-size", "0.1", "--set", "enclosed", "--close", "0.3", "--fields", "normal,triangle"],
            ["--voxel-size", "0.1", "--set", "region", "--seed", "0,0,0", "--allow-outside", "--fields", "point"],
            ["--voxel-size", "0.1", "--set", "links", "--side", "both", "--fields", "links,link_crossings"],
            ["--voxel-size", "0.1", "--set", "links", "--side", "both", "--separability", "2", "--fields", "triangle"],
            ["--voxel-size", "0.1", "--set", "solid", "--force-open", "--separability", "1", "--fields", "links"],
            ["--voxel-size", "0.1", "--set", "interior", "--force-open", "--separability", "1", "--fields", "links"],
            ["--voxel-size", "0.1", "--band", "2v", "--separability", "2", "--fields", "distance,links"],
        )):
            with self.subTest(options):
                summary = self.voxelize(BUNNY, *options, out=f"{n}.vdb")
                name = "distance" if "--band" in options else "voxels"
                grid = pyopenvdb.readGridMetadata(str(self.dir / f"{n}.vdb"), name)
                request = json.loads(grid["latvox_request"])
                for option in {"--up-axis", "--scale", "--quantization", "--input-format"} & set(options):
                    told = str(request[option[2:].replace("-", "_")])
                    self.assertEqual(told.removesuffix(".0"), options[options.index(option) + 1])
                line = {"mesh": str(BUNNY), "out": f"again{n}.vdb"} | request
                (self.dir / "jobs.jsonl").write_text(json.dumps(line) + "\n")
                done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / f"out{n}")
                self.assertEqual(done.returncode, 0, done.stderr)
                again = pyopenvdb.readGridMetadata(str(self.dir / f"out{n}" / f"again{n}.vdb"), name)
                self.assertEqual(again["latvox_digest"], summary["digest"])
                for field, about in summary.get("fields", {}).items():
                    self.assertEqual(again[f"latvox_{field}_digest"], about["digest"])
                self.assertEqual(again["latvox_request"], grid["latvox_request"])

    def test_a_vdb_tells_which_part_it_is(self):
        self.write(["a.vdb"], *BCC, "--region=-3,-4,-5,6,7,8", "--bounds=-1,-1,-1,0.5,1,1")
        (grid,), _ = pyopenvdb.readAll(str(self.dir / "a.vdb"))
        self.assertEqual(grid["latvox_region"], "-3,-4,-5,6,7,8")
        self.assertEqual([float(x) for x in grid["latvox_bounds"].split(",")], [-1, -1, -1, 0.5, 1, 1])
        self.assertNotIn("region", grid["latvox_request"])

    def test_info_tells_what_a_vdb_holds(self):
        summary, voxels = self.write(["a.vdb"], *BCC)
        done = latvox("info", self.dir / "a.vdb")
        self.assertEqual(done.returncode, 0, done.stderr)
        low, above = (",".join(str(f(v[m] for v in voxels) + add) for m in range(3)) for f, add in ((min, 0), (max, 1)))
        for line in (f"active voxels  {summary['voxels']}", f"active box     {low} to below {above}",
                     f"latvox_digest = {summary['digest']}", "latvox_lattice = bcc", "grid           voxels (bool)"):
            self.assertIn(line + "\n", done.stdout)
        error = summary["certificate"]["snap_error_max"]
        self.assertIn(f"latvox_snap_error_max = {error}\n", done.stdout)
        told = json.loads(latvox("info", "--json", self.dir / "a.vdb").stdout)
        same = "voxels", "index_box", "basis", "origin", "voxel_size"
        box = {"min": [int(x) for x in low.split(",")], "max": [int(x) for x in above.split(",")]}
        self.assertEqual([told[name] for name in same], [(summary | {"index_box": box})[name] for name in same])
        self.assertEqual(told["grid"], {"name": "voxels", "type": "bool"})
        self.assertEqual(told["metadata"]["latvox_digest"], summary["digest"])

    def test_nanovdb_finds_its_file_valid_and_gives_the_grid_back(self):
        for options in (BCC, ["--basis", "0.2,0,0.01,0.02,0.25,0,0,0.03,0.3", "--origin", "0.1,-0.2,0.3"]):
            with self.subTest(options):
                summary, voxels = self.write(["a.nvdb"], *options)
                self.assertIn("pass", run("nanovdb_validate", "-v", self.dir / "a.nvdb").lower())
                self.assertRegex(run("nanovdb_print", self.dir / "a.nvdb"), rf"voxels .*\b{summary['voxels']}\b")
                run("nanovdb_convert", "-f", self.dir / "a.nvdb", self.dir / "back.vdb")
                points, grid = grid_points(self.dir / "back.vdb")
                self.assertEqual(points, set(voxels))
                self.assertEqual(grid.name, "voxels")
                # nanovdb_convert transposes the matrix on the way back to OpenVDB. NanoVDB's own map has it unchanged.
                matrix, shift = nano_map(self.dir / "a.nvdb")
                for ijk, position in voxels.items():
                    for seen, written in zip(matrix @ ijk + shift, position):
                        self.assertAlmostEqual(seen, written, places=12)

    def test_nanovdb_has_the_metadata_as_blind_data(self):
        summary, _ = self.write(["a.nvdb", "a.vdb"], *BCC)
        name, text = nano_text(self.dir / "a.nvdb")
        self.assertEqual(name, b"latvox")
        info = latvox("info", self.dir / "a.vdb").stdout.splitlines()
        self.assertEqual(text.decode().splitlines(), [line for line in info if line.startswith("latvox_")])
        self.assertIn(f"latvox_digest = {summary['digest']}\n", text.decode())

    def test_nanovdb_holds_fields_and_bands(self):
        """NanoVDB's own converter gives OpenVDB's grids, with the values of our .vdb."""
        for options, grids, floats in (
            ([*BCC, "--fields", "triangle,distance,normal"], ["voxels", "triangle", "distance", "normal"], ["distance", "normal"]),
            (["--resolution", "32", "--band", "3v", "--signed"], ["distance"], ["distance"]),
        ):
            with self.subTest(grids=grids):
                files = [word for name in ("a.nvdb", "a.vdb") for word in ("-o", self.dir / name)]
                summary = json.loads(latvox("voxelize", BUNNY, *files, "--json", *options).stdout)
                self.assertIn("pass", run("nanovdb_validate", "-v", self.dir / "a.nvdb").lower())
                listed = run("nanovdb_print", self.dir / "a.nvdb")
                for grid in grids:
                    self.assertRegex(listed, rf"\b{grid}\b.*\b{summary['voxels']}\b")
                run("nanovdb_convert", "-f", self.dir / "a.nvdb", self.dir / "back.vdb")
                for grid in floats:  # pyopenvdb reads no grids of int32
                    wanted, found = (active_values(self.dir / name, grid) for name in ("a.vdb", "back.vdb"))
                    self.assertEqual(len(wanted), summary["voxels"])
                    self.assertEqual(found, wanted)
                level_set = pyopenvdb.readGridMetadata(str(self.dir / "back.vdb"), "distance")["class"] == "level set"
                self.assertEqual(level_set, grids == ["distance"])

    def test_numpy_reads_coordinates_and_boxes(self):
        for options in (BCC, CUBES, [*BCC, "--region", "3,4,5,17,30,9"]):
            with self.subTest(options):
                _, voxels = self.write(["a.npy"], *options)
                array = numpy.load(self.dir / "a.npy")
                self.assertEqual((array.dtype, array.shape), (numpy.int32, (len(voxels), 3)))
                self.assertEqual(set(map(tuple, array.tolist())), set(voxels))
                table = numpy.genfromtxt(self.dir / "a.csv", delimiter=",", names=True)
                self.assertEqual(list(zip(table["x"], table["y"], table["z"])), list(voxels.values()))
                summary, _ = self.write(["a.npy"], *options, "--npy", "dense")
                low, high = summary["index_box"]["min"], summary["index_box"]["max"]
                dense = numpy.load(self.dir / "a.npy")
                self.assertEqual((dense.dtype, dense.shape), (numpy.uint8, tuple(h - l for l, h in zip(low, high))))
                self.assertEqual({tuple(p) for p in (numpy.argwhere(dense == 1) + low).tolist()}, set(voxels))
                self.assertEqual(int(dense.sum()), len(voxels))

    def test_a_box_without_a_voxel_is_an_empty_array(self):
        self.write(["a.npy"], "--resolution", 20, "--region", "1000,0,0,1001,1,1", "--npy", "dense")
        self.assertEqual(int(numpy.load(self.dir / "a.npy").sum()), 0)

    def test_a_box_that_is_too_large_is_refused_before_anything_is_done(self):
        done = latvox("voxelize", BUNNY, "-o", self.dir / "a.npy", "--npy", "dense", "--resolution", 3000)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertRegex(done.stderr, r"a.npy: .* \d+ x \d+ x \d+ elements exceeds 4294967296 bytes; request less with --region")
        self.assertEqual(list(self.dir.iterdir()), [])

    def test_meshio_reads_the_points(self):
        _, voxels = self.write(["a.ply"], *BCC)
        self.assertEqual({tuple(ijk): tuple(xyz) for xyz, *ijk in read_points(self.dir / "a.ply", *"ijk")}, voxels)

    def test_three_reads_the_surface(self):
        """Its corners are those of the facets between voxels and empty points. On BCC all are at the cell's outer
        radius from a center."""
        summary, voxels = self.write(["a.glb"], *CUBES)
        found = by_three(self.dir / "a.glb")
        half, origin = summary["basis"][0] / 2, summary["origin"]
        facets = [(v, m, sign) for v in voxels for m in range(3) for sign in (-1, 1)
                  if (*v[:m], v[m] + sign, *v[m + 1 :]) not in voxels]  # fmt: skip
        self.assertEqual(found["triangles"], 2 * len(facets))
        corners = {tuple(2 * x + (sign if n == m else side) for n, (x, side) in enumerate(zip(v, sides)))
                   for v, m, sign in facets for sides in itertools.product((-1, 1), repeat=3)}  # fmt: skip
        places = [[(x - o) / half for x, o in zip(corner, origin)] for corner in found["corners"]]
        self.assertLess(max(abs(x - round(x)) for place in places for x in place), 1e-3)
        self.assertEqual({tuple(map(round, place)) for place in places}, corners)
        summary, voxels = self.write(["a.glb"], "--lattice", "bcc", "--resolution", "16")
        centers, radius = numpy.array(list(voxels.values())), summary["basis"][0] * 5**0.5 / 4
        for corner in by_three(self.dir / "a.glb")["corners"]:
            self.assertAlmostEqual(numpy.linalg.norm(centers - corner, axis=1).min() / radius, 1, places=4)

    def test_readers_from_npm_find_the_cubes(self):
        summary, voxels = self.write(["a.binvox", "a.vox"], *CUBES)
        size, low = summary["basis"][0], [min(v[m] for v in voxels) for m in range(3)]
        found = self.by_node("const b = new (require('binvox').Parser)().parse(new Uint8Array(data).buffer);"
                             "console.log(JSON.stringify(b))", "a.binvox")
        cells = {(v["x"], v["y"], v["z"]) for v in found["voxels"]}
        self.assertEqual(cells, {tuple(x - l for x, l in zip(v, low)) for v in voxels})
        depth = found["dimension"]["depth"]
        self.assertAlmostEqual(found["scale"] / depth, size, places=12)
        corner = [voxels[min(voxels)][m] + (low[m] - min(voxels)[m]) * size - size / 2 for m in range(3)]
        for seen, wanted in zip((found["translate"][n] for n in ("depth", "width", "height")), corner):
            self.assertAlmostEqual(seen, wanted, places=9)
        models, palette = self.scene("a.vox")
        self.assertEqual(models, [((0, 0, 0), {c: 1 for c in cells})])
        self.assertIsNone(palette)

    def scene(self, name):
        """Returns the models of a .vox file and its palette: the place of a model's middle, and the color number of each
        voxel."""
        found = self.by_node("console.log(JSON.stringify(require('vox-reader')(data)))", name)
        shapes = {node["nodeId"]: node["models"][0][0] for node in listed(found.get("nshp"))}
        places = {0: (0, 0, 0)}
        for node in listed(found.get("ntrn")):
            if node["child"] in shapes:
                places[shapes[node["child"]]] = tuple(map(int, node["frames"][0]["_t"].split()))
        cells = [{(v["x"], v["y"], v["z"]): v["i"] for v in model["values"]} for model in listed(found["xyzi"])]
        sizes = [(size["x"], size["y"], size["z"]) for size in listed(found["size"])]
        for size, model in zip(sizes, cells, strict=True):
            self.assertEqual(size, tuple(max(v[m] for v in model) + 1 for m in range(3)))
        models = [(tuple(p - s // 2 for p, s in zip(places[n], sizes[n])) if len(sizes) > 1 else places[n], model)
                  for n, model in enumerate(cells)]  # fmt: skip
        return models, found.get("rgba")

    def test_a_reader_from_npm_finds_a_scene_of_models_in_colors(self):
        mesh = write_named_obj(self.dir / "two.obj", [("left", "a"), ("right", "b")])
        grid = ["--voxel-size", "0.05", "--separability", "2", "--fields", "material"]
        done = latvox("voxelize", mesh, "-o", self.dir / "a.vox", "-o", self.dir / "a.csv", *grid)
        self.assertEqual(done.returncode, 0, done.stderr)
        models, palette = self.scene("a.vox")
        self.assertGreater(len(models), 2)
        found = {}
        for low, model in models:
            self.assertLessEqual(max(max(v) for v in model), 255)
            found |= {tuple(l + x for l, x in zip(low, v)): number for v, number in model.items()}
        self.assertEqual(len(found), sum(len(model) for _, model in models))
        with open(self.dir / "a.csv", encoding="utf-8") as file:
            expected = {tuple(int(row[c]) for c in "ijk"): int(row["material"]) for row in csv.DictReader(file)}
        shift = [min(v[m] for v in found) - min(v[m] for v in expected) for m in range(3)]
        materials = {tuple(x + s for x, s in zip(v, shift)): material for v, material in expected.items()}
        self.assertEqual(found.keys(), materials.keys())
        colors = {}
        for v, number in found.items():
            color = palette["values"][number - 1]
            colors.setdefault(materials[v], set()).add((color["r"], color["g"], color["b"], color["a"]))
        self.assertEqual(colors, {0: {(0xE6, 0x9F, 0, 0xFF)}, 1: {(0x56, 0xB4, 0xE9, 0xFF)}})
        self.assertEqual(min(v[2] for v in found), 0)
        info = json.loads(latvox("info", self.dir / "a.vox", "--json").stdout)
        self.assertEqual((info["voxels"], info["models"]), (len(found), len(models)))

    def labeled(self, field, count, *options):
        """Writes boxes that are each another part or material. Returns the done call, and for each number of a.csv the
        numbers of the palette in a.vox."""
        mesh, lines, first = self.dir / "m.obj", [], 1
        for n in range(count):
            vertices, triangles = box((3 * n, 0, 0), (3 * n + 2, 2, 2))
            lines += [f"o part{n}", f"usemtl material{n}", *(f"v {x} {y} {z}" for x, y, z in vertices)]
            lines += [f"f {a + first} {b + first} {c + first}" for a, b, c in triangles]
            first += len(vertices)
        mesh.write_text("\n".join(lines))
        done = latvox("voxelize", mesh, "-o", self.dir / "a.vox", "-o", self.dir / "a.csv", "--voxel-size", "1", "--separability", "2",
                      "--fields", field, "--json", *options)  # fmt: skip
        if done.returncode != 0:
            return done, {}
        models, palette = self.scene("a.vox")
        found = {tuple(l + x for l, x in zip(low, v)): number for low, model in models for v, number in model.items()}
        with open(self.dir / "a.csv", encoding="utf-8") as file:
            expected = {tuple(int(row[c]) for c in "ijk"): int(row[field]) for row in csv.DictReader(file)}
        shift = [min(v[m] for v in found) - min(v[m] for v in expected) for m in range(3)]
        numbers = {}
        for v, label in expected.items():
            numbers.setdefault(label, set()).add(found[tuple(x + s for x, s in zip(v, shift))])
        self.assertEqual(len(numbers), count)
        return done, numbers

    def test_a_palette_keeps_parts_and_materials_apart(self):
        for field, count in (("part", 13), ("material", 255)):
            done, numbers = self.labeled(field, count, "--strict")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(numbers, {n: {n + 1} for n in range(count)})

    def test_a_palette_that_is_too_small_is_a_warning(self):
        done, numbers = self.labeled("material", 256)
        self.assertEqual(set.union(*numbers.values()), {*range(1, 13)})
        (warning,) = json.loads(done.stdout)["warnings"]
        path = str(self.dir / "a.vox")
        self.assertEqual((warning["code"], warning["element"]), ("COLORS_MERGED", path))
        self.assertEqual(warning["message"], f"{path}: has 12 colors for the 256 materials of the voxels, so it does not tell all of them apart")
        self.assertIn(warning["message"], done.stderr)
        (self.dir / "a.vox").unlink()
        done, _ = self.labeled("material", 256, "--strict")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("COLORS_MERGED", done.stderr)
        self.assertFalse((self.dir / "a.vox").exists())

    def test_imagemagick_sees_the_picture(self):
        self.write(["a.png"], *BCC)
        width, height, depth, colors = run("identify", "-format", "%w %h %z %k", self.dir / "a.png").split()
        self.assertGreater(min(int(width), int(height)), 100)
        self.assertEqual(depth, "8")
        self.assertGreater(int(colors), 16, "the picture is not shaded")


if __name__ == "__main__":
    unittest.main()
