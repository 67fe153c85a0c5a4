"""Programs and server tell their origin: version, commit, libraries."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from harness import BIN, latvox

ROOT = pathlib.Path(__file__).resolve().parents[2]
COMMIT = r"[0-9a-f]{40}(-modified)?|unknown"
MANUAL = "deploy/manual"


def page(program):
    done = subprocess.run([pathlib.Path(BIN) / program, "--version"], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


class Programs(unittest.TestCase):
    def test_the_first_line_is_name_and_version_alone(self):
        version = re.search(r"project\(latvox VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
        for program in "latvox", "latvoxd":
            self.assertEqual(page(program)[0], f"{program} {version}")

    def test_both_programs_and_the_server_name_one_commit(self):
        commits = {page(program)[1].removeprefix("commit ") for program in ("latvox", "latvoxd")}
        commits.add(json.loads(latvox("limits", "--json").stdout)["commit"])
        self.assertEqual(len(commits), 1)
        self.assertRegex(commits.pop(), rf"^({COMMIT})$")

    def test_libraries_have_versions(self):
        of_tool, of_server = (page(program)[2].removeprefix("built with ") for program in ("latvox", "latvoxd"))
        for text, names in (of_tool, ("Abseil", "Draco", "gRPC", "OpenVDB", "Protobuf")), (of_server, ("Draco", "gRPC", "OpenSSL")):
            for name in names:
                self.assertRegex(text, rf"(^|, ){name} [0-9.]+(,|$)")
        self.assertNotIn("unknown", of_tool + of_server)
        told = json.loads(latvox("limits", "--json").stdout)["libraries"]
        self.assertEqual(dict(each.split(" ") for each in of_server.split(", ")), told)
        self.assertIn(of_server, latvox("limits").stdout)


class CommitOfABuild(unittest.TestCase):
    """The script that each build runs, on repositories and tarballs of a file or two."""

    def setUp(self):
        self.dir = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.source = self.dir / "source"
        (self.source / MANUAL).mkdir(parents=True)
        for name in "commit", "commit.cmake", ".gitattributes":
            (self.source / MANUAL / name).write_bytes((ROOT / MANUAL / name).read_bytes())

    def git(self, *words):
        settings = ["-c", "user.name=a", "-c", "user.email=a@localhost", "-c", "init.defaultBranch=main"]
        done = subprocess.run(["git", *settings, "-C", self.source, *words], capture_output=True, check=True)
        return done.stdout

    def commit(self):
        self.git("init", "--quiet")
        self.git("add", ".")
        self.git("commit", "--quiet", "--message=all")
        return self.git("rev-parse", "HEAD").decode().strip()

    def written(self, source=None, given="", check=True):
        """Returns the commit in the file that the script writes."""
        source = source or self.source
        output = self.dir / "commit.cc"
        command = ["cmake", "-D", f"SOURCE={source}", "-D", f"OUTPUT={output}", "-D", f"LATVOX_COMMIT={given}", "-P"]
        done = subprocess.run([*command, source / MANUAL / "commit.cmake"], capture_output=True, text=True)
        self.assertEqual(done.returncode == 0, check, done.stderr)
        return re.search(r'kCommit = "(.*)";', output.read_text())[1] if check else done.stderr

    def test_git_tells_it_and_modified_files_too(self):
        commit = self.commit()
        self.assertEqual(self.written(), commit)
        self.git("tag", "v1.0.0")
        self.assertEqual(self.written(), commit)
        script = self.source / MANUAL / "commit.cmake"
        script.write_text(script.read_text() + "# more\n")
        self.assertEqual(self.written(), commit + "-modified")

    def test_tarballs_have_it(self):
        commit = self.commit()
        unpacked = self.dir / "unpacked"
        unpacked.mkdir()
        subprocess.run(["tar", "-x", "-C", unpacked], input=self.git("archive", "HEAD"), check=True)
        self.assertEqual(self.written(unpacked), commit)

    def test_it_is_unknown_without_both_and_within_a_repository_of_others(self):
        self.assertEqual(self.written(), "unknown")
        subprocess.run(["git", "init", "--quiet", self.dir], check=True)
        self.assertEqual(self.written(), "unknown")

    def test_a_given_one_counts(self):
        self.commit()
        self.assertEqual(self.written(given="abc"), "abc")
        self.assertIn('LATVOX_COMMIT is "a b"', self.written(given="a b", check=False))

    def test_the_same_commit_leaves_the_file_alone(self):
        self.commit()
        self.written()
        os.utime(self.dir / "commit.cc", (1, 1))
        self.written()
        self.assertEqual((self.dir / "commit.cc").stat().st_mtime, 1)


if __name__ == "__main__":
    unittest.main()
