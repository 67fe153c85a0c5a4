"""Statements about time. Every quantity is measured in several rounds, and its verdict takes their spread into account."""

import statistics

from data import ALGORITHMS, CASES, mean
from verdict import KEYS, NAMES, OURS, UNTESTED, Claim, every, listed, percent, spread, within

# The thesis reads "just as efficient" and "small difference" from graphs with logarithmic axes, without a number.
TENTH = 10**0.1
LIKE = f"a factor of at most {TENTH:.2f}, a tenth of a decade: about what a reader can tell on the thesis's logarithmic axes"
BRUTE, INCREMENTAL, OPTIMIZED = KEYS


def quotients(a, b):
    """Returns a / b for each round."""
    return [x / y for x, y in zip(a, b)]


def time_claims(data):
    yield order_of_magnitude(data)
    yield growth(data)
    yield orientation(data)
    yield exact_call(data)
    yield lead(data)
    yield low_lead(data)
    yield fill_order(data)
    yield fill_growth(data)
    yield bcc_efficiency(data)
    yield lattices(data)


def order_of_magnitude(data):
    ratios = {case: quotients(data.times(case, BRUTE, data.top), data.times(case, INCREMENTAL, data.top)) for case in CASES}
    return Claim(
        "5.16, 5.17",
        "The incremental algorithm runs one order of magnitude faster than brute force.",
        f"at D = {data.top}, brute force takes at least 10 times incremental's time in every lattice",
        f"times: {listed(ratios, '{:.1f}')}",
        every(within(values, 10) for values in ratios.values()),
        why="The factor grows with D; at this size it is not there yet.",
    )


def growth(data):
    says = "Brute force is asymptotically slower: up to O(D³) against O(D²)."
    criterion = (
        f"slope of log time over log D, D ≥ {data.top / 2:g}: brute force steeper than both incremental ones by 0.3 in every lattice. Terms of lower order "
        "pull the incremental slopes up to 0.15 away from 2; the difference must be twice as large"
    )
    if len(data.upper) < 3:
        return Claim("5.16, 5.17", says, criterion, "a quick run has too few resolutions", UNTESTED)
    slopes = {name: {case: data.slopes(case, name) for case in CASES} for name in ALGORITHMS}
    steeper = [[a - b for a, b in zip(slopes[BRUTE][case], slopes[name][case])] for case in CASES for name in KEYS[1:]]
    return Claim(
        "5.16, 5.17",
        says,
        criterion,
        "; ".join(f"{NAMES[name]}: {spread(sum(rows.values(), []))}" for name, rows in slopes.items())
        + f"; least difference: {spread(min(steeper, key=min))}",
        every(within(values, 0.3) for values in steeper),
    )


def orientation(data):
    ratios = {name: {case: data.across(case, name, data.top) for case in CASES} for name in KEYS}
    low = sum((data.across(case, BRUTE, 50) for case in CASES), [])
    return Claim(
        "§5.4",
        "Brute force's run time depends on the triangle's orientation.",
        f"one equilateral triangle with edges of length D = {data.top}: across the volume (normal (1, 1, 1)), the time that brute force takes for "
        f"a voxel differs from that parallel to lattice planes (normal (1, 0, 0)) by more than a factor of {TENTH:.2f}, in every lattice",
        "; ".join(f"{NAMES[name]}: {listed(rows)}" for name, rows in ratios.items()) + f". Brute force at D = 50: {spread(low)}",
        every(within(values, TENTH) for values in ratios[BRUTE].values()),
        why="The box of a triangle across the volume has D³ points. Most are rejected early, and the parallel one needs a margin of two voxels.",
    )


def exact_call(data):
    call = {c: quotients(data.times(c, "exact", data.top), data.times(c, OPTIMIZED, data.top, "seconds")) for c in CASES}
    loop = {c: quotients(data.times(c, "exact", data.top), data.times(c, OPTIMIZED, data.top)) for c in CASES}
    fresh = {c: quotients(data.times(c, "exact", data.top, "fresh_seconds"), data.times(c, "exact", data.top)) for c in CASES}
    return Claim(
        OURS,
        "The exact algorithm is faster than the fastest of the thesis's, both as the library's whole call.",
        f"at D = {data.top}, exact takes at most half of optimized incremental's time in every lattice; the rounds spread by far less than a factor of 2",
        f"share of optimized incremental's whole call: {listed(call, '{:.2f}')}. Times its bare loop into an array: {listed(loop, '{:.2f}')}",
        every(within(values, 0, 0.5) for values in call.values()),
        note="Ended calls leave up to 32 MiB to later ones, as the contract of VoxelizeJob says (core/voxelizer/voxelizer.h, core/base/kept_memory.h). So a call "
        f"does not pay for fresh pages. With KeepJobMemory(0) it takes {spread(sum(fresh.values(), []))} times as long. For all algorithms alike, the "
        "heap of the C library keeps freed memory, too.",
    )


def lead(data):
    says, wanted = "Optimized incremental has a small lead of around 11 % over incremental.", (0.055, 0.165)
    criterion = (
        f"mean lead over D ≥ {data.top / 2:g} between 5.5 and 16.5 % in every lattice: 11 %, and half of it more or less, because the thesis's own graphs swing "
        "by more"
    )
    if len(data.upper) < 3:
        return Claim("5.18, 5.19", says, criterion, "a quick run has too few resolutions", UNTESTED)

    def means(column):
        rows = {case: [data.leads(case, d, column) for d in data.upper] for case in CASES}
        return {case: [mean(values) for values in zip(*leads)] for case, leads in rows.items()}

    leads = means("array_seconds")
    return Claim(
        "5.18, 5.19",
        says,
        criterion,
        f"{listed(leads, '{:.1%}')}; triangles alone, without seams: {spread(sum(means('scan_seconds').values(), []), '{:.1%}')}",
        every(within(values, *wanted) for values in leads.values()),
        note="The lead changes from process to process with the addresses of code and data, more than from call to call.",
    )


def low_lead(data):
    low = {(case, d): data.leads(case, d, "array_seconds") for case in CASES for d in data.timed if d <= 60}
    everything = sum(low.values(), [])
    return Claim(
        "5.18, 5.19",
        "At low resolution the lead swings between 0 and 20 %.",
        "lead within 0 to 20 % for every lattice and D ≤ 60, in every round",
        f"{percent(min(everything))} to {percent(max(everything))}, median {percent(statistics.median(everything))}",
        every(within(values, 0, 0.2) for values in low.values()),
    )


def fill_order(data):
    rates = {name: {case: data.fill_rates(case, name, data.top) for case in CASES} for name in KEYS}
    pairs = [quotients(rates[a][case], rates[b][case]) for case in CASES for a, b in ((OPTIMIZED, INCREMENTAL), (INCREMENTAL, BRUTE))]
    return Claim(
        "5.20, 5.21",
        "At high resolution optimized incremental fills fastest, then incremental, then brute force.",
        f"voxels a second in this order at D = {data.top}, in every lattice and round",
        "; ".join(
            f"{NAMES[name]}: " + listed({c: [r / 1e6 for r in rates[name][c]] for c in CASES}, "{:.0f}") + " M/s" for name in reversed(KEYS)
        ),
        every(within(values, 1) for values in pairs),
    )


def fill_growth(data):
    low = data.timed[0]
    growth = {case: quotients(data.fill_rates(case, OPTIMIZED, data.top), data.fill_rates(case, OPTIMIZED, low)) for case in CASES}
    return Claim(
        "5.20, 5.21",
        "The incremental fill rate is low at low resolution, for a constant setup a triangle, and grows.",
        f"optimized incremental's rate at D = {data.top} at least twice that at {low} in every lattice: then the setup is at least half of the time there",
        f"times: {listed(growth, '{:.1f}')}",
        every(within(values, 2) for values in growth.values()),
    )


def bcc_efficiency(data):
    ratios = {n: quotients(data.fill_rates(("bcc", "0"), n, data.top), data.fill_rates(("cartesian", "0"), n, data.top)) for n in KEYS[1:]}
    return Claim(
        "5.20, 5.21",
        "On BCC the incremental algorithm performs just as efficiently as on the Cartesian lattice.",
        f"voxels a second on BCC against Cartesian k = 0 at D = {data.top}: {LIKE}",
        "; ".join(f"{NAMES[name]}: {spread(values)} times" for name, values in ratios.items()),
        every(within(values, 1 / TENTH, TENTH) for values in ratios.values()),
        why="Points of the skew basis lie farther apart in the array of this measurement.",
    )


def lattices(data):
    ratios = {}
    for name in KEYS[1:]:
        rounds = list(zip(*(data.fill_rates(case, name, data.top) for case in CASES)))
        ratios[name] = [max(rates) / min(rates) for rates in rounds]
    return Claim(
        "ch. 6",
        "There is a small difference in run time efficiency across the lattices.",
        f"largest over least of the four rates, voxels a second at D = {data.top}: {LIKE}",
        "; ".join(f"{NAMES[name]}: {spread(values)}" for name, values in ratios.items()),
        every(within(values, 1, TENTH) for values in ratios.values()),
    )
