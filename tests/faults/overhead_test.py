"""The cost of the service over decoding and voxelizing in one process, and the part of it that separate decoders cause.

Two cases. Warm: the server keeps the decoded mesh, so it does not decode again; the single process does. This is the
case of a mesh that is requested more than once, and the promise covers it. New: the server decodes each time, too, so
both do the same work. Nothing is promised for it.
"""

import json
import re
import subprocess
import unittest

import stage
from stage import BIN, FULL, MESHES, Faults

PROMISED = 15
GROSS = 150
ROUNDS = 100 if FULL else 20


class Overhead(Faults):
    scenario = "overhead"

    def test_the_service_costs_little(self):
        with stage.server(self.dir) as server:
            self.measure(server, "warm", promised=PROMISED)

    def test_a_new_mesh_is_measured(self):
        with stage.server(self.dir, "--decode-always") as server:
            self.measure(server, "a new mesh")

    def measure(self, server, state, promised=None):
        for separability in (0, 2):
            options = ["--resolution", 512, "--separability", separability, "--rounds", ROUNDS]
            told = json.loads(
                stage.faults("overhead", "--server", server.address, "--mesh", MESHES / "bunny.drc", *options)
            )
            percent = 100 * (told["service_ms"] / told["process_ms"] - 1)
            best = 100 * (told["service_min_ms"] / told["process_min_ms"] - 1)
            what = f"bunny at 512, k = {separability}, {state}"
            for name, ms in told.items():
                self.figure(f"{what}: {name.removesuffix('_ms').replace('_', ' ')}", float(ms), "ms")
            self.bounded(
                f"{what}: more than in one process, medians", percent, "%", promised=promised, fails_over=GROSS
            )
            self.figure(f"{what}: more than in one process, minima", best, "%")

    def test_a_confined_decoder_costs_little(self):
        """At most 5 %, or 2 ms, whichever is more."""
        for name in ("bunny", "bunny-x4"):
            command = [BIN / "latvox_bench_decoders", MESHES / f"{name}.drc"]
            told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            # The program prints medians, with minima in brackets.
            one, confined = map(float, re.search(r"in process ([\d.]+) ms .* isolated ([\d.]+) ", told).groups())
            what = f"{name}, decoded in a confined process"
            self.figure(f"{what}: median, and in one process", f"{confined:.1f}, {one:.1f}", "ms")
            most = max(2, round(one / 20, 1))
            self.bounded(f"{what}: more than in one process", confined - one, "ms", promised=most, fails_over=10 * most)


if __name__ == "__main__":
    unittest.main()
