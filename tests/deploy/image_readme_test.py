"""The commands of deploy/README.md under "Image" and "Compose" run as they stand, one after the other, with podman in the
place of docker: a folder on $PATH has a `docker` that is podman, podman-compose or buildah."""

import os
import re
import unittest

import containers
from compose_test import Stack
from containers import ROOT, podman, run
from harness import latvox

# The base image is ours; podman-compose 1.0.3 neither builds on it nor knows profiles: for its `up` the page has words of
# its own.
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


PAGE = (ROOT / "deploy/README.md").read_text()


def blocks(section):
    body = re.search(rf"^## {section}\n(.*?)(?=^## |\Z)", PAGE, re.M | re.S)[1]
    return re.findall(r"^```bash\n(.*?)^```$", body, re.M | re.S)


class Readme(Stack):
    def setUp(self):
        super().setUp()
        self.addCleanup(self.remove_all)
        (self.dir / "deploy").symlink_to(ROOT / "deploy")
        programs = self.dir / "programs"
        programs.mkdir()
        (programs / "docker").write_text(DOCKER.format(root=ROOT, base=containers.BASE, up=re.search(r"`(podman-compose \S+ \S+ up [^`]+)`", PAGE)[1]))
        (programs / "docker").chmod(0o755)
        git = run("git", "-C", ROOT, "rev-parse", "--absolute-git-dir").stdout.strip()
        self.environment |= {"PATH": f"{programs}:{os.environ['PATH']}", "GIT_DIR": git}

    def remove_all(self):
        podman("rm", "--force", "--all", "--time", "0", "--volumes")
        podman("network", "prune", "--force")

    def do(self, commands):
        return run(*self.inside, "bash", "-euo", "pipefail", "-c", commands, cwd=self.dir, env=self.environment, timeout=600).stdout

    def test_the_image_and_then_compose(self):
        """One after the other, as one who reads on does it."""
        image, compose = blocks("Image"), blocks("Compose")
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
