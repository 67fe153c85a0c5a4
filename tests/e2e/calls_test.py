"""Callers that cannot stream upwards get the same voxels and the same errors, and need tokens as all others:
UploadMesh, VoxelizeStored, VoxelizeSmall."""

import functools
import hashlib
import importlib
import pathlib
import struct
import subprocess
import sys
import time
import unittest

import grpc

import harness
from harness import Case

PROTO = pathlib.Path(__file__).resolve().parents[2] / "proto"


def torus(n):
    """A raw mesh of 2 n^2 triangles. Returns RawMesh's arrays and its numbers of vertices and triangles."""
    from math import cos, pi, sin

    turn = [(cos(2 * pi * i / n), sin(2 * pi * i / n)) for i in range(n)]
    vertices = [((3 + c) * x, (3 + c) * y, s) for x, y in turn for c, s in turn]
    at = lambda i, j: i % n * n + j % n
    triangles = [t for i in range(n) for j in range(n)
                 for t in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))]
    mesh = b"".join(struct.pack("<3f", *v) for v in vertices) + b"".join(struct.pack("<3I", *t) for t in triangles)
    return mesh, len(vertices), len(triangles)


class Calls(Case):
    def setUp(self):
        super().setUp()
        subprocess.run(["protoc", "-I", PROTO, f"--python_out={self.dir}", "latvox/v1/voxelizer.proto"], check=True)
        sys.path.insert(0, str(self.dir))
        self.addCleanup(sys.path.remove, str(self.dir))
        if "latvox.v1.voxelizer_pb2" not in sys.modules:
            importlib.import_module("latvox.v1.voxelizer_pb2")
        self.pb = sys.modules["latvox.v1.voxelizer_pb2"]
        self.mesh, vertices, triangles = torus(60)
        self.raw = self.pb.RawMesh(vertices=vertices, triangles=triangles)
        self.metadata = ()

    def open(self, *options):
        server = self.enterContext(harness.server(self.dir, *options))
        self.channel = self.enterContext(grpc.insecure_channel(server.address, [("grpc.max_receive_message_length", -1)]))

    def method(self, name, kind, request, response):
        path = f"/latvox.v1.Voxelizer/{name}"
        call = getattr(self.channel, kind)(path, request.SerializeToString, response.FromString)
        return functools.partial(call, metadata=self.metadata)

    def spec(self, resolution=40, **more):
        lattice = self.pb.Lattice(named=self.pb.NAMED_LATTICE_BCC)
        return self.pb.VoxelizeSpec(lattice=lattice, resolution=resolution, raw_mesh=self.raw, separability=1,
                                    fields=[self.pb.FIELD_DISTANCE], **more)

    def upload(self, offset, piece, **changes):
        stored = {"mesh_sha256": hashlib.sha256(self.mesh).digest(), "mesh_bytes": len(self.mesh), "raw_mesh": self.raw}
        request = self.pb.UploadMeshRequest(spec=self.pb.PutMeshSpec(**stored | changes), offset=offset, mesh_piece=piece)
        return self.method("UploadMesh", "unary_unary", self.pb.UploadMeshRequest, self.pb.UploadMeshResponse)(request)

    def upload_all(self, piece=1 << 16):
        answer = self.upload(0, b"")
        while not answer.stored:
            answer = self.upload(answer.next_offset, self.mesh[answer.next_offset:][:piece])
        self.assertEqual(answer.next_offset, len(self.mesh))

    def stream(self):
        def requests():
            yield self.pb.VoxelizeRequest(spec=self.spec())
            for at in range(0, len(self.mesh), 50000):
                yield self.pb.VoxelizeRequest(mesh_piece=self.mesh[at : at + 50000])

        call = self.method("Voxelize", "stream_stream", self.pb.VoxelizeRequest, self.pb.VoxelizeResponse)
        return list(call(requests()))

    def stored(self, **more):
        call = self.method("VoxelizeStored", "unary_stream", self.pb.VoxelizeStoredRequest, self.pb.VoxelizeResponse)
        digest = hashlib.sha256(self.mesh).digest()
        return call(self.pb.VoxelizeStoredRequest(spec=self.spec(mesh_sha256=digest, **more)))

    def small(self, mesh, **more):
        call = self.method("VoxelizeSmall", "unary_unary", self.pb.VoxelizeSmallRequest, self.pb.VoxelizeSmallResponse)
        return call(self.pb.VoxelizeSmallRequest(spec=self.spec(**more), mesh=mesh))

    def refused(self, code, words, call, *arguments, **more):
        with self.assertRaises(grpc.RpcError) as caught:
            answer = call(*arguments, **more)
            list(answer if hasattr(answer, "__next__") else ())
        self.assertEqual(caught.exception.code(), code)
        self.assertIn(words, caught.exception.details())
        return caught.exception

    def test_every_style_gives_the_same_voxels(self):
        self.open()
        streamed = self.stream()
        bricks = [message.bricks for message in streamed[1:-1]]
        certificate = streamed[-1].summary.certificate
        self.assertGreater(streamed[-1].summary.voxels, 1000)
        self.refused(grpc.StatusCode.NOT_FOUND, "does not have this mesh", self.stored)
        self.upload_all()
        stored, small = list(self.stored()), self.small(self.mesh)
        self.assertEqual(self.small(b"", mesh_sha256=hashlib.sha256(self.mesh).digest()).summary.certificate, certificate)
        self.assertEqual(stored[-1].summary.certificate, certificate)
        self.assertEqual(small.summary.certificate, certificate)
        without_progress = lambda batches: b"".join(b.masks + b"".join(f.values for f in b.fields) for b in batches)
        self.assertEqual(without_progress(m.bricks for m in stored[1:-1]), without_progress(bricks))
        self.assertEqual(without_progress(small.bricks), without_progress(bricks))
        self.assertEqual((small.accepted.grid, stored[0].accepted.grid), (streamed[0].accepted.grid,) * 2)

        tile = [x >> 3 for x in bricks[0].brick_ijk[:3]]
        rest = list(self.stored(resume_after=self.pb.Ijk(i=tile[0], j=tile[1], k=tile[2])))[-1].summary
        self.assertTrue(0 < rest.voxels < streamed[-1].summary.voxels)

    def test_an_upload_goes_on_where_it_was(self):
        self.open()
        wrong = grpc.StatusCode.INVALID_ARGUMENT
        self.assertEqual(self.upload(0, b"").next_offset, 0)
        self.assertEqual(self.upload(0, self.mesh[:1000]).next_offset, 1000)
        self.assertEqual(self.upload(0, self.mesh[:1000]).next_offset, 1000, "a repeated piece")
        self.assertEqual(self.upload(500, self.mesh[500:1700]).next_offset, 1700, "partly repeated")
        self.refused(wrong, "offset 1701 is beyond the 1700 bytes", self.upload, 1701, b"x")
        self.assertEqual(self.upload(99999, b"").next_offset, 1700, "a question")
        self.refused(wrong, "mesh_piece: the bytes from 3 on", self.upload, 3, b"other")
        self.assertEqual(self.upload(0, b"").next_offset, 0, "begins again")
        self.upload_all()
        self.assertTrue(self.upload(7, b"whatever").stored)

    def test_bad_uploads_name_what_is_wrong(self):
        self.open()
        wrong = grpc.StatusCode.INVALID_ARGUMENT
        self.refused(wrong, "mesh_bytes 9 was declared, but at least 10 bytes came", self.upload, 0, b"x" * 10, mesh_bytes=9, raw_mesh=None)
        self.refused(wrong, "mesh_sha256 has 3 bytes", self.upload, 0, b"", mesh_sha256=b"abc")
        self.refused(wrong, "vertex 0 is not finite", self.upload, 0, b"\xff" * 12)
        other = bytes(32)
        self.upload(0, self.mesh[:-1], mesh_sha256=other)
        self.refused(wrong, "the mesh that came has another digest", self.upload, len(self.mesh) - 1, self.mesh[-1:], mesh_sha256=other)
        self.assertEqual(self.upload(0, b"", mesh_sha256=other).next_offset, 0)
        self.refused(wrong, "mesh_sha256 is not set", lambda: self.method(
            "VoxelizeStored", "unary_stream", self.pb.VoxelizeStoredRequest, self.pb.VoxelizeResponse)(
                self.pb.VoxelizeStoredRequest(spec=self.spec())))

    def test_one_message_has_limits_that_name_the_way_out(self):
        self.open("--max-message-bytes", "100000")
        full = grpc.StatusCode.RESOURCE_EXHAUSTED
        self.refused(full, "UploadMesh and VoxelizeStored have no such limit", self.small, self.mesh)
        self.refused(full, "message_bytes", self.upload, 0, self.mesh)
        self.upload_all(90000)
        digest = hashlib.sha256(self.mesh).digest()
        self.refused(full, "exceeds 100000; UploadMesh and VoxelizeStored", self.small, b"", mesh_sha256=digest, resolution=300)
        self.assertGreater(list(self.stored(resolution=300))[-1].summary.voxels, 100000)
        self.refused(grpc.StatusCode.INVALID_ARGUMENT, "only 0 bytes came", self.small, b"")

    def test_a_cancelled_call_ends_at_once(self):
        self.open("--threads", "1")
        self.upload_all()
        call = self.stored(resolution=4000)
        self.assertTrue(next(call).HasField("accepted"))
        began = time.monotonic()
        call.cancel()
        harness.await_log(self.dir, r"method=VoxelizeStored .*code=CANCELLED")
        self.assertLess(time.monotonic() - began, 5)

    def use_token_of(self, name):
        self.metadata = (("authorization", f"Bearer {name}-0123456789abcdef"),)

    def open_with_tokens(self, **limits):
        """Opens a server with a token for `alice`, and for each name of `limits` one with these limits."""
        lines = [f"{name} {name}-0123456789abcdef {words}\n" for name, words in {"alice": "", **limits}.items()]
        (self.dir / "tokens").write_text("".join(lines))
        self.open("--token-file", self.dir / "tokens")

    def unary_calls(self):
        """The three calls for callers that cannot stream upwards."""
        return [(self.upload, 0, self.mesh), (self.stored,), (self.small, self.mesh)]

    def test_each_call_needs_a_good_token(self):
        self.open_with_tokens()
        good = "Bearer alice-0123456789abcdef"
        other, wrong_scheme = "Bearer mallory-0123456789abc", "Basic " + good[7:]
        for values in ([], [other], [good[:-1]], [good + "0"], [wrong_scheme], [good, good]):
            self.metadata = [("authorization", value) for value in values]
            for call, *arguments in self.unary_calls():
                with self.subTest(values, call=call.__name__):
                    words = "the call needs a good bearer token"
                    error = self.refused(grpc.StatusCode.UNAUTHENTICATED, words, call, *arguments)
                    details = dict(error.trailing_metadata())["grpc-status-details-bin"]
                    self.assertIn(b"UNAUTHENTICATED", details)
        self.use_token_of("alice")
        self.assertEqual(self.upload(0, b"").next_offset, 0, "bytes without a token were kept")
        self.upload_all()
        self.assertEqual(list(self.stored())[-1].summary.certificate, self.small(self.mesh).summary.certificate)
        harness.await_log(self.dir, r"method=VoxelizeSmall .*caller=alice")

    def test_limits_of_a_token_hold_for_each_call(self):
        self.open_with_tokens(light="max-mesh-bytes=1000", coarse="max-triangles=100", hurried="max-job-seconds=1")
        full = grpc.StatusCode.RESOURCE_EXHAUSTED
        self.use_token_of("alice")
        self.upload_all()
        for name, words in (("light", f"{len(self.mesh)} exceeds 1000"), ("coarse", "7200 exceeds 100")):
            self.use_token_of(name)
            for call, *arguments in self.unary_calls():
                with self.subTest(name, call=call.__name__):
                    self.refused(full, words, call, *arguments)
        self.use_token_of("hurried")
        self.assertGreater(list(self.stored())[-1].summary.voxels, 1000)
        self.refused(full, "seconds", self.stored, resolution=8000)

    def test_jobs_of_a_token_are_counted_over_all_calls(self):
        self.open_with_tokens(single="max-jobs=1")
        self.use_token_of("single")
        self.upload_all()
        running = self.stored(resolution=4000)
        self.assertTrue(next(running).HasField("accepted"))
        full = grpc.StatusCode.RESOURCE_EXHAUSTED
        for call, *arguments in self.unary_calls():
            with self.subTest(call=call.__name__):
                self.refused(full, "jobs_of_client", call, *arguments)
        self.use_token_of("alice")
        self.assertGreater(self.small(self.mesh).summary.voxels, 1000)
        running.cancel()
        harness.await_log(self.dir, r"method=VoxelizeStored .*code=CANCELLED")
        self.use_token_of("single")
        self.assertGreater(self.small(self.mesh).summary.voxels, 1000)


if __name__ == "__main__":
    unittest.main()
