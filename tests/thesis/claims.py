"""The thesis's statements, each with a criterion that the data decide."""

from accuracy_claims import accuracy_claims
from model_claims import model_claims
from time_claims import time_claims
from verdict import OURS, Claim, decided


def all_claims(data):
    return [*accuracy_claims(data), *time_claims(data), *model_claims(data), *table_claims(data)]


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
        decided(len(valid) == len(rows)),
    )
    yield Claim(
        "4.1–4.4",
        "det(V⁻¹M) = 1.",
        "in every row",
        f"−1 for ({'), ('.join(negative)})" if negative else "in every row",
        decided(not negative),
        why="Harmless: the criterion that matters is |det| = 1.",
    )
    yield Claim(
        "4.1–4.4",
        "N is V⁻¹M.",
        "in every row, with V of eq. 4.3",
        f"not in {len(wrong)} rows of table 4.4: ({'), ('.join(wrong)})" if wrong else "in every row",
        decided(not wrong),
        why="The printed N belongs to another V, or is mistaken; the M beside it are right.",
    )
    yield Claim(
        OURS,
        "The matrices of this program, found for any lattice, are valid.",
        "det N = 1 in every row",
        f"{sum(row['our_det_n'] == '1' for row in rows)} of {len(rows)} rows",
        decided(all(row["our_det_n"] == "1" for row in rows)),
        must=True,
    )
