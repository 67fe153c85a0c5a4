"""Runs the examples of README.md and of the pages in client/docs and server/docs as they stand. The page of the command
line is generated and shows usage only; e2e/manual_test.py checks it.

The ```sh blocks of a page run in order, by bash -e, in one shell and one directory. That shell must print each line of the
page's ```text blocks. The ```cpp blocks must compile.
"""

import contextlib
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ["LATVOX_BIN"])
README = ROOT / "README.md"
GENERATED = ROOT / "client/docs/command-line.md"
PATIENCE = 300  # seconds for a page; a page takes a tenth of it on two idle cores
PAGES = [README, *sorted([*ROOT.glob("client/docs/*.md"), *ROOT.glob("server/docs/*.md")])]


def blocks(language, page):
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.M | re.S)


def without_times(text):
    """Returns the text without the seconds that each run takes."""
    return re.sub(r"\bin [0-9.]+ s\b", "in T s", text)


def own_network():
    """Returns a prefix that gives a command its own loopback, because connections of other tests may take the ports of
    the examples. Returns nothing where no network namespace can be made."""
    prefix = ["unshare", "--net", "sh", "-c", 'ip link set lo up && exec "$@"', "sh"]
    with contextlib.suppress(FileNotFoundError):
        if subprocess.run([*prefix, "true"], stderr=subprocess.DEVNULL).returncode == 0:
            return prefix
    return []


class Examples(unittest.TestCase):
    def run_in(self, directory, script):
        """Returns what the script prints."""
        environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}", "PS4": "+ ${SECONDS} s: "}
        with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as trace:
            shell = subprocess.Popen(
                [*own_network(), "bash", "-euo", "pipefail", "-c", f"BASH_XTRACEFD={trace.fileno()}; set -x\n{script}"],
                cwd=directory,
                env=environment,
                stdout=output,
                stderr=output,
                pass_fds=[trace.fileno()],
                start_new_session=True,
            )
            try:
                shell.wait(timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                pass  # the assertion below says which command did not end
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(shell.pid, signal.SIGKILL)  # ends what the script left running
                shell.wait()
            output.seek(0)
            trace.seek(0)
            printed = output.read()
            self.assertEqual(shell.returncode, 0, f"{printed}\nThe last commands:\n{trace.read()[-2000:]}")
        return printed

    def test_pages_run_and_print_what_they_show(self):
        self.assertGreater(len(blocks("sh", README)), 1, "the examples of README.md were not found")
        shown = 0
        for page in PAGES:
            if page == GENERATED:
                continue
            name = str(page.relative_to(ROOT))
            with self.subTest(name), tempfile.TemporaryDirectory(prefix="latvox-page-") as directory:
                printed = self.run_in(directory, "".join(blocks("sh", page)))
                printed = without_times(printed)
                for line in "".join(blocks("text", page)).splitlines():
                    self.assertIn(without_times(line), printed)
                    shown += 1
        self.assertGreater(shown, 15, "the pages were not found")

    def test_cpp_examples_compile(self):
        for page in PAGES:
            for example in blocks("cpp", page):
                command = ["g++", "-std=c++20", "-Wall", "-fsyntax-only", f"-I{ROOT}/client/include", "-xc++", "-"]
                done = subprocess.run(command, input=example, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)

    def test_scripts_refuse_other_arguments_with_their_usage(self):
        for script in ("deploy/quickstart", "deploy/scale/measure", "client/docs/draw", "deploy/gateway/install"):
            with self.subTest(script):
                done = subprocess.run([ROOT / script, "--help", "me", "now"], capture_output=True, text=True)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertRegex(done.stderr, f"(?i)usage: .*{pathlib.Path(script).name}")

    def test_files_that_are_named_exist(self):
        missing = []
        for page in PAGES:
            text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.M | re.S)
            named = re.findall(r"`((?:proto|server|client|core|deploy|tests)/[\w./-]*)`", text)
            linked = re.findall(r"\]\(([^)#:]+)(?:#[\w-]*)?\)", text)
            missing += [name for name in named if not (ROOT / name).exists()]
            missing += [name for name in linked if not (page.parent / name).exists()]
        self.assertEqual(missing, [])


if __name__ == "__main__":
    unittest.main()
