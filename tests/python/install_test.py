"""The package installs by pip, without a network, and needs nothing of the build folder then."""

import base64
import csv
import hashlib
import io
import os
import subprocess
import zipfile

import latvox
from conftest import ROOT
from page_install import install_and_try

RECORD = f"latvox-{latvox.__version__}.dist-info/RECORD"


def test_the_page_s_commands_install_the_package(tmp_path):
    install_and_try(tmp_path, LATVOX_BUILD_DIR=os.environ["LATVOX_BUILD_DIR"])


def in_backend(program, **environment):
    """Runs a program with the builder of wheels."""
    command = ["/usr/bin/python3", "-B", "-c", f"import cmake_wheel; {program}"]
    environment = {"PATH": "/usr/bin:/bin", **environment}
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT / "client/python", env=environment)


def test_a_wheel_lists_its_files_and_equals_the_next_one(tmp_path):
    wheels = []
    for n in range(2):
        folder = tmp_path / str(n)
        folder.mkdir()
        program = f"print(cmake_wheel.build_wheel({str(folder)!r}))"
        done = in_backend(program, LATVOX_BUILD_DIR=os.environ["LATVOX_BUILD_DIR"])
        assert done.returncode == 0, done.stderr
        wheels.append(folder / done.stdout.strip())
    assert wheels[0].name.startswith(f"latvox-{latvox.__version__}-cp3") and wheels[0].name == wheels[1].name
    assert wheels[0].read_bytes() == wheels[1].read_bytes()
    with zipfile.ZipFile(wheels[0]) as archive:
        listed = {name: (digest, size) for name, digest, size in csv.reader(io.TextIOWrapper(archive.open(RECORD)))}
        assert listed.pop(RECORD) == ("", "") and sorted([*listed, RECORD]) == sorted(archive.namelist())
        for name, (digest, size) in listed.items():
            content = archive.read(name)
            own = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
            assert (digest, int(size)) == (f"sha256={own}", len(content)), name


def test_a_build_folder_of_another_python_is_refused(tmp_path):
    done = in_backend(f"cmake_wheel.build_wheel({str(tmp_path)!r})", LATVOX_BUILD_DIR=str(tmp_path))
    assert done.returncode != 0 and f"{tmp_path}: has no module for Python 3." in done.stderr
