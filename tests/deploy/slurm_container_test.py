"""Runs deploy/slurm on a real Slurm, with latvox in containers."""

import json
import unittest

import containers
import slurm_cluster
from slurm_cluster import SLURM, ClusterCase, harness, latvox, results


class SlurmWithContainers(ClusterCase):
    environment = {"LATVOX": str(SLURM / "in-container"), "LATVOX_IMAGE": containers.IMAGE}

    def test_an_array_does_all_jobs(self):
        jobs = [{"mesh": "bunny.obj", "out": f"{n}.vdb", "lattice": "bcc", "resolution": 64} for n in range(4)]
        (self.dir / "jobs.jsonl").write_text("".join(json.dumps(job) + "\n" for job in jobs))
        (self.dir / "bunny.obj").write_bytes(harness.BUNNY.read_bytes())
        job = self.submit("sbatch", "--parsable", "--array=0-1", SLURM / "batch.sbatch", "jobs.jsonl", "out")
        self.assert_all_completed(self.cluster.wait_for_job(job))
        alone = latvox("voxelize", harness.BUNNY, "--lattice", "bcc", "--resolution", 64, "--json", "-o", self.dir / "x.vdb")
        found = {line["id"]: line["summary"]["digest"] for lines in results(self.dir / "out").values() for line in lines}
        self.assertEqual(found, dict.fromkeys([f"{n}.vdb" for n in range(4)], json.loads(alone)["digest"]))

    def test_other_folders_are_seen_if_they_are_named(self):
        self.cluster.environment["LATVOX_MOUNTS"] = str(harness.BUNNY.parent)
        joining = self.submit(SLURM / "shards", 2, harness.BUNNY, "bunny.vdb", "--resolution", 64)
        self.assert_all_completed(self.cluster.wait_for_job(joining))
        self.assertTrue((self.dir / "bunny.vdb").exists())


if __name__ == "__main__":
    containers.require()
    if not containers.exists(containers.IMAGE):
        containers.skip(f"there is no image {containers.IMAGE}: the test deploy.image_build makes it")
    slurm_cluster.require()
    unittest.main()
