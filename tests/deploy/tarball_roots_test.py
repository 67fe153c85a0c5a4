"""The tarball of build/packages in fresh systems that have nothing but their base: Debian 12, 13 and unstable, and Ubuntu
24.04 if its mirror answers. `tests/run --packages` makes it first. LATVOX_DEBIAN, if set, is the release of the tarball in
build/RELEASE/packages."""

import os
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

import debian_root
from debian_root import ROOT, STATE, Root, harness

PACKAGES = ROOT / "build" / os.environ.get("LATVOX_DEBIAN", "") / "packages"
FOREIGN = "noble"
RELEASES = ["bookworm", FOREIGN, "trixie", "sid"]  # each has a newer glibc than the one before
RELEASES = RELEASES[RELEASES.index(debian_root.RELEASE) :]
MODEL = "/usr/share/glmark2/models"
PLACE = "/opt/a b/ü"
START = f"export PATH='{PLACE}'/latvox/bin:$PATH; cd /tmp; "


def tarballs():
    return list(PACKAGES.glob("latvox-*-linux-*.tar.gz"))


class FreshSystems(unittest.TestCase):
    def each(self, use):
        (tarball,) = tarballs()
        for release in RELEASES:
            with self.subTest(release), tempfile.TemporaryDirectory(prefix="root-", dir=STATE / "work") as directory:
                root = Root(pathlib.Path(directory) / "debian", base(release))
                shutil.copy(tarball, root.path / "latvox.tar.gz")
                # The system's own tar and gzip are enough.
                root.shell(f"mkdir -p '{PLACE}/latvox'; tar xzf /latvox.tar.gz --strip-components=1 -C '{PLACE}/latvox'")
                (root.path / MODEL[1:]).mkdir(parents=True)
                shutil.copy(harness.BUNNY, root.path / MODEL[1:])
                use(root)

    def test_the_first_command_of_the_readme_and_the_server(self):
        self.each(lambda root: (self.nothing_is_missing(root), self.it_voxelizes(root), self.it_serves(root)))

    def nothing_is_missing(self, root):
        told = root.shell(f"cd '{PLACE}'/latvox; ldd bin/*").stdout
        self.assertNotIn("not found", told)
        self.assertIn(f"{PLACE}/latvox/bin/../lib", told)

    def it_voxelizes(self, root):
        block = re.search(r"^## Three commands$.*?^```sh\n(.*?)^```", (ROOT / "README.md").read_text(), re.M | re.S)[1]
        self.assertIn("-o bunny.vdb", block)
        for script in block + " latvox info bunny.vdb", f"latvox voxelize {MODEL}/bunny.obj --lattice bcc -o a.h5; latvox info a.h5":
            self.assertIn("172367", root.shell(START + script).stdout.replace(",", ""))

    def it_serves(self, root):
        script = f"""latvoxd --listen unix:/tmp/socket 2>log &
        until latvox health --server unix:/tmp/socket >/dev/null; do sleep 0.1; done
        latvox voxelize {MODEL}/bunny.obj --lattice bcc --server unix:/tmp/socket --upload draco -o a.csv
        kill %1; wait %1"""
        root.shell(START + script)
        log = (root.path / "tmp/log").read_text()
        self.assertIn("event=stopping reason=SIGTERM", log)
        self.assertNotIn("no_guard", log)


def base(release):
    return debian_root.archive(STATE / f"{release}-base.tar", release=release, skips=release != FOREIGN)


def prepare():
    """Makes the systems, because a test of unittest could not skip the run."""
    (STATE / "work").mkdir(parents=True, exist_ok=True)
    for release in list(RELEASES):
        try:
            base(release)
        except debian_root.Unreachable as error:
            print(f"NOT CHECKED: {error}", file=sys.stderr)
            RELEASES.remove(release)


if __name__ == "__main__":
    debian_root.require_programs("package", "mmdebstrap", "unshare")
    if not tarballs():
        debian_root.skip("there is no tarball: deploy/packaging/tarball makes it")
    prepare()
    unittest.main()
