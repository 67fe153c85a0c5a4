"""deploy/slurm on a real Slurm of four nodes: a job array over many meshes, one mesh in parts; nodes die on the way."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import slurm_cluster

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402

SLURM = ROOT / "deploy" / "slurm"
BIN = harness.BIN
SKIP = 77  # ctest's word for it
NODES = 4

# Of each task's three jobs the last is the slowest: one that has a result is still at work.
RESOLUTIONS = [64] * NODES + [256] * NODES + [2048] * NODES


def stretched(mesh, factor):
    vertices, triangles = mesh
    return [(x * factor, y, z) for x, y, z in vertices], triangles


def latvox(*words, **options):
    done = subprocess.run([BIN / "latvox", *map(str, words)], capture_output=True, text=True, timeout=300, **options)
    assert done.returncode == 0, done.stderr
    return done.stdout


def results(directory):
    """Lines of a worker's results, whole ones only, by file."""
    return {path.name: [json.loads(line) for line in path.read_text().splitlines(True) if line.endswith("\n")]
            for path in directory.glob("results*.jsonl")}


class Slurm(unittest.TestCase):
    def setUp(self):
        self.dir = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-slurm-")))
        cluster = self.dir / "cluster"
        cluster.mkdir()
        self.cluster = slurm_cluster.Cluster(cluster, {"LATVOX": str(BIN / "latvox")}, NODES)
        self.addCleanup(self.cluster.stop)

    def submit(self, *command):
        return self.cluster.run(*command, cwd=self.dir).partition(";")[0]

    def assert_all_completed(self, tasks):
        logs = "\n".join(path.read_text() for path in self.dir.glob("*.log"))
        self.assertEqual({(task["JobState"], task["ExitCode"]) for task in tasks}, {("COMPLETED", "0:0")}, logs)

    def kill_the_node_of(self, job, index):
        """Returns its name; whatever else ran there is dead, too."""
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

    def test_what_fails_is_told_and_is_not_joined(self):
        (self.dir / "bad.obj").write_text("f 1 2 3\n")
        joining = self.submit(SLURM / "shards", 2, self.dir / "bad.obj", self.dir / "joined.vdb", "--resolution", 8)
        parts = re.search(r"\d+", self.cluster.jobs(joining)[0]["Dependency"])[0]
        tasks = self.cluster.wait_for_job(parts)
        self.assertEqual({(task["JobState"], task["ExitCode"]) for task in tasks}, {("FAILED", "3:0")})
        self.assertEqual(self.cluster.wait_for_job(joining)[0]["JobState"], "CANCELLED")
        self.assertFalse((self.dir / "joined.vdb").exists())

    def test_wrong_usage_of_shards_is_told(self):
        for words in ([], ["0", "a.obj", "b.vdb"], ["2", "a.obj", "b.csv"]):
            done = subprocess.run([SLURM / "shards", *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("Usage: deploy/slurm/shards N MESH OUT.vdb", done.stderr)


if __name__ == "__main__":
    why = slurm_cluster.missing()
    if why:
        print(f"SKIPPED: {why}", file=sys.stderr)
        sys.exit(SKIP)
    unittest.main()
