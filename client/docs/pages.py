#!/usr/bin/python3
"""The pages of the documentation, and a filter that makes a page of the repository one for Doxygen.

Usage: pages.py FILE. Prints the file with links that Doxygen 1.9.4 understands:

    # Title, ## Section                 get names: sets, sets_pixels_of_a_drawing
    [text](sets.md#pixels-of-a-drawing)  a link to that name
    [text](../examples/hello.cc)         a link to the example; likewise for public headers and the .proto file
    [text](../../LICENSE)                text and the file's path, because the documentation does not have that file
    `--fill surface\\|solid`              in a table: the bar without its backslash

A file that is no page, such as the reference of the protocol, is printed as it is.
"""

import pathlib
import posixpath
import re
import sys
import xml.sax.saxutils

ROOT = pathlib.Path(__file__).resolve().parents[2]
FRONT = "README.md"

# The menu: group, then pages in order, each a file of the repository and its name, which is also its address.
GROUPS = {
    "Start": {
        "client/docs/tutorial.md": "tutorial",
        "client/docs/choosing.md": "choosing",
        "client/docs/exact.md": "exact",
        "client/docs/index.md": "all_pages",
    },
    "Use": {
        "client/docs/inputs-and-outputs.md": "inputs_and_outputs",
        "client/docs/sets.md": "sets",
        "client/docs/batch.md": "batch",
        "client/docs/command-line.md": "command_line",
        "client/docs/limits.md": "limits",
    },
    "Program": {
        "client/docs/sdk.md": "sdk",
        "server/docs/protocol.md": "protocol_guide",
        "": "protocol",  # made from the .proto file
        "proto/README.md": "proto",
    },
    "Serve": {
        "server/docs/running.md": "running",
        "server/docs/security.md": "security",
        "server/docs/operations.md": "operations",
    },
    "Deploy": {
        "deploy/README.md": "deploy",
        "deploy/docs/image.md": "image",
        "deploy/docs/compose.md": "compose",
        "deploy/docs/kubernetes.md": "kubernetes",
        "deploy/docs/slurm.md": "slurm",
        "deploy/scale/README.md": "scale",
    },
    "Measure": {
        "tests/bench/README.md": "bench",
        "tests/thesis/README.md": "thesis",
    },
    "Contribute": {
        ".github/CONTRIBUTING.md": "contributing",
        ".github/SECURITY.md": "report_a_vulnerability",
        "core/README.md": "core",
        "server/README.md": "server",
        "client/README.md": "client",
        "tests/README.md": "tests",
        "deploy/RELEASE.md": "release",
        "deploy/CHANGELOG.md": "changelog",
    },
}
NAMES = {path: name for group in GROUPS.values() for path, name in group.items() if path}


def inputs():
    """Returns the paths of all pages that are files of the repository."""
    return [FRONT, *NAMES]


def title_of(path):
    return re.search(r"^# (.*)$", (ROOT / path).read_text(), re.M)[1].replace("`", "")


def slugs(text):
    """Returns the headings' names on a repository's host, in order. Code blocks have no headings."""
    seen, found = {}, []
    for heading in re.findall(r"^#+ +(.*?) *$", re.sub(r"^ *```.*?^ *```$", "", text, flags=re.M | re.S), re.M):
        slug = re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
        seen[slug] = seen.get(slug, -1) + 1
        found.append(f"{slug}-{seen[slug]}" if seen[slug] else slug)
    return found


def section_name(path, slug):
    name = NAMES.get(path, "front")
    return re.sub(r"\W", "_", f"{name}_{slug}")


def link(text, target, path):
    """Returns a link of the page `path` for Doxygen."""
    file, _, slug = target.partition("#")
    file = posixpath.normpath(posixpath.join(posixpath.dirname(path), file)) if file else path
    if file == "proto/latvox/v1/voxelizer.proto":
        return f"[{text}](#protocol)"
    if header_or_example := re.fullmatch(r"client/(?:include/(latvox/.*\.h)|examples/(.*\.cc))", file):
        return f'\\ref {header_or_example[1] or header_or_example[2]} "{text.strip("`")}"'
    if file not in NAMES and file != FRONT:
        return f"`{file}`" if text.strip("`") in (file, posixpath.basename(file)) else f"{text} (`{file}`)"
    if slug and slug not in slugs((ROOT / file).read_text())[:1]:  # the first heading is the page
        return f"[{text}](#{section_name(file, slug)})"
    return f"[{text}](index.html)" if file == FRONT else f"[{text}](#{NAMES[file]})"


def in_a_table(line):
    """Doxygen 1.9.4 shows the backslash of an escaped bar within code."""
    return re.sub(
        r"`([^`]*\\\|[^`]*)`",
        lambda code: f"<code>{xml.sax.saxutils.escape(code[1]).replace(chr(92) + '|', '&#124;')}</code>",
        line,
    )


def with_links(path, text):
    """Replaces the links of a text without code blocks. A link may stand in the text, but not in code. Its own text may
    hold code, and go on in the next line; then the link stays in as many lines."""

    def replaced(found):
        if found["code"]:
            return found["code"]
        return link(found["text"].replace("\n", " "), found["target"], path) + "\n" * found["text"].count("\n")

    return re.sub(r"(?<!!)\[(?P<text>[^\[\]]+)\]\((?P<target>[^)\s:]+)\)|(?P<code>`[^`\n]*`)", replaced, text)


def filtered(path, text):
    """Returns the page's text for Doxygen, with as many lines as it has."""
    names, out = iter(slugs(text)), []

    def named(heading):
        slug, is_title = next(names), heading[1] == "#"
        name = NAMES.get(path, "mainpage") if is_title else section_name(path, slug)
        return f"{heading[1]} {heading[2].replace('`', '') if is_title else heading[2]} {{#{name}}}"

    # Odd pieces are code blocks.
    for n, piece in enumerate(re.split(r"(^ *```.*?^ *```$)", text, flags=re.M | re.S)):
        if n % 2 == 0:
            piece = re.sub(r"^(#+) +(.*?) *$", named, piece, flags=re.M)
            piece = with_links(path, piece)
            piece = re.sub(r"^\|.*$", lambda row: in_a_table(row[0]), piece, flags=re.M)
        out.append(piece)
    return "".join(out)


def layout():
    """Returns Doxygen's layout: the menu, and the tree beside each page."""

    def tab(name, title):
        return f"<tab type='user' url='@ref {name}' title={xml.sax.saxutils.quoteattr(title)}/>"

    groups = "".join(
        f"<tab type='usergroup' title='{group}'>"
        + "".join(tab(name, title_of(path) if path else "Protocol reference") for path, name in pages.items())
        + ("<tab type='classlist' title='SDK: classes'/><tab type='namespacelist' title='SDK: names'/>"
           "<tab type='filelist' title='SDK: headers'/><tab type='examples' title='SDK: examples'/>"
           if group == "Program" else "")
        + "</tab>"
        for group, pages in GROUPS.items()
    )  # fmt: skip
    return f"<doxygenlayout version='1.0'><navindex><tab type='mainpage' title='latvox'/>{groups}</navindex></doxygenlayout>\n"


def main(name):
    path, text = pathlib.Path(name).resolve(), pathlib.Path(name).read_text()
    known = path.is_relative_to(ROOT) and path.relative_to(ROOT).as_posix() in inputs()
    print(filtered(path.relative_to(ROOT).as_posix(), text) if known else text, end="")


if __name__ == "__main__":
    main(*sys.argv[1:])
