"""Scripts do the same on each machine: with a clone of another user, and on each Debian release. Each test has a repository
of its own, with the real scripts. Programs that would build for minutes are stubs."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest
import unittest.mock

import containers
from debian_root import ROOT

COMMITTED = "1000000000"  # seconds since 1970
# The facts that a script hands on: stub in PATH -> what it writes to $FACTS.
BUILDING = {"cmake": 'printf "%s\\n" "SOURCE_DATE_EPOCH=$SOURCE_DATE_EPOCH" "$@" >>"$FACTS"', "dpkg": "echo amd64", "cpack": "touch latvox.deb"}
PACKING = {"cmake": 'echo "SOURCE_DATE_EPOCH=$SOURCE_DATE_EPOCH" >"$FACTS"; exit 1', "patchelf": ""}
ENTERING = {"unshare": 'printf "%s\\n" "$@" >"$FACTS"', "mmdebstrap": "", "pivot_root": ""}
TESTING = {"cmake": "", "ctest": 'echo "The following tests did not run:"; printf "\\t 12 - %s (Skipped)\\n" $LEFT_OUT'}


class Machine(unittest.TestCase):
    def setUp(self):
        self.dir = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-machine-")))
        self.repository = self.dir / "repository"
        self.facts = self.dir / "facts"
        (self.dir / "bin").mkdir()

    def place(self, *scripts, stubs=()):
        """Puts real scripts and empty ones into the repository, and commits them."""
        for name in (*scripts, *stubs):
            path = self.repository / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes((ROOT / name).read_bytes() if name in scripts else b"#!/bin/bash\n")
            path.chmod(0o755)
        dates = {"GIT_AUTHOR_DATE": f"@{COMMITTED} +0000", "GIT_COMMITTER_DATE": f"@{COMMITTED} +0000"}
        for words in ("init --quiet", "add .", "-c user.name=a -c user.email=a@localhost commit --quiet --message=all"):
            subprocess.run(["git", "-C", self.repository, *words.split()], env=os.environ | dates, check=True, capture_output=True)

    def run_script(self, *words, programs, **variables):
        for name, script in programs.items():
            path = self.dir / "bin" / name
            path.write_text(f"#!/bin/bash\n{script}\n")
            path.chmod(0o755)
        given = {"PATH": f"{self.dir / 'bin'}:{os.environ['PATH']}", "FACTS": str(self.facts), "HOME": str(self.dir)}
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("LATVOX_", "SOURCE_DATE_"))}
        return subprocess.run([self.repository / words[0], *words[1:]], env=kept | given | variables, capture_output=True, text=True)


class CloneOfAnotherUser(Machine):
    """git refuses it, unless a script says that it is safe."""

    def facts_of(self, *words, programs):
        done = self.run_script(*words, programs=programs, GIT_TEST_ASSUME_DIFFERENT_OWNER="1")
        self.assertTrue(self.facts.exists(), done.stderr)
        return self.facts.read_text().splitlines()

    def test_packages_have_maintainer_and_time_of_the_commit(self):
        self.place("deploy/packaging/build", stubs=["deploy/install-packages"])
        (self.repository / "build/packages").mkdir(parents=True)
        facts = self.facts_of("deploy/packaging/build", programs=BUILDING)
        self.assertIn("LATVOX_PACKAGE_MAINTAINER=a <a@localhost>", facts)
        self.assertIn(f"SOURCE_DATE_EPOCH={COMMITTED}", facts)

    def test_the_tarball_has_the_time_of_the_commit(self):
        self.place("deploy/packaging/tarball", stubs=["deploy/install-packages"])
        tree = self.repository / "build/packages"
        (tree / "bin").mkdir(parents=True)
        for name in ("CMakeCache.txt", "late_libraries.txt", "bin/latvox", "bin/latvoxd"):
            (tree / name).touch()
        self.assertEqual(self.facts_of("deploy/packaging/tarball", programs=PACKING), [f"SOURCE_DATE_EPOCH={COMMITTED}"])

    @unittest.skipIf(os.geteuid() != 0, "only root can enter a system in a folder")
    def test_another_debian_gets_the_facts_of_the_commit(self):
        self.place("deploy/packaging/in-debian")
        root = self.repository / "build/roots/trixie"
        root.mkdir(parents=True)
        root.with_suffix(".made").touch()
        facts = self.facts_of("deploy/packaging/in-debian", "trixie", "true", programs=ENTERING)
        commit = subprocess.run(["git", "-C", self.repository, "rev-parse", "HEAD"], capture_output=True, text=True).stdout.strip()
        for fact in f"LATVOX_COMMIT={commit}", "LATVOX_PACKAGE_MAINTAINER=a <a@localhost>", f"SOURCE_DATE_EPOCH={COMMITTED}":
            self.assertIn(fact, facts)


class OtherRelease(Machine):
    def test_the_base_of_the_image_is_debian_12(self):
        made = {}

        def bootstrap(tar, *options, release="that of this machine"):
            made[release] = options
            tar.touch()

        (self.dir / "work").mkdir()
        with unittest.mock.patch.multiple(containers, STATE=self.dir, bootstrap=bootstrap, exists=lambda _: False, podman=lambda *_: None):
            containers.debian(containers.BASE, "--include=wget")
        self.assertEqual(made, {"bookworm": ("--include=wget",)})

    def test_a_skipped_test_fails_where_a_package_could_run_it(self):
        self.place("tests/run", stubs=["deploy/install-packages", "deploy/packaging/build", "deploy/packaging/tarball"])
        system, script = self.dir / "os-release", self.repository / "tests/run"
        script.write_text(script.read_text().replace("/etc/os-release", str(system)))
        for release, left_out, status in (("bookworm", "deploy.kustomize", 0), ("trixie", "deploy.kustomize", 1), ("bookworm", "deploy.image", 1)):
            system.write_text(f"ID=debian\nVERSION_CODENAME={release}\n")
            done = self.run_script("tests/run", "--packages", programs=TESTING, LEFT_OUT=left_out)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertEqual(f"asks for tests that were skipped: {left_out}\n" in done.stderr, status == 1)


if __name__ == "__main__":
    unittest.main()
