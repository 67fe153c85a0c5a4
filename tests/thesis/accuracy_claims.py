"""Statements about accuracy: tunnels, minimality, numerical precision."""

from data import ALGORITHMS, CASES, IDEAL, mean
from verdict import KEYS, NAMES, OBSERVED, OURS, Claim, decided, listed, percent

FIGURES = ("5.10, 5.11", "5.12, 5.13", "5.14, 5.15", OURS)


def accuracy_claims(data):
    for where, algorithm in zip(FIGURES, ALGORITHMS):
        yield convergence(data, where, algorithm)
    yield watertight(data)
    yield outliers(data)
    yield from minimality_ratio(data)
    yield from planes(data)
    yield from separation(data)
    yield from precision(data)
    yield exact_counts(data)
    yield exact_ratio(data)


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
        decided(max(largest.values()) <= bound and falls),
        note="The fitted limit is no sharper than about a percent: one face of the tetrahedron is normal to the axis of rotation and so parallel to lattice "
        "planes at every angle. Where it lies between two of them shifts ΔV by up to 1/(8D), up or down with D, and the mean over the angles "
        "does not remove that.",
        must=algorithm == "exact",
    )


def watertight(data):
    dry = {name: sum(x > 0 for x in data.all(name, "displaced_volume")) for name in ALGORITHMS}
    runs = len(data.all("exact", "displaced_volume"))
    return Claim(
        "5.10–5.15",
        "The surfaces are k-separating: the water stays outside.",
        "ΔV > 0 in every single run (one tunnel lets the water in, and ΔV is 0)",
        "; ".join(f"{NAMES[name]} {count} of {runs}" for name, count in dry.items()),
        decided(all(count == runs for count in dry.values())),
    )


def outliers(data):
    def spread(case, name):
        values = data.values(case, name, data.top, "displaced_volume")
        return max(abs(value / mean(values) - 1) for value in values)

    spreads = {name: max(spread(case, name) for case in CASES) for name in ALGORITHMS}
    limit = 0.05
    return Claim(
        "§5.4",
        "All angles show the same trend; no outliers.",
        f"at D = {data.top}, ΔV of every angle within {percent(limit, 0)} of the mean: half of what the bound 1.2/D on its error allows",
        "; ".join(f"{NAMES[name]} within {percent(value)}" for name, value in spreads.items()),
        decided(max(spreads.values()) <= limit),
    )


def minimality_ratio(data):
    largest = {name: max(data.all(name, "r")) for name in KEYS}
    yield Claim(
        "5.12–5.15",
        "R of the incremental algorithms stays at zero.",
        "R = 0 in every run: the thesis says that R is exactly 0",
        f"largest R: incremental {largest['incremental']:.4g}, optimized {largest['optimized-incremental']:.4g}",
        decided(largest["incremental"] == 0 == largest["optimized-incremental"]),
        why="A sum of roundings chose the end of a tie that eq. 4.7 does not choose, so one line along C has two voxels.",
    )


def planes(data):
    sums = {name: {c: sum(data.all(name, c)) for c in ("minimal", "not_minimal", "redundant", "voxels")} for name in ALGORITHMS}
    yield Claim(
        "ch. 6",
        "The new algorithm creates k-minimal planes.",
        "every voxel of a plane away from its edges (the exclusions of figure 5.3) satisfies theorem 8, which suffices for minimality",
        "; ".join(f"{NAMES[name]}: {sums[name]['not_minimal']:,.0f} of {sums[name]['minimal'] + sums[name]['not_minimal']:,.0f} do not" for name in KEYS),
        decided(all(sums[name]["not_minimal"] == 0 for name in KEYS[1:])),
    )
    yield Claim(
        OBSERVED,
        "Whole surfaces have redundant voxels where planes meet.",
        "voxels that can leave, one at a time, without a tunnel, as a share of all voxels of all tetrahedra",
        "; ".join(f"{NAMES[name]}: {percent(sums[name]['redundant'] / sums[name]['voxels'])}" for name in ALGORITHMS),
        note="The thesis does not state otherwise: §4.1 (figure 4.3) says that it cannot guarantee minimality there.",
    )


def separation(data):
    sums = {name: {c: sum(data.all(name, c)) for c in ("tunnels", "tunnels_rounded")} for name in KEYS}
    yield Claim(
        "§4.5, ch. 6",
        "The incremental algorithm's surfaces are k-separating.",
        "0 tunnels in the tetrahedra with vertices rounded to lattice points, on which the algorithm is defined (§4.6): no crossed lattice edge "
        "without an end in the set",
        "; ".join(f"{NAMES[name]}: {sums[name]['tunnels_rounded']:,.0f} tunnels" for name in KEYS[1:]),
        decided(all(sums[name]["tunnels_rounded"] == 0 for name in KEYS[1:])),
    )
    yield Claim(
        OBSERVED,
        "The same surfaces have tunnels with regard to the tetrahedra as given.",
        "crossed lattice edges of the given tetrahedra without an end in the set",
        "; ".join(f"{NAMES[name]}: {sums[name]['tunnels']:,.0f} tunnels" for name in KEYS),
        note="Rounding moves the surface by up to half a cell's diagonal. Lattice edges cross the given one there between two empty voxels. The water "
        "cannot tell: the set is closed, merely elsewhere. Brute force does not round.",
    )


def counts_of(data, placement, precision):
    rows = [row for row in data.precision if (row["placement"], row["precision"]) == (placement, precision)]
    return {column: sum(int(row[column]) for row in rows) for column in ("planes", "voxels", "doubled", "empty", "wrong")}


def precision(data):
    rotated = {precision: counts_of(data, "rotated", precision) for precision in ("single", "double")}

    def measured(counts):
        return (
            f"{counts['doubled']:,} lines with two voxels and {counts['empty']:,} without one, of {counts['voxels']:,}, in {counts['planes']:,} planes"
        )

    for precision, counts in rotated.items():
        yield Claim(
            "§5.4",
            f"Brute force suffers from numerical precision, here {precision}: it includes two adjacent voxels along the principal direction.",
            f"vertices not snapped, n·z + D and t in {precision} precision: some line along the principal direction has two voxels. Rationals of unlimited "
            "size judge, from the same vertices; exactly, every line has one",
            measured(counts),
            decided(counts["doubled"] > 0),
            note="The thesis states neither its precision nor its placement.",
            why="No voxel of these planes lies within the errors of doubles of the slab's border.",
        )
    shares = {precision: 2 * counts["doubled"] / counts["voxels"] for precision, counts in rotated.items()}
    yield Claim(
        "5.10, 5.11",
        "Such voxels of brute force are apparent in the graphs of R.",
        "R at least 0.001: the axes of figures 5.10 and 5.11 span 0.2, and a reader can tell half a percent of that. Both voxels of a doubled line fail "
        "theorem 8, so R is twice their share",
        "; ".join(f"{precision} precision: R = {share:.1g}" for precision, share in shares.items()),
        decided(max(shares.values()) >= 0.001),
        why="R of this size needs planes with ties, as below, or the closed slab of theorem 3.",
    )
    ties = {precision: counts_of(data, "ties", precision) for precision in ("single", "double")}
    yield Claim(
        OBSERVED,
        "Where lattice points lie exactly on the slab's border, both precisions fail.",
        "planes x + y + z = c, with voxels at exactly −t and t",
        "; ".join(f"{precision} precision: {measured(counts)}" for precision, counts in ties.items()),
        note="A line without a voxel is a tunnel. The library's brute force has neither: its vertices lie on a grid of 1/256 voxel, so distances are exact in "
        "doubles at this size, and −t < d ≤ t (theorem 4) settles ties. Its R is 0 in every run.",
    )


def exact_counts(data):
    sums = {c: sum(data.all("exact", c)) for c in ("tunnels", "redundant", "voxels")}
    return Claim(
        OURS,
        "The exact algorithm has no tunnel and no redundant voxel, in any tetrahedron or model.",
        "every crossed lattice edge checked: 0 tunnels; every voxel checked: 0 redundant",
        f"{sums['tunnels']:.0f} tunnels, {sums['redundant']:.0f} redundant of {sums['voxels']:,.0f} voxels",
        decided(
            sums["tunnels"] == 0 == sums["redundant"]
            and all(row["tunnels"] == "0" == row["redundant"] for row in data.models if row["algorithm"] == "exact")
        ),
        must=True,
    )


def exact_ratio(data):
    bottom, top = (max(data.mean(case, "exact", d, "r") for case in CASES) for d in (20, data.top))
    return Claim(
        OURS,
        "R of the exact algorithm falls as D grows.",
        f"the largest mean R at D = {data.top} is less than a fifth of that at D = 20: R counts voxels near edges, whose share falls like 1/D, by a factor of "
        "10 here; a factor of 5 allows for the noise of few voxels",
        f"{percent(bottom, 2)} at D = 20, {percent(top, 2)} at D = {data.top}; largest of all runs {percent(max(data.all('exact', 'r')))}",
        decided(top < bottom / 5),
        note="It is not 0, though no voxel is redundant: theorem 8 is sufficient for minimality, not necessary. It looks along one "
        "direction, but next to edges a voxel may be needed for another; and where thinning took away the other surface's voxel, "
        "exclusion 2 no longer sees that surface.",
    )
