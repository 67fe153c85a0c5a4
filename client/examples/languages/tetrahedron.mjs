import grpc from '@grpc/grpc-js';
import loader from '@grpc/proto-loader';

const [address, proto] = process.argv.slice(2);
const definition = loader.loadSync('latvox/v1/voxelizer.proto', { includeDirs: [proto], longs: String });
const { Voxelizer } = grpc.loadPackageDefinition(definition).latvox.v1;

const vertices = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1);
const triangles = Uint32Array.of(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3);
const mesh = Buffer.concat([Buffer.from(vertices.buffer), Buffer.from(triangles.buffer)]);
const spec = {
  lattice: { named: 'NAMED_LATTICE_BCC' }, resolution: 32, rawMesh: { vertices: 4, triangles: 4 },
};
const client = new Voxelizer(address, grpc.credentials.createInsecure());
client.VoxelizeSmall({ spec, mesh }, { deadline: Date.now() + 60_000 }, (error, answer) => {
  if (error) {
    console.error(error.message);
    process.exitCode = 1;
  } else {
    console.log(`${answer.summary.voxels} voxels, digest ${answer.summary.certificate.digest}`);
  }
  client.close();
});
