"""The voxels depend only on the triangles, however a mesh arrives: formats, standard input, several files,
--up-axis."""

import json
import subprocess
import unittest

import harness
from harness import BIN, encode_drc, latvox, write_obj, write_ply, write_stl
from inputs import GRID, MESH, InputCase, joined, mapped, mesh_xml, model, write_3mf, write_gltf, write_off


class Input(InputCase):
    def test_every_format_says_the_same_by_name_and_on_standard_input(self):
        wanted = self.expected(MESH)
        obj = self.dir / "expected.obj"
        whole = model(f'<object id="1">{mesh_xml(MESH)}</object>', '<item objectid="1"/>')
        for path in (
            obj,
            write_ply(self.dir / "mesh.ply", MESH),
            write_stl(self.dir / "mesh.stl", MESH),
            write_off(self.dir / "mesh.off", MESH),
            encode_drc(self.dir / "mesh.drc", obj),
            write_3mf(self.dir / "mesh.3mf", whole),
        ):
            with self.subTest(path.name):
                self.assertEqual(self.digest(path), wanted)
                self.assertEqual(self.digest("-", stdin=path), wanted)
        with self.subTest("glb"):
            glb = write_gltf(self.dir / "mesh.glb", MESH)
            both = self.expected(joined(MESH, mapped(MESH, lambda x, y, z: (x + 1, y, z))))
            self.assertEqual(self.digest(glb), both)
            self.assertEqual(self.digest("-", stdin=glb), both)

    def test_the_format_can_be_told(self):
        wanted = self.expected(MESH)
        write_ply(self.dir / "mesh.obj", MESH)
        self.assertEqual(self.digest(self.dir / "mesh.obj"), wanted)  # by its first bytes, with a warning
        self.assertEqual(self.digest(self.dir / "mesh.obj", "--input-format", "ply"), wanted)
        obj = self.dir / "expected.obj"
        self.assert_refused(3, "standard input: not a PLY file", "-", "--input-format", "ply", stdin=obj)

    def test_broken_elements_are_left_out_on_request(self):
        path = write_obj(self.dir / "broken.obj", MESH)
        wanted = self.digest(path)
        with path.open("a") as obj:
            obj.write("\nv nan 0 0\nf 1 2\nf 1 2 -1\n")
        self.assert_refused(3, "broken.obj: line .*: a face has 2 corners", path)
        self.assertEqual(self.digest(path, "--skip-bad"), wanted)
        latvox("voxelize", path, *GRID, "--skip-bad", "-o", self.dir / "kept.vdb", *self.server)
        told = json.loads(latvox("info", self.dir / "kept.vdb", "--json").stdout)["metadata"]
        self.assertTrue(json.loads(told["latvox_request"])["skip_bad"])

    def test_standard_input_that_is_no_mesh_is_refused(self):
        (self.dir / "text").write_text("this is no mesh\n")
        self.assert_refused(3, "standard input: .*--input-format", "-", stdin=self.dir / "text")
        self.assert_refused(3, "standard input: is empty", "-")
        self.assert_refused(2, "- is given twice", "-", "-")

    def test_standard_input_that_is_closed_is_refused(self):
        command = ["sh", "-c", 'exec "$0" "$@" <&-', BIN / "latvox", "voxelize", "-", "-o", self.dir / "out.csv", *GRID]
        done = subprocess.run(command, capture_output=True, text=True, timeout=harness.PATIENCE)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("standard input: is ", done.stderr)

    def test_several_meshes_are_one(self):
        other = mapped(MESH, lambda x, y, z: (x + 1.5, y + 0.5, z - 2))
        paths = write_obj(self.dir / "a.obj", MESH), write_ply(self.dir / "b.ply", other)
        wanted = self.expected(joined(MESH, other))
        self.assertEqual(self.digest(*paths), wanted)
        self.assertEqual(self.digest(encode_drc(self.dir / "a.drc", paths[0]), "-", stdin=paths[1]), wanted)

    def test_up_and_scale_move_the_vertices(self):
        path = write_obj(self.dir / "a.obj", MESH)
        for options, move in (
            (["--up-axis", "z"], lambda x, y, z: (x, y, z)),
            (["--up-axis", "y"], lambda x, y, z: (x, -z, y)),
            (["--up-axis", "x"], lambda x, y, z: (-z, y, x)),
            (["--scale", "0.3"], lambda x, y, z: (0.3 * x, 0.3 * y, 0.3 * z)),
            (["--up-axis", "y", "--scale", "1.7"], lambda x, y, z: (1.7 * x, -1.7 * z, 1.7 * y)),
        ):
            with self.subTest(options):
                wanted = self.expected(mapped(MESH, move))
                self.assertEqual(self.digest(path, *options), wanted)
                self.assertEqual(self.digest(encode_drc(self.dir / "a.drc", path), *options), wanted)
        self.assert_refused(3, "a.obj: vertex 1 .2.7 .* is not finite", path, "--scale", "1e308")

    def test_encode_writes_what_voxelize_reads(self):
        path, drc = write_obj(self.dir / "mesh.obj", MESH), self.dir / "mesh.drc"
        for options in [], ["--up-axis", "y", "--scale", "0.5"]:
            with self.subTest(options):
                done = latvox("encode", path, *options, "-o", drc)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertRegex(done.stdout, rf"^{path}: 4 triangles\nwrote {drc}, \d+ bytes, lossless\n$")
                self.assertEqual(self.digest(drc), self.digest(path, *options))
        self.assertEqual(latvox("encode", path, path, "-o", drc).stdout.split()[3], "8")
        coarse = self.dir / "coarse.drc"
        self.assertEqual(latvox("encode", drc, "-o", coarse, "--quantization", 5).returncode, 0)
        self.assertEqual(self.voxelize(coarse, *GRID)["certificate"]["quantization_bits"], 5)
        done = latvox("encode", drc, "-o", drc)
        self.assertEqual((done.returncode, done.stderr), (2, f'latvox: --out: "{drc}" is the mesh itself\n'))

    def test_jobs_take_the_same(self):
        write_obj(self.dir / "a.obj", MESH)
        job = {"mesh": "a.obj", "voxel_size": 0.25, "origin": [0, 0, 0], "quantization": 0, "out": "a.csv"}
        wanted = self.expected(mapped(MESH, lambda x, y, z: (2 * x, -2 * z, 2 * y)))
        for scale, status in ((2, "done"), (2, "skipped"), (3, "done")):
            line = job | {"up_axis": "y", "scale": scale, "weld_report": True, "input_format": "obj"}
            (self.dir / "jobs.jsonl").write_text(json.dumps(line))
            done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir, "--resume", *self.server)
            self.assertEqual(done.returncode, 0, done.stderr)
            result = json.loads((self.dir / "results.jsonl").read_text().splitlines()[-1])
            self.assertEqual(result["status"], status)
            if scale == 2 and status == "done":
                self.assertEqual(result["summary"]["digest"], wanted)
                self.assertEqual(result["summary"]["mesh"]["weld_report"]["vertices"], 4)


class WeldReport(InputCase):
    def test_it_counts_what_is_wrong_with_a_mesh(self):
        vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0), (0, -1, 0)]
        triangles = [
            (0, 2, 1), (0, 4, 3), (1, 2, 3), (2, 0, 3),  # closed once vertex 4 is vertex 1
            (0, 1, 4),  # degenerate in the same way
            (0, 1, 5),  # a third triangle on edge 0-1, with two open edges
        ]
        path = write_obj(self.dir / "a.obj", (vertices, triangles))
        wanted = {"vertices": 6, "triangles": 6, "duplicate_vertices": 1, "degenerate_triangles": 1, "open_edges": 2,
                  "non_manifold_edges": 1, "inconsistent_edges": 0}
        summary = self.voxelize(path, *GRID, *self.server, "--weld-report")
        self.assertEqual(summary["mesh"]["weld_report"], wanted)
        self.assertNotIn("weld_report", self.voxelize(path, *GRID, *self.server)["mesh"])
        turned = write_obj(self.dir / "b.obj", (vertices, [(1, 2, 0), *triangles[1:4]]))
        report = self.voxelize(turned, *GRID, *self.server, "--weld-report")["mesh"]["weld_report"]
        self.assertEqual((report["open_edges"], report["inconsistent_edges"]), (0, 3))
        done = latvox("voxelize", path, *GRID, "--weld-report", "-o", self.dir / "out.csv", *self.server)
        says = "of 6 vertices, 1 are duplicates; of 6 triangles, 1 are degenerate; edges: 2 open, 1 non-manifold"
        self.assertIn(says, done.stdout)

    def test_it_leaves_a_draco_stream_as_it_is(self):
        drc = encode_drc(self.dir / "a.drc", write_obj(self.dir / "a.obj", MESH))
        options = *GRID[:-2], *self.server
        with_report, without = self.voxelize(drc, *options, "--weld-report"), self.voxelize(drc, *options)
        self.assertEqual(with_report["bytes"]["sent"], without["bytes"]["sent"])
        self.assertEqual(with_report["mesh"]["weld_report"]["open_edges"], 0)


if __name__ == "__main__":
    unittest.main()
