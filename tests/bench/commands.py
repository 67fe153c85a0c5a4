"""Commands and files that the scripts of this folder time.

    Run(command)                    runs a command to its end
    dragon()                        returns the path of the dragon's mesh
    Bench(programs).ask(words)      measures by a process that stays
    write_plainly(source, target)   writes the bytes of a file again
"""

import json
import os
import pathlib
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
