"""Verdicts on statements: a criterion, what was measured, and what the spread of the measurements allows to say."""

import statistics
from dataclasses import dataclass

from data import ALGORITHMS, CASES

NAMES = dict(zip(ALGORITHMS, ("brute force", "incremental", "optimized incremental", "exact (ours)")))
KEYS = ALGORITHMS[:3]  # the thesis's own
HOLDS, FAILS, UNDECIDED, UNTESTED = ("holds", "does not hold", "undecided", "not tested")
OURS, OBSERVED = "ours", "observed"


@dataclass
class Claim:
    where: str  # figures or section; OURS: of the exact algorithm; OBSERVED: measured beside, not judged
    says: str
    criterion: str
    measured: str
    verdict: str = ""
    note: str = ""  # shown in any case
    why: str = ""  # shown where it does not hold
    must: bool = False  # must hold, or the run fails


def decided(condition):
    return HOLDS if condition else FAILS


def within(values, low, high=float("inf")):
    """Judges one quantity, measured several times: undecided if some values keep the limits and some do not."""
    if all(low <= value <= high for value in values):
        return HOLDS
    return FAILS if min(values) > high or max(values) < low else UNDECIDED


def every(verdicts):
    """Judges a statement about several quantities."""
    verdicts = set(verdicts)
    return next((verdict for verdict in (FAILS, UNDECIDED) if verdict in verdicts), HOLDS)


def percent(share, digits=1):
    return f"{100 * share:.{digits}f} %"


def formatted(value, form):
    return form.format(value).replace("%", " %")


def spread(values, form="{:.2f}"):
    """Returns the median, and the least and the largest value."""
    middle, least, most = (formatted(x, form) for x in (statistics.median(values), min(values), max(values)))
    return f"{middle} ({least}–{most})"


def listed(values, form="{:.2f}"):
    """Returns a value or the spread of some, for each case."""
    texts = {c: spread(v, form) if isinstance(v, list) else formatted(v, form) for c, v in values.items()}
    return ", ".join(f"{CASES[c].removeprefix('Cartesian, ')}: {text}" for c, text in texts.items())
