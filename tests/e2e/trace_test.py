"""A W3C trace goes from the tool's option or environment to the server's log, for every command that makes a call."""

import json
import os
import unittest

import harness
from harness import BUNNY, Case, latvox

TRACE, SPAN = "4bf92f3577b34da6a3ce929d0e0e4736", "00f067aa0ba902b7"
PARENT = f"00-{TRACE}-{SPAN}-01"
OTHER = f"00-{'a' * 32}-{'b' * 16}-00"
OK, USAGE = 0, 2


class Trace(Case):
    def requests(self):
        """Returns the log's lines of calls so far."""
        lines = [json.loads(line) for line in (self.dir / "latvoxd.log").read_text().splitlines() if line[:1] == "{"]
        return [line for line in lines if line["event"] == "request"]

    def commands(self, server):
        """For each command with a server: its words, and the method that it calls."""
        drawing, jobs = self.dir / "star.txt", self.dir / "jobs.jsonl"
        drawing.write_text("0,0 4,9 8,0 -1,6 9,6 z\n")
        jobs.write_text(json.dumps({"mesh": str(BUNNY), "resolution": 16, "out": "bunny.csv"}) + "\n")
        at = ["--server", server.address]
        return [
            (["voxelize", BUNNY, "--resolution", 16, "-o", self.dir / "out.csv", *at], "Voxelize"),
            (["pixelize", drawing, "--resolution", 16, "-o", self.dir / "star.csv", *at], "Pixelize"),
            (["batch", jobs, "--out", self.dir / "voxels", *at], "Voxelize"),
        ]

    def trace_of(self, words, method, **environment):
        """Returns the log's facts about a call: its trace and the span that called."""
        before = len(self.requests())
        done = latvox(*words, env=os.environ | environment)
        self.assertEqual(done.returncode, OK, done.stderr)
        found = lambda: [line for line in self.requests()[before:] if line["method"] == method]
        lines = harness.await_true("no line of the call in the log", found)
        self.assertEqual(len(lines), 1)
        if "trace_id" not in lines[0]:
            self.assertNotIn("span_id", lines[0])
            return None
        self.assertNotIn(lines[0]["span_id"], (lines[0]["parent_id"], "0" * 16))
        return lines[0]["trace_id"], lines[0]["parent_id"]

    def test_every_command_says_which_trace_its_calls_belong_to(self):
        with harness.server(self.dir, "--log-format", "json") as server:
            for words, method in self.commands(server):
                with self.subTest(words[0]):
                    self.assertEqual(self.trace_of([*words, "--traceparent", PARENT], method), (TRACE, SPAN))
                    self.assertEqual(self.trace_of(words, method, TRACEPARENT=PARENT, TRACESTATE="a=1"), (TRACE, SPAN))
                    both = self.trace_of([*words, "--traceparent", PARENT], method, TRACEPARENT=OTHER)
                    self.assertEqual(both, (TRACE, SPAN))
                    self.assertIsNone(self.trace_of(words, method))
                    self.assertIsNone(self.trace_of(words, method, TRACEPARENT="abc-1", TRACESTATE="a=1"))
            for command in ("health", "limits"):
                done = latvox(command, "--server", server.address, "--traceparent", PARENT)
                self.assertEqual(done.returncode, OK, done.stderr)

    def test_an_option_that_is_malformed_is_wrong_usage(self):
        for bad in ("", "abc-1", PARENT.upper(), PARENT[:-1], f"{PARENT}-more"):
            done = latvox("health", "--server", "127.0.0.1:1", "--traceparent", bad)
            self.assertEqual(done.returncode, USAGE, bad)
            self.assertIn("--traceparent", done.stderr)


if __name__ == "__main__":
    unittest.main()
