import com.google.protobuf.ByteString;
import io.grpc.ManagedChannel;
import io.grpc.ManagedChannelBuilder;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.util.concurrent.TimeUnit;
import latvox.v1.VoxelizerGrpc;
import latvox.v1.VoxelizerOuterClass.Lattice;
import latvox.v1.VoxelizerOuterClass.NamedLattice;
import latvox.v1.VoxelizerOuterClass.RawMesh;
import latvox.v1.VoxelizerOuterClass.Summary;
import latvox.v1.VoxelizerOuterClass.VoxelizeSmallRequest;
import latvox.v1.VoxelizerOuterClass.VoxelizeSpec;

public class Tetrahedron {
  public static void main(String[] arguments) {
    float[] vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    int[] triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    ByteBuffer mesh = ByteBuffer.allocate(96).order(ByteOrder.LITTLE_ENDIAN);
    for (float coordinate : vertices) mesh.putFloat(coordinate);
    for (int vertex : triangles) mesh.putInt(vertex);
    VoxelizeSpec spec = VoxelizeSpec.newBuilder()
        .setLattice(Lattice.newBuilder().setNamed(NamedLattice.NAMED_LATTICE_BCC))
        .setResolution(32)
        .setRawMesh(RawMesh.newBuilder().setVertices(4).setTriangles(4))
        .build();
    VoxelizeSmallRequest request = VoxelizeSmallRequest.newBuilder()
        .setSpec(spec).setMesh(ByteString.copyFrom(mesh.array())).build();
    ManagedChannel channel = ManagedChannelBuilder.forTarget(arguments[0]).usePlaintext().build();
    try {
      Summary summary = VoxelizerGrpc.newBlockingStub(channel)
          .withDeadlineAfter(1, TimeUnit.MINUTES).voxelizeSmall(request).getSummary();
      System.out.println(summary.getVoxels() + " voxels, digest " + summary.getCertificate().getDigest());
    } finally {
      channel.shutdownNow();
    }
  }
}
