"""The dependencies of the top folders: core and deploy depend on nothing of ours, server on core, proto and deploy,
client on proto and deploy, tests on all.

Reads every #include, every target_link_libraries, and the link lines of $LATVOX_BUILD_DIR/build.ninja.
"""

import collections
import functools
import os
import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("core", "proto", "server", "client", "deploy", "tests")
TOP = {"CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", *FOLDERS}

# Patterns of the include paths and of the libraries that each folder must not use.
GRPC = r"grpc|protobuf|google/|.*\.pb\.h|latvox/v1/"
Rule = collections.namedtuple("Rule", "includes links")
RULES = {
    "core": Rule(
        rf"{GRPC}|draco|openvdb|nanovdb|spdlog|fmt/|assimp|(server|client|proto|tests)/",
        r"grpc|protobuf|draco|openvdb|spdlog|fmt|assimp|latvox[_:]+(proto|server|client|mesh|grid|tool|oracle)|gtest",
    ),
    "proto": Rule(r"(core|server|client|tests)/", r"draco|openvdb|latvox[_:]+(core|server|client|mesh|grid|tool)|gtest"),
    "server": Rule(r"openvdb|nanovdb|assimp|(client|tests)/", r"openvdb|assimp|latvox[_:]+(client|mesh|grid|tool|oracle)|gtest"),
    "client": Rule(r"(core|server|tests)/", r"latvox[_:]+(core|server|oracle)|gtest"),
    "deploy": Rule(r"(core|proto|server|client|tests)/", r"latvox[_:]+(core|proto|server|client|mesh|grid|tool|oracle)|gtest"),
}

# The folder of each of our programs. core has only a library; the rule for it is on its CMakeLists.txt.
PROGRAMS = {"latvoxd": "server", "latvox": "client"}


@functools.cache
def includes(source):
    """Returns the paths of all #include lines of a C++ source text."""
    return re.findall(r'^[ \t]*#[ \t]*(?:include|include_next|import)[ \t]*[<"]([^>"]+)[>"]', source, re.M)


def linked(cmake):
    """Returns all libraries of the target_link_libraries of a CMake source text."""
    code = re.sub(r"#.*", "", cmake)
    calls = re.findall(r"target_link_libraries\s*\(\s*\S+\s+([^)]*)\)", code, re.I)
    return [word for call in calls for word in call.split() if word not in ("PUBLIC", "PRIVATE", "INTERFACE")]


def programs(ninja):
    """Returns the link lines of a build.ninja: program name -> file names of the libraries."""
    found = {}
    for name, body in re.findall(r"^build (?:\S*/)?(\S+): CXX_EXECUTABLE_LINKER\S*[^\n]*\n((?:  [^\n]*\n)*)", ninja, re.M):
        libraries = re.search(r"^  LINK_LIBRARIES = (.*)$", body, re.M)
        found[name] = [word.rpartition("/")[2] for word in libraries[1].split()] if libraries else []
    return found


def violations(folder, path, text):
    """Returns the violations in one file of a folder, as lines for people."""
    rule = RULES.get(folder)
    if rule is None:
        return []
    if path.endswith((".h", ".cc", ".inc", ".cu", ".cuh")):
        return [f"{path} includes {name}" for name in includes(text) if re.match(rule.includes, name)]
    if path.endswith(("CMakeLists.txt", ".cmake")):
        return [f"{path} links {name}" for name in linked(text) if re.search(rule.links, name, re.I)]
    return []


def link_violations(found):
    """Returns the violations in the link lines of our programs."""
    return [
        f"{program} links {library}"
        for program, libraries in found.items()
        if program in PROGRAMS
        for library in libraries
        if re.search(RULES[PROGRAMS[program]].links, library, re.I)
    ]


class TheTree(unittest.TestCase):
    def test_every_folder_keeps_to_its_dependencies(self):
        wrong, files = [], 0
        for folder in RULES:
            for path in sorted((ROOT / folder).rglob("*")):
                if path.is_file() and "node_modules" not in path.parts:
                    files += 1
                    with open(path, encoding="utf-8", errors="replace") as text:
                        wrong += violations(folder, str(path.relative_to(ROOT)), text.read())
        self.assertEqual(wrong, [])
        self.assertGreater(files, 20, "the folders were not found")

    @unittest.skipUnless("LATVOX_BUILD_DIR" in os.environ, "needs LATVOX_BUILD_DIR")
    def test_every_program_keeps_to_its_dependencies(self):
        found = programs((pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "build.ninja").read_text())
        self.assertLessEqual({"latvox", "latvoxd"}, found.keys())
        self.assertIn("liblatvox_core.a", found["latvoxd"], "the link lines were not understood")
        self.assertEqual(link_violations(found), [])

    def test_nothing_else_stands_at_the_top(self):
        try:
            listing = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
        except (OSError, subprocess.CalledProcessError):
            self.skipTest("not a git checkout")
        top = {name.partition("/")[0] for name in listing.splitlines()}
        self.assertEqual({name for name in top - TOP if not name.startswith(".")}, set())


class TheRules(unittest.TestCase):
    """The test finds violations that are put into a copy of the tree."""

    def test_wrong_includes_are_found(self):
        for folder, name in (
            ("core", "grpcpp/grpcpp.h"),
            ("core", "google/protobuf/message.h"),
            ("core", "latvox/v1/voxelizer.pb.h"),
            ("core", "draco/mesh/mesh.h"),
            ("core", "openvdb/openvdb.h"),
            ("core", "spdlog/spdlog.h"),
            ("core", "server/wire/convert.h"),
            ("core", "client/include/latvox/types.h"),
            ("core", "tests/oracle/oracle.h"),
            ("server", "client/include/latvox/types.h"),
            ("server", "openvdb/openvdb.h"),
            ("server", "tests/oracle/oracle.h"),
            ("client", "core/lattice/lattice.h"),
            ("client", "server/wire/convert.h"),
            ("client", "tests/oracle/oracle.h"),
            ("proto", "core/lattice/lattice.h"),
            ("deploy", "client/include/latvox/types.h"),
        ):
            for line in (f'#include "{name}"', f"  #  include <{name}>  // why", f'int x;\n#include "{name}"\n'):
                with self.subTest(folder=folder, line=line):
                    self.assertEqual(violations(folder, f"{folder}/a.h", line), [f"{folder}/a.h includes {name}"])

    def test_right_includes_are_not(self):
        for folder, name in (
            ("core", "core/lattice/lattice.h"),
            ("core", "absl/status/status.h"),
            ("server", "core/lattice/lattice.h"),
            ("server", "grpcpp/grpcpp.h"),
            ("server", "draco/mesh/mesh.h"),
            ("client", "latvox/v1/voxelizer.grpc.pb.h"),
            ("client", "openvdb/openvdb.h"),
            ("tests", "core/lattice/lattice.h"),
        ):
            self.assertEqual(violations(folder, f"{folder}/a.cc", f'#include "{name}"'), [])

    def test_wrong_links_are_found(self):
        for folder, name in (
            ("core", "gRPC::grpc++"),
            ("core", "protobuf::libprotobuf"),
            ("core", "draco::draco"),
            ("core", "${OpenVDB_LIBRARIES}"),
            ("core", "spdlog::spdlog"),
            ("core", "latvox::proto"),
            ("core", "latvox_server"),
            ("server", "latvox::client"),
            ("server", "GTest::gtest"),
            ("client", "latvox_core"),
            ("client", "latvox::server"),
        ):
            text = f"add_library(x a.cc)\ntarget_link_libraries(x PUBLIC latvox_build\n  PRIVATE {name})\n"
            with self.subTest(folder=folder, name=name):
                path = f"{folder}/CMakeLists.txt"
                self.assertEqual(violations(folder, path, text), [f"{path} links {name}"])
        self.assertEqual(violations("core", "core/CMakeLists.txt", "# target_link_libraries(x gRPC::grpc++)"), [])

    def test_wrong_link_lines_are_found(self):
        ninja = (
            "build bin/{0}: CXX_EXECUTABLE_LINKER__{0}_Release a.o | x.a || y\n"
            "  FLAGS = -O3\n  LINK_LIBRARIES = core/liblatvox_core.a  /usr/lib/{1}  -ldl\n  POST_BUILD = :\n\n"
        )
        for program, library in (
            ("latvox", "liblatvox_core.a"),
            ("latvox", "liblatvox_server.a"),
            ("latvoxd", "libopenvdb.so"),
            ("latvoxd", "liblatvox_client.a"),
        ):
            with self.subTest(program=program, library=library):
                found = programs(ninja.format(program, library))
                self.assertEqual(found, {program: ["liblatvox_core.a", library, "-ldl"]})
                self.assertIn(f"{program} links {library}", link_violations(found))
        self.assertEqual(link_violations(programs(ninja.format("latvoxd", "libgrpc++.so"))), [])


if __name__ == "__main__":
    unittest.main()
