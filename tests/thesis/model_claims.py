"""Statements about the bunny, and about how many points and voxels BCC saves."""

from data import ALGORITHMS
from verdict import KEYS, NAMES, UNTESTED, Claim, decided, percent

BUNNY = {"5.7": ("Cartesian, k=0, 256^3", 256, 229328), "5.8": ("BCC, 180x180x360", 180, 85699), "5.9": ("BCC, 203x203x406", 203, 172223)}


def model_claims(data):
    yield from sampling()
    counts = {fig: {name: data.model("bunny", case, name) for name in ALGORITHMS} for fig, (case, _, _) in BUNNY.items()}
    if all(counts[fig][name] for fig in BUNNY for name in ALGORITHMS):
        voxels = {fig: {name: found["voxels"] for name, found in row.items()} for fig, row in counts.items()}
        yield from bunny_counts(voxels)
        yield from savings(voxels)


def bunny_counts(voxels):
    """The thesis states neither the bunny's scale nor the algorithm. Ours fills the volume, from the first layer to the
    last; with a margin of two voxels it has (D − 5) / (D − 1) of the size, and the square of that of the voxels."""
    for fig, (case, size, thesis) in BUNNY.items():
        smaller = ((size - 5) / (size - 1)) ** 2
        why = {
            "5.8": "It cannot be the same bunny and the same algorithm as in figure 5.9: a surface's voxels grow with D², and "
            f"172,223·(180/203)² = {172223 * (180 / 203) ** 2:,.0f}, far from 85,699.",
            "5.9": "Only the exact algorithm, which the thesis does not have, comes that close.",
        }
        yield Claim(
            fig,
            f"The bunny has {thesis:,} voxels ({case}).",
            "between one of the thesis's three algorithms' count, with the bunny filling the volume, and that with §5.1's margin of two voxels on each side, "
            f"{percent(1 - smaller)} fewer; the thesis does not state its scale",
            "; ".join(f"{NAMES[name]} {voxels[fig][name]:,} ({100 * (voxels[fig][name] / thesis - 1):+.1f} %)" for name in ALGORITHMS),
            decided(any(smaller * voxels[fig][name] <= thesis <= voxels[fig][name] for name in KEYS)),
            why=why.get(fig, ""),
        )


def savings(voxels):
    saved = {name: 1 - voxels["5.9"][name] / voxels["5.7"][name] for name in ALGORITHMS}
    yield Claim(
        "§5.3",
        "At equal sampling density BCC needs 25 % fewer surface voxels than the 0-separating Cartesian lattice.",
        "each of the thesis's three algorithms: 20 to 30 % fewer. The unknown scale changes each of the two counts by 3 to 4 %, and so this share by up to 5 points",
        "; ".join(f"{NAMES[name]} {percent(share)}" for name, share in saved.items()),
        decided(all(0.2 <= saved[name] <= 0.3 for name in KEYS)),
        note=f"The thesis's own counts: {percent(1 - 172223 / 229328)}.",
    )
    saved = {name: 1 - voxels["5.8"][name] / voxels["5.7"][name] for name in ALGORITHMS}
    yield Claim(
        "§5.3",
        "BCC at 180×180×360 has 73 % fewer surface voxels than the Cartesian 256³.",
        "one of the thesis's three algorithms: 68 to 78 % fewer, with 5 points for the unknown scale as above",
        "; ".join(f"{NAMES[name]} {percent(share)}" for name, share in saved.items()),
        decided(any(0.68 <= saved[name] <= 0.78 for name in KEYS)),
        why=f"Nor do the thesis's own counts say so: 1 − 85,699/229,328 = {percent(1 - 85699 / 229328)}; and 85,699 is too few, see figure 5.8.",
    )


def sampling():
    """The spectrum of an isotropic signal is a ball. Lattices that hold it without overlap need points in proportion to
    the volume of the reciprocal cell around the ball: 8 r³ on Cartesian, 4·√2 r³ on BCC."""
    share = 4 * 2**0.5 / 8
    points = 2 * 180**3 / 256**3
    yield Claim(
        "§5.3",
        "An optimal BCC lattice needs 30 % fewer points than a Cartesian one for the same information.",
        "calculated: the volumes of the reciprocal cells around one ball, the spectrum of an isotropic signal; 25 to 35 %, because the thesis rounds to tens",
        f"1 − √2/2 = {percent(1 - share)}; figure 5.8 has {percent(1 - points)} fewer points than figure 5.7",
        decided(0.25 <= 1 - share <= 0.35),
    )
    yield Claim(
        "§5.3",
        "With as many points, BCC captures 30 % more information.",
        "calculated: the volume of the spectrum that fits; 25 to 35 % more",
        f"2/√2 − 1 = {percent(1 / share - 1)} more",
        decided(0.25 <= 1 / share - 1 <= 0.35),
        why="30 % fewer and 30 % more are not two views of one fact: 1/0.7071 is 1.414. BCC is better than the thesis says.",
    )
    yield Claim(
        "§5.3",
        "All the surface details of figure 5.7 can still be seen in figure 5.8.",
        "none: this is a judgment of two pictures",
        "nothing",
        UNTESTED,
    )
