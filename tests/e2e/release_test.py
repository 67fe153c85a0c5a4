"""deploy/release refuses a commit that is not ready, and names the reason. Each test has a repository of its own. And
deploy/packages has all that it needs.

The script and the check of the protocol are the real ones. Programs that would build for minutes are stubs, which write
small files. buf is the real one where a protocol changes, because its start takes half a second.
"""

import ast
import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUF = ROOT / "tests/node/node_modules/.bin/buf"
PROTOCOL = "proto/latvox/v1/voxelizer.proto"
RELEASED = "proto/released/latvox/v1/voxelizer.proto"
OWN_RELEASE = platform.freedesktop_os_release()["VERSION_CODENAME"]
OTHER_RELEASE = "trixie" if OWN_RELEASE == "bookworm" else "bookworm"
# Stubs: path in the repository or in PATH -> script.
STUBS = {
    "deploy/install-packages": "",
    "deploy/packaging/build": 'tree=build${1:+/$1}/packages; mkdir -p $tree/docs; cd $tree; touch latvox_${1:-own}.deb docs/index.html; echo libcurl.so.4 >late_libraries.txt',
    "deploy/packaging/in-debian": 'mkdir -p build/$1/packages; touch "build/$1/packages/latvox_$1.deb"; [[ $2 == *build ]] || LATVOX_TREE=build/$1/packages "${@:2}"',
    "deploy/packaging/arm64/image": "mkdir -p build/arm64/image",
    "deploy/packaging/tarball": 'touch "${LATVOX_TREE:-build/packages}/latvox-0-linux-$(uname -m).tar.gz"',
    "deploy/sbom": 'echo "{}" "$@"',
}
PROGRAMS = {
    "cmake": 'mkdir -p build/abi/client; touch build/abi/client/liblatvox.so',
    "abidw": 'while [[ $1 != --out-file ]]; do shift; done; echo "$ABI" >"$2"',
    "abidiff": 'cmp -s "$2" "$3" || exit 4',
    "docker": "exit 1",
    "podman": 'if [[ $1 == save ]]; then echo "image $4" >"$3"; else echo "podman $*" >>podman.log; fi',
    "buildah": "exit 1",
    "dpkg": "echo amd64",
}


class Release(unittest.TestCase):
    def setUp(self):
        self.dir = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-release-")))
        self.repository = self.dir / "repository"
        (self.repository / "deploy/packaging/arm64").mkdir(parents=True)
        (self.dir / "bin").mkdir()
        shutil.copy(ROOT / "deploy/release", self.repository / "deploy")
        shutil.copytree(ROOT / "proto", self.repository / "proto")
        shutil.copy(self.repository / PROTOCOL, self.repository / RELEASED)
        for path, script in [*STUBS.items(), *((self.dir / "bin" / name, script) for name, script in PROGRAMS.items())]:
            stub = self.repository / path
            stub.write_text(f"#!/bin/bash\n{script}\n")
            stub.chmod(0o755)
        (self.repository / ".gitignore").write_text("/build/\n/podman.log\n")
        self.git("init", "--quiet")
        self.prepare("0.1.0")

    def git(self, *words):
        settings = ["-c", "user.name=a", "-c", "user.email=a@localhost", "-c", "init.defaultBranch=main", "-c", "tag.gpgSign=false"]
        return subprocess.run(["git", *settings, "-C", self.repository, *words], capture_output=True, text=True, check=True).stdout

    def prepare(self, version, heading=None):
        """Commits everything, with a version and a section of the change log."""
        (self.repository / "CMakeLists.txt").write_text(f"project(latvox VERSION {version} LANGUAGES CXX)\n")
        heading = heading or f"## {version}, 2030-01-31"
        (self.repository / "deploy/CHANGELOG.md").write_text(f"# Change log\n\n{heading}\n\nText.\n")
        self.git("add", ".")
        self.git("commit", "--quiet", "--message", version)

    def stub(self, name, script):
        path = self.dir / "bin" / name
        path.write_text(f"#!/bin/bash\n{script}\n")
        path.chmod(0o755)

    def commit(self, path, change):
        """Commits a script after `change` of its text."""
        script = self.repository / path
        script.write_text(change(script.read_text()))
        self.git("commit", "--quiet", "--all", "--message", path)

    def release(self, *words, abi="one", buf="true"):
        environment = os.environ | {"PATH": f"{self.dir / 'bin'}:{os.environ['PATH']}", "LATVOX_BUF": str(buf), "ABI": abi}
        if buf is None:
            del environment["LATVOX_BUF"]
        return subprocess.run([self.repository / "deploy/release", *words], env=environment, capture_output=True, text=True)

    def refused(self, why, *words, **options):
        done = self.release(*words, **options)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn(f"release: refused: {why}", done.stderr)
        self.assertEqual(done.stderr.count("refused"), 1, done.stderr)
        self.assertFalse((self.repository / f"build/releases/{words[0]}/SHA256SUMS").exists())

    def made(self, *words, **options):
        done = self.release(*words, **options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def replace(self, path, old, new):
        text = (self.repository / path).read_text()
        self.assertEqual(text.count(old), 1, old)
        (self.repository / path).write_text(text.replace(old, new))

    def break_protocol(self):
        for path in PROTOCOL, RELEASED:
            self.replace(path, "  bool verify = 8;", "  bool verify = 99;")

    def test_a_release_has_all_files_and_their_checksums(self):
        text = self.made("0.1.0")
        folder = self.repository / "build/releases/0.1.0"
        names = {"latvox-0.1.0.tar.gz", "latvox-0.1.0-docs.tar.gz", "latvox-0.1.0-bookworm.spdx.json", "latvox-0.1.0-trixie.spdx.json", "latvox-gateway-0.1.0.spdx.json",
                 "latvox-0.1.0.abi.tar.gz", "latvox-0.1.0-image.tar.gz", "latvox-0.1.0-image-arm64.tar.gz", f"latvox-0-linux-{platform.machine()}.tar.gz"}  # fmt: skip
        names |= {f"{OWN_RELEASE}-amd64/latvox_own.deb", f"{OTHER_RELEASE}-amd64/latvox_{OTHER_RELEASE}.deb", f"{OWN_RELEASE}-arm64/latvox_arm64.deb"}
        sums = dict(reversed(line.split("  ")) for line in (folder / "SHA256SUMS").read_text().splitlines())
        self.assertEqual(sums.keys(), names)
        self.assertEqual({str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()} - {"SHA256SUMS"}, names)
        for path in folder.iterdir():
            self.assertLessEqual(len(list(path.glob("latvox_*.deb"))), 1, "a pattern of the pages takes packages of two systems")
        for name, sum in sums.items():
            self.assertEqual(hashlib.sha256((folder / name).read_bytes()).hexdigest(), sum)
        with tarfile.open(folder / "latvox-0.1.0.tar.gz") as tarball:
            self.assertIn("latvox-0.1.0/CMakeLists.txt", tarball.getnames())
        for release in "bookworm", "trixie":
            self.assertIn("latvox-vdb.so client/python/latvox/_latvox.*.so libcurl.so.4", (folder / f"latvox-0.1.0-{release}.spdx.json").read_text())
        for told in ("0.1.0 is the first release", "no release before this one", "no ABI of a last release", "whose maintainer is a <a@localhost>", "git tag -s v0.1.0"):
            self.assertIn(told, text)

    def test_a_fresh_machine_gets_its_programs_first(self):
        for name in "git", "npm":
            self.stub(name, "exit 127")
        npm = "mkdir -p tests/node/node_modules/.bin; ln -s /bin/true tests/node/node_modules/.bin/buf"
        script = f"[[ $1 == release ]]; rm '{self.dir}/bin/git'; printf '#!/bin/bash\n{npm}\n' >'{self.dir}/bin/npm'"
        self.commit("deploy/install-packages", lambda text: f"{text}{script}\n")
        self.made("0.1.0", buf=None)

    def test_root_releases_the_clone_of_somebody_else(self):
        self.git("tag", "v0.0.9")
        with unittest.mock.patch.dict(os.environ, GIT_TEST_ASSUME_DIFFERENT_OWNER="1"):
            self.assertIn("whose maintainer is a <a@localhost>", self.made("0.1.0"))

    def test_images_have_the_time_of_the_commit_and_their_health_check(self):
        self.made("0.1.0")
        time = self.git("log", "-1", "--format=%ct").strip()
        built = (self.repository / "podman.log").read_text()
        self.assertRegex(built, rf"(?m)^podman build --format docker --timestamp {time} .* --build-arg SOURCE_DATE_EPOCH={time} --tag localhost/latvox:0.1.0 \.$")
        self.assertRegex(built, rf"(?m)^podman build --format docker --timestamp {time} --platform linux/arm64 .* --tag localhost/latvox:0.1.0-arm64 build/arm64/image$")

    def test_an_arm_machine_makes_its_own_image_alone(self):
        self.stub("dpkg", "echo arm64")
        self.made("0.1.0")
        self.assertNotIn("-arm64", (self.repository / "podman.log").read_text())

    def test_a_machine_that_builds_no_image_is_refused_unless_none_is_wanted(self):
        self.stub("podman", "exit 1")
        self.refused("neither docker with buildx nor podman nor buildah runs here", "0.1.0")
        self.assertIn("NOT BUILT", self.made("0.1.0", "--without-image"))
        self.stub("buildah", 'if [[ $1 == push ]]; then file=${3#docker-archive:}; echo image >"${file%%:*}"; else echo "$*" >>podman.log; fi')
        self.made("0.1.0")
        self.assertTrue((self.repository / "build/releases/0.1.0/latvox-0.1.0-image.tar.gz").exists())
        builds = re.findall(r"^build .*", (self.repository / "podman.log").read_text(), re.M)
        self.assertEqual([" --isolation chroot " in build for build in builds], [True, True], builds)

    def test_docker_builds_the_image_if_it_has_buildx(self):
        log = self.repository / "podman.log"
        for buildx, builder in (False, "podman"), (True, "docker"):
            self.stub("docker", f"[[ $1 == info ]] || {str(buildx).lower()} || exit 1\n{PROGRAMS['podman'].replace('podman $*', 'docker $*')}")
            self.made("0.1.0")
            self.assertEqual(set(re.findall(r"^(\w+) (?:buildx )?build .*", log.read_text(), re.M)), {builder})
            log.unlink()

    def test_no_temporary_file_stays(self):
        temporary = self.dir / "temporary"
        temporary.mkdir()
        self.prepare("0.0.9")
        self.git("tag", "v0.0.9")
        self.prepare("0.1.0")
        with unittest.mock.patch.dict(os.environ, TMPDIR=str(temporary)):
            self.assertIn("The protocol is compatible with 0.0.9", self.made("0.1.0"))
        self.assertEqual(list(temporary.iterdir()), [])

    def test_equal_commits_make_equal_files(self):
        self.made("0.1.0")
        sums = self.repository / "build/releases/0.1.0/SHA256SUMS"
        before = sums.read_text()
        self.made("0.1.0")
        self.assertEqual(sums.read_text(), before)

    def test_wrong_usage_has_status_two(self):
        for words in ([], ["1.2"], ["1.2.3.4"], ["01.2.3"], ["v1.2.3"], ["0.1.0", "--force"], ["0.1.0", "0.1.1"], ["0.1.0", "--last-abi"]):
            self.assertEqual(self.release(*words).returncode, 2, words)

    def test_a_changed_tree_is_refused(self):
        self.replace("CMakeLists.txt", "CXX)", "CXX )")
        self.refused("the tree has changes that no commit has: CMakeLists.txt", "0.1.0")

    def test_a_file_that_no_commit_has_is_refused(self):
        (self.repository / "new").touch()
        self.refused("the tree has changes that no commit has: new", "0.1.0")

    def test_another_version_in_cmake_is_refused(self):
        self.prepare("0.1.0", heading="## 0.2.0, 2030-01-31")
        self.refused("CMakeLists.txt states version 0.1.0, and not 0.2.0", "0.2.0")

    def test_a_change_log_without_number_or_date_is_refused(self):
        for heading in ("## 0.1.0, in preparation", "## 0.2.0, 2030-01-31", "## 0.1.0"):
            self.prepare("0.1.0", heading=heading)
            self.refused(f'the first section of deploy/CHANGELOG.md is "{heading}"', "0.1.0")

    def test_a_change_log_without_sections_is_refused(self):
        (self.repository / "deploy/CHANGELOG.md").write_text("# Change log\n")
        self.git("commit", "--quiet", "--all", "--message", "no section")
        self.refused('the first section of deploy/CHANGELOG.md is ""', "0.1.0")

    def test_an_existing_tag_is_refused(self):
        self.git("tag", "v0.1.0")
        self.refused("the tag v0.1.0 exists", "0.1.0")

    def test_a_version_below_the_last_is_refused(self):
        self.git("tag", "v0.10.0")
        self.prepare("0.9.0")
        self.refused("0.9.0 is below 0.10.0, the last release", "0.9.0")

    def test_a_clone_without_the_last_release_is_refused(self):
        self.prepare("0.0.9")
        self.git("tag", "v0.0.9")
        self.prepare("0.1.0")
        (self.repository / "deploy/CHANGELOG.md").write_text("## 0.1.0, 2030-01-31\n\n## 0.0.9, 2029-01-31\n\n## 0.0.8, 2028-01-31\n")
        self.git("commit", "--quiet", "--all", "--message", "log")
        self.assertNotIn("first release", self.made("0.1.0"))
        whole = self.repository
        for words, why in (("--depth=1", "this clone is shallow"), ("--no-tags", "deploy/CHANGELOG.md has the release 0.0.9, and this clone lacks its tag")):
            self.repository = self.dir / words
            subprocess.run(["git", "clone", "--quiet", words, f"file://{whole}", self.repository], check=True)
            self.refused(why, "0.1.0")

    def test_a_last_release_on_another_branch_is_refused(self):
        self.prepare("0.0.9")
        self.git("tag", "v0.0.9")
        self.git("checkout", "--quiet", "-b", "side")
        self.prepare("0.0.10")
        self.git("tag", "v0.0.10")
        self.git("checkout", "--quiet", "-")
        self.prepare("0.1.0")
        (self.repository / "deploy/CHANGELOG.md").write_text("## 0.1.0, 2030-01-31\n\n## 0.0.10, 2029-01-31\n")
        self.git("commit", "--quiet", "--all", "--message", "log")
        self.refused("deploy/CHANGELOG.md has the release 0.0.10, which is no ancestor of this commit; merge v0.0.10", "0.1.0")

    def test_a_protocol_that_was_not_copied_is_refused(self):
        self.replace(PROTOCOL, "  bool verify = 8;", "  bool verify = 8;\n\n  // For this test.\n  bool another = 99;")
        self.prepare("0.1.0")
        self.refused("proto/released is not this protocol", "0.1.0")

    def test_a_protocol_that_breaks_its_promise_is_refused(self):
        for last, version, allowed in (("1.0.0", "1.1.0", False), ("1.9.0", "2.0.0", True)):
            self.prepare(last)
            self.git("tag", f"v{last}")
            self.break_protocol()
            self.prepare(version)
            if allowed:
                self.assertIn(f"breaks that of {last}, as {version} may", self.made(version, buf=BUF))
            else:
                self.refused(f"the protocol breaks that of {last}, and {version} promises to keep it", version, buf=BUF)
            self.git("reset", "--quiet", "--hard", f"v{last}")

    def test_an_abi_that_breaks_programs_is_refused(self):
        self.made("0.1.0")
        dump = self.dir / "latvox-0.1.0.abi.tar.gz"
        shutil.copy(self.repository / "build/releases/0.1.0/latvox-0.1.0.abi.tar.gz", dump)
        self.git("tag", "v0.1.0")
        self.prepare("0.1.1")
        self.refused("the SDK keeps the soname of 0.1.0; name its dump by --last-abi latvox-0.1.0.abi.tar.gz", "0.1.1")
        self.refused("--last-abi: there is no file none", "0.1.1", "--last-abi", "none")
        self.refused("liblatvox: the ABI may break programs of 0.1.0", "0.1.1", "--last-abi", dump, abi="another")
        self.assertIn("liblatvox: programs of 0.1.0 go on working", self.made("0.1.1", "--last-abi", dump))

    @unittest.skipIf(shutil.which("abidw") is None, "abigail-tools is not installed; deploy/install-packages test")
    def test_the_real_abidiff_finds_a_function_that_vanishes(self):
        for name in "abidw", "abidiff":
            (self.dir / "bin" / name).unlink()
        compiled = "mkdir -p build/abi/client; g++ -g -shared -fPIC -I client/include -o build/abi/client/liblatvox.so client/a.cc"
        self.stub("cmake", compiled)
        (self.repository / "client/include").mkdir(parents=True)

        def prepare(version, *functions):
            (self.repository / "client/include/a.h").write_text("".join(f"int {name}(int);\n" for name in functions))
            (self.repository / "client/a.cc").write_text('#include "a.h"\n' + "".join(f"int {name}(int n) {{ return n; }}\n" for name in functions))
            self.prepare(version)

        prepare("0.1.0", "one", "two")
        self.made("0.1.0", "--without-image")
        dump = shutil.copy(self.repository / "build/releases/0.1.0/latvox-0.1.0.abi.tar.gz", self.dir)
        self.git("tag", "v0.1.0")
        prepare("0.1.1", "one")
        self.refused("liblatvox: the ABI may break programs of 0.1.0", "0.1.1", "--last-abi", dump, "--without-image")
        prepare("0.1.1", "one", "two", "three")
        self.assertIn("liblatvox: programs of 0.1.0 go on working", self.made("0.1.1", "--last-abi", dump, "--without-image"))

    def test_the_abi_is_that_of_one_debian_release_on_each_machine(self):
        """The programs that dump it are installed there, too."""
        system = self.dir / "os-release"
        self.commit("deploy/release", lambda text: text.replace("/etc/os-release", str(system)))
        # Like the real one: `build` is a folder of the release's own.
        view = 'view=$(mktemp -d --tmpdir="${PWD%/*}"); ln -s "$PWD"/* $view; mkdir -p build/$1; ln -sfn "$PWD/build/$1" $view/build; cd $view; DEBIAN=$1 "${@:2}"'
        self.commit("deploy/packaging/in-debian", lambda _: f"#!/bin/bash\n{view}\n")
        self.commit("deploy/install-packages", lambda text: text + 'echo "$* ${DEBIAN:-own}" >>"$INSTALLED"\n')
        self.stub("abidw", PROGRAMS["abidw"].replace("$ABI", "of ${DEBIAN:-own}"))
        for release, dumped in ("bookworm", "own"), ("trixie", "bookworm"):
            system.write_text(f"VERSION_CODENAME={release}\n")
            with unittest.mock.patch.dict(os.environ, INSTALLED=str(self.dir / release)):
                self.made("0.1.0")
            with tarfile.open(self.repository / "build/releases/0.1.0/latvox-0.1.0.abi.tar.gz") as dump:
                self.assertEqual(dump.extractfile("./liblatvox.abi").read().decode(), f"of {dumped}\n")
            self.assertIn(f"release {dumped}\n", (self.dir / release).read_text())

    def test_a_dry_run_goes_on_and_tells_what_it_would_refuse(self):
        self.replace("CMakeLists.txt", "CXX)", "CXX )")
        done = self.release("0.2.0", "--dry-run")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr.count("release: refused: "), 3)
        self.assertIn("Dry run: a release would be refused, for 3 reasons", done.stdout)
        self.assertTrue((self.repository / "build/releases/0.2.0/SHA256SUMS").exists())


class Packages(unittest.TestCase):
    """The groups of deploy/packages that deploy/release installs, against what its programs import and run."""

    MODULES = {"google": "python3-protobuf"}
    PROGRAMS = {"doxygen": "doxygen", "protoc": "protobuf-compiler"}

    def installed(self):
        groups = re.search(r"^  release\) groups='(.*)' ;;$", (ROOT / "deploy/install-packages").read_text(), re.M)[1]
        rows = [line.split() for line in (ROOT / "deploy/packages").read_text().splitlines() if line and line[0] != "#"]
        return {row[1] for row in rows if re.search(groups, row[0])}

    def test_a_release_installs_a_builder_of_images(self):
        builders = re.search(r"^  for program in (docker podman buildah); do$", (ROOT / "deploy/release").read_text(), re.M)[1]
        self.assertTrue(self.installed() & set(builders.split()))

    def test_a_release_installs_all_that_the_documentation_needs(self):
        folder = ROOT / "client/docs"
        scripts = [path for path in folder.iterdir() if path.is_file() and (path.suffix == ".py" or path.read_bytes().startswith(b"#!/usr/bin/python3"))]
        self.assertLessEqual({folder / "build", folder / "proto_reference"}, set(scripts))
        imported = set()
        for node in (node for script in scripts for node in ast.walk(ast.parse(script.read_text()))):
            if isinstance(node, ast.Import):
                imported |= {name.name.partition(".")[0] for name in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module.partition(".")[0])
        foreign = imported - sys.stdlib_module_names - {path.stem for path in scripts}
        run = set(re.findall(r'\brun\("([\w-]+)"', (folder / "build").read_text()))
        self.assertEqual(run, self.PROGRAMS.keys())
        self.assertIn("google", foreign)
        self.assertLessEqual({self.MODULES[name] for name in foreign} | set(self.PROGRAMS.values()), self.installed())


if __name__ == "__main__":
    unittest.main()
