"""Makes the page of tests/thesis/run from the tables that thesis_reproduce wrote.

Usage: page.py DIRECTORY [NOTE ...]     each note is a warning to show
Writes DIRECTORY/index.html, which needs no other file, and DIRECTORY/chapter5.csv and .svg, the figure of README.md.
Exits with 1 if a claim about the exact algorithm does not hold.
"""

import collections
import html
import pathlib
import platform
import re
import statistics
import sys

import picture
from claims import all_claims
from data import ALGORITHMS, CASES, IDEAL, Data, mean
from model_claims import BUNNY
from picture import RESOLUTION, series
from plot import Chart, Series, figure
from verdict import FAILS, HOLDS, NAMES, OBSERVED, OURS, UNDECIDED, UNTESTED, percent

VOLUME, RATIO = "#0072B2", "#D55E00"
CLASSES = {HOLDS: "yes", FAILS: "no", UNDECIDED: "open", UNTESTED: "open", "": "seen"}
PLURALS = {HOLDS: "hold", FAILS: "do not hold", UNDECIDED: "are undecided", UNTESTED: "are not tested"}

CSS = """
:root { color-scheme: light dark; --ink: #222; --paper: #fff; --faint: #666; --rule: #ccc; --box: #f7f7f7; --yes: #117733; --no: #b03a2e; --open: #7a5c00; --warn: #fff3cd }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e4e4; --paper: #181818; --faint: #a6a6a6; --rule: #444; --box: #222; --yes: #5fd08a; --no: #ff8a7a; --open: #e6c34d; --warn: #3d3210 } a { color: #8ab4f8 } }
body { font: 16px/1.5 Helvetica, Arial, sans-serif; color: var(--ink); background: var(--paper); max-width: 1000px; margin: 2em auto; padding: 0 1em }
h1 { margin-bottom: 0 } h2 { margin-top: 2.2em; border-bottom: 1px solid var(--rule) } svg { max-width: 100%; height: auto }
.wide { overflow-x: auto } .charts { display: flex; flex-wrap: wrap; gap: .5em }
table { border-collapse: collapse; margin: 1em 0; font-size: 14px } th, td { border-bottom: 1px solid var(--rule); padding: .35em .6em; vertical-align: top; text-align: left }
td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap } td.m { font-family: monospace; white-space: pre }
.yes, .no, .open { font-weight: bold; white-space: nowrap } .yes { color: var(--yes) } .no { color: var(--no) } .open { color: var(--open) }
.claim { border-left: 4px solid var(--open); padding: .1em 1em; margin: 1em 0; background: var(--box); font-size: 15px; overflow-wrap: anywhere }
.claim.is-yes { border-color: var(--yes) } .claim.is-no { border-color: var(--no) } .claim.is-seen { border-color: var(--rule) } .claim p { margin: .4em 0 }
.faint { color: var(--faint); font-size: 14px } .warning { background: var(--warn); padding: .6em 1em }
"""


def text(value):
    return html.escape(str(value))


def panels(charts):
    """Returns charts side by side, or one below the other where there is no room."""
    return "<div class='charts'>" + "".join(figure([chart], columns=1) for chart in charts) + "</div>"


def titles(first, second):
    """Returns the title of each case's chart: the thesis shows k = 2 and 1 in one figure, k = 0 and BCC in the next."""
    numbers = (f"{first} (a)", f"{first} (b)", f"{second} (a)", f"{second} (b)") if first else [""] * 4
    return {case: f"Figure {number}: {CASES[case]}" if number else f"Not in the thesis: {CASES[case]}" for case, number in zip(CASES, numbers)}


def ratio_charts(data, algorithm, names):
    for case, title in names.items():
        spread = [(d, data.values(case, algorithm, d, "displaced_volume")) for d in data.resolutions]
        band = [(d, min(v), max(v)) for d, v in spread]
        volume = Series("ΔV, mean and range over the angles", VOLUME, [(d, mean(v)) for d, v in spread], band=band)
        points = [(d, data.mean(case, algorithm, d, "r")) for d in data.resolutions]
        ratio = Series("R, mean", RATIO, points, "6 4", "square")
        yield Chart(title, RESOLUTION, "share", [volume, ratio], (IDEAL, "ideal ΔV"))


def share_charts(data, column, label, names):
    for case, title in names.items():
        lines = [
            series(a, [(d, data.mean(case, a, d, column) / data.mean(case, a, d, "voxels")) for d in data.resolutions])
            for a in ALGORITHMS
        ]
        yield Chart(title, RESOLUTION, label, lines)


def measured(data, measure):
    """Returns the medians of the rounds, and their ranges."""
    values = [(d, measure(d)) for d in data.timed]
    return [(d, statistics.median(v)) for d, v in values], [(d, min(v), max(v)) for d, v in values]


def time_charts(data, measure, label, names):
    for case, title in names.items():
        lines = [series(a, *measured(data, lambda d, a=a, case=case: measure(case, a, d))) for a in ALGORITHMS]
        yield Chart(title, RESOLUTION, label, lines, log=True)


def lead_charts(data, names):
    for case, title in names.items():
        lines = []
        for name, column, color, dash, marker in (
            ("whole algorithm", "array_seconds", "#0072B2", "", "circle"),
            ("triangles alone", "scan_seconds", "#D55E00", "6 4", "square"),
        ):
            points, band = measured(data, lambda d, case=case, column=column: [100 * x for x in data.leads(case, d, column)])
            lines.append(Series(name, color, points, dash, marker, band))
        yield Chart(title, RESOLUTION, "lead, percent", lines, (11, "thesis: around 11 %"))


def place(claim):
    if claim.where in (OURS, OBSERVED):
        return {OURS: "Of this program.", OBSERVED: "Observed."}[claim.where]
    kind = {"4": "Tables ", "5": "Figures " if "," in claim.where or "–" in claim.where else "Figure "}.get(claim.where[0], "")
    return kind + claim.where + "."


def number(value, digits=0):
    return f"<td class=n>{value:,.{digits}f}"


class Page:
    def __init__(self, data, notes):
        self.data, self.parts, self.shown = data, [], 0
        self.claims = all_claims(data)
        self.header(notes)
        self.summary()
        self.ratio_figures()
        self.counts()
        self.timing_figures()
        self.bunny()
        self.tables()
        self.differences()
        assert self.shown == len(self.claims), "a claim is not on the page, or twice"

    def add(self, *parts):
        self.parts += parts

    def claims_of(self, pattern):
        for claim in self.claims:
            if re.search(pattern, claim.where) or re.search(pattern, claim.says):
                self.claim(claim)

    def claim(self, claim):
        self.shown += 1
        name = CLASSES[claim.verdict]
        verdict = f"<span class='{name}'>{claim.verdict}</span>." if claim.verdict else ""
        why = f"<p>{text(claim.why)}</p>" if claim.why and claim.verdict == FAILS else ""
        note = f"<p>{text(claim.note)}</p>" if claim.note else ""
        judged = "Criterion" if claim.verdict else "Counted"
        self.add(
            f"<div class='claim is-{name}'><p><b>{text(place(claim))}</b> {text(claim.says)} {verdict}</p>{why}{note}"
            f"<p class='faint'>{judged}: {text(claim.criterion)}.<br>Measured: {text(claim.measured)}.</p></div>"
        )

    def table(self, header, rows):
        """Adds a table that scrolls where it is wider than the page. Cells are HTML, with their attributes."""
        head = "".join(f"<th>{cell}" for cell in header)
        body = "".join("<tr>" + "".join(cells) for cells in rows)
        self.add(f"<div class='wide'><table><tr>{head}{body}</table></div>")

    def header(self, notes):
        d = self.data
        self.add(
            "<h1>The thesis's chapter 5, again</h1>",
            "<p>Haris Widjaya, <i>Accurate incremental voxelization in common sampling lattices</i>, Simon Fraser University, 2006: "
            "its experiments with the thesis's three algorithms, as this program implements them, and with this program's exact one. "
            "Made by <code>tests/thesis/run</code>; every verdict is computed from the tables beside this page.</p>",
            f"<p class='faint'>{d.settings['angles']} angles, D from {d.resolutions[0]} to {d.top} in {len(d.resolutions)} steps, 4 lattices and "
            f"neighborhoods, 4 algorithms: {int(d.settings['angles']) * len(d.resolutions) * 16:,} tetrahedra. Times: {d.settings['timed_angles']} of the "
            f"angles, {len(d.timed)} resolutions. {text(processor())}; counted on {d.settings['threads']} threads in {float(d.settings['seconds']):.0f} s. "
            "Tables: " + ", ".join(f"<a href='{n}.csv'>{n}.csv</a>" for n in ("accuracy", "precision", "models", "tables", "settings"))
            + ", timing-N.csv and orientation-N.csv for each round N.</p>",
        )
        if d.quick:
            notes = ["This is a quick run with few angles and resolutions. Claims that need more are not tested.", *notes]
        for note in notes:
            self.add(f"<p class='warning'>{text(note)}</p>")

    def summary(self):
        judged = collections.Counter(claim.verdict for claim in self.claims if claim.where not in (OURS, OBSERVED))
        counts = ", ".join(f"{judged[verdict]} {plural}" for verdict, plural in PLURALS.items())
        self.add(
            "<h2>Summary</h2>",
            f"<p>Of {judged.total()} statements of the thesis: {counts}. A statement about several lattices holds if it holds in each of them. Counts are "
            f"deterministic, so they decide. A time is measured in {len(self.data.timing)} rounds, and the statement is <i>undecided</i> if rounds lie on both "
            "sides of its limit.</p>",
        )
        self.table(
            ("Where", "Statement", "Verdict"),
            (
                (f"<td>{text(place(claim)[:-1])}", f"<td>{text(claim.says)}", f"<td class='{CLASSES[claim.verdict]}'>{claim.verdict}")
                for claim in self.claims
                if claim.where != OBSERVED
            ),
        )

    def ratio_figures(self):
        self.add(
            "<h2>Figures 5.10 to 5.15: displaced volume and minimality ratio</h2>",
            "<p>ΔV (eq. 5.1) is the share of the volume that water poured in at a corner does not reach; R is the share of surface voxels "
            "that theorem 8 calls redundant, except those near edges (figure 5.3). The black line is the tetrahedron's volume.</p>",
        )
        for (first, second), algorithm in zip((("5.10", "5.11"), ("5.12", "5.13"), ("5.14", "5.15"), (None, None)), ALGORITHMS):
            title = f"Figures {first} and {second}: {NAMES[algorithm]}" if first else "The same for the exact algorithm"
            self.add(f"<h3>{text(title)}</h3>", panels(ratio_charts(self.data, algorithm, titles(first, second))))
            for claim in self.claims:
                if claim.where.startswith(f"{first}, ") or (not first and claim.where == OURS and re.match("ΔV|R of", claim.says)):
                    self.claim(claim)
        self.claims_of(r"5\.12–5\.15|5\.10–5\.15|All angles|precision,|slab's border")

    def counts(self):
        d = self.data
        self.add(
            "<h2>What the thesis's tests cannot see</h2>",
            "<p>This check compares every lattice edge that the mesh crosses with the voxels. A crossed edge without an end in the set is a tunnel. "
            "A voxel is redundant if all of its crossed edges have their other end in the set: it can leave.</p>",
            panels(share_charts(d, "redundant", "redundant, share of voxels", titles(None, None))),
        )
        rows = []
        for case, title in CASES.items():
            for name in ALGORITHMS:
                voxels, redundant, tunnels, rounded = (d.mean(case, name, d.top, c) for c in ("voxels", "redundant", "tunnels", "tunnels_rounded"))
                last = "<td class=n>–" if name in ("brute-force", "exact") else number(rounded, 1)
                rows.append((f"<td>{text(title)}", f"<td>{NAMES[name]}", number(voxels), number(redundant, 1), number(tunnels, 1), last))
        header = (f"D = {d.top}, mean over the angles", "algorithm", "voxels", "redundant", "tunnels in the given tetrahedron", "in the rounded one")
        self.table(header, rows)
        self.claims_of("k-minimal planes|k-separating$|k-separating[.]$|Whole surfaces|The same surfaces|no tunnel")

    def timing_figures(self):
        d = self.data

        def whole_call(case, algorithm, resolution):
            return d.times(case, algorithm, resolution, "seconds")

        self.add(
            "<h2>Figures 5.16 and 5.17: time</h2>",
            f"<p>Processor seconds of one thread, because other programs disturb them less than the clock's. There are {len(d.timing)} rounds, and each is a "
            "process of its own. In a round, a time is the least of several runs. Points are medians of the rounds, bands reach from the least to the most. "
            "The thesis's algorithms write into an array of bits, as in the thesis. The exact one's time is the library's whole call: snap, voxelize, "
            "thin, deliver sparse bricks.</p>",
            panels(time_charts(d, d.times, "seconds", titles("5.16", "5.17"))),
            "<p>All four as the library's whole call:</p>",
            panels(time_charts(d, whole_call, "seconds", titles(None, None))),
        )
        self.claims_of(r"5\.16|exact algorithm is faster|orientation")
        self.add(
            "<h2>Figures 5.18 and 5.19: the lead of optimized incremental</h2>",
            "<p>1 − time of optimized incremental / time of incremental.</p>",
            panels(lead_charts(d, titles("5.18", "5.19"))),
        )
        self.claims_of(r"5\.18")
        self.add("<h2>Figures 5.20 and 5.21: fill rate</h2>", panels(time_charts(d, d.fill_rates, "voxels per second", titles("5.20", "5.21"))))
        self.claims_of(r"5\.20|small difference")

    def bunny(self):
        d = self.data
        self.add("<h2>Figures 5.7 to 5.9, and other models</h2>")
        thesis = {case: count for case, _, count in BUNNY.values()}
        rows = []
        for row in d.models:
            printed = thesis.get(row["case"]) if row["model"] == "bunny" and row["algorithm"] == "incremental" else None
            voxels, redundant = int(row["voxels"]), int(row["redundant"])
            rows.append(
                (
                    *(f"<td>{text(name)}" for name in (row["model"], row["case"], NAMES[row["algorithm"]])),
                    number(voxels),
                    number(printed) if printed else "<td>",
                    number(int(row["tunnels"])),
                    f"<td class=n>{redundant:,} ({percent(redundant / voxels)})",
                    "<td class=n>–" if row["algorithm"] in ("exact", "brute-force") else number(int(row["tunnels_rounded"])),
                )
            )
        if rows:
            self.table(("model", "lattice", "algorithm", "voxels", "thesis", "tunnels", "redundant", "tunnels in the rounded mesh"), rows)
            sizes = {row["model"]: int(row["triangles"]) for row in d.models}
            self.add("<p class='faint'>Triangles: " + ", ".join(f"{text(name)} {count:,}" for name, count in sizes.items()) + ".</p>")
        self.claims_of(r"5\.[789]$|§5\.3")

    def tables(self):
        self.add(
            "<h2>Tables 4.1 to 4.4: voxelization matrices</h2>",
            "<p>By rows. M is in world units; V⁻¹M is in lattice coordinates, with V of eq. 4.3 for BCC.</p>",
        )

        def matrix(entries):
            rows = [row.split() for row in entries.split(" / ")]
            width = max(len(word) for row in rows for word in row)
            return "<td class=m>" + "\n".join(" ".join(word.rjust(width) for word in row) for row in rows)

        def mark(flag):
            return "<td class='yes'>yes" if flag else "<td class='no'>no"

        rows = []
        for row in self.data.tables:
            direction, valid = row["direction"].replace(" ", ", "), row["spans"] == "1" == row["is_last"]
            thesis = (matrix(row["m"]), f"<td class=n>{row['det_n']}", mark(valid), matrix(row["n"]), mark(row["n_right"] == "1"))
            ours = (matrix(row["true_n"]), matrix(row["our_m"]), matrix(row["our_n"]), f"<td class=n>{row['our_det_n']}")
            rows.append((f"<td>{row['table']}", f"<td>({direction})", *thesis, *ours))
        header = ("table", "direction", "thesis's M", "det V⁻¹M", "valid", "thesis's N", "is V⁻¹M", "V⁻¹M", "our M", "our N", "det N")
        self.table(header, rows)
        self.claims_of(r"4\.1|matrices")

    def differences(self):
        self.add(
            "<h2>What differs from the thesis</h2><ul>",
            "<li>Placement. The thesis does not say where the tetrahedron lies; here it is centered in its box, and lattice points are as far from the low sides "
            "as from the high ones.",
            "<li>Jitter. Each multiple of 5 degrees gets 0 to 4 degrees more, as in the thesis. The numbers are ours, and fixed.",
            "<li>Vertices. All algorithms start from vertices on a grid of 1/256 voxel, which is this program's only rounding; the incremental ones then round "
            "them to lattice points, as §4.6 says.",
            "<li>Seams. §4.5 gives a criterion for two half planes; for meshes we read it as: near an edge, the voxels in the slabs of all its triangles.",
            "<li>Signs. Eqs 4.8 to 4.11 lack a sign; without it the incremental offset runs the wrong way.",
            "<li>Exclusions of R (figure 5.3). A voxel is at a seam if two triangles give it. For the exact algorithm a triangle also gives the voxels within R "
            "of its edges, the regions L<sub>e</sub> and L<sub>v</sub> of §4.1.",
            "<li>Water. Poured by rows of bits instead of point by point; the result is the same.",
            "<li>Time. Another machine, twenty years later; ratios compare, seconds do not. Processor time, in several rounds.",
            "<li>Precision. The library computes with vertices on a grid; the test of §5.4's statement about precision does not snap them.",
            "<li>Names. Figures 5.11, 5.13 and 5.15 call the BCC surfaces 0-separating, 5.17 and 5.21 2-separating: on BCC these are the same.",
            "</ul>",
        )

    def html(self):
        return (
            f"<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width'><title>Chapter 5, again</title>"
            f"<style>{CSS}</style>\n" + "\n".join(self.parts) + "\n</html>\n"
        )


def processor():
    try:
        names = re.findall(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    except OSError:
        names = []
    return names[0] if names else platform.machine()


def main(directory, notes):
    data = Data(directory)
    page = Page(data, notes)
    (directory / "index.html").write_text(page.html(), encoding="utf-8")
    picture.write(directory / "chapter5.csv", picture.rows_of(data))
    picture.main(directory)
    for claim in page.claims:
        print(f"{claim.verdict or 'observed':14} {place(claim)} {claim.says}\n{'':15}{claim.measured}")
    broken = [claim for claim in page.claims if claim.must and claim.verdict != HOLDS]
    for claim in broken:
        print(f"page.py: must hold: {claim.says} Measured: {claim.measured}", file=sys.stderr)
    return 1 if broken else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1]), sys.argv[2:]))
