"""A killed program leaves nothing behind that stays, and never a part of a file. Equal jobs write equal files."""

import contextlib
import hashlib
import json
import os
import signal
import subprocess
import time
import unittest

import harness
from harness import BIN, BUNNY, Case, latvox

EXTENSIONS = ["vdb", "nvdb", "csv", "npy", "npz", "ply", "png", "html", "glb", "vox", "binvox", "vti", "vtu", "nrrd", "mha", "nii", "nii.gz"]
LONG_JOB = ["voxelize", BUNNY, "--lattice", "cartesian", "--resolution", "700"]
KILLS = 12


def hashes(directory):
    """Returns name -> hash of all files, except those that a kill between the two last steps of a replacement leaves."""
    paths = [path for path in directory.iterdir() if not path.match(".latvox-*.part")]
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}


class Leftovers(Case):
    def setUp(self):
        super().setUp()
        self.out, self.runtime = self.dir / "out", self.dir / "runtime"
        self.out.mkdir()
        self.runtime.mkdir()
        temporary = {"XDG_RUNTIME_DIR": str(self.runtime), "TMPDIR": str(self.runtime)}
        self.environment = os.environ | temporary

    def start(self, *arguments, **options):
        return subprocess.Popen([BIN / "latvox", *map(str, arguments)], env=self.environment, **options)

    def kill_at(self, share, seconds, *arguments, **options):
        process = self.start(*arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **options)
        time.sleep(seconds * share)
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.assert_no_process_left()

    def seconds_of(self, *arguments):
        begun = time.monotonic()
        self.assertEqual(self.start(*arguments, stdout=subprocess.DEVNULL).wait(harness.PATIENCE), 0)
        return time.monotonic() - begun

    def test_a_killed_voxelize_leaves_no_unfinished_file(self):
        outputs = [word for name in ("o.vdb", "o.csv", "o.npz", "o.html") for word in ("-o", self.out / name)]
        command = ["voxelize", BUNNY, "--resolution", "300", *outputs]
        seconds = self.seconds_of(*command)
        whole = hashes(self.out)
        for n in range(KILLS):
            self.kill_at(n / KILLS, seconds, *command)
            self.assertEqual({**whole, **hashes(self.out)}, whole)
        for path in self.out.iterdir():
            path.unlink()
        for n in range(KILLS):
            self.kill_at(n / KILLS, seconds, *command)
            self.assertEqual({**whole, **hashes(self.out)}, whole)
        self.seconds_of(*command)
        self.assertEqual(set(os.listdir(self.out)), set(whole))

    def test_the_directory_of_a_killed_programs_server_goes_with_the_next_program(self):
        for _ in range(KILLS):
            process = self.start(*LONG_JOB, "-o", self.out / "o.csv", stderr=subprocess.DEVNULL)
            while not any(self.runtime.iterdir()):
                self.assertIsNone(process.poll())
                time.sleep(0.001)
            process.send_signal(signal.SIGKILL)
            process.wait()
            self.assert_no_process_left()
            self.assertLessEqual(len(list(self.runtime.iterdir())), 1)
        self.assertEqual(self.start("limits", stdout=subprocess.DEVNULL).wait(harness.PATIENCE), 0)
        self.assertEqual(list(self.runtime.iterdir()), [])

    def test_the_directory_of_a_killed_standard_output_goes_and_that_of_a_living_one_stays(self):
        command = ["voxelize", "-", "--resolution", "9", "-o", "-"]  # waits for its mesh
        living, dead = (
            self.start(*command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for _ in range(2)
        )
        for process in (living, dead):
            self.addCleanup(process.wait)
            self.addCleanup(process.kill)
            self.addCleanup(process.stdin.close)
        # A directory of its file, and one of its server, each.
        harness.await_true("the programs do not make their directories", lambda: len(list(self.runtime.iterdir())) == 4)
        time.sleep(0.5)  # both have their locks
        dead.kill()
        dead.wait()
        self.assertEqual(len(list(self.runtime.iterdir())), 4)
        self.assertEqual(self.start("limits", stdout=subprocess.DEVNULL).wait(harness.PATIENCE), 0)
        self.assertEqual(len(list(self.runtime.iterdir())), 2)

    def test_a_killed_batch_leaves_nothing_after_its_resumption(self):
        jobs = self.dir / "jobs.jsonl"
        lines = [{"mesh": str(BUNNY), "resolution": 200 + n, "out": f"{n % 2}/{n}.vdb"} for n in range(16)]
        jobs.write_text("".join(json.dumps(line) + "\n" for line in lines))
        command = ["batch", jobs, "--out", self.out, "--resume"]
        for n in range(8):
            self.kill_at(1, 0.3 + n / 10, *command)
        self.assertEqual(self.start(*command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).wait(300), 0)
        found = sorted(str(path.relative_to(self.out)) for path in self.out.rglob("*") if path.is_file())
        self.assertEqual(found, sorted([*(line["out"] for line in lines), "results.jsonl"]))
        self.assertEqual(list(self.runtime.iterdir()), [])

    def test_a_file_appears_under_no_other_name(self):
        process = self.start(*LONG_JOB, "-o", self.out / "o.csv", stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        names = set()
        while process.poll() is None:
            for entry in os.scandir(self.out):
                # A program first tries whether an unnamed file can get a name: an empty one has it for a moment.
                with contextlib.suppress(FileNotFoundError):
                    if entry.stat().st_size != 0:
                        names.add(entry.name)
        self.assertEqual((process.returncode, names | set(os.listdir(self.out))), (0, {"o.csv"}))


class Names(Case):
    def test_names_of_the_greatest_length_can_be_written(self):
        mesh = harness.write_obj(self.dir / "octahedron.obj", harness.octahedron())
        out = self.dir / "out"
        out.mkdir()
        for length in (240, 255):
            paths = [out / ("n" * (length - len(extension) - 1) + "." + extension) for extension in EXTENSIONS]
            outputs = [word for path in paths for word in ("-o", path)]
            for _ in range(2):  # the second one replaces the first
                done = latvox("voxelize", mesh, "--lattice", "cartesian", "--resolution", "9", *outputs)
                self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual({*os.listdir(out)}, {path.name for path in paths})
            for path in paths:
                path.unlink()

    def test_a_longer_name_is_refused_before_the_work(self):
        path = self.dir / ("n" * 252 + ".vdb")
        begun = time.monotonic()
        done = latvox("voxelize", BUNNY, "--resolution", "4000", "-o", path)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"n\.vdb: cannot be written \(File name too long\)")
        self.assertLess(time.monotonic() - begun, harness.PATIENCE / 2)


class EqualJobs(Case):
    def twice(self, *arguments, names):
        """Returns, for each name, the hashes that two runs of a command gave."""
        found = []
        for _ in range(2):
            done = latvox(*arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            found.append([hashlib.sha256((self.dir / name).read_bytes()).hexdigest() for name in names])
            for name in names:
                (self.dir / name).unlink()
            time.sleep(1.1)  # formats with times have at least seconds
        return zip(names, *found, strict=True)

    def assert_equal_runs(self, *arguments, names):
        outputs = [word for name in names for word in ("-o", self.dir / name)]
        for name, first, second in self.twice(*arguments, *outputs, names=names):
            with self.subTest(name, command=arguments[0]):
                self.assertEqual(first, second)

    def test_all_formats(self):
        names = [f"out.{extension}" for extension in EXTENSIONS]
        self.assert_equal_runs("voxelize", BUNNY, "--lattice", "cartesian", "--resolution", "40", names=names)

    def test_all_formats_of_bands_and_of_values(self):
        names = [f"out.{extension}" for extension in ("vdb", "csv", "npy", "npz", "ply", "png", "html")]
        self.assert_equal_runs("voxelize", BUNNY, "--resolution", "30", "--band", "0.1", names=names)
        self.assert_equal_runs("voxelize", BUNNY, "--resolution", "30", "--fields", "part", names=names)

    def test_files_made_of_files(self):
        a, b, parts = self.dir / "a.vdb", self.dir / "b.vdb", [self.dir / "0.vdb", self.dir / "1.vdb"]
        shards = [(part, ["--shard", f"{n}/2"]) for n, part in enumerate(parts)]
        for path, options in ((a, []), (b, ["--separability", "2"]), *shards):
            common = ["--lattice", "cartesian", "--resolution", "50"]
            self.assertEqual(latvox("voxelize", BUNNY, *common, *options, "-o", path).returncode, 0)
        self.assert_equal_runs("merge", *parts, names=["merged.vdb"])
        self.assert_equal_runs("render", a, names=["o.png"])
        self.assert_equal_runs("view", a, names=["o.html"])
        self.assert_equal_runs("encode", BUNNY, names=["o.drc"])
        outputs = ["-o", self.dir / "d.vdb", "-o", self.dir / "d.png"]
        found = []
        for _ in range(2):
            self.assertEqual(latvox("compare", a, b, *outputs).returncode, 1)
            found.append([hashlib.sha256((self.dir / name).read_bytes()).hexdigest() for name in ("d.vdb", "d.png")])
        self.assertEqual(*found)

    def test_other_voxels_have_another_uuid(self):
        uuids = set()
        for resolution in ("20", "21"):
            path = self.dir / f"{resolution}.vdb"
            self.assertEqual(latvox("voxelize", BUNNY, "--resolution", resolution, "-o", path).returncode, 0)
            uuids.add(path.read_bytes()[21:57])
        self.assertEqual(len(uuids), 2)
        for uuid in uuids:
            self.assertRegex(uuid, rb"^[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$")


if __name__ == "__main__":
    unittest.main()
