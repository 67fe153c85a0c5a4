"""Damaged .vdb files end with status 3 and one line; the process that reads them never outlives its parent."""

import contextlib
import os
import pathlib
import random
import signal
import struct
import subprocess
import time
import unittest

import harness
from harness import BIN, BUNNY, Case, latvox

HEADER = struct.pack("<qIIIb", 0x56444220, 224, 10, 0, 1) + b"00000000-0000-0000-0000-000000000000"


def offspring(pid):
    """Returns the ids of a process's children."""
    return [int(word) for file in pathlib.Path(f"/proc/{pid}/task").glob("*/children") for word in file.read_text().split()]


class Damaged(Case):
    def claims(self, length):
        """Returns a file whose first metadata have a name of this length, and nothing behind it."""
        path = self.dir / "claims.vdb"
        path.write_bytes(HEADER + struct.pack("<II", 1, length))
        return path

    def refused(self, *words):
        done = latvox(*words)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def slow(self, *words, **options):
        """Starts a command that reads for a second, and stops its reader as soon as that is confined. Returns both."""
        process = subprocess.Popen([BIN / "latvox", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)
        deadline = time.monotonic() + harness.PATIENCE
        while time.monotonic() < deadline:
            for reader in offspring(process.pid):
                with contextlib.suppress(OSError):
                    if "Seccomp:\t2" in pathlib.Path(f"/proc/{reader}/status").read_text():
                        os.kill(reader, signal.SIGSTOP)
                        return process, reader
            time.sleep(0.001)
        process.kill()
        process.communicate()
        self.fail("there is no reader with a filter of system calls")

    def test_one_changed_bit_is_an_error_or_another_file(self):
        path, mutant = self.dir / "bunny.vdb", self.dir / "mutant.vdb"
        self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", "256", out=path.name)
        whole, crashes, chance = path.read_bytes(), 0, random.Random(5)
        for _ in range(40):
            at = chance.randrange(3000, len(whole) // 3)  # the nodes of the tree
            bad = bytearray(whole)
            bad[at] ^= 1 << chance.randrange(8)
            mutant.write_bytes(bad)
            done = latvox("info", mutant)
            self.assertIn(done.returncode, (0, 3), (at, done.stderr))
            if done.returncode == 3:
                self.assertRegex(done.stderr, r"^latvox: .*mutant\.vdb: is (not a readable|damaged).*\n$")
                crashes += "the library that read it ends with signal" in done.stderr
        self.assertGreater(crashes, 0, "no file crashes OpenVDB, so this test shows nothing")

    # OpenVDB's library starts threads when it is loaded. The sandbox closes while they start.
    def test_a_whole_file_is_read_each_time(self):
        self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", "32", out="bunny.vdb")
        for _ in range(40):
            done = latvox("info", self.dir / "bunny.vdb")
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_lengths_that_a_file_claims(self):
        path = self.claims(0xFFFFFFFF)
        for words in ["info", path], ["compare", path, path], ["view", path, "-o", self.dir / "out.html"]:
            line = self.refused(*words)
            self.assertIn("claims.vdb: is damaged, or needs more than 4294967296 bytes of memory to read", line)
        self.assertIn("(it is cut short)", self.refused("info", self.claims(100)))
        line = self.refused("merge", self.claims(0xFFFFFFFF), "-o", self.dir / "out.vdb")
        self.assertIn("it is cut short: 65 bytes, and 12 more are needed at 61", line)
        self.assertFalse((self.dir / "out.vdb").exists())

    def test_what_is_no_file(self):
        os.mkfifo(self.dir / "pipe.vdb")
        self.assertIn("pipe.vdb: is not a file", self.refused("info", self.dir / "pipe.vdb"))
        self.assertIn("no such file", self.refused("info", self.dir / "none.vdb"))
        (self.dir / "folder.vdb").mkdir()
        self.assertIn("Is a directory", self.refused("info", self.dir / "folder.vdb"))

    @unittest.skipUnless(os.geteuid() == 0, "only root sees the environment of a confined process")
    def test_the_reader_learns_no_secrets(self):
        secrets = {"LD_LIBRARY_PATH": str(self.dir), "LATVOX_TOKEN": "secret", "HOME": "/home/somebody"}
        process, reader = self.slow("info", self.claims(0x70000000), env=secrets)
        environment = pathlib.Path(f"/proc/{reader}/environ").read_bytes()
        process.kill()
        process.communicate()
        self.assertEqual(environment, f"LD_LIBRARY_PATH={self.dir}\0".encode())

    def test_nobody_survives_kill(self):
        process, _ = self.slow("info", self.claims(0x70000000))
        process.kill()
        process.communicate()
        self.assert_no_process_left()

    def test_an_interrupt_ends_both(self):
        path = self.claims(0x70000000)
        for words, status in (["info", path], -signal.SIGINT), (["compare", path, path], 6):
            with self.subTest(words[0]):
                process, _ = self.slow(*words)
                process.send_signal(signal.SIGINT)
                self.assertEqual(process.wait(harness.PATIENCE), status, process.communicate())
                process.communicate()
                self.assert_no_process_left()


if __name__ == "__main__":
    unittest.main()
