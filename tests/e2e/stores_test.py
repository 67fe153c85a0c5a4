"""Batches from and to object stores and web servers: whole objects or none, nothing twice, and no secret in any text."""

import json
import os
import pathlib
import random
import shutil
import signal
import ssl
import subprocess
import tempfile
import threading
import unittest

import harness
from harness import BIN, BUNNY, Case, latvox, octahedron, write_obj
from object_relay import FAULTS, Relay
from object_store import KEY, SECRET, ObjectStore, presign
from tls_test import Authority

OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED, STOPPED = range(7)
MESHES = 24
CLEARED = ("AWS_", "SSL_CERT_FILE", "http_proxy", "https_proxy", "all_proxy", "HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY")


def setUpModule():
    folder = unittest.enterModuleContext(tempfile.TemporaryDirectory(prefix="latvox-store-"))
    Stores.store = ObjectStore(folder, harness.PATIENCE)
    Stores.store.start()
    unittest.addModuleCleanup(Stores.store.kill)
    assert Stores.store.call("PUT", "bucket")[0] == 200
    mesh = pathlib.Path(folder) / "mesh.obj"
    for n in range(MESHES):
        Stores.meshes[f"in/mesh {n}+.obj"] = write_obj(mesh, octahedron(1 + n)).read_bytes()
    Stores.meshes["bunny.obj"] = BUNNY.read_bytes()
    for key, body in Stores.meshes.items():
        Stores.store.put(f"bucket/{key}", body)


class Stores(Case):
    store, meshes = None, {}

    def assert_no_process_left(self, seconds=10):
        """The store of all tests goes on."""
        shared = self.store.process.pid
        children, harness.children = harness.children, lambda: {pid: words for pid, words in children().items() if pid != shared}
        try:
            super().assert_no_process_left(seconds)
        finally:
            harness.children = children

    def setUp(self):
        super().setUp()
        self.out = self.dir / "out"
        self.temporary = self.dir / "tmp"
        self.temporary.mkdir()
        self.prefix = f"{self._testMethodName}/"  # of this test's outputs
        self.secrets = {SECRET, "X-Amz-"}
        self.texts = []

    def tearDown(self):
        """Nothing that latvox printed or wrote has a secret in it, and no local copy is left."""
        for path in self.dir.rglob("results*.jsonl"):
            self.texts.append(path.read_text())
        for text in self.texts:
            for secret in self.secrets:
                self.assertNotIn(secret, text)
        self.assertEqual(list(self.temporary.iterdir()), [])

    def environment(self, port=None, **more):
        kept = {name: value for name, value in os.environ.items() if not name.startswith(CLEARED)}
        store = self.store.environment
        if port:
            store["AWS_ENDPOINT_URL_S3"] = f"http://127.0.0.1:{port}"
        return {**kept, **store, "TMPDIR": str(self.temporary), "HOME": str(self.dir), **more}

    def profile(self):
        """Writes the profile "farm". Returns an environment without other settings of the store."""
        folder, store, environment = self.dir / ".aws", self.store.environment, self.environment()
        folder.mkdir()
        (folder / "credentials").write_text(f"[farm]\naws_access_key_id = {KEY}\naws_secret_access_key = {SECRET}\n")
        place = f"region = {store['AWS_REGION']}\nendpoint_url = {store['AWS_ENDPOINT_URL_S3']}\n"
        (folder / "config").write_text(f"[profile farm]\n{place}")
        return {name: value for name, value in environment.items() if name not in store}

    def small(self, count=MESHES):
        """Returns a job for each of the small meshes, each from and to the store."""
        ends = ("vdb", "csv", "npz", "ply")
        return [
            {"mesh": f"s3://bucket/{key}", "resolution": 8 + n, "out": f"s3://bucket/{self.prefix}{n} &.{ends[n % 4]}"}
            for n, key in zip(range(count), self.meshes)
        ]

    def write(self, jobs):
        path = self.dir / "jobs.jsonl"
        path.write_text("".join(json.dumps(job) + "\n" for job in jobs))
        return path

    def batch(self, jobs, *options, code=OK, environment=None):
        done = latvox("batch", self.write(jobs), "--out", self.out, *options, env=environment or self.environment())
        self.texts += [done.stdout, done.stderr]
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def results(self):
        return [json.loads(line) for line in (self.out / "results.jsonl").read_text().splitlines()]

    def expect_objects(self, jobs):
        """The objects of the jobs are the files that local jobs write."""
        local = []
        for n, job in enumerate(jobs):
            (self.dir / f"{n}.obj").write_bytes(self.meshes[job["mesh"].removeprefix("s3://bucket/")])
            local.append({**job, "mesh": f"{n}.obj", "out": f"{n}." + job["out"].rpartition(".")[2]})
        done = latvox("batch", self.write(local), "--out", self.dir / "local", env=self.environment())
        self.assertEqual(done.returncode, OK, done.stderr)
        for here, job in zip(local, jobs):
            found = self.store.get(job["out"].removeprefix("s3://"))
            (self.dir / "found.vdb").write_bytes(found or b"")
            if not here["out"].endswith("vdb"):
                self.assertEqual(found, (self.dir / "local" / here["out"]).read_bytes(), job)
            elif here is local[0]:  # a .vdb states when it was made, so its voxels are compared
                compared = latvox("compare", self.dir / "found.vdb", self.dir / "local" / here["out"])
                self.assertEqual(compared.returncode, OK, job)

    def keys(self):
        """Returns the keys of this test's objects."""
        listing = self.store.call("GET", "bucket")[2].decode()
        return {key.partition("</Key>")[0] for key in listing.split("<Key>")[1:] if key.startswith(self.prefix)}


class Jobs(Stores):
    def test_objects_are_the_files_of_local_jobs_and_a_second_run_skips_them(self):
        jobs = self.small()
        self.batch(jobs)
        self.expect_objects(jobs)
        with Relay(self.store) as relay:
            shutil.rmtree(self.out)  # the store itself knows what is done
            self.batch(jobs, "--resume", environment=self.environment(relay.port))
            self.assertEqual(relay.count("PUT"), {})
        results = self.results()
        self.assertEqual({r["status"] for r in results}, {"skipped"})
        for result in results:
            self.assertEqual(len(result["digest"]), 32)
            self.assertGreater(result["output_bytes"][0], 0)
        self.assertEqual(self.store.call("DELETE", jobs[3]["out"].removeprefix("s3://"))[0], 204)
        self.store.put(jobs[5]["out"].removeprefix("s3://"), b"of somebody else")
        self.batch(jobs, "--resume")
        self.assertEqual(sum(r["status"] == "done" for r in self.results()), 2)
        self.expect_objects([jobs[3], jobs[5]])

    def test_a_worker_that_may_not_look_repeats_jobs(self):
        job = self.small(1)[0]
        with Relay(self.store, lambda request: "forbid" if request.method == "HEAD" else None) as relay:
            for _ in range(2):
                self.batch([job], "--resume", environment=self.environment(relay.port))
        self.assertEqual([r["status"] for r in self.results()], ["done", "done"])

    def test_a_job_may_have_several_outputs_here_and_there(self):
        job = {"mesh": ["s3://bucket/in/mesh 1+.obj", "s3://bucket/in/mesh 2+.obj"], "resolution": 20,
               "out": ["here/a.csv", f"s3://bucket/{self.prefix}a.csv", f"s3://bucket/{self.prefix}b.npz"]}
        self.batch([job])
        here = (self.out / "here/a.csv").read_bytes()
        self.assertEqual(self.store.get(f"bucket/{self.prefix}a.csv"), here)
        result = self.results()[0]
        self.assertEqual(result["outputs"], job["out"])
        self.assertEqual(result["output_bytes"][:2], [len(here), len(here)])
        self.assertEqual(result["mesh"], " + ".join(job["mesh"]))
        self.batch([job], "--resume")
        self.assertEqual(self.results()[1]["status"], "skipped")
        (self.out / "here/a.csv").unlink()
        self.batch([job], "--resume")
        self.assertEqual(self.results()[2]["status"], "done")

    def test_presigned_urls_read_and_write(self):
        out = f"{self.prefix}a.csv"
        job = {"mesh": presign("GET", self.store.port, "bucket", "in/mesh 1+.obj"), "resolution": 9,
               "out": presign("PUT", self.store.port, "bucket", out)}
        self.batch([job])
        self.assertGreater(len(self.store.get(f"bucket/{out}")), 100)
        result = self.results()[0]
        self.assertEqual(result["outputs"], [job["out"].partition("?")[0]])
        self.assertEqual(result["mesh"], job["mesh"].partition("?")[0])
        self.batch([{**job, "out": presign("PUT", self.store.port, "bucket", out, 1000)}], "--resume")
        self.assertEqual(self.results()[1]["status"], "skipped")

    def test_the_example_of_the_page_works(self):
        page = pathlib.Path(__file__).resolve().parents[2] / "client/docs/batch.md"
        example = page.read_text().partition("## Object stores")[2].partition("```bash\n")[2].partition("```")[0]
        for bucket in ("my-meshes", "my-voxels"):
            self.assertEqual(self.store.call("PUT", bucket)[0], 200)
        self.store.put("my-meshes/bunny.obj", self.meshes["bunny.obj"])
        environment = self.profile()
        environment["PATH"] = f"{BIN}:{environment['PATH']}"
        done = subprocess.run(["bash", "-euc", example], env=environment, cwd=self.dir, capture_output=True, text=True)
        self.texts += [done.stdout, done.stderr]
        self.assertEqual(done.returncode, OK, done.stderr)
        for key in ("bunny.vdb", "bunny.npz", "small/bunny.csv"):
            self.assertGreater(len(self.store.get(f"my-voxels/{key}")), 1000)
        self.assertEqual(self.store.get("my-voxels/small/bunny.csv"), (self.dir / "results/bunny.csv").read_bytes())

    def test_voxelize_reads_and_writes_objects(self):
        out = f"s3://bucket/{self.prefix}a.csv"
        done = latvox("voxelize", "s3://bucket/in/mesh 1+.obj", "--resolution", 9, "-o", out, env=self.environment())
        self.assertEqual(done.returncode, OK, done.stderr)
        self.assertIn(f"wrote {out}", done.stdout)
        self.expect_objects([{"mesh": "s3://bucket/in/mesh 1+.obj", "resolution": 9, "out": out}])

    def test_a_large_object_goes_in_parts_and_appears_at_the_end(self):
        key = f"{self.prefix}large.csv"
        job = {"mesh": "s3://bucket/bunny.obj", "resolution": 300, "out": f"s3://bucket/{key}"}
        seen = []

        def choose(request):
            if "uploadId=" in request.path and "partNumber=" not in request.path:
                seen.append(self.store.get(f"bucket/{key}"))
            first = request.number == 1
            if "partNumber=1&" in request.path and first:
                return "lose"
            if "partNumber=2&" in request.path and first:
                return "damage_request"
            return "lose" if request.method == "POST" and "uploadId=" in request.path and first else None

        with Relay(self.store, choose) as relay:
            self.batch([job], environment=self.environment(relay.port))
            self.assertGreaterEqual(sum("partNumber=" in path for path in relay.count("PUT")), 2)
        self.assertEqual(seen[0], None)
        self.expect_objects([job])
        self.batch([job], "--resume")
        self.assertEqual(self.results()[1]["status"], "skipped")

    def test_parts_of_a_failed_upload_are_taken_back(self):
        key = f"{self.prefix}large.csv"
        job = {"mesh": "s3://bucket/bunny.obj", "resolution": 300, "out": f"s3://bucket/{key}"}
        environment = self.environment()

        def choose(request):
            if "partNumber=2&" in request.path:
                os.kill(client.pid, signal.SIGINT)
                return "refuse"
            return None

        with Relay(self.store, choose) as relay:
            environment["AWS_ENDPOINT_URL_S3"] = f"http://127.0.0.1:{relay.port}"
            command = [BIN / "latvox", "batch", self.write([job]), "--out", self.out]
            client = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.texts.append(client.communicate(timeout=harness.PATIENCE)[0])
            self.assertEqual(client.returncode, STOPPED)
            self.assertEqual(len(relay.count("DELETE", 204)), 1)
        self.assertEqual(self.keys(), set())


class Faults(Stores):
    def test_every_kind_of_fault_passes(self):
        jobs = self.small()
        rng = random.Random(7)
        faults = [rng.choice(FAULTS) if rng.random() < 0.3 else None for _ in range(10000)]
        faults[: len(FAULTS)] = [fault if fault != "busy" else None for fault in FAULTS]

        with Relay(self.store, lambda request: faults.pop(0) if request.number < 4 else None) as relay:
            self.batch(jobs, environment=self.environment(relay.port))
            self.assertGreaterEqual({p.fault for p in relay.passed}, set(FAULTS) - {"busy"})
        self.expect_objects(jobs)
        self.assertEqual(len(self.keys()), len(jobs))
        self.assertEqual({r["status"] for r in self.results()}, {"done"})

    def test_damage_without_end_is_an_error_and_leaves_nothing(self):
        refusals = "BadDigest|XAmzContentSHA256Mismatch"  # versions of Swift differ in the digest that they compare first
        for fault, choose, says in (("damage", "GET", "damaged on its way"), ("damage_request", "PUT", refusals)):
            job = {**self.small(1)[0], "out": f"s3://bucket/{self.prefix}{fault}.csv"}
            with Relay(self.store, lambda request: fault if request.method == choose else None) as relay:
                environment = self.environment(relay.port, AWS_MAX_ATTEMPTS="3")
                done = self.batch([job], code=UNREACHABLE, environment=environment)
            self.assertRegex(done.stderr, says)
            self.assertIn("3 tries failed", done.stderr)
        self.assertEqual(self.keys(), set())

    def test_a_killed_worker_repeats_nothing_that_the_store_has(self):
        jobs = self.small()
        turns = iter(range(10000))

        def choose(request):
            if request.method == "PUT" and next(turns) == 7:
                client.kill()  # before it could hear of the object, and send it again
                return "lose"
            return None

        environment = self.environment()
        with Relay(self.store, choose) as relay:
            environment["AWS_ENDPOINT_URL_S3"] = f"http://127.0.0.1:{relay.port}"
            command = [BIN / "latvox", "batch", self.write(jobs), "--out", self.out]
            with open(self.dir / "client.log", "w") as log:
                client = subprocess.Popen(command, env=environment, stdout=log, stderr=log)
            self.assertEqual(client.wait(timeout=harness.PATIENCE), -signal.SIGKILL)
            relay.await_store()  # which may get other objects meanwhile
            self.texts.append((self.dir / "client.log").read_text())
            self.batch(jobs, "--resume", environment=environment)
            stored = relay.count("PUT")
        # A killed client may have sent a request that nobody counted as its last one.
        self.assertEqual(set(stored.values()), {1}, stored)
        self.assertEqual(len(stored), len(jobs))
        results = self.results()
        self.assertEqual({r["id"] for r in results if r["status"] in ("done", "skipped")}, {job["out"] for job in jobs})

    def test_a_killed_store_comes_back(self):
        jobs = self.small()

        turns = iter(range(10000))
        restart = threading.Thread(target=self.store.start)

        def choose(_):
            if next(turns) == 20:
                self.store.kill()
                restart.start()
            return None

        with Relay(self.store, choose) as relay:
            self.batch(jobs, environment=self.environment(relay.port))
            restart.join()
            self.assertIn("dead", {p.fault for p in relay.passed})
        self.expect_objects(jobs)
        self.assertEqual(len(self.keys()), len(jobs))


class Errors(Stores):
    def refused(self, job, code, *words, options=(), **environment):
        done = self.batch([job], *options, code=code, environment=self.environment(**environment))
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertEqual(self.keys(), set())

    def test_what_the_store_refuses_is_named(self):
        job = self.small(1)[0]
        self.refused({**job, "mesh": "s3://bucket/none.obj"}, BAD_INPUT, "s3://bucket/none.obj: cannot be read (HTTP 404 NoSuchKey")
        self.refused({**job, "out": "s3://nowhere/a.csv"}, BAD_INPUT, "s3://nowhere/a.csv: cannot be written (HTTP 404 NoSuchBucket")
        self.refused(job, REFUSED, "HTTP 403 SignatureDoesNotMatch", AWS_SECRET_ACCESS_KEY="wrong-secret")
        self.secrets.add("wrong-secret")
        self.refused(job, REFUSED, "AWS_SECRET_ACCESS_KEY: is not set", AWS_SECRET_ACCESS_KEY="")
        self.refused(job, REFUSED, "no credentials of S3", AWS_SECRET_ACCESS_KEY="", AWS_ACCESS_KEY_ID="")

    def test_credentials_come_from_files_of_a_profile(self):
        self.batch(self.small(1), environment={**self.profile(), "AWS_PROFILE": "farm"})
        self.assertEqual(len(self.keys()), 1)

    def test_wrong_lines_tell_no_secret(self):
        self.secrets |= {"hidden", "pa55"}
        url = "https://example.invalid/a.obj?signature=hidden"
        for job, words in (
            ({"mesh": url, "resolution": 8, "out": "https://example.invalid/a.xyz?s=hidden"}, "is not one of"),
            ({"mesh": url, "resolution": 8, "out": "https://example.invalid/a.mhd?s=hidden"}, "is not one file"),
            ({"mesh": [url, url + "2"], "resolution": 8}, "another query"),
            ({"mesh": "https://me:pa55@example.invalid/a.obj", "resolution": 8}, "user or password"),
            ({"mesh": [url, 7], "resolution": 8}, "a path or a URL"),
            ({"mesh": "gs://bucket/a.obj?s=hidden", "resolution": 8}, "not file, https, http or s3"),
            ({"mesh": url, "resolution": url, "out": "a.csv"}, "is not a number"),
        ):
            done = self.batch([job], code=BAD_INPUT)
            self.assertIn(words, done.stderr)
            self.assertIn("no job was run", done.stderr)
        two = [{"mesh": "a.obj", "out": f"https://example.invalid/a.csv?s=hidden{n}"} for n in (1, 2)]
        self.assertIn("already used by line 1", self.batch(two, code=BAD_INPUT).stderr)

    def test_the_directory_of_results_is_local(self):
        done = latvox("batch", self.write(self.small(1)), "--out", "s3://bucket/results", env=self.environment())
        self.assertEqual(done.returncode, USAGE)
        self.assertIn('--out: "s3://bucket/results" is not a directory of this machine', done.stderr)

    def test_plain_http_to_other_machines_needs_an_option(self):
        # For latvox, this spelling of the loopback address is another machine.
        mesh = presign("GET", self.store.port, "bucket", "in/mesh 1+.obj").replace("127.0.0.1", "[::ffff:127.0.0.1]")
        job = {"mesh": mesh, "resolution": 8, "out": "a.csv"}
        self.assertIn("needs --allow-http", self.batch([job], code=BAD_INPUT).stderr)
        # The signature is about another host, so the store refuses: it was asked.
        self.assertIn("HTTP 403", self.batch([job], "--allow-http", code=REFUSED).stderr)


class Tls(Stores):
    def test_certificates_are_verified_against_own_roots(self):
        authority = Authority(self.dir, "authority")
        certificate, key = authority.issue("store", "store", "subjectAltName=IP:127.0.0.1")
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(certificate, key)
        with Relay(self.store, tls=context) as relay:
            jobs = self.small(4)
            secure = {"AWS_ENDPOINT_URL_S3": f"https://127.0.0.1:{relay.port}"}
            done = self.batch(jobs[:1], code=UNREACHABLE, environment=self.environment(**secure))
            self.assertIn("certificate", done.stderr)
            self.assertNotIn("tries failed", done.stderr)
            self.assertEqual(relay.passed, [])
            for n, name in enumerate(("SSL_CERT_FILE", "AWS_CA_BUNDLE")):
                environment = self.environment(**secure, **{name: str(authority.root)})
                self.batch(jobs[2 * n : 2 * n + 2], environment=environment)
            self.assertEqual(len(relay.count("PUT")), 4)
        self.assertEqual(len(self.keys()), 4)


if __name__ == "__main__":
    unittest.main()
