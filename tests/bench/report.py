"""Writes the table of tests/bench/run as files: CSV, Markdown and a plot."""

import csv
import math
import os
import pathlib
import re
import subprocess
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "thesis"))
from plot import Chart, Series, figure  # noqa: E402

EXACT = {("cartesian", 0): "k = 0", ("cartesian", 1): "k = 1", ("cartesian", 2): "k = 2", ("bcc", 0): "BCC", ("fcc", 0): "FCC"}
LINES = {  # of the plot: program, lattice, separability, dash, color, marker
    "k = 0": ("exact", "cartesian", 0, "", "#D55E00", "circle"),
    "k = 2": ("exact", "cartesian", 2, "", "#0072B2", "square"),
    "BCC": ("exact", "bcc", 0, "", "#009E73", "diamond"),
    "OpenVDB": ("openvdb", "cartesian", 0, "2 4", "#222222", "circle"),
    "optimized incremental, k = 0": ("optimized-incremental", "cartesian", 0, "6 4", "#8E44AD", "square"),
}


def machine():
    """Returns the facts that the figures depend on, by name."""
    with open("/proc/cpuinfo") as cpuinfo:
        model = re.search(r"model name\s*:\s*(.*)", cpuinfo.read())

    def first_line(*command):
        return subprocess.run(command, capture_output=True, text=True).stdout.split("\n")[0]

    return {
        "processor": model[1] if model else "unknown",
        "cores": os.cpu_count(),
        "compiler": first_line("g++", "--version"),
        "commit": first_line("git", "describe", "--always", "--dirty", "--exclude", "*"),
    }


def write(table):
    """Writes all files. It is called after each block of rows, so an interrupted run keeps its results."""
    directory = table.directory
    write_csv(directory / "table.csv", table.rows)
    write_csv(directory / "streams.csv", table.streams)
    (directory / "table.md").write_text(markdown(table))
    (directory / "table.svg").write_text(figure(charts(table), columns=3, width=360))


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        for name, value in machine().items():
            file.write(f"# {name}: {value}\n")
        if rows:
            writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


class Rows:
    """Rows of the table by the case that they measure."""

    def __init__(self, table):
        self.by_key = {
            tuple(row[name] for name in ("mesh", "resolution", "lattice", "separability", "program", "simd", "threads")): row
            for row in table.rows
        }
        self.widest = table.simds[-1]

    def exact(self, mesh, resolution, lattice, simd=None, threads=1):
        return self.by_key.get((mesh, resolution, *lattice, "exact", simd or self.widest, threads))

    def other(self, mesh, resolution, lattice, program, threads=1):
        return self.by_key.get((mesh, resolution, *lattice, program, "", threads))


def number(value, unit=1.0):
    """Formats three significant digits, or a dash."""
    if value is None:
        return "–"
    value /= unit
    if value == 0 or abs(value) >= 100:
        return f"{value:.0f}"
    return f"{value:.{max(0, 2 - math.floor(math.log10(abs(value))))}f}"


def ms(row):
    return number(row["ms_min"] if row else None)


def ratio(row, to):
    return number(row["ms_min"] / to["ms_min"] if row and to else None)


def grid(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n"


def blocks(table):
    """Returns mesh and resolution of each block, in the order measured."""
    return list(dict.fromkeys((row["mesh"], row["resolution"]) for row in table.rows))


def markdown(table):
    rows = Rows(table)
    facts = machine()
    parts = [
        "# latvox: time and memory\n",
        f"{facts['processor']}, {facts['cores']} cores; {facts['compiler']}; commit {facts['commit']}.\n",
        "Milliseconds from the mesh in memory to all bricks in memory, minimum of interleaved repetitions (medians are in "
        f"`table.csv`), thinned to be minimal, digests equal to the scalar kernels' in all cells"
        f"{'' if not table.differing else ' BUT THOSE BELOW'}.\n",
        *(f"- **THE DIGEST DIFFERS**: {where}\n" for where in table.differing),
        f"## Summary: one thread, {rows.widest}\n",
        summary(table, rows),
        "![Time over resolution](table.svg)\n",
        "## Every cell\n",
        "Speed and memory are those of the widest kernels on one thread; memory is what the job took beyond the mesh, with all "
        "of the result.\n",
        every_cell(table, rows),
        "## Streams: bricks dropped as they come\n" if table.streams else "",
        streams(table) if table.streams else "",
        "## Notes\n" if table.notes else "",
        "".join(f"- {note}\n" for note in dict.fromkeys(table.notes)),
    ]
    return "\n".join(part for part in parts if part)


def summary(table, rows):
    header = ["mesh", "resolution", *EXACT.values(), "OpenVDB", "OpenVDB : k = 0", "optimized incremental, k = 0"]
    out = []
    for mesh, resolution in blocks(table):
        ours = {lattice: rows.exact(mesh, resolution, lattice) for lattice in EXACT}
        openvdb = rows.other(mesh, resolution, ("cartesian", 0), "openvdb")
        thesis = rows.other(mesh, resolution, ("cartesian", 0), "optimized-incremental")
        out.append([mesh, resolution, *map(ms, ours.values()), ms(openvdb), ratio(openvdb, ours["cartesian", 0]), ms(thesis)])
    return grid(header, out)


def every_cell(table, rows):
    more = [count for count in table.threads if count > 1]
    header = ["mesh", "resolution", "lattice", "voxels", *table.simds]
    header += [f"{count} threads" for count in more] + ["ns/triangle", "Mvoxels/s", "MB"]
    header += ["optimized incremental", "OpenVDB", "OpenVDB : ours"]
    out = []
    for mesh, resolution in blocks(table):
        for lattice, name in EXACT.items():
            best = rows.exact(mesh, resolution, lattice)
            if not best:
                continue
            openvdb = rows.other(mesh, resolution, lattice, "openvdb")
            line = [mesh, resolution, name, best["voxels"]]
            line += [ms(rows.exact(mesh, resolution, lattice, simd)) for simd in table.simds]
            for count in more:
                several = rows.exact(mesh, resolution, lattice, threads=count)
                line.append(f"{ms(several)} ({ratio(best, several)}×)")
            line += [number(best["ns_per_triangle"]), number(best["mvoxels_per_s"]), number(best["job_peak_mb"])]
            line += [ms(rows.other(mesh, resolution, lattice, "optimized-incremental")), ms(openvdb), ratio(openvdb, best)]
            out.append(line)
    return grid(header, out)


def streams(table):
    header = ["mesh", "arguments", "threads", "Mvoxels", "s", "ns/voxel", "peak of the process, MB", "bytes/triangle beyond the mesh"]
    header += ["first brick after", "cancelled within, ms"]
    out = []
    for row in table.streams:
        peak, first = row["job_peak_bytes"], row["ms_first_brick"]
        out.append(
            [row["mesh"], row["arguments"], row["threads"], number(row["voxels"], 1e6), number(row["ms_min"], 1e3)]
            + [number(row["ms_min"] * 1e6 / row["voxels"]) if row["voxels"] else "–", number(row["peak_rss_bytes"], 1e6)]
            + [number(peak / row["triangles"] if peak is not None else None)]
            + [f"{100 * first / row['ms_min']:.1f} %" if first else "–", number(row["ms_cancel"])]
        )
    return grid(header, out)


def charts(table):
    rows = Rows(table)
    resolutions = sorted({row["resolution"] for row in table.rows})
    names = {math.log2(resolution / resolutions[0]): str(resolution) for resolution in resolutions}
    for mesh in dict.fromkeys(row["mesh"] for row in table.rows):
        series = []
        for name, (program, lattice, k, dash, color, marker) in LINES.items():
            simd = rows.widest if program == "exact" else ""
            found = [(x, rows.by_key.get((mesh, int(label), lattice, k, program, simd, 1))) for x, label in names.items()]
            series.append(Series(name, color, [(x, row["ms_min"]) for x, row in found if row], dash, marker))
        yield Chart(mesh, "resolution", "ms, one thread", series, log=True, x_names=names)
