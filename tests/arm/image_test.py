"""deploy/packaging/arm64/image in a small tree, with a package of two lines and one library. `tests/run --arm` builds and
runs the image itself: machine_test.py."""

import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
KEPT = ("deploy/packaging/arm64/image", "deploy/Dockerfile", "deploy/latvoxd.toml", "LICENSE")
FILES = {
    "build/arm64/root/lib/aarch64-linux-gnu/libsmall.so.1": "a library",
    "build/arm64/root/lib/aarch64-linux-gnu/liblate.so.1": "a library that is loaded late",
    "build/arm64/root/usr/share/doc/small/copyright": "its license",
    "build/arm64/root/usr/share/ca-certificates/mozilla/one.crt": "a certificate\n",
    "build/arm64/root/usr/share/ca-certificates/mozilla/two.crt": "another one\n",
    "build/arm64/root/var/lib/dpkg/status": "Package: small\nStatus: install ok installed\nArchitecture: arm64\nVersion: 1\n"
                                            "Maintainer: a <a@b.c>\nDescription: small\n",
    "build/arm64/root/var/lib/dpkg/info/small.list": "/lib/aarch64-linux-gnu/libsmall.so.1\n/lib/aarch64-linux-gnu/liblate.so.1\n",
    "build/arm64/package/DEBIAN/control": "Package: latvox\nVersion: 1\nArchitecture: arm64\nMaintainer: a <a@b.c>\nDescription: a\n",
    "build/arm64/package/usr/bin/latvox": "the tool",
    "build/arm64/package/usr/bin/latvoxd": "the server",
    "build/arm64/package/usr/lib/aarch64-linux-gnu/latvox/latvox-vdb.so": "the module",
    "build/arm64/package/usr/share/man/man1/latvox.1": "the manual, which no image has",
}  # fmt: skip
PROGRAMS = {
    "deploy/sbom": 'basename --multiple "$LATVOX_ARM64_ROOT" "$DPKG_ADMINDIR" "$@"; echo \'"licenseComments": "a; see /usr/share/doc/small/copyright"\'',
    "programs/qemu-aarch64": 'printf "\\tlibsmall.so.1 => %s (0x1)\\n\\t(0x2)\\n" "$FOUND"',
}


class Image(unittest.TestCase):
    def setUp(self):
        self.tree = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-image-")))
        for name in KEPT:
            (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(REPOSITORY / name, self.tree / name)
        for name, text in (FILES | {name: f"#!/bin/sh\n{text}\n" for name, text in PROGRAMS.items()}).items():
            (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
            (self.tree / name).write_text(text)
        for name in PROGRAMS:
            (self.tree / name).chmod(0o755)
        self.packages = self.tree / "build/arm64/packages"
        self.packages.mkdir()
        late = self.tree / "build/arm64/root/usr/lib/aarch64-linux-gnu/liblate.so.1"
        (self.packages / "late_libraries.txt").write_text(f"{late}\n")
        (self.tree / "build/arm64/root/usr/lib").symlink_to("../lib")
        subprocess.run(["dpkg-deb", "--build", self.tree / "build/arm64/package", self.packages / "latvox_1_arm64.deb"],
                       check=True, capture_output=True)  # fmt: skip

    def make(self, found="/lib/aarch64-linux-gnu/libsmall.so.1"):
        path = f"{self.tree}/programs:{os.environ['PATH']}"
        return subprocess.run([self.tree / KEPT[0]], capture_output=True, text=True, env=os.environ | {"PATH": path, "FOUND": found})

    def made(self):
        done = self.make()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return self.tree / "build/arm64/image"

    def test_it_has_the_programs_and_what_they_need(self):
        with tarfile.open(self.made() / "files.tar") as tar:
            members = {member.name: member for member in tar}
            names = {name.removeprefix("./") for name, member in members.items() if member.isfile()}
            certificates = tar.extractfile("./etc/ssl/certs/ca-certificates.crt").read()
            told = tar.extractfile("./usr/share/doc/latvox/sbom.spdx.json").read().decode().splitlines()
        texts = {name for name in names if name.startswith("usr/share/common-licenses/")}
        self.assertIn("usr/share/common-licenses/GPL-3", texts)
        self.assertEqual(names - texts, {
            "usr/bin/latvox", "usr/bin/latvoxd", "usr/lib/aarch64-linux-gnu/latvox/latvox-vdb.so",
            "lib/aarch64-linux-gnu/libsmall.so.1", "usr/lib/aarch64-linux-gnu/liblate.so.1", "usr/share/doc/small/copyright",
            "usr/share/doc/latvox/LICENSE", "usr/share/doc/latvox/sbom.spdx.json", "etc/latvox/latvoxd.toml",
            "etc/ssl/certs/ca-certificates.crt"})  # fmt: skip
        self.assertEqual(certificates, b"a certificate\nanother one\n")
        self.assertEqual(told, ["root", "dpkg", "latvoxd", "latvox", "latvox-vdb.so", "liblate.so.1",
                                '"licenseComments": "a; see /usr/share/doc/small/copyright"'])
        self.assertEqual({member.mtime for member in members.values()}, {0})
        self.assertEqual((members["./data"].uid, members["./tmp"].mode), (65532, 0o1777))
        self.assertEqual({member.uid for name, member in members.items() if name != "./data"}, {0})

    def test_the_rest_is_the_last_stage_of_the_other_image(self):
        lines = (self.made() / "Dockerfile").read_text().splitlines()
        stage = (REPOSITORY / "deploy/Dockerfile").read_text().rpartition("\nFROM scratch\n")[2].splitlines()
        self.assertEqual(lines[:2], ["FROM scratch", "ADD files.tar /"])
        differing = [pair for pair in zip(lines[2:], stage[1:], strict=True) if pair[0] != pair[1] and not pair[0].startswith("ARG BASE=")]
        self.assertEqual(differing, [])
        self.assertFalse([line for line in lines if line.startswith(("RUN", "COPY"))])

    def test_equal_packages_make_an_equal_folder(self):
        folder = self.made()
        before = [(path.name, path.read_bytes()) for path in sorted(folder.iterdir())]
        self.assertEqual([(path.name, path.read_bytes()) for path in sorted(self.made().iterdir())], before)

    def test_a_missing_library_is_named(self):
        done = self.make("not found")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("libsmall.so.1", done.stderr)

    def test_it_refuses_a_tree_without_package_and_a_strange_dockerfile(self):
        dockerfile = self.tree / "deploy/Dockerfile"
        dockerfile.write_text(dockerfile.read_text().replace("COPY --from=build", "COPY --from=other"))
        self.assertIn('deploy/Dockerfile has no line "COPY --from=build', self.make().stderr)
        next(self.packages.glob("*.deb")).unlink()
        self.assertIn("deploy/packaging/build arm64 makes it", self.make().stderr)
        shutil.rmtree(self.packages)
        self.assertIn("deploy/packaging/build arm64 makes it", self.make().stderr)


if __name__ == "__main__":
    if os.geteuid() != 0:
        print("SKIPPED: only root can make files of all owners", file=sys.stderr)
        sys.exit(77)
    unittest.main()
