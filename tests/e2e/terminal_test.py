"""Progress and colors are for terminals. Pipes get plain lines."""

import fcntl
import math
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time
import unittest

from harness import BIN, BUNNY, PATIENCE, Case, latvox, server

BAR = re.compile(r"\[(#*)\.*\] +(\d+) %  voxelizing: (\d+) bricks(?:, (\d+)/s)?(?:, (?:(\d+)m)?(\d+)s left)?")


class Pauses:
    """Stops the server for a while when the bar moves, the first few times. The first stop is long enough to show a
    rate."""

    def __init__(self, process):
        self.process, self.frames = process, 0

    def __call__(self, text):
        frames = text.count(" bricks")
        if frames == self.frames or self.frames > 8:
            return
        self.process.send_signal(signal.SIGSTOP)
        time.sleep(0.15 if self.frames else 0.8)
        self.process.send_signal(signal.SIGCONT)
        self.frames = frames


def on_terminal(*words, see=lambda text: None, columns=120, **environment):
    """Returns the exit status, and the standard error on a terminal. Calls `see` with all of it as it
    grows."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("4H", 24, columns, 0, 0))
    command = [BIN / "latvox", *map(str, words)]
    environment = os.environ | {"TERM": "xterm"} | environment
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=slave, env=environment)
    os.close(slave)
    text = b""
    while True:
        if not select.select([master], [], [], PATIENCE)[0]:
            process.kill()
        try:
            text += os.read(master, 65536)
            see(text.decode(errors="replace"))
        except OSError:  # the other end is closed
            break
    os.close(master)
    return process.wait(PATIENCE), text.decode()


class Terminal(Case):
    def test_a_terminal_sees_stages_a_bar_and_nothing_in_the_end(self):
        code, text = on_terminal("voxelize", BUNNY, "-o", self.dir / "a.vdb", "--resolution", 300, "--threads", 1)
        self.assertEqual(code, 0, text)
        for stage in (f"reading {BUNNY}", "encoding 69666 triangles", "connecting", "voxelizing: ", "writing "):
            self.assertIn(stage, text)
        self.assertRegex(text, r"\[.*\] +\d+ %  voxelizing: \d+ bricks")
        self.assertIn("\x1b[32m#", text.replace("\x1b[32m\x1b", ""))
        # Nothing is left of the line that shows progress.
        self.assertEqual(re.split(r"\r\x1b\[K|\n", text)[-1], "")
        self.assertNotIn("\n\x1b", text)

    def test_the_bar_tells_rate_and_remaining_time(self):
        with server(self.dir, "--threads", "1") as process:
            words = "voxelize", BUNNY, "-o", self.dir / "a.vdb", "--resolution", 2500, "--encoding", "masks"
            start = time.monotonic()
            code, text = on_terminal(*words, "--server", process.address, see=Pauses(process))
            whole = time.monotonic() - start
        self.assertEqual(code, 0, text)
        frames = BAR.findall(re.sub(r"\x1b\[[\d;]*[mK]", "", text))
        told = [frame for frame in frames if frame[3]]
        self.assertTrue(told and any(frame[5] for frame in told), frames)
        for bar, percent, bricks, rate, minutes, seconds in told:
            elapsed = int(bricks) / int(rate)
            self.assertTrue(0.5 <= elapsed * 1.001 and elapsed * 0.999 <= whole, (elapsed, whole))
            low, high = max(int(percent) - 0.5, 0) / 100, min(int(percent) + 0.5, 100) / 100
            self.assertTrue(math.floor(30 * low) <= len(bar) <= math.floor(30 * high), (bar, percent))
            if seconds:
                left = 60 * int(minutes or 0) + int(seconds)
                most = math.ceil(elapsed * 1.001 * (1 - low) / low)
                self.assertTrue(math.ceil(elapsed * 0.999 * (1 - high) / high) <= left <= most, (left, elapsed, percent))
            else:
                self.assertLessEqual(int(percent), 1, "no remaining time is told")

    def test_a_pipe_sees_the_summary_alone(self):
        done = latvox("voxelize", BUNNY, "-o", self.dir / "a.vdb", "--resolution", 100)
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stderr, "")
        self.assertNotIn("\x1b", done.stdout)

    def test_quiet_shows_neither_summary_nor_bar(self):
        code, text = on_terminal("voxelize", BUNNY, "-q", "-o", self.dir / "a.vdb", "--resolution", 300, "--threads", 1)
        self.assertEqual((code, text), (0, ""))
        done = latvox("voxelize", BUNNY, "--quiet", "-o", self.dir / "a.vdb", "--resolution", 50)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertEqual(latvox("compare", "-q", self.dir / "a.vdb", self.dir / "a.vdb").stdout, "")

    def test_a_narrow_terminal_still_has_a_bar(self):
        code, text = on_terminal("voxelize", BUNNY, "-o", self.dir / "a.vdb", "--resolution", 300, "--threads", 1, columns=44)
        self.assertEqual(code, 0, text)
        plain = re.sub(r"\x1b\[[\d;]*[mK]", "", text)
        self.assertRegex(plain, r"\[[#.]{4,}\] +\d+ %")
        self.assertLess(max(map(len, re.split(r"[\r\n]", plain))), 44)

    def test_a_reader_that_has_seen_enough_ends_the_tool_quietly(self):
        for words in (["completions", "bash"], ["voxelize", BUNNY, "--res", "200", "-q", "-o", "-", "--output-format", "csv"]):
            with self.subTest(words[0]):
                process = subprocess.Popen([BIN / "latvox", *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                process.stdout.close()
                with process.stderr as errors:
                    self.assertEqual(errors.read(), b"")
                self.assertEqual(process.wait(PATIENCE), 0)

    def test_errors_are_red_on_terminals_that_want_it(self):
        red = "\x1b[31mlatvox:\x1b[0m "
        words = "voxelize", self.dir / "none.obj", "-o", self.dir / "a.vdb", "--resolution", 9
        code, text = on_terminal(*words)
        self.assertEqual(code, 3)
        self.assertIn(red, text)
        self.assertIn(red, on_terminal(*words, NO_COLOR="")[1])
        self.assertNotIn("\x1b[31m", on_terminal(*words, NO_COLOR="1")[1])
        self.assertNotIn("\x1b", on_terminal(*words, TERM="dumb")[1])
        self.assertNotIn("\x1b", latvox(*words).stderr)


if __name__ == "__main__":
    unittest.main()
