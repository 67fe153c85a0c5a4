"""Builds the package for pip: CMake makes the module and the programs, and this file packs them into a wheel.

If $LATVOX_BUILD_DIR names a build folder with the target latvox_python, the package takes what is there, and nothing is
built. Otherwise the folder is build/pip of the repository.

The functions without an underscore are those that PEP 517 names.
"""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile

_HERE = pathlib.Path(__file__).resolve().parent
_ROOT = _HERE.parents[1]
_PROGRAMS = ("latvox", "latvoxd")
_VERSION = re.search(r"project\(latvox VERSION (\S+)", (_ROOT / "CMakeLists.txt").read_text())[1]
_INFO = f"latvox-{_VERSION}.dist-info"
_METADATA = f"""\
Metadata-Version: 2.1
Name: latvox
Version: {_VERSION}
Summary: Exact voxelization on any 3D lattice
License: Apache-2.0
Requires-Python: >=3.9
Requires-Dist: numpy
"""
_REGULAR = 0o100000  # the type of a file, in the upper half of a zip archive's attributes


class UnsupportedOperation(Exception):
    """The error, by the name that PEP 517 gives it, of a hook that does not apply."""


def _tag():
    """Returns the Pythons and the platform that the module is for."""
    abi = "cp" + sysconfig.get_config_var("SOABI").split("-")[1]
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"cp{sys.version_info[0]}{sys.version_info[1]}-{abi}-{platform}"


def _wheel_facts():
    return f"Wheel-Version: 1.0\nGenerator: latvox {_VERSION}\nRoot-Is-Purelib: false\nTag: {_tag()}\n"


def _build():
    """Builds for this Python, with the options of the release preset. Returns the folder."""
    folder = _ROOT / "build/pip"
    options = ["-DBUILD_TESTING=OFF", f"-DLATVOX_PYTHON_PROGRAM={sys.executable}", "--log-level=WARNING"]
    subprocess.run(["cmake", "--preset", "release", "-B", folder, *options], check=True, cwd=_ROOT)
    subprocess.run(["cmake", "--build", folder, "--target", "latvox_python"], check=True)
    return folder


def _files(folder):
    """Returns the files of the package, by their names in the wheel."""
    module = f"latvox/_latvox{sysconfig.get_config_var('EXT_SUFFIX')}"
    if not (folder / "client/python" / module).exists():
        major, minor = sys.version_info[:2]
        raise FileNotFoundError(f"{folder}: has no module for Python {major}.{minor}, {module}")
    files = {module: folder / "client/python" / module}
    for pattern in ("*.py", "*.pyi", "py.typed"):
        files |= {f"latvox/{path.name}": path for path in (_HERE / "latvox").glob(pattern)}
    library = [file.name for file in (folder / "bin").glob("latvox-vdb.so")]  # unless it is a part of the program
    return files | {f"latvox/bin/{name}": folder / "bin" / name for name in (*_PROGRAMS, *library)}


class _Wheel:
    """An archive with a list of its files."""

    def __init__(self, path):
        self._archive = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED)
        self._record = ""

    def add(self, name, content, mode=0o644):
        """Adds a file."""
        info = zipfile.ZipInfo(name)  # with the date that all archives share
        info.external_attr = (_REGULAR | mode) << 16
        self._archive.writestr(info, content, zipfile.ZIP_DEFLATED)
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        self._record += f"{name},sha256={digest},{len(content)}\n"

    def close(self):
        """Adds the list."""
        name = f"{_INFO}/RECORD"
        self._archive.writestr(zipfile.ZipInfo(name), f"{self._record}{name},,\n")
        self._archive.close()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Makes the wheel. Returns its name."""
    folder = pathlib.Path(os.environ.get("LATVOX_BUILD_DIR") or _build())
    name = f"latvox-{_VERSION}-{_tag()}.whl"
    wheel = _Wheel(pathlib.Path(wheel_directory) / name)
    for target, path in sorted(_files(folder).items()):
        wheel.add(target, path.read_bytes(), path.stat().st_mode & 0o777)
    wheel.add(f"{_INFO}/METADATA", _METADATA.encode())
    wheel.add(f"{_INFO}/WHEEL", _wheel_facts().encode())
    wheel.close()
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes what pip wants to know before the build. Returns the folder's name."""
    folder = pathlib.Path(metadata_directory) / _INFO
    folder.mkdir()
    (folder / "METADATA").write_text(_METADATA)
    (folder / "WHEEL").write_text(_wheel_facts())
    return _INFO


def build_sdist(sdist_directory, config_settings=None):
    """Refuses: this folder alone does not suffice."""
    raise UnsupportedOperation("the sources of latvox are its whole repository; build a wheel from there")
