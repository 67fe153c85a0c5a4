"""latvox merge: parts with fields, and parts of bands, are the whole again, byte for byte."""

import json
import unittest

from harness import BUNNY, Case, latvox, octahedron, write_obj

OK, BAD_INPUT = 0, 3
KINDS = {
    "surface": ["--fields", "part,distance,triangle,point,normal", "--lattice", "bcc"],
    "solid": ["--set", "solid", "--fields", "part,distance", "--signed"],
    "fractions": ["--set", "supercover-solid", "--fields", "fraction:4", "--lattice", "fcc"],
    "fractions of labels": ["--set", "solid", "--labels", "part", "--fields", "part,label_fractions:3"],
    "band": ["--set", "band", "--band", "1"],
    "level set": ["--set", "band", "--band", "1", "--signed"],
    "supercover": ["--set", "supercover", "--fields", "part,normal", "--lattice", "hexagonal"],
    "enclosed": ["--set", "enclosed", "--fields", "triangle", "--lattice", "fcc"],
    "labeled enclosed": ["--set", "enclosed", "--labels", "part", "--fields", "part,distance"],
    "region": ["--set", "region", "--seed", "0,0,0", "--fields", "distance", "--lattice", "hexagonal"],
    "region with closed holes": ["--set", "region", "--seed", "0,0,0", "--close", "1", "--fields", "distance"],
    "links": ["--set", "links", "--fields", "point"],
    "interior": ["--set", "interior", "--fields", "material,distance", "--lattice", "bcc"],
    "enclosed interior": ["--set", "enclosed-interior", "--fields", "triangle"],
    "materials and colors": ["--fields", "material,color"],
}


class MergeFields(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_obj(self.dir / "octahedron.obj", octahedron(8))
        lines = self.mesh.read_text().splitlines()
        self.mesh.write_text("\n".join(["mtllib o.mtl", *lines[:6], "usemtl red", *lines[6:10], "usemtl blue", *lines[10:], ""]))
        (self.dir / "o.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n")
        self.merged = self.dir / "merged.vdb"

    def parts(self, cuts, *options, extension=".vdb"):
        paths = [self.dir / f"part{n}{extension}" for n in range(len(cuts))]
        for path, cut in zip(paths, cuts):
            self.voxelize(self.mesh, "--voxel-size", "0.3", *options, *cut, out=path.name)
        return paths

    def merge(self, paths):
        done = latvox("merge", *paths, "-o", self.merged, "--json")
        self.assertEqual((done.returncode, done.stderr), (OK, ""))
        return json.loads(done.stdout)

    def refuses(self, paths, says):
        done = latvox("merge", *paths, "-o", self.merged)
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertRegex(done.stderr, says)
        self.assertFalse(self.merged.exists())

    def test_shards_are_the_whole(self):
        for name, options in KINDS.items():
            with self.subTest(name):
                whole = self.voxelize(self.mesh, "--voxel-size", "0.3", *options, out="whole.vdb")
                for extension in (".vdb", ".nvdb"):
                    cuts = [["--shard", f"{n}/3"] for n in range(3)]
                    summary = self.merge(self.parts(cuts, *options, extension=extension))
                    self.assertEqual((summary["voxels"], summary["digest"]), (whole["voxels"], whole["digest"]))
                    self.assertEqual(self.merged.read_bytes(), (self.dir / "whole.vdb").read_bytes(), extension)

    def test_materials_keep_their_names(self):
        self.merge(self.parts([["--shard", f"{n}/3"] for n in range(3)], *KINDS["materials and colors"]))
        self.assertRegex(latvox("info", self.merged).stdout, r"latvox_material_names = .*red.*blue")

    def test_regions_that_overlap_within_bricks_are_the_whole(self):
        cuts = [[f"--region={box}"] for box in ("-999,-999,-999,5,999,999", "3,-999,-999,999,12,999", "3,9,-999,999,999,999")]
        for name in ("surface", "band", "region with closed holes"):
            with self.subTest(name):
                self.voxelize(self.mesh, "--voxel-size", "0.3", *KINDS[name], out="whole.vdb")
                self.merge(self.parts(cuts, *KINDS[name]))
                compared = latvox("compare", self.merged, self.dir / "whole.vdb").stdout
                self.assertIn(" 0 in A alone, 0 in B alone", compared)
                self.assertIn("0 of the distances in both differ", compared)
                self.assertNotRegex(compared, "[1-9] of the .* differ")
                infos = [latvox("info", path).stdout.splitlines() for path in (self.merged, self.dir / "whole.vdb")]
                differ = {line.partition(" = ")[0] for line in set(infos[0]) ^ set(infos[1])}
                self.assertLessEqual(differ, {"latvox_region", "latvox_minimal", "latvox_request"})

    def test_parts_that_do_not_belong_together(self):
        shards = [["--shard", "0/2"], ["--shard", "1/2"]]
        paths = self.parts(shards, "--fields", "part")
        self.voxelize(self.mesh, "--voxel-size", "0.3", *shards[1], out="bare.vdb")
        self.refuses([paths[0], self.dir / "bare.vdb"], "bare.vdb: latvox_fields is absent, but part in .*part0.vdb")
        self.refuses([self.dir / "bare.vdb", paths[0]], "part0.vdb: latvox_fields is part, but absent in .*bare.vdb")
        self.voxelize(self.mesh, "--voxel-size", "0.3", "--fields", "part,normal", *shards[1], out="more.vdb")
        self.refuses([paths[0], self.dir / "more.vdb"], "more.vdb: latvox_fields is part,normal, but part in .*part0.vdb")

    def test_values_that_were_changed(self):
        paths = self.parts([["--shard", "0/2"], ["--shard", "1/2"]], "--fields", "distance")
        data = bytearray(paths[1].read_bytes())
        data[-2] ^= 1  # in the last number of the last grid
        paths[1].write_bytes(data)
        self.refuses(paths, "part1.vdb: is damaged: its voxels have digest .*, but latvox_distance_digest is ")

    def test_a_field_of_the_bunny(self):
        self.mesh = BUNNY
        whole = self.voxelize(BUNNY, "--voxel-size", "0.3", "--fields", "triangle", out="whole.vdb")
        self.merge(self.parts([["--shard", f"{n}/16"] for n in range(16)], "--fields", "triangle"))
        self.assertEqual(self.merged.read_bytes(), (self.dir / "whole.vdb").read_bytes())
        self.assertGreater(whole["voxels"], 100)


if __name__ == "__main__":
    unittest.main()
