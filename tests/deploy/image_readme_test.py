"""The commands of deploy/README.md under "Image" and "Compose" run as they stand, one after the other, with podman in the
place of docker: a folder on $PATH has a `docker` that is podman, podman-compose or buildah."""

import os
import re
import unittest

import containers
from compose_test import Stack
from containers import ROOT, podman, run
from harness import BUNNY, latvox

# The base image is ours; podman-compose 1.0.3 neither builds on it nor knows profiles, so that services are named.
DOCKER = """#!/bin/sh
set -e
command=$1
shift
case "$command" in
  build) cd "{root}"; exec buildah bud --isolation=chroot --layers --pull-never --format=docker --timestamp=0 --build-arg=BASE={base} "$@" ;;
  compose)
    case "$*" in *" up "*) exec podman-compose --file deploy/compose.yaml up --no-build --detach haproxy prometheus ;; esac
    exec podman-compose "$@" ;;
  *) exec podman "$command" "$@" ;;
esac
"""


def blocks(section):
    text = (ROOT / "deploy/README.md").read_text()
    body = re.search(rf"^## {section}\n(.*?)(?=^## |\Z)", text, re.M | re.S)[1]
    return re.findall(r"^```bash\n(.*?)^```$", body, re.M | re.S)


class Readme(Stack):
    def setUp(self):
        super().setUp()
        self.addCleanup(self.remove_all)
        (self.dir / "deploy").symlink_to(ROOT / "deploy")
        programs = self.dir / "programs"
        programs.mkdir()
        (programs / "docker").write_text(DOCKER.format(root=ROOT, base=containers.BASE))
        (programs / "docker").chmod(0o755)
        git = run("git", "-C", ROOT, "rev-parse", "--absolute-git-dir").stdout.strip()
        self.environment |= {"PATH": f"{programs}:{os.environ['PATH']}", "GIT_DIR": git}

    def remove_all(self):
        podman("rm", "--force", "--all", "--time", "0", "--volumes")
        podman("network", "prune", "--force")

    def do(self, commands):
        return run(*self.inside, "bash", "-euo", "pipefail", "-c", commands, cwd=self.dir, env=self.environment, timeout=600).stdout

    def test_the_image(self):
        (self.dir / "mesh.obj").write_bytes(BUNNY.read_bytes())
        found = blocks("Image")
        self.assertEqual(len(found), 2)
        for commands in found:
            output = self.do(commands)
        self.assertIn("memory budget", output.replace("_", " "))
        self.assertEqual(latvox("info", self.dir / "mesh.vdb").returncode, 0)

    def test_compose(self):
        found = blocks("Compose")
        self.assertEqual(len(found), 2)
        for commands in found:
            self.do(commands)
        self.assertEqual(latvox("info", self.dir / "job/mesh.vdb").returncode, 0)
        self.assertGreater(len((self.dir / "job/mesh.csv").read_text().splitlines()), 1000)


if __name__ == "__main__":
    containers.require("podman-compose")
    unittest.main()
