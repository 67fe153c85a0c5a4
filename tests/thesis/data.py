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
QUICK_STEP = 12  # a quick run measures every 12th angle


class Data:
    def __init__(self, directory):
        def rows(name):
            with open(pathlib.Path(directory) / name, newline="", encoding="utf-8") as file:
                return list(csv.DictReader(file))

        self.settings = {row["key"]: row["value"] for row in rows("settings.csv")}
        self.quick = self.settings["quick"] == "1"
        self.models, self.tables, self.precision = rows("models.csv"), rows("tables.csv"), rows("precision.csv")
        self.accuracy = self._grouped(rows("accuracy.csv"))
        rounds = range(1, 1 + len(list(pathlib.Path(directory).glob("timing-*.csv"))))
        self.timing = [self._grouped(rows(f"timing-{n}.csv")) for n in rounds]
        self.orientation = [rows(f"orientation-{n}.csv") for n in rounds]
        self.resolutions = sorted({key[2] for key in self.accuracy})
        self.timed = sorted({key[2] for key in self.timing[0]})
        self.top = self.resolutions[-1]
        self.upper = [d for d in self.timed if 2 * d >= self.top]  # for trends

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

    def times(self, case, algorithm, resolution, column="array_seconds"):
        """Returns for each round the mean seconds over the angles; the exact algorithm has only those of the whole call."""
        column = "seconds" if algorithm == "exact" and column == "array_seconds" else column
        return [mean([float(row[column]) for row in timing[case, algorithm, resolution]]) for timing in self.timing]

    def fill_rates(self, case, algorithm, resolution):
        """Returns for each round the voxels a second."""
        column = "voxels" if algorithm == "exact" else "array_voxels"
        voxels = mean([float(row[column]) for row in self.timing[0][case, algorithm, resolution]])
        return [voxels / seconds for seconds in self.times(case, algorithm, resolution)]

    def leads(self, case, resolution, column):
        """Returns for each round the lead of optimized incremental, as a share of incremental's time."""
        fast, slow = (self.times(case, name, resolution, column) for name in ("optimized-incremental", "incremental"))
        return [1 - a / b for a, b in zip(fast, slow)]

    def across(self, case, algorithm, resolution):
        """Returns for each round the time for a voxel of the triangle across the volume, over that of the parallel one."""
        ratios = []
        for rows in self.orientation:
            found = {
                row["orientation"]: float(row["array_seconds"]) / float(row["array_voxels"])
                for row in rows
                if (row["lattice"], row["k"]) == case and (row["algorithm"], row["resolution"]) == (algorithm, str(resolution))
            }
            ratios.append(found["across"] / found["parallel"])
        return ratios

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

    def slopes(self, case, algorithm):
        """Returns for each round the power of the resolution with which time grows: least squares of the logarithms, upper
        half of the resolutions."""
        rows = [(1, math.log(d)) for d in self.upper]
        times = [self.times(case, algorithm, d) for d in self.upper]
        return [least_squares(rows, [math.log(seconds) for seconds in row])[1] for row in zip(*times)]

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
