"""The bill of materials: every library of the programs, with version, licenses and package URL."""

import gzip
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import unittest.mock
import urllib.parse

from harness import BIN, PATIENCE, Case

BUILD = BIN.parent
ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = [BIN / "latvox", *BIN.glob("latvox-vdb.so"), BIN / "latvoxd"]
EXTENSION = list(BUILD.glob("client/python/latvox/_latvox.*.so"))
# A build installs packages of these sources of Debian, and the programs have no code of theirs.
FOREIGN = {"assimp", "boost-defaults", "googletest", "python3-defaults"}
GNU = r"(?:AGPL|GFDL|GPL|LGPL)-[1-3]\.[0-3]-(?:only|or-later)"
LATE = next(pathlib.Path("/usr/lib").glob("*/libcurl.so.4"))  # a library that latvox loads when it needs it


def sbom(*words):
    return subprocess.run([ROOT / "deploy/sbom", *words], capture_output=True, text=True, timeout=PATIENCE)


def script():
    """Returns deploy/sbom as a module, without a file of its bytes beside it."""
    spec = importlib.util.spec_from_loader("sbom", importlib.machinery.SourceFileLoader("sbom", str(ROOT / "deploy/sbom")))
    module = importlib.util.module_from_spec(spec)
    with unittest.mock.patch("sys.dont_write_bytecode", True):
        spec.loader.exec_module(module)
    return module


def without_joints(expression):
    """Returns the names of an expression of SPDX. Fails if it is none, or leaves in doubt what AND and OR join."""
    while "(" in expression:
        inner = re.search(r"\(([^()]+)\)", expression)
        assert " OR " in inner[1], expression
        expression = expression.replace(inner[0], re.sub(r" (?:AND|OR) ", " AND ", inner[1]))
    names = expression.split(" AND ")
    assert not [name for name in names if not re.fullmatch(r"[\w.+-]+", name)], expression
    return names


class Names(unittest.TestCase):
    """The licenses of copyright files as Debian writes them."""

    def declared(self, *paragraphs):
        sbom = script()
        with tempfile.TemporaryDirectory() as directory, unittest.mock.patch.object(sbom, "SYSTEM", directory):
            sbom.copyright_file("small").parent.mkdir(parents=True)
            sbom.copyright_file("small").write_text("\n\n".join(paragraphs))
            extracted = {}
            return sbom.Licenses("small", "source", extracted).declared, extracted

    def test_choices_stay_choices(self):
        head = "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/"
        for field, expected in (
            ("GPL-1+", ["GPL-1.0-or-later"]),
            ("LGPL-2.1", ["LGPL-2.1-only"]),
            ("GFDL-1.2+", ["GFDL-1.2-or-later"]),
            ("Expat and zlib", ["MIT", "Zlib"]),
            ("BSD-3-clause or GPL-2", ["(BSD-3-Clause OR GPL-2.0-only)"]),
            ("Expat and/or GPL-3+", ["(MIT OR GPL-3.0-or-later)"]),
            ("Expat and ISC or GPL-2", ["(MIT AND ISC OR GPL-2.0-only)"]),
            ("Expat or ISC, and zlib", ["(MIT OR ISC)", "Zlib"]),
            ("MPL-1.1 or GPL-2+ or LGPL-2.1+", ["(MPL-1.1 OR GPL-2.0-or-later OR LGPL-2.1-or-later)"]),
        ):
            self.assertEqual(self.declared(head, f"Files: *\nLicense: {field}"), (expected, {}), field)

    def test_a_paragraph_with_the_text_of_a_choice_asks_for_nothing(self):
        head = "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/"
        texts = "License: Expat\n Free.", "License: own\n First.\n .\n Second."
        self.assertEqual(self.declared(head, "Files: *\nLicense: Expat or own", *texts),
                         (["(MIT OR LicenseRef-debian-source-own)"], {"LicenseRef-debian-source-own": ("own", "First.\n\nSecond.")}))  # fmt: skip
        (own,), extracted = self.declared(head, "Files: *\nLicense: GPL-2+ with Bison exception\n Text.")
        self.assertEqual(own, "LicenseRef-debian-source-GPL-2-or-later-with-Bison-exception")
        self.assertEqual(extracted[own], ("GPL-2+ with Bison exception", "Text."))

    def test_a_file_without_fields_is_the_text(self):
        (own,), extracted = self.declared("The license:\nLicense: is free.")
        self.assertEqual(extracted, {own: ("copyright", "The license:\nLicense: is free.")})


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
        self.assertIn("(BSD-3-Clause OR GPL-2.0-only)", self.packages["libzstd1"]["licenseDeclared"].split(" AND "))

    def test_each_license_is_an_expression_of_spdx_and_one_without_a_name_there_has_its_text(self):
        known = set(script().SPDX.values())
        for package in self.document["packages"]:
            names = without_joints(package["licenseDeclared"])
            self.assertTrue(names, package["name"])
            for name in names:
                self.assertTrue(name in known or re.fullmatch(GNU, name) or re.fullmatch(r"LicenseRef-[A-Za-z0-9.-]+", name), name)
        texts = {info["licenseId"]: info["extractedText"] for info in self.document["hasExtractedLicensingInfos"]}
        for name in "libc6", "libstdc++6":  # their files have no fields that name licenses
            self.assertEqual(texts[self.packages[name]["licenseDeclared"]], pathlib.Path(f"/usr/share/doc/{name}/copyright").read_text())
        self.assertIn("Redistribution and use in source", next(text for own, text in texts.items() if own.endswith("-BSD-3-google")))

    def test_package_urls_have_no_plus(self):
        """Readers of URLs may take it for a space."""
        for package in self.document["packages"]:
            (url,) = (each["referenceLocator"] for each in package["externalRefs"])
            self.assertNotIn("+", url)
            kind, name, version = re.fullmatch(r"pkg:(\w+)/(?:debian/)?([^@]+)@([^?]+)(?:\?arch=\w+)?", url).groups()
            self.assertIn(kind, ("deb", "generic", "npm"))
            self.assertEqual([urllib.parse.unquote(part) for part in (name, version)], [package["name"], package["versionInfo"]])

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

    def test_the_notices_are_those_of_what_a_program_holds(self):
        for programs, more in ((PROGRAMS, set()), (PROGRAMS + EXTENSION, {"pybind11-dev"} if EXTENSION else set())):
            paths = sbom("--notices", *programs).stdout.splitlines()
            self.assertEqual([path for path in paths if not pathlib.Path(path).is_file()], [])
            held = {package["name"] for package in self.document["packages"] if package["name"].endswith("-dev")}
            self.assertEqual({pathlib.Path(path).parent.name for path in paths}, held | more)

    def test_packages_have_the_notices(self):
        """As CPack runs the script, over the files of the packages."""
        root = self.dir / "root"
        for name, path in (("latvox", "bin/latvox"), ("latvoxd", "lib/systemd/system/latvoxd.service"), ("liblatvox-dev", "lib/a/liblatvox.a"),
                           ("python3-latvox", "lib/python3/dist-packages/latvox/_latvox.cpython-311.so")):  # fmt: skip
            (root / name / "usr" / path).parent.mkdir(parents=True)
            (root / name / "usr" / path).touch()
        folder = ROOT / "deploy/packaging"
        words = {"CPACK_TEMPORARY_INSTALL_DIRECTORY": root, "CPACK_LATVOX_FOLDER": folder, "CPACK_LATVOX_PACKAGES": ";".join(path.name for path in root.iterdir())}
        subprocess.run(["cmake", *(f"-D{name}={value}" for name, value in words.items()), "-P", folder / "documents.cmake"],
                       env=os.environ | {"SOURCE_DATE_EPOCH": "0"}, check=True, capture_output=True)  # fmt: skip
        found = {name.name: {path.stem for path in name.glob("usr/share/doc/*/notices/*.gz")} for name in root.iterdir()}
        held = {package["name"] for package in self.document["packages"] if package["name"].endswith("-dev")}
        self.assertEqual(found, {"latvox": held, "latvoxd": set(), "liblatvox-dev": held, "python3-latvox": held | {"pybind11-dev"}})
        notice = root / "latvox/usr/share/doc/latvox/notices/libcli11-dev.gz"
        self.assertEqual(gzip.decompress(notice.read_bytes()).decode(), pathlib.Path("/usr/share/doc/libcli11-dev/copyright").read_text())

    def test_bad_words_are_refused(self):
        for words, says in (((), "the following arguments are required: programs"), (("nowhere",), "nowhere: no such file"),
                            (("--gateway", PROGRAMS[0]), "--gateway: takes neither programs nor --static"),
                            (("--static", "x", PROGRAMS[0]), "--static: x is not NAME=VERSION=LICENSE")):
            done = sbom(*words)
            self.assertEqual(done.returncode, 2)
            self.assertIn(says, done.stderr)


if __name__ == "__main__":
    unittest.main()
