using System;
using System.IO;
using Google.Protobuf;
using Grpc.Net.Client;
using Latvox.V1;

var bytes = new MemoryStream();
var writer = new BinaryWriter(bytes);  // always little-endian
foreach (float coordinate in new float[] { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 }) writer.Write(coordinate);
foreach (uint vertex in new uint[] { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 }) writer.Write(vertex);
var spec = new VoxelizeSpec {
    Lattice = new Lattice { Named = NamedLattice.Bcc },
    Resolution = 32,
    RawMesh = new RawMesh { Vertices = 4, Triangles = 4 },
};
using var channel = GrpcChannel.ForAddress("http://" + args[0]);
var client = new Voxelizer.VoxelizerClient(channel);
var request = new VoxelizeSmallRequest { Spec = spec, Mesh = ByteString.CopyFrom(bytes.ToArray()) };
var summary = client.VoxelizeSmall(request, deadline: DateTime.UtcNow.AddMinutes(1)).Summary;
Console.WriteLine($"{summary.Voxels} voxels, digest {summary.Certificate.Digest}");
