"""Runs the kernels for AVX-512 on a machine that has none: in Bochs, as on a Skylake-X, under Debian's kernel.

Usage: emulate.py FOLDER_OF_PROGRAMS [TEST...]
    FOLDER_OF_PROGRAMS  where latvox_bench and the tests are, such as build/release/bin
    TEST                programs to run, too; without any, those of TESTS

Jobs of latvox_bench must give there, voxel by voxel, what plain C++ gives here. All of it takes some ten minutes: an
emulated core is a hundred times slower. The status is 1 where something differs or fails.

A Skylake-X has no VBMI2. Bochs has processors that do, but version 2.7 takes VPCOMPRESSW of 32 lanes, all selected, for
one of none, and with it the lists of tiny triangles are wrong.
"""

import json
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import threading

TESTS = ("core_row_spans_test", "core_kernel_test")
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
    *(f"{mesh} {resolution} {lattice}" for mesh, resolutions in MESHES for resolution in resolutions for lattice in LATTICES),
    *(f"{BUNNY} 256 {options}" for options in ("--no-minimal", "--fill solid", "--cover supercover")),
]
ONCE = "--warmups 0 --reps 1 --threads 1 --json"

FOLDER = pathlib.Path("build/avx512")

INIT = """#!/bin/busybox sh
busybox mount -t devtmpfs dev /dev
busybox mount -t proc proc /proc
exec >/dev/ttyS0 2>&1
# The dynamic linker saves registers in ways that the kernel was told to leave alone.
export LD_BIND_NOW=1
/programs/latvox_bench - </jobs
for test in {tests}; do
  /programs/$test --gtest_color=no --gtest_brief=1
  echo "$test ended with $?"
done
echo All done
busybox sleep 5  # what it wrote is on its way
busybox poweroff -f
"""

# Linux does not believe what Bochs says of the sizes of compact XSAVE areas, and would do without AVX.
BOOT = """default linux
prompt 0
timeout 0
label linux
  kernel /vmlinuz
  append initrd=/initrd.gz console=ttyS0 loglevel=4 mitigations=off clearcpuid=xsaves,xsavec,pku,ospke
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


def fetch_kernel():
    """Debian's newest kernel for virtual machines, unpacked instead of installed."""
    found = sorted(FOLDER.glob("kernel/boot/vmlinuz-*"))
    if not found:
        package = re.search(r"Depends: (linux-image-\S+)", run("apt-cache", "depends", "linux-image-cloud-amd64"))[1]
        run("apt-get", "download", package, cwd=FOLDER)
        run("dpkg-deb", "-x", str(next(FOLDER.glob(f"{package}_*.deb"))), str(FOLDER / "kernel"))
        found = sorted(FOLDER.glob("kernel/boot/vmlinuz-*"))
    return found[-1]


def copy_into(root, path, to=None):
    target = root / (to or path.lstrip("/"))
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(path, target)


def make_root(root, programs, tests):
    """Files of the emulated machine: the programs and what they load and read."""
    shutil.rmtree(root, ignore_errors=True)
    for folder in ("dev", "proc"):
        (root / folder).mkdir(parents=True)
    copy_into(root, "/bin/busybox")
    for name in ("latvox_bench", *tests):
        copy_into(root, programs / name, f"programs/{name}")
        run("strip", str(root / "programs" / name))
        for library in re.findall(r"(/\S+) \(0x", run("ldd", str(programs / name))):
            copy_into(root, library)
    for mesh in (BUNNY, HORSE):
        copy_into(root, mesh)
    (root / "jobs").write_text("".join(f"{job} {ONCE} --simd avx512\n" for job in JOBS))
    (root / "init").write_text(INIT.format(tests=" ".join(tests)))
    (root / "init").chmod(0o755)


def make_disk(root, kernel):
    disk = FOLDER / "disk"
    (disk / "isolinux").mkdir(parents=True, exist_ok=True)
    shutil.copy(kernel, disk / "vmlinuz")
    for file in ("/usr/lib/ISOLINUX/isolinux.bin", "/usr/lib/syslinux/modules/bios/ldlinux.c32"):
        shutil.copy(file, disk / "isolinux")
    (disk / "isolinux" / "isolinux.cfg").write_text(BOOT)
    archive = f"cd {root} && find . | busybox cpio -o -H newc | gzip -1"
    with open(disk / "initrd.gz", "wb") as to:
        subprocess.run(["sh", "-c", archive], check=True, stdout=to, stderr=subprocess.DEVNULL)
    run("xorriso", "-as", "mkisofs", "-o", str(FOLDER / "boot.iso"), "-b", "isolinux/isolinux.bin", "-c", "isolinux/boot.cat",
        "-no-emul-boot", "-boot-load-size", "4", "-boot-info-table", str(disk))  # fmt: skip


def drain(terminal):
    with open(terminal, "rb", buffering=0) as screen:
        try:
            while screen.read(1 << 16):
                pass
        except OSError:
            pass  # it is gone


def emulate():
    """Returns what the emulated machine wrote to its serial line, until it switched itself off."""
    (FOLDER / "bochsrc").write_text(BOCHS)
    (FOLDER / "debugger").write_text("continue\nquit\n")  # Debian's Bochs begins in its debugger
    serial = FOLDER / "serial"
    serial.unlink(missing_ok=True)
    here, there = pty.openpty()  # its debugger's terminal
    command = ["bochs", "-q", "-f", "bochsrc", "-rc", "debugger"]
    environment = {**os.environ, "TERM": "xterm"}
    with subprocess.Popen(command, cwd=FOLDER, stdin=there, stdout=there, stderr=there, env=environment) as bochs:
        os.close(there)
        try:
            with open(FOLDER / "terminal", "wb", buffering=0) as terminal:
                while data := os.read(here, 1 << 16):
                    terminal.write(data)
                    # It stops when nobody looks at its screen.
                    if screen := re.search(rb'connected to screen "(.*?)"', data):
                        threading.Thread(target=drain, args=screen.groups(), daemon=True).start()
        except OSError:
            pass  # it is gone
        finally:
            bochs.kill()
            os.close(here)
    return serial.read_text(errors="replace") if serial.exists() else ""


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    programs, tests = pathlib.Path(sys.argv[1]), sys.argv[2:] or TESTS
    FOLDER.mkdir(parents=True, exist_ok=True)
    jobs = "".join(f"{job} {ONCE} --simd scalar\n" for job in JOBS)
    wanted = [json.loads(line) for line in run(programs / "latvox_bench", "-", input=jobs).splitlines()]
    make_root(FOLDER / "root", programs, tests)
    make_disk(FOLDER / "root", fetch_kernel())
    print(f"Emulating; what it prints goes to {FOLDER / 'serial'}", flush=True)
    output = emulate()
    found = [json.loads(job) for job in re.findall(r'\{"voxels".*?\}', output)]
    failed = [test for test in tests if f"{test} ended with 0" not in output]
    differ = [job for job, one, other in zip(JOBS, wanted, found) if one["digest"] != other["digest"]]
    differ += [job for job, other in zip(JOBS, found) if other["simd"] != "avx512"] + JOBS[len(found) :]
    for name in failed + differ:
        print(f"failed: {name}")
    print(f"{len(JOBS) - len(differ)} of {len(JOBS)} jobs as by plain C++, {len(tests) - len(failed)} of {len(tests)} tests pass")
    return 1 if failed or differ or "All done" not in output else 0


if __name__ == "__main__":
    sys.exit(main())
