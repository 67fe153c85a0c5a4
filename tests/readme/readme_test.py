"""The examples of README.md: each ```sh block runs as it stands, in order, in one directory, by bash -e; ```cpp compiles."""

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


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", (ROOT / "README.md").read_text(), re.M | re.S)


def own_network():
    """What to put before a command so that it has a loopback of its own: the server's port in the examples is one that
    other tests' connections may take. Nothing, where that cannot be made."""
    prefix = ["unshare", "--net", "sh", "-c", 'ip link set lo up && exec "$@"', "sh"]
    with contextlib.suppress(FileNotFoundError):
        if subprocess.run([*prefix, "true"], stderr=subprocess.DEVNULL).returncode == 0:
            return prefix
    return []


class Examples(unittest.TestCase):
    def test_shell_examples_run(self):
        examples = blocks("sh")
        self.assertGreater(len(examples), 1, "the examples were not found")
        network = own_network()
        environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}"}
        with tempfile.TemporaryDirectory(prefix="latvox-readme-") as directory:
            for example in examples:
                with self.subTest(example), tempfile.TemporaryFile("w+") as output:
                    shell = subprocess.Popen(
                        [*network, "bash", "-euo", "pipefail", "-c", example],
                        cwd=directory,
                        env=environment,
                        stdout=output,
                        stderr=output,
                        start_new_session=True,
                    )
                    try:
                        shell.wait(timeout=120)
                    finally:
                        with contextlib.suppress(ProcessLookupError):
                            os.killpg(shell.pid, signal.SIGKILL)  # what the example left running
                    output.seek(0)
                    self.assertEqual(shell.returncode, 0, output.read())

    def test_cpp_examples_compile(self):
        for example in blocks("cpp"):
            command = ["g++", "-std=c++20", "-Wall", "-fsyntax-only", f"-I{ROOT}", "-xc++", "-"]
            done = subprocess.run(command, input=example, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_files_that_are_named_exist(self):
        text = (ROOT / "README.md").read_text()
        named = re.findall(r"`((?:proto|server|client|core|deploy|tests)/[\w./-]*)`|\]\(([^)#:]+)\)", text)
        missing = [name for pair in named for name in pair if name and not (ROOT / name).exists()]
        self.assertEqual(missing, [])


if __name__ == "__main__":
    unittest.main()
