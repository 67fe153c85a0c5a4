"""Commands and files that the scripts of this folder time.

    Run(command)                    runs a command to its end
    dragon()                        returns the path of the dragon's mesh
    binary_ply(source)              returns the path of the same PLY, in binary
    Bench(programs).ask(words)      measures by a process that stays
    write_plainly(source, target)   writes the bytes of a file again
"""

import json
import os
import pathlib
import struct
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
BLOCK = 1 << 20


class Run:
    """A finished child: milliseconds from its start to its end, milliseconds on the processor with its own children, its
    peak of memory in MB, and its output."""

    def __init__(self, command):
        begin = time.monotonic()
        process = subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.output, errors = process.stdout.read(), process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.milliseconds, self.peak = 1e3 * (time.monotonic() - begin), usage.ru_maxrss / 1024
        self.core = 1e3 * (usage.ru_utime + usage.ru_stime)
        if process.returncode != 0:
            sys.exit(errors)


def dragon():
    """Fetches the mesh at the first call on this machine. None if that fails, as it does without a network."""
    folder = HERE.parents[1] / "build/bench"
    folder.mkdir(parents=True, exist_ok=True)
    fetched = subprocess.run([HERE / "fetch-dragon", folder], stdout=sys.stderr, check=False)
    return folder / "dragon.ply" if fetched.returncode == 0 else None


def binary_ply(source):
    """Writes a text PLY of triangles, once, as scanners write it: little-endian, with three floats for each vertex."""
    target = source.with_suffix(".binary.ply")
    if target.exists():
        return target
    unfinished = target.with_suffix(".part")
    with open(source, encoding="ascii") as text, open(unfinished, "wb") as file:
        counts = {}
        for words in map(str.split, text):
            if words[0] == "end_header":
                break
            if words[0] == "element":
                counts[words[1]] = int(words[2])
        head = ["ply", "format binary_little_endian 1.0", f"element vertex {counts['vertex']}"]
        head += [f"property float {axis}" for axis in "xyz"]
        head += [f"element face {counts['face']}", "property list uchar int vertex_indices", "end_header", ""]
        file.write("\n".join(head).encode())
        for _ in range(counts["vertex"]):
            file.write(struct.pack("<3f", *map(float, next(text).split()[:3])))
        for _ in range(counts["face"]):
            file.write(struct.pack("<B3i", *map(int, next(text).split()[:4])))
    unfinished.rename(target)
    return target


class Bench:
    """latvox_bench as a process that keeps its mesh between measurements."""

    def __init__(self, programs):
        self.process = subprocess.Popen([programs / "latvox_bench", "-"], stdin=-1, stdout=-1, text=True, bufsize=1)

    def ask(self, words):
        """Returns the fields of `latvox_bench --json`, or only `error`."""
        print(*words, file=self.process.stdin)
        answer = self.process.stdout.readline()
        if not answer:
            sys.exit(f"latvox_bench ended at: {' '.join(map(str, words))}")
        return json.loads(answer)

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def write_plainly(source, target):
    """Returns the milliseconds of a copy, whose source the system has in memory. This process keeps no more than a
    block, because the peak of a child counts what its parent holds."""
    begin = time.monotonic()
    with open(source, "rb") as bytes_of, open(target, "wb") as file:
        while block := bytes_of.read(BLOCK):
            file.write(block)
        file.flush()
        os.fsync(file.fileno())
    target.unlink()
    return 1e3 * (time.monotonic() - begin)
