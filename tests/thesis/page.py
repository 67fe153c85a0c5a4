"""Makes the page of tests/thesis/run from the tables that thesis_reproduce wrote.

Usage: page.py DIRECTORY [NOTE ...]     each note is a warning to show
Writes DIRECTORY/index.html, which needs no other file, and DIRECTORY/chapter5.svg, one figure of it. Exits with 1 if a
claim about the exact algorithm does not hold.
"""

import html
import pathlib
import platform
import re
import sys

from claims import BUNNY, NAMES, all_claims, percent
from data import ALGORITHMS, CASES, IDEAL, Data, mean
from plot import Chart, Series, figure

STYLE = {  # color, dash, marker; distinguishable without color, too
    "brute-force": ("#D55E00", "", "square"),
    "incremental": ("#0072B2", "", "circle"),
    "optimized-incremental": ("#009E73", "6 4", "diamond"),
    "exact": ("#8E44AD", "", "circle"),
}
VOLUME, RATIO = "#0072B2", "#D55E00"
RESOLUTION = "lattice resolution D"

CSS = """
body { font: 16px/1.5 Helvetica, Arial, sans-serif; color: #222; background: #fff; max-width: 1000px; margin: 2em auto; padding: 0 1em }
h1 { margin-bottom: 0 } h2 { margin-top: 2.2em; border-bottom: 1px solid #ccc } svg { max-width: 100%; height: auto }
table { border-collapse: collapse; margin: 1em 0; font-size: 14px } th, td { border-bottom: 1px solid #ddd; padding: .35em .6em; vertical-align: top; text-align: left }
td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap } td.m { font-family: monospace; white-space: pre }
.yes, .no { font-weight: bold; white-space: nowrap } .yes { color: #117733 } .no { color: #b03a2e }
.claim { border-left: 4px solid #117733; padding: .1em 1em; margin: 1em 0; background: #f7f7f7; font-size: 15px }
.claim.fails { border-color: #b03a2e } .claim p { margin: .4em 0 } td:first-child { white-space: nowrap } .faint { color: #666; font-size: 14px } .warning { background: #fff3cd; padding: .6em 1em }
"""


def text(value):
    return html.escape(str(value))


def series(algorithm, points):
    color, dash, marker = STYLE[algorithm]
    return Series(NAMES[algorithm], color, points, dash, marker)


def ratio_charts(data, algorithm, cases):
    for case in cases:
        spread = [(d, data.values(case, algorithm, d, "displaced_volume")) for d in data.resolutions]
        band = [(d, min(v), max(v)) for d, v in spread]
        volume = Series("ΔV, mean and range over the angles", VOLUME, [(d, mean(v)) for d, v in spread], band=band)
        points = [(d, data.mean(case, algorithm, d, "r")) for d in data.resolutions]
        ratio = Series("R, mean", RATIO, points, "6 4", "square")
        top = 0.1 if algorithm == "exact" else 0.07
        yield Chart(CASES[case], RESOLUTION, "share", [volume, ratio], (IDEAL, "ideal ΔV"), y_range=(-0.01, top))


def share_charts(data, column, label):
    for case in CASES:
        lines = [
            series(a, [(d, data.mean(case, a, d, column) / data.mean(case, a, d, "voxels")) for d in data.resolutions])
            for a in ALGORITHMS
        ]
        yield Chart(CASES[case], RESOLUTION, label, lines)


def time_charts(data, measure, label):
    for case in CASES:
        lines = [series(a, [(d, measure(case, a, d)) for d in data.resolutions]) for a in ALGORITHMS]
        yield Chart(CASES[case], RESOLUTION, label, lines, log=True)


def lead_charts(data):
    for case in CASES:
        lines = [
            Series("whole algorithm", "#0072B2", [(d, data.lead(case, d, "array_seconds")) for d in data.resolutions]),
            Series("triangles alone", "#009E73", [(d, data.lead(case, d, "scan_seconds")) for d in data.resolutions], "6 4", "square"),
        ]
        yield Chart(CASES[case], RESOLUTION, "lead", lines, (0.11, "thesis: around 11 %"), y_range=(-0.05, 0.3))


def readme_figure(data):
    """Returns one row of charts, for BCC: displaced volume, redundant voxels and time."""
    case = ("bcc", "0")
    lines = [series(a, [(d, data.mean(case, a, d, "displaced_volume")) for d in data.resolutions]) for a in ALGORITHMS]
    charts = [Chart("Displaced volume ΔV (BCC)", RESOLUTION, "share of the box", lines, (IDEAL, "ideal ΔV"))]
    lines = [series(a, [(d, 100 * data.mean(case, a, d, "redundant") / data.mean(case, a, d, "voxels")) for d in data.resolutions]) for a in ALGORITHMS]
    charts.append(Chart("Redundant voxels (BCC)", RESOLUTION, "percent", lines))
    lines = [series(a, [(d, 1e3 * data.time(case, a, d, "seconds")) for d in data.resolutions]) for a in ALGORITHMS]
    charts.append(Chart("Time of the call, one thread (BCC)", RESOLUTION, "milliseconds", lines, log=True))
    return figure(charts, columns=3, width=360, height=270)


class Page:
    def __init__(self, data, notes):
        self.data, self.parts = data, []
        self.claims = all_claims(data)
        self.header(notes)
        self.summary()
        self.ratio_figures()
        self.counts()
        self.timing_figures()
        self.bunny()
        self.tables()
        self.differences()

    def add(self, *parts):
        self.parts += parts

    def claims_of(self, pattern):
        for claim in self.claims:
            if re.search(pattern, claim.where) or (claim.where == "ours" and re.search(pattern, claim.says)):
                self.claim(claim)

    def claim(self, claim):
        verdict = "<span class='yes'>holds</span>" if claim.holds else "<span class='no'>does not hold</span>"
        why = f"<p>{text(claim.why)}</p>" if claim.why and not claim.holds else ""
        note = f"<p>{text(claim.note)}</p>" if claim.note else ""
        self.add(
            f"<div class='claim{'' if claim.holds else ' fails'}'><p><b>{text(self.place(claim))}</b> {text(claim.says)} {verdict}.</p>{why}{note}"
            f"<p class='faint'>Criterion: {text(claim.criterion)}.<br>Measured: {text(claim.measured)}.</p></div>"
        )

    @staticmethod
    def place(claim):
        if claim.where == "ours":
            return "Of this program."
        return {"4": "Tables ", "5": "Figure " if "," not in claim.where and "–" not in claim.where else "Figures "}.get(claim.where[0], "") + claim.where + "."

    def header(self, notes):
        d = self.data
        angles, timed = d.settings["angles"], d.settings["timed_angles"]
        self.add(
            "<h1>The thesis's chapter 5, again</h1>",
            "<p>Haris Widjaya, <i>Accurate incremental voxelization in common sampling lattices</i>, Simon Fraser University, 2006: "
            "its experiments with the thesis's three algorithms, as this program implements them, and with this program's exact one. "
            "Made by <code>tests/thesis/run</code>; every verdict is computed from the tables beside this page.</p>",
            f"<p class='faint'>{angles} angles, D from {d.resolutions[0]} to {d.top} in {len(d.resolutions)} steps, 4 lattices and neighborhoods, 4 algorithms: "
            f"{int(angles) * len(d.resolutions) * 16:,} tetrahedra. Times: one thread, {timed} of the angles. {text(processor())}. "
            f"Measured in {sum(float(d.settings[k]) for k in ('accuracy_seconds', 'timing_seconds', 'models_seconds')):.0f} s on {d.settings['threads']} threads. "
            "Tables: " + ", ".join(f"<a href='{n}.csv'>{n}.csv</a>" for n in ("accuracy", "timing", "models", "tables", "settings")) + ".</p>",
        )
        if d.quick:
            notes = ["A quick run: few angles, low resolutions, wide tolerances. Verdicts on limits and times need the whole run.", *notes]
        for note in notes:
            self.add(f"<p class='warning'>{text(note)}</p>")

    def summary(self):
        holding = sum(claim.holds for claim in self.claims if claim.where != "ours")
        total = sum(claim.where != "ours" for claim in self.claims)
        self.add("<h2>Summary</h2>", f"<p>{holding} of {total} statements of the thesis hold here.</p>", "<table><tr><th>Where<th>Statement<th>")
        for claim in self.claims:
            verdict = "<td class='yes'>holds" if claim.holds else "<td class='no'>does not hold"
            self.add(f"<tr><td>{text(self.place(claim)[:-1])}<td>{text(claim.says)}{verdict}")
        self.add("</table>")

    def ratio_figures(self):
        cases = list(CASES)
        self.add(
            "<h2>Figures 5.10 to 5.15: displaced volume and minimality ratio</h2>",
            "<p>ΔV (eq. 5.1) is the share of the volume that water poured in at a corner does not reach; R is the share of surface voxels "
            "that theorem 8 calls redundant, except those near edges (figure 5.3). The black line is the tetrahedron's volume.</p>",
        )
        for (first, second), algorithm in zip((("5.10", "5.11"), ("5.12", "5.13"), ("5.14", "5.15"), (None, None)), ALGORITHMS):
            title = f"Figures {first} and {second}: {NAMES[algorithm]}" if first else "The same for the exact algorithm"
            self.add(f"<h3>{text(title)}</h3>", figure(ratio_charts(self.data, algorithm, cases)))
            for claim in self.claims:
                if claim.where.startswith(f"{first}, ") or (not first and claim.where == "ours" and re.match("ΔV|R of", claim.says)):
                    self.claim(claim)
        self.claims_of(r"5\.12–5\.15|5\.10–5\.15|§5\.4")

    def counts(self):
        d = self.data
        self.add(
            "<h2>What the thesis's tests cannot see</h2>",
            "<p>This check compares every lattice edge that the mesh crosses with the voxels. A crossed edge without an end in the set is a tunnel. "
            "A voxel is redundant if all of its crossed edges have their other end in the set: it can leave.</p>",
            figure(share_charts(d, "redundant", "redundant, share of voxels")),
            f"<table><tr><th>D = {d.top}, mean over the angles<th>algorithm<th>voxels<th>redundant<th>tunnels in the given tetrahedron<th>in the rounded one",
        )
        for case, title in CASES.items():
            for name in ALGORITHMS:
                values = [d.mean(case, name, d.top, column) for column in ("voxels", "redundant", "tunnels", "tunnels_rounded")]
                rounded = "–" if name in ("brute-force", "exact") else f"{values[3]:,.1f}"
                self.add(
                    f"<tr><td>{text(title)}<td>{NAMES[name]}<td class=n>{values[0]:,.0f}<td class=n>{values[1]:,.1f}<td class=n>{values[2]:,.1f}<td class=n>{rounded}"
                )
        self.add("</table>")
        self.claims_of(r"ch\. 6|no tunnel")

    def timing_figures(self):
        d = self.data
        self.add(
            "<h2>Figures 5.16 and 5.17: time</h2>",
            "<p>Processor seconds of one thread. The thesis's algorithms write into an array of bits, as in the thesis. The exact one's time is the "
            "library's whole call: snap, voxelize, thin, deliver sparse bricks.</p>",
            figure(time_charts(d, d.time, "seconds")),
            "<p>All four as the library's whole call:</p>",
            figure(time_charts(d, lambda case, a, n: d.time(case, a, n, "seconds"), "seconds")),
        )
        self.claims_of(r"5\.16|costs little more")
        self.add(
            "<h2>Figures 5.18 and 5.19: the lead of optimized incremental</h2>",
            "<p>1 − time of optimized incremental / time of incremental.</p>",
            figure(lead_charts(d)),
        )
        self.claims_of(r"5\.18")
        self.add("<h2>Figures 5.20 and 5.21: fill rate</h2>", figure(time_charts(d, d.fill_rate, "voxels per second")))
        self.claims_of(r"5\.20")

    def bunny(self):
        d = self.data
        if not d.models:
            return
        self.add(
            "<h2>Figures 5.7 to 5.9, and other models</h2>",
            "<table><tr><th>model<th>lattice<th>algorithm<th>voxels<th>thesis<th>tunnels<th>redundant<th>tunnels in the rounded mesh",
        )
        thesis = {case: count for case, count in BUNNY.values()}
        for row in d.models:
            printed = f"{thesis[row['case']]:,}" if row["model"] == "bunny" and row["case"] in thesis and row["algorithm"] == "incremental" else ""
            rounded = f"{int(row['tunnels_rounded']):,}" if row["algorithm"] not in ("exact", "brute-force") else "–"
            self.add(
                f"<tr><td>{text(row['model'])}<td>{text(row['case'])}<td>{NAMES[row['algorithm']]}<td class=n>{int(row['voxels']):,}<td class=n>{printed}"
                f"<td class=n>{int(row['tunnels']):,}<td class=n>{int(row['redundant']):,} ({percent(int(row['redundant']) / int(row['voxels']))})<td class=n>{rounded}"
            )
        sizes = {row["model"]: int(row["triangles"]) for row in d.models}
        self.add("</table>", "<p class='faint'>Triangles: " + ", ".join(f"{text(name)} {count:,}" for name, count in sizes.items()) + ".</p>")
        self.claims_of(r"5\.[789]$|§5\.3")

    def tables(self):
        self.add(
            "<h2>Tables 4.1 to 4.4: voxelization matrices</h2>",
            "<p>By rows. M is in world units; V⁻¹M is in lattice coordinates, with V of eq. 4.3 for BCC.</p>",
            "<table><tr><th>table<th>direction<th>thesis's M<th>det V⁻¹M<th>valid<th>thesis's N<th>is V⁻¹M<th>V⁻¹M<th>our M<th>our N<th>det N",
        )

        def matrix(entries):
            rows = [row.split() for row in entries.split(" / ")]
            width = max(len(word) for row in rows for word in row)
            return "<td class=m>" + "\n".join(" ".join(word.rjust(width) for word in row) for row in rows)

        def mark(flag):
            return "<td class='yes'>yes" if flag else "<td class='no'>no"

        for row in self.data.tables:
            valid = row["spans"] == "1" == row["is_last"]
            self.add(
                f"<tr><td>{row['table']}<td>({row['direction'].replace(' ', ', ')}){matrix(row['m'])}<td class=n>{row['det_n']}{mark(valid)}{matrix(row['n'])}"
                f"{mark(row['n_right'] == '1')}{matrix(row['true_n'])}{matrix(row['our_m'])}{matrix(row['our_n'])}<td class=n>{row['our_det_n']}"
            )
        self.add("</table>")
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
            "<li>Time. Another machine, twenty years later; ratios compare, seconds do not. Times are the least of several runs, so that other programs disturb them little.",
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
    (directory / "chapter5.svg").write_text(readme_figure(data), encoding="utf-8")
    for claim in page.claims:
        print(f"{'holds         ' if claim.holds else 'does not hold '} {page.place(claim)} {claim.says}")
    broken = [claim for claim in page.claims if claim.ours and not claim.holds]
    for claim in broken:
        print(f"page.py: must hold: {claim.says} Measured: {claim.measured}", file=sys.stderr)
    return 1 if broken else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1]), sys.argv[2:]))
