"""The tarball of this build: whole in itself, and at work under a strange path. `tests/run --packages` unpacks one in fresh
systems as well: tarball_roots_test.py."""

import functools
import http.server
import json
import os
import pathlib
import re
import shutil
import socket
import tempfile
import threading
import unittest
import unittest.mock
import urllib.request

import debian_root
from debian_root import OWN_RELEASE, ROOT, harness, run

BUILD = pathlib.Path(os.environ["LATVOX_BUILD_DIR"])
SCRIPT = ROOT / "deploy/packaging/tarball"
GLIBC = {"bookworm": (2, 36), "trixie": (2, 41)}
# The libraries of glibc's own package, as far as programs and libraries here ask for them.
GLIBCS = re.compile(r"(ld-linux-[\w-]+|libc|libm|libdl|librt|libpthread|libresolv|libutil|libmvec|libanl|libnss_\w+)\.so\.\d+")


def setUpModule():
    global FOLDER
    directory = pathlib.Path(unittest.enterModuleContext(tempfile.TemporaryDirectory(prefix="latvox-tarball-")))
    FOLDER = directory / "a b/ü:$x"
    run(SCRIPT, BUILD, FOLDER)


@functools.cache
def binaries():
    """Returns path -> what readelf tells of the file."""
    files = [path for path in FOLDER.rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\x7fELF"]
    assert len(files) > 50, files
    return {path: run("readelf", "--wide", "--dynamic", "--version-info", path).stdout for path in files}


class Files(unittest.TestCase):
    def test_each_library_that_a_file_needs_is_there_or_is_of_glibc(self):
        names = {path.name for path in binaries()}
        for path, told in binaries().items():
            needed = set(re.findall(r"\(NEEDED\) +Shared library: \[(.*)\]", told))
            self.assertEqual({name for name in needed - names if not GLIBCS.fullmatch(name)}, set(), path)
        late = {pathlib.Path(line).name for line in (BUILD / "late_libraries.txt").read_text().splitlines()}
        self.assertEqual(len(late), 2)
        self.assertLessEqual(late, names)
        self.assertEqual({name for name in names if GLIBCS.fullmatch(name)}, set(), "glibc's files must be the system's")

    def test_programs_have_a_path_that_holds_for_the_libraries_of_libraries(self):
        (module,) = FOLDER.rglob("latvox-vdb.so")
        private = module.parent.relative_to(FOLDER)
        for path, told in binaries().items():
            paths = re.findall(r"\((RPATH|RUNPATH)\).*\[(.*)\]", told)
            if path.parent.name == "bin":
                self.assertEqual(paths, [("RPATH", f"$ORIGIN/../{private}")], path)
            else:  # Abseil's libraries on Debian 13 look beside themselves, where all libraries are
                self.assertIn(paths, ([], [("RUNPATH", "$ORIGIN")]), path)
        self.assertEqual({path.parent for path in binaries()}, {FOLDER / "bin", FOLDER / private})

    def test_no_file_needs_a_newer_glibc_than_the_readme_says(self):
        needed = {tuple(map(int, version.split("."))) for told in binaries().values() for version in re.findall(r"\bGLIBC_([\d.]+)", told)}
        self.assertFalse([path for path, told in binaries().items() if "GLIBC_PRIVATE" in told])
        told = re.search(r"glibc: version ([\d.]+) or later", (FOLDER / "README").read_text())[1]
        self.assertEqual(tuple(map(int, told.split("."))), max(needed))
        self.assertLessEqual(max(needed), GLIBC[OWN_RELEASE])

    def test_every_library_has_its_licenses_and_is_listed(self):
        documents = FOLDER / "share/doc/latvox"
        listed = {each["name"]: each for each in json.loads((documents / "latvox.spdx.json").read_text())["packages"]}
        debian = {name for name, each in listed.items() if each["supplier"] == "Organization: Debian"}
        texts = {path.name: path for path in (documents / "licenses").iterdir() if path.is_file()}
        self.assertEqual(debian - texts.keys(), {"libc6"})
        self.assertLessEqual({"libcurl4", "libhdf5-103-1"} if OWN_RELEASE == "bookworm" else set(), debian)
        self.assertIn("libcli11-dev", texts, "its headers are part of the programs")
        for path in texts.values():
            for name in re.findall(r"/usr/share/common-licenses/(\w+(?:-[\d.]*\d)?)", path.read_text(errors="replace")):
                self.assertTrue((documents / "licenses/common-licenses" / name).is_file(), f"{path.name}: {name}")
        self.assertIn("three.js", (documents / "copyright").read_text())
        self.assertIn("Apache License", (documents / "LICENSE").read_text())

    def test_libraries_are_unchanged(self):
        for path in binaries():
            if path.name.startswith("lib"):
                originals = [place.read_bytes() for folder in ("/lib", "/usr/lib") for place in pathlib.Path(folder).glob(f"*/{path.name}")]
                self.assertIn(path.read_bytes(), originals, path.name)

    def test_people_find_manual_and_completions_but_no_unit(self):
        for name in ("share/man/man1/latvox.1", "share/man/man8/latvoxd.8", "share/bash-completion/completions/latvox",
                     "share/zsh/site-functions/_latvox", "share/fish/vendor_completions.d/latvox.fish", "share/doc/latvox/tutorial.md"):  # fmt: skip
            self.assertTrue((FOLDER / name).is_file(), name)
        self.assertEqual({path.name for path in FOLDER.iterdir()}, {"README", "bin", "lib", "share"})
        self.assertEqual(list(FOLDER.rglob("*.service")), [])

    def test_bad_words_are_refused(self):
        for words, says in ((("nowhere",), "there is no CMakeCache.txt"), ((BUILD, FOLDER), f"FOLDER: {FOLDER} exists"),
                            ((BUILD, FOLDER, "x"), "usage: deploy/packaging/tarball")):
            done = run(SCRIPT, *words, check=False)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(says, done.stderr)


class AtWork(harness.Case):
    def environment(self):
        """The loader writes what it loads to files of self.dir, for this process and for all that it starts."""
        return {"HOME": str(self.dir), "LD_DEBUG": "libs", "LD_DEBUG_OUTPUT": str(self.dir / "loaded")}

    def assert_loaded_from_the_tarball(self, *programs):
        logs = [path.read_text() for path in self.dir.glob("loaded.*")]
        self.assertGreaterEqual(len(logs), len(programs))
        loaded = {path for log in logs for path in re.findall(r"calling init: (.*)", log)}
        self.assertEqual({path for path in loaded if not path.startswith(str(FOLDER)) and not GLIBCS.fullmatch(path.rpartition("/")[2])}, set())
        for name in programs:
            self.assertTrue([log for log in logs if f"initialize program: {FOLDER}/bin/{name}\n" in log], name)
        return {path.rpartition("/")[2] for path in loaded}

    def job(self, *words):
        return run(FOLDER / "bin/latvox", "voxelize", *words, "--resolution", "64", "--json", cwd=self.dir, env=self.environment())

    def test_files_of_all_kinds_are_those_of_the_build(self):
        shutil.copy(harness.BUNNY, self.dir / "mesh.obj")
        handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=self.dir)
        handler.func.log_message = lambda *_: None
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as store:
            threading.Thread(target=store.serve_forever, daemon=True).start()
            self.job(f"http://127.0.0.1:{store.server_port}/mesh.obj", "-o", "a.nvdb", "-o", "a.h5", "-o", "a.png")
            store.shutdown()
        loaded = self.assert_loaded_from_the_tarball("latvox", "latvoxd")
        for name in ("latvox-vdb.so", "libopenvdb", "libhdf5", "libcurl", "libstdc++"):
            self.assertTrue([path for path in loaded if path.startswith(name)], name)
        digest = self.voxelize(harness.BUNNY, "--resolution", "64")["digest"]
        for name in ("a.nvdb", "a.h5"):
            told = run(FOLDER / "bin/latvox", "info", self.dir / name, env=self.environment()).stdout
            self.assertIn(digest, told, name)

    def test_a_link_to_the_tool_works(self):
        (self.dir / "latvox").symlink_to(FOLDER / "bin/latvox")
        run(self.dir / "latvox", "voxelize", harness.BUNNY, "--resolution", "32", "-o", self.dir / "a.vdb", env=self.environment())
        self.assert_loaded_from_the_tarball("latvoxd")

    def test_the_server_has_its_guard_and_its_decoders_and_ends_in_order(self):
        options = ["--metrics-listen", "127.0.0.1:0"]
        with unittest.mock.patch.object(harness, "BIN", FOLDER / "bin"), harness.server(self.dir, *options) as server:
            metrics = harness.await_log(self.dir, r"event=metrics address=(\S+)")
            self.job(harness.BUNNY, "--server", server.address, "--upload", "draco", "-o", "a.csv")
            with socket.socket(socket.AF_UNIX) as attack:
                attack.settimeout(harness.PATIENCE)
                attack.connect(server.address.removeprefix("unix:"))
                attack.sendall(b"PRI / HTTP/1.1\r\n\r\n")  # it begins like HTTP/2
                while attack.recv(4096):
                    pass
            told = urllib.request.urlopen(f"http://{metrics}/metrics", timeout=harness.PATIENCE).read().decode()
        self.assertIn('latvox_connections_closed_total{offense="preface"} 1\n', told)
        self.assertRegex(told, r"latvox_decoder_decodes_total [1-9]")
        self.assertNotIn("no_guard", (self.dir / "latvoxd.log").read_text())


if __name__ == "__main__":
    if shutil.which("patchelf") is None:
        debian_root.skip("patchelf is not installed; deploy/install-packages package")
    unittest.main()
