"""Runs the AVX-512 kernels on a machine without AVX-512: on a Skylake-X in Bochs, under Debian's kernel.

Usage: emulate.py FOLDER_OF_PROGRAMS [TEST...]
    FOLDER_OF_PROGRAMS  the folder of latvox_bench and the tests, such as build/release/bin
    TEST                tests to run, with arguments if needed, such as 'core_tiny_test --gtest_filter=*Kernel'; default:
                        those of TESTS

JOBS of latvox_bench must have the digests that plain C++ has here. All of it takes a quarter of an hour, because an
emulated core is a hundred times slower. It needs the packages of `deploy/install-packages emulate`. The status is 1 if
something differs or fails, and 2 if the test cannot run.

A Skylake-X has no VBMI2. Bochs has processors with VBMI2, but version 2.7 treats VPCOMPRESSW of 32 lanes, all selected,
as one of no lanes. That makes the lists of tiny triangles wrong.
"""

import itertools
import json
import os
import pathlib
import pty
import re
import shlex
import shutil
import subprocess
import sys
import threading

TESTS = (
    "core_row_spans_test",
    "core_kernel_test",
    "core_tiny_cover_test",
    "core_candidates_test --gtest_filter=*LatticePoints*:*AllSizes*",
)
BUNNY = "/usr/share/glmark2/models/bunny.obj"
HORSE = "/usr/share/glmark2/models/horse.3ds"
LATTICES = (
    *(f"--lattice cartesian --separability {k}" for k in (0, 1, 2)),
    *(f"--lattice fcc --separability {k}" for k in (0, 2)),
    "--lattice bcc",
    "--lattice hexagonal",
)
MESHES = ((BUNNY, (40, 128, 256, 512, 1024)), (HORSE, (128, 512)), ("box", (64, 300)), ("sphere:30000", (128, 256)))
JOBS = [
    *(f"{mesh} {side} {lattice}" for mesh, sides in MESHES for side, lattice in itertools.product(sides, LATTICES)),
    *(f"{BUNNY} 256 {options}" for options in ("--no-minimal", "--set solid", "--set supercover")),
    *(f"{BUNNY} 128 {options}" for options in ("--set enclosed", "--set links", "--fields triangle,normal")),
    *(f"sphere:30000 {side} --set supercover" for side in (64, 128)),
]
ONCE = "--warmups 0 --reps 1 --threads 1 --json"
RESULT = re.compile(r'^\{"(?:voxels|error)".*\}', re.MULTILINE)

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "build/avx512"
SECONDS = 2 * 3600  # until an emulated machine counts as hung

INIT = """#!/bin/busybox sh
busybox mount -t devtmpfs dev /dev
busybox mount -t proc proc /proc
exec >/dev/ttyS0 2>&1
# The dynamic linker saves registers in ways that the kernel was told to leave alone.
export LD_BIND_NOW=1
/programs/latvox_bench - </jobs
{tests}
echo All done
busybox sleep 5  # what it wrote is on its way
busybox poweroff -f
"""
TEST = "/programs/{command} --gtest_color=no --gtest_brief=1\necho Test {number} ended with $?\n"

# Linux distrusts the sizes that Bochs reports for compact XSAVE areas, and would disable AVX.
BOOT = """default linux
prompt 0
timeout 0
label linux
  kernel /vmlinuz
  append initrd=/initrd.gz console=ttyS0 loglevel=3 mitigations=off clearcpuid=xsaves,xsavec,pku,ospke
"""

BOCHS = """display_library: term
megs: 2048
romimage: file=/usr/share/bochs/BIOS-bochs-latest
vgaromimage: file=/usr/share/vgabios/vgabios.bin
cpu: model=corei7_skylake_x, ips=50000000
ata0: enabled=1, ioaddr1=0x1f0, ioaddr2=0x3f0, irq=14
ata0-master: type=cdrom, path=boot.iso, status=inserted
boot: cdrom
com1: enabled=1, mode=file, dev=serial
log: log
"""


def run(*words, **options):
    return subprocess.run(words, check=True, capture_output=True, text=True, **options).stdout


def fetch(package):
    """Unpacks one of Debian's packages, and returns its folder. Installing it would change this machine."""
    folder = FOLDER / package
    if not folder.exists():
        aside = FOLDER / "unpacked"
        shutil.rmtree(aside, ignore_errors=True)
        run("apt-get", "download", package, cwd=FOLDER)
        run("dpkg-deb", "-x", max(FOLDER.glob(f"{package}_*.deb"), key=os.path.getmtime), aside)
        aside.rename(folder)
    return folder


def fetch_kernel():
    """Returns the kernel for virtual machines."""
    package = re.search(r"Depends: (linux-image-\S+)", run("apt-cache", "depends", "linux-image-cloud-amd64"))[1]
    return next(fetch(package).glob("boot/vmlinuz-*"))


def copy_into(root, path, to=None):
    target = root / (to or path.lstrip("/"))
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(path, target)


def make_root(root, programs, tests):
    """Writes the files of the emulated machine: the programs and the files that they load and read."""
    shutil.rmtree(root, ignore_errors=True)
    for folder in ("dev", "proc"):
        (root / folder).mkdir(parents=True)
    copy_into(root, fetch("busybox-static") / "bin/busybox", "bin/busybox")
    for name in ("latvox_bench", *(shlex.split(test)[0] for test in tests)):
        copy_into(root, programs / name, f"programs/{name}")
        run("strip", root / "programs" / name)
        for library in re.findall(r"(/\S+) \(0x", run("ldd", programs / name)):
            copy_into(root, library)
    for mesh in (BUNNY, HORSE):
        copy_into(root, mesh)
    (root / "jobs").write_text("".join(f"{job} {ONCE} --simd avx512\n" for job in JOBS))
    run_tests = "".join(
        TEST.format(command=shlex.join(shlex.split(test)), number=number) for number, test in enumerate(tests)
    )
    (root / "init").write_text(INIT.format(tests=run_tests))
    (root / "init").chmod(0o755)


def make_disk(root, kernel):
    disk = FOLDER / "disk"
    (disk / "isolinux").mkdir(parents=True, exist_ok=True)
    shutil.copy(kernel, disk / "vmlinuz")
    for file in ("/usr/lib/ISOLINUX/isolinux.bin", "/usr/lib/syslinux/modules/bios/ldlinux.c32"):
        shutil.copy(file, disk / "isolinux")
    (disk / "isolinux" / "isolinux.cfg").write_text(BOOT)
    archive = "set -o pipefail; find . | bin/busybox cpio -o -H newc | gzip -1 >../disk/initrd.gz"
    run("bash", "-c", archive, cwd=root)
    run("xorriso", "-as", "mkisofs", "-o", FOLDER / "boot.iso", "-b", "isolinux/isolinux.bin", "-c", "isolinux/boot.cat",
        "-no-emul-boot", "-boot-load-size", "4", "-boot-info-table", disk)  # fmt: skip


def read_all(terminal, to):
    """Reads until the program at the other end is gone."""
    try:
        while data := os.read(terminal, 1 << 16):
            to(data)
    except OSError:
        pass


def emulate():
    """Runs the emulated machine until it switches itself off, and returns what it wrote to its serial line."""
    (FOLDER / "bochsrc").write_text(BOCHS)
    (FOLDER / "debugger").write_text("continue\nquit\n")  # Debian's Bochs starts in its debugger
    serial = FOLDER / "serial"
    serial.unlink(missing_ok=True)
    print(f"Emulating; what it prints goes to {serial}", flush=True)
    here, there = pty.openpty()  # the debugger's terminal
    said, screens = bytearray(), []

    def listen(data):
        said.extend(data)
        # Bochs stops if nobody reads its screen.
        if not screens and (found := re.search(rb'connected to screen "(.*?)"', said)):
            screens.append(os.open(found[1], os.O_RDONLY | os.O_NOCTTY))
            threading.Thread(target=read_all, args=(screens[0], lambda data: None), daemon=True).start()

    command = ["setpriv", "--pdeathsig", "KILL", "bochs", "-q", "-f", "bochsrc", "-rc", "debugger"]
    environment = {**os.environ, "TERM": "xterm"}
    with subprocess.Popen(command, cwd=FOLDER, stdin=there, stdout=there, stderr=there, env=environment) as bochs:
        os.close(there)
        deadline = threading.Timer(SECONDS, bochs.kill)
        deadline.start()
        try:
            read_all(here, listen)
        finally:
            deadline.cancel()
            bochs.kill()
            os.close(here)
    if not serial.exists():
        raise OSError(f"Bochs ended at once: {said.decode(errors='replace')}")
    return serial.read_text(errors="replace")


def outcome(line):
    """Returns the facts about a job that are compared: digest and kernels."""
    try:
        result = json.loads(line)
    except ValueError:  # a kernel message interrupted the line
        result = {}
    return result.get("digest"), result.get("simd")


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    programs, tests = pathlib.Path(sys.argv[1]), sys.argv[2:] or TESTS
    try:
        FOLDER.mkdir(parents=True, exist_ok=True)
        jobs = "".join(f"{job} {ONCE} --simd scalar\n" for job in JOBS)
        wanted = RESULT.findall(run(programs / "latvox_bench", "-", input=jobs))
        make_root(FOLDER / "root", programs, tests)
        make_disk(FOLDER / "root", fetch_kernel())
        output = emulate()
    except subprocess.CalledProcessError as error:
        print(f"emulate.py: {shlex.join(map(str, error.cmd))}: {error.stderr}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"emulate.py: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    failed = [test for number, test in enumerate(tests) if f"Test {number} ended with 0" not in output]
    differ = [
        job
        for job, here, there in itertools.zip_longest(JOBS, wanted, RESULT.findall(output), fillvalue="{}")
        if (outcome(here)[0], "avx512") != outcome(there)
    ]
    for name in failed + differ:
        print(f"failed: {name}")
    if "All done" not in output:
        print("failed: the emulated machine stopped before it was done")
    print(f"{len(JOBS) - len(differ)} of {len(JOBS)} jobs as by plain C++,", end=" ")
    print(f"{len(tests) - len(failed)} of {len(tests)} tests pass")
    return 1 if failed or differ or "All done" not in output else 0


if __name__ == "__main__":
    sys.exit(main())
