"""Progress and colours are for terminals; pipes get plain lines."""

import os
import pty
import re
import select
import subprocess
import unittest

from harness import BIN, BUNNY, PATIENCE, Case, latvox


def on_terminal(*words, **environment):
    """The exit status, and what a terminal gets on standard error."""
    master, slave = pty.openpty()
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
        except OSError:  # nobody has the other end any more
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
        # What is left in the line that progress is drawn over: nothing.
        self.assertEqual(re.split(r"\r\x1b\[K|\n", text)[-1], "")
        self.assertNotIn("\n\x1b", text)

    def test_a_pipe_sees_one_plain_line(self):
        done = latvox("voxelize", BUNNY, "-o", self.dir / "a.vdb", "--resolution", 100)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"\Alatvox: no --server given, started a private .*\n\Z")
        self.assertNotIn("\x1b", done.stdout + done.stderr)

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
