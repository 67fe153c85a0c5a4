"""Compiles each file of core's kernels for ARM, with the flags of this build and gcc's cross compiler (Debian's package
g++-aarch64-linux-gnu). `tests/run --arm` also runs them. Without the compiler the test is skipped, with status 77."""

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
LIBRARIES = ("absl", "boost", "hwy", "oneapi", "tbb", "xxhash.h")  # host headers that work on any processor


def kernels():
    """Returns the files of core that Highway compiles for several instruction sets, with their commands."""
    for entry in json.loads(COMMANDS.read_text()):
        file = pathlib.Path(entry["file"])
        if file.is_relative_to(REPOSITORY / "core") and "hwy/foreach_target.h" in file.read_text():
            yield file, shlex.split(entry["command"])


def compile_for_arm(compiler, headers, file, command):
    kept = [word for word in command if re.match(r"-(D|W|f|std=|I)", word)]
    # As core/CMakeLists.txt sets for ARM, but unoptimized: half of the time, and the same errors.
    words = [compiler, *kept, "-march=armv8-a+crypto", "-O0", "-isystem", headers, "-c", file, "-o", os.devnull]
    return file, subprocess.run(words, capture_output=True, text=True)


def main():
    compiler = next(filter(shutil.which, COMPILERS), None)
    if not compiler:
        print(f"skipped: none of {', '.join(COMPILERS)} is here")
        return 77
    with tempfile.TemporaryDirectory() as headers, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name in LIBRARIES:
            pathlib.Path(headers, name).symlink_to(f"/usr/include/{name}")
        done = list(pool.map(lambda kernel: compile_for_arm(compiler, headers, *kernel), kernels()))
    failed = [(file, run.stderr) for file, run in done if run.returncode != 0]
    for file, errors in failed:
        print(f"{file}:\n{errors}")
    print(f"{len(done) - len(failed)} of {len(done)} files compile")
    return 0 if done and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
