import struct
import sys

import grpc
from latvox.v1 import voxelizer_pb2 as pb

vertices = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
triangles = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
spec = pb.VoxelizeSpec(
    lattice=pb.Lattice(named=pb.NAMED_LATTICE_BCC),
    resolution=32,
    raw_mesh=pb.RawMesh(vertices=4, triangles=4),
)
request = pb.VoxelizeSmallRequest(spec=spec, mesh=struct.pack("<12f12I", *vertices, *triangles))
with grpc.insecure_channel(sys.argv[1]) as channel:
    voxelize_small = channel.unary_unary(
        "/latvox.v1.Voxelizer/VoxelizeSmall",
        request_serializer=pb.VoxelizeSmallRequest.SerializeToString,
        response_deserializer=pb.VoxelizeSmallResponse.FromString,
    )
    summary = voxelize_small(request, timeout=60).summary
print(f"{summary.voxels} voxels, digest {summary.certificate.digest}")
