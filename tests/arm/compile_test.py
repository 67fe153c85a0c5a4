"""Compiles each file of core's kernels for ARM, with the flags of this build and gcc's cross compiler (Debian's package
g++-aarch64-linux-gnu). qemu-user runs those of one file, which must do the same as plain C++; `tests/run --arm` runs
all. Without a compiler, or without an emulator for what was compiled, the status is 77."""

import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
COMMANDS = pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "compile_commands.json"
COMPILERS = ("aarch64-linux-gnu-g++", "aarch64-linux-gnu-g++-12")
RUN = REPOSITORY / "core/tile/tile_bits.cc"  # needs no library of ARM's
LIBRARIES = ("absl", "boost", "hwy", "oneapi", "tbb", "xxhash.h")  # host headers that work on any processor


def kernels():
    """Returns the files of core that Highway compiles for several instruction sets, with their commands."""
    for entry in json.loads(COMMANDS.read_text()):
        file = pathlib.Path(entry["file"])
        if file.is_relative_to(REPOSITORY / "core") and "hwy/foreach_target.h" in file.read_text():
            yield file, shlex.split(entry["command"])


def compile_for_arm(compiler, headers, file, command, *options):
    """Compiles without optimization: half of the time, and the same errors. `options` are the compiler's."""
    kept = [word for word in command if re.match(r"-(D|W|f|std=|I)", word)]
    # As core/CMakeLists.txt sets for ARM.
    words = [compiler, *kept, "-march=armv8-a+crypto", "-O0", "-isystem", headers, file, *(options or ("-c", "-o", os.devnull))]
    return file, subprocess.run(words, capture_output=True, text=True)


def run_for_arm(compiler, headers, file, command):
    """Returns the file of the kernels that run, and what compiler or emulator said."""
    program = pathlib.Path(headers, "program")
    _, compiled = compile_for_arm(compiler, headers, file, command, REPOSITORY / "tests/arm/tile_bits.cc", "-O1", "-static", "-o", program)
    if compiled.returncode != 0:
        return file, compiled
    return file, subprocess.run(["qemu-aarch64", program], capture_output=True, text=True)


def main():
    compiler = next(filter(shutil.which, COMPILERS), None)
    if not compiler:
        print(f"skipped: none of {', '.join(COMPILERS)} is here")
        return 77
    emulates = shutil.which("qemu-aarch64") is not None
    with tempfile.TemporaryDirectory() as headers, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name in LIBRARIES:
            pathlib.Path(headers, name).symlink_to(f"/usr/include/{name}")
        done = list(pool.map(lambda kernel: compile_for_arm(compiler, headers, *kernel), kernels()))
        ran = [run_for_arm(compiler, headers, *kernel) for kernel in kernels() if emulates and kernel[0] == RUN]
    failed = [(file, run) for file, run in done + ran if run.returncode != 0]
    for file, run in failed:
        print(f"{file}:\n{run.stdout}{run.stderr}")
    print(f"{len(done)} files compiled, {len(ran)} run, {len(failed)} failures:", *(run.stdout.strip() for _, run in ran))
    if failed or not done or len(ran) != emulates:
        return 1
    if emulates:
        return 0
    print("skipped: what was compiled did not run, because there is no qemu-aarch64, of Debian's package qemu-user")
    return 77


if __name__ == "__main__":
    sys.exit(main())
