"""The documentation site has every page and no dead link, and its build notices missing descriptions."""

import contextlib
import html
import html.parser
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import unittest

from browser import Browser, Tab
from harness import BIN, Case

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["LATVOX_BUILD_DIR"])
DOXYFILE = BUILD / "client/docs/Doxyfile"
SITE = BUILD / "docs"
FOLDERS = (".github", "client", "core", "deploy", "proto", "server", "tests")
# Pages with wide tables, pictures, diagrams, or long names.
WIDE = ("index.html", "client_docs_choosing.html", "client_docs_fields.html", "client_docs_limits.html", "server.html",
        "tests_bench.html", "tests_thesis.html", "protocol.html", "classlatvox_1_1client_1_1Client.html",
        "annotated.html")  # fmt: skip
READY = "new Promise((done) => document.readyState === 'complete' ? done() : addEventListener('load', done))"


def load(name):
    """Loads a program of client/docs as a module."""
    loader = importlib.machinery.SourceFileLoader(name.removesuffix(".py"), str(ROOT / "client/docs" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class Page(html.parser.HTMLParser):
    """The anchors and the links of a page of the site, and those of its navigation."""

    def __init__(self, path):
        super().__init__()
        self.anchors, self.links, self.navigation, self.place = set(), [], [], None
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.anchors |= {attributes[name] for name in ("id", "name") if attributes.get(name)}
        links = [attributes[name] for name in ("href", "src", "data") if attributes.get(name)]
        self.links += links
        if tag == "nav":
            self.place = tag
        elif self.place:
            self.navigation += links

    def handle_endtag(self, tag):
        if tag == self.place:
            self.place = None


class Docs(Case):
    @classmethod
    def setUpClass(cls):
        build = ["cmake", "--build", BUILD, "--target", "docs"]
        cls.built = subprocess.run(build, capture_output=True, text=True, timeout=300)
        cls.pages = {path.name: Page(path) for path in SITE.glob("*.html")}

    def setUp(self):
        super().setUp()
        self.assertEqual(self.built.returncode, 0, self.built.stdout + self.built.stderr)

    def test_every_page_of_the_repository_is_in_it(self):
        contents = load("contents.py")
        found = ["README.md", *(str(path.relative_to(ROOT)) for folder in FOLDERS for path in (ROOT / folder).rglob("*.md"))]
        expected = {path for path in found if not re.search("/node_modules/|TEMPLATE|pull_request_template", path)}
        self.assertGreater(len(expected), 80)
        self.assertEqual(sorted(contents.pages()), sorted(expected))
        for path in contents.pages():
            with self.subTest(path):
                file = contents.name(path) + ".html"
                title = re.search(r'<div class="title">(.*?)</div>', (SITE / file).read_text(), re.S)[1]
                shown = " ".join(html.unescape(re.sub("<[^>]*>", "", title)).split())
                self.assertEqual(shown, contents.title(path))
                for page in self.pages.values():
                    self.assertIn(file, page.navigation)

    def test_no_link_is_dead(self):
        for name, page in self.pages.items():
            for link in page.links:
                path, _, anchor = link.partition("#")
                if re.match("https?:", link):
                    continue
                with self.subTest(page=name, link=link):
                    self.assertTrue((SITE / (path or name)).is_file())
                    self.assertNotIn(".md", path)
                    if anchor:
                        self.assertIn(anchor, self.pages[path or name].anchors)

    def test_links_to_sections_lead_there(self):
        self.assertIn("client_docs_sets.html#client_docs_sets-the-guarantees", self.pages["index.html"].links)
        self.assertIn("LICENSE", self.pages["index.html"].links)

    def test_no_mark_of_markdown_is_left(self):
        for name in self.pages:
            text = (SITE / name).read_text().partition("<main>")[2]
            for code in (r"<pre.*?</pre>", r"<code.*?</code>", r'<div class="fragment">.*?</div><!-- fragment -->'):
                text = re.sub(code, "CODE", text, flags=re.S)
            with self.subTest(name):
                self.assertIsNone(re.search(r"\]\(|\{#|[@\\]ref\b|\[TOC\]|`|\*\*", re.sub("<[^>]*>", "", text)))

    def test_the_search_finds_sections_and_names_of_the_sdk(self):
        index = (SITE / "search_index.js").read_text()
        found = json.loads(index.removeprefix("const SECTIONS = ").removesuffix(";\n"))
        for address, title, heading, _ in found:
            path, _, anchor = address.partition("#")
            with self.subTest(address):
                self.assertTrue(title)
                self.assertTrue(not anchor or anchor in self.pages[path].anchors)
        self.assertIn(["A server for others", "Tokens"], [section[1:3] for section in found])
        self.assertTrue(any("VoxelizeAll" in section[2] for section in found))

    def test_it_works_on_a_phone_and_on_a_desk(self):
        with contextlib.closing(Browser(self.dir)) as browser:
            for width, phone in ((390, True), (1280, False)):
                tab = Tab(browser, width, 800, phone=phone)
                for name in WIDE:
                    tab.call("Page.navigate", url=f"file://{SITE}/{name}")
                    with self.subTest(name, width=width):
                        self.assertLessEqual(tab.run(READY + ".then(() => document.documentElement.scrollWidth)"), width)
                shown = "getComputedStyle(document.getElementById('navigation')).display"
                self.assertEqual(tab.run(shown), "none" if phone else "block")
                if phone:
                    self.assertEqual(tab.run(f"menu.click(), {shown}"), "block")
                first = tab.run("load().then(() => (search.value = 'tokens', show())).then(() => results.firstChild.href)")
                self.assertEqual(first, f"file://{SITE}/server_docs_security.html#server_docs_security-tokens")
                tab.call("Page.close")
            self.assertEqual([event for event in browser.events if event["method"] == "Runtime.exceptionThrown"], [])

    def test_everything_public_is_in_it(self):
        docs = SITE
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
            self.assertTrue(f">{name}</code>" in protocol, name)

    def test_kept_pictures_are_those_that_draw_makes(self):
        drawn, kept = self.dir, ROOT / "client/docs/pictures"
        subprocess.run([ROOT / "client/docs/draw", BIN, drawn], check=True, timeout=300)
        self.assertEqual(sorted(path.name for path in drawn.iterdir()), sorted(path.name for path in kept.glob("*.png")))
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
        self.assertEqual(load("build").undescribed(self.dir / "xml"), [])
        lacking = self.doxygen(header % "  int y = 0;\n")
        self.assertNotEqual(lacking.returncode, 0)
        self.assertRegex(lacking.stderr, r"broken\.h:8: .*Member y .* is not documented")
        self.doxygen(header % "  // One of.\n  enum class E { kA };\n")
        self.assertEqual(load("build").undescribed(self.dir / "xml"), ["structA: kA"])

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
