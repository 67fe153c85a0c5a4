#!/usr/bin/python3
"""A client of latvoxd from proto/latvox/v1/voxelizer.proto alone: sends an .obj mesh of triangles, prints its voxels.

Needs python3-grpcio, python3-protobuf and, made once in a folder that $PYTHONPATH names (here: PYTHONPATH=.):
    protoc -I proto --python_out=. latvox/v1/voxelizer.proto
Usage: client/examples/voxelize.py ADDRESS MESH.obj RESOLUTION [cartesian|bcc|fcc|hexagonal] >voxels.csv
"""

import array
import sys

import grpc
from latvox.v1 import voxelizer_pb2 as pb


def arrays(obj):
    """The vertices as numbers of 32 bits, x, y and z in turn, and the three vertices of each triangle."""
    positions, triangles = array.array("f"), array.array("I")
    for key, *words in map(str.split, filter(str.strip, obj)):
        if key == "v":
            positions.extend(map(float, words[:3]))
        elif key == "f":
            corners = [int(word.split("/")[0]) - 1 for word in words]  # 12/7/3 is vertex 12
            if len(corners) != 3 or min(corners) < 0:
                sys.exit(f"f {' '.join(words)}: this example reads triangles with numbers from 1 on")
            triangles.extend(corners)
    return positions, triangles


def requests(positions, triangles, resolution, lattice):
    """The specification first, then the arrays in pieces of any size."""
    mesh = positions.tobytes() + triangles.tobytes()
    named = pb.NamedLattice.Value(f"NAMED_LATTICE_{lattice.upper()}")
    yield pb.VoxelizeRequest(
        spec=pb.VoxelizeSpec(
            lattice=pb.Lattice(named=named),
            resolution=resolution,
            separability=2,
            encoding=pb.BRICK_ENCODING_PACKED,
            raw_mesh=pb.RawMesh(vertices=len(positions) // 3, triangles=len(triangles) // 3),
            mesh_bytes=len(mesh),
        )
    )
    for at in range(0, len(mesh), 1 << 18):
        yield pb.VoxelizeRequest(mesh_piece=mesh[at : at + (1 << 18)])


def octree(packed, at):
    """The cells (x, y, z) of the octree that begins at byte `at`, and the byte after it."""
    if packed[at] == 0:  # all of them
        return [(n >> 6, n >> 3 & 7, n & 7) for n in range(512)], at + 1
    corners = [(0, 0, 0)]
    for half in (4, 2, 1):
        inner = []
        for x, y, z in corners:
            octants = [n for n in range(8) if packed[at] >> n & 1]
            inner += [(x + half * (n >> 2), y + half * (n >> 1 & 1), z + half * (n & 1)) for n in octants]
            at += 1
        corners = inner
    return sorted(corners), at


def voxels(packed):
    """The voxels (i, j, k) of BrickBatch.packed: tiles of bricks of voxels."""
    at = 0
    while at < len(packed):
        tile = [64 * int.from_bytes(packed[at + 4 * m : at + 4 * m + 4], "little", signed=True) for m in range(3)]
        bricks, at = octree(packed, at + 12)
        for brick in bricks:
            cells, at = octree(packed, at)
            for cell in cells:
                yield tuple(tile[m] + 8 * brick[m] + cell[m] for m in range(3))


def main(address, path, resolution, lattice="cartesian"):
    with open(path) as file, grpc.insecure_channel(address) as channel:
        positions, triangles = arrays(file)
        call = channel.stream_stream(
            "/latvox.v1.Voxelizer/Voxelize",
            request_serializer=pb.VoxelizeRequest.SerializeToString,
            response_deserializer=pb.VoxelizeResponse.FromString,
        )
        print("i,j,k")
        for answer in call(requests(positions, triangles, int(resolution), lattice), timeout=600):
            for i, j, k in voxels(answer.bricks.packed):
                print(f"{i},{j},{k}")
        # Only the last answer has a summary; without one, something is missing.
        print(f"{answer.summary.voxels} voxels, digest {answer.summary.certificate.digest}", file=sys.stderr)


if __name__ == "__main__":
    words = [*sys.argv[1:], "cartesian"][:4]
    if not (3 < len(sys.argv) < 6 and words[2].isdecimal() and words[3] in "cartesian bcc fcc hexagonal".split()):
        sys.exit(__doc__[__doc__.index("Usage") :].strip())
    main(*words)
