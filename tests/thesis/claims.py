"""The thesis's statements, each with a criterion that the data decide."""

from dataclasses import dataclass

from data import ALGORITHMS, CASES, IDEAL, mean

NAMES = dict(zip(ALGORITHMS, ("brute force", "incremental", "optimized incremental", "exact (ours)")))
KEYS = ("brute-force", "incremental", "optimized-incremental")


@dataclass
class Claim:
    where: str  # figures or section
    says: str
    criterion: str
    measured: str
    holds: bool
    note: str = ""  # shown in any case
    why: str = ""  # shown where it does not hold
    ours: bool = False  # must hold, or the run fails


def percent(share, digits=1):
    return f"{100 * share:.{digits}f} %"


def listed(values, form="{:.3g}"):
    return ", ".join(f"{CASES[case]}: {form.format(value)}" for case, value in values.items())


def all_claims(data):
    return [
        *(convergence(data, where, algorithm) for where, algorithm in zip(("5.10, 5.11", "5.12, 5.13", "5.14, 5.15", "ours"), ALGORITHMS)),
        watertight(data),
        outliers(data),
        *minimality_ratio(data),
        *exact_counts(data),
        *time_claims(data),
        *lead_claims(data),
        *fill_rate_claims(data),
        *bunny_claims(data),
        *table_claims(data),
    ]


def convergence(data, where, algorithm):
    """The bound: the surface's voxels inside the tetrahedron fill at most half of its area times a thickness of sqrt(3)
    voxels. The area is (3 + sqrt 3)/4 of the side's square, so they fill 1.02 / D. The shift that the note describes
    adds 1 / (8 D)."""
    bound = 1.2
    largest = {case: max(data.errors(case, algorithm)) for case in CASES}
    means = [abs(data.mean(case, algorithm, d, "displaced_volume") - IDEAL) for case in CASES for d in (data.resolutions[0], data.top)]
    falls = all(means[n + 1] < means[n] / 2 for n in range(0, len(means), 2))
    limits = {case: data.limit(case, algorithm) / IDEAL - 1 for case in CASES}
    return Claim(
        where,
        f"ΔV of {NAMES[algorithm]} converges to the tetrahedron's volume, 1/(6·√2³) = {IDEAL:.5f}.",
        f"|ΔV − ideal| ≤ {bound}/D in every run (ΔV leaves out the surface's voxels inside the tetrahedron, which fill no more), and the mean error at "
        f"D = {data.top} is less than half of that at {data.resolutions[0]}",
        f"|ΔV − ideal|·D at most {listed(largest, '{:.2f}')}. Mean ΔV fitted by v + a/D + b/D² (D ≥ 20, weights D²) gives the ideal v, except for "
        f"{listed(limits, '{:+.2%}')}",
        max(largest.values()) <= bound and falls,
        note="The fitted limit is no sharper than about a percent: one face of the tetrahedron is normal to the axis of rotation and so parallel to lattice "
        "planes at every angle. Where it lies between two of them shifts ΔV by up to 1/(8D), up or down with D, and the mean over the angles "
        "does not remove that.",
        ours=algorithm == "exact",
    )


def watertight(data):
    dry = {name: sum(x > 0 for x in data.all(name, "displaced_volume")) for name in ALGORITHMS}
    runs = len(data.all("exact", "displaced_volume"))
    return Claim(
        "5.10–5.15",
        "The surfaces are k-separating: the water stays outside.",
        "ΔV > 0 in every single run (one tunnel lets the water in, and ΔV is 0)",
        "; ".join(f"{NAMES[name]} {count} of {runs}" for name, count in dry.items()),
        all(count == runs for count in dry.values()),
    )


def outliers(data):
    def spread(case, name):
        values = data.values(case, name, data.top, "displaced_volume")
        return max(abs(value / mean(values) - 1) for value in values)

    spreads = {name: max(spread(case, name) for case in CASES) for name in ALGORITHMS}
    limit = 0.05 if not data.quick else 0.15
    return Claim(
        "§5.4",
        "All angles show the same trend; no outliers.",
        f"at D = {data.top}, ΔV of every angle within {percent(limit, 0)} of the mean",
        "; ".join(f"{NAMES[name]} within {percent(value)}" for name, value in spreads.items()),
        max(spreads.values()) <= limit,
    )


def minimality_ratio(data):
    largest = {name: max(data.all(name, "r")) for name in ALGORITHMS}
    top = max(data.mean(case, "exact", data.top, "r") for case in CASES)
    yield Claim(
        "5.12–5.15",
        "R of the incremental algorithms stays at zero.",
        "R = 0 in every run",
        f"largest R: incremental {largest['incremental']:.4g}, optimized {largest['optimized-incremental']:.4g}",
        largest["incremental"] == 0 == largest["optimized-incremental"],
        why="A sum of roundings chose the end of a tie that eq. 4.7 does not choose, so one line along C has two voxels.",
    )
    yield Claim(
        "5.10, 5.11",
        "Brute force suffers from numerical precision: R is above zero.",
        "R > 0 in some run",
        f"largest R: {largest['brute-force']:.4g}",
        largest["brute-force"] > 0,
        why="Here it does not: vertices lie on a grid of 1/256 voxel, so the distances of voxels from a plane are exact in doubles at "
        "this size, and −t < d ≤ t (theorem 4, not theorem 3's closed slab) settles ties.",
    )
    yield Claim(
        "ours",
        "R of the exact algorithm vanishes as D grows.",
        f"mean R at D = {data.top} below 0.5 %" if not data.quick else f"mean R at D = {data.top} below 2 %",
        f"largest mean at D = {data.top}: {percent(top, 2)}; largest of all runs {percent(largest['exact'], 1)}",
        top < (0.02 if data.quick else 0.005),
        note="It is not 0, though no voxel is redundant: theorem 8 is sufficient for minimality, not necessary. It looks along one "
        "direction, but next to edges a voxel may be needed for another; and where thinning took away the other surface's voxel, "
        "exclusion 2 no longer sees that surface.",
    )


def exact_counts(data):
    sums = {name: {c: sum(data.all(name, c)) for c in ("tunnels", "redundant", "tunnels_rounded", "voxels")} for name in ALGORITHMS}
    yield Claim(
        "ours",
        "The exact algorithm has no tunnel and no redundant voxel, in any tetrahedron or model.",
        "every crossed lattice edge checked: 0 tunnels; every voxel checked: 0 redundant",
        f"{sums['exact']['tunnels']:.0f} tunnels, {sums['exact']['redundant']:.0f} redundant of {sums['exact']['voxels']:,.0f} voxels",
        sums["exact"]["tunnels"] == 0 == sums["exact"]["redundant"]
        and all(row["tunnels"] == "0" == row["redundant"] for row in data.models if row["algorithm"] == "exact"),
        ours=True,
    )
    yield Claim(
        "§4.5, ch. 6",
        "The incremental algorithm's surfaces are k-separating.",
        "no crossed lattice edge of the tetrahedron as given without an end in the set",
        "; ".join(
            f"{NAMES[name]}: {sums[name]['tunnels']:,.0f} tunnels in the given, {sums[name]['tunnels_rounded']:,.0f} in the rounded tetrahedra"
            for name in KEYS[1:]
        )
        + f"; {NAMES[KEYS[0]]}: {sums[KEYS[0]]['tunnels']:,.0f} in the given",
        all(sums[name]["tunnels"] == 0 for name in KEYS[1:]),
        why="They are separating for the tetrahedron with its vertices rounded to lattice points (§4.6). The given one lies up to "
        "half a cell's diagonal away, and there lattice edges cross it between two empty voxels. The water cannot tell: the set is closed, "
        "merely elsewhere. Brute force does not round.",
    )
    yield Claim(
        "ch. 6",
        "The new algorithm creates k-minimal planes.",
        "no voxel of the whole surface can leave without a tunnel",
        "; ".join(f"{NAMES[name]}: {percent(sums[name]['redundant'] / sums[name]['voxels'])} redundant" for name in KEYS),
        all(sums[name]["redundant"] == 0 for name in KEYS),
        why="Each plane by itself is minimal, and R, which leaves out voxels near edges, is 0. But where planes meet there are too many: "
        "§4.1 (figure 4.3) says that it cannot guarantee otherwise.",
    )


def time_claims(data):
    best = {case: data.time(case, "brute-force", data.top) / data.time(case, "optimized-incremental", data.top) for case in CASES}
    yield Claim(
        "5.16, 5.17",
        "The incremental algorithm runs one order of magnitude faster than brute force.",
        f"at D = {data.top}, brute force takes at least 10 times optimized incremental's time in every lattice",
        f"times: {listed(best, '{:.1f}')}",
        min(best.values()) >= 10,
        why="The factor grows with D; at this size it is not there yet.",
    )
    slopes = {name: {case: data.slope(case, name) for case in CASES} for name in ALGORITHMS}
    yield Claim(
        "5.16, 5.17",
        "Brute force is asymptotically slower: up to O(D³) against O(D²).",
        f"slope of log time over log D, D ≥ {data.top / 2:g}: brute force steeper than both incremental ones by 0.3 in every lattice",
        "; ".join(f"{NAMES[name]}: {min(s.values()):.2f} to {max(s.values()):.2f}" for name, s in slopes.items()),
        all(slopes["brute-force"][case] >= slopes[name][case] + 0.3 for case in CASES for name in KEYS[1:]),
        why="Fixed costs and single measurements hide the slope at so few and small D." if data.quick else "",
    )
    exact = {case: data.time(case, "exact", data.top) / data.time(case, "optimized-incremental", data.top) for case in CASES}
    call = {case: data.time(case, "exact", data.top) / data.time(case, "optimized-incremental", data.top, "seconds") for case in CASES}
    yield Claim(
        "ours",
        "The exact algorithm costs little more than the fastest of the thesis's, both as the library's whole call.",
        f"at D = {data.top}, exact takes at most 1.5 times optimized incremental's time in every lattice",
        f"times optimized incremental's whole call: {listed(call, '{:.2f}')}; its bare loop into an array: {listed(exact, '{:.1f}')}",
        max(call.values()) <= 1.5,
        why="Being exact and minimal costs this much: every direction's crossings are found, not the principal one's alone, and seams are thinned.",
    )


def lead_claims(data):
    high = [d for d in data.resolutions if 2 * d >= data.top]
    leads = {case: mean([data.lead(case, d, "array_seconds") for d in high]) for case in CASES}
    scans = {case: mean([data.lead(case, d, "scan_seconds") for d in high]) for case in CASES}
    average = mean(list(leads.values()))
    yield Claim(
        "5.18, 5.19",
        "Optimized incremental has a small lead of around 11 % over incremental.",
        f"mean lead over all lattices, D ≥ {data.top / 2:g}, between 5 and 17 %",
        f"{percent(average)} ({listed(leads, '{:.3f}')}); triangles alone, without seams: {percent(mean(list(scans.values())))}",
        0.05 <= average <= 0.17,
    )
    low = [data.lead(case, d, "array_seconds") for case in CASES for d in data.resolutions if d <= 60]
    yield Claim(
        "5.18, 5.19",
        "At low resolution the lead swings between 0 and 20 %.",
        "lead within −2 to 22 % for every lattice and D ≤ 60",
        f"{percent(min(low))} to {percent(max(low))}",
        min(low) >= -0.02 and max(low) <= 0.22,
        why="A single time of a few microseconds is noisier than that on this machine.",
    )


def fill_rate_claims(data):
    rate, low = data.fill_rate, data.resolutions[0]
    yield Claim(
        "5.20, 5.21",
        "At high resolution optimized incremental fills fastest, then incremental, then brute force.",
        f"voxels/s in this order at D = {data.top} in every lattice",
        "; ".join(f"{NAMES[name]}: " + listed({case: rate(case, name, data.top) / 1e6 for case in CASES}, "{:.0f} M/s") for name in KEYS),
        all(rate(c, KEYS[2], data.top) > rate(c, KEYS[1], data.top) > rate(c, KEYS[0], data.top) for c in CASES),
    )
    growth = {case: rate(case, KEYS[2], data.top) / rate(case, KEYS[2], low) for case in CASES}
    yield Claim(
        "5.20, 5.21",
        "The incremental fill rate is low at low resolution, for a constant setup a triangle, and grows.",
        f"optimized incremental's rate at D = {data.top} at least 1.5 times that at {low}, in every lattice",
        f"times: {listed(growth, '{:.1f}')}",
        min(growth.values()) >= 1.5,
    )
    ratio = rate(("bcc", "0"), KEYS[2], data.top) / rate(("cartesian", "0"), KEYS[2], data.top)
    yield Claim(
        "5.20, 5.21",
        "On BCC the incremental algorithm performs just as efficiently as on the Cartesian lattice.",
        f"optimized incremental's voxels/s on BCC within 25 % of Cartesian k = 0 at D = {data.top}",
        f"{ratio:.2f} times",
        0.75 <= ratio <= 1.25,
        why="Points of the skew basis lie farther apart in the array of this measurement.",
    )


BUNNY = {"5.7": ("Cartesian, k=0, 256^3", 229328), "5.8": ("BCC, 180x180x360", 85699), "5.9": ("BCC, 203x203x406", 172223)}


def bunny_claims(data):
    counts = {fig: {name: data.model("bunny", case, name) for name in ALGORITHMS} for fig, (case, _) in BUNNY.items()}
    if not all(counts[fig][name] for fig in BUNNY for name in ALGORITHMS):
        return
    voxels = {fig: {name: found["voxels"] for name, found in row.items()} for fig, row in counts.items()}
    for fig, (case, thesis) in BUNNY.items():
        off = {name: count / thesis - 1 for name, count in voxels[fig].items()}
        why = (
            "It cannot be the same bunny and the same algorithm as in figure 5.9: a surface's voxels grow with D², and "
            f"172,223·(180/203)² = {172223 * (180 / 203) ** 2:,.0f}, far from 85,699."
        )
        yield Claim(
            fig,
            f"The bunny has {thesis:,} voxels ({case}).",
            "one of the algorithms within 3 %; placement, mesh and algorithm are not stated, so the counts are comparisons, not targets",
            "; ".join(f"{NAMES[name]} {voxels[fig][name]:,} ({100 * off[name]:+.1f} %)" for name in ALGORITHMS),
            min(map(abs, off.values())) <= 0.03,
            why=why if fig == "5.8" else "",
        )
    saved = {name: 1 - voxels["5.9"][name] / voxels["5.7"][name] for name in ALGORITHMS}
    yield Claim(
        "§5.3",
        "At equal sampling density BCC needs 25 % fewer surface voxels than the 0-separating Cartesian lattice.",
        "exact and incremental: 20 to 30 % fewer",
        "; ".join(f"{NAMES[name]} {percent(share)}" for name, share in saved.items()),
        all(0.2 <= saved[name] <= 0.3 for name in ("exact", "incremental")),
        note=f"The thesis's own counts: {percent(1 - 172223 / 229328)}.",
    )
    saved = {name: 1 - voxels["5.8"][name] / voxels["5.7"][name] for name in ALGORITHMS}
    yield Claim(
        "§5.3",
        "BCC at 180×180×360 captures the detail of the Cartesian 256³ with 73 % fewer voxels.",
        "exact or incremental: 68 to 78 % fewer",
        "; ".join(f"{NAMES[name]} {percent(share)}" for name, share in saved.items()),
        any(0.68 <= saved[name] <= 0.78 for name in ("exact", "incremental")),
        why=f"Nor do the thesis's own counts say so: 1 − 85,699/229,328 = {percent(1 - 85699 / 229328)}; and 85,699 is too few, see figure 5.8.",
    )


def table_claims(data):
    rows = data.tables
    valid = [row for row in rows if row["spans"] == "1" == row["is_last"]]
    negative = [row["direction"] for row in rows if row["det_n"] == "-1"]
    wrong = [row["direction"] for row in rows if row["n_right"] == "0"]
    yield Claim(
        "4.1–4.4",
        "Every M spans the lattice and ends in its principal direction.",
        "V⁻¹M is integer with determinant ±1, and M's last column is the direction",
        f"{len(valid)} of {len(rows)} rows",
        len(valid) == len(rows),
    )
    yield Claim(
        "4.1–4.4",
        "det(V⁻¹M) = 1.",
        "in every row",
        f"−1 for ({'), ('.join(negative)})" if negative else "in every row",
        not negative,
        why="Harmless: the criterion that matters is |det| = 1.",
    )
    yield Claim(
        "4.1–4.4",
        "N is V⁻¹M.",
        "in every row, with V of eq. 4.3",
        f"not in {len(wrong)} rows of table 4.4: ({'), ('.join(wrong)})" if wrong else "in every row",
        not wrong,
        why="The printed N belongs to another V, or is mistaken; the M beside it are right.",
    )
    yield Claim(
        "ours",
        "The matrices of this program, found for any lattice, are valid.",
        "det N = 1 in every row",
        f"{sum(row['our_det_n'] == '1' for row in rows)} of {len(rows)} rows",
        all(row["our_det_n"] == "1" for row in rows),
        ours=True,
    )
