"""The results of thesis_reproduce, as numbers by lattice, algorithm and resolution."""

import collections
import csv
import math
import pathlib

CASES = {  # (lattice, k) -> title; in the thesis's order
    ("cartesian", "2"): "Cartesian, k = 2",
    ("cartesian", "1"): "Cartesian, k = 1",
    ("cartesian", "0"): "Cartesian, k = 0",
    ("bcc", "0"): "BCC",
}
THESIS = ("brute-force", "incremental", "optimized-incremental")
ALGORITHMS = (*THESIS, "exact")
IDEAL = 1 / (6 * math.sqrt(2) ** 3)  # the tetrahedron's share of its box


class Data:
    def __init__(self, directory):
        def rows(name):
            with open(pathlib.Path(directory) / name, newline="", encoding="utf-8") as file:
                return list(csv.DictReader(file))

        self.settings = {row["key"]: row["value"] for row in rows("settings.csv")}
        self.quick = self.settings["quick"] == "1"
        self.models, self.tables = rows("models.csv"), rows("tables.csv")
        self.accuracy, self.timing = self._grouped(rows("accuracy.csv")), self._grouped(rows("timing.csv"))
        self.resolutions = sorted({key[2] for key in self.accuracy})
        self.top = self.resolutions[-1]

    @staticmethod
    def _grouped(rows):
        groups = collections.defaultdict(list)
        for row in rows:
            groups[(row["lattice"], row["k"]), row["algorithm"], int(row["resolution"])].append(row)
        return groups

    def values(self, case, algorithm, resolution, column):
        return [float(row[column]) for row in self.accuracy[case, algorithm, resolution]]

    def mean(self, case, algorithm, resolution, column):
        return mean(self.values(case, algorithm, resolution, column))

    def all(self, algorithm, column):
        """Returns all values of an algorithm, over all lattices, resolutions and angles."""
        return [x for case in CASES for d in self.resolutions for x in self.values(case, algorithm, d, column)]

    def time(self, case, algorithm, resolution, column="array_seconds"):
        """Returns mean seconds; the exact algorithm has only those of the whole call."""
        column = "seconds" if algorithm == "exact" else column
        return mean([float(row[column]) for row in self.timing[case, algorithm, resolution]])

    def fill_rate(self, case, algorithm, resolution):
        column = "voxels" if algorithm == "exact" else "array_voxels"
        voxels = mean([float(row[column]) for row in self.timing[case, algorithm, resolution]])
        return voxels / self.time(case, algorithm, resolution)

    def lead(self, case, resolution, column):
        """Returns the lead of optimized incremental, as a share of incremental's time."""
        fast, slow = (self.time(case, name, resolution, column) for name in ("optimized-incremental", "incremental"))
        return 1 - fast / slow

    def errors(self, case, algorithm):
        """Returns |Delta(V) - ideal| * D of every run; D is the cube root of the number of points."""
        for d in self.resolutions:
            for row in self.accuracy[case, algorithm, d]:
                yield abs(float(row["displaced_volume"]) - IDEAL) * float(row["points"]) ** (1 / 3)

    def limit(self, case, algorithm):
        """Returns Delta(V) at infinite resolution: v of mean Delta(V) = v + a x + b x^2, with x = points^(-1/3), that
        is 1 / D. Least squares with weights D^2 over D >= 20."""
        rows, values = [], []
        for d in (d for d in self.resolutions if d >= 20):
            x = self.mean(case, algorithm, d, "points") ** (-1 / 3)
            rows.append((1 / x, 1, x))
            values.append(self.mean(case, algorithm, d, "displaced_volume") / x)
        return least_squares(rows, values)[0]

    def slope(self, case, algorithm):
        """Returns the power of the resolution with which time grows: least squares of the logarithms, upper half."""
        half = [d for d in self.resolutions if 2 * d >= self.top]
        rows = [(1, math.log(d)) for d in half]
        return least_squares(rows, [math.log(self.time(case, algorithm, d)) for d in half])[1]

    def model(self, name, case, algorithm):
        for row in self.models:
            if (row["model"], row["case"], row["algorithm"]) == (name, case, algorithm):
                return {key: int(row[key]) for key in ("voxels", "tunnels", "redundant", "tunnels_rounded")}
        return None


def mean(values):
    return sum(values) / len(values)


def least_squares(rows, values):
    """Returns the x that minimizes |rows x - values|, by the normal equations."""
    n = len(rows[0])
    m = [[sum(r[i] * r[j] for r in rows) for j in range(n)] + [sum(r[i] * v for r, v in zip(rows, values))] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(m[r][i]))
        m[i], m[pivot] = m[pivot], m[i]
        for r in range(n):
            if r != i:
                factor = m[r][i] / m[i][i]
                m[r] = [a - factor * b for a, b in zip(m[r], m[i])]
    return [m[i][n] / m[i][i] for i in range(n)]
