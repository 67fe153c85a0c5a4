#!/usr/bin/python3
"""Measures the English of pages and comments: the length of sentences, habits that cost a second reading, spelling, and
the length of lines.

Usage: tests/prose/prose.py [PATH ...]   prints a table of the files below these paths, then each finding
"""

import ast
import collections
import dataclasses
import io
import pathlib
import re
import subprocess
import sys
import tokenize

ROOT = pathlib.Path(__file__).resolve().parents[2]

LONG = 30  # words; longer sentences need a second reading
LONGEST = 45  # words; no sentence is longer
MEAN = 18  # words a sentence, at most, over a page or a room
LONG_SHARE = {"page": 0.08, "comment": 0.10}
HABITS_IN_10000_WORDS = 3
LINE = 120  # characters, of pages; clang-format bounds the lines of code
WHOLE_CODE = re.compile(r"\s*(?:- )?`[^`]*`:?")  # a line that is one piece of code
FEW = 12  # sentences; a mean over fewer says little

# Written by others, or by programs.
FOREIGN = {"client/tool/view/three.js", "tests/node/package-lock.json", "LICENSE"}
OWN_EXAMPLES = {"tests/prose/prose.py", "tests/prose/prose_test.py"}  # of bad English
FOREIGN_FOLDERS = ("proto/google/", "proto/released/", "tests/fuzz/corpus/")

HABITS = {
    "'of which'": re.compile(r"\bof (?:which|whom|those (?:that|which|who))\b", re.I),
    "'but for'": re.compile(r"\bbut for\b", re.I),
    "'for' in place of 'because'": re.compile(
        r"[,;] for (?:it|they|there|this|that|these|those|we|nobody|nothing|no one) (?:\w+)", re.I),
    "opens with 'Of'": re.compile(r"^Of (?!course)"),
    "a what-clause in place of a noun": re.compile(r"^What (?!if\b)[^?]*$|\b(?:than|of|by|from|with|for|in|beside) what\b", re.S),
    "'who has X, does Y'": re.compile(r"^(?:Who|Whoever)\b[^?]*$", re.S),
}  # fmt: skip

# British words to American ones; the rest of a word may follow.
SPELLING = {
    "colour": "color", "centre": "center", "centring": "centering", "neighbour": "neighbor", "behaviour": "behavior",
    "favour": "favor", "honour": "honor", "labelled": "labeled", "labelling": "labeling", "modelled": "modeled",
    "modelling": "modeling", "travelled": "traveled", "travelling": "traveling", "licence": "license", "grey": "gray",
    "metre": "meter", "millimetre": "millimeter", "kilometre": "kilometer", "centimetre": "centimeter", "fibre": "fiber",
    "artefact": "artifact", "analyse": "analyze", "catalogue": "catalog", "recognise": "recognize", "optimise": "optimize",
    "organise": "organize", "normalise": "normalize", "initialise": "initialize", "serialise": "serialize",
    "quantise": "quantize", "summarise": "summarize", "minimise": "minimize", "maximise": "maximize",
    "synchronise": "synchronize", "voxelise": "voxelize", "rasterise": "rasterize", "tokenise": "tokenize",
    "parallelise": "parallelize", "whilst": "while", "amongst": "among", "misspelt": "misspelled", "learnt": "learned",
    "spelt": "spelled", "defence": "defense", "offence": "offense", "judgement": "judgment", "sceptic": "skeptic",
    "tyre": "tire", "cheque": "check", "mould": "mold", "plough": "plow", "ageing": "aging", "unlabelled": "unlabeled",
}  # fmt: skip
BRITISH = re.compile(rf"(?<![A-Za-z-])({'|'.join(SPELLING)})", re.I)
AMERICAN_AS_WELL = re.compile(r"aria-labelledby|metrein", re.I)


@dataclasses.dataclass
class Sentence:
    """A sentence, and the line where its paragraph begins."""

    line: int
    text: str

    @property
    def words(self):
        return sum(bool(re.search(r"[^\W_]", word)) for word in self.text.split())


# --- Paragraphs: (line, text) ---------------------------------------------------------------------------------------


def paragraphs_of_page(text):
    """Paragraphs, list items and table cells of Markdown; code is one word."""
    fence, at, words = None, 0, []

    def flush():
        nonlocal words
        whole, words = " ".join(words), []
        return [(at, whole)] if whole else []

    for number, line in enumerate(text.splitlines(), 1):
        mark = re.match(r"\s*(```+|~~~+)", line)
        if fence or mark:
            yield from flush()
            fence = None if fence and mark and mark[1].startswith(fence) else fence or mark[1]
            continue
        stripped = line.strip()
        is_item = re.match(r"([-*+]|\d+[.)])\s+", stripped)
        if not stripped or stripped.startswith(("#", "<", "|", "![", "@")) or is_item:
            yield from flush()
        if stripped.startswith("|") and not re.fullmatch(r"[|:\s-]+", stripped):
            yield from ((number, cell.strip()) for cell in re.split(r"(?<!\\)\|", stripped) if cell.strip())
        elif stripped and not stripped.startswith(("#", "<", "|", "![", "@")):
            if not words:
                at = number
            words.append(stripped[is_item.end() :] if is_item else stripped)
    yield from flush()


def paragraphs_of_comments(lines):
    """Paragraphs of comments' lines: (number, whether code stands before it, text after its mark). Comments behind code,
    and indented lines, which are lists and formulas, are paragraphs by themselves."""
    at, words, previous, indent = 0, [], None, 0

    def flush():
        nonlocal words
        whole, words = " ".join(words), []
        return [(at, whole)] if whole else []

    for number, behind_code, text in lines:
        deep = len(text) - len(text.lstrip())
        stripped = text.strip()
        begins = re.match(r"[-*+]\s+|\d+[.)]\s+|\S+(?:, \S+)*\s{2,}", stripped)  # an item, or the name in a table's row
        is_more = words and previous == number - 1 and stripped and not begins and not behind_code and deep == indent
        if not is_more:
            yield from flush()
            at, indent = number, deep + (begins.end() if begins else 0)
        if stripped:
            words.append(stripped[begins.end() :] if begins else stripped)
        previous = None if behind_code else number
    yield from flush()


STRINGS = r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''


def marked_comments(text, mark):
    """The lines of comments that begin with `mark` and end with the line."""
    finder = re.compile(rf'R"(\w*)\(.*?\)\1"|{STRINGS}|{mark}(?P<text>[^\n]*)', re.S)
    for found in finder.finditer(text):
        if found["text"] is not None:
            before = text[text.rfind("\n", 0, found.start()) + 1 : found.start()]
            yield text.count("\n", 0, found.start()) + 1, bool(before.strip()), found["text"].removeprefix(" ")


def messages(text):
    """The strings of C++, adjacent ones joined, as paragraphs. Comments are skipped, because quotes in them open no string."""
    for found in re.finditer(rf'//[^\n]*|R"(\w*)\(.*?\)\1"|(?P<text>(?:(?:{STRINGS})\s*)+)', text, re.S):
        if found["text"]:
            parts = re.findall(STRINGS, found["text"])
            yield text.count("\n", 0, found.start()) + 1, "".join(part[1:-1] for part in parts)


def comments_of_python(text):
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and not token.string.startswith("#!"):
            yield token.start[0], bool(token.line[: token.start[1]].strip()), token.string[1:].removeprefix(" ")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            body = node.body[0] if node.body else None
            if isinstance(body, ast.Expr) and isinstance(getattr(body.value, "value", None), str):
                for number, line in enumerate(body.value.value.splitlines(), body.lineno):
                    yield number, False, line.strip()


MARKS = {".h": "//", ".cc": "//", ".inc": "//", ".proto": "//", ".js": "//", ".mjs": "//", ".cpp": "//"}
HASHES = {".cmake", ".sh", ".yaml", ".yml", ".toml", ".cfg", ".txt", ".in", ".conf"}


def paragraphs(path, text):
    """(kind, paragraphs) of a file of ours: kind is "page" or "comment"; None: it has no prose."""
    first = text.split("\n", 1)[0]
    if path.suffix == ".md":
        return "page", list(paragraphs_of_page(text))
    if path.suffix in MARKS:
        return "comment", list(paragraphs_of_comments(marked_comments(text, MARKS[path.suffix] + "+")))
    if path.suffix == ".py" or (first.startswith("#!") and "python" in first):
        return "comment", list(paragraphs_of_comments(sorted(comments_of_python(text))))
    if path.suffix in HASHES or path.name == "Containerfile" or re.match(r"#!.*\b(ba|da)?sh\b", first):
        return "comment", list(paragraphs_of_comments(marked_comments(text, r"(?:(?<=\s)|^)#(?![!:])".replace("^", r"(?<![\s\S])"))))
    return None


# --- Sentences --------------------------------------------------------------------------------------------------------

ABBREVIATION = re.compile(r"\b(?:e\.g|i\.e|etc|cf|vs|Fig|Eq|No|Dr|approx)\.$")


def plain(text):
    """Without marks: code, and the targets of links, are one word or none."""
    text = re.sub(r"``[^`]+``|`[^`]*`", "Code", text)  # which may begin a sentence
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"https?://\S+", "link", text)
    return re.sub(r"[*_]{2,}|(?<!\w)[*_](?=\w)|(?<=\w)[*_](?!\w)", "", text)


def is_prose(text):
    """Not a formula, a separator, or a line for a program."""
    words = text.split()
    return len(words) >= 3 and sum(bool(re.fullmatch(r"\W*[A-Za-z][a-z'’-]+\W*", word)) for word in words) >= 0.6 * len(words)


def sentences(paragraph):
    line, text = paragraph
    text, begin = plain(text), 0
    for end in re.finditer(r"[.!?][)\"”']*(?=\s+[\"“(\[]?[A-Z0-9`]|\s*$)|$", text):
        piece = text[begin : end.end()].strip()
        if ABBREVIATION.search(piece):
            continue
        begin = end.end()
        if is_prose(piece):
            yield Sentence(line, piece)


@dataclasses.dataclass
class File:
    """What one file says: its sentences, and what is wrong with single lines."""

    path: str
    kind: str
    sentences: list
    findings: list  # (line, message); a habit's message begins with "habit: "

    @property
    def room(self):
        """A page stands for itself; comments are judged with those of their folder."""
        return self.path if self.kind == "page" else str(pathlib.Path(self.path).parent)


def habits_of(sentence):
    return [name for name, pattern in HABITS.items() if pattern.search(sentence.text.lstrip("\"'( "))]


def read(path, text):
    """The File of a text, or None where it has no prose."""
    found = paragraphs(pathlib.Path(path), text)
    if found is None:
        return None
    kind, blocks = found
    file = File(path, kind, [sentence for block in blocks for sentence in sentences(block)], [])
    for sentence in file.sentences:
        if sentence.words > LONGEST:
            file.findings.append((sentence.line, f"{sentence.words} words in a sentence, {LONGEST} are allowed: {sentence.text}"))
        file.findings += [(sentence.line, f"habit: {name}: {sentence.text}") for name in habits_of(sentence)]
    if pathlib.Path(path).suffix in (".h", ".cc"):
        said = [sentence for message in messages(text) for sentence in sentences(message)]
        file.findings += [(each.line, f"habit: {name}: {each.text}") for each in said for name in habits_of(each)]
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        for word in BRITISH.findall(AMERICAN_AS_WELL.sub("", line)):
            file.findings.append((number, f"spelling: {word} is {SPELLING[word.lower()]} in American English"))
        fenced ^= bool(re.match(r"\s*```", line))
        breakable = not (WHOLE_CODE.fullmatch(line) or (line.startswith("|") and path != "README.md"))
        if kind == "page" and len(line) > LINE and not fenced and breakable:
            file.findings.append((number, f"{len(line)} characters in a line, {LINE} are allowed"))
    file.findings.sort()
    return file


def tracked(paths):
    """Files of git below these paths, as texts."""
    # -z: names as they are. Not yet added ones count, too.
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", *paths],
                            cwd=ROOT, capture_output=True, text=True, check=True).stdout  # fmt: skip
    for name in sorted(set(filter(None, listed.split("\0")))):
        if name in FOREIGN | OWN_EXAMPLES or name.startswith(FOREIGN_FOLDERS) or not (ROOT / name).is_file():
            continue
        try:
            yield name, (ROOT / name).read_text()
        except UnicodeDecodeError:
            continue


def read_tree(paths=()):
    return [file for name, text in tracked(paths) if (file := read(name, text)) is not None]


@dataclasses.dataclass
class Measure:
    """A page, or the comments of a folder."""

    count: int
    mean: float  # words a sentence
    long_share: float  # of sentences of more than LONG words

    @classmethod
    def of(cls, found):
        words = [sentence.words for sentence in found]
        count = max(len(words), 1)
        return cls(len(words), sum(words) / count, sum(n > LONG for n in words) / count)


def measures(files):
    """Measures by (room, kind)."""
    rooms = collections.defaultdict(list)
    for file in files:
        rooms[file.room, file.kind] += file.sentences
    return {key: Measure.of(found) for key, found in sorted(rooms.items())}


def judge(files):
    """All that is too much, a line each. A habit is told only where they are too many."""
    out = []
    for (room, kind), measure in measures(files).items():
        if measure.count < FEW:
            continue
        if measure.mean > MEAN:
            out.append(f"{room}: {measure.mean:.1f} words a sentence ({kind}s), {MEAN} are allowed")
        if measure.long_share > LONG_SHARE[kind]:
            share = f"{100 * measure.long_share:.0f} % of sentences"
            out.append(f"{room}: {share} ({kind}s) have more than {LONG} words, {100 * LONG_SHARE[kind]:.0f} % are allowed")
    words = sum(sentence.words for file in files for sentence in file.sentences)
    habits = [each for file in files for each in file.findings if each[1].startswith("habit: ")]
    too_many = len(habits) > HABITS_IN_10000_WORDS * max(words, 10000) / 10000
    for file in files:
        out += [f"{file.path}:{line}: {text}" for line, text in file.findings if too_many or not text.startswith("habit: ")]
    return out


def main():
    files = read_tree(sys.argv[1:])
    for (room, kind), measure in measures(files).items():
        print(f"{measure.count:6} sentences {measure.mean:6.1f} words {100 * measure.long_share:5.1f} % long  {kind:8} {room}")
    for file in files:
        long = [(each.line, f"{each.words} words: {each.text}") for each in file.sentences if LONG < each.words <= LONGEST]
        for line, text in sorted([*file.findings, *long]):
            print(f"{file.path}:{line}: {text}")
    return 1 if judge(files) else 0


if __name__ == "__main__":
    sys.exit(main())
