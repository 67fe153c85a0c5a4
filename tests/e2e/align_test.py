"""--align: a mesh on the lattice and origin of another file's grid."""

import json
import unittest

from harness import BIN, BUNNY, Case, latvox, octahedron, rows, write_obj


class Align(Case):
    def test_a_mesh_has_the_same_voxels_on_the_grid_of_its_own_file(self):
        for lattice in ("cartesian", "bcc", "hexagonal"):
            options = ["--lattice", lattice, "--resolution", 60, "--quantization", 16]
            first = self.voxelize(BUNNY, *options, out="first.vdb")
            again = self.voxelize(BUNNY, "--align", self.dir / "first.vdb", "--quantization", 16, out="again.vdb")
            self.assertEqual(again["digest"], first["digest"], lattice)
            self.assertEqual((again["basis"], again["origin"]), (first["basis"], first["origin"]))
            self.assertEqual(again["lattice"], lattice)
            same = latvox("compare", self.dir / "first.vdb", self.dir / "again.vdb")
            self.assertEqual(same.returncode, 0, same.stdout)

    def test_another_mesh_lies_on_the_points_of_the_first(self):
        basis = "0.25,0,0,0.125,0.25,0,0,0.0625,0.5"
        self.voxelize(BUNNY, "--basis", basis, "--origin", "10,-3,0.125", out="first.vdb")
        mesh = write_obj(self.dir / "octahedron.obj", octahedron(2))
        summary = self.voxelize(mesh, "--align", self.dir / "first.vdb", out="second.csv")
        self.assertEqual(summary["basis"], [float(x) for x in basis.split(",")])
        self.assertEqual(summary["origin"], [10, -3, 0.125])
        for (i, j, k), world in rows(self.dir / "second.csv").items():
            self.assertEqual(world, (10 + i / 4 + j / 8, -3 + j / 4 + k / 16, 0.125 + k / 2))

    def test_a_job_is_not_aligned_to_an_object_of_a_store(self):
        (self.dir / "jobs.jsonl").write_text(json.dumps({"mesh": str(BUNNY), "align": "s3://b/first.vdb", "out": "a.csv"}))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('align: "s3://b/first.vdb" is a URL; download it', done.stderr)

    def test_jobs_are_aligned_to_files_beside_theirs_and_done_again_for_another_grid(self):
        mesh = write_obj(self.dir / "a.obj", octahedron(2))
        job = {"mesh": "a.obj", "align": "first.vdb", "quantization": 16, "out": "a.csv"}
        (self.dir / "jobs.jsonl").write_text(json.dumps(job))
        for resolution, status in ((40, "done"), (40, "skipped"), (50, "done")):
            first = self.voxelize(BUNNY, "--lattice", "fcc", "--resolution", resolution, out="first.vdb")
            done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out", "--resume")
            self.assertEqual(done.returncode, 0, done.stderr)
            result = json.loads((self.dir / "out" / "results.jsonl").read_text().splitlines()[-1])
            self.assertEqual(result["status"], status)
            if status == "done":
                self.assertEqual((result["summary"]["basis"], result["summary"]["lattice"]), (first["basis"], "fcc"))
                alone = self.voxelize(mesh, "--align", self.dir / "first.vdb", "--quantization", 16)
                self.assertEqual(result["summary"]["digest"], alone["digest"])
        (self.dir / "first.vdb").unlink()
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out")
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, "jobs.jsonl:1: align: .*first.vdb: no such file")
        result = json.loads((self.dir / "out" / "results.jsonl").read_text().splitlines()[-1])
        self.assertRegex(result["error"]["message"], "^align: /.*first.vdb: no such file$")

    def test_a_format_that_cannot_hold_the_grid_s_cells_is_refused_when_the_file_is_read(self):
        for lattice, status in (("cartesian", 0), ("bcc", 3)):
            self.voxelize(BUNNY, "--lattice", lattice, "--resolution", 9, out="first.vdb")
            done = latvox("voxelize", BUNNY, "-o", self.dir / "o.vti", "--align", self.dir / "first.vdb")
            self.assertEqual(done.returncode, status, done.stderr)
        self.assertRegex(done.stderr, r"o.vti: the format holds boxes along the axes only, .*; .vdb .* .vtu .*can hold these voxels")

    def test_contradictions_and_files_without_a_grid_are_refused(self):
        self.voxelize(BUNNY, "--resolution", 9, out="first.vdb")
        for option in ("--resolution=9", "--voxel-size=1", "--lattice=bcc", "--basis=1,0,0,0,1,0,0,0,1", "--origin=0,0,0"):
            done = latvox("voxelize", BUNNY, "-o", self.dir / "o.vdb", "--align", self.dir / "first.vdb", option)
            self.assertEqual(done.returncode, 2, option)
            self.assertIn("--align", done.stderr)
            self.assertIn(option.split("=")[0], done.stderr)
        for name, says in ((self.dir / "none.vdb", "no such file"), (BIN / "latvox", "neither a .vdb nor a .nvdb file")):
            done = latvox("voxelize", BUNNY, "-o", self.dir / "o.vdb", "--align", name)
            self.assertEqual(done.returncode, 3)
            self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()
