"""The package installs by pip, without a network, and needs nothing of the build folder then."""

import os
import shutil
import subprocess
import sys

import latvox
from conftest import ROOT
from harness import BUNNY


def test_pip_installs_the_package(tmp_path):
    source, target = tmp_path / "source", tmp_path / "target"
    shutil.copytree(ROOT / "client/python", source / "client/python")
    shutil.copy(ROOT / "CMakeLists.txt", source)
    options = ["--no-build-isolation", "--no-index", "--no-deps", "--target", target]
    command = [sys.executable, "-m", "pip", "install", source / "client/python", *options]
    installed = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"})
    assert installed.returncode == 0, installed.stdout + installed.stderr
    program = (
        "import latvox, sys; v = latvox.voxelize(sys.argv[1], resolution=9); v.save('a.vdb');"
        "print(latvox.__version__, latvox.__file__, v.digest)"
    )
    environment = {"PYTHONPATH": str(target), "PATH": "/usr/bin"}
    run = [sys.executable, "-B", "-c", program, BUNNY]
    done = subprocess.run(run, capture_output=True, text=True, cwd=tmp_path, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr
    version, file, digest = done.stdout.split()
    assert (version, digest) == (latvox.__version__, latvox.voxelize(BUNNY, resolution=9).digest)
    assert file == str(target / "latvox/__init__.py") and (target / "latvox/py.typed").exists()
    files = sorted(path.name for path in (target / "latvox/bin").iterdir() if not path.is_symlink())
    assert files == ["latvox", "latvox-vdb.so", "latvoxd"]
