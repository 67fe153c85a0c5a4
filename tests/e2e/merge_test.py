"""latvox merge: the joined file equals that of the whole, by OpenVDB and by latvox info, and needs little memory."""

import json
import pathlib
import resource
import signal
import struct
import subprocess
import tempfile
import time
import unittest

import numpy
import pyopenvdb

import harness
from harness import BIN, BUNNY, Case, latvox, octahedron, rows, write_obj

OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED, STOPPED = range(7)
FAR = 100000
STATISTICS = ("file_bbox_min", "file_bbox_max", "file_mem_bytes", "file_voxel_count", "file_compression")


def slabs(axis, *borders):
    """Regions that together cover everything, cut across an axis."""
    ends = [-FAR, *borders, FAR]
    for low, high in zip(ends, ends[1:]):
        box = [-FAR] * 3 + [FAR] * 3
        box[axis], box[axis + 3] = low, high
        yield ["--region=" + ",".join(map(str, box))]


def shards(count):
    return [["--shard", f"{index}/{count}"] for index in range(count)]


class MergeCase(Case):
    def setUp(self):
        super().setUp()
        self.merged = self.dir / "merged.vdb"

    def parts(self, cuts, *options, extensions=(".vdb",)):
        """Writes the parts, in these formats in turns."""
        paths = []
        with tempfile.TemporaryDirectory() as directory, harness.server(pathlib.Path(directory)) as server:
            for n, cut in enumerate(cuts):
                paths.append(self.dir / f"part{n}{extensions[n % len(extensions)]}")
                self.voxelize(BUNNY, *options, *cut, "--server", server.address, out=paths[-1].name)
        return paths

    def merge(self, *arguments):
        done = latvox("merge", *arguments, "-o", self.merged, "--json")
        self.assertEqual(done.returncode, OK, done.stderr)
        self.assertEqual(done.stderr, "")
        return json.loads(done.stdout)


class Union(MergeCase):
    CUTS = {
        "slabs": [*slabs(0, -40, 3, 64)],  # within bricks, and at a tile's border
        "overlapping slabs": [*slabs(2, 20), *slabs(2, 100)],
        "one part": [[]],
        "one shard": shards(1),
        "shards": shards(7),
        "shards, half of them empty": shards(16),
    }

    def check(self, cuts, *options):
        whole = self.voxelize(BUNNY, *options, out="whole.vdb")
        table = self.voxelize(BUNNY, *options, out="whole.csv")
        self.assertEqual(whole["digest"], table["digest"])
        parts = self.parts(cuts, *options)
        summary = self.merge(*parts)
        self.assertEqual(
            (summary["digest"], summary["voxels"], summary["bricks"], summary["parts"]),
            (whole["digest"], whole["voxels"], whole["bricks"], len(parts)),
        )
        larger = self.merged.stat().st_size - (self.dir / "whole.vdb").stat().st_size
        regions = [word.partition("=")[2] for cut in cuts for word in cut if word.startswith("--region=")]
        self.assertEqual(larger, 0 if not regions else len("latvox_region" + "string" + "; ".join(regions)) + 3 * 4)
        self.check_info(shards="--shard" in cuts[0])
        self.check_grids(rows(self.dir / "whole.csv"))

    def check_info(self, shards):
        """latvox info reports the same, except for facts that are unknown for a union that may lack regions."""
        lines = [latvox("info", path).stdout.splitlines() for path in (self.dir / "whole.vdb", self.merged)]
        self.assertGreater(len(lines[0]), 20)
        differ = {line.partition(" = ")[0] for line in set(lines[0]) ^ set(lines[1])}
        self.assertLessEqual(differ, set() if shards else {"latvox_minimal", "latvox_region"}, differ)

    def check_grids(self, voxels):
        (whole,), _ = pyopenvdb.readAll(str(self.dir / "whole.vdb"))
        (grid,), _ = pyopenvdb.readAll(str(self.merged))
        self.assertEqual(grid.activeVoxelCount(), len(voxels))
        self.assertEqual(grid.evalActiveVoxelBoundingBox(), whole.evalActiveVoxelBoundingBox())
        self.assertEqual(grid.evalLeafDim(), whole.evalLeafDim())
        self.assertEqual((grid.leafCount(), grid.nonLeafCount()), (whole.leafCount(), whole.nonLeafCount()))
        self.assertEqual(grid.transform, whole.transform)
        for name in STATISTICS:
            self.assertEqual(grid[name], whole[name], name)
        self.assertEqual(grid["file_voxel_count"], len(voxels))
        self.assertEqual(grid["file_bbox_min"], tuple(map(min, zip(*voxels))))
        self.assertEqual(grid["file_bbox_max"], tuple(map(max, zip(*voxels))))
        low = numpy.array(grid["file_bbox_min"])
        values, expected = (numpy.zeros(grid["file_bbox_max"] - low + 1, bool) for _ in range(2))
        grid.copyToArray(values, ijk=grid["file_bbox_min"])
        expected[tuple((numpy.array(list(voxels)) - low).T)] = True
        self.assertTrue(numpy.array_equal(values, expected))

    def test_parts_of_the_bcc_bunny_are_the_whole(self):
        for name, cuts in self.CUTS.items():
            with self.subTest(name):
                self.check(cuts, "--lattice", "bcc", "--resolution", "100")

    def test_parts_of_the_cartesian_bunny_are_the_whole(self):
        for name in ("slabs", "overlapping slabs", "shards"):
            with self.subTest(name):
                self.check(self.CUTS[name], "--lattice", "cartesian", "--separability", "2", "--resolution", "130")

    def test_parts_of_both_formats_are_the_whole_byte_for_byte(self):
        options = ["--lattice", "bcc", "--resolution", "100"]
        self.voxelize(BUNNY, *options, out="whole.vdb")
        for extensions in ([".nvdb"], [".vdb", ".nvdb"]):
            self.merge(*self.parts(shards(7), *options, extensions=extensions))
            self.assertEqual(self.merged.read_bytes(), (self.dir / "whole.vdb").read_bytes(), extensions)

    def test_parts_of_a_solid_with_tiles_are_the_whole_byte_for_byte(self):
        options = ["--set", "solid", "--resolution", "200"]
        summary = self.voxelize(BUNNY, *options, out="whole.vdb")
        (grid,), _ = pyopenvdb.readAll(str(self.dir / "whole.vdb"))
        self.assertLess(grid.leafCount(), summary["bricks"] * 3 / 4)
        self.assertEqual(grid.activeVoxelCount(), summary["voxels"])
        for extensions in ([".vdb"], [".vdb", ".nvdb"]):
            self.merge(*self.parts(shards(5), *options, extensions=extensions))
            self.assertEqual(self.merged.read_bytes(), (self.dir / "whole.vdb").read_bytes(), extensions)
        self.voxelize(BUNNY, *options, out="whole.csv")
        for source in "whole.vdb", "part1.nvdb":
            self.assertEqual(latvox("convert", self.dir / source, "-o", self.dir / "again.csv").returncode, OK)
            again, whole = (sorted((self.dir / name).read_bytes().splitlines()) for name in ("again.csv", "whole.csv"))
            self.assertEqual(again == whole, source == "whole.vdb")
        for words in ["compare", self.dir / "whole.vdb", self.merged], ["info", self.merged]:
            self.assertEqual(latvox(*words).returncode, OK, words)
        done = latvox("slice", self.dir / "whole.vdb", "-o", self.dir / "slice.png")
        self.assertEqual(done.returncode, OK, done.stderr)

    def test_merging_may_go_on_from_merged_files(self):
        options = ["--lattice", "bcc", "--resolution", "100"]
        a, b, c = self.parts(slabs(1, 0, 50), *options)
        whole = self.voxelize(BUNNY, *options, out="whole.vdb")
        self.merge(a, b)
        self.merged.rename(self.dir / "ab.vdb")
        self.assertEqual(self.merge(self.dir / "ab.vdb", c)["digest"], whole["digest"])

    def test_empty_parts_merge_to_an_empty_grid(self):
        cuts = [["--region", f"{FAR},0,0,{FAR + n},9,9"] for n in (1, 2)]
        for extension in (".vdb", ".nvdb"):
            paths = self.parts(cuts, "--lattice", "bcc", "--resolution", "16", extensions=[extension])
            self.assertEqual(self.merge(*paths)["voxels"], 0)
            (grid,), _ = pyopenvdb.readAll(str(self.merged))
            self.assertTrue(grid.empty())
        part = bytearray(paths[0].read_bytes())
        struct.pack_into("<q", part, 16 + 176 + len("voxels") + 1 + 672, 1 << 62)  # where its leaves begin; it has none
        paths[0].write_bytes(part)
        self.assertEqual(self.merge(*paths)["voxels"], 0)

    def test_memory_does_not_grow_with_the_bricks(self):
        for extension in (".vdb", ".nvdb"):
            peaks, sizes = [], []
            for resolution in ("256", "2048"):
                options = ["--lattice", "cartesian", "--separability", "2", "--resolution", resolution]
                paths = self.parts(shards(4), *options, extensions=[extension])
                peaks.append(self.peak_memory("merge", *paths, "-o", self.merged))
                sizes.append(self.merged.stat().st_size)
            self.assertGreater(sizes[1], 30e6)
            # At most a few MB of buffers beyond a file with hardly any bricks. Loading everything would take as much as
            # the file.
            self.assertLess(peaks[1], peaks[0] + 8e6, (extension, peaks, sizes))


class Failures(MergeCase):
    OPTIONS = ["--lattice", "bcc", "--resolution", "64"]

    def bad(self, *arguments, code, says, out=None, **options):
        """Checks that the run fails with `code` and one line matching `says`, neither makes nor touches the output, and
        leaves nothing."""
        out = out or self.merged
        for old in (None, b"what was here before"):
            if old:
                out.write_bytes(old)
            before = sorted(self.dir.iterdir())
            done = latvox("merge", *arguments, "-o", out, **options)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertRegex(done.stderr, says)
            self.assertEqual(sorted(self.dir.iterdir()), before)
            if old:
                self.assertEqual(out.read_bytes(), old)
        out.unlink()

    def test_parts_that_do_not_belong_together(self):
        a, b = self.parts(slabs(0, 0), *self.OPTIONS)
        for name, options, says in (
            ("lattice", ["--lattice", "fcc", "--resolution", "64"], "other.vdb: the transform is .*, but .* in .*part0.vdb"),
            ("separability", [*self.OPTIONS, "--separability", "2"], "other.vdb: latvox_separability is 2, but 0 in .*part0.vdb"),
            ("origin", [*self.OPTIONS, "--origin", "0,0,0"], "other.vdb: the transform is .*, but .* in .*part0.vdb"),
            ("algorithm", [*self.OPTIONS, "--algorithm", "incremental"], "latvox_algorithm is incremental, but exact in "),
        ):
            with self.subTest(name):
                self.voxelize(BUNNY, *options, out="other.vdb")
                self.bad(a, b, self.dir / "other.vdb", code=BAD_INPUT, says=says)

    def test_a_part_of_a_rounded_mesh_does_not_belong_to_parts_of_the_mesh(self):
        grid = ["--voxel-size", "0.04", "--origin", "0,0,0"]
        a, b = self.parts(slabs(0, 0), *grid)
        self.voxelize(BUNNY, *grid, "--quantization", "9", out="other.vdb")
        self.bad(a, b, self.dir / "other.vdb", code=BAD_INPUT, says="other.vdb: latvox_(mesh_box|quantization_bits) is ")

    def test_grids_of_two_meshes_are_no_parts_of_one(self):
        grid = ["--voxel-size", "0.04", "--origin", "0,0,0"]
        write_obj(self.dir / "other.obj", octahedron(1))
        for name, mesh in (("a", BUNNY), ("b", self.dir / "other.obj")):
            self.voxelize(mesh, *grid, out=f"{name}.vdb")
        self.bad(self.dir / "a.vdb", self.dir / "b.vdb", code=BAD_INPUT, says="b.vdb: latvox_mesh_.* is .*, but .* in .*a.vdb")

    def test_shards_that_are_missing_or_given_twice(self):
        paths = self.parts(shards(4), *self.OPTIONS)
        self.bad(*paths[:1], *paths[2:], code=BAD_INPUT, says="3 of 4 shards are there; missing 1$")
        self.bad(*paths, paths[2], code=BAD_INPUT, says="part2.vdb")
        self.voxelize(BUNNY, *self.OPTIONS, "--shard", "2/5", out="other.vdb")
        self.bad(*paths[:3], self.dir / "other.vdb", code=BAD_INPUT, says="other.vdb: latvox_shard is 2/5, but 0/4 in .*part0.vdb")

    def test_files_that_are_not_parts(self):
        a, b = self.parts(slabs(0, 0), *self.OPTIONS)
        short = self.dir / "short.vdb"
        short.write_bytes(a.read_bytes()[:-1])
        self.bad(short, b, code=BAD_INPUT, says="short.vdb: is not a whole .vdb file .*cut short: [0-9]+ bytes of [0-9]+")
        self.bad(a, BUNNY, code=BAD_INPUT, says="bunny.obj: is not a whole .vdb or .nvdb file that latvox wrote.*latvox convert")
        self.bad(a, self.dir / "none.vdb", code=BAD_INPUT, says="none.vdb: no such file")
        self.bad(a, a, code=BAD_INPUT, says="part0.vdb: is given twice")
        grid = pyopenvdb.BoolGrid()
        pyopenvdb.write(str(self.dir / "foreign.vdb"), grids=[grid])
        self.bad(a, self.dir / "foreign.vdb", code=BAD_INPUT, says="foreign.vdb: .*no latvox_digest")
        self.bad(self.flipped(a), b, code=BAD_INPUT, says="flipped.vdb: is damaged")
        for option in ("-z", "-b"):
            subprocess.run(["nanovdb_convert", "-f", option, a, self.dir / "packed.nvdb"], capture_output=True, check=True)
            self.bad(self.dir / "packed.nvdb", b, code=BAD_INPUT, says="packed.nvdb: .*it is compressed, .*latvox convert")

    def flipped(self, path):
        """Returns the same file with one voxel more, or less, in its last brick."""
        data = bytearray(path.read_bytes())
        name = b"Tree_bool_5_4_3"
        (leaves,) = struct.unpack_from("<q", data, data.index(name) + len(name) + 4 + 8)
        data[leaves - 64] ^= 1
        flipped = self.dir / "flipped.vdb"
        flipped.write_bytes(data)
        return flipped

    def test_wrong_usage(self):
        (a,) = self.parts([[]], *self.OPTIONS)
        self.bad(code=USAGE, says="(?i)part")
        self.bad(a, "-o", self.dir / "second.vdb", code=USAGE, says="--out: one file")
        self.bad(a, out=self.dir / "out.csv", code=USAGE, says="out.csv.* not one of .vdb; latvox convert")
        before = a.read_bytes()
        done = latvox("merge", a, "-o", a)
        self.assertEqual((done.returncode, a.read_bytes()), (USAGE, before), done.stderr)
        self.assertRegex(done.stderr, "part0.vdb.*itself")

    def test_open_files_are_a_limit_of_the_system(self):
        paths = self.parts(slabs(0, *range(-40, 40, 4)), *self.OPTIONS)

        def limit(hard):
            return lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (18, hard))

        self.bad(*paths, code=REFUSED, says="part.*open files.*ulimit -n", preexec_fn=limit(18))
        done = latvox("merge", *paths, "-o", self.merged, preexec_fn=limit(64))
        self.assertEqual(done.returncode, OK, done.stderr)


class Kill(MergeCase):
    def start(self, paths):
        return subprocess.Popen([BIN / "latvox", "merge", *paths, "-o", self.merged], stdout=subprocess.DEVNULL)

    def test_a_killed_merge_leaves_no_half_of_a_file_and_the_next_one_does_it(self):
        paths = self.parts(shards(3), "--lattice", "cartesian", "--separability", "2", "--resolution", "1024")
        whole = self.merge(*paths)
        begun = time.monotonic()
        self.assertEqual(self.start(paths).wait(60), OK)
        seconds = time.monotonic() - begun
        killed_at_work = 0
        for old in (b"what was here before", None):
            for n in range(12):
                self.merged.unlink(missing_ok=True)
                if old:
                    self.merged.write_bytes(old)
                process = self.start(paths)
                time.sleep(seconds * n / 12)
                at_work = bool(harness.unfinished_files(process.pid, self.dir))
                process.send_signal(signal.SIGKILL)
                if process.wait() == OK:
                    continue
                killed_at_work += at_work
                found = self.merged.read_bytes() if self.merged.exists() else None
                if found != old:  # killed between its last step and its end
                    self.assertIn(whole["digest"], latvox("info", self.merged).stdout)
        self.assertGreater(killed_at_work, 0, "no merge was killed at work")
        self.assertEqual([path for path in self.dir.iterdir() if path.suffix == ".part"], [])
        self.assertEqual(self.merge(*paths)["digest"], whole["digest"])

    def test_an_interrupted_merge_leaves_nothing(self):
        paths = self.parts(shards(3), "--lattice", "cartesian", "--separability", "2", "--resolution", "2048")
        process = self.start(paths)
        while not harness.unfinished_files(process.pid, self.dir):
            self.assertIsNone(process.poll(), "the merge has ended already")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(60), STOPPED)
        self.assertEqual(sorted(self.dir.iterdir()), sorted(paths))


if __name__ == "__main__":
    unittest.main()
