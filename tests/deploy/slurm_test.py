"""Runs deploy/slurm on a real Slurm of four nodes: a job array over many meshes, and one mesh in parts. Nodes die on
the way."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import slurm_cluster
from slurm_cluster import NODES, ROOT, SLURM, ClusterCase, harness, latvox, results

# The last of each task's three jobs is the slowest, so a task with a result is still at work.
RESOLUTIONS = [64] * NODES + [256] * NODES + [2048] * NODES


def stretched(mesh, factor):
    vertices, triangles = mesh
    return [(x * factor, y, z) for x, y, z in vertices], triangles


class Slurm(ClusterCase):
    def kill_the_node_of(self, job, index):
        """Kills the node of a task, with everything else on it. Returns the node's name."""
        node = next(task["NodeList"] for task in self.cluster.jobs(job) if task.get("ArrayTaskId") == str(index))
        self.assertIn(node, self.cluster.nodes)
        self.cluster.kill_node(node)
        return node

    def assert_started_again_elsewhere(self, tasks, index, dead):
        task = next(task for task in tasks if task["ArrayTaskId"] == str(index))
        self.assertEqual(task["Restarts"], "1")
        self.assertNotEqual(task["NodeList"], dead)
        self.assertEqual({task["Restarts"] for task in tasks if task["ArrayTaskId"] != str(index)}, {"0"})

    def test_an_array_does_all_jobs_although_a_node_dies(self):
        jobs, bunny = self.dir / "jobs.jsonl", harness.read_obj(harness.BUNNY)
        for n, resolution in enumerate(RESOLUTIONS):
            harness.write_obj(self.dir / f"{n}.obj", stretched(bunny, 1 + n / 16))
            with jobs.open("a") as file:
                file.write(json.dumps({"mesh": f"{n}.obj", "lattice": "bcc", "resolution": resolution}) + "\n")
        latvox("batch", jobs, "--out", self.dir / "single")
        single = {line["id"]: line["summary"]["digest"] for line in results(self.dir / "single")["results.jsonl"]}
        self.assertEqual(len(single), len(RESOLUTIONS))

        out, victim = self.dir / "out", 1
        name = f"results-{victim}-of-{NODES}.jsonl"
        job = self.submit("sbatch", "--parsable", f"--array=0-{NODES - 1}", SLURM / "batch.sbatch", jobs, out, "--jobs", 1)
        self.cluster.wait("a first result", lambda: results(out).get(name))
        dead = self.kill_the_node_of(job, victim)
        before = results(out)[name]
        self.assertLess(len(before), len(RESOLUTIONS) // NODES, "the node died too late")
        tasks = self.cluster.wait_for_job(job)

        self.assert_all_completed(tasks)
        self.assert_started_again_elsewhere(tasks, victim, dead)
        found = results(out)
        self.assertEqual(set(found), {f"results-{n}-of-{NODES}.jsonl" for n in range(NODES)})
        done = [line for lines in found.values() for line in lines if line["status"] == "done"]
        self.assertEqual(len(done), len(RESOLUTIONS), "what was done before the node died is not done again")
        self.assertEqual({line["id"]: line["summary"]["digest"] for line in done}, single)
        self.assertEqual({path.name for path in out.glob("*.vdb")}, {f"{n}.vdb" for n in range(len(RESOLUTIONS))})
        skipped = [line["id"] for line in found[name] if line["status"] == "skipped"]
        self.assertEqual(skipped, [line["id"] for line in before])

    def test_parts_of_one_mesh_are_joined_although_a_node_dies(self):
        options = ["--lattice", "bcc", "--resolution", 2048]
        whole = json.loads(latvox("voxelize", harness.BUNNY, *options, "--json", "-o", self.dir / "whole.vdb"))
        joining = self.submit(SLURM / "shards", NODES, harness.BUNNY, self.dir / "joined.vdb", *options)
        parts = re.search(r"\d+", self.cluster.jobs(joining)[0]["Dependency"])[0]
        victim = NODES - 1
        self.cluster.wait("work", lambda: all(task["JobState"] == "RUNNING" for task in self.cluster.jobs(parts)))
        dead = self.kill_the_node_of(parts, victim)
        tasks = self.cluster.wait_for_job(parts)
        self.assert_all_completed(tasks)
        self.assert_started_again_elsewhere(tasks, victim, dead)
        self.assert_all_completed(self.cluster.wait_for_job(joining))
        log = (self.dir / f"latvox-merge-{joining}.log").read_text()
        self.assertIn(f"{whole['voxels']} voxels", log)
        self.assertIn(f"digest {whole['digest']}", log)

    def test_parts_with_fields_and_of_a_band_are_joined(self):
        for options in (["--fields", "triangle,normal"], ["--band", "2v"]):
            whole = json.loads(latvox("voxelize", harness.BUNNY, "--resolution", 64, *options, "--json", "-o", self.dir / "whole.vdb"))
            joining = self.submit(SLURM / "shards", 2, harness.BUNNY, self.dir / "joined.vdb", "--resolution", 64, *options)
            self.assert_all_completed(self.cluster.wait_for_job(joining))
            log = (self.dir / f"latvox-merge-{joining}.log").read_text()
            self.assertIn(f"{whole['voxels']} voxels", log)
            self.assertIn(f"digest {whole['digest']}", log)

    def test_failed_parts_are_reported_and_not_joined(self):
        (self.dir / "bad.obj").write_text("f 1 2 3\n")
        joining = self.submit(SLURM / "shards", 2, self.dir / "bad.obj", self.dir / "joined.vdb", "--resolution", 8)
        parts = re.search(r"\d+", self.cluster.jobs(joining)[0]["Dependency"])[0]
        tasks = self.cluster.wait_for_job(parts)
        self.assertEqual({(task["JobState"], task["ExitCode"]) for task in tasks}, {("FAILED", "3:0")})
        self.assertEqual(self.cluster.wait_for_job(joining)[0]["JobState"], "CANCELLED")
        self.assertFalse((self.dir / "joined.vdb").exists())

    def test_the_examples_of_the_page_run(self):
        page = (ROOT / "deploy/docs/slurm.md").read_text()
        example = re.search(r"^```sh\n(.*?)^```$", page, re.M | re.S)[1]
        (self.dir / "deploy").symlink_to(ROOT / "deploy")
        (self.dir / "build/release").mkdir(parents=True)
        (self.dir / "build/release/bin").symlink_to(harness.BIN)
        told = self.submit("bash", "-euo", "pipefail", "-c", example)
        self.assert_all_completed(self.cluster.wait_for_job(told.split()[-1]))
        self.assertEqual({path.name for path in (self.dir / "voxels").glob("*.vdb")}, {f"bunny-{n}.vdb" for n in range(1, 13)})
        self.assertTrue((self.dir / "bunny.vdb").exists())

    def test_a_part_can_be_done_again_alone(self):
        first = self.submit("sbatch", "--parsable", "--array=0-1", SLURM / "shard.sbatch", 3, harness.BUNNY, "a.vdb", "--resolution", 64)
        last = self.submit("sbatch", "--parsable", "--array=2", SLURM / "shard.sbatch", 3, harness.BUNNY, "a.vdb", "--resolution", 64)
        for job in (first, last):
            self.assert_all_completed(self.cluster.wait_for_job(job))
        self.assert_all_completed(self.cluster.wait_for_job(self.submit("sbatch", "--parsable", SLURM / "merge.sbatch", 3, "a.vdb")))
        self.assertTrue((self.dir / "a.vdb").exists())

    def test_wrong_usage_of_shards_is_told(self):
        for words in ([], ["0", "a.obj", "b.vdb"], ["2", "a.obj", "b.csv"]):
            done = subprocess.run([SLURM / "shards", *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("Usage: deploy/slurm/shards N MESH OUT.vdb", done.stderr)


class Scripts(unittest.TestCase):
    """The scripts' commands, without a cluster."""

    def environment_of(self, script, *words, **variables):
        directory = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (directory / "latvox").write_text('#!/bin/sh\nexec env\n')
        (directory / "latvox").chmod(0o755)
        variables = {"PATH": os.environ["PATH"], "LATVOX": str(directory / "latvox"), "SLURM_ARRAY_TASK_ID": "0"} | variables
        done = subprocess.run(["bash", SLURM / script, *words], env=variables, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return dict(line.partition("=")[::2] for line in done.stdout.splitlines())

    def test_a_task_takes_no_more_than_slurm_gave_it(self):
        for script, *words in (["batch.sbatch", "jobs.jsonl", "out"], ["shard.sbatch", "2", "a.obj", "b.vdb"]):
            found = self.environment_of(script, *words, SLURM_CPUS_ON_NODE="3", SLURM_MEM_PER_NODE="4096")
            self.assertEqual((found["LATVOX_THREADS"], found["LATVOX_MEMORY_BUDGET"]), ("3", "2048MiB"))
            self.assertEqual(found["LATVOX_DECODER_MEMORY"], "341MiB")
            found = self.environment_of(script, *words, SLURM_CPUS_ON_NODE="8", SLURM_MEM_PER_CPU="1000")
            self.assertEqual((found["LATVOX_MEMORY_BUDGET"], found["LATVOX_DECODER_MEMORY"]), ("4000MiB", "500MiB"))
            found = self.environment_of(script, *words, SLURM_CPUS_ON_NODE="3", LATVOX_THREADS="2")
            self.assertEqual((found["LATVOX_THREADS"], found.get("LATVOX_MEMORY_BUDGET")), ("2", None))
            found = self.environment_of(script, *words, SLURM_CPUS_ON_NODE="3", SLURM_MEM_PER_NODE="4096", LATVOX_THREADS="0")
            self.assertEqual((found["LATVOX_THREADS"], found["LATVOX_DECODER_MEMORY"]), ("3", "341MiB"))


if __name__ == "__main__":
    slurm_cluster.require()
    unittest.main()
