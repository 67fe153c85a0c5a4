"""The image builds, is small, and is the same for the same sources. Reports the times of a build, and of one after a
change."""

import gzip
import pathlib
import re
import shutil
import tarfile
import unittest

import containers
from containers import IMAGE, ROOT, inspect, podman

LARGEST, LARGEST_TO_PULL = 70e6, 30e6  # bytes


def layers(image):
    return inspect(image)["RootFS"]["Layers"]


class ImageBuild(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cached = containers.STATE.joinpath("work", "buildah-cache").exists()
        containers.debian(containers.BASE)
        seconds = containers.build(ROOT, IMAGE)
        print(f"image: {inspect(IMAGE)['Size'] / 1e6:.1f} MB, built in {seconds:.0f} s", "with" if cached else "without", "a cache")

    def copy(self):
        """The sources, in a folder of their own."""
        folder = containers.STATE / "work" / "copy"
        shutil.rmtree(folder, ignore_errors=True)
        self.addCleanup(shutil.rmtree, folder)
        for line in (ROOT / ".dockerignore").read_text().splitlines():
            if line.startswith("!"):
                source, target = ROOT / line[1:], folder / line[1:]
                target.parent.mkdir(parents=True, exist_ok=True)
                (shutil.copytree if source.is_dir() else shutil.copy2)(source, target)
        shutil.copy2(ROOT / ".dockerignore", folder)
        shutil.copy2(ROOT / "deploy/Dockerfile", folder / "deploy")
        return folder

    def test_equal_sources_make_an_equal_layer_and_others_another(self):
        folder = self.copy()
        source = folder / "server/main.cc"
        source.write_text(source.read_text() + "// A comment is nothing that runs.\n")
        containers.build(folder, "localhost/latvox-commented")
        self.addCleanup(podman, "rmi", "localhost/latvox-commented")
        self.assertEqual(layers("localhost/latvox-commented"), layers(IMAGE))
        source.write_text(source.read_text().replace('"latvoxd: %s\\n"', '"latvoxd changed: %s\\n"'))
        seconds = containers.build(folder, "localhost/latvox-changed")
        self.addCleanup(podman, "rmi", "localhost/latvox-changed")
        print(f"image: built after a change in {seconds:.0f} s")
        self.assertNotEqual(layers("localhost/latvox-changed"), layers(IMAGE))

    def test_it_holds_what_is_needed_and_no_more(self):
        self.assertLess(inspect(IMAGE)["Size"], LARGEST)
        self.assertEqual(len(layers(IMAGE)), 1)
        tar = containers.STATE / "work" / "image.tar"
        self.addCleanup(tar.unlink)
        created = podman("create", IMAGE)
        self.addCleanup(podman, "rm", created)
        podman("export", "--output", tar, created)
        self.assertLess(len(gzip.compress(tar.read_bytes(), 6)), LARGEST_TO_PULL)
        with tarfile.open(tar) as files:
            members = {pathlib.PurePath(member.name): member for member in files if not member.name.startswith(("dev", "run"))}
        regular = [path for path, member in members.items() if member.isreg() and member.size > 0]
        others = [str(path) for path in regular if not path.match("lib*/**/*.so*") and not path.match("*/*/*.so*")]
        materials = "usr/share/doc/latvox/sbom.spdx.json"
        self.assertIn(materials, others)
        licenses = {name for name in others if name.startswith("usr/share/doc/")} - {materials}
        self.assertLessEqual({f"usr/share/doc/{name}" for name in ("latvox/LICENSE", "openvdb/copyright", "libgrpc29/copyright", "libhdf5-103-1/copyright", "libcli11-dev/copyright")}, licenses)
        self.assertEqual([name for name in licenses if not name.endswith(("/LICENSE", "/copyright"))], [])
        common = {name for name in others if name.startswith("usr/share/common-licenses/")}
        with tarfile.open(tar) as files:
            for name in licenses:
                told = files.extractfile(name).read().decode(errors="replace")
                for text in re.findall(r"/(usr/share/common-licenses/\w+(?:-[\d.]*\d)?)", told):
                    self.assertIn(pathlib.PurePath(text), members, f"{name} refers to it")
        self.assertEqual(
            sorted(name for name in others if ".so" not in name and name not in licenses | common | {materials}),
            ["etc/latvox/latvoxd.toml", "etc/ssl/certs/ca-certificates.crt", "usr/bin/latvox", "usr/bin/latvoxd"],
        )
        self.assertGreater(members[pathlib.PurePath("etc/ssl/certs/ca-certificates.crt")].size, 100_000)
        self.assertEqual([str(path) for path in regular if members[path].mode & 0o6000], [], "programs that raise privileges")
        self.assertEqual({members[path].mtime for path in regular if str(path) != "etc/hosts"}, {0})
        self.assertEqual((members[pathlib.PurePath("data")].uid, members[pathlib.PurePath("tmp")].mode & 0o7777), (65532, 0o1777))

    def test_it_says_what_it_is(self):
        # Without the cache, because buildah 1.28 reuses a step although its arguments differ.
        arguments = ["--build-arg=VERSION=1.2.3", "--build-arg=REVISION=abc"]
        containers.build(ROOT, "localhost/latvox-labelled", "--no-cache", *arguments)
        self.addCleanup(podman, "rmi", "localhost/latvox-labelled")
        labels = inspect("localhost/latvox-labelled")["Labels"]
        prefix = "org.opencontainers.image."
        for name, value in {"title": "latvox", "licenses": "Apache-2.0", "version": "1.2.3", "revision": "abc", "base.name": containers.BASE}.items():
            self.assertEqual(labels[prefix + name], value)
        config = inspect(IMAGE)["Config"]
        self.assertEqual(config["User"], "65532:65532")
        self.assertEqual(config["StopSignal"], "SIGTERM")
        self.assertEqual(config["Entrypoint"], ["/usr/bin/latvoxd", "--config", "/etc/latvox/latvoxd.toml"])
        self.assertEqual(sorted(config["ExposedPorts"]), ["50151/tcp", "50152/tcp", "9464/tcp"])
        self.assertEqual(inspect(IMAGE)["Healthcheck"]["Test"][:3], ["CMD", "/usr/bin/latvox", "health"])


if __name__ == "__main__":
    containers.require()
    unittest.main()
