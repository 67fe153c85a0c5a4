"""The Debian packages of build/arm64/packages: judged, then installed, used and purged on an emulated 64-bit ARM machine
with Debian's own kernel, where decoders confine themselves as on a real one. Then the image that is built from them runs
there, with the rights of a container. Digests must be those of the programs of $LATVOX_BIN. `tests/run --arm` makes the
packages first."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import unittest

os.environ["LATVOX_ARCHITECTURE"] = "arm64"  # of the packages that these tests judge
REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "tests/deploy"))

import containers  # noqa: E402
import debian_root  # noqa: E402
import packages_test  # noqa: E402
from debian_root import run  # noqa: E402
from packages_test import BUNNY, THEIRS, Packages  # noqa: E402, F401: their tests are these tests, too

ROOT = REPOSITORY / "build/arm64/machine"
WORK = REPOSITORY / "build/arm64/boot"
IMAGE = "localhost/latvox-arm64"
INSTALLED = ("latvox", "latvoxd", "python3-latvox")
NEEDED = ("?essential", "glmark2-data", "iproute2", "linux-image-cloud-arm64", "mount")
NEEDLESS = ("boot", "usr/lib/modules", "usr/share/doc", "usr/share/locale", "usr/share/man")
SECONDS = 1800  # until an emulated machine counts as hung

OCTAHEDRON = """v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1
f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6
"""

# Few and small, because an emulated core is slow: Draco's decoder would exceed its time with the bunny.
JOBS = (
    f"{BUNNY} --resolution 64",
    f"{BUNNY} --resolution 64 --lattice bcc",
    f"{BUNNY} --resolution 48 --lattice hexagonal --set solid",
    f"{BUNNY} --resolution 32 --set supercover --fields triangle,normal",
    f"{BUNNY} --resolution 32 --set band --band 3v --fields distance",
    "octahedron.obj --resolution 48 --lattice fcc --separability 1 --upload draco",
)
SERVER = "--server 127.0.0.1:50151"
IMAGE_JOBS = (f"{JOBS[1]} -o bunny.h5", f"{JOBS[-1]} {SERVER}")  # the first one loads all that is loaded late

INIT = f"""#!/bin/bash
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root
# numpy finds its libraries by links, which packages make when they are configured. These are not.
export LD_LIBRARY_PATH=/usr/lib/aarch64-linux-gnu/blas:/usr/lib/aarch64-linux-gnu/lapack
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs dev /dev
ip link set lo up
exec </dev/null >/dev/console 2>&1
cd /work

job() {{
  echo "Job $1"
  $inside latvox voxelize "${{@:2}}" -o "$1.vdb" --json 2>/tmp/errors || cat /tmp/errors
}}
# Fails if the last process in the background ends first.
await() {{
  until "$@"; do
    kill -0 $! || return
    sleep 1
  done
}}
files() {{
  find / -xdev -path /run -prune -o -path /tmp -prune -o -path /work -prune -o -print | sort
}}

files >/tmp/before
dpkg --install /packages/*.deb && dpkg --verify {" ".join(INSTALLED)} && echo Installed
job private {JOBS[0]}
latvox info private.vdb
latvoxd --config /etc/latvox/latvoxd.toml 2>log &
await latvox health {SERVER}
{{calls}}
echo Job python
python3 -c "import latvox; v = latvox.voxelize('{BUNNY}', resolution=64); print(len(v), v.digest)"
kill $!
wait $! && echo Served
cat log
dpkg --purge {" ".join(INSTALLED)} && echo Purged
files | comm -3 /tmp/before - | sed 's/^\t*/Changed /'

# As `docker run --read-only --tmpfs /tmp --cap-drop=all --security-opt=no-new-privileges` with a volume.
mount --bind /image /image
for each in tmp data; do mount -t tmpfs -o mode=1777 $each /image/$each; done
mkdir -p /image/proc /image/dev
mount -t proc proc /image/proc
mount --bind /dev /image/dev
cp {BUNNY} octahedron.obj /image/data
mount -o remount,bind,ro /image
unset LD_LIBRARY_PATH
inside="setpriv --no-new-privs unshare --root=/image --wd={{folder}} --setgid={{user}} --setuid={{user}}"
$inside {{entrypoint}} --insecure >log 2>&1 &
await $inside {{health}} && echo Healthy
{{image_calls}}
kill $!
wait $! && echo Stopped
cat log
echo o >/proc/sysrq-trigger
sleep 60
"""


def make_root():
    """Unpacks what the packages depend on, unless it is there."""
    depends = ",".join(packages_test.fields(name)["Depends"] for name in INSTALLED)
    names = {word.split()[0] for word in depends.split(",")} - set(INSTALLED)
    wanted = "\n".join(sorted(names) + list(NEEDED))
    kept = ROOT / "unpacked"
    if debian_root.is_recent(kept) and kept.read_text() == wanted:
        return
    debian_root.require_programs("arm", "mmdebstrap")
    run(REPOSITORY / "deploy/packaging/arm64/unpack", ROOT, *wanted.split(), timeout=1800)
    for name in "passwd", "group":
        shutil.copy(ROOT / f"usr/share/base-passwd/{name}.master", ROOT / f"etc/{name}")
    (kernel,) = ROOT.glob("boot/vmlinuz-*")
    shutil.copy(kernel, ROOT / "vmlinuz")
    for folder in NEEDLESS:
        shutil.rmtree(ROOT / folder)
    kept.write_text(wanted)


def make_image():
    """Builds the image, and unpacks it as an engine does. Returns its description."""
    containers.configure()
    run(REPOSITORY / "deploy/packaging/arm64/image", timeout=600)
    run("buildah", "bud", "--isolation=chroot", "--format=docker", "--platform=linux/arm64", "--tag", IMAGE,
        REPOSITORY / "build/arm64/image", timeout=600)  # fmt: skip
    archive, folder = WORK / "image.tar", ROOT / "image"
    archive.unlink(missing_ok=True)
    run("buildah", "push", IMAGE, f"docker-archive:{archive}", timeout=600)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    with tarfile.open(archive) as files:
        (manifest,) = json.load(files.extractfile("manifest.json"))
        for layer in manifest["Layers"]:
            with tarfile.open(fileobj=files.extractfile(layer)) as content:
                content.extractall(folder, numeric_owner=True)
        return json.load(files.extractfile(manifest["Config"]))


def make_disk(image):
    """Writes the memory disk that the machine starts from: the root, the packages, the image, and what it is to do."""
    shutil.rmtree(ROOT / "packages", ignore_errors=True)
    (ROOT / "packages").mkdir()
    for name in INSTALLED:
        shutil.copy(packages_test.package(name), ROOT / "packages")
    config = image["config"]
    script = INIT
    for name, text in {
        "calls": "\n".join(f"job {n} {options} {SERVER}" for n, options in enumerate(JOBS)),
        "image_calls": "\n".join(f"job image{n} {options.replace(BUNNY, 'bunny.obj')}" for n, options in enumerate(IMAGE_JOBS)),
        "user": config["User"].split(":")[0],
        "folder": config["WorkingDir"],
        "entrypoint": " ".join(config["Entrypoint"]),
        "health": " ".join(config["Healthcheck"]["Test"][1:]),
    }.items():
        script = script.replace(f"{{{name}}}", text)
    (ROOT / "init").write_text(script)
    (ROOT / "init").chmod(0o755)
    for folder in ROOT / "work", WORK:
        folder.mkdir(exist_ok=True)
        (folder / "octahedron.obj").write_text(OCTAHEDRON)
    pack = 'set -o pipefail; find . -print0 | cpio --null --create --format=newc --quiet >"$0"'
    run("bash", "-c", pack, WORK / "disk", cwd=ROOT, timeout=600)


def emulate():
    """Runs the machine until it switches itself off, and returns what it wrote to its console."""
    command = ["qemu-system-aarch64", "-machine", "virt", "-cpu", "cortex-a72", "-smp", "2", "-m", "4G", "-nic", "none",
               "-kernel", ROOT / "vmlinuz", "-initrd", WORK / "disk", "-append", "console=ttyAMA0 loglevel=3 panic=-1",
               "-nographic", "-no-reboot"]  # fmt: skip
    console = WORK / "console"
    print(f"Emulating; what the machine prints goes to {console}", flush=True)
    with open(console, "wb") as out:
        subprocess.run(command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT, timeout=SECONDS, check=True)
    return console.read_text(errors="replace").replace("\r", "")


def summary_here(options):
    words = options.removesuffix(SERVER).split()
    done = run(f"{os.environ['LATVOX_BIN']}/latvox", "voxelize", *words, "-o", "here.vdb", "--json", cwd=WORK)
    return json.loads(done.stdout)


class Machine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        make_root()
        cls.image = make_image()
        make_disk(cls.image)
        cls.console = emulate()

    def find(self, pattern):
        found = re.search(pattern, self.console, re.M | re.S)
        self.assertTrue(found, f"{WORK}/console has no {pattern}")
        return found

    def summary_there(self, job):
        """Returns the JSON that a job printed."""
        return json.loads(self.find(rf"^Job {job}\n(\{{.*?^\}})$")[1])

    def assert_equal_voxels(self, job, options):
        here, there = summary_here(options), self.summary_there(job)
        for key in ("voxels", "digest", "fields") if "--fields" in options else ("voxels", "digest"):
            self.assertEqual(there[key], here[key], key)

    def test_packages_install(self):
        self.find("^Installed$")

    def test_a_private_server_gives_the_digests_of_this_machine(self):
        self.assert_equal_voxels("private", JOBS[0])

    def test_a_server_gives_the_digests_of_this_machine(self):
        for number, options in enumerate(JOBS):
            with self.subTest(options):
                self.assert_equal_voxels(number, options)

    def test_python_gives_the_digest_of_this_machine(self):
        here = summary_here(JOBS[0])
        self.assertEqual(self.find(r"^Job python\n(\d+ \w+)$")[1], f"{here['voxels']} {here['digest']}")

    def test_the_server_warns_of_nothing_and_ends_well(self):
        self.find("^Served$")
        self.find("^Stopped$")
        self.assertEqual(re.findall(r".*level=(?:warning|error|critical).*", self.console), [])

    def test_nothing_is_left_of_the_packages(self):
        self.find("^Purged$")
        changed = re.findall(r"^Changed (.*)$", self.console, re.M)
        self.assertTrue(changed, "not even dpkg's own files")
        self.assertEqual([path for path in changed if not re.match(THEIRS, path)], [])
        self.assertEqual([path for path in changed if "latvox" in path], [])

    def test_the_image_is_one_for_arm(self):
        self.assertEqual((self.image["architecture"], self.image["os"]), ("arm64", "linux"))
        self.assertEqual(self.image["config"]["User"], "65532:65532")
        programs = {path.name for path in (ROOT / "image/usr/bin").iterdir()}
        self.assertEqual(programs, {"latvox", "latvoxd"})
        self.assertEqual((ROOT / "image/data").stat().st_uid, 65532)
        materials = json.loads((ROOT / "image/usr/share/doc/latvox/sbom.spdx.json").read_text())
        urls = [each["externalRefs"][0]["referenceLocator"] for each in materials["packages"]]
        for library in "libopenvdb", "libgrpc%2B%2B", "libhdf5", "libcurl4":
            self.assertTrue([url for url in urls if re.match(rf"pkg:deb/debian/{re.escape(library)}\S*\?arch=arm64$", url)], library)

    def test_the_image_gives_the_digests_of_this_machine(self):
        self.find("^Healthy$")
        for number, options in enumerate(IMAGE_JOBS):
            with self.subTest(options):
                self.assert_equal_voxels(f"image{number}", options)


def prepare():
    debian_root.require_programs("arm", "qemu-system-aarch64", "buildah", "cpio", "lintian")
    if not list(packages_test.PACKAGES.glob("*.deb")):
        debian_root.skip("there are no packages: deploy/packaging/build arm64 makes them")


if __name__ == "__main__":
    prepare()
    unittest.main()
