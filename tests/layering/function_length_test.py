"""No function is longer than 60 lines: C++, Python, JavaScript and shell, tests included.

A proof that must be read in one piece may be longer: PROOFS names it, with its length.
Universal ctags finds the functions of C++. Those of JavaScript and shell end where a brace closes at their own indentation.
"""

import ast
import collections
import json
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("client", "core", "deploy", "proto", "server", "tests")
LIMIT = 60
PROOFS = {
    ("core/digitize/crossing.h", "ForEachCrossing"): 70,
    ("core/digitize/principal_scan.h", "ScanAlongPrincipal"): 73,
}
FOREIGN = {"client/tool/view/three.js"}  # made by client/tool/view/bundle

Function = collections.namedtuple("Function", "path line name length")

SUFFIXES = {".h": "C++", ".cc": "C++", ".inc": "C++", ".py": "Python", ".js": "JavaScript", ".sh": "Shell"}
JAVASCRIPT = re.compile(
    r"(?:.*\bfunction\b|.*=> \{$|\s*(?!(?:if|for|while|switch|catch|with)\b)(?:(?:async|static|get|set|\*) ?)*[\w#$]+\(.*\) \{$)"
)
SHELL = re.compile(r"\s*[\w-]+\(\) *[{(]$")


def language(path):
    """The language of a file, or None where it has no functions of ours."""
    if path.suffix:
        return SUFFIXES.get(path.suffix)
    with open(path, encoding="utf-8", errors="replace") as text:
        line = text.readline()
    if not line.startswith("#!"):
        return None
    return "Python" if "python" in line else "Shell" if re.search(r"\b(ba|da)?sh\b", line) else None


def cpp_functions(root, paths):
    """The functions of C++ files, as ctags sees them; bodies of TEST are functions, too."""
    tags = subprocess.run(
        ["ctags", "--languages=C++", "--language-force=C++", "--kinds-C++=f", "--fields=+neS", "--output-format=json",
         "-f", "-", "-L", "-"],
        cwd=root, input="\n".join(paths), capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    for tag in map(json.loads, tags.splitlines()):
        if "end" in tag:
            name = tag["name"] + (tag.get("signature", "") if tag["name"].startswith("TEST") else "")
            yield Function(tag["path"], tag["line"], name, tag["end"] - tag["line"] + 1)


def python_functions(path, text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield Function(path, node.lineno, node.name, node.end_lineno - node.lineno + 1)


def braced_functions(path, text, start):
    """Functions whose first line matches `start`, and whose last line is a closing brace at the same indentation."""
    lines = text.splitlines()
    for number, line in enumerate(lines):
        if not start.match(line) or not line.endswith(("{", "(")):
            continue
        indentation = line[: len(line) - len(line.lstrip())]
        last = next(
            (n for n in range(number + 1, len(lines)) if re.match(indentation + r"[})]", lines[n])), len(lines) - 1
        )
        yield Function(path, number + 1, line.strip(), last - number + 1)


def functions(root, folders):
    """All functions of ours below `root`."""
    cpp = []
    for folder in folders:
        for file in sorted((root / folder).rglob("*")):
            path = str(file.relative_to(root))
            if not file.is_file() or "node_modules" in file.parts or path in FOREIGN:
                continue
            match language(file):
                case "C++":
                    cpp.append(path)
                case "Python":
                    yield from python_functions(path, file.read_text())
                case "JavaScript":
                    yield from braced_functions(path, file.read_text(), JAVASCRIPT)
                case "Shell":
                    yield from braced_functions(path, file.read_text(), SHELL)
    yield from cpp_functions(root, cpp)


def too_long(found):
    """Functions beyond the limit, as lines for people."""
    return [
        f"{function.path}:{function.line}: {function.name} has {function.length} lines, {limit} are allowed"
        for function in found
        if function.length > (limit := PROOFS.get((function.path, function.name), LIMIT))
    ]


class TheTree(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.found = list(functions(ROOT, FOLDERS))

    def test_no_function_is_too_long(self):
        self.assertEqual(too_long(self.found), [])

    def test_functions_of_every_language_are_found(self):
        count = collections.Counter(language(ROOT / function.path) for function in self.found)
        for name, least in (("C++", 3000), ("Python", 500), ("JavaScript", 100), ("Shell", 10)):
            self.assertGreater(count[name], least, name)

    def test_the_exceptions_are_needed(self):
        lengths = {(function.path, function.name): function.length for function in self.found}
        self.assertEqual({key: lengths.get(key) for key in PROOFS}, PROOFS)


class TheRule(unittest.TestCase):
    """A long function of each language is found, and one at the limit is not."""

    def found(self, name, first, line, last):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "core").mkdir()
            path = root / "core" / name
            lengths = []
            for between in (LIMIT - 2, LIMIT - 1):
                path.write_text("\n".join([*first, *[line] * between, *last, ""]))
                lengths.append(too_long(functions(root, ["core"])))
            return lengths

    def test_long_functions_are_found(self):
        for name, first, line, last in (
            ("a.cc", ["int F(int a) {"], "  a += 1;", ["}"]),
            ("a.h", ["template <class T>", "T F(T a) {"], "  a += 1;", ["}"]),
            ("a_test.cc", ["TEST(Case, Name) {"], "  Check();", ["}"]),
            ("a.py", ["def f(a):"], "    a += 1", ["    return a"]),
            ("a.js", ["function f(a) {"], "  a += 1;", ["}"]),
            ("b.js", ["class A {", "  f(a) {"], "    a += 1;", ["  }", "}"]),
            ("c.js", ["test('a', async () => {"], "  check();", ["});"]),
            ("a.sh", ["f() {"], "  check", ["}"]),
            ("tool", ["#!/bin/bash", "f() {"], "  check", ["}"]),
            ("script", ["#!/usr/bin/python3 -B", "def f(a):"], "    a += 1", ["    return a"]),
        ):
            with self.subTest(name):
                fits, long = self.found(name, first, line, last)
                self.assertEqual(fits, [])
                self.assertEqual(len(long), 1, long)
                self.assertRegex(long[0], rf"^core/{name}:\d+: .* has 61 lines, 60 are allowed$")


if __name__ == "__main__":
    unittest.main()
