"""Reads the mesh files of Debian's and npm's packages with latvox and with readers of others, and compares the facts.

Usage: corpus.py [--all] [PACKAGE...]   --all: also packages that are not installed
"""

import collections
import concurrent.futures
import gzip
import os
import pathlib
import sys
import tempfile
import time

import exceptions
import readers
import sources
from compare import compare


class Result:
    def __init__(self, file, ours, theirs, reference, entries):
        self.file = file
        self.ours = ours
        self.theirs = theirs
        self.reference = reference
        self.difference = compare(ours, theirs)
        self.entry = exceptions.entry_of(file, entries)

    def kind(self):
        if self.difference is not None:
            return "explained" if self.entry and self.entry.explains(self.difference) else "unexplained"
        return "refused by both" if "error" in self.ours else "equal"


def read_both(file, others):
    """Reads a file with latvox, which unpacks gzip by itself, and with another reader, for which it is unpacked."""
    extension = sources.extension_of(file.name)
    ours = readers.read_latvox(file.path)
    if file.path.suffix.lower() != ".gz":
        return ours, *others.read(file.path, extension)
    with tempfile.TemporaryDirectory(prefix="latvox-") as folder:
        unpacked = pathlib.Path(folder) / file.path.stem
        unpacked.write_bytes(gzip.decompress(file.path.read_bytes()))
        return ours, *others.read(unpacked, extension)


def read_all(files, entries):
    others = readers.Readers()
    try:
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(lambda file: Result(file, *read_both(file, others), entries), files))
    finally:
        others.close()


KINDS = ("equal", "explained", "refused by both", "unexplained")


def table(title, groups):
    lines = [f"| {title} | files | {' | '.join(KINDS)} |", "|---" * (2 + len(KINDS)) + "|"]
    for name, results in sorted(groups.items()):
        counts = collections.Counter(result.kind() for result in results)
        lines.append(f"| {name} | {len(results)} | {' | '.join(str(counts[kind]) for kind in KINDS)} |")
    return lines


def grouped(results, key):
    groups = collections.defaultdict(list)
    for result in results:
        groups[key(result)].append(result)
    return groups


def report(results):
    """Returns tables of counts, and a line for each file that is not equal."""
    lines = table("package", grouped(results, lambda result: result.file.package))
    lines += ["", *table("format", grouped(results, lambda result: sources.extension_of(result.file.name)))]
    lines += ["", *table("reference", grouped(results, lambda result: result.reference))]
    lines += ["", *table("all", {"": results})]
    for kind in KINDS[1:]:
        chosen = [result for result in results if result.kind() == kind]
        lines += ["", f"{kind.capitalize()}: {len(chosen)}", ""] if chosen else []
        for result in chosen:
            said = result.difference or f"latvox: {result.ours['error']}; {result.reference}: {result.theirs['error']}"
            lines.append(f"- {result.file}: {said}" + (f" -- {result.entry.reason}" if kind == "explained" else ""))
    return "\n".join(lines) + "\n"


def choose(arguments):
    names = {word for word in arguments if word != "--all"}
    listed = sources.read_sources()
    if unknown := names - {source.name for source in listed}:
        raise SystemExit(f"corpus: {' '.join(sorted(unknown))} is not in tests/corpus/sources")
    return [source for source in listed if source.name in names or (not names and ("--all" in arguments or source.registry == "test"))]


def main(arguments):
    start = time.monotonic()
    chosen = choose(arguments)
    files = [file for source in chosen for file in sources.mesh_files(source, readers.READERS)]
    empty = {source.name for source in chosen} - {file.package for file in files}
    entries = exceptions.read_entries()
    results = read_all(files, entries)
    text = report(results)
    sources.CACHE.mkdir(parents=True, exist_ok=True)
    (sources.CACHE / "report.md").write_text(text)
    print(text)
    complaints = [f"{name}: the package has no mesh file" for name in sorted(empty)]
    complaints += exceptions.outdated([(result.file, result.difference) for result in results], entries, {source.name for source in chosen})
    complaints += [f"{result.file}: {result.difference}" for result in results if result.kind() == "unexplained"]
    print(f"{len(files)} files in {time.monotonic() - start:.0f} s; {len(complaints)} complaints", *complaints, sep="\n")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
