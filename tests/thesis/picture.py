"""The figure of README.md, from the data that are checked in beside it.

Usage: picture.py DIRECTORY     draws DIRECTORY/chapter5.svg from DIRECTORY/chapter5.csv
"""

import csv
import pathlib
import statistics
import sys

from data import ALGORITHMS, IDEAL, QUICK_STEP
from plot import Chart, Series, figure
from verdict import NAMES

CASE = ("bcc", "0")
RESOLUTION = "lattice resolution D"
# Wide below narrow, and large markers below small ones: where curves coincide, all of them can be seen.
STYLE = {
    "brute-force": dict(color="#8a8a8a", marker="square", width=6, size=4.6),
    "incremental": dict(color="#0072B2", marker="circle", width=3.6, size=3.6),
    "optimized-incremental": dict(color="#D55E00", marker="diamond", width=1.8, size=1.9, dash="6 4"),
    "exact": dict(color="#8E44AD", marker="circle", width=1.6, size=1.5),
}


def series(algorithm, points, band=()):
    return Series(NAMES[algorithm], points=points, band=list(band), **STYLE[algorithm])


def rows_of(data):
    """Returns the rows of chapter5.csv, as text. Counts over the angles of a quick run stand beside means over all."""
    for algorithm in ALGORITHMS:
        for d in data.resolutions:
            by_angle = sorted(data.accuracy[CASE, algorithm, d], key=lambda run: float(run["degrees"]))
            runs = by_angle[:: 1 if data.quick else QUICK_STEP]
            times = [1e3 * x for x in data.times(CASE, algorithm, d, "seconds")] if d in data.timed else []
            yield {
                "algorithm": algorithm,
                "resolution": str(d),
                "displaced_volume": f"{data.mean(CASE, algorithm, d, 'displaced_volume'):.6f}",
                "redundant_percent": f"{100 * data.mean(CASE, algorithm, d, 'redundant') / data.mean(CASE, algorithm, d, 'voxels'):.4f}",
                "median_ms": f"{statistics.median(times):.4f}" if times else "",
                "least_ms": f"{min(times):.4f}" if times else "",
                "most_ms": f"{max(times):.4f}" if times else "",
                **{
                    f"quick_{column}": str(sum(int(run[column]) for run in runs))
                    for column in ("voxels", "redundant", "tunnels", "tunnels_rounded")
                },
                "quick_inside": str(sum(round(float(run["displaced_volume"]) * int(run["points"])) for run in runs)),
            }


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write(path, rows):
    rows = list(rows)
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def draw(rows):
    """Returns one row of charts, for BCC: displaced volume, redundant voxels and time."""

    def lines(column, low="", high=""):
        for algorithm in ALGORITHMS:
            found = [row for row in rows if row["algorithm"] == algorithm and row[column]]
            band = [(int(row["resolution"]), float(row[low]), float(row[high])) for row in found] if low else []
            yield series(algorithm, [(int(row["resolution"]), float(row[column])) for row in found], band)

    charts = [
        Chart("ΔV, as in figures 5.11 to 5.15 (BCC)", RESOLUTION, "share of the box", list(lines("displaced_volume")), (IDEAL, "ideal ΔV")),
        Chart("Redundant voxels (BCC)", RESOLUTION, "percent", list(lines("redundant_percent"))),
        Chart("Time, as in figure 5.17 (BCC)", RESOLUTION, "milliseconds", list(lines("median_ms", "least_ms", "most_ms")), log=True),
    ]
    return figure(charts, columns=3, width=360, height=270)


def main(directory):
    (directory / "chapter5.svg").write_text(draw(read(directory / "chapter5.csv")), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
