"""A batch from and to an S3 server, with kill -9 of the worker, of latvoxd and of the store, again and again: every job is
done, with the right voxels, and no object is made twice."""

import collections
import json
import os
import random
import subprocess
import sys
import threading
import time
import unittest

import stage
from stage import BIN, SEED, Faults, Server, harness, latvox

sys.path.insert(0, str(stage.ROOT / "tests" / "e2e"))

from object_relay import Relay  # noqa: E402
from object_store import ObjectStore  # noqa: E402

JOBS, EVERY = (1000, 80) if stage.FULL else (32, 8)  # EVERY: objects from kill to kill
VICTIMS = ("worker", "server", "store")


class Network(Relay):
    """Knows whether a request is on its way."""

    def __init__(self, store):
        super().__init__(store)
        self.on_the_way = 0

    def answer(self, handler):
        with self.lock:
            self.on_the_way += 1
        try:
            super().answer(handler)
        finally:
            with self.lock:
                self.on_the_way -= 1

    def made(self):
        return sum(self.count("PUT").values())


class Stores(Faults):
    scenario = "stores"

    def setUp(self):
        super().setUp()
        self.rng = random.Random(SEED)
        self.store = ObjectStore(self.dir / "store", harness.PATIENCE)
        self.store.start()
        self.addCleanup(lambda: self.store.kill())
        self.assertEqual(self.store.call("PUT", "bucket")[0], 200)
        self.jobs, local = [], []
        for n in range(JOBS):
            mesh = harness.write_obj(self.dir / f"{n}.obj", harness.octahedron(1 + n))
            self.store.put(f"bucket/in/{n}.obj", mesh.read_bytes())
            request = {"resolution": 8 + n % 32, "lattice": ("bcc", "fcc", "cartesian")[n % 3]}
            self.jobs.append({"mesh": f"s3://bucket/in/{n}.obj", "out": f"s3://bucket/out/{n}.csv", "id": str(n), **request})
            local.append({"mesh": mesh.name, "out": f"{n}.csv", "id": str(n), **request})
        done = latvox("batch", self.write("local", local), "--out", self.dir / "local")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.digests = self.results("local")["done"]

    def write(self, name, jobs):
        path = self.dir / f"{name}.jsonl"
        path.write_text("".join(json.dumps(job) + "\n" for job in jobs))
        return path

    def results(self, folder):
        """Returns the digests of the jobs by their ids, for each status."""
        found = collections.defaultdict(dict)
        for line in (self.dir / folder / "results.jsonl").read_text().splitlines():
            result = json.loads(line)
            found[result["status"]][result["id"]] = result.get("digest") or result.get("summary", {}).get("digest")
        return found

    def start_worker(self, network, server):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("AWS_")}
        environment |= self.store.environment | {"AWS_ENDPOINT_URL_S3": f"http://127.0.0.1:{network.port}"}
        command = [BIN / "latvox", "batch", self.dir / "remote.jsonl", "--out", self.dir / "remote", "--resume"]
        command += ["--server", server.address, "--retries", "20"]
        with open(self.dir / "worker.log", "ab") as log:
            worker = subprocess.Popen(list(map(str, command)), env=environment, stdout=log, stderr=log)
        self.addCleanup(worker.wait)
        self.addCleanup(worker.kill)
        return worker

    def run_batch(self, network, server):
        """Runs the batch to its end. Returns how often each victim was killed."""
        kills, next_kill = collections.Counter(), EVERY
        worker = self.start_worker(network, server)
        deadline = time.monotonic() + 600
        while worker.poll() != 0:
            self.assertLess(time.monotonic(), deadline, "the batch does not end")
            if worker.returncode is not None or (killed := self.kill(network, next_kill, kills, worker, server)) == "worker":
                worker.wait()
                while network.on_the_way:  # a request of a dead worker is not yet told
                    time.sleep(0.01)
                worker, killed = self.start_worker(network, server), "worker"
            if killed:
                next_kill = network.made() + EVERY
            time.sleep(0.005)
        return kills

    def kill(self, network, next_kill, kills, worker, server):
        """Kills a victim if enough objects were made since the last one. Returns which."""
        if network.made() < next_kill:
            return None
        victim = min(VICTIMS, key=lambda name: (kills[name], self.rng.random()))
        kills[victim] += 1
        if victim == "worker":
            worker.kill()
        elif victim == "server":
            server.kill()
            server.start()
        else:
            self.store.kill()
            threading.Thread(target=self.store.start).start()
        return victim

    def test_nothing_is_lost_or_done_twice(self):
        self.write("remote", self.jobs)
        server = Server(self.dir)
        self.addCleanup(lambda: server.kill())
        server.process.address = server.address
        harness.wait_until_healthy(server.process)
        with Network(self.store) as network:
            kills = self.run_batch(network, server)
            made = network.count("PUT")
        results = self.results("remote")
        right = {id: digest for status in ("done", "skipped") for id, digest in results[status].items()} == self.digests
        self.figure("jobs", JOBS, "", "done, with the right digests", right)
        self.figure("kills", " ".join(f"{name} {kills[name]}" for name in VICTIMS), "", "each", all(kills[n] for n in VICTIMS))
        same = all(self.store.get(f"bucket/out/{n}.csv") == (self.dir / "local" / f"{n}.csv").read_bytes() for n in range(JOBS))
        self.figure("objects", JOBS, "", "those of local files, byte by byte", same)
        self.figure("objects made twice", sum(count > 1 for count in made.values()), "", "0", max(made.values()) == 1)


if __name__ == "__main__":
    unittest.main()
