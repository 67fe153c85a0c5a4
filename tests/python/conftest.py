"""The package of $LATVOX_BUILD_DIR, meshes, and the tool to compare with."""

import json
import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "client/python"
sys.path[:0] = [str(PACKAGE), str(ROOT / "tests/e2e")]

import harness  # noqa: E402
import latvox  # noqa: E402


class Tool:
    """The command line tool, as a reference."""

    def __init__(self, directory):
        self.directory = directory

    def voxelize(self, mesh, *options, out="tool.npy"):
        """Runs a job that must succeed. Returns its file and its report."""
        path = self.directory / out
        done = harness.latvox("voxelize", mesh, "-o", path, "--json", *options)
        assert done.returncode == 0, done.stderr
        return path, json.loads(done.stdout)


@pytest.fixture
def tool(tmp_path):
    return Tool(tmp_path)


@pytest.fixture(scope="session")
def server():
    """A private server that the tests share."""
    with latvox.Client() as client:
        yield client


@pytest.fixture
def run(tmp_path):
    """Starts a program of Python that imports latvox. It is killed at the end."""
    import subprocess

    started = []

    def start(program):
        environment = os.environ | {"PYTHONPATH": str(PACKAGE), "BUNNY": str(harness.BUNNY)}
        command = [sys.executable, "-B", "-c", program]
        pipe = subprocess.PIPE
        process = subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=environment, cwd=tmp_path)
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()
