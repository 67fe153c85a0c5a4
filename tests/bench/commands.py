"""Commands and files that the scripts of this folder time.

    Run(command)                    runs a command to its end
    write_plainly(source, target)   writes the bytes of a file again
"""

import os
import subprocess
import sys
import time

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
