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
            ("--memory-budget: 1048576 bytes leave less than 67108864 for jobs; 268435456 suffice", ["--memory-budget", "1MiB"], {}),
            ("127.0.0.1.*HOST:PORT", ["--listen", "127.0.0.1"], {}),
            ("127.0.0.1:99999.*65535", ["--listen", "127.0.0.1:99999"], {}),
            (r"127.0.0.1:\+1.*HOST:PORT", ["--listen", "127.0.0.1:+1"], {}),
            ("unix:/a.*for metrics", ["--metrics-listen", "unix:/a"], {}),
            ("nonsense.*HOST:PORT", ["--listen", "127.0.0.1:1", "--metrics-listen", "nonsense"], {}),
            ("max-jbs", ["--config", "typo.toml"], {}),
            ("^latvoxd: missing.toml: cannot be read .No such file", ["--config", "missing.toml"], {}),
            ("^latvoxd: missing.toml: cannot be read .No such file", [], {"LATVOX_CONFIG": "missing.toml"}),
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


# By the name that help gives to an option's value: TOML that its key does not take.
NOT_A_NUMBER = ["true", "[1]", "{a = 1}", "1979-05-27", '"many"', '"3"', "2.5", "-1", "99999999999999999999"]
WRONG = {
    "": ["1", '"true"', '"yes"', "[true]"],
    "N": NOT_A_NUMBER,
    "SIZE": ["true", "[1]", "2.5", "-1", '"999PiB"', "999999999999999999", "99999999999999999999", '"99999999999999999999"',
             '"99999999999EiB"', '"1XB"', '"GiB"', '"1.5GiB"', '""', '"-1GiB"'],
    "SECONDS": ["true", '"1"', "[1]", "-1", "nan", "inf", "86401", "99999999999999999999"],
    "TEXT": ["1", "true", "[]", "[1]", '"a\\u0000b"'],
    "words": ["1", "true", '["info"]', '"no such word"', '""'],
}  # fmt: skip
WRONG["FILE"] = WRONG["ADDRESS"] = WRONG["TEXT"]
# The same for variables and flags.
WRONG_WORDS = {
    "": ["maybe", "2"],
    "N": ["many", "-1", "2.5", "1x", "0x10", "99999999999999999999", "1,2"],
    "SIZE": ["many", "-1", "2.5", "999PiB", "99999999999EiB", "99999999999999999999", "1XB", "GiB", "1.5GiB", "1GiB,1"],
    "SECONDS": ["many", "-1", "nan", "inf", "86401", "1s", "1,2"],
    "words": ["no such word"],
}
# Texts that are no TOML at all, and the line of the error.
NO_TOML = [
    (b'listen = ["127.0.0.1:1"', 1),
    (b'log-level = "info"\nlisten = ["127.0.0.1:1",\n"127.0.0.1:2"\n', 3),
    (b'log-level = "info\n', 1),
    (b"log-level = info\n", 1),
    (b"max-jobs\n", 1),
    (b"max-jobs =\n", 1),
    (b"= 3\n", 1),
    (b"max-jobs = 3 4\n", 1),
    (b"max-jobs = 3\nthreads = 1\nmax-jobs = 4\n", 3),
    (b"max-jobs = 3\n\0threads = 1\n", 2),
    (b'log-level = "in\0fo"\n', 1),
    (b'log-level = "info" # \xff\n', 1),
    (b'tls-cert = "\xc3\x28"\n', 1),
    (b"\x7fELF\x02\x01\x01\0\0\0\0", 1),
    (b"\xff\xfem\0a\0x\0", 1),
    (b"max-jobs = 3\n[limits]\nthreads = 1\n", 2),
    (b"limits.threads = 1\n", 1),
]


class WrongValues(Case):
    """Each option, with each wrong value that its kind has."""

    def check(self, *arguments, **environment):
        command = [BIN / "latvoxd", "--check-config", *arguments]
        return subprocess.run(command, capture_output=True, env=os.environ | environment, cwd=self.dir, errors="replace")

    def options(self):
        """Returns flag -> kind, from the help."""
        text = subprocess.run([BIN / "latvoxd", "--help"], capture_output=True, text=True).stdout
        found = dict(re.findall(r"^  (--[a-z-]+)(?: (\S+))?(?:\s\s|$)", text, re.M))
        for flag in ("--man", "--config", "--check-config", "--parent-pid"):
            del found[flag]
        return {flag: "words" if "|" in value else value for flag, value in found.items()}

    def assert_refused(self, done, *says):
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        first = done.stderr.splitlines()[0]
        for text in says:
            self.assertIn(text, first)

    def test_in_a_file(self):
        self.assertGreater(len(self.options()), 30)
        for flag, kind in self.options().items():
            for value in WRONG[kind]:
                with self.subTest(f"{flag} = {value}"):
                    (self.dir / "l.toml").write_text(f"# a comment\n\n{flag[2:]} = {value}\n")
                    done = self.check("--config", "l.toml")
                    self.assert_refused(done, "l.toml:3: ")
                    if value not in ("99999999999999999999", "1979-05-27", "{a = 1}"):  # the reader of TOML does not say
                        self.assert_refused(done, flag[2:])

    def test_in_a_variable_and_on_the_command_line(self):
        for flag, kind in self.options().items():
            variable = "LATVOX_" + flag[2:].upper().replace("-", "_")
            for word in WRONG_WORDS.get(kind, []):
                with self.subTest(f"{flag} {word}"):
                    self.assert_refused(self.check(**{variable: word}), variable + ": ", word.partition(",")[0])
                    self.assert_refused(self.check(f"{flag}={word}"), flag, word.partition(",")[0])

    def test_an_error_names_the_limit(self):
        for line, says in (
            ('memory-budget = "999PiB"', "l.toml:1: memory-budget: 999PiB exceeds 128TiB"),
            ("max-visited-points = 99999999999999999999", "l.toml:1: "),
            ("max-jobs = 4294967296", "l.toml:1: max-jobs: 4294967296 exceeds 4294967295"),
            ("threads = 1025", "l.toml:1: threads: \"1025\" is not a whole number from 0 to 1024"),
            ("grace = 86401", "l.toml:1: grace: \"86401\" is not a number from 0 to 86400"),
            ('log-level = "loud"', "l.toml:1: log-level: \"loud\" is not one of debug, info"),
            ("max-jobs = 0", "l.toml:1: max-jobs: 0 is below 1"),
            ('max-jobs = "3"', "l.toml:1: max-jobs: 3 is a text, not a whole number"),
            ("insecure = 1", "l.toml:1: insecure: 1 is a whole number, not true or false"),
            ("max-jbs = 1", 'l.toml:1: unknown key "max-jbs"; did you mean max-jobs?'),
            ("frobnicate = 1", 'l.toml:1: unknown key "frobnicate"'),
            ("check-config = true", "l.toml:1: check-config: may only stand on the command line"),
            ("parent-pid = 1", "l.toml:1: parent-pid: may only stand on the command line"),
        ):
            with self.subTest(line):
                (self.dir / "l.toml").write_text(line)
                self.assert_refused(self.check("--config", "l.toml"), says)

    def test_what_is_no_toml_is_refused_with_its_line(self):
        for content, line in NO_TOML:
            with self.subTest(content):
                (self.dir / "l.toml").write_bytes(content)
                self.assert_refused(self.check("--config", "l.toml"), f"l.toml:{line}: ")

    def test_files_that_cannot_be_read(self):
        (self.dir / "large.toml").write_text("# comment\n" * 200_000)
        for path, says in (("large.toml", "large.toml: exceeds 1048576"), ("/dev/zero", "/dev/zero: exceeds 1048576"),
                           ("missing.toml", "missing.toml"), (".", ".")):  # fmt: skip
            with self.subTest(path):
                self.assert_refused(self.check("--config", path), says)

    def test_a_flag_twice_is_refused(self):
        for flag, kind in self.options().items():
            value = {"N": "2", "SIZE": "1GiB", "SECONDS": "5"}.get(kind)
            if value:
                self.assert_refused(self.check(flag, value, flag, value), flag)

    def test_a_file_of_everything_that_is_right_is_read(self):
        (self.dir / "l.toml").write_text(
            "\ufeff# a byte order mark\nmax-jobs = 1_0\n\"max-triangles\" = 0x10\ngrace = 2.5\nstall-timeout = 5\n"
            'listen = [\n  "127.0.0.1:1", # one\n  \'unix:a b\',\n]\nmemory-budget = "4GiB"\ninsecure = true\n'
        )
        done = self.check("--config", "l.toml")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for line in ("max-jobs = 10 ", "max-triangles = 16 ", "grace = 2.5 ", 'listen = ["127.0.0.1:1", "unix:a b"]',
                     "memory-budget = 4294967296 ", "insecure = true "):  # fmt: skip
            self.assertIn(line, done.stdout)


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
        self.assertRegex(good["request_id"], r"^[0-9a-f]{8}-\d+$")
        self.assertIsInstance(good["total_ms"], float)
        self.assertEqual(bad["code"], "INVALID_ARGUMENT")
        self.assertIn("basis", bad["error"])


if __name__ == "__main__":
    unittest.main()
