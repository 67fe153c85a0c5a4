"""Cancelled calls, and calls past their deadline, stop their work at once, in every stage.

The log gets a call's line when all of its work has ended.
"""

import datetime
import json
import time
import unittest

import stage
from stage import FULL, JOBS, SANITIZED, Faults, percentile

PROMISED_MS = 50
GROSS_MS = 1000
TIMES = 20 if FULL else 8 if SANITIZED else 2
# stage of the call: job, milliseconds into the stage, milliseconds of a deadline that ends in it
STAGES = {
    "upload": ("upload", "medium bunny-256-fcc", 30, 60),
    "decode": ("decode", "huge bunny-x16-512-cartesian", 20, 60),
    "voxelize": ("voxelize", "huge bunny-32768-cartesian", 100, 400),
    "voxelize a tangle": ("voxelize", "huge tangle-128-bcc", 500, 500),
    "stream": ("stream", "huge bunny-8192-cartesian", 800, 1000),
}


def seconds(line):
    return datetime.datetime.fromisoformat(line["time"].replace("Z", "+00:00")).timestamp()


class Cancelled(Faults):
    scenario = "cancel"

    def stop(self, server, what, by):
        stage_name, job, after, deadline = STAGES[what]
        words = ["--after-ms", after] if by == "cancelled" else ["--after-ms", deadline, "--deadline"]
        before = len(server.lines("request"))
        told = stage.faults(
            "cancel",
            "--server",
            server.address,
            "--jobs",
            JOBS,
            "--job",
            job,
            "--stage",
            stage_name,
            "--times",
            TIMES,
            *words,
        )
        stops = [json.loads(line) for line in told.splitlines()]
        end = time.monotonic() + 10
        while len(server.lines("request")) < before + TIMES and time.monotonic() < end:
            time.sleep(0.05)
        ended = server.lines("request")[before:]
        self.assertEqual(len(ended), TIMES, "calls that go on after they were stopped")
        # The log has a resolution of milliseconds.
        took = [max(0.0, (seconds(line) - stop["cancelled"]) * 1000) for line, stop in zip(ended, stops)]
        # At its deadline the client also cancels by itself; either may come first.
        codes = {"cancelled": ("CANCELLED",), "deadline": ("CANCELLED", "DEADLINE_EXCEEDED")}[by]
        self.figure(
            f"{what}, {by}: calls that ended so",
            sum(line["code"] in codes for line in ended),
            f"of {TIMES}",
            "some",
            any(line["code"] in codes for line in ended),
        )
        self.figure(f"{what}, {by}: work went on for, p50", percentile(took, 50), "ms")
        self.bounded(
            f"{what}, {by}: work went on for, at most", max(took), "ms", promised=PROMISED_MS, fails_over=GROSS_MS
        )

    def test_work_stops_in_every_stage(self):
        with stage.server(self.dir, "--decode-always") as server:
            for what in STAGES:
                for by in ("cancelled", "deadline"):
                    with self.subTest(what, by=by):
                        self.stop(server, what, by)
            idle = server.cpu()
            time.sleep(1)
            self.figure(
                "processor time of the server in a second after",
                server.cpu() - idle,
                "s",
                "< 0.1",
                server.cpu() - idle < 0.1,
            )
            self.assert_serves(server)


if __name__ == "__main__":
    unittest.main()
