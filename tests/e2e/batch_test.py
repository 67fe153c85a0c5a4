"""Many meshes in one command: a failure stops nothing else, finished jobs are not repeated, and workers together do the
whole."""

import collections
import contextlib
import json
import os
import pathlib
import pty
import re
import signal
import subprocess
import time
import unittest

import harness
from harness import BIN, BUNNY, Case, encode_drc, latvox, octahedron, write_obj, write_ply, write_stl

OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED, STOPPED = range(7)
ENGINES = ("JOB_COMPLETION_INDEX", "LATVOX_WORKER_COUNT", "SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN")
LONG = {"mesh": str(BUNNY), "resolution": 30000, "out": "long.csv"}  # minutes of work


class Batch(Case):
    def setUp(self):
        super().setUp()
        for name in ENGINES:
            os.environ.pop(name, None)
        self.out = self.dir / "out"
        self.mesh = write_obj(self.dir / "octahedron.obj", octahedron())

    def jobs(self, *jobs):
        path = self.dir / "jobs.jsonl"
        path.write_text("".join((job if isinstance(job, str) else json.dumps(job)) + "\n" for job in jobs))
        return path

    def small(self, count):
        """Returns different jobs that take no time."""
        return [{"mesh": "octahedron.obj", "resolution": 8 + n, "out": f"{n}.vdb"} for n in range(count)]

    def batch(self, jobs, *options, out=None, code=OK, **environment):
        done = latvox("batch", jobs, "--out", out or self.out, *options, env=os.environ | environment)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def start(self, jobs, *options, stderr=subprocess.PIPE):
        command = [BIN / "latvox", "batch", jobs, "--out", self.out, *options]
        client = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=stderr, text=True)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        if client.stderr:
            self.addCleanup(client.stderr.close)
        return client

    def wait_for_lines(self, client, count, name="results.jsonl"):
        deadline = time.monotonic() + harness.PATIENCE
        while not (self.out / name).exists() or len((self.out / name).read_text().splitlines()) < count:
            self.assertIsNone(client.poll(), "the batch has ended already")
            self.assertLess(time.monotonic(), deadline, "no results come")
            time.sleep(0.01)

    def results(self, name="results.jsonl", out=None):
        return [json.loads(line) for line in ((out or self.out) / name).read_text().splitlines()]

    def digests(self, results):
        return {r["id"]: r["summary"]["digest"] for r in results if r["status"] == "done"}

    def outputs(self, out=None):
        """Returns all output files except results."""
        out = out or self.out
        files = (path for path in out.rglob("*") if path.is_file())
        return sorted(str(path.relative_to(out)) for path in files if not path.name.startswith("results"))


class Jobs(Batch):
    def test_each_job_gives_the_result_of_voxelize(self):
        write_ply(self.dir / "a.ply", octahedron(2))
        write_stl(self.dir / "b.stl", octahedron(3))
        encode_drc(self.dir / "c d.drc", self.mesh)
        jobs = self.jobs(
            {"mesh": "octahedron.obj", "resolution": 20, "verify": True},
            "",
            {"mesh": "a.ply", "lattice": "bcc", "voxel_size": 0.1, "out": ["deep/er/a.csv", "a.vdb", "a.png"], "id": "first"},
            {"mesh": str(self.dir / "b.stl"), "resolution": 30, "lattice": "fcc", "separability": 1, "minimal": False, "out": "b.npy"},
            {"mesh": f"file://{self.dir}/c%20d.drc", "basis": [0.1, 0, 0, 0, 0.1, 0, 0.05, 0.05, 0.05], "origin": [1, 2, 3]},
        )
        done = self.batch(jobs, "--json")
        self.assertEqual(done.stderr, "")
        summary = json.loads(done.stdout)
        self.assertEqual((summary["jobs"], summary["done"], summary["failed"], summary["skipped"]), (4, 4, 0, 0))
        self.assertEqual(summary["results"], str(self.out / "results.jsonl"))
        results = sorted(self.results(), key=lambda r: r["line"])
        self.assertEqual([r["line"] for r in results], [1, 3, 4, 5])
        self.assertEqual([r["id"] for r in results], ["octahedron.vdb", "first", "b.npy", "c d.vdb"])
        self.assertEqual({r["status"] for r in results}, {"done"})
        self.assertEqual(self.outputs(), ["a.png", "a.vdb", "b.npy", "c d.vdb", "deep/er/a.csv", "octahedron.vdb"])
        single = [
            self.voxelize(self.mesh, "--resolution", 20, "--verify"),
            self.voxelize(self.dir / "a.ply", "--lattice", "bcc", "--voxel-size", "0.1"),
            self.voxelize(self.dir / "b.stl", "--resolution", 30, "--lattice", "fcc", "--separability", 1, "--no-minimal"),
            self.voxelize(self.dir / "c d.drc", "--basis", "0.1,0,0,0,0.1,0,0.05,0.05,0.05", "--origin", "1,2,3"),
        ]
        for result, alone in zip(results, single):
            self.assertEqual(result["summary"].keys(), alone.keys())
            for key in ("digest", "voxels", "certificate", "basis", "origin", "mesh"):
                self.assertEqual(result["summary"][key], alone[key], key)
        self.assertEqual(self.voxelize(self.dir / "a.ply", "--lattice", "bcc", "--voxel-size", "0.1", out="a.csv")["voxels"], single[1]["voxels"])
        self.assertEqual((self.out / "deep/er/a.csv").read_text(), (self.dir / "a.csv").read_text())

    def test_lines_can_be_parts_of_one_mesh(self):
        request = {"mesh": str(BUNNY), "lattice": "bcc", "resolution": 256}
        parts = [{**request, "shard": f"{n}/3", "out": f"{n}.csv"} for n in range(3)]
        self.batch(self.jobs({**request, "out": "whole.csv"}, *parts))
        voxels = [harness.rows(self.out / name) for name in ("whole.csv", "0.csv", "1.csv", "2.csv")]
        self.assertEqual([len(part) > 0 for part in voxels], [True] * 4)
        self.assertEqual(sum(len(part) for part in voxels[1:]), len(voxels[0]))
        self.assertEqual(voxels[1] | voxels[2] | voxels[3], voxels[0])

    def test_several_meshes_are_one_and_jobs_may_come_by_standard_input(self):
        mesh, options = [str(self.mesh), str(BUNNY)], ["--resolution", "20", "--quantization", "0"]
        wanted = self.voxelize(self.mesh, BUNNY, *options)["digest"]
        jobs = self.jobs({"mesh": mesh, "resolution": 20, "quantization": 0}, *self.small(1))
        for resume in [], ["--resume"]:
            with open(jobs, "rb") as lines:
                done = latvox("batch", "-", "--out", self.out, *resume, stdin=lines, cwd=self.dir)
            self.assertEqual(done.returncode, OK, done.stderr)
        self.assertEqual(self.digests(self.results())["octahedron.vdb"], wanted)
        self.assertEqual([r["mesh"] for r in self.results() if r["status"] == "done"].count(" + ".join(mesh)), 1)
        done = latvox("batch", "-", "--out", self.out, input='{"mesh": 3}\n')
        self.assertEqual(done.returncode, BAD_INPUT)
        self.assertIn("standard input:1: mesh: 3 is not a path", done.stderr)

    def test_a_failed_job_stops_no_other(self):
        (self.dir / "broken.ply").write_text("this is no mesh\n")
        small = self.small(3)
        jobs = self.jobs(small[0], {"mesh": "missing.obj", "resolution": 8}, small[1], {"mesh": "broken.ply", "resolution": 8}, small[2])
        done = self.batch(jobs, code=BAD_INPUT)
        self.assertRegex(done.stdout, "^3 of 5 jobs done, 2 failed in ")
        failures = sorted(done.stderr.splitlines())
        self.assertEqual(len(failures), 2, done.stderr)
        self.assertRegex(failures[0], r"^latvox: .*/jobs\.jsonl:2: .*/missing\.obj: no such file$")
        self.assertRegex(failures[1], r"^latvox: .*/jobs\.jsonl:4: .*/broken\.ply: ")
        self.assertEqual(self.outputs(), ["0.vdb", "1.vdb", "2.vdb"])
        results = {r["line"]: r for r in self.results()}
        self.assertEqual({line: r["status"] for line, r in results.items()}, {1: "done", 2: "failed", 3: "done", 4: "failed", 5: "done"})
        self.assertEqual(results[2]["error"]["code"], "NOT_FOUND")
        self.assertEqual(results[2]["error"]["exit_status"], BAD_INPUT)
        self.assertIn("missing.obj", results[2]["error"]["message"])

    def test_a_mesh_that_does_not_come_is_waited_for_until_the_timeout(self):
        os.mkfifo(self.dir / "silent.ply")  # which nobody opens to write
        jobs = self.jobs({"mesh": "silent.ply", "resolution": 8}, *self.small(1))
        done = self.batch(jobs, "--jobs", "1", "--timeout", "2", code=STOPPED)
        self.assertRegex(done.stderr, r"jobs\.jsonl:1: the --timeout passed\n$")
        self.assertEqual(self.outputs(), ["0.vdb"])

    def test_a_mesh_beyond_memory_fails_its_job_alone(self):
        (self.dir / "huge.ply").touch()
        os.truncate(self.dir / "huge.ply", 8 << 30)  # a hole
        jobs = self.jobs({"mesh": "huge.ply", "resolution": 8}, *self.small(1))
        command = ["prlimit", f"--as={4 << 30}", BIN / "latvox", "batch", jobs, "--out", self.out, "--jobs", "1"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=harness.PATIENCE)
        self.assertRegex(done.stderr, r"jobs\.jsonl:1: .*/huge\.ply: is larger than the available memory\n$")
        self.assertEqual((done.returncode, self.outputs()), (REFUSED, ["0.vdb"]))

    def test_wrong_lines_are_all_named_and_nothing_is_run(self):
        jobs = self.jobs(
            *self.small(1),
            {"mesh": "octahedron.obj", "resolution": 70000},
            "# a comment",
            {"mesh": "octahedron.obj", "resolution": 8, "out": "0.vdb"},
        )
        for options in ([], ["--worker", "0/4"]):
            lines = self.batch(jobs, *options, code=BAD_INPUT).stderr.splitlines()
            self.assertEqual(len(lines), 4, lines)
            self.assertRegex(lines[0], r"jobs\.jsonl:2: resolution: .*70000.*65536")
            self.assertRegex(lines[1], r"jobs\.jsonl:3: not JSON")
            self.assertRegex(lines[2], r"jobs\.jsonl:4: out: .*0\.vdb.*line 1")
            self.assertRegex(lines[3], r"3 of 4 jobs are wrong; no job was run")
            self.assertFalse(self.out.exists())

    def test_the_exit_status_is_that_of_the_failures_or_1_for_several(self):
        large = {"mesh": str(BUNNY), "resolution": 16}
        missing = {"mesh": "missing.obj", "resolution": 8}
        with harness.server(self.dir, "--max-triangles", "100") as server:
            remote = ["--server", server.address]
            self.batch(self.jobs(*self.small(2), large), *remote, code=REFUSED)
            self.batch(self.jobs(*self.small(2), large, missing), *remote, code=OTHER)
            self.batch(self.jobs({**LONG, "mesh": "octahedron.obj"}, *self.small(2)), *remote, "--timeout", "1", code=STOPPED)
        self.assertEqual([r["error"]["code"] for r in self.results() if r["id"] == "long.csv"], ["DEADLINE_EXCEEDED"])
        self.assertEqual(self.outputs(), ["0.vdb", "1.vdb"])

    def test_wrong_usage_is_2_and_no_server_is_4(self):
        jobs = self.jobs(*self.small(1))
        for options, says in (
            (["--worker", "3/3"], r"--worker: \"3/3\""),
            (["--jobs", "0"], r"--jobs: \"0\".* 1 to 256"),
            (["--frobnicate"], "frobnicate"),
        ):
            self.assertRegex(self.batch(jobs, *options, code=USAGE).stderr, says)
        self.assertRegex(self.batch(jobs, "--server", f"unix:{self.dir}/nobody", code=UNREACHABLE).stderr, "nobody")
        self.assertEqual(self.results(), [])
        self.assertRegex(self.batch(self.dir / "none.jsonl", code=BAD_INPUT).stderr, "none.jsonl")

    def test_a_private_server_that_dies_fails_its_jobs_and_another_does_the_others(self):
        jobs = self.jobs(LONG, *self.small(5))
        client = self.start(jobs, "--jobs", "1")
        harness.await_true("the long job does not begin", lambda: any(harness.unfinished_files(client.pid, self.out)))
        tasks = pathlib.Path(f"/proc/{client.pid}/task").iterdir()
        servers = [pid for task in tasks for pid in (task / "children").read_text().split()]
        self.assertEqual(len(servers), 1)
        os.kill(int(servers[0]), signal.SIGKILL)
        stderr = client.communicate(timeout=harness.PATIENCE)[1]
        self.assertEqual(client.returncode, UNREACHABLE, stderr)
        self.assertEqual(collections.Counter(r["status"] for r in self.results()), {"failed": 1, "done": 5})

    def test_on_a_terminal_a_bar_tells_jobs_rate_and_time(self):
        reader, writer = pty.openpty()
        client = self.start(self.jobs(*self.small(30), {"mesh": str(BUNNY), "resolution": 1000}), stderr=writer)
        os.close(writer)
        shown = b""
        with contextlib.suppress(OSError):  # the end of a terminal's output
            while part := os.read(reader, 4096):
                shown += part
        os.close(reader)
        self.assertEqual(client.wait(), OK)
        plain = re.sub(r"\x1b\[\d*m", "", shown.decode())  # without colors
        self.assertRegex(plain, r"\[#+\.*\] +\d+ %  \d+/31 jobs, [\d.e+]+/s, \S+ left")


class Resume(Batch):
    def test_after_a_kill_the_rest_is_done_and_nothing_twice(self):
        jobs = self.jobs(*({"mesh": str(BUNNY), "lattice": "bcc", "resolution": 300 + n, "out": f"{n}.vdb"} for n in range(16)))
        client = self.start(jobs)
        self.wait_for_lines(client, 4)
        client.send_signal(signal.SIGKILL)
        client.wait()
        self.assert_no_process_left()
        whole_lines = (self.out / "results.jsonl").read_text().rpartition("\n")[0]
        (self.out / "results.jsonl").write_text(whole_lines + "\n")
        finished = {r["id"] for r in self.results()}
        self.assertGreaterEqual(len(finished), 4)
        self.assertLess(len(finished), 16)
        with open(self.out / "results.jsonl", "a") as file:
            file.write('{"id":"15.vdb","status":"do')  # as a kill during a write leaves it
        times = {name: (self.out / name).stat().st_mtime_ns for name in finished}
        summary = json.loads(self.batch(jobs, "--resume", "--json").stdout)
        self.assertEqual((summary["done"], summary["skipped"], summary["failed"]), (16 - len(finished), len(finished), 0))
        self.assertEqual({name: (self.out / name).stat().st_mtime_ns for name in finished}, times)
        results = self.results()
        self.assertEqual(collections.Counter(r["id"] for r in results if r["status"] == "done"), {f"{n}.vdb": 1 for n in range(16)})
        self.assertEqual({r["id"] for r in results if r["status"] == "skipped"}, finished)
        undisturbed = self.dir / "undisturbed"
        self.batch(jobs, out=undisturbed)
        self.assertEqual(self.digests(results), self.digests(self.results(out=undisturbed)))

    def test_changed_jobs_are_done_again(self):
        write_obj(self.dir / "other.obj", octahedron(2))
        small = [{**job, "mesh": mesh} for job, mesh in zip(self.small(6), ["octahedron.obj"] * 5 + ["other.obj"])]
        small[4]["out"] = ["4.vdb", "4.csv"]
        self.batch(self.jobs(*small))

        def done_again(*jobs):
            before = len(self.results())
            self.batch(self.jobs(*jobs), "--resume")
            new = self.results()[before:]
            self.assertEqual(len(new), len(jobs))
            return sorted(r["id"] for r in new if r["status"] == "done")

        self.assertEqual(done_again(*small), [])
        self.assertEqual(done_again(*reversed(small)), [])  # on other lines
        (self.out / "0.vdb").unlink()
        (self.out / "1.vdb").write_bytes((self.out / "2.vdb").read_bytes())
        small[3]["minimal"] = False
        (self.out / "4.csv").unlink()
        write_obj(self.dir / "other.obj", octahedron(3))
        self.assertEqual(done_again(*small), ["0.vdb", "1.vdb", "3.vdb", "4.vdb", "5.vdb"])
        os.truncate(self.out / "4.csv", (self.out / "4.csv").stat().st_size - 1)
        self.assertEqual(done_again(*small), ["4.vdb"])
        self.assertEqual(done_again(*small), [])
        self.batch(self.jobs(*small))  # without --resume all jobs run
        self.assertEqual([r["status"] for r in self.results()[-6:]], ["done"] * 6)

    def test_nothing_left_to_do_needs_no_server(self):
        jobs = self.jobs(*self.small(2))
        self.batch(jobs)
        self.batch(jobs, "--resume", "--server", f"unix:{self.dir}/nobody")

    def test_an_interrupt_keeps_results_and_leaves_no_part(self):
        for signal_number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal_number):
                client = self.start(self.jobs(*self.small(3), LONG, *self.small(9)[3:]), "--jobs", "1", "--resume")
                lines = len(self.results()) if (self.out / "results.jsonl").exists() else 0
                self.wait_for_lines(client, lines + 3)
                time.sleep(0.5)  # into the long one
                started = time.monotonic()
                client.send_signal(signal_number)
                stderr = client.communicate(timeout=15)[1]
                self.assertLess(time.monotonic() - started, 5)
                self.assertEqual(client.returncode, STOPPED, stderr)
                self.assertIn("cancelled", stderr)
                self.assertEqual(self.outputs(), ["0.vdb", "1.vdb", "2.vdb"])
        self.assertEqual([r["status"] for r in self.results()], ["done"] * 3 + ["skipped"] * 3)
        self.batch(self.jobs(*self.small(9)), "--resume")
        self.assertEqual(collections.Counter(r["status"] for r in self.results()), {"done": 9, "skipped": 6})


class Shards(Batch):
    COUNT = 11

    def test_workers_make_up_the_whole(self):
        jobs = self.jobs(*self.small(self.COUNT))
        whole = self.dir / "whole"
        self.batch(jobs, out=whole)
        parts = {}
        started = time.time_ns() // 10**6
        for index in range(3):
            done = self.batch(jobs, "--worker", f"{index}/3")
            self.assertRegex(done.stderr, rf"(?m)^latvox: worker {index}/3 \(--worker\): [34] of 11 jobs$")
            part = self.digests(self.results(f"results-{index}-of-3.jsonl"))
            self.assertIn(len(part), (3, 4))
            self.assertEqual(parts.keys() & part.keys(), set())
            parts |= part
        self.assertEqual(parts, self.digests(self.results(out=whole)))
        self.assertEqual(self.outputs(), self.outputs(whole))
        for result in self.results("results-0-of-3.jsonl"):
            self.assertIn(result["ended_unix_ms"], range(started, time.time_ns() // 10**6 + 1))
            self.assertEqual(result["output_bytes"], [(self.out / name).stat().st_size for name in result["outputs"]])
        # However the jobs were shared, finished ones are not repeated.
        self.assertRegex(self.batch(jobs, "--resume").stdout, "^0 of 11 jobs done, 11 skipped")
        self.assertRegex(self.batch(jobs, "--resume", "--worker", "1/2").stdout, "^0 of 5 jobs done, 5 skipped")

    def test_engines_tell_the_worker(self):
        jobs = self.jobs(*self.small(self.COUNT))
        kubernetes = [{"JOB_COMPLETION_INDEX": str(n), "LATVOX_WORKER_COUNT": "3"} for n in range(3)]
        slurm = [{"SLURM_ARRAY_TASK_ID": str(5 + n), "SLURM_ARRAY_TASK_MIN": "5", "SLURM_ARRAY_TASK_COUNT": "3"} for n in range(3)]
        for name, environments in (("kubernetes", kubernetes), ("slurm", slurm)):
            lines = []
            for index, environment in enumerate(environments):
                done = self.batch(jobs, out=self.dir / name, **environment)
                self.assertRegex(done.stderr, rf"(?m)^latvox: worker {index}/3 \({next(iter(environment))}, \w+\): [34] of 11 jobs$")
                lines += [r["line"] for r in self.results(f"results-{index}-of-3.jsonl", out=self.dir / name)]
            self.assertEqual(sorted(lines), list(range(1, self.COUNT + 1)))

    def test_an_index_without_a_count_is_never_the_whole(self):
        jobs = self.jobs(*self.small(1))
        for environment in ({"JOB_COMPLETION_INDEX": "0"}, {"SLURM_ARRAY_TASK_ID": "0"}, {"LATVOX_WORKER_COUNT": "2"}):
            done = self.batch(jobs, code=USAGE, **environment)
            self.assertIn(next(iter(environment)), done.stderr)
            self.assertFalse(self.out.exists())
        self.batch(jobs, "--worker", "0/1", JOB_COMPLETION_INDEX="0")

    def test_two_workers_with_one_index_wait_for_each_other(self):
        first = self.start(self.jobs(*self.small(2), LONG), "--jobs", "1", "--worker", "0/1")
        self.wait_for_lines(first, 2)
        small = self.jobs(*self.small(2))
        waiting = [self.start(small, "--resume") for _ in range(3)]
        for client in waiting:
            self.assertIn("results.jsonl: another latvox batch is using it", client.stderr.readline())
        for client, signal_number in zip(waiting, (signal.SIGINT, signal.SIGTERM)):
            client.send_signal(signal_number)
            self.assertEqual(client.wait(15), STOPPED)
            self.assertEqual(client.stderr.read().count("\n"), 1)
        self.assertIsNone(waiting[2].poll())
        first.send_signal(signal.SIGINT)
        self.assertEqual(first.wait(15), STOPPED)
        self.assertEqual(waiting[2].wait(15), OK, waiting[2].stderr.read())
        self.assertEqual([r["status"] for r in self.results()], ["done"] * 2 + ["skipped"] * 2)


if __name__ == "__main__":
    unittest.main()
