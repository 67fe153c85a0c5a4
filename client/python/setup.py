"""Builds the package by CMake in build/pip of the repository: the module, and the programs that it starts.

If $LATVOX_BUILD_DIR names a build folder with the target latvox_python, the package takes what is there, and builds
nothing.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ("latvox", "latvoxd")


def version():
    """Returns the version of the whole project."""
    return re.search(r"project\(latvox VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


def build():
    """Builds for this Python, with the options of the release preset. Returns the folder."""
    folder = ROOT / "build/pip"
    options = ["-DBUILD_TESTING=OFF", f"-DLATVOX_PYTHON_PROGRAM={sys.executable}", "--log-level=WARNING"]
    subprocess.run(["cmake", "--preset", "release", "-B", folder, *options], check=True, cwd=ROOT)
    subprocess.run(["cmake", "--build", folder, "--target", "latvox_python"], check=True)
    return folder


class CMakeBuild(build_ext):
    """Builds the target latvox_python, and takes what it makes."""

    def build_extension(self, extension):
        """Copies the module and the programs into the package."""
        folder = pathlib.Path(os.environ.get("LATVOX_BUILD_DIR") or build())
        path = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        (path.parent / "bin").mkdir(parents=True, exist_ok=True)
        shutil.copy2(folder / "client/python/latvox" / path.name, path)
        module = (file.name for file in (folder / "bin").glob("latvox-vdb.so"))  # unless it is a part of the program
        for name in (*PROGRAMS, *module):
            shutil.copy2(folder / "bin" / name, path.parent / "bin" / name)


setup(version=version(), ext_modules=[Extension("latvox._latvox", [])], cmdclass={"build_ext": CMakeBuild})
