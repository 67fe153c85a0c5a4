"""`latvox info` tells the facts of every file that latvox writes and of every mesh that it reads, and refuses others."""

import gzip
import json
import resource
import struct
import unittest
import zipfile

from harness import Case, encode_drc, latvox, octahedron, rows, write_obj

GRID = ["--voxel-size", "1", "--origin", "0.5,0,0", "--quantization", "0"]
SPIDER = "/usr/share/assimp/models/OBJ/spider.obj"  # of assimp-testmodels
MEMORY = 1 << 31  # bytes of address space


class Info(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_obj(self.dir / "m.obj", octahedron(9.0))

    def info(self, name):
        """Returns the facts as JSON, after comparing them with the text."""
        done = latvox("info", "--json", self.dir / name)
        self.assertEqual(done.returncode, 0, done.stderr)
        facts = json.loads(done.stdout)
        text = latvox("info", self.dir / name)
        self.assertEqual(text.returncode, 0, text.stderr)
        if "voxels" in facts:
            self.assertRegex(text.stdout, rf"voxels +{facts['voxels']}\n")
        return facts

    def write(self, *names, options=()):
        """Writes the files and a.csv. Returns the summary and the .csv's voxels."""
        files = [word for name in names for word in ("-o", self.dir / name)]
        return self.voxelize(self.mesh, *files, *GRID, *options, out="a.csv"), rows(self.dir / "a.csv")

    def boxes(self, voxels):
        def box(points, beyond):
            return {"min": [min(p[m] for p in points) for m in range(3)], "max": [max(p[m] for p in points) + beyond for m in range(3)]}

        return box(list(voxels), 1), box(list(voxels.values()), 0)

    def test_files_of_voxels_tell_number_and_place(self):
        summary, voxels = self.write("a.vdb", "a.nvdb", "a.npy", "a.npz", "a.ply", "a.glb", "a.vox", "a.binvox", "a.png")
        index_box, bounds = self.boxes(voxels)
        shape = [h - l for l, h in zip(index_box["min"], index_box["max"])]
        for name in ("a.csv", "a.ply", "a.npy"):
            facts = self.info(name)
            self.assertEqual((facts["format"], facts["voxels"], facts["index_box"]), (name[2:], len(voxels), index_box))
            self.assertEqual(facts["bytes"], (self.dir / name).stat().st_size)
            self.assertEqual(facts.get("bounds", bounds), bounds)
        self.assertEqual(self.info("a.csv")["columns"], [*"ijkxyz"])
        facts = self.info("a.npz")
        self.assertEqual((facts["voxels"], facts["basis"], facts["origin"]), (len(voxels), summary["basis"], summary["origin"]))
        self.assertEqual(facts["index_min"], summary["index_box"]["min"])
        self.assertEqual(facts["arrays"]["data"]["type"], "'|u1'")
        for name, sides in (("a.vox", shape), ("a.binvox", [max(shape)] * 3)):
            self.assertEqual((self.info(name)["voxels"], self.info(name)["shape"]), (len(voxels), sides), name)
        facts = self.info("a.glb")
        self.assertEqual((facts["voxels"], facts["digest"], facts["lattice"]), (len(voxels), summary["digest"], "cartesian"))
        self.assertEqual(facts["bounds"]["min"], [x - 0.5 for x in bounds["min"]])
        self.assertEqual((self.info("a.png")["width"], self.info("a.png")["height"]), (1024, 1024))

    def test_files_with_all_fields_are_read(self):
        fields = "part,material,color,distance,triangle,point,normal,links,link_triangles,link_crossings"
        names = ("f.csv", "f.npy", "f.npz", "f.ply")
        outputs = [word for name in names[1:] for word in ("-o", self.dir / name)]
        summary = self.voxelize(SPIDER, *outputs, "--resolution", "12", "--fields", fields, out=names[0])
        for name in names:
            with self.subTest(name):
                self.assertEqual(self.info(name)["voxels"], summary["voxels"])

    def test_images_and_files_of_vtk_tell_number_and_place(self):
        summary, voxels = self.write("a.nrrd", "a.mha", "a.mhd", "a.nii", "a.nii.gz", "a.vti", "a.vtu", "a.npz")
        index_box, bounds = self.boxes(voxels)
        low, high = summary["index_box"]["min"], summary["index_box"]["max"]
        place = {"type": "uint8", "components": 1, "shape": [h - l for l, h in zip(low, high)], "voxels": len(voxels),
                 "basis": summary["basis"], "corner": [0.5 + low[0], *low[1:]]}  # fmt: skip
        for name in ("nrrd", "mha", "mhd", "nii", "nii.gz"):
            facts = self.info(f"a.{name}")
            self.assertEqual((facts["format"], {key: facts[key] for key in place}), (name, place))
        facts = self.info("a.vti")
        self.assertEqual((facts["voxels"], facts["shape"], facts["cell"]), (len(voxels), place["shape"], [1, 1, 1]))
        self.assertEqual(facts["low_corner"], [x - 0.5 for x in place["corner"]])
        self.assertEqual(facts["arrays"], {"data": "UInt8"})
        facts = self.info("a.vtu")
        self.assertEqual((facts["voxels"], facts["arrays"]), (len(voxels), {"ijk": "Int32"}))
        for field, told in (("distance", True), ("normal", True), ("triangle", True), ("color", False)):
            names = ("b.nrrd", "b.mha", "b.nii.gz") if field != "color" else ("b.nrrd",)
            outputs = [word for name in names for word in ("-o", self.dir / name)]
            count = self.voxelize(SPIDER, *outputs, "--resolution", "12", "--fields", field, out="b.vtu")["voxels"]
            for name in names:
                self.assertEqual(self.info(name).get("voxels"), count if told else None, (name, field))

    def test_both_grids_tell_the_same(self):
        summary, _ = self.write("a.vdb", "a.nvdb")
        nano, grid = self.info("a.nvdb"), self.info("a.vdb")
        for name in ("voxels", "index_box", "basis", "origin", "voxel_size"):
            self.assertEqual(nano[name], grid[name], name)
        self.assertEqual(nano["metadata"], {name: value for name, value in grid["metadata"].items() if name.startswith("latvox_")})
        self.assertEqual(nano["metadata"]["latvox_digest"], summary["digest"])
        self.assertEqual(nano["grid"]["name"], "voxels")

    def test_a_page_tells_its_voxels(self):
        summary, voxels = self.write("a.vdb")
        self.assertEqual(latvox("view", self.dir / "a.vdb", "-o", self.dir / "a.html").returncode, 0)
        facts = self.info("a.html")
        self.assertEqual((facts["voxels"], facts["index_box"]), (len(voxels), self.boxes(voxels)[0]))
        self.assertEqual(facts["metadata"]["digest"], summary["digest"])

    def test_other_sets_and_pixels(self):
        self.voxelize(self.mesh, "-o", self.dir / "b.npz", "-o", self.dir / "b.npy", "-o", self.dir / "b.ply", *GRID, "--band", "2v", out="b.csv")
        voxels = len((self.dir / "b.csv").read_text().splitlines()) - 1
        for name in ("b.csv", "b.npy", "b.npz", "b.ply"):
            self.assertEqual(self.info(name)["voxels"], voxels, name)
        self.assertEqual(self.info("b.csv")["columns"], [*"ijkxyz", "distance"])
        self.voxelize(self.mesh, *GRID, "--npy", "dense", out="d.npy")
        self.assertEqual(self.info("d.npy")["voxels"], len(self.write()[1]))
        self.voxelize(self.mesh, *GRID, "--region", "1000,0,0,1001,1,1", out="none.glb")
        self.assertEqual((self.info("none.glb")["voxels"], self.info("none.glb")["triangles"]), (0, 0))
        (self.dir / "p.txt").write_text("0,0 4,9 8,0 z\n")
        done = latvox("pixelize", self.dir / "p.txt", "--resolution", 20, "-o", self.dir / "p.csv", "--json")
        self.assertEqual(self.info("p.csv")["pixels"], json.loads(done.stdout)["pixels"])

    def test_content_tells_a_mesh_from_voxels(self):
        encode_drc(self.dir / "m.drc", self.mesh)
        vertices, triangles = octahedron(9.0)
        (self.dir / "m.ply").write_text(
            f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
            + "".join(f"{x} {y} {z}\n" for x, y, z in vertices) + "".join(f"3 {a} {b} {c}\n" for a, b, c in triangles))
        # A scene of another program: the same triangles without our generator.
        self.write("a.glb")
        data = (self.dir / "a.glb").read_bytes()
        (self.dir / "m.glb").write_bytes(data.replace(b'"generator":"latvox', b'"generator":"Latvox'))
        for name in ("m.obj", "m.drc", "m.ply"):
            facts = self.info(name)
            self.assertEqual((facts["triangles"], facts["parts"]), (8, 1), name)
            self.assertEqual(facts["bounds"], {"min": [-9, -9, -9], "max": [9, 9, 9]}, name)
        self.assertEqual(self.info("m.glb")["triangles"], self.info("a.glb")["triangles"])
        self.assertNotIn("voxels", self.info("m.glb"))

    def test_a_mesh_tells_its_colors_and_warnings(self):
        corners = ["0 0 0 1 0 0", "1 0 0 0 1 0", "0 1 0 0 0 0.2", "5 5 5 1 1 1"]
        (self.dir / "c.obj").write_text("".join(f"v {corner}\n" for corner in corners) + "f 1 2 3\nl 1 2\n")
        facts = self.info("c.obj")
        self.assertEqual(facts["colors"], {"min": [0, 0, 0], "max": [255, 255, 51]})
        self.assertEqual(facts["mean_color"], [85, 85, 17])
        self.assertEqual([warning["code"] for warning in facts["warnings"]], ["SKIPPED_ELEMENTS"])
        self.assertIn(facts["warnings"][0]["message"], latvox("info", self.dir / "c.obj").stdout)
        facts = self.info("m.obj")
        self.assertEqual((facts["colors"], facts["mean_color"], facts["warnings"]), (None, None, []))

    def test_a_mesh_may_have_gzip(self):
        (self.dir / "m.obj.gz").write_bytes(gzip.compress(self.mesh.read_bytes()))
        plain, packed = self.info("m.obj"), self.info("m.obj.gz")
        self.assertEqual((packed["format"], packed["triangles"], packed["bounds"]), ("obj", 8, plain["bounds"]))

    def test_others_are_refused(self):
        for name, says in (("x.txt", 'extension ".txt" is not one of .vdb .nvdb .h5 .csv .npy .npz'), ("x", 'extension "" is not one of')):
            (self.dir / name).write_text("x")
            done = latvox("info", self.dir / name)
            self.assertEqual((done.returncode, done.stdout), (3, ""))
            self.assertIn(says, done.stderr)
        for name in ("none.npz", "none.csv", "none.nvdb", "none.html", "none.ply", "none.obj"):
            done = latvox("info", self.dir / name)
            self.assertEqual((done.returncode, done.stdout), (3, ""), name)
            self.assertIn(name, done.stderr)
        (self.dir / "folder.csv").mkdir()
        self.assertIn("is not a regular file", latvox("info", self.dir / "folder.csv").stderr)

    def test_a_file_that_is_cut_short_or_changed_is_refused(self):
        images = "a.vti", "a.vtu", "a.nrrd", "a.mha", "a.nii", "a.nii.gz"
        self.write("a.vdb", "a.nvdb", "a.npy", "a.npz", "a.ply", "a.glb", "a.vox", "a.binvox", "a.png", *images)
        self.assertEqual(latvox("view", self.dir / "a.vdb", "-o", self.dir / "a.html").returncode, 0)
        for name in ("a.nvdb", "a.npy", "a.npz", "a.ply", "a.glb", "a.vox", "a.binvox", "a.png", "a.html", *images):
            data = (self.dir / name).read_bytes()
            for bad in (data[:-1], data[: len(data) // 2], data[:9], b"x" + data[1:], b""):
                (self.dir / name).write_bytes(bad)
                done = latvox("info", self.dir / name)
                self.assertEqual((done.returncode, done.stdout), (3, ""), (name, len(bad), done.stderr))
                self.assertRegex(done.stderr, rf"latvox: .*{name}: .")
                self.assertEqual(done.stderr.count("\n"), 1)
        for text in ("i,j\n", "i,j,k,x,y,z\n1,2,3,4,5\n", "i,j,k,x,y,z\n1,2,3,4,5,q\n", "i,j,k,x,y,z\n99999999999,2,3,4,5,6\n", "i,j,k,x,y,z\n" + "1" * 70000):
            (self.dir / "a.csv").write_text(text)
            self.assertEqual(latvox("info", self.dir / "a.csv").returncode, 3, text[:40])

    def test_declared_sizes_take_no_memory(self):
        header = b"{'descr': '|u1', 'fortran_order': False, 'shape': (%s), }"

        def npy(shape):
            text = (header % shape).ljust(117) + b"\n"
            return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text

        (self.dir / "a.npy").write_bytes(npy(b"1000000, 1000000, 1000000"))
        (self.dir / "b.npy").write_bytes(npy(b"4096, 4096, 4096"))
        with zipfile.ZipFile(self.dir / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("data.npy", npy(b"1024, 1024, 512") + b"\0" * 100)
        (self.dir / "a.ply").write_bytes(
            b"ply\nformat binary_little_endian 1.0\nelement vertex 4611686018427387904\n"
            b"property double x\nproperty double y\nproperty double z\nproperty int i\nproperty int j\nproperty int k\nend_header\n")
        (self.dir / "a.vox").write_bytes(b"VOX " + struct.pack("<I", 150) + b"MAIN" + struct.pack("<II", 0, 0xFFFFFFFF) + b"SIZE")
        (self.dir / "a.glb").write_bytes(b"glTF" + struct.pack("<III", 2, 0xFFFFFFF0, 0xFFFFFF00) + b"JSON{}")
        (self.dir / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 0xFFFFFFFF) + b"IHDR" + b"\0" * 8)
        for name in ("a.npy", "b.npy", "a.npz", "a.ply", "a.vox", "a.glb", "a.png"):
            limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))  # noqa: E731
            done = latvox("info", self.dir / name, preexec_fn=limit)
            self.assertEqual(done.returncode, 3, (name, done.stderr))
            self.assertIn(name, done.stderr)


if __name__ == "__main__":
    unittest.main()
