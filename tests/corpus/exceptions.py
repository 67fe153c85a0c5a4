"""The differences that have a reason: the list `exceptions`."""

import dataclasses
import pathlib
import platform
import re

HERE = pathlib.Path(__file__).resolve().parent
RELEASE = platform.freedesktop_os_release().get("VERSION_CODENAME")


def matches(pattern, text):
    """Returns whether they are equal; * stands for any text."""
    return re.fullmatch(".*".join(re.escape(part) for part in pattern.split("*")), text, re.DOTALL) is not None


@dataclasses.dataclass(frozen=True)
class Entry:
    files: str  # a pattern of MeshFile's text
    expected: str  # a pattern of the difference
    reason: str
    release: str | None = None  # of Debian, the only one whose package has the files

    def names(self, file):
        return matches(self.files, str(file))

    def explains(self, difference):
        return difference is not None and matches(self.expected, difference)


def parse(text):
    """Returns the entries of paragraphs: the files, with the one release of Debian that has them, as in "[trixie]"; the
    expected difference; and the reason in one or more lines."""
    entries = []
    for paragraph in text.split("\n\n"):
        lines = [line for line in paragraph.splitlines() if not line.startswith("#")]
        if not lines:
            continue
        if len(lines) < 3:
            raise SystemExit(f"corpus: the entry {lines} has fewer than three lines")
        files, _, release = lines[0].strip().removesuffix("]").partition(" [")
        reason = " ".join(line.strip() for line in lines[2:])
        entries.append(Entry(files, lines[1].strip(), reason, release or None))
    return entries


def read_entries():
    return parse((HERE / "exceptions").read_text())


def entry_of(file, entries):
    return next((entry for entry in entries if entry.names(file)), None)


def outdated(results, entries, packages):
    """Returns complaints about entries that no longer apply, as far as their packages were read.

    results  pairs of a file and its difference
    """
    complaints = []
    for entry in entries:
        if entry.files.split()[0] not in packages or entry.release not in (None, RELEASE):
            continue
        named = [(file, difference) for file, difference in results if entry_of(file, entries) is entry]
        if not named:
            complaints.append(f"{entry.files}: an exception for no file")
        complaints += [f"{file}: an exception, and the readers agree" for file, difference in named if difference is None]
    return complaints
