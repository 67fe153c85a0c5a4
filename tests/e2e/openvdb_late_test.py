"""The tool loads OpenVDB only for files that need it, and says what is missing."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

from harness import BIN, BUNNY, Case, latvox

MODULE = "latvox-vdb.so"


def loaded(*words):
    """Returns the libraries that a command and its processes load, by the system's loader."""
    environment = os.environ | {"LD_DEBUG": "files"}
    done = subprocess.run([BIN / "latvox", *map(str, words)], env=environment, capture_output=True, text=True, check=True)
    return set(re.findall(r"file=(\S+) \[0\];  (?:generating link map|dynamically loaded)", done.stderr))


def openvdb(libraries):
    return {name for name in libraries if "openvdb" in name or name.endswith(MODULE)}


class Late(Case):
    def test_commands_without_grids_load_no_openvdb(self):
        for words in ["--version"], ["info", BUNNY]:
            libraries = loaded(*words)
            self.assertIn("libgrpc++.so.1.51", libraries)
            self.assertEqual(openvdb(libraries), set(), words)

    def test_other_files_are_written_without_openvdb(self):
        for out in "a.vdb", "a.npz", "a.csv", "a.png", "a.glb", "a.nrrd", "a.vti", "a.h5":
            words = "voxelize", BUNNY, "--resolution", "16", "-o", self.dir / out
            self.assertEqual(openvdb(loaded(*words)), set(), out)

    def test_grids_are_read_and_those_of_fields_written_by_it(self):
        path = self.dir / "a.vdb"
        words = "voxelize", BUNNY, "--resolution", "16", "-o"
        for out in [self.dir / "a.nvdb"], [path, "--fields", "triangle"]:
            self.assertEqual(len(openvdb(loaded(*words, *out))), 2)
        self.assertEqual(latvox("info", path).returncode, 0)

    def test_the_module_has_no_protocol(self):
        listed = subprocess.run(["ldd", BIN / MODULE], capture_output=True, text=True, check=True).stdout
        self.assertIn("libopenvdb", listed)
        self.assertNotRegex(listed, "protobuf|grpc")  # messages that are registered twice would end the program

    def test_the_server_has_no_openvdb(self):
        listed = subprocess.run(["ldd", BIN / "latvoxd"], capture_output=True, text=True, check=True).stdout
        self.assertIn("libgrpc++", listed)
        self.assertNotIn("openvdb", listed)


class Missing(Case):
    """A copy of the programs without the module."""

    def setUp(self):
        super().setUp()
        self.bin = self.dir / "bin"
        self.bin.mkdir()
        for name in "latvox", "latvoxd":
            shutil.copy(BIN / name, self.bin)

    def run_copy(self, *words):
        return subprocess.run([self.bin / "latvox", *map(str, words)], capture_output=True, text=True, timeout=60)

    def refused(self, *words):
        done = self.run_copy(*words)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def test_each_use_tells_the_file_and_the_package(self):
        whole, other = self.dir / "whole.vdb", self.dir / "other.vdb"
        self.voxelize(BUNNY, "--resolution", "16", out=whole.name)
        self.voxelize(BUNNY, "--resolution", "17", out=other.name)
        before = sorted(self.dir.iterdir())
        for words in (
            ["voxelize", BUNNY, "--resolution", "16", "--fields", "triangle", "-o", self.dir / "a.vdb"],
            ["voxelize", BUNNY, "--resolution", "16", "-o", self.dir / "a.nvdb"],
            ["voxelize", BUNNY, "--resolution", "16", "-o", self.dir / "a.html"],
            ["info", whole],
            ["convert", whole, "-o", self.dir / "a.csv"],
            ["compare", whole, other, "-o", self.dir / "a.vdb"],
            ["merge", whole, other, "-o", self.dir / "a.vdb"],
        ):  # fmt: skip
            line = self.refused(*words)
            self.assertRegex(line, rf"^latvox: /\S+/latvox/{MODULE}: no such file; this part of the package latvox ")
            self.assertEqual(sorted(self.dir.iterdir()), before, words)

    def test_other_files_need_no_module(self):
        for out in self.dir / "a.npz", self.dir / "a.vdb":
            done = self.run_copy("voxelize", BUNNY, "--resolution", "16", "-o", out)
            self.assertEqual((done.returncode, out.exists()), (0, True), done.stderr)

    def test_the_module_is_found_where_it_is_installed(self):
        path = self.dir / "a.vdb"
        line = self.refused("voxelize", BUNNY, "--fields", "triangle", "-o", path)
        (module,) = re.findall(r"^latvox: (/\S+): no such file", line)
        pathlib.Path(module).parent.mkdir(parents=True)
        shutil.copy(BIN / MODULE, module)
        self.assertEqual(self.run_copy("voxelize", BUNNY, "--resolution", "16", "-o", path).returncode, 0)
        self.assertEqual(self.run_copy("info", path).returncode, 0)

    def test_a_module_that_is_none(self):
        whole = self.dir / "whole.vdb"
        self.voxelize(BUNNY, "--resolution", "16", out=whole.name)
        (self.bin / MODULE).write_text("no library")
        for words in ["info", whole], ["voxelize", BUNNY, "-o", self.dir / "a.nvdb"]:
            self.assertIn(f"bin/{MODULE}: cannot be loaded (", self.refused(*words))


if __name__ == "__main__":
    unittest.main()
