"""The table of contents of the documentation site, and the names that its pages have there.

A page is a Markdown file of the repository, named by its path from the root.
"""

import functools
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Sections of the navigation. An item is a page, a pattern for pages that no other item names, (title, file of the site),
# or (title, items).
CONTENTS = [
    ("Start", [("Overview", "index.html"), "client/docs/tutorial.md", "client/docs/choosing.md", "client/docs/exact.md"]),
    ("Tasks", [
        "client/docs/inputs.md", "client/docs/voxel-files.md", "client/docs/sets.md", "client/docs/fields.md",
        "client/docs/drawings.md",
        "client/docs/batch.md", "client/docs/sdk.md", "client/docs/python.md", "client/docs/languages.md",
        "server/docs/protocol.md", "client/docs/life-of-a-call.md", "client/docs/*.md",
    ]),
    ("Server", ["server/docs/running.md", "server/docs/security.md", "server/docs/operations.md", "server/docs/*.md"]),
    ("Deployment", ["deploy/README.md", "deploy/docs/*.md", "deploy/scale/README.md"]),
    ("Reference", [
        "client/docs/command-line.md", "client/docs/limits.md", ("The protocol", "protocol.html"),
        ("C++ SDK", [
            ("latvox/client.h", "client_8h.html"), ("Client", "classlatvox_1_1client_1_1Client.html"),
            ("Namespace latvox::client", "namespacelatvox_1_1client.html"), ("Classes", "annotated.html"),
            ("Headers", "files.html"), ("Examples", "examples.html"),
        ]),
        "deploy/CHANGELOG.md",
    ]),
    ("Measurements", [
        "tests/bench/README.md", "tests/bench/figures.md", "tests/bench/bounds.md",
        ("Notes on performance", ["tests/bench/notes/*.md"]), "tests/thesis/README.md", "tests/corpus/README.md",
    ]),
    ("Contributing", [
        ".github/CONTRIBUTING.md", ".github/SECURITY.md", "deploy/RELEASE.md", "tests/README.md",
        ("Notes on tests", ["tests/notes/*.md"]), "proto/README.md",
        ("Code: core", ["core/README.md", "core/**/README.md"]),
        ("Code: server", ["server/README.md", "server/**/README.md"]),
        ("Code: client", ["client/README.md", "client/**/README.md"]),
        ("Code: deploy", ["deploy/**/README.md"]),
    ]),
]  # fmt: skip
FRONT = "README.md"


def named(items):
    """Yields the pages that the items name."""
    for item in items:
        if isinstance(item, str) and "*" not in item:
            yield item
        elif not isinstance(item, str) and not isinstance(item[1], str):
            yield from named(item[1])


@functools.cache
def contents():
    """Returns CONTENTS with pages in place of patterns."""
    taken = {FRONT, *named(CONTENTS)}

    def expanded(items):
        for item in items:
            if isinstance(item, str) and "*" in item:
                found = sorted(str(path.relative_to(ROOT)) for path in ROOT.glob(item))
                found = [path for path in found if path not in taken and "node_modules" not in path]
                taken.update(found)
                yield from found
            else:
                yield item if isinstance(item, str) or isinstance(item[1], str) else (item[0], list(expanded(item[1])))

    return list(expanded(CONTENTS))


@functools.cache
def pages():
    """Returns all pages, each once."""
    return [FRONT, *named(contents())]


def name(page):
    """Returns the page's name in the site: its file there without .html."""
    if page == FRONT:
        return "index"
    return re.sub(r"\W+", "_", page.removesuffix(".md").removesuffix("/README")).strip("_")


def lines(page):
    """Yields the lines of a page, each with the anchor that GitHub gives it: None except for headings."""
    seen, fence = {}, None
    for line in (ROOT / page).read_text().splitlines():
        mark, heading = re.match(r" *(```+|~~~+)", line), re.match(r"#+ +(.*)", line)
        slug = None
        if mark and fence in (None, mark[1]):
            fence = None if fence else mark[1]
        elif heading and not fence:
            slug = re.sub(r"[^\w -]", "", heading[1].lower()).replace(" ", "-")
            count = seen[slug] = seen.get(slug, -1) + 1
            slug += f"-{count}" if count else ""
        yield line, slug, bool(fence or mark)


@functools.cache
def title(page):
    """Returns the page's title, without marks of Markdown."""
    return next(re.sub(r"^#+ +|[`*]", "", line) for line, slug, _ in lines(page) if slug)
