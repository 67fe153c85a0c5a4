"""`latvox convert` writes grids, pictures and pages as `latvox voxelize` does, from OpenVDB's and NanoVDB's files."""

import contextlib
import json
import os
import pathlib
import random
import signal
import struct
import subprocess
import time
import unittest

import pyopenvdb

from bodies import BODIES, write_bodies
from harness import BIN, BUNNY, PATIENCE, Case, await_true, box, bytes_written, latvox

DOCS = pathlib.Path(__file__).resolve().parents[2] / "client/docs/voxel-files.md"
SPIDER = "/usr/share/assimp/models/OBJ/spider.obj"  # of assimp-testmodels
FIELDS = "part,material,color,distance,triangle,point,normal"
JOBS = {
    "plain": [BUNNY, "--lattice", "bcc", "--resolution", "40", "--scale", "3.1"],
    "skewed": [BUNNY, "--basis", "0.1,0,0.01,0.02,0.12,0,0,0.03,0.15", "--origin", "0.5,-3,1", "--no-minimal"],
    "fields": [SPIDER, "--lattice", "fcc", "--resolution", "24", "--fields", FIELDS],
    "fractions": [BUNNY, "--resolution", "16", "--set", "solid", "--fields", "fraction:4"],
    "level set": [BUNNY, "--resolution", "32", "--band", "3v", "--signed", "--up-axis", "x"],
    "thin band": [BUNNY, "--lattice", "hexagonal", "--resolution", "24", "--band", "0.01"],
    "part of a band": [BUNNY, "--resolution", "32", "--band", "3v", "--signed", "--shard", "1/3"],
    "band with fields": [BUNNY, "--resolution", "32", "--band", "2v", "--fields", "distance,normal"],
    "nothing": [BUNNY, "--resolution", "32", "--region", "900,0,0,901,1,1"],
}


class Convert(Case):
    def write(self, job, *names):
        return self.voxelize(*job, *(word for name in names[1:] for word in ("-o", self.dir / name)), out=names[0])

    def convert(self, name, *outputs, options=()):
        words = [word for output in outputs for word in ("-o", self.dir / output)]
        done = latvox("convert", self.dir / name, *words, *options)
        self.assertEqual(done.returncode, 0, done.stderr)

    def equal(self, a, b, msg=None):
        """Compares bytes, without printing them."""
        self.assertTrue((self.dir / a).read_bytes() == (self.dir / b).read_bytes(), f"{a} is not {b}: {msg}")

    def info(self, name):
        return json.loads(latvox("info", "--json", self.dir / name).stdout)

    def test_grids_are_those_of_voxelize_byte_for_byte(self):
        (self.dir / "again").mkdir()
        for name, job in JOBS.items():
            with self.subTest(name):
                summary = self.write(job, "a.vdb", "a.nvdb")
                for source in ("a.vdb", "a.nvdb"):
                    self.convert(source, "again/a.vdb", "again/a.nvdb")
                    self.equal("again/a.vdb", "a.vdb", source)
                    self.equal("again/a.nvdb", "a.nvdb", source)
                self.assertEqual(self.info("again/a.vdb")["metadata"]["latvox_digest"], summary["digest"])
                self.assertEqual(latvox("compare", self.dir / "a.vdb", self.dir / "again/a.nvdb").stdout.splitlines()[-1], "equal")

    def test_an_interrupt_ends_the_writing_of_a_file(self):
        """It comes when an eighth is written, and what follows is less than the rest. On many cores, the file may be
        complete before the first look at it, so one core writes it."""
        self.write([BUNNY, "--resolution", "400"], "a.vdb")
        self.convert("a.vdb", "a.cells.vtu")
        size = (self.dir / "a.cells.vtu").stat().st_size
        words = [BIN / "latvox", "convert", self.dir / "a.vdb", "-o", self.dir / "b.cells.vtu"]
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                   preexec_fn=lambda: os.sched_setaffinity(0, [min(os.sched_getaffinity(0))]))  # fmt: skip
        self.addCleanup(process.kill)
        await_true("an eighth is written", lambda: bytes_written(process.pid) > size / 8)
        process.send_signal(signal.SIGINT)
        written = 0
        while process.poll() is None:
            with contextlib.suppress(OSError, TypeError):  # it ends
                written = bytes_written(process.pid)
            time.sleep(0.005)
        self.assertLess(written, size * 3 / 4)
        self.assertEqual((process.wait(), process.communicate()[1]), (6, "latvox: cancelled\n"))
        self.assertFalse((self.dir / "b.cells.vtu").exists())

    def test_pictures_and_pages_are_those_of_voxelize(self):
        (self.dir / "again").mkdir()
        for name in ("plain", "fields", "level set", "band with fields"):
            with self.subTest(name):
                self.write(JOBS[name], "a.vdb", "a.nvdb", "a.png", "a.html")
                for source in ("a.vdb", "a.nvdb"):
                    self.convert(source, "again/a.png", "again/a.html")
                    self.equal("again/a.png", "a.png", source)
                    self.equal("again/a.html", "a.html", source)
        job = [*JOBS["fields"][:-1], "color"]
        self.write(job, "a.vdb", "a.glb")
        self.convert("a.vdb", "again/a.glb")
        self.assertEqual(self.info("again/a.glb"), self.info("a.glb"))  # its triangles have another order

    def test_other_commands_read_both(self):
        self.write(JOBS["fields"], "a.vdb", "a.nvdb")
        for command, output in ("render", "png"), ("slice", "csv"), ("view", "html"):
            options = ["--axis", "k", "--index", "5"] if command == "slice" else []
            for source in ("vdb", "nvdb"):
                done = latvox(command, self.dir / f"a.{source}", "-o", self.dir / f"{source}.{output}", *options)
                self.assertEqual(done.returncode, 0, done.stderr)
            pages = [(self.dir / f"{source}.{output}").read_bytes().replace(b"a.nvdb", b"a.vdb") for source in ("vdb", "nvdb")]
            self.assertTrue(pages[0] == pages[1], command)

    def test_a_mesh_is_aligned_to_both(self):
        self.write(JOBS["skewed"], "a.vdb", "a.nvdb")
        for source in ("vdb", "nvdb"):
            self.voxelize(BUNNY, "--align", self.dir / f"a.{source}", out=f"{source}.csv")
        self.equal("vdb.csv", "nvdb.csv")

    def test_some_fields_keep_their_metadata(self):
        self.write(JOBS["fields"], "a.vdb")
        whole = self.info("a.vdb")["metadata"]
        for fields, names in ("part,color", {"part", "color"}), ("none", set()):
            self.convert("a.vdb", "b.nvdb", options=["--fields", fields])
            metadata = self.info("b.nvdb")["metadata"]
            self.assertEqual(metadata.pop("latvox_fields", "none"), fields)
            kept = {name: value for name, value in whole.items() if name.startswith("latvox_") and name != "latvox_fields"}
            for field in set(FIELDS.split(",")) - names:
                for suffix in ("digest", "names"):
                    kept.pop(f"latvox_{field}_{suffix}", None)
            if "distance" not in names:
                kept.pop("latvox_signed_distance")
            self.assertEqual(metadata, kept)
        self.convert("b.nvdb", "c.csv")
        self.assertEqual((self.dir / "c.csv").read_text().splitlines()[0], "i,j,k,x,y,z")

    def test_fractions_of_labels_keep_the_labels_names(self):
        mesh = write_bodies(self.dir / "boxes.obj", {name: box(*corners) for name, corners in BODIES.items()})
        self.write([mesh, "--set", "solid", "--labels", "part", "--voxel-size", "1", "--fields", "label_fractions:2"], "a.vdb")
        self.convert("a.vdb", "b.vdb", options=["--fields", "label_fractions"])
        metadata = self.info("b.vdb")["metadata"]
        self.assertEqual(metadata["latvox_part_names"], self.info("a.vdb")["metadata"]["latvox_part_names"])
        self.assertEqual(metadata["latvox_fraction_n"], "2")
        self.assertNotIn("latvox_part_digest", metadata)
        done = latvox("render", self.dir / "b.vdb", "-o", self.dir / "a.png", "--color-by", "label_fractions",
                      "--label", next(iter(BODIES)))  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        self.convert("a.vdb", "c.vdb", options=["--fields", "part"])
        self.assertNotIn("latvox_fraction_n", self.info("c.vdb")["metadata"])

    def test_one_grid_of_several(self):
        self.write(JOBS["fields"], "a.nvdb")
        data = bytearray((self.dir / "a.nvdb").read_bytes())
        place = data.index(b"NanoVDB", 100)  # of the first grid, behind the headers of all
        data[place + 24 : place + 32] = struct.pack("<II", 1, 2)  # its index, and the number of grids
        (self.dir / "b.nvdb").write_bytes(data)
        self.convert("b.nvdb", "b.csv")
        self.convert("a.nvdb", "a.csv")
        self.equal("a.csv", "b.csv")

    def nano(self, source, target, *options):
        """Writes a .nvdb file by NanoVDB's own converter."""
        subprocess.run(["nanovdb_convert", "-f", *options, self.dir / source, self.dir / target],
                       capture_output=True, timeout=PATIENCE, check=True)  # fmt: skip

    def foreign(self, grid, name):
        """Writes a grid as .vdb by OpenVDB, and as .nvdb by NanoVDB, in each of its codecs."""
        pyopenvdb.write(str(self.dir / f"{name}.vdb"), [grid])
        for extension, options in ("nvdb", []), ("zip.nvdb", ["-z"]), ("blosc.nvdb", ["-b"]):
            self.nano(f"{name}.vdb", f"{name}.{extension}", *options)

    def test_grids_of_other_programs(self):
        solid = pyopenvdb.BoolGrid(False)
        solid.name = "mine"
        solid.fill((-8, -8, -8), (9, 9, 9), True)  # with tiles
        solid.transform = pyopenvdb.createLinearTransform([[2, 0, 0, 0], [0, 3, 0, 0], [1, 0, 4, 0], [5, 6, 7, 1]])
        self.foreign(solid, "solid")
        sphere = pyopenvdb.createLevelSetSphere(radius=5, voxelSize=0.5)
        sphere.name = "distance"
        self.foreign(sphere, "sphere")
        for name, grid in ("solid", solid), ("sphere", sphere):
            for extension in ("vdb", "nvdb", "zip.nvdb", "blosc.nvdb"):
                self.convert(f"{name}.{extension}", f"{extension}.vdb", f"{extension}.csv")
                again = pyopenvdb.readAll(str(self.dir / f"{extension}.vdb"))[0][0]
                self.assertEqual(again.activeVoxelCount(), grid.activeVoxelCount())
                self.assertEqual(again.evalActiveVoxelBoundingBox(), grid.evalActiveVoxelBoundingBox())
                self.assertEqual(again.gridClass, grid.gridClass)
                self.assertEqual([again.transform.indexToWorld(p) for p in ((0, 0, 0), (1, 2, 3))],
                                 [grid.transform.indexToWorld(p) for p in ((0, 0, 0), (1, 2, 3))])  # fmt: skip
                self.equal(f"{extension}.vdb", "vdb.vdb", name)
                self.equal(f"{extension}.csv", "vdb.csv", name)
            facts = [self.info(f"{name}.{extension}") for extension in ("nvdb", "zip.nvdb", "blosc.nvdb")]
            for packed in facts[1:]:
                self.assertEqual({key: packed[key] for key in facts[0] if key != "metadata"},
                                 {key: facts[0][key] for key in facts[0] if key != "metadata"})  # fmt: skip
        values = {v.min: v.value for v in sphere.citerOnValues()}
        self.assertEqual({v.min: v.value for v in again.citerOnValues()}, values)

    def test_rows_are_the_same_in_two_orders(self):
        self.write([BUNNY, "--resolution", "150"], "a.vdb", "a.csv")
        self.convert("a.vdb", "b.csv")
        streamed, sorted_by_brick = ((self.dir / name).read_text().splitlines()[1:] for name in ("a.csv", "b.csv"))
        self.assertEqual(sorted(streamed), sorted(sorted_by_brick))
        self.assertNotEqual(streamed, sorted_by_brick)

        def place(row, bits):
            return [int(n) >> bits for n in row.split(",")[:3]]

        by_brick = sorted(sorted_by_brick, key=lambda row: (place(row, 3), place(row, 0)))
        self.assertEqual(sorted_by_brick, by_brick)
        tiles = [place(row, 6) for row in streamed]
        starts = [n for n, tile in enumerate(tiles) if n == 0 or tile != tiles[n - 1]]
        self.assertGreater(len(starts), 8)
        self.assertEqual(len(starts), len({tuple(tile) for tile in tiles}), "the rows of a cube of bricks are together")
        for start, end in zip(starts, [*starts[1:], len(tiles)]):
            rows = streamed[start:end]
            self.assertEqual(rows, sorted(rows, key=lambda row: (place(row, 3), place(row, 0))))

    def test_the_table_of_the_documentation_is_what_commands_read(self):
        lines = DOCS.read_text().partition("| command | `.vdb` |")[2].splitlines()[2:]
        table = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[: lines.index("")]]
        self.write([BUNNY, "--resolution", "12"], "a.vdb", "a.nvdb", "a.npz")
        self.nano("a.vdb", "packed.nvdb", "-z")
        commands = {
            "info": [],
            "convert": ["-o", self.dir / "b.vdb"],
            "compare": [self.dir / "a.vdb", "--voxels"],
            "render": ["-o", self.dir / "b.png"],
            "slice": ["-o", self.dir / "b.csv"],
            "view": ["-o", self.dir / "b.html"],
            "voxelize --align": ["-o", self.dir / "b.npy", BUNNY],
            "merge": ["-o", self.dir / "b.vdb"],
        }
        named = {command.strip("`"): row[1:] for row in table for command in row[0].split(", ")}
        self.assertEqual(named.keys(), commands.keys())
        for command, options in commands.items():
            for name, answer in zip(("a.vdb", "a.nvdb", "packed.nvdb", "a.npz"), named[command], strict=True):
                done = latvox(*command.split(), self.dir / name, *options)
                self.assertEqual(done.returncode, {"yes": 0, "no": 3}[answer], (command, name, done.stderr))

    def test_files_of_other_machines_are_refused_by_every_command(self):
        url = "https://example.org/a.vdb?signature=secret"
        for words in (["info", url], ["merge", url, "-o", "a.vdb"], ["compare", url, "b.vdb"], ["convert", url, "-o", "a.csv"],
                      ["render", url, "-o", "a.png"], ["slice", url, "-o", "a.png"], ["view", url, "-o", "a.html"]):
            done = latvox(*words)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("https://example.org/a.vdb", done.stderr)
            self.assertIn(" is a URL; download it", done.stderr)
            self.assertNotIn("secret", done.stderr)

    def test_commands_that_read_grids_name_the_one_that_reads_meshes(self):
        self.write([BUNNY, "--resolution", "9"], "a.vdb", "a.npz")
        mesh = self.dir / "mesh.OBJ"
        mesh.write_bytes(pathlib.Path(BUNNY).read_bytes())
        (self.dir / "mesh.vdb").write_bytes(mesh.read_bytes())
        commands = [["convert", "-o", "o.csv"], ["slice", "-o", "o.png"], ["render", "-o", "o.png"], ["view", "-o", "o.html"],
                    ["compare", "a.vdb"], ["voxelize", BUNNY, "-o", "o.vdb", "--align"]]  # fmt: skip
        for command in commands:
            for name, help in (("mesh.OBJ", "; latvox voxelize reads meshes"), ("a.npz", ""), ("mesh.vdb", "")):
                with self.subTest(command[0], file=name):
                    done = latvox(*command, name, cwd=self.dir)
                    self.assertEqual(done.returncode, 3, done.stderr)
                    says = f"{name}: is neither a .vdb nor a .nvdb file, the only ones whose voxels latvox reads{help}\n"
                    self.assertTrue(done.stderr.endswith(says), done.stderr)
        done = latvox("info", "mesh.vdb", cwd=self.dir)
        self.assertIn("mesh.vdb: is neither a .vdb nor a .nvdb file", done.stderr)

    def test_grids_that_cannot_be_read(self):
        density = pyopenvdb.FloatGrid()
        density.name = "density"
        density.fill((0, 0, 0), (3, 3, 3), 1)
        self.foreign(density, "density")
        for extension in ("vdb", "nvdb"):
            done = latvox("convert", self.dir / f"density.{extension}", "-o", self.dir / "a.csv")
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn(f'density.{extension}: the grid "density" is a Tree_float_5_4_3; voxels are read from a bool grid, and distances', done.stderr)
        self.nano("density.vdb", "packed.nvdb", "--fp8")
        done = latvox("convert", self.dir / "packed.nvdb", "-o", self.dir / "a.csv")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('packed.nvdb: is not a readable .nvdb file (the grid "density" is a Float8, neither', done.stderr)

    def test_compressed_grids_that_cannot_be_unpacked(self):
        self.write(JOBS["plain"], "a.vdb")
        for option, says in ("-z", "its ZIP stream does not unpack to"), ("-b", "its BLOSC chunk at byte 0 does not unpack to"):
            self.nano("a.vdb", "packed.nvdb", option)
            whole = (self.dir / "packed.nvdb").read_bytes()
            size = struct.unpack_from("<Q", whole, 16)[0]  # of the grid, behind the file's header
            first = 16 + 176 + len("voxels") + 1  # of the compressed bytes
            for at, value, why in (
                (16, size + 32, f"{says} {size + 32} bytes"),
                (16, 1 << 29, says),
                (16, (1 << 29) + 1, f"are said to unpack to {(1 << 29) + 1}, more than {1 << 29}"),
                (16, (1 << 64) - 1, f"more than {1 << 29}"),
                (24, 7, "a compressed grid is cut short|it goes on with something else"),
                (24, 1 << 63, "it is cut short"),
                (first, 1 << 62, "a compressed grid is cut short"),
                (first + 24, 0, says),
            ):
                with self.subTest(option, at=at, value=value):
                    bad = bytearray(whole)
                    struct.pack_into("<Q", bad, at, value)
                    (self.dir / "bad.nvdb").write_bytes(bad)
                    done = latvox("convert", self.dir / "bad.nvdb", "-o", self.dir / "b.csv")
                    self.assertEqual(done.returncode, 3, done.stderr)
                    self.assertRegex(done.stderr, f"^latvox: .*bad.nvdb: is not a readable .nvdb file .*{why}")

    def test_shards_can_be_merged_after_they_were_converted(self):
        job = [BUNNY, "--resolution", "48", "--fields", "distance"]
        self.write(job, "whole.vdb")
        for n in range(3):
            self.write([*job, "--shard", f"{n}/3"], f"{n}.nvdb")
            self.convert(f"{n}.nvdb", f"{n}.vdb")
        done = latvox("merge", *(self.dir / f"{n}.vdb" for n in range(3)), "-o", self.dir / "joined.vdb")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = latvox("compare", self.dir / "whole.vdb", self.dir / "joined.vdb", "--voxels")
        self.assertEqual(done.stdout.splitlines()[-1], "equal")

    def test_damaged_files_are_errors_or_other_files(self):
        self.write(JOBS["plain"], "a.nvdb", "a.vdb")
        self.nano("a.vdb", "zip.nvdb", "-z")
        self.nano("a.vdb", "blosc.nvdb", "-b")
        for name, count in ("a.nvdb", 30), ("zip.nvdb", 12), ("blosc.nvdb", 12):
            with self.subTest(name):
                self.damage((self.dir / name).read_bytes(), count)

    def damage(self, whole, count):
        chance = random.Random(7)
        for n in range(count):
            bad = bytearray(whole if n % 3 else whole[: chance.randrange(len(whole))])
            if n % 3 and bad:
                bad[chance.randrange(min(len(bad), 4000) if n % 2 else len(bad))] ^= 1 << chance.randrange(8)
            (self.dir / "bad.nvdb").write_bytes(bad)
            done = latvox("convert", self.dir / "bad.nvdb", "-o", self.dir / "b.csv")
            self.assertIn(done.returncode, (0, 3), (n, done.stderr))
            if done.returncode == 3:
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertIn("bad.nvdb: ", done.stderr)
                self.assertFalse((self.dir / "b.csv").exists())
            else:
                (self.dir / "b.csv").unlink()


if __name__ == "__main__":
    unittest.main()
