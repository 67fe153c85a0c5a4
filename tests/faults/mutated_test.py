"""Tens of thousands of requests that are nearly right."""

import json
import time
import unittest

import stage
from stage import FULL, MESHES, MIB, SEED, Faults, Watch

REQUESTS = 100_000 if FULL else 5_000


class Mutated(Faults):
    scenario = "mutated"

    def test_mutated_requests_do_no_harm(self):
        # Fast machines send more calls than one host may; the scenario "attacks" tests that limit.
        with stage.server(self.dir, "--max-jobs", "256", "--behind-proxy") as server:
            start = time.monotonic()
            with Watch(server) as watch:
                told = stage.faults(
                    "mutate",
                    "--server",
                    server.address,
                    "--mesh",
                    MESHES / "sphere.drc",
                    "--requests",
                    REQUESTS,
                    "--seed",
                    SEED,
                )
            took = time.monotonic() - start
            told = json.loads(told)
            self.figure("requests", sum(told["counts"].values()), f"in {took:.0f} s")
            for what, count in told["counts"].items():
                self.figure(what, count)
            for complaint in told["complaints"]:
                print(complaint)
            self.figure("defects of the server told", len(told["complaints"]), "", "0", not told["complaints"])
            self.figure("peak memory of the server and its decoders", watch.peak_all / MIB, "MiB")
            self.assert_serves(server)


if __name__ == "__main__":
    unittest.main()
