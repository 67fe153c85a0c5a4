"""The documentation builds completely, without a warning or a dead link. The build notices missing descriptions."""

import html.parser
import importlib.machinery
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import unittest
import urllib.parse

from harness import BIN, Case

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["LATVOX_BUILD_DIR"])
DOXYFILE = BUILD / "client/docs/Doxyfile"

sys.path.insert(0, str(ROOT / "client/docs"))
import pages  # noqa: E402


def load_build():
    """Loads client/docs/build as a module."""
    loader = importlib.machinery.SourceFileLoader("build", str(ROOT / "client/docs/build"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("build", loader))
    loader.exec_module(module)
    return module


class Page(html.parser.HTMLParser):
    """The links and the anchors of a page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text())

    def handle_starttag(self, tag, attrs):
        self.links += [value for name, value in attrs if name in ("href", "src", "data") and value]
        self.anchors |= {value for name, value in attrs if name in ("id", "name")}


def dead_links(folder):
    """Returns the links below the folder that lead nowhere, and the number of links read: of pages, menu and tree."""
    read = {path: Page(path) for path in sorted(folder.resolve().rglob("*.html"))}
    links = [(path, link) for path, page in read.items() for link in page.links]
    for script in [folder / "menudata.js", *folder.glob("navtreedata.js")]:
        links += [(script.resolve(), link) for link in re.findall(r'"([\w.-]+\.html(?:#\w+)?)"', script.read_text())]
    found = []
    for path, link in links:
        file, _, anchor = urllib.parse.unquote(link).partition("#")
        if re.match(r"\w+:", link):
            continue
        target = (path.parent / file).resolve() if file else path
        if not target.exists() or (anchor and target in read and anchor not in read[target].anchors):
            found.append(f"{path.name}: {link}")
    return found, len(links)


class Docs(Case):
    def test_everything_public_is_in_it(self):
        build = ["cmake", "--build", BUILD, "--target", "docs"]
        done = subprocess.run(build, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        docs = BUILD / "docs"
        menu = (docs / "menudata.js").read_text()
        for path, name in pages.NAMES.items():
            self.assertIn(f'"{name}.html"', menu, path)
            self.assertTrue((docs / f"{name}.html").exists(), path)
        for folder in ("client/docs", "server/docs", "deploy/docs"):
            for path in (ROOT / folder).glob("*.md"):
                self.assertIn(str(path.relative_to(ROOT)), pages.NAMES, "add it to client/docs/pages.py")
        found, read = dead_links(docs)
        self.assertEqual(found, [])
        self.assertGreater(read, 5000, "the links were not found")
        for name in ("Client", "BrickStream", "VoxelService", "VoxelGrid"):
            self.assertTrue((docs / f"classlatvox_1_1client_1_1{name}.html").exists(), name)
        namespace = (docs / "namespacelatvox_1_1client.html").read_text()
        for name in ("GetErrorDetails", "MergeParts", "NamedLattice", "kBcc", "Vec3i"):
            self.assertIn(name, namespace)
        for example in (ROOT / "client/examples").glob("*.cc"):
            self.assertTrue((docs / f"{example.stem}_8cc-example.html").exists(), example.name)
        for picture in re.findall(r"\(pictures/(\S+\.png)\)", (ROOT / "client/docs/choosing.md").read_text()):
            self.assertEqual((docs / picture).read_bytes(), (ROOT / "client/docs/pictures" / picture).read_bytes())
        protocol = (docs / "protocol.html").read_text()
        proto = (ROOT / "proto/latvox/v1/voxelizer.proto").read_text()
        for name in re.findall(r"^ *(?:message|enum|service|rpc) (\w+)", proto, re.M):
            self.assertIn(name, protocol)
        for name in re.findall(r"^ *\S+(?: \S+)? (\w+) = \d+;", proto, re.M):
            self.assertIn(f"<code>{name}</code>", protocol)

    def test_kept_pictures_are_those_that_draw_makes(self):
        drawn, kept = self.dir, ROOT / "client/docs/pictures"
        subprocess.run([ROOT / "client/docs/draw", BIN, drawn], check=True, timeout=300)
        self.assertEqual(sorted(path.name for path in drawn.iterdir()), sorted(path.name for path in kept.iterdir()))
        for path in drawn.iterdir():
            with self.subTest(path.name):
                self.assertLess((kept / path.name).stat().st_size, 200000 if path.name == "bunny-lattices.png" else 60000)
                compare = ["compare", "-metric", "RMSE", path, kept / path.name, "null:"]
                done = subprocess.run(compare, capture_output=True, text=True, timeout=60)
                # The bound is a tenth of the effect of another lattice or k: "RMSE of 65535 (of 1)".
                self.assertLess(float(done.stderr.partition("(")[2].rstrip(")")), 0.01, done.stderr)

    def doxygen(self, header):
        """Runs doxygen on a header with this text. Its XML is in self.dir / "xml"."""
        (self.dir / "broken.h").write_text(header)
        settings = re.sub(r"^INPUT .*$", "", DOXYFILE.read_text(), flags=re.M)
        settings += f"INPUT = {self.dir}/broken.h\nOUTPUT_DIRECTORY = {self.dir}\nHTML_OUTPUT = html\n"
        return subprocess.run(["doxygen", "-"], input=settings, capture_output=True, text=True, cwd=ROOT, timeout=60)

    def test_missing_descriptions_are_found(self):
        header = "// A file.\n#ifndef A_H_\n#define A_H_\n\n// A thing.\nstruct A {\n  int x = 0;  // a number\n%s};\n\n#endif\n"
        whole = self.doxygen(header % "")
        self.assertEqual((whole.returncode, whole.stderr), (0, ""))
        self.assertEqual(load_build().undescribed(self.dir / "xml"), [])
        lacking = self.doxygen(header % "  int y = 0;\n")
        self.assertNotEqual(lacking.returncode, 0)
        self.assertRegex(lacking.stderr, r"broken\.h:8: .*Member y .* is not documented")
        self.doxygen(header % "  // One of.\n  enum class E { kA };\n")
        self.assertEqual(load_build().undescribed(self.dir / "xml"), ["structA: kA"])

    def test_dead_links_are_found(self):
        (self.dir / "a.html").write_text('<a id="here"></a><a href="#here"></a><a href="b.html"></a><a href="http://a/b"></a>')
        (self.dir / "menudata.js").write_text('{url:"a.html"},{url:"c.html"}')
        (self.dir / "b.html").write_text('<img src="no.png"><a href="a.html#there"></a><a href="a.html#here"></a>')
        dead = ["b.html: no.png", "b.html: a.html#there", "menudata.js: c.html"]
        self.assertEqual(dead_links(self.dir), (dead, 8))

    def test_pages_become_pages_of_doxygen(self):
        page = "# Sets\n\n[a\nb](choosing.md#k) and\n`[x]` [a](choosing.md#k), `[b](c.md)`, [d](../../LICENSE), [e](../examples/hello.cc)\n\n| `x\\|y` |\n\n```\n# f\n```\n## `g` h\n"
        became = "# Sets {#sets}\n\n[a b](#choosing_k)\n and\n`[x]` [a](#choosing_k), `[b](c.md)`, d (`LICENSE`), \\ref hello.cc \"e\"\n\n"
        became += "| <code>x&#124;y</code> |\n\n```\n# f\n```\n## `g` h {#sets_g_h}\n"
        self.assertEqual(pages.filtered("client/docs/sets.md", page), became)
        self.assertEqual(pages.slugs("# A\n## B c\n## B c\n"), ["a", "b-c", "b-c-1"])

    def test_a_field_without_a_comment_is_found(self):
        message = "// A thing.\nmessage A {\n  // A number.\n  int32 x = 1;\n  int32 y = 2;\n}\n"
        (self.dir / "a.proto").write_text('// A file.\nsyntax = "proto3";\n\n' + message)
        descriptors = self.dir / "a.bin"
        options = ["-I", self.dir, "--include_source_info", f"--descriptor_set_out={descriptors}"]
        subprocess.run(["protoc", *options, "a.proto"], check=True, timeout=60)
        done = subprocess.run([ROOT / "client/docs/proto_reference", descriptors], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (1, "", "a.proto: without a comment: A.y\n"))


if __name__ == "__main__":
    unittest.main()
