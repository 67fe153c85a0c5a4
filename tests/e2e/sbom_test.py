"""The bill of materials: every library of the programs, with version, licenses and package URL."""

import json
import pathlib
import re
import subprocess
import unittest

from harness import BIN, PATIENCE, Case

BUILD = BIN.parent
ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = [BIN / "latvox", *BIN.glob("latvox-vdb.so"), BIN / "latvoxd"]
EXTENSION = list(BUILD.glob("client/python/latvox/_latvox.*.so"))
# A build installs packages of these sources of Debian, and the programs have no code of theirs.
FOREIGN = {"assimp", "boost-defaults", "googletest", "python3-defaults"}
LATE = next(pathlib.Path("/usr/lib").glob("*/libcurl.so.4"))  # a library that latvox loads when it needs it


def sbom(*words):
    return subprocess.run([ROOT / "deploy/sbom", *words], capture_output=True, text=True, timeout=PATIENCE)


class Sbom(Case):
    @classmethod
    def setUpClass(cls):
        done = sbom("--static", "openvdb=10.0.1=MPL-2.0", *PROGRAMS, LATE)
        assert done.returncode == 0, done.stderr
        cls.document = json.loads(done.stdout)
        # Debian 13 adds t64 to the names of libraries that got times of 64 bits on some processors.
        cls.packages = {package["name"].removesuffix("t64"): package for package in cls.document["packages"]}

    def test_every_library_has_its_package_with_the_installed_version(self):
        for package in self.document["packages"]:
            name = package["name"]
            if package["supplier"] != "Organization: Debian":
                continue
            version = subprocess.run(["dpkg-query", "-W", "-f=${Version}\n", name], capture_output=True, text=True).stdout
            self.assertIn(package["versionInfo"], version.split(), name)
        listed = subprocess.run(["ldd", *PROGRAMS], capture_output=True, text=True, check=True).stdout
        self.assertGreater(len(self.packages), 20)
        for library, name in (("libgrpc++", "libgrpc++1.51"), ("libssl", "libssl3"), ("libc.so", "libc6"), ("libtbb", "libtbb12"), ("libopenvdb", "libopenvdb10.0")):
            self.assertIn(library, listed)
            self.assertIn(name, self.packages)
        self.assertNotIn("libcurl", listed)
        self.assertIn("libcurl4", self.packages)

    def test_references_and_licenses_are_whole(self):
        known = {package["SPDXID"] for package in self.document["packages"]} | {"SPDXRef-DOCUMENT"}
        self.assertEqual(len(known), len(self.document["packages"]) + 1, "two packages have one name")
        for relation in self.document["relationships"]:
            self.assertIn(relation["spdxElementId"], known)
            self.assertIn(relation["relatedSpdxElement"], known)
        named = set(re.findall(r"LicenseRef-[A-Za-z0-9.-]+", json.dumps(self.document["packages"])))
        self.assertEqual(named, {info["licenseId"] for info in self.document["hasExtractedLicensingInfos"]})
        self.assertIn("BSD-3-Clause", self.packages["libprotobuf32"]["licenseDeclared"].split(" AND "))

    def test_what_a_program_holds_in_itself_is_listed(self):
        three = self.packages["three"]
        bundle = (ROOT / "client/tool/view/three.js").read_text()
        self.assertIn(f'"{three["versionInfo"].split(".")[1]}"', bundle)  # the revision that it tells
        self.assertEqual((three["licenseDeclared"], three["checksums"][0]["algorithm"]), ("MIT", "SHA512"))
        static = [r["relatedSpdxElement"] for r in self.document["relationships"] if r["relationshipType"] == "STATIC_LINK"]
        self.assertEqual(static, [self.packages["openvdb"]["SPDXID"]])

    def test_each_library_that_a_build_installs_is_listed(self):
        """Those of headers alone, too, which no program loads."""
        document = json.loads(sbom(*PROGRAMS, *EXTENSION, *(BUILD / "late_libraries.txt").read_text().split()).stdout)
        rows = [line.split() for line in (ROOT / "deploy/packages").read_text().splitlines()]
        built = {row[1] for row in rows if row[:1] == ["build"] and row[1].endswith("-dev")}
        told = subprocess.run(["dpkg-query", "-W", "-f=${source:Package}\n", *built], capture_output=True, text=True, check=True).stdout
        listed = {package["sourceInfo"].split()[5] for package in document["packages"] if "sourceInfo" in package}
        self.assertEqual(set(told.split()) - listed, FOREIGN | ({"pybind11"} if not EXTENSION else set()))
        names = {package["SPDXID"]: package["name"] for package in document["packages"]}
        held = {names[r["relatedSpdxElement"]] for r in document["relationships"] if r["relationshipType"] == "CONTAINS"}
        self.assertLessEqual({"three", "libcli11-dev", "libnanovdb-dev", "libtomlplusplus-dev", "nlohmann-json3-dev"}, held)
        self.assertNotIn("pybind11-dev", self.packages, "programs without the Python package")

    def test_the_build_of_the_image_has_the_files_that_it_reads(self):
        kept = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
        dockerfile = (ROOT / "deploy/Dockerfile").read_text()
        read = set(re.findall(r"\bdeploy/[\w./-]+", dockerfile.split("FROM packages AS openvdb")[1])) - {"deploy/docs/image.md"}
        read |= {"tests/node/package-lock.json"}  # of deploy/sbom
        read |= {f"deploy/{name}" for name in re.findall(r"add_subdirectory\(deploy/(\w+)", (ROOT / "CMakeLists.txt").read_text())}
        self.assertIn("deploy/sbom", read)
        for path in read:
            self.assertTrue(kept & {str(place) for place in [pathlib.Path(path), *pathlib.Path(path).parents]}, path)

    def test_the_gateways_packages_are_those_that_it_pins(self):
        done = sbom("--gateway")
        self.assertEqual(done.returncode, 0, done.stderr)
        document = json.loads(done.stdout)
        listed = {package["name"]: package for package in document["packages"]}
        wanted = json.loads((ROOT / "deploy/gateway/package.json").read_text())["dependencies"]
        self.assertEqual({name: listed[name]["versionInfo"] for name in wanted}, wanted)
        installed = {str(path.parent.relative_to(ROOT / "deploy/gateway/node_modules"))
                     for path in (ROOT / "deploy/gateway/node_modules").glob("**/package.json")
                     if "version" in json.loads(path.read_text())}
        self.assertEqual(listed.keys() - {"latvox"}, installed, "the packages of its packages, too")
        self.assertEqual({relation["relationshipType"] for relation in document["relationships"]}, {"DESCRIBES", "CONTAINS"})
        protobuf = listed["@bufbuild/protobuf"]
        self.assertEqual(protobuf["licenseDeclared"], "(Apache-2.0 AND BSD-3-Clause)")
        self.assertRegex(protobuf["externalRefs"][0]["referenceLocator"], r"^pkg:npm/%40bufbuild/protobuf@\d")

    def test_bad_words_are_refused(self):
        for words, says in (((), "the following arguments are required: programs"), (("nowhere",), "nowhere: no such file"),
                            (("--gateway", PROGRAMS[0]), "--gateway: takes neither programs nor --static"),
                            (("--static", "x", PROGRAMS[0]), "--static: x is not NAME=VERSION=LICENSE")):
            done = sbom(*words)
            self.assertEqual(done.returncode, 2)
            self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()
