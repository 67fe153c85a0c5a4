"""The gateway for browsers: 200 clients at once, readers that stop, and its sudden death under load."""

import asyncio
import base64
import datetime
import json
import os
import re
import sys
import time
import unittest

import stage
from stage import MIB, ROOT, SECONDS, Faults, Watch, percentile, tally

sys.path.insert(0, str(ROOT / "tests" / "deploy"))

from gateway import SERVICE, Gateway, gateway, raw  # noqa: E402
from harness import octahedron  # noqa: E402

CLIENTS = 200
READERS = 12
BYTES_A_READER = 40 * MIB  # a message of latvoxd, its JSON, and the buffers of two connections
LOAD = max(3, SECONDS / 4)
GROSS_MS = 1000
ABOUT, DATA, NAME = raw(octahedron(7.0))
SPEC = {"lattice": {"named": "NAMED_LATTICE_BCC"}, "resolution": 40, "rawMesh": ABOUT}
BIG = {**SPEC, "resolution": 3000, "supercover": {}, "meshSha256": base64.b64encode(NAME).decode()}
SMALL_CALL = (
    "VoxelizeSmall",
    "application/json",
    json.dumps({"spec": SPEC, "mesh": base64.b64encode(DATA).decode()}).encode(),
)


def stream_call():
    body = json.dumps({"spec": BIG}).encode()
    return "VoxelizeStored", "application/connect+json", b"\0" + len(body).to_bytes(4, "big") + body


async def begin(running, method, kind, body):
    """Sends a call. Returns the two ends of its connection."""
    host, port = running.address.split(":")
    reader, writer = await asyncio.open_connection(host, int(port))
    head = f"POST {SERVICE}{method} HTTP/1.1\r\nHost: a\r\nConnection: close\r\n"
    head += f"Content-Type: {kind}\r\nContent-Length: {len(body)}\r\n\r\n"
    writer.write(head.encode() + body)
    await writer.drain()
    return reader, writer


async def small(running):
    """Returns the outcome of a small call: its digest, or its error; and its milliseconds."""
    began = time.monotonic()
    try:
        reader, writer = await begin(running, *SMALL_CALL)
        answer = (await reader.read()).decode(errors="replace")
        writer.close()
    except OSError as error:
        answer = type(error).__name__
    found = re.search(r'"digest":"(\w+)"', answer) or re.search(r'"reason":"(\w+)"', answer)
    return (found[1] if found else answer[:80] or "nothing"), 1000 * (time.monotonic() - began)


async def load(running, clients, seconds):
    """Returns the outcomes of so many clients that make one call after the other."""
    end = time.monotonic() + seconds

    async def client():
        found = []
        while time.monotonic() < end:
            found.append(await small(running))
        return found

    return [each for found in await asyncio.gather(*(client() for _ in range(clients))) for each in found]


class GatewayFaults(Faults):
    scenario = "gateway"

    def upload(self, running):
        spec = {"meshSha256": BIG["meshSha256"], "meshBytes": len(DATA), "rawMesh": ABOUT}
        status, _, answer = running.post("UploadMesh", {"spec": spec, "meshPiece": base64.b64encode(DATA).decode()})
        self.assertEqual((status, answer.get("stored")), (200, True), answer)

    def judge(self, what, outcomes, right):
        """Adds lines about calls, which must be right or refused for a while."""
        kinds = tally("right" if said == right else said for said, _ in outcomes)
        allowed = {right, "TOO_MANY_JOBS", "TOO_MANY_JOBS_OF_CLIENT", "MEMORY_IN_USE"}
        self.figure(f"{what}: calls", kinds, "", "right or refused", all(said in allowed for said, _ in outcomes))
        times = [ms for said, ms in outcomes if said == right]
        self.figure(f"{what}: right ones", len(times), "", "some", bool(times))
        self.figure(f"{what}: p50 / p99", f"{percentile(times, 50):.0f} / {percentile(times, 99):.0f}", "ms")

    def descriptors(self, running):
        return len(os.listdir(f"/proc/{running.process.pid}/fd"))

    def test_many_clients(self):
        with stage.server(self.dir, "--max-jobs-per-client", "300") as server, gateway(
            self.dir, server.address
        ) as running:
            right = asyncio.run(small(running))[0]
            before = self.descriptors(running)
            self.judge(f"{CLIENTS} clients", asyncio.run(load(running, CLIENTS, LOAD)), right)
            time.sleep(1)
            self.figure(
                f"{CLIENTS} clients: the gateway's memory at most",
                running.memory() / MIB,
                "MiB",
                "<= 1024",
                running.memory() <= 1024 * MIB,
            )
            more = self.descriptors(running) - before
            self.figure(f"{CLIENTS} clients: files left open", more, "", "<= 4, connections to latvoxd", more <= 4)

    def test_readers_that_stop(self):
        async def readers(running):
            ends = [await begin(running, *stream_call()) for _ in range(READERS)]
            for reader, _ in ends:
                await reader.readexactly(1000)
                reader._transport.pause_reading()
            await asyncio.sleep(1)
            outcomes = await load(running, 1, LOAD)
            for _, writer in ends:
                writer.transport.abort()
            return outcomes

        with stage.server(self.dir) as server, gateway(self.dir, server.address) as running:
            self.upload(running)
            right = asyncio.run(small(running))[0]
            rest, server_rest = running.memory(), stage.memory(stage.descendants(server.pid))
            with Watch(server) as watch:
                outcomes = asyncio.run(readers(running))
            self.judge("beside readers that stop", outcomes, right)
            for name, grown in (("gateway", running.memory() - rest), ("server", watch.peak - server_rest)):
                each = grown / READERS
                self.figure(
                    f"readers that stop: memory of the {name} for each",
                    each / MIB,
                    "MiB",
                    f"<= {BYTES_A_READER // MIB}",
                    each <= BYTES_A_READER,
                )
            running.await_log("method=VoxelizeStored .*code=CANCELLED", READERS)

    def test_sudden_death(self):
        async def streams(running):
            ends = [await begin(running, *stream_call()) for _ in range(READERS)]
            for reader, _ in ends:
                await reader.readexactly(1000)
            running.process.kill()
            killed = time.time()
            for _, writer in ends:
                writer.transport.abort()
            return killed

        with stage.server(self.dir) as server:
            running = Gateway(self.dir, server.address)
            self.addCleanup(running.process.wait)
            self.addCleanup(running.process.kill)
            self.upload(running)
            right = asyncio.run(small(running))[0]
            killed = asyncio.run(streams(running))
            running.process.wait()
            end = time.monotonic() + 10
            ended = []
            while len(ended) < READERS and time.monotonic() < end:
                time.sleep(0.02)
                ended = [line for line in server.lines("request") if line["method"] == "VoxelizeStored"]
            self.figure("killed: calls that latvoxd gave up", len(ended), f"of {READERS}", "all", len(ended) == READERS)
            last = max(line["time"] for line in ended)
            took = 1000 * (datetime.datetime.fromisoformat(last.replace("Z", "+00:00")).timestamp() - killed)
            self.bounded(
                "killed: until latvoxd gave up the last of its calls", took, "ms", promised=50, fails_over=GROSS_MS
            )
            with gateway(self.dir, server.address) as again:
                said = asyncio.run(small(again))[0]
                self.figure("killed and started again: a call", said, "", f"{right}, the right digest", said == right)


if __name__ == "__main__":
    unittest.main()
