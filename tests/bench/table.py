"""Measures the cells of tests/bench/run's table, and writes the table.

Usage: table.py PROGRAMS DIRECTORY [--quick] [--mesh NAME,...] [--resolution N,...]
  PROGRAMS    the folder of latvox_bench
  DIRECTORY   the folder of dragon.ply; table.csv, streams.csv, table.md and table.svg are written there
Paths are relative to the working directory. Exits with 1 if a digest differs from the scalar kernels'.
"""

import argparse
import dataclasses
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

import report
from commands import Bench

BUNNY = "/usr/share/glmark2/models/bunny.obj"
HORSE = "/usr/share/glmark2/models/horse.3ds"
RESOLUTIONS = (256, 512, 1024, 2048, 4096)
LATTICES = (("cartesian", 0), ("cartesian", 1), ("cartesian", 2), ("bcc", 0), ("fcc", 0))  # with separability
SIMDS = ("scalar", "avx2", "avx512")
THREADS = (1, 2, 16)  # at most as many as there are cores
REFERENCE = ("scalar", 1)


@dataclasses.dataclass
class Effort:
    meshes: tuple
    resolutions: tuple
    rounds: int  # of all cells of a mesh at a resolution
    seconds: float  # on one cell, until it takes no part in further rounds
    limit: float  # seconds of one repetition; above them no higher resolution is tried
    streams: tuple  # arguments of latvox_bench, after a name


FULL = Effort(
    ("bunny", "horse", "dragon", "dragon x16", "box", "sphere"),
    RESOLUTIONS,
    5,
    4,
    60,
    (
        ("bunny", "1024 --separability 2 --cancel"),
        ("bunny", "8192 --separability 2 --cancel"),
        ("bunny", "16384 --separability 2 --cancel"),
        ("bunny", "65536 --separability 2"),
        ("bunny", "65536 --separability 2 --region 32768,32768,0,32832,32832,65536"),
        ("box", "1024 --separability 2 --cancel"),
        ("box", "16384 --separability 2 --cancel"),
        ("box", "65536 --separability 2"),
        ("dragon x16", "1024 --cancel"),
        ("sphere", "1024 --cancel"),
    ),
)
QUICK = Effort(
    ("bunny", "dragon", "box"),
    (256, 1024),
    3,
    0.3,
    5,
    (("bunny", "4096 --separability 2 --cancel"), ("dragon", "1024 --cancel")),
)


def mesh_words(name, directory):
    """Returns a mesh as arguments of latvox_bench."""
    dragon = str(directory / "dragon.ply")
    return {
        "bunny": [BUNNY],
        "horse": [HORSE],
        "dragon": [dragon],
        "dragon x16": [dragon, "--subdivide", "2"],
        "box": ["box"],
        "sphere": ["sphere:20000000"],
    }[name]


@dataclasses.dataclass
class Cell:
    """One program on one mesh, with one set of options."""

    mesh: str
    resolution: int
    lattice: str
    separability: int
    program: str  # exact, optimized-incremental, openvdb
    simd: str  # of the exact program only
    threads: int
    samples: list = dataclasses.field(default_factory=list)  # milliseconds
    spent: float = 0  # seconds
    first: dict = None  # first answer
    left_out: str = ""  # the reason, if it is left out

    def key(self):
        """Returns everything except the resolution."""
        return (self.mesh, self.lattice, self.separability, self.program, self.simd, self.threads)

    def words(self):
        out = [str(self.resolution), "--lattice", self.lattice, "--separability", str(self.separability)]
        out += ["--threads", str(self.threads)]
        if self.program == "openvdb":
            return out + ["--peer", "openvdb"]
        return out + ["--algorithm", self.program] + (["--simd", self.simd] if self.simd else [])

    def measure(self, bench, mesh):
        """Adds samples. The first is of a cold process and gives the memory, too; the others are of warm ones."""
        repetitions = ["--reps", "1"]
        if self.first:
            warm = 1 + min(6, int(100 / self.samples[0]))
            repetitions = ["--warmups", "1", "--reps", str(warm)]
        start = time.monotonic()
        answer = bench.ask(mesh + self.words() + repetitions)
        self.spent += time.monotonic() - start
        if "error" in answer:
            self.left_out = answer["error"]
            return
        self.samples += answer["ms"]
        self.first = self.first or answer

    def row(self):
        first, least = self.first, min(self.samples)
        return {
            "mesh": self.mesh,
            "triangles": first["triangles"],
            "resolution": self.resolution,
            "lattice": self.lattice,
            "separability": self.separability,
            "program": self.program,
            "simd": self.simd,
            "threads": self.threads,
            "repetitions": len(self.samples),
            "voxels": first["voxels"],
            "ms_min": round(least, 4),
            "ms_median": round(statistics.median(self.samples), 4),
            "ns_per_triangle": round(least * 1e6 / first["triangles"], 2),
            "mvoxels_per_s": round(first["voxels"] / least / 1e3, 2),
            "job_peak_mb": round(first["job_peak_bytes"] / 1e6, 2) if first["job_peak_bytes"] is not None else None,
            "ms_first_brick": first["ms_first_brick"],
            "digest": first["digest"],
        }


def cells_of(mesh, resolution, simds, threads):
    """Yields all cells of a mesh at a resolution. The reference of each lattice comes before the cells compared with
    it."""
    for lattice, k in LATTICES:
        for count in threads:
            for simd in simds:
                yield Cell(mesh, resolution, lattice, k, "exact", simd, count)
            if (lattice, k) == LATTICES[0]:
                yield Cell(mesh, resolution, lattice, k, "openvdb", "", count)
        yield Cell(mesh, resolution, lattice, k, "optimized-incremental", "", 1)


def available_memory():
    with open("/proc/meminfo") as meminfo:
        return next(int(line.split()[1]) * 1024 for line in meminfo if line.startswith("MemAvailable"))


def reason_to_leave_out(cell, before, limit):
    """Decides by the same cell at a lower resolution. Results, and memory with them, grow with the square of the
    resolution."""
    lower = before.get(cell.key())
    if lower is None:
        return ""
    if lower.left_out:
        return lower.left_out
    seconds = min(lower.samples) / 1000
    if seconds > limit:
        return f"{seconds:.0f} s a run at {lower.resolution}"
    expected = (cell.resolution / lower.resolution) ** 2 * (lower.first["job_peak_bytes"] or 0)
    if expected > available_memory():
        return f"{expected / 1e9:.0f} GB to be expected, more than there is"
    return ""


class Table:
    def __init__(self, programs, directory, effort):
        self.programs, self.directory, self.effort = programs, directory, effort
        self.threads = [count for count in THREADS if count <= os.cpu_count()]
        self.rows, self.streams, self.notes, self.differing = [], [], [], []
        self.simds = [simd for simd in SIMDS if self.has(simd)]

    def has(self, simd):
        probe = [self.programs / "latvox_bench", "box", "16", "--reps", "1", "--simd", simd]
        done = subprocess.run(probe, capture_output=True, text=True)
        if done.returncode == 0:
            return True
        if done.returncode != 3:
            sys.exit(f"bench/run: {done.stderr.strip()}")
        self.notes.append(f"{simd}: left out: {done.stderr.strip()}")
        return False

    def measure_mesh(self, mesh):
        bench, before = Bench(self.programs), {}
        for resolution in self.effort.resolutions:
            start = time.monotonic()
            cells = list(cells_of(mesh, resolution, self.simds, self.threads))
            for cell in cells:
                cell.left_out = reason_to_leave_out(cell, before, self.effort.limit)
            self.interleave(bench, cells)
            self.compare_digests(cells)
            before = {cell.key(): cell for cell in cells}
            self.rows += [cell.row() for cell in cells if cell.first]
            self.note_left_out(cells)
            print(f"{mesh} {resolution}: {len(cells)} cells, {time.monotonic() - start:.0f} s", file=sys.stderr)
            report.write(self)
        bench.close()

    def interleave(self, bench, cells):
        """Each round takes every cell once, so that other load hits all cells alike. Our cells run at least twice."""
        for done in range(self.effort.rounds):
            for cell in cells:
                wanted = cell.spent < self.effort.seconds or (done < 2 and cell.program == "exact")
                if wanted and not cell.left_out:
                    cell.measure(bench, mesh_words(cell.mesh, self.directory))

    def compare_digests(self, cells):
        exact = [cell for cell in cells if cell.program == "exact" and cell.first]
        reference = {cell.lattice + str(cell.separability): cell for cell in reversed(exact)}  # the first cell of each
        for cell in exact:
            expected = reference[cell.lattice + str(cell.separability)]
            if (expected.simd, expected.threads) != REFERENCE:
                self.notes.append(f"{cell.mesh} {cell.resolution} {cell.lattice}: no scalar reference to compare with")
            if cell.first["digest"] != expected.first["digest"]:
                where = f"{cell.mesh} {cell.resolution} {cell.lattice} k={cell.separability} {cell.simd}, threads: {cell.threads}"
                self.differing.append(where)
                print(f"bench/run: THE DIGEST DIFFERS from the scalar kernels': {where}", file=sys.stderr)

    def note_left_out(self, cells):
        for cell in cells:
            if cell.left_out:
                what = f"{cell.program} {cell.simd}".strip()
                where = f"{cell.mesh} {cell.resolution} {cell.lattice} k={cell.separability}"
                self.notes.append(f"{where}, {what}, threads: {cell.threads}: left out: {cell.left_out}")

    def measure_stream(self, mesh, words):
        """Bricks are dropped as they arrive, in a process of its own."""
        command = [self.programs / "latvox_bench", *mesh_words(mesh, self.directory), *words.split()]
        command += ["--reps", "1", "--discard", "--json", "--threads", str(min(2, os.cpu_count()))]
        done = subprocess.run(command, stdout=-1, text=True)
        if done.returncode != 0:
            sys.exit(f"bench/run: failed: {' '.join(map(str, command))}")
        self.streams.append({"mesh": mesh, "arguments": words.replace(" --cancel", ""), **json.loads(done.stdout)})
        print(f"{mesh} {words}: {self.streams[-1]['ms_min'] / 1000:.1f} s", file=sys.stderr)
        report.write(self)


def chosen(all_values, text):
    """Returns the values of all_values that a comma-separated list names; all of them if there is no list."""
    if not text:
        return all_values
    names = {str(value): value for value in all_values}
    try:
        return tuple(names[name] for name in text.split(","))
    except KeyError as unknown:
        sys.exit(f"bench/run: {unknown} is none of {', '.join(names)}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--mesh")
    parser.add_argument("--resolution")
    arguments = parser.parse_args()
    effort = QUICK if arguments.quick else FULL
    if arguments.mesh or arguments.resolution:
        meshes, resolutions = chosen(FULL.meshes, arguments.mesh), chosen(RESOLUTIONS, arguments.resolution)
        effort = dataclasses.replace(effort, meshes=meshes, resolutions=resolutions, streams=())
    table = Table(arguments.programs, arguments.directory, effort)
    for mesh in effort.meshes:
        table.measure_mesh(mesh)
    for mesh, words in effort.streams:
        table.measure_stream(mesh, words)
    sys.exit(1 if table.differing else 0)


if __name__ == "__main__":
    main()
