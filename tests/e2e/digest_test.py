"""The voxels depend only on mesh and specification."""

import unittest

from harness import BUNNY, Case, encode_drc, latvox, read_obj, rows, shuffled, write_obj, write_ply, write_stl

LOSSLESS = ["--quantization", "0"]
SEED = 20240229


class Digest(Case):
    def digests(self, meshes, *options):
        return {self.voxelize(mesh, *LOSSLESS, *options)["digest"] for mesh in meshes}

    def test_threads_do_not_matter(self):
        options = [*LOSSLESS, "--lattice", "fcc", "--resolution", "256"]
        digests = {self.voxelize(BUNNY, *options, "--threads", n)["digest"] for n in (1, 2, 7)}
        self.assertEqual(len(digests), 1)

    def test_the_order_of_triangles_and_corners_does_not_matter(self):
        mesh = read_obj(BUNNY)
        files = [write_obj(self.dir / f"{n}.obj", shuffled(mesh, SEED + n)) for n in range(2)]
        for minimal in ("--minimal", "--no-minimal"):
            found = self.digests([BUNNY, *files], "--lattice", "bcc", "--resolution", "128", minimal)
            self.assertEqual(len(found), 1, f"{minimal}, seed {SEED}")

    def test_the_file_format_does_not_matter(self):
        mesh = read_obj(BUNNY)
        obj = write_obj(self.dir / "bunny.obj", mesh)
        files = [
            obj,
            write_ply(self.dir / "bunny.ply", mesh),
            write_stl(self.dir / "bunny.stl", mesh),
            encode_drc(self.dir / "edgebreaker.drc", obj, "-cl", "7"),
            encode_drc(self.dir / "sequential.drc", obj, "-cl", "0"),
        ]
        found = self.digests(files, "--lattice", "cartesian", "--resolution", "128")
        self.assertEqual(len(found), 1)

    def test_the_digest_tells_different_sets_apart(self):
        options = ["--lattice", "cartesian", "--resolution"]
        found = {self.voxelize(BUNNY, *options, n)["digest"] for n in (40, 41, 42)}
        self.assertEqual(len(found), 3)

    def test_an_encoding_changes_what_travels_and_nothing_else(self):
        found = [self.voxelize(BUNNY, "--resolution", 256, "--encoding", name, out="a.vdb") for name in ("masks", "packed", "packed-zstd")]
        self.assertEqual(len({summary["digest"] for summary in found}), 1)
        masks, packed, zstd = (summary["bytes"]["received"] for summary in found)
        self.assertLess(packed, masks / 2)
        self.assertLess(zstd, packed)

    def test_shards_make_the_whole(self):
        options = [*LOSSLESS, "--lattice", "fcc", "--separability", "2", "--resolution", "160"]
        whole = self.voxelize(BUNNY, *options)
        everything = rows(self.dir / "out.csv")
        for count in (1, 7):
            union, digest = {}, 0
            for index in range(count):
                part = self.voxelize(BUNNY, *options, "--shard", f"{index}/{count}")
                self.assertEqual(part["shard"], {"index": index, "count": count})
                self.assertEqual(part["certificate"]["minimal"], count == 1)
                found = rows(self.dir / "out.csv")
                self.assertFalse(union.keys() & found.keys())
                self.assertTrue(count == 1 or len(found) < len(everything) / 3)
                union |= found
                digest += int(part["digest"], 16)
            self.assertEqual(union, everything)
            self.assertEqual(f"{digest % (1 << 128):032x}", whole["digest"])

    def test_a_shard_knows_itself(self):
        self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", "40", "--shard", "1/3", out="part.vdb")
        self.assertIn("latvox_shard = 1/3\n", latvox("info", self.dir / "part.vdb").stdout)

    def test_bad_shards_are_refused(self):
        for shard in ("3/3", "-1/3", "1", "1/", "/2", "0/0", "1/3/4", "a/b", "0/1048577"):
            done = latvox("voxelize", BUNNY, "-o", self.dir / "out.csv", "--resolution", "40", f"--shard={shard}")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("--shard", done.stderr)

    def test_regions_are_exact_parts_of_the_whole(self):
        options = [*LOSSLESS, "--lattice", "bcc", "--resolution", "96"]
        whole = self.voxelize(BUNNY, *options)
        everything = rows(self.dir / "out.csv")
        low = [min(ijk[m] for ijk in everything) for m in range(3)]
        high = [max(ijk[m] for ijk in everything) + 1 for m in range(3)]
        cuts = [[low[m], 8 * ((low[m] + high[m]) // 16), high[m]] for m in range(3)]  # between bricks, not tiles
        union, digest = {}, 0
        for corner in ((i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)):
            box = [cuts[m][corner[m]] for m in range(3)] + [cuts[m][corner[m] + 1] for m in range(3)]
            part = self.voxelize(BUNNY, *options, "--region=" + ",".join(map(str, box)))
            found = rows(self.dir / "out.csv")
            self.assertEqual(len(found), part["voxels"])
            self.assertFalse(union.keys() & found.keys())
            union |= found
            digest += int(part["digest"], 16)
        self.assertEqual(union, everything)
        self.assertEqual(f"{digest % 2**128:032x}", whole["digest"])


if __name__ == "__main__":
    unittest.main()
