"""Options from flags, environment and file: --check-config shows them, a changed file is read again; and the lines of
the log."""

import json
import os
import re
import signal
import subprocess
import unittest
import unittest.mock

import harness
from harness import BIN, Case, latvox


# Variables that Kubernetes makes for a Service named latvox, and variables of our other programs.
FOREIGN_VARIABLES = {
    "LATVOX_SERVICE_HOST": "10.0.0.1",
    "LATVOX_SERVICE_PORT": "50151",
    "LATVOX_SERVICE_PORT_GRPC": "50151",
    "LATVOX_PORT": "tcp://10.0.0.1:50151",
    "LATVOX_PORT_50151_TCP": "tcp://10.0.0.1:50151",
    "LATVOX_PORT_50151_TCP_PROTO": "tcp",
    "LATVOX_PORT_50151_TCP_PORT": "50151",
    "LATVOX_PORT_50151_TCP_ADDR": "10.0.0.1",
    "LATVOX_WORKER_COUNT": "4",
    "LATVOX_FAULTS_SECONDS": "10",
    "LATVOX_FAULTS_SEED": "1",
    "LATVOX_PATIENCE": "60",
}


class CheckConfig(Case):
    def check(self, *arguments, **environment):
        command = [BIN / "latvoxd", "--check-config", *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, env=os.environ | environment, cwd=self.dir)

    def settings(self, *arguments, **environment):
        """Returns name -> (value, source)."""
        done = self.check(*arguments, **environment)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        lines = [re.fullmatch(r"(\S+) = (.*?) +# ([^;]*)(;.*)?", line) for line in done.stdout.splitlines()]
        return {line[1]: (line[2], line[3]) for line in lines if line}

    def test_every_option_that_has_a_flag_is_told(self):
        text = subprocess.run([BIN / "latvoxd", "--help"], capture_output=True, text=True).stdout
        flags = set(re.findall(r"--([a-z][a-z-]*)", text)) - {"help", "version", "man", "config", "check-config"}
        told = set(re.findall(r"^(?:# )?(\S+) (?:=|is not set)", self.check().stdout, re.M))
        self.assertGreater(len(flags), 10)
        self.assertEqual(told, flags)

    def test_flag_wins_over_environment_and_that_over_the_file(self):
        file = self.dir / "latvoxd.toml"
        file.write_text('max-jobs = 1\nmax-triangles = 1\nmax-vertices = 1\nmax-mesh-bytes = "3MiB"\n')
        found = self.settings("--max-jobs", 3, LATVOX_CONFIG=str(file), LATVOX_MAX_JOBS="2", LATVOX_MAX_TRIANGLES="2")
        self.assertEqual(found["max-jobs"], ("3", "flag"))
        self.assertEqual(found["max-triangles"], ("2", "environment LATVOX_MAX_TRIANGLES"))
        self.assertEqual(found["max-vertices"], ("1", f"file {file}"))
        self.assertEqual(found["max-mesh-bytes"], ("3145728", f"file {file}"))
        self.assertEqual(found["threads"], ("0", "default"))

    def test_its_output_is_a_configuration_file_of_the_same_values(self):
        once = self.settings("--listen", "127.0.0.1:1", "--listen", "unix:a b", LATVOX_GRACE="2.5", LATVOX_THREADS="3")
        (self.dir / "again.toml").write_text(self.check("--listen", "127.0.0.1:1,unix:a b", "--grace", 2.5, "--threads", 3).stdout)
        again = self.settings("--config", "again.toml")
        self.assertEqual({name: value for name, (value, _) in once.items()}, {name: value for name, (value, _) in again.items()})
        self.assertEqual({source for _, source in again.values()}, {"file again.toml"})

    def test_a_mesh_store_of_nothing_may_be_asked_for(self):
        self.assertEqual(self.settings("--mesh-store-bytes", 0)["mesh-store-bytes"], ("0", "flag"))

    def test_an_error_is_told_with_status_two(self):
        (self.dir / "typo.toml").write_text("max-jbs = 3\n")
        for says, arguments, environment in (
            ("max-jobs.*0", ["--max-jobs", 0], {}),
            ("LATVOX_MAX_JOBS|max-jobs.*many", [], {"LATVOX_MAX_JOBS": "many"}),
            ("max-jobs.*010", ["--max-jobs", "010"], {}),
            ("max-triangles.*-5", ["--max-triangles", "-5"], {}),
            ("memory-budget.*-1", ["--memory-budget", "-1"], {}),
            ("MAX_MESH_BYTES|max-mesh-bytes.*-1", [], {"LATVOX_MAX_MESH_BYTES": "-1"}),
            ("max-jobs.*0x0", ["--max-jobs", "0x0"], {}),
            ("grace.*nan", ["--grace", "nan"], {}),
            ("grace.*-nan", ["--grace=-nan"], {}),
            ("memory budget 1048576 leaves less", ["--memory-budget", "1MiB"], {}),
            ("127.0.0.1.*HOST:PORT", ["--listen", "127.0.0.1"], {}),
            ("127.0.0.1:99999.*65535", ["--listen", "127.0.0.1:99999"], {}),
            (r"127.0.0.1:\+1.*HOST:PORT", ["--listen", "127.0.0.1:+1"], {}),
            ("unix:/a.*for metrics", ["--metrics-listen", "unix:/a"], {}),
            ("nonsense.*HOST:PORT", ["--listen", "127.0.0.1:1", "--metrics-listen", "nonsense"], {}),
            ("max-jbs", ["--config", "typo.toml"], {}),
            ("missing.toml", ["--config", "missing.toml"], {}),
            ("missing.toml", [], {"LATVOX_CONFIG": "missing.toml"}),
        ):
            with self.subTest(says):
                done = self.check(*arguments, **environment)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(done.stderr, says)


    def test_a_misspelled_variable_is_warned_of_and_a_foreign_one_is_not(self):
        done = self.check(
            LATVOX_MAX_JBS="3",
            LATVOX_TLS_CERTIFICATE="none.pem",
            LATVOX_JOBS="3",
            LATVOX_MAX_JOBS="3",
            **FOREIGN_VARIABLES,
        )
        self.assertEqual(done.returncode, 0)
        says = "latvoxd: warning: the environment variable LATVOX_%s is no option; LATVOX_%s is"
        pairs = [("JOBS", "MAX_JOBS"), ("MAX_JBS", "MAX_JOBS"), ("TLS_CERTIFICATE", "TLS_CERT")]
        self.assertEqual(done.stderr.splitlines(), [says % pair for pair in pairs])
        self.assertIn("max-jobs = 3", done.stdout)


class RunningServer(Case):
    def log(self):
        return (self.dir / "latvoxd.log").read_text()

    def await_log(self, pattern):
        harness.await_log(self.dir, pattern)

    def test_sighup_applies_the_files_log_level_and_names_what_needs_a_new_start(self):
        file = self.dir / "latvoxd.toml"
        file.write_text('log-level = "error"\nmax-jobs = 5\n')
        with harness.server(self.dir, "--config", file) as server:
            self.assertEqual(self.log(), "")
            file.write_text('log-level = "info"\nmax-jobs = 6\n')
            server.send_signal(signal.SIGHUP)
            self.await_log("level=info event=reloaded")
            self.assertRegex(self.log(), "level=warning event=restart_needed options=max-jobs\n")
            file.write_text("max-jbs = 6\n")
            server.send_signal(signal.SIGHUP)
            self.await_log("level=error event=reload_failed error=.*max-jbs")
            self.assertIn('"max_jobs": 5', latvox("limits", "--json", "--server", server.address).stdout)

    def test_a_file_that_changes_applies_its_log_level_without_a_signal(self):
        file = self.dir / "latvoxd.toml"
        file.write_text('log-level = "error"\n')
        with harness.server(self.dir, "--config", file):
            self.assertEqual(self.log(), "")
            (self.dir / "new.toml").write_text('log-level = "info"\n')
            (self.dir / "new.toml").rename(file)
            self.await_log(f"level=info event=configuration_read path={file}\n")

    def test_a_log_level_that_the_file_cannot_change_is_told_at_a_level_that_is_written(self):
        (self.dir / "latvoxd.toml").write_text('log-level = "info"\n')
        file = ["--config", self.dir / "latvoxd.toml"]
        for options, environment, says in (
            ([*file, "--log-level", "error"], {}, "level=error event=log_level_fixed by=flag\n"),
            (file, {"LATVOX_LOG_LEVEL": "warning"}, 'level=warning event=log_level_fixed by="environment LATVOX_LOG_LEVEL"\n'),
            ([], {}, 'level=warning event=log_level_fixed by="there is no configuration file"\n'),
        ):
            with self.subTest(says), unittest.mock.patch.dict(os.environ, environment):
                (self.dir / "latvoxd.log").unlink(missing_ok=True)
                with harness.server(self.dir, *options) as server:
                    server.send_signal(signal.SIGHUP)
                    self.await_log(says)

    def test_a_private_server_leaves_half_of_the_memory_unless_it_is_told_how_much_to_take(self):
        def memory_for_jobs(*options, **environment):
            done = latvox("limits", "--json", *options, env=os.environ | {"LATVOX_MESH_STORE_BYTES": "1"} | environment)
            self.assertEqual(done.returncode, 0, done.stderr)
            return json.loads(done.stdout)["memory_budget_bytes"]

        own = 128 << 20  # which is not for jobs; gRPC has an eighth more
        with harness.server(self.dir, "--mesh-store-bytes", "1") as server:
            alone = memory_for_jobs("--server", server.address) + own
        self.assertAlmostEqual((memory_for_jobs() + own) / alone, max(0.5, (256 << 20) / (alone * 8 / 7)), delta=1e-6)
        self.assertAlmostEqual(memory_for_jobs(LATVOX_MEMORY_BUDGET="2GiB"), (7 << 28) - own, delta=1)

    def test_a_misspelled_variable_is_in_its_log(self):
        with unittest.mock.patch.dict(os.environ, {"LATVOX_MAX_JBS": "3"} | FOREIGN_VARIABLES):
            with harness.server(self.dir):
                self.assertEqual(re.findall("unknown_variable.*", self.log()), ["unknown_variable name=LATVOX_MAX_JBS nearest=LATVOX_MAX_JOBS"])

    def test_json_lines_are_objects_with_numbers_as_numbers(self):
        mesh = harness.write_obj(self.dir / "octahedron.obj", harness.octahedron())
        with harness.server(self.dir, "--log-format", "json") as server:
            self.voxelize(mesh, "--lattice", "bcc", "--resolution", 16, "--server", server.address)
            bad = latvox("voxelize", mesh, "-o", self.dir / "no.csv", "--basis", "1,0,0,0,1,0,1,1,0", "--server", server.address)
            self.assertEqual(bad.returncode, 3)
        lines = [json.loads(line) for line in self.log().splitlines()]
        self.assertEqual({"started", "listening", "request", "stopping", "stopped"}, {line["event"] for line in lines})
        good, bad = [line for line in lines if line["event"] == "request"]
        self.assertRegex(good["time"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$")
        self.assertEqual((good["level"], good["code"], good["lattice"], good["triangles"]), ("info", "OK", "bcc", 8))
        self.assertRegex(good["request_id"], "^[0-9a-f]{8}-\d+$")
        self.assertIsInstance(good["total_ms"], float)
        self.assertEqual(bad["code"], "INVALID_ARGUMENT")
        self.assertIn("basis", bad["error"])


if __name__ == "__main__":
    unittest.main()
