"""The SDK built alone, without server, tool and grids. It needs only the packages of the group "sdk"; as archives
and as shared libraries; for users of CMake and of pkg-config."""

import ctypes
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import harness
from harness import BUNNY, latvox, server

ROOT = pathlib.Path(__file__).resolve().parents[2]
ALONE = [f"-D{name}=OFF" for name in ("LATVOX_BUILD_SERVER", "LATVOX_BUILD_TOOL", "LATVOX_BUILD_GRID", "BUILD_TESTING")]
# Dependencies of the rest of the repository, as names of CMake packages, and as parts of file names.
FOREIGN = ("Boost", "CLI11", "OpenVDB", "PNG", "TBB", "hwy", "prometheus-cpp", "spdlog")
FOREIGN_FILE = r"boost|CLI/|CLI11|openvdb|nanovdb|Imath|libpng|png\.h|tbb|hwy|prometheus|spdlog|toml\+\+|/fmt/"
# Modules of pkg-config. gRPC's package requires re2, and this one requires Abseil's on Debian 13.
MODULES = ("libxxhash.pc", "libzip.pc", "libzstd.pc", "re2.pc", "absl_*.pc")
KINDS = ("static", "shared")

CACHED = {"CCACHE_NOHASHDIR": "1", "CCACHE_SLOPPINESS": "pch_defines,time_macros"}


def run(*words, **options):
    done = subprocess.run([*map(str, words)], capture_output=True, text=True, timeout=300, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}: {done.stdout}{done.stderr}")
    return done.stdout


def configure(source, build, *options, **more):
    words = ["cmake", "-S", source, "-B", build, "-G", "Ninja", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", *options]
    return run(*words, **more)


PLUGIN = """
#include <latvox/client.h>
#include <latvox/mesh/encode_mesh.h>
#include <latvox/mesh_files/read_mesh_file.h>

extern "C" __attribute__((visibility("default"))) int meshes_refused() {
  const auto client = latvox::client::Client::Connect("no address");
  return !client.ok() && !latvox::client::EncodeMesh(latvox::client::TriangleMesh()).ok() &&
         !latvox::client::ReadMeshFile("missing.obj").ok();
}
"""


def marked(headers):
    """Returns the names of the functions and classes that these headers mark with LATVOX_EXPORT."""
    text = "\n".join(header.read_text() for header in headers)
    classes, functions = r"^class LATVOX_EXPORT (\w+)", r"^LATVOX_EXPORT [^(]*\b(\w+)\("
    return {*re.findall(classes, text, re.M), *re.findall(functions, text, re.M)}


class Kind:
    """One kind of library, in a folder of its own. The paths in it are the same for each kind, so ccache finds the
    files of the second."""

    def __init__(self, folder, source, shared):
        self.folder, self.shared = folder, shared
        self.build, self.prefix, self.examples = folder / "sdk", folder / "prefix", folder / "build"
        modules = folder / "modules"
        modules.mkdir(parents=True)
        system = pathlib.Path(run("pkg-config", "--variable=pcfiledir", "re2").strip())
        for module in (module for name in MODULES for module in system.glob(name)):
            (modules / module.name).symlink_to(module)
        self.cached = os.environ | CACHED | {"CCACHE_BASEDIR": str(folder.parent)}
        missing = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in FOREIGN]
        self.said = configure(source, self.build, *ALONE, *missing, f"-DBUILD_SHARED_LIBS={'ON' if shared else 'OFF'}",
                              "-DCMAKE_CXX_FLAGS=-O0", "-DLATVOX_UNITE_FOLDERS=ON",
                              env=os.environ | {"PKG_CONFIG_LIBDIR": str(modules)})
        run("cmake", "--install", self.build, "--prefix", folder / "first", env=self.cached)  # builds what it lacks: all
        (folder / "first").rename(self.prefix)  # programs are built against the moved copy
        shutil.copytree(ROOT / "client/examples", folder / "source")
        needless = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ("gRPC", "Protobuf", "draco", "meshoptimizer", "pugixml")
                    if shared]
        configure(folder / "source", self.examples, f"-DCMAKE_PREFIX_PATH={self.prefix}",
                  "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror", *needless)
        run("cmake", "--build", self.examples, env=self.cached)

    def pkg_config(self, *words):
        environment = os.environ | {"PKG_CONFIG_PATH": str(self.prefix / "lib/pkgconfig")}
        return run("pkg-config", *(() if self.shared else ("--static",)), *words, env=environment).split()

    def by_pkg_config(self, example, package):
        """Builds the example's program by pkg-config, as the documentation says."""
        made = self.folder / f"{example}.o"
        compiler = ["ccache", "g++", "-std=c++20", *self.pkg_config("--cflags", package)]
        run(*compiler, "-c", f"source/{example}.cc", "-o", made, cwd=self.folder, env=self.cached)
        program = self.folder / f"{example}_by_pkg_config"
        run("g++", made, "-o", program, *self.pkg_config("--libs", package))
        return program

    def output(self, program, *arguments):
        environment = os.environ | {"LD_LIBRARY_PATH": str(self.prefix / "lib")}
        return run(program, *arguments, env=environment)


class SdkAlone(harness.Case):
    @classmethod
    def setUpClass(cls):
        folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="latvox-sdk-")))
        source = cls.source = folder / "repository"  # the SDK is built from this copy, without the rest
        for part in "proto", "client":
            shutil.copytree(ROOT / part, source / part, ignore=shutil.ignore_patterns("tool"))
        for file in "CMakeLists.txt", "LICENSE":
            shutil.copy(ROOT / file, source)
        cls.kinds = {name: Kind(folder / name, source, name == "shared") for name in KINDS}

    def test_programs_find_what_the_tool_finds(self):
        mesh = self.dir / "bunny.drc"
        self.assertEqual(latvox("encode", BUNNY, "-o", mesh).returncode, 0)
        octahedron = harness.write_obj(self.dir / "octahedron.obj", harness.octahedron())
        with server(self.dir) as latvoxd:
            bunny = self.voxelize(mesh, "--lattice", "bcc", "--resolution", 200, "--server", latvoxd.address)
            expected = f"{bunny['voxels']} voxels in {bunny['bricks']} bricks, digest {bunny['digest']}\n"
            own = self.voxelize(octahedron, "--resolution", 90, "--server", latvoxd.address)
            for name, kind in self.kinds.items():
                with self.subTest(name):
                    for program in kind.examples / "hello", kind.by_pkg_config("hello", "latvox"):
                        self.assertEqual(kind.output(program, latvoxd.address, mesh, 200), expected)
                    for program in kind.examples / "own_mesh", kind.by_pkg_config("own_mesh", "latvox-mesh"):
                        self.assertEqual(kind.output(program, latvoxd.address, 90),
                                         f"{own['voxels']} voxels, digest {own['digest']}\n")
                    self.assertEqual(kind.output(kind.examples / "fake_server"), "passed\n")

    def test_archives_can_be_part_of_a_shared_library(self):
        """For example a plugin, or a module of Python."""
        kind = self.kinds["static"]
        (kind.folder / "plugin.cc").write_text(PLUGIN)
        plugin = kind.folder / "plugin.so"
        run("g++", "-std=c++20", "-fPIC", "-fvisibility=hidden", "-shared", "-Wl,-z,defs", kind.folder / "plugin.cc", "-o", plugin,
            *kind.pkg_config("--cflags", "--libs", "latvox-mesh-files"))
        self.assertEqual(ctypes.CDLL(str(plugin)).meshes_refused(), 1)

    def test_nothing_of_the_tool_or_the_server_is_read(self):
        for name, kind in self.kinds.items():
            with self.subTest(name):
                headers = run("ninja", "-C", kind.build, "-t", "deps").splitlines()
                commands = run("ninja", "-C", kind.build, "-t", "commands") + run("ninja", "-C", kind.examples, "-t", "commands")
                read = {line.strip() for line in headers} | set(commands.split())
                for known in "/usr/include/grpcpp/channel.h", "/usr/include/draco/mesh/mesh.h", "libabsl_status":
                    self.assertTrue(any(known in file for file in read), f"{known}: the lists were not understood")
                self.assertEqual([file for file in read if re.search(FOREIGN_FILE, file)], [])
                self.assertNotRegex(kind.said, "(?i)tbb|openvdb|boost")

    def test_shared_libraries_bring_what_they_need(self):
        """Link lines of their users have neither gRPC nor Protobuf nor libraries of formats."""
        kind = self.kinds["shared"]
        self.assertNotRegex(run("ninja", "-C", kind.examples, "-t", "commands"), "grpc|protobuf|draco|zip|pugixml|meshopt")
        for package in "latvox-mesh", "latvox-mesh-files":
            self.assertNotRegex(" ".join(kind.pkg_config("--cflags", "--libs", package)), "grpc|protobuf|draco|zip|pugixml|meshopt")
        for name in "client", "mesh", "mesh_files":
            library = kind.prefix / f"lib/liblatvox_{name}.so"
            self.assertRegex(run("readelf", "-d", library), rf"soname: \[liblatvox_{name}\.so\.\d+\.\d+\]")

    def test_shared_libraries_show_what_the_headers_mark_and_no_more(self):
        lib, include = self.kinds["shared"].prefix / "lib", ROOT / "client/include/latvox"
        for name, headers in (("client", include.glob("*.h")), ("mesh", include.glob("mesh/*.h")),
                              ("mesh_files", include.glob("mesh_files/*.h"))):
            symbols = run("nm", "-DC", "--defined-only", lib / f"liblatvox_{name}.so").splitlines()
            shown = {re.sub(r"^(vtable|typeinfo|typeinfo name) for ", "", line.split(maxsplit=2)[2]) for line in symbols}
            self.assertEqual({re.match(r"latvox::client::(\w+)|", symbol)[1] for symbol in shown}, marked(headers))

    def test_the_list_of_the_grid_library_has_what_its_headers_mark_and_no_more(self):
        text = (ROOT / "client/grid/latvox_grid.map").read_text()
        patterns = re.findall(r"^ +(latvox::client::\S+);$", text, re.M)
        names = [f"latvox::client::{name}::" for name in marked((ROOT / "client/include/latvox/grid").glob("*.h"))]
        self.assertEqual([name for name in names if not any(fnmatch.fnmatchcase(name, each) for each in patterns)], [])
        self.assertEqual([each for each in patterns if not fnmatch.filter(names, each)], [])

    def test_everything_that_headers_leave_to_the_library_is_marked(self):
        for header in (ROOT / "client/include/latvox").rglob("*.h"):
            for line in re.sub(r"^template <.*>\n.*", "", header.read_text(), flags=re.M).splitlines():
                if re.match(r"class .*\{$|(?!inline|constexpr|template|using)[\w:]+(<.*>)?[&*]? \w+\(", line):
                    with self.subTest(f"{header.name}: {line}"):
                        self.assertRegex(line, r"^class LATVOX_EXPORT ")

    def test_the_package_names_no_place_of_the_build(self):
        for name, kind in self.kinds.items():
            with self.subTest(name):
                files = [*kind.prefix.rglob("*.cmake"), *kind.prefix.rglob("*.pc")]
                self.assertGreater(len(files), 5)
                for file in files:
                    self.assertNotIn(str(kind.folder.parent), file.read_text(), file)
                self.assertFalse((kind.prefix / "include/latvox/grid").exists())

    def test_options_that_exclude_each_other_are_named(self):
        """The SDK also builds without the encoder."""
        for options, wrong in (
            (["-DLATVOX_BUILD_GRID=OFF"], r"LATVOX_BUILD_TOOL is ON and needs LATVOX_BUILD_GRID, which\s+is\s+OFF"),
            ([*ALONE, "-DCMAKE_DISABLE_FIND_PACKAGE_draco=ON"], r"Draco is not found.*LATVOX_BUILD_MESH=OFF"),
            ([*ALONE, "-DCMAKE_DISABLE_FIND_PACKAGE_draco=ON", "-DLATVOX_BUILD_MESH=OFF"], None),
        ):
            with self.subTest(options):
                words = ["cmake", "-S", self.source, "-B", tempfile.mkdtemp(dir=self.dir), "-G", "Ninja", *options]
                done = subprocess.run(words, capture_output=True, text=True, timeout=300)
                self.assertEqual(done.returncode == 0, wrong is None, done.stderr)
                self.assertRegex(done.stderr, f"(?s){wrong or ''}")


if __name__ == "__main__":
    unittest.main()
