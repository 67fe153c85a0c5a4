"""Runs the commands of deploy/docs/image.md and compose.md as they stand, one after the other, with podman in place of
docker. A folder on $PATH has a `docker` that calls podman, podman-compose or buildah."""

import os
import re
import unittest

import containers
from compose_test import Stack
from containers import ROOT, podman, run
from harness import latvox

# The base image is ours. podman-compose 1.0.3 neither builds on it nor knows profiles, so the page has a command of its
# own for its `up`.
DOCKER = """#!/bin/sh
set -e
command=$1
shift
case "$command" in
  build) cd "{root}"; exec buildah bud --isolation=chroot --layers --pull-never --format=docker --timestamp=0 --build-arg=BASE={base} "$@" ;;
  compose)
    case "$*" in *" up "*) exec {up} ;; esac
    exec podman-compose "$@" ;;
  *) exec podman "$command" "$@" ;;
esac
"""


def page(name):
    return (ROOT / "deploy/docs" / name).read_text()


def blocks(name):
    return re.findall(r"^```bash\n(.*?)^```$", page(name), re.M | re.S)


class Readme(Stack):
    def setUp(self):
        super().setUp()
        self.addCleanup(self.remove_all)
        (self.dir / "deploy").symlink_to(ROOT / "deploy")
        programs = self.dir / "programs"
        programs.mkdir()
        up = re.search(r"`(podman-compose \S+ \S+ up [^`]+)`", page("compose.md"))[1]
        (programs / "docker").write_text(DOCKER.format(root=ROOT, base=containers.BASE, up=up))
        (programs / "docker").chmod(0o755)
        git = run("git", "-C", ROOT, "rev-parse", "--absolute-git-dir").stdout.strip()
        self.environment |= {"PATH": f"{programs}:{os.environ['PATH']}", "GIT_DIR": git}

    def remove_all(self):
        podman("rm", "--force", "--all", "--time", "0", "--volumes")
        podman("network", "prune", "--force")

    def do(self, commands):
        return run(*self.inside, "bash", "-euo", "pipefail", "-c", commands, cwd=self.dir, env=self.environment, timeout=600).stdout

    def test_the_image_and_then_compose(self):
        """In the order in which a reader runs them."""
        image, compose = blocks("image.md"), blocks("compose.md")
        self.assertEqual((len(image), len(compose)), (2, 2))
        for commands in image:
            output = self.do(commands)
        self.assertIn("memory budget", output.replace("_", " "))
        self.assertEqual(latvox("info", self.dir / "mesh.vdb").returncode, 0)
        for commands in compose:
            self.do(commands)
        self.assertEqual(latvox("info", self.dir / "job/mesh.vdb").returncode, 0)
        self.assertGreater(len((self.dir / "job/mesh.csv").read_text().splitlines()), 1000)


if __name__ == "__main__":
    containers.require("podman-compose")
    unittest.main()
