"""If a server dies in the middle, the user loses time and gets one line on standard error."""

import re
import signal
import subprocess
import time
import unittest

import harness
from harness import BIN, BUNNY, Case, latvox

LONG = ["--lattice", "bcc", "--resolution", "6000"]
SLOW = ["--simd", "scalar", "--threads", "1"]  # seconds of work on any machine


class Resume(Case):
    def setUp(self):
        super().setUp()
        self.dirs = [self.dir / name for name in ("first", "second")]
        for directory in self.dirs:
            directory.mkdir()
        self.addresses = [f"unix:{directory}/latvoxd.socket" for directory in self.dirs]

    def start(self, *options):
        """Starts a long run on both servers."""
        command = [BIN / "latvox", "voxelize", BUNNY, "-o", self.dir / "out.png", *LONG, "--json"]
        client = subprocess.Popen(
            [*map(str, command), "--server", ",".join(self.addresses), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(client.stdout.close)
        self.addCleanup(client.stderr.close)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        return client

    def test_another_server_goes_on(self):
        with harness.server(self.dirs[0], *SLOW, mortal=True) as first:
            client = self.start()
            time.sleep(1)  # into the stream; the second server must not run yet when the call begins
            with harness.server(self.dirs[1]):
                self.assertIsNone(client.poll(), "the long run has ended already")
                first.send_signal(signal.SIGKILL)
                out, err = client.communicate(timeout=harness.PATIENCE)
                self.assertEqual(client.returncode, 0, err)
                lines = err.splitlines()
                self.assertEqual(len(lines), 1, err)
                self.assertRegex(
                    lines[0],
                    r"^latvox: connection lost, resumed after tile -?\d+,-?\d+,-?\d+ on " + re.escape(self.addresses[1]) + "$",
                )
                undisturbed = latvox("voxelize", BUNNY, "-o", self.dir / "same.png", *LONG, "--json", "--server", self.addresses[1])
        self.assertEqual(undisturbed.returncode, 0, undisturbed.stderr)
        resumed, whole = (harness.json.loads(text) for text in (out, undisturbed.stdout))
        self.assertEqual((resumed["resumed"], whole["resumed"]), (1, 0))
        for key in ("digest", "voxels", "bricks", "tiles", "basis", "certificate", "mesh"):
            self.assertEqual(resumed[key], whole[key], key)
        self.assertEqual((self.dir / "out.png").read_bytes(), (self.dir / "same.png").read_bytes())

    def test_without_another_server_it_gives_up_and_says_so(self):
        with harness.server(self.dirs[0], *SLOW, mortal=True) as first:
            client = self.start("--retries", "1")
            time.sleep(1)
            first.send_signal(signal.SIGKILL)
            err = client.communicate(timeout=harness.PATIENCE)[1]
        self.assertEqual(client.returncode, 4, err)
        self.assertRegex(err, r"^latvox: .*tries\)\n$")
        self.assertFalse((self.dir / "out.png").exists())

    def test_the_timeout_covers_all_tries(self):
        with harness.server(self.dirs[0], *SLOW, mortal=True) as first:
            started = time.monotonic()
            client = self.start("--retries", "1000", "--timeout", "3")
            time.sleep(1)
            first.send_signal(signal.SIGKILL)
            err = client.communicate(timeout=harness.PATIENCE)[1]
        self.assertEqual(client.returncode, 6, err)
        self.assertRegex(err, "deadline")
        self.assertLess(time.monotonic() - started, 5)


if __name__ == "__main__":
    unittest.main()
