"""Programs of others read .h5 files: voxels, positions, fields and links are those of the .csv and .npz."""

import json
import random
import re
import resource
import signal
import subprocess
import time
import unittest

import h5py
import numpy

from harness import BIN, BUNNY, Case, latvox

SPIDER = "/usr/share/assimp/models/OBJ/spider.obj"  # of assimp-testmodels
LATTICES = {
    "cartesian": ["--resolution", "24", "--origin", "0.5,-3,1"],
    "stretched": ["--lattice", "bcc", "--voxel-size", "0.05,0.08,0.11"],
    "fcc": ["--lattice", "fcc", "--resolution", "24", "--set", "solid"],
    "hexagonal": ["--lattice", "hexagonal", "--resolution", "24", "--band", "2v", "--signed"],
    "skewed": ["--basis", "0.1,0,0.01,0.02,0.12,0,0,0.03,0.15", "--set", "links"],
}
FIELDS = "part,material,color,distance,triangle,point,normal"
LINKS = {"links": "share", "link_triangles": "triangle", "link_crossings": "crossings"}


def read(path):
    """Returns all arrays by their paths, and the attributes."""
    arrays = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: arrays.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
        return arrays, dict(file.attrs)


class Hdf5(Case):
    def write(self, mesh, *options):
        """Writes a.h5, a.npz, a.npy and a.csv. Returns arrays and attributes of a.h5."""
        outputs = [word for e in ("h5", "npz", "npy") for word in ("-o", self.dir / f"a.{e}")]
        self.summary = self.voxelize(mesh, *outputs, *options, out="a.csv")
        return read(self.dir / "a.h5")

    def test_voxels_of_every_lattice_are_at_their_positions(self):
        for name, options in LATTICES.items():
            with self.subTest(name):
                arrays, attributes = self.write(BUNNY, *options)
                table = numpy.genfromtxt(self.dir / "a.csv", delimiter=",", names=True)
                ijk = arrays["sets/voxels/ijk"]
                self.assertEqual((ijk.dtype, len(ijk)), (numpy.int32, self.summary["voxels"]))
                numpy.testing.assert_array_equal(ijk, numpy.c_[table["i"], table["j"], table["k"]])
                place = attributes["origin"] + ijk @ attributes["basis"]
                numpy.testing.assert_allclose(place, numpy.c_[table["x"], table["y"], table["z"]], rtol=1e-13, atol=1e-13)
                numpy.testing.assert_array_equal(attributes["index_box"], [ijk.min(0), ijk.max(0) + 1])
                self.assertEqual((attributes["format"], attributes["format_version"]), ("latvox", 1))
                self.assertEqual((attributes["set"], attributes["latvox_digest"]), (attributes["latvox_set"], self.summary["digest"]))
                self.assertEqual(attributes["lattice"], self.summary["lattice"])
                self.assertIn('"placement"', attributes["latvox_request"])
                self.check_bricks(arrays)

    def check_bricks(self, arrays):
        masks = arrays["sets/voxels/brick_mask"]
        bits = numpy.unpackbits(masks.view("u1").reshape(-1, 8, 8, 1), axis=3, bitorder="little")
        brick, x, y, z = numpy.nonzero(bits)
        ijk = 8 * arrays["sets/voxels/brick_ijk"][brick] + numpy.c_[x, y, z]
        numpy.testing.assert_array_equal(ijk, arrays["sets/voxels/ijk"])
        numpy.testing.assert_array_equal(arrays["sets/voxels/brick_first"], numpy.searchsorted(brick, range(len(masks))))

    def test_fields_and_links_are_those_of_the_other_formats(self):
        options = ["--lattice", "bcc", "--resolution", "20", "--fields", ",".join([FIELDS, *LINKS])]
        arrays, attributes = self.write(SPIDER, *options)
        rows = numpy.load(self.dir / "a.npy")
        for name in FIELDS.split(","):
            values = arrays[f"fields/{name}"]
            self.assertEqual((values.dtype, values.shape), (rows[name].dtype, rows[name].shape), name)
            numpy.testing.assert_array_equal(values, rows[name], name)
        self.assertIn("Leib", attributes["latvox_part_names"] + attributes["latvox_material_names"])
        with numpy.load(self.dir / "a.npz") as whole:
            voxel, neighbor = numpy.nonzero(~numpy.isnan(whole["links"]))
            self.assertGreater(len(voxel), 1000)
            numpy.testing.assert_array_equal(arrays["links/neighbors"], whole["neighbors"])
            numpy.testing.assert_array_equal(arrays["links/voxel"], voxel)
            numpy.testing.assert_array_equal(arrays["links/neighbor"], neighbor)
            numpy.testing.assert_array_equal(arrays["links/ijk"], whole["ijk"][voxel])
            for field, name in LINKS.items():
                numpy.testing.assert_array_equal(arrays[f"links/{name}"], whole[field][voxel, neighbor], field)
        for field, name in LINKS.items():  # each one tells alone which links are crossed
            alone, _ = self.write(SPIDER, *options[:-1], field)
            self.assertEqual({n for n in alone if n[:5] == "links"}, {f"links/{n}" for n in ("neighbors", "voxel", "neighbor", "ijk", name)})
            numpy.testing.assert_array_equal(alone[f"links/{name}"], arrays[f"links/{name}"])
            numpy.testing.assert_array_equal(alone["links/ijk"], arrays["links/ijk"])

    def test_fractions_and_an_empty_set(self):
        arrays, _ = self.write(BUNNY, "--resolution", "12", "--set", "solid", "--fields", "fraction:4")
        self.assertEqual((arrays["fields/fraction"].dtype, arrays["fields/fraction"].max()), (numpy.uint16, 64))
        arrays, attributes = self.write(BUNNY, "--resolution", "12", "--set", "solid", "--labels", "part",
                                        "--fields", "fraction:4,label_fractions:4", "--fraction-labels", "9,0")  # fmt: skip
        numpy.testing.assert_array_equal(arrays["fields/label_fractions"][:, 1], arrays["fields/fraction"])
        self.assertEqual((arrays["fields/label_fractions"][:, 0].max(), attributes["latvox_fraction_labels"]), (0, "9,0"))
        empty, attributes = self.write(BUNNY, "--resolution", "12", "--region", "1000,0,0,1001,1,1", "--fields", "normal")
        self.assertEqual((empty["sets/voxels/ijk"].shape, empty["fields/normal"].shape), ((0, 3), (0, 3)))
        self.assertNotIn("index_box", attributes)
        self.assertEqual(json.loads(latvox("info", "--json", self.dir / "a.h5").stdout)["voxels"], 0)

    def test_more_rows_than_a_chunk(self):
        arrays, _ = self.write(BUNNY, "--resolution", "300", "--fields", "distance")
        self.assertGreater(self.summary["voxels"], 2 * 65536)
        rows = numpy.load(self.dir / "a.npy")
        numpy.testing.assert_array_equal(arrays["sets/voxels/ijk"], rows["ijk"])
        numpy.testing.assert_array_equal(arrays["fields/distance"], rows["distance"])
        done = subprocess.run(["h5dump", "-p", "-H", self.dir / "a.h5"], capture_output=True, text=True, check=True)
        self.assertIn(f"( {self.summary['voxels']}, 3 )", done.stdout)
        self.assertRegex(done.stdout, r"SHUFFLE\s+COMPRESSION DEFLATE")

    def test_info_tells_what_it_tells_of_the_grid(self):
        self.write(SPIDER, "-o", self.dir / "a.vdb", "--lattice", "bcc", "--resolution", "20", "--fields", FIELDS)
        facts, grid = (json.loads(latvox("info", "--json", self.dir / f"a.{e}").stdout) for e in ("h5", "vdb"))
        for name in ("voxels", "index_box", "basis", "origin", "voxel_size"):
            self.assertEqual(facts[name], grid[name], name)
        ours = {name: value for name, value in grid["metadata"].items() if re.match("latvox_(?!basis|origin|voxel_size)", name)}
        self.assertEqual(facts["metadata"], ours)
        self.assertEqual(set(facts["grid"]["type"].split(", ")), set(FIELDS.split(",")))

    def test_a_grid_is_converted_with_its_metadata(self):
        arrays, attributes = self.write(SPIDER, "-o", self.dir / "a.vdb", "--lattice", "bcc", "--resolution", "20", "--fields", FIELDS)
        done = latvox("convert", self.dir / "a.vdb", "-o", self.dir / "b.h5", "--fields", "color,part")
        self.assertEqual(done.returncode, 0, done.stderr)
        again, copied = read(self.dir / "b.h5")
        self.assertEqual({n for n in again if n[:6] == "fields"}, {"fields/color", "fields/part"})
        order = [numpy.lexsort(a["sets/voxels/ijk"].T) for a in (arrays, again)]
        for name in ("sets/voxels/ijk", "fields/color", "fields/part"):
            numpy.testing.assert_array_equal(again[name][order[1]], arrays[name][order[0]], name)
        self.assertEqual(copied.pop("latvox_fields"), "color,part")
        for name, value in copied.items():
            numpy.testing.assert_array_equal(value, attributes[name], name)

    def test_equal_jobs_write_equal_bytes(self):
        files = []
        for threads in ("1", "2"):
            self.write(BUNNY, "--resolution", "20", "--fields", "distance,links", "--threads", threads)
            files.append((self.dir / "a.h5").read_bytes())
            time.sleep(1.1)  # HDF5 has times in seconds
        self.assertEqual(*files)

    def test_memory_does_not_grow_with_the_voxels(self):
        most = []
        for name in ("csv", "h5"):
            words = ["--resolution", "300", "--fields", "distance,normal", "-o", self.dir / f"m.{name}"]
            most.append(self.peak_memory("voxelize", BUNNY, *words))
        self.assertLess(most[1] - most[0], 40 << 20)

    def test_a_full_disk_is_an_error_and_leaves_nothing(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

        words = [BIN / "latvox", "voxelize", BUNNY, "--resolution", "128", "-o", self.dir / "a.h5"]
        done = subprocess.run(words, capture_output=True, text=True, preexec_fn=limit)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, r"a\.h5: cannot be written \(File too large\)\n$")
        self.assertEqual(list(self.dir.glob("*.h5")), [])

    def test_damaged_and_other_files_are_refused(self):
        self.write(BUNNY, "--resolution", "32", "--fields", "distance")
        whole, chance, refused = (self.dir / "a.h5").read_bytes(), random.Random(3), 0
        mutant = self.dir / "mutant.h5"
        for n in range(12):
            bad = bytearray(whole[: chance.randrange(len(whole)) if n % 3 == 0 else None])
            for _ in range(4):
                bad[chance.randrange(len(bad) // 4)] ^= 1 << chance.randrange(8)
            mutant.write_bytes(bad)
            done = latvox("info", mutant)
            self.assertIn(done.returncode, (0, 3), (n, done.stderr))
            if done.returncode == 3:
                refused += 1
                self.assertRegex(done.stderr, r"^latvox: .*mutant\.h5: .+\n$")
        self.assertGreater(refused, 3)
        mutant.write_bytes(b"\x89HDF\r\n\x1a\n")
        self.assertIn("mutant.h5: is not a readable .h5 file", latvox("info", mutant).stderr)
        with h5py.File(mutant, "w") as file:
            file["x"] = [1, 2]
        self.assertIn("mutant.h5: is not a file of latvox", latvox("info", mutant).stderr)

    def test_the_library_is_loaded_only_when_it_is_needed(self):
        listed = subprocess.run(["ldd", BIN / "latvox"], capture_output=True, text=True, check=True).stdout
        self.assertNotRegex(listed, "hdf5|libcurl")


if __name__ == "__main__":
    unittest.main()
