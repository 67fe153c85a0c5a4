"""The shortest commands: outputs without a name, standard output, lines about odd sizes."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from harness import BIN, BUNNY, PATIENCE, Case, await_log, await_true, children_of, latvox, octahedron, server, write_obj


class Manners(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_obj(self.dir / "octahedron.obj", octahedron(4))

    def run_here(self, *words, code=0, stdin=b""):
        """Runs latvox in the test's folder. Returns its standard output in bytes, and its standard error."""
        done = subprocess.run([BIN / "latvox", *map(str, words)], cwd=self.dir, input=stdin, capture_output=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout, done.stderr.decode()

    def files(self):
        return sorted(path.name for path in self.dir.iterdir())

    def test_a_mesh_alone_is_enough(self):
        (self.dir / "meshes").mkdir()
        shutil.move(self.mesh, self.dir / "meshes")
        text, _ = self.run_here("voxelize", "meshes/octahedron.obj")
        self.assertIn(b"(resolution 256, the default)", text)
        self.assertIn(b"wrote octahedron.vdb in ", text)
        self.assertEqual(self.files(), ["meshes", "octahedron.vdb"])
        kept = (self.dir / "octahedron.vdb").read_bytes()
        _, error = self.run_here("voxelize", "meshes/octahedron.obj", code=2)
        self.assertIn("octahedron.vdb", error)
        self.assertEqual((self.dir / "octahedron.vdb").read_bytes(), kept)

    def test_the_summary_counts_in_words_that_fit(self):
        triangle = write_obj(self.dir / "one.obj", ([(0, 0, 0), (8, 0, 0), (0, 8, 0)], [(0, 1, 2)]))
        self.assertIn(b"one.obj: 1 triangle, not closed", self.run_here("voxelize", triangle, "-o", "one.csv")[0])
        text, _ = self.run_here("voxelize", self.mesh, "--dims", "20,20,20", "-o", "box.npz")
        self.assertRegex(text, rb"\(resolution \d+, which fits --dims\)")

    def test_a_report_alone_writes_no_file(self):
        before = self.files()
        self.run_here("voxelize", self.mesh, "--json")
        text, _ = self.run_here("voxelize", self.mesh, "--verify")
        self.assertRegex(text.decode(), r"verified: 0 tunnels, 0 redundant voxels\ndone in ")
        self.assertEqual(self.files(), before)

    def test_standard_output_gets_the_bytes_of_the_file(self):
        temporary = self.dir / "temporary"
        temporary.mkdir()
        os.environ["TMPDIR"] = str(temporary)
        self.addCleanup(os.environ.pop, "TMPDIR")
        size = ["--resolution", "40"]
        for format in ("csv", "npy", "ply", "binvox"):
            with self.subTest(format):
                self.run_here("voxelize", self.mesh, *size, "-o", f"file.{format}")
                out, error = self.run_here("voxelize", "-", *size, "-o", "-", "--output-format", format, stdin=self.mesh.read_bytes())
                self.assertEqual(out, (self.dir / f"file.{format}").read_bytes())
                self.assertIn("wrote standard output in ", error)
        grid, _ = self.run_here("voxelize", self.mesh, *size, "-o", "-")
        (self.dir / "grid.vdb").write_bytes(grid)
        self.run_here("voxelize", self.mesh, *size, "-o", "file.vdb")
        self.assertIn(b"equal", self.run_here("compare", "grid.vdb", "file.vdb")[0])
        self.run_here("voxelize", self.dir / "none.obj", *size, "-o", "-", code=3)
        self.assertEqual(list(temporary.iterdir()), [])

    def test_the_private_server_ends_before_the_file_is_complete(self):
        command = [BIN / "latvox", "voxelize", BUNNY, "--resolution", "64", "-o", "-", "--output-format", "csv", "--quiet"]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as tool:
            first = tool.stdout.read(1)  # the pipe cannot take the rest
            await_true("the server stays", lambda: not children_of(tool.pid))
            self.assertIsNone(tool.poll())
            self.assertTrue((first + tool.stdout.read()).startswith(b"i,j,k,"))
        self.assertEqual(tool.returncode, 0)

    def test_no_library_runs_when_the_tool_and_its_server_end(self):
        voxelize = ["voxelize", self.mesh, "--resolution", "20", "-o", "out.vdb"]
        for words, processes, status in ((["--version"], 1, 0), (["voxelize"], 1, 2), (voxelize, 2, 0)):
            with self.subTest(words), tempfile.TemporaryDirectory() as folder:
                environment = os.environ | {"LD_DEBUG": "files", "LD_DEBUG_OUTPUT": f"{folder}/loader"}
                done = subprocess.run([BIN / "latvox", *words], cwd=self.dir, env=environment, capture_output=True, timeout=PATIENCE)
                self.assertEqual(done.returncode, status, done.stderr)
                texts = [path.read_text() for path in pathlib.Path(folder).iterdir()]
                self.assertEqual([("calling init" in text, "calling fini" in text) for text in texts], [(True, False)] * processes)

    def test_a_mesh_that_is_small_beside_its_voxels_is_told(self):
        for size, told in ((2, False), (2.1, True), (50, True)):
            _, error = self.run_here("voxelize", self.mesh, "--voxel-size", size, "--json")
            self.assertEqual(f"longest side, 8, is below 4 voxel sizes of {size}" in error, told, error)
        self.assertEqual(self.run_here("voxelize", self.mesh, "--resolution", 2, "--json")[1], "")

    def test_a_solid_tells_that_centers_may_lie_outside(self):
        command = ["voxelize", self.mesh, "--resolution", "20", "-o", "a.csv", "--set"]
        self.assertIn(b"with the surface, whose centers may lie outside\n", self.run_here(*command, "solid")[0])
        self.assertIn(b"without the surface\n", self.run_here(*command, "interior")[0])

    def test_versions(self):
        texts = {self.run_here(word)[0] for word in ("-V", "--version", "version")}
        self.assertEqual(len(texts), 1)

    def test_health_needs_a_server_to_ask(self):
        done = latvox("health")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stderr.splitlines()[0], "latvox: --server is required")

    def test_a_health_port_is_told_from_a_server(self):
        with server(self.dir, "--health-listen", "127.0.0.1:0"):
            address = await_log(self.dir, r"event=health address=(\S+)")
            done = latvox("voxelize", self.mesh, "--resolution", 8, "--server", address, "-o", self.dir / "a.csv")
        self.assertEqual(done.returncode, 1)
        self.assertIn("latvox: the server does not offer this call (UNIMPLEMENTED)", done.stderr)

    def test_an_address_without_a_port_is_refused(self):
        for address, why in (("localhost", "has no port"), ("127.0.0.1:99999", "has no port from 1 to 65535"),
                             ("https://localhost:50151", "is a URL"), ("127.0.0.1:1,", "is empty")):
            done = latvox("health", "--server", address)
            self.assertEqual(done.returncode, 2, address)
            self.assertRegex(done.stderr, f"^latvox: --server: .*{why}; it is HOST:PORT or unix:PATH\n$")


if __name__ == "__main__":
    unittest.main()
