"""Several files of one command: written at once, each as by a command of its own, all or none."""

import itertools
import os
import resource
import signal
import subprocess
import unittest

from harness import BIN, BUNNY, Case, latvox

OK, OTHER, STOPPED = 0, 1, 6
JOB = ["voxelize", BUNNY, "--resolution", "60", "--fields", "distance"]
NAMES = ["a.csv", "a.h5", "a.nii.gz", "a.npy", "a.npz", "a.nrrd", "a.nvdb", "a.png", "a.vdb", "a.vti", "b.h5", "b.png", "b.vdb"]


def outputs(directory, names):
    return itertools.chain.from_iterable(("-o", directory / name) for name in names)


class Outputs(Case):
    def test_files_are_those_of_commands_of_their_own(self):
        alone, together = self.dir / "alone", self.dir / "together"
        for directory in (alone, together):
            directory.mkdir()
        for name in NAMES:
            self.assertEqual(latvox(*JOB, *outputs(alone, [name])).returncode, OK)
        self.assertEqual(latvox(*JOB, *outputs(together, NAMES)).returncode, OK)
        converted = self.dir / "converted"
        converted.mkdir()
        self.assertEqual(latvox("convert", together / "a.vdb", *outputs(converted, NAMES)).returncode, OK)
        self.assertEqual(sorted(path.name for path in together.iterdir()), NAMES)
        for name in NAMES:
            with self.subTest(name):
                expected = (alone / name).read_bytes()
                self.assertTrue((together / name).read_bytes() == expected, "voxelize")
                if not name.endswith(".csv"):  # whose order is that of the stream
                    self.assertTrue((converted / name).read_bytes() == expected, "convert")

    def test_the_first_file_that_fails_is_named_and_none_is_left(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

        old = self.dir / "a.npz"  # small enough to be written
        old.write_bytes(b"old")
        for order in itertools.permutations(["a.csv", "a.nii", "a.npz"]):
            first = next(name for name in order if name != "a.npz")
            with self.subTest(order):
                words = [BIN / "latvox", *map(str, JOB[:4]), *outputs(self.dir, order)]
                done = subprocess.run(words, capture_output=True, text=True, preexec_fn=limit)
                self.assertEqual(done.returncode, OTHER, done.stderr)
                self.assertEqual(done.stderr, f"latvox: {self.dir / first}: cannot be written (File too large)\n")
                self.assertEqual([path.name for path in self.dir.iterdir()], ["a.npz"])
                self.assertEqual(old.read_bytes(), b"old")

    def test_an_interrupt_in_the_midst_of_writing_leaves_nothing(self):
        """The pictures of a large scene take long enough to be met."""
        names = [f"{n}.png" for n in range(40)]
        words = [BIN / "latvox", *map(str, JOB[:2]), "--resolution", "700", *outputs(self.dir, names)]
        master, slave = os.openpty()  # a terminal, which is told the stage
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        told = b""
        while b"writing" not in told:
            told += os.read(master, 4096)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), STOPPED)
        os.close(master)
        self.assertEqual(list(self.dir.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
