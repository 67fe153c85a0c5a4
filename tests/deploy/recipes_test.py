"""The recipes of deploy/packaging for vcpkg, conda and Homebrew: syntax, version, options of CMake, and dependencies. None
of these package managers runs here. And the version and the commit of images."""

import json
import pathlib
import re
import subprocess
import tempfile
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "deploy/packaging"
PORT = FOLDER / "vcpkg/latvox"
VERSION = re.search(r"^project\(latvox VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(), re.M)[1]

# Each dependency that CMakeLists.txt looks for: name there -> name of vcpkg, of conda-forge, of Homebrew.
NAMES = {
    "absl": ("abseil", "libabseil", "abseil"),
    "blosc": ("blosc", "blosc", "c-blosc"),
    "Boost": ("boost-multiprecision", "libboost-devel", "boost"),
    "CLI11": ("cli11", "cli11", "cli11"),
    "curl": ("curl", "libcurl", "curl"),
    "draco": ("draco", "draco", "draco"),
    "gRPC": ("grpc", "libgrpc", "grpc"),
    "hdf5": ("hdf5", "hdf5", "hdf5"),
    "hwy": ("highway", "libhwy", "highway"),
    "libnghttp2": ("nghttp2", "libnghttp2", "libnghttp2"),
    "libturbojpeg": ("libjpeg-turbo", "libjpeg-turbo", "jpeg-turbo"),
    "libwebp": ("libwebp", "libwebp-base", "webp"),
    "libxxhash": ("xxhash", "xxhash", "xxhash"),
    "libzip": ("libzip", "libzip", "libzip"),
    "libzstd": ("zstd", "zstd", "zstd"),
    "meshoptimizer": ("meshoptimizer", "meshoptimizer", "meshoptimizer"),
    "nlohmann_json": ("nlohmann-json", "nlohmann_json", "nlohmann-json"),
    "OpenSSL": ("openssl", "openssl", "openssl@4"),
    "OpenVDB": ("openvdb", "openvdb", "openvdb"),
    "PNG": ("libpng", "libpng", "libpng"),
    "prometheus-cpp": ("prometheus-cpp", "prometheus-cpp", "prometheus-cpp"),
    "Protobuf": ("protobuf", "libprotobuf", "protobuf"),
    "pugixml": ("pugixml", "pugixml", "pugixml"),
    "seccomp": ("libseccomp", "libseccomp", "libseccomp"),
    "spdlog": ("spdlog", "spdlog", "spdlog"),
    "TBB": ("tbb", "tbb-devel", "tbb"),
    "tomlplusplus": ("tomlplusplus", "tomlplusplus", "tomlplusplus"),
    "ZLIB": ("zlib", "zlib", "zlib-ng-compat"),
}
# Packages of conda-forge without run_exports: what is built with them must ask for them by itself.
WITHOUT_RUN_EXPORTS = {"draco", "meshoptimizer"}
UNNAMED = {"tomlplusplus"}  # a header that no CMake file looks for
SEARCH = re.compile(
    r"^\s*(?:find_package\(([\w-]+)|pkg_check_modules\(\w+ (?:REQUIRED )?(?:IMPORTED_TARGET )?(?:REQUIRED )?([\w-]+)|pkg_search_module\(\w+ REQUIRED ([\w-]+)"
    r"|find_library\(\w+ (?:NAMES )?([\w-]+)|find_path\(\w+ ([\w.-]+))", re.M)  # fmt: skip
SYNONYMS = {"hdf5-serial": "hdf5", "hdf5_serial": "hdf5", "libcurl": "curl", "xxhash.h": "libxxhash"}
TOOLS = {"PkgConfig"}
VCPKG, CONDA, BREW = range(3)


def searched(text):
    found = {next(filter(None, groups)) for groups in SEARCH.findall(text)}
    return {SYNONYMS.get(name, name) for name in found} - TOOLS


def sdk():
    """Returns what the client, the encoder and the readers of meshes look for: all before the grids."""
    client, grids, _ = (ROOT / "client/CMakeLists.txt").read_text().partition("if(LATVOX_BUILD_GRID)")
    assert grids
    return searched(client) | searched((ROOT / "proto/CMakeLists.txt").read_text())


def everything():
    files = [ROOT / path / "CMakeLists.txt" for path in ("client", "core", "proto", "server", "deploy/manual", "deploy/process")]
    return set().union(UNNAMED, *(searched(path.read_text()) for path in files))


def named(dependencies, manager):
    return {NAMES[name][manager] for name in dependencies}


class Recipes(unittest.TestCase):
    def assert_options_exist(self, options):
        known = set(re.findall(r"^option\((\w+)", (ROOT / "CMakeLists.txt").read_text(), re.M)) | {"BUILD_TESTING", "CMAKE_BUILD_TYPE"}
        self.assertLessEqual({re.match(r"-D(\w+)=", option)[1] for option in options}, known)

    def test_every_dependency_has_its_names(self):
        self.assertEqual(everything(), NAMES.keys())
        self.assertNotIn("OpenVDB", sdk())

    def test_the_port_of_vcpkg(self):
        port = json.loads((PORT / "vcpkg.json").read_text())
        self.assertEqual((port["name"], port["version"], port["license"]), ("latvox", VERSION, "Apache-2.0"))
        self.assertEqual({each for each in port["dependencies"] if isinstance(each, str)}, named(sdk(), VCPKG))
        hosts = [each for each in port["dependencies"] if not isinstance(each, str)]
        self.assertEqual({each["name"] for each in hosts if each["host"]}, {"grpc", "protobuf", "vcpkg-cmake", "vcpkg-cmake-config"})

    def test_the_portfile_is_one_of_cmake_and_builds_this_checkout(self):
        # Stubs of vcpkg's functions print their words.
        functions = ("vcpkg_find_acquire_program", "vcpkg_cmake_configure", "vcpkg_cmake_install", "vcpkg_cmake_config_fixup", "vcpkg_fixup_pkgconfig", "vcpkg_install_copyright")
        stubs = "".join(f'function({name})\nmessage("{name};${{ARGN}}")\nendfunction()\n' for name in functions)
        with tempfile.TemporaryDirectory() as directory:
            script = pathlib.Path(directory) / "stubs.cmake"
            script.write_text(f'{stubs}set(PKGCONFIG "/tools/pkgconf")\nset(CURRENT_PACKAGES_DIR "{directory}/packages")\ninclude("{PORT}/portfile.cmake")\n')
            done = subprocess.run(["cmake", "-P", script], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        called = {name: words for name, *words in (line.split(";") for line in done.stderr.splitlines())}
        self.assertEqual(called.keys(), set(functions))
        source, *options = called["vcpkg_cmake_configure"][1:]
        self.assertEqual(pathlib.Path(source), ROOT)
        self.assertEqual(options[:2], ["OPTIONS", "-DPKG_CONFIG_EXECUTABLE=/tools/pkgconf"])
        self.assertEqual(called["vcpkg_find_acquire_program"], ["PKGCONFIG"])
        self.assert_options_exist(options[2:])
        self.assertEqual(called["vcpkg_install_copyright"], ["FILE_LIST", str(ROOT / "LICENSE")])
        self.assertTrue((ROOT / "LICENSE").is_file())

    def test_the_recipe_of_conda(self):
        recipe = yaml.safe_load((FOLDER / "conda/recipe.yaml").read_text())
        self.assertEqual((recipe["context"]["version"], recipe["about"]["license"]), (VERSION, "Apache-2.0"))
        self.assertEqual((FOLDER / "conda" / recipe["source"]["path"]).resolve(), ROOT)
        self.assertEqual(set(recipe["requirements"]["host"]), named(sdk(), CONDA))
        self.assertEqual(set(recipe["requirements"]["run"]), WITHOUT_RUN_EXPORTS & named(sdk(), CONDA))
        self.assert_options_exist(re.findall(r"-D\S+", " ".join(recipe["build"]["script"])))
        (test,) = [each for each in recipe["tests"] if "script" in each]
        (examples,) = test["files"]["source"]
        self.assertIn(f"cmake -S {examples.rstrip('/')} ", test["script"][0])
        targets = set(re.findall(r"[\w]+", test["script"][1].partition("--target ")[2]))
        self.assertLessEqual({f"{target}.cc" for target in targets}, {path.name for path in (ROOT / examples).iterdir()})

    def test_the_formula_of_homebrew(self):
        path = FOLDER / "homebrew/latvox.rb"
        formula = path.read_text()
        self.assertEqual(subprocess.run(["ruby", "-c", path], capture_output=True, text=True).stdout, "Syntax OK\n")
        self.assertEqual(re.search(r'tag: "v(.*?)"', formula)[1], VERSION)
        names = set(re.findall(r'^  depends_on "([^"]+)"', formula, re.M))
        self.assertEqual(names - {"cmake", "ninja", "pkgconf"}, named(everything(), BREW))
        self.assert_options_exist(re.findall(r'"(-D\w+=\w+)"', formula))

    def test_recipes_leave_out_the_same(self):
        left_out = {option for option in re.findall(r"-D\w+=OFF", (PORT / "portfile.cmake").read_text())}
        recipe = yaml.safe_load((FOLDER / "conda/recipe.yaml").read_text())
        self.assertEqual(left_out, set(re.findall(r"-D\w+=OFF", " ".join(recipe["build"]["script"]))))
        alone = re.search(r"^ALONE = .*", (ROOT / "tests/e2e/sdk_alone_test.py").read_text(), re.M)[0]
        self.assertEqual(left_out, {f"-D{name}=OFF" for name in re.findall(r'"(\w{5,})"', alone)}, "what a test builds")


class Pages(unittest.TestCase):
    def test_commands_hold_for_each_version(self):
        pages = [ROOT / "README.md", *ROOT.glob("deploy/docs/*.md"), *ROOT.glob("client/docs/*.md")]
        self.assertGreater(len(pages), 20)
        files = {str(page.relative_to(ROOT)): re.findall(r"latvox[\w-]*[-_]v?\d+\.\d[\w.-]*", page.read_text()) for page in pages}
        self.assertEqual({page: names for page, names in files.items() if names}, {})


class Images(unittest.TestCase):
    FILES = [*ROOT.glob("deploy/*.md"), *ROOT.glob("deploy/docs/*.md"), ROOT / "deploy/Dockerfile"]

    def test_the_version_is_that_of_the_programs(self):
        self.assertEqual(re.findall(r"^ARG VERSION=(.*)", (ROOT / "deploy/Dockerfile").read_text(), re.M), [VERSION])

    def test_each_command_names_the_commit(self):
        text = "\n".join(path.read_text().replace("\\\n", "") for path in self.FILES)
        builds = re.findall(r"docker build --file deploy/Dockerfile [^`\n]*", text)
        self.assertGreaterEqual(len(builds), 3)
        self.assertEqual([line for line in builds if "--build-arg REVISION=$(git rev-parse HEAD)" not in line], [])
        composed = re.findall(r"([^`\n]*)docker compose [^`\n]* --build", text)
        self.assertGreaterEqual(len(composed), 3)
        self.assertEqual(set(composed), {"LATVOX_COMMIT=$(git rev-parse HEAD) "})
        build = yaml.safe_load((ROOT / "deploy/compose.yaml").read_text())["services"]["latvoxd-1"]["build"]
        self.assertEqual(build["args"], {"REVISION": "${LATVOX_COMMIT:-unknown}"})
        self.assertIn("| `LATVOX_COMMIT` |", (ROOT / "deploy/docs/compose.md").read_text())


if __name__ == "__main__":
    unittest.main()
