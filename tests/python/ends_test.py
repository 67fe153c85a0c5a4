"""Programs that end while their daemon threads call latvox: with status 0, at once, and without a server left."""

import concurrent.futures
import os
import pathlib
import subprocess
import sys

import harness
import pytest
from conftest import PACKAGE

PROGRAM = """
import atexit, os, sys, threading, time
BUNNY = os.environ["BUNNY"]
LONG = {{"resolution": 6000, "verify": True}}  # some seconds

class Path:
    def __fspath__(self):
        time.sleep(0.1)
        return f"{{threading.get_ident()}}.csv"

def forever(_):
    while True:
        time.sleep(0.001)

{before}

def work():
    {work}

sys.setswitchinterval(1e-6)  # a thread that runs Python code is interrupted there
for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
time.sleep({sleep})
"""

START = "import latvox"
WARM = START + "; latvox.voxelize(BUNNY, resolution=9)"
VOXELS = START + "; v = latvox.voxelize(BUNNY, resolution=500)"
# Runs after latvox's own, because that is younger. Meanwhile threads go on.
LATE = "atexit.register(time.sleep, 0.05); "
AGAIN = "try: latvox.voxelize(BUNNY, resolution=9)\n        except latvox.Cancelled: pass"

# What each daemon thread does, after what, how often the program runs, and the longest time before its end.
CASES = {
    "a client starts": (START, "latvox.voxelize(BUNNY, **LONG)", 10, 1),
    "a call": (WARM, "latvox.voxelize(BUNNY, **LONG)", 10, 0.3),
    "save": (VOXELS, "while True: v.save(f'{threading.get_ident()}.npz')", 10, 0.3),
    "arrays": (VOXELS, "while True: latvox.Grid(v._voxels).ijk, v.dense()", 2, 0.2),
    "calls after the end of work": (LATE + WARM, f"while True:\n        {AGAIN}", 4, 0.2),
    "a path of the caller": (WARM, "latvox.voxelize(BUNNY, resolution=9, out=Path())", 2, 0.05),
    "convert": (VOXELS + "; v.save('v.vdb')", "latvox.convert('v.vdb', f'{threading.get_ident()}.csv')", 2, 0.1),
    "a stream": (WARM, "for batch in latvox.stream(BUNNY, **LONG): pass", 2, 0.3),
    "progress that does not return": (WARM, "latvox.voxelize(BUNNY, **LONG, progress=forever)", 2, 0.3),
    "progress that returns": (WARM, "latvox.voxelize(BUNNY, **LONG, progress=lambda _: time.sleep(0.001))", 2, 0.3),
}


def run(directory, mark, before, work, sleep):
    """Runs the program. Returns its exit status and its errors."""
    environment = os.environ | {"PYTHONPATH": str(PACKAGE), "BUNNY": str(harness.BUNNY), "LATVOX_TEST_MARK": mark}
    program = PROGRAM.format(before=before, work=work, sleep=sleep)
    done = subprocess.run(
        [sys.executable, "-B", "-c", program], env=environment, cwd=directory, capture_output=True, text=True, timeout=60
    )
    return done.returncode, done.stderr


def servers_with(mark):
    """Returns the ids of the processes that such programs have started, and that go on."""
    found = []
    for environment in pathlib.Path("/proc").glob("[0-9]*/environ"):
        try:
            if f"LATVOX_TEST_MARK={mark}\0".encode() in environment.read_bytes():
                found.append(environment.parent.name)
        except OSError:
            continue
    return found


@pytest.mark.parametrize("case", CASES)
def test_a_program_ends_in_spite_of_its_daemon_threads(case, tmp_path):
    before, work, times, longest = CASES[case]
    mark = str(tmp_path)
    sleeps = [longest * (n + 1) / times for n in range(times)]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        ends = list(pool.map(lambda sleep: run(tmp_path, mark, before, work, sleep), sleeps))
    assert [end[0] for end in ends if end[0] != 0] == []
    assert not any("terminate" in error for _, error in ends)
    harness.await_true("a server goes on", lambda: not servers_with(mark))
