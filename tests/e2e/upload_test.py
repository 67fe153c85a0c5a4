"""The form in which a mesh goes to the server: plain arrays where no network is in between, otherwise Draco."""

import json
import unittest

from harness import BUNNY, Case, latvox, octahedron, server

GRID = ("--lattice", "bcc", "--resolution", "60")
FAR = 5334762.25  # in meters, as in map coordinates


class Upload(Case):
    def bits(self, *options, mesh=BUNNY):
        return self.voxelize(mesh, *GRID, *options)["certificate"]["quantization_bits"]

    def octahedron_at(self, x):
        path = self.dir / f"at_{x}.obj"
        vertices, triangles = octahedron(4)
        lines = ["v %r %r %r" % (a + x, b, c) for a, b, c in vertices] + ["f %d %d %d" % tuple(n + 1 for n in t) for t in triangles]
        path.write_text("\n".join(lines) + "\n")
        return path

    def test_a_private_server_gets_the_positions_as_they_are(self):
        found = self.voxelize(BUNNY, *GRID)
        self.assertEqual(found["certificate"]["quantization_bits"], 0)
        self.assertEqual(found["digest"], self.voxelize(BUNNY, *GRID, "--quantization", "0")["digest"])
        self.assertIn("read", found["timings_ms"])
        self.assertIn("encode", found["timings_ms"])

    def test_a_network_gets_draco(self):
        with server(self.dir, "--listen", "127.0.0.1:0") as latvoxd:
            port = self.port()
            self.assertEqual(self.bits("--server", latvoxd.address), 0)
            for near in ("127.0.0.1", "localhost", "127.0.0.1:1,localhost"):
                self.assertEqual(self.bits("--server", f"{near}:{port}"), 0, near)
            # A name that may be resolved to any machine.
            for far in ("dns:localhost", "127.0.0.1:1,dns:localhost"):
                self.assertGreater(self.bits("--server", f"{far}:{port}"), 0, far)
                self.assertEqual(self.bits("--server", f"{far}:{port}", "--upload", "raw"), 0, far)

    def port(self):
        """The TCP port of the server, from its log."""
        log = (self.dir / "latvoxd.log").read_text()
        return log.split("127.0.0.1:")[1].split()[0].strip('",')

    def test_bits_that_are_asked_for_need_draco(self):
        self.assertEqual(self.bits("--quantization", "9"), 9)
        done = latvox("voxelize", BUNNY, "--quantization", "9", "--upload", "raw", "--json")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stderr, "latvox: --quantization: 9 needs --upload draco; raw positions are exact\n")

    def test_draco_and_arrays_of_the_same_numbers_are_equal(self):
        mesh = self.octahedron_at(0)
        digests = {self.voxelize(mesh, *GRID, "--upload", form, "--quantization", "0")["digest"] for form in ("raw", "draco")}
        self.assertEqual(len(digests), 1)

    def test_rounding_of_draco_far_from_0_is_told(self):
        mesh = self.octahedron_at(FAR)
        self.assertEqual(self.bits(mesh=mesh), 0)
        found = self.voxelize(mesh, *GRID, "--upload", "draco")
        self.assertEqual([warning["code"] for warning in found["warnings"]], ["POSITIONS_ROUNDED"])
        done = latvox("encode", mesh, "-o", self.dir / "far.drc", "--strict")
        self.assertEqual(done.returncode, 3)
        self.assertIn("Draco rounds the positions to 32 bits", done.stderr)

    def test_a_draco_file_is_sent_as_it_is(self):
        drc = self.dir / "bunny.drc"
        self.assertEqual(latvox("encode", BUNNY, "-o", drc, "--quantization", "9").returncode, 0)
        self.assertEqual(self.bits(mesh=drc), 9)
        done = latvox("voxelize", drc, "--upload", "raw", "--json")
        self.assertEqual(done.returncode, 3)
        self.assertEqual(done.stderr, "latvox: --upload: a .drc file is sent as it is, not raw\n")

    def test_a_batch_has_the_same_choice(self):
        jobs = [{"mesh": str(BUNNY), "resolution": 60, "upload": form, "out": f"{form}.csv"} for form in ("auto", "raw", "draco")]
        (self.dir / "jobs.jsonl").write_text("".join(json.dumps(job) + "\n" for job in jobs))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir / "out", "--jobs", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        results = map(json.loads, (self.dir / "out/results.jsonl").read_text().splitlines())
        bits = [result["summary"]["certificate"]["quantization_bits"] for result in results]
        self.assertEqual((bits[0], bits[1]), (0, 0))
        self.assertGreater(bits[2], 0)


if __name__ == "__main__":
    unittest.main()
