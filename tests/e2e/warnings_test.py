"""Warnings: their codes, their places, and their documentation."""

import json
import pathlib
import re
import unittest

from harness import Case, box, latvox, octahedron, write_obj

ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE = re.compile(r'(?:\bWarning|[wW]arnings?\.push_back\(|[wW]arnings \+?= |\breturn|\bWarn\()\s*\{\s*"([A-Z]+(?:_[A-Z]+)*)"|\bwarn\("([A-Z_]+)"')


class Codes(unittest.TestCase):
    def test_the_table_of_codes_is_that_of_the_sources(self):
        sources = [path for path in (ROOT / "client").rglob("*.cc") if "examples" not in path.parts]
        used = {code for path in sources for match in CODE.finditer(path.read_text()) for code in match.groups() if code}
        self.assertLess({"FEW_VOXELS", "EMPTY_RESULT"}, used)
        page = (ROOT / "client/docs/limits.md").read_text()
        section = page[page.index("## Warnings") :].split("\n## ")[0] if "## Warnings" in page else ""
        documented = re.findall(r"^\| `([A-Z_]+)` \|", section, re.MULTILINE)
        self.assertEqual(documented, sorted(documented))
        self.assertEqual(set(documented), used)


class Warnings(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_obj(self.dir / "octahedron.obj", octahedron(1))
        self.cut = self.dir / "cut.stl"
        self.cut.write_text(
            "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
        )

    def test_a_warning_of_each_origin_is_everywhere(self):
        done = latvox("voxelize", self.cut, "--voxel-size", "0.3", "-o", self.dir / "a.vdb", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        warnings = json.loads(done.stdout)["warnings"]
        self.assertEqual([warning["code"] for warning in warnings], ["NO_END", "FEW_VOXELS"])
        said = [line for line in done.stderr.splitlines() if "warning" in line]
        self.assertEqual(said, ["latvox: warning: " + warning["message"] for warning in warnings])
        info = json.loads(latvox("info", "--json", self.dir / "a.vdb").stdout)
        self.assertEqual(json.loads(info["metadata"]["latvox_warnings"]), warnings)
        (self.dir / "jobs.jsonl").write_text(json.dumps({"mesh": "cut.stl", "voxel_size": 0.3, "out": "b.vdb"}))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertEqual(done.returncode, 0, done.stderr)
        for warning in warnings:
            self.assertIn(f"latvox: b.vdb: warning: {warning['message']}\n", done.stderr)
        self.assertEqual(json.loads((self.dir / "results.jsonl").read_text())["summary"]["warnings"], warnings)

    def test_without_a_warning_the_list_is_empty(self):
        done = latvox("voxelize", self.mesh, "--voxel-size", "0.1", "-o", self.dir / "a.vdb", "--json")
        self.assertEqual(json.loads(done.stdout)["warnings"], [])
        self.assertNotIn("warning", done.stderr)
        self.assertNotIn("latvox_warnings", latvox("info", self.dir / "a.vdb").stdout)

    def test_strict_makes_each_warning_an_error_and_writes_nothing(self):
        kept = sorted(self.dir.iterdir())
        for mesh, options, code in (
            (self.cut, ["--resolution", "9"], "NO_END"),
            (self.mesh, ["--voxel-size", "1"], "FEW_VOXELS"),
            (self.mesh, ["--resolution", "9", "--bounds", "5,5,5,6,6,6"], "EMPTY_RESULT"),
        ):
            with self.subTest(code):
                done = latvox("voxelize", mesh, *options, "--strict", "-o", self.dir / "a.vdb", "-o", self.dir / "a.csv")
                self.assertEqual(done.returncode, 3, done.stderr)
                self.assertIn(f"latvox: --strict: no warning is allowed, and there is {code}\n", done.stderr)
                self.assertEqual(sorted(self.dir.iterdir()), kept)
        done = latvox("voxelize", self.mesh, "--resolution", "9", "--strict", "-o", self.dir / "a.vdb")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_strict_holds_for_encode_and_for_jobs(self):
        out = self.dir / "a.drc"
        done = latvox("encode", self.cut, "--strict", "-o", out)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("there is NO_END", done.stderr)
        self.assertFalse(out.exists())
        done = latvox("encode", self.cut, "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("latvox: warning: ", done.stderr)
        self.assertTrue(out.exists())
        jobs = self.dir / "jobs.jsonl"
        job = {"mesh": "cut.stl", "resolution": 9, "out": "b.vdb"}
        for strict, status in ((False, 0), (True, 3)):
            jobs.write_text(json.dumps({**job, "strict": strict}))
            done = latvox("batch", jobs, "--out", self.dir, "--resume")
            self.assertEqual(done.returncode, status, done.stderr)
        line = json.loads((self.dir / "results.jsonl").read_text().splitlines()[-1])
        self.assertEqual(line["status"], "failed")
        self.assertIn("NO_END", line["error"]["message"])

    def test_every_empty_result_has_its_reason(self):
        plate = write_obj(self.dir / "plate.obj", box((0, 0, 0.01), (9, 9, 0.02)))
        speck = write_obj(self.dir / "speck.obj", box((0.1, 0.15, 0.32), (0.12, 0.17, 0.34)))
        hole = write_obj(self.dir / "hole.obj", (octahedron(4)[0], octahedron(4)[1][:1]))
        step, solid = ["--voxel-size", "1", "--origin", "0,0,0"], ["--set", "interior"]
        for mesh, options, code, reason in (
            (plate, [*step, *solid], "EMPTY_RESULT", "no lattice point lies inside the mesh, which is thinner than"),
            (plate, [*step, *solid, "--rule", "positive"], "EMPTY_RESULT", "or turned inside out"),
            (hole, [*step, *solid, "--force-open"], "EMPTY_RESULT", "the mesh is not closed, and [0-9]+ lattice lines"),
            (speck, step, "EMPTY_RESULT", "the mesh crosses no step between neighboring lattice points"),
            (speck, [*step, "--set", "links", "--fields", "distance", "--signed"], "EMPTY_RESULT", "the mesh crosses no step"),
            (plate, [*step, "--set", "links", "--side", "inside"], "EMPTY_RESULT", "no end of a step .* lies on this side of it"),
            (speck, [*step, "--band", "0.01"], "EMPTY_RESULT", "no lattice point lies within 0.01 of the mesh"),
            (speck, ["--resolution", "2", "--shard", "0/9999"], "EMPTY_SHARD", "shard 0/9999 has no voxel"),
        ):
            with self.subTest(reason):
                summary = self.voxelize(mesh, *options)
                self.assertEqual(summary["voxels"], 0)
                self.assertEqual(summary["warnings"][0]["code"], code)
                self.assertRegex(summary["warnings"][0]["message"], reason)
        done = latvox("voxelize", speck, "--resolution", "2", "--shard", "0/9999", "--strict", "-o", self.dir / "a.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("latvox: note: shard 0/9999 has no voxel; others may have some\n", done.stderr)

    def test_quantization_does_not_apply_to_draco(self):
        drc = self.dir / "a.drc"
        self.assertEqual(latvox("encode", self.mesh, "-o", drc).returncode, 0)
        done = latvox("voxelize", drc, "--resolution", "9", "--quantization", "5", "--json")
        self.assertEqual([warning["code"] for warning in json.loads(done.stdout)["warnings"]], ["QUANTIZATION_IGNORED"])

    def test_a_mesh_of_very_many_voxels_is_told_before_the_work(self):
        mesh = self.dir / "sliver.obj"
        mesh.write_text("v 0 0 0\nv 30 0 0\nv 0 0.002 0\nf 1 2 3\n")
        out = self.dir / "out.csv"
        done = latvox("voxelize", mesh, "--voxel-size", "0.001", "--json", "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the mesh is 30000 voxels long", done.stderr)
        self.assertEqual([warning["code"] for warning in json.loads(done.stdout)["warnings"]], ["MANY_VOXELS"])
        out.unlink()
        done = latvox("voxelize", mesh, "--voxel-size", "0.001", "--strict", "-o", out)
        self.assertEqual((done.returncode, out.exists()), (3, False))
        self.assertIn("MANY_VOXELS", done.stderr)
        done = latvox("voxelize", mesh, "--resolution", "30000", "--json", "-o", out)
        self.assertEqual(json.loads(done.stdout)["warnings"], [])


if __name__ == "__main__":
    unittest.main()
