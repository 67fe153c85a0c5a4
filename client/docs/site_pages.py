"""Turns Doxygen's pages into the site: adds the navigation to each page, and writes the index of the search."""

import html
import html.parser
import json
import pathlib
import re

import contents

SHORT = 26  # characters of code in one line
SDK = "client_8h.html"  # stands in the part of the navigation to which all pages made of headers belong
LISTS = re.compile(r"(annotated|classes|dir_|examples|files|functions|globals|namespacemembers|namespaces)|-members\.html$")


def resolved(items):
    """Returns the items as (title, file) or (title, items)."""
    found = []
    for item in items:
        if isinstance(item, str):
            found.append((contents.title(item), contents.name(item) + ".html"))
        else:
            found.append((item[0], item[1] if isinstance(item[1], str) else resolved(item[1])))
    return found


def files(items):
    """Yields the files that the items name, in order."""
    for _, part in items:
        if isinstance(part, str):
            yield part
        else:
            yield from files(part)


def tree(items, file, known):
    """Returns the navigation as HTML, opened where the page stands. Pages that it does not name belong to the SDK."""
    out = ["<ul>"]
    for title, part in items:
        title = html.escape(title)
        if isinstance(part, str):
            out.append(f'<li><a href="{part}"{" aria-current=page" * (part == file)}>{title}</a></li>')
        else:
            here = (file if known else SDK) in files(part)
            out.append(f"<li><details{' open' * here}><summary>{title}</summary>{tree(part, file, known)}</details></li>")
    return "".join([*out, "</ul>"])


class Sections(html.parser.HTMLParser):
    """Collects a page's sections as [anchor, heading, text]."""

    def __init__(self):
        super().__init__()
        self.found, self.heading = [["", "", ""]], None

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "a" and self.heading and attributes.get("class") == "anchor":
            self.found[-1][0] = attributes["id"]
        elif tag == "a" and self.heading == "h2" and attributes.get("href", "").startswith("#"):
            self.found[-1][0] = attributes["href"][1:]  # a member of the SDK
        elif tag in ("h1", "h2", "h3"):
            self.heading = tag
            self.found.append(["", "", ""])

    def handle_endtag(self, tag):
        if tag == self.heading:
            self.heading = None

    def handle_data(self, data):
        self.found[-1][1 if self.heading else 2] += data


def sections(file, text):
    """Yields what the search finds on a page: [address, title of the page, heading, text]."""
    title = re.search(r'<div class="title">(.*?)</div>', text, re.S)
    title = html.unescape(re.sub(r"<[^>]*>", "", title[1])).strip() if title else file
    parser = Sections()
    body = text.partition('<div class="contents">')[2] or text.partition('<div class="textblock">')[2]
    parser.feed(re.sub(r'<details class="toc">.*?</details>', "", body.partition("</main>")[0], flags=re.S))
    for anchor, heading, words in parser.found:
        heading, words = (" ".join(part.replace("◆", " ").split()) for part in (heading, words))
        if words or heading:
            yield [f"{file}#{anchor}" if anchor else file, title, heading, words]


def completed(text):
    """Returns the page with a table of contents that opens, and without breaks in short code."""
    text = re.sub(r'<div class="toc"><h3>[^<]*</h3>(.*?)</div>',
                  r'<details class="toc"><summary>On this page</summary>\1</details>', text, flags=re.S)  # fmt: skip
    text = re.sub(r'(<td class="memItemLeft"[^>]*>)(?:&#160;|\s)*</td>', r"\1</td>", text)
    text = re.sub(r'(<p>[^<]*</p>)(\s*<div class="textblock">)\1', r"\2\1", text)  # Doxygen repeats what is brief
    return re.sub(rf"<code>([^<]{{1,{SHORT}}})</code>", r'<code class="short">\1</code>', text)


def finish(out):
    """Completes the pages in the folder."""
    items = resolved(contents.contents())
    order = {file: n for n, file in enumerate(files(items))}
    index = []
    for path in sorted(pathlib.Path(out).glob("*.html"), key=lambda path: (order.get(path.name, order[SDK]), path.name)):
        text = completed(path.read_text())
        navigation = tree(items, path.name, path.name in order)
        text = text.replace('<nav id="navigation"></nav>', f'<nav id="navigation">{navigation}</nav>')
        path.write_text(text)
        if not LISTS.search(path.name):
            index += sections(path.name, text)
    (pathlib.Path(out) / "search_index.js").write_text(f"const SECTIONS = {json.dumps(index, ensure_ascii=False)};\n")
