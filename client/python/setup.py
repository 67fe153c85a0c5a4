"""Builds the package by CMake: the module, and the programs that it starts.

$CMAKE_ARGS has further arguments of CMake. If $LATVOX_BUILD_DIR names a build folder with the target latvox_python, the
package takes what is there, and builds nothing.
"""

import os
import pathlib
import re
import shlex
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


class CMakeBuild(build_ext):
    """Builds the target latvox_python, and takes what it makes."""

    def build_extension(self, extension):
        """Copies the module and the programs into the package."""
        build = pathlib.Path(os.environ.get("LATVOX_BUILD_DIR") or self.build(self.build_temp))
        path = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        (path.parent / "bin").mkdir(parents=True, exist_ok=True)
        shutil.copy2(build / "client/python/latvox" / path.name, path)
        for program in PROGRAMS:
            shutil.copy2(build / "bin" / program, path.parent / "bin" / program)

    def build(self, folder):
        """Builds in the folder, and returns it."""
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DLATVOX_UNITE_FOLDERS=ON", "-DBUILD_TESTING=OFF", "-DLATVOX_PYTHON=ON"]
        options += [f"-DLATVOX_PYTHON_PROGRAM={sys.executable}", *shlex.split(os.environ.get("CMAKE_ARGS", ""))]
        subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "--log-level=WARNING", *options], check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "latvox_python"], check=True)
        return folder


setup(version=version(), ext_modules=[Extension("latvox._latvox", [])], cmdclass={"build_ext": CMakeBuild})
