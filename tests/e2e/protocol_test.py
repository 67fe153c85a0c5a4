"""proto/check finds changes of the protocol that break programs of others."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUF = ROOT / "tests/node/node_modules/.bin/buf"


class Protocol(unittest.TestCase):
    def setUp(self):
        self.proto = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-protocol-"))) / "proto"
        shutil.copytree(ROOT / "proto", self.proto)
        self.file = self.proto / "latvox/v1/voxelizer.proto"

    def check(self, *folder):
        return subprocess.run([self.proto / "check", *folder], env=os.environ | {"LATVOX_BUF": str(BUF)}, capture_output=True, text=True)

    def replace(self, old, new):
        text = self.file.read_text()
        self.assertEqual(text.count(old), 1, old)
        self.file.write_text(text.replace(old, new))

    def test_the_protocol_keeps_what_others_rely_on(self):
        done = self.check()
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_a_field_of_another_number_is_found(self):
        self.replace("  bool verify = 8;", "  bool verify = 99;")
        done = self.check()
        self.assertNotEqual(done.returncode, 0)
        self.assertIn('field "8" with name "verify"', done.stdout)

    def test_a_new_field_is_no_breach(self):
        self.replace("  bool verify = 8;", "  bool verify = 8;\n\n  // For this test.\n  bool another = 99;")
        self.assertEqual(self.check().returncode, 0)

    def test_another_copy_can_be_named(self):
        shutil.move(self.proto / "released", self.proto.parent / "last")
        last = self.proto.parent / "last"
        self.assertEqual(self.check(last).returncode, 0)
        self.replace("  bool verify = 8;", "  bool verify = 99;")
        self.assertNotEqual(self.check(last).returncode, 0)

    def test_a_missing_copy_is_told(self):
        (self.proto / "released/latvox/v1/voxelizer.proto").unlink()
        done = self.check()
        self.assertEqual((done.returncode, done.stderr), (1, "proto/check: proto/released/latvox/v1/voxelizer.proto is missing\n"))


if __name__ == "__main__":
    unittest.main()
