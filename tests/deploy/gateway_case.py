"""The basis of the gateway's tests: requests, meshes that are stored, and answers that are not read."""

import base64
import json
import sys

from gateway import ROOT, SERVICE, raw

sys.path.insert(0, str(ROOT / "tests" / "e2e"))

from harness import Case, octahedron  # noqa: E402

DRAWING = {"polylines": [{"xy": [0, 0, 3, 4]}], "lattice": {"named": "NAMED_PLANE_LATTICE_SQUARE"}, "resolution": 20}
BCC = {"lattice": {"named": "NAMED_LATTICE_BCC"}, "resolution": 40}
BIG = {"lattice": {"named": "NAMED_LATTICE_CARTESIAN"}, "resolution": 4000, "supercover": {}}


def text(data):
    return base64.b64encode(data).decode()


class GatewayCase(Case):
    def setUp(self):
        super().setUp()
        self.mesh = octahedron(7.0)
        self.about, self.data, self.name = raw(self.mesh)

    def stored(self, **spec):
        return {"spec": {**spec, "meshSha256": text(self.name), "rawMesh": self.about}}

    def pieces(self):
        """Yields requests of UploadMesh, in three pieces."""
        spec = {"meshSha256": text(self.name), "meshBytes": len(self.data), "rawMesh": self.about}
        for at in range(0, len(self.data), third := len(self.data) // 3 + 1):
            yield {"spec": spec, "offset": at, "meshPiece": text(self.data[at : at + third])}

    def upload(self, running):
        for piece in self.pieces():
            status, _, answer = running.post("UploadMesh", piece)
            self.assertEqual(status, 200, answer)
        self.assertTrue(answer["stored"], answer)

    def stalled(self, running, resolution=4000):
        """Returns a connection on which a large answer has begun, whose rest is not read."""
        body = json.dumps(self.stored(**{**BIG, "resolution": resolution})).encode()
        connection = running.connect()
        self.addCleanup(connection.close)
        framed = b"\0" + len(body).to_bytes(4, "big") + body
        head = f"POST {SERVICE}VoxelizeStored HTTP/1.1\r\nHost: a\r\n"
        head += f"Content-Type: application/connect+json\r\nContent-Length: {len(framed)}\r\n\r\n"
        connection.sendall(head.encode() + framed)
        self.assertIn(b" 200 OK", connection.recv(4096))
        return connection

    def detail(self, answer, kind="ErrorInfo"):
        found = [each.get("debug", each) for each in answer["details"] if each["type"] == f"google.rpc.{kind}"]
        self.assertEqual(len(found), 1, answer)
        return found[0]
