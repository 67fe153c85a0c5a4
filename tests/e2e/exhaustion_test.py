"""Little memory, few threads: each command ends with one line and a documented exit status, never by a signal."""

import itertools
import os
import resource
import subprocess
import unittest

import harness
from harness import BIN, BUNNY, Case, latvox

OK, REFUSED = 0, 5
LIGHT = ("version", "help", "man", "completions")  # commands that are content with the least of the limits
LOADER = 127  # the system's loader cannot map the libraries
KIB = 1024
NO_THREAD = "latvox: a thread cannot be started (ulimit -u, or the control group's pids.max)\n"


class Exhaustion(Case):
    def setUp(self):
        super().setUp()
        self.vdb = self.dir / "bunny.vdb"
        self.assertEqual(latvox("voxelize", BUNNY, "--resolution", "300", "-o", self.vdb).returncode, 0)
        (self.dir / "jobs.jsonl").write_text('{"mesh": "%s", "resolution": 20}\n' % BUNNY)
        (self.dir / "curve.txt").write_text("0 0\n1 0\n1 1\n\n")

    def limited(self, kind, limit, *arguments):
        command = [BIN / "latvox", *map(str, arguments)]
        set_limit = lambda: resource.setrlimit(kind, (limit, limit))  # noqa: E731
        return subprocess.run(command, capture_output=True, text=True, preexec_fn=set_limit, timeout=harness.PATIENCE, cwd=self.dir)

    def commands(self):
        return {
            "version": ["--version"],
            "help": ["voxelize", "--help"],
            "man": ["man"],
            "completions": ["completions", "bash"],
            "voxelize": ["voxelize", BUNNY, "--resolution", "100", "-o", "o.vdb", "-o", "o.png", "-o", "o.glb"],
            "batch": ["batch", "jobs.jsonl", "--out", "batch"],
            "pixelize": ["pixelize", "curve.txt", "--pixel-size", "0.1", "-o", "o.csv"],
            "encode": ["encode", BUNNY, "-o", "o.drc"],
            "merge": ["merge", self.vdb, "-o", "merged.vdb"],
            "render": ["render", self.vdb, "-o", "r.png"],
            "slice": ["slice", self.vdb, "--axis", "z", "--index", "100", "-o", "s.png"],
            "view": ["view", self.vdb, "-o", "v.html"],
            "compare": ["compare", self.vdb, self.vdb],
            "info": ["info", self.vdb],
            "limits": ["limits"],
        }

    def assert_orderly(self, done):
        """An exit status of the documentation, and one line about an error."""
        self.assertIn(done.returncode, (0, 1, 3, 4, 5, LOADER), done.stderr)
        if done.returncode == LOADER:
            self.assertIn("error while loading shared libraries", done.stderr)
        elif done.returncode != OK:
            self.assertRegex(done.stderr.splitlines()[-1], "^latvox: ")
            self.assertNotIn("terminate called", done.stderr)

    def test_a_limit_of_the_address_space(self):
        for name, arguments in self.commands().items():
            statuses = set()
            for mib in (40, 60, 80, 90, 100, 110, 120, 140, 160, 200, 250, 300, 400):
                with self.subTest(name, mib=mib):
                    done = self.limited(resource.RLIMIT_AS, mib << 20, *arguments)
                    self.assert_orderly(done)
                    statuses.add(done.returncode)
            self.assertIn(OK if name in LIGHT else REFUSED, statuses, name)

    def test_the_line_names_the_limit(self):
        line = "latvox: not enough memory within the limit of 100000 KiB (ulimit -v): 131072 KiB more are needed\n"
        for words in ["limits"], ["info", self.vdb], ["voxelize", BUNNY, "-o", "o.vdb"]:
            done = self.limited(resource.RLIMIT_AS, 100000 * KIB, *words)
            self.assertEqual((done.returncode, done.stderr), (REFUSED, line))

    @unittest.skipIf(os.geteuid() != 0, "only root can become a user without other processes")
    def test_a_limit_of_threads(self):
        users = itertools.count(54321)  # the limit counts the ended processes of a user that nobody has waited for

        def limit(count):
            def become(user=next(users)):
                resource.setrlimit(resource.RLIMIT_NPROC, (count, count))
                os.setuid(user)

            return become

        enough = 64 + 8 * os.cpu_count()  # tool and server have threads for each core
        for command in (["--version"], ["voxelize", BUNNY, "--resolution", "30", "--json"], ["limits"]):
            for count in (1, 2, 4, 6, 8, 10, 12, 14, 15, 16, 18, 20, 22, 24, 26, 28, 32, 36, enough):
                with self.subTest(command[0], threads=count):
                    done = subprocess.run([BIN / "latvox", *command], capture_output=True, text=True,
                                          preexec_fn=limit(count), timeout=harness.PATIENCE, cwd="/")  # fmt: skip
                    self.assert_orderly(done)
                    if command == ["--version"]:  # which needs none
                        self.assertEqual((done.returncode, done.stderr), (OK, ""))
                    elif count == 1:
                        self.assertEqual((done.returncode, done.stderr), (REFUSED, NO_THREAD))
        self.assertEqual(done.returncode, OK)  # with enough threads

    def test_a_usual_limit_of_clusters_suffices(self):
        done = self.limited(resource.RLIMIT_AS, 1000000 * KIB, "voxelize", BUNNY, "--resolution", "100", "-o", "o.vdb")
        self.assertEqual((done.returncode, done.stderr), (OK, ""))

    def test_other_limits_below_the_wish_are_kept(self):
        for kind, limit in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_FSIZE, 1 << 30), (resource.RLIMIT_NOFILE, 64)):
            done = self.limited(kind, limit, "voxelize", BUNNY, "--resolution", "100", "-o", "o.vdb")
            self.assertEqual((done.returncode, done.stderr), (OK, ""))


if __name__ == "__main__":
    unittest.main()
