"""Installs the package by the commands of client/docs/python.md, word for word, and tries it."""

import os
import re
import subprocess

import latvox
from conftest import ROOT
from harness import BUNNY

PAGE = (ROOT / "client/docs/python.md").read_text()
PROGRAM = (
    "import latvox, sys; v = latvox.voxelize(sys.argv[1], resolution=9); v.save('a.vdb');"
    "print(latvox.__version__, latvox.__file__, v.digest)"
)


def install_and_try(directory, **environment):
    """Installs into directory/env, without a network. The environment's variables count beside PATH.

    The folder client/python must stay as it was.
    """
    (commands,) = [block for block in re.findall(r"^```bash\n(.*?)^```$", PAGE, re.M | re.S) if "pip install" in block]
    (directory / "client").symlink_to(ROOT / "client")
    clean = {"PATH": "/usr/bin:/bin", "HOME": str(directory)}
    of_builds = {name: value for name, value in os.environ.items() if name.startswith(("CCACHE_", "CMAKE_"))}
    offline = {"PIP_NO_INDEX": "1", "PYTHONDONTWRITEBYTECODE": "1", **clean, **of_builds, **environment}
    files = sorted((ROOT / "client/python").rglob("*"))
    shell = ["bash", "-euo", "pipefail", "-c", commands]
    installed = subprocess.run(shell, capture_output=True, text=True, cwd=directory, env=offline)
    assert installed.returncode == 0, installed.stdout + installed.stderr
    assert installed.stdout.splitlines()[-1] == latvox.__version__
    assert sorted((ROOT / "client/python").rglob("*")) == files

    run = [directory / "env/bin/python", "-B", "-c", PROGRAM, BUNNY]
    done = subprocess.run(run, capture_output=True, text=True, cwd=directory, env=clean, timeout=60)
    assert done.returncode == 0, done.stderr
    version, file, digest = done.stdout.split()
    assert (version, digest) == (latvox.__version__, latvox.voxelize(BUNNY, resolution=9).digest)
    (package,) = directory.glob("env/lib/python3*/site-packages/latvox")
    assert file == str(package / "__init__.py") and (package / "py.typed").exists()
    names = sorted(path.name for path in (package / "bin").iterdir() if not path.is_symlink())
    assert names == ["latvox", "latvox-vdb.so", "latvoxd"]
    assert all(os.access(package / "bin" / name, os.X_OK) for name in ("latvox", "latvoxd"))
