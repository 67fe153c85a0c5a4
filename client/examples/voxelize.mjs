// A client of latvoxd from proto/latvox/v1/voxelizer.proto alone: sends an .obj mesh of triangles, prints its voxels.
//
// Needs: npm install @grpc/grpc-js @grpc/proto-loader, in a folder above this file. A copy elsewhere finds the protocol
// in the folder that LATVOX_PROTO names, for example: LATVOX_PROTO=latvox/proto
// Usage: node client/examples/voxelize.mjs ADDRESS MESH.obj RESOLUTION [cartesian|bcc|fcc|hexagonal] >voxels.csv
import fs from 'node:fs';
import { fileURLToPath } from 'node:url';
import grpc from '@grpc/grpc-js';
import loader from '@grpc/proto-loader';

const [address, path, resolution, lattice = 'cartesian'] = process.argv.slice(2);
if (!(resolution > 0) || !['cartesian', 'bcc', 'fcc', 'hexagonal'].includes(lattice)) {
  console.error('Usage: voxelize.mjs ADDRESS MESH.obj RESOLUTION [cartesian|bcc|fcc|hexagonal] >voxels.csv');
  process.exit(2);
}
// In the repository, or as `cmake --install` installs it.
const places = ['../../proto', '../../../latvox/proto'].map((dir) => fileURLToPath(new URL(dir, import.meta.url)));
const includeDirs = process.env.LATVOX_PROTO ? [process.env.LATVOX_PROTO] : places;
const proto = loader.loadSync('latvox/v1/voxelizer.proto', { includeDirs, longs: String, defaults: true, oneofs: true });
const { Voxelizer } = grpc.loadPackageDefinition(proto).latvox.v1;

// The vertices as numbers of 32 bits, x, y and z in turn, and the three vertices of each triangle.
function arraysOf(obj) {
  const rows = obj.split('\n').map((line) => line.trim().split(/\s+/));
  const rowsOf = (key) => rows.filter((row) => row[0] === key).flatMap((row) => row.slice(1, 4));
  const corner = (word) => parseInt(word, 10) - 1; // 12/7/3 is vertex 12
  const other = rows.find((row) => row[0] === 'f' && (row.length !== 4 || row.some((word) => word.startsWith('-'))));
  if (other) throw new Error(`${other.join(' ')}: this example reads triangles with numbers from 1 on`);
  return { positions: Float32Array.from(rowsOf('v'), Number), triangles: Uint32Array.from(rowsOf('f'), corner) };
}

// The voxels of BrickBatch.packed: tiles of bricks of voxels, the latter two as octrees.
function* voxelsOf(packed) {
  let at = 0;
  const octree = () => {
    if (packed[at] === 0) {
      at++; // all 512
      return Array.from({ length: 512 }, (_, n) => [n >> 6, (n >> 3) & 7, n & 7]);
    }
    let corners = [[0, 0, 0]];
    for (const half of [4, 2, 1]) {
      corners = corners.flatMap(([x, y, z]) => {
        const node = packed[at++];
        const octants = [0, 1, 2, 3, 4, 5, 6, 7].filter((n) => node & (1 << n));
        return octants.map((n) => [x + half * (n >> 2), y + half * ((n >> 1) & 1), z + half * (n & 1)]);
      });
    }
    return corners.sort(([a, b, c], [d, e, f]) => a - d || b - e || c - f);
  };
  while (at < packed.length) {
    const tile = [0, 4, 8].map((n) => 64 * packed.readInt32LE(at + n));
    at += 12;
    for (const brick of octree()) {
      for (const cell of octree()) yield tile.map((low, m) => low + 8 * brick[m] + cell[m]);
    }
  }
}

const { positions, triangles } = arraysOf(fs.readFileSync(path, 'utf8'));
const mesh = Buffer.concat([positions, triangles].map((numbers) => Buffer.from(numbers.buffer)));
const rawMesh = { vertices: positions.length / 3, triangles: triangles.length / 3 };
const named = `NAMED_LATTICE_${lattice.toUpperCase()}`;
const encoding = 'BRICK_ENCODING_PACKED';
const grid = { lattice: { named }, resolution: Number(resolution), separability: 2 };
const spec = { ...grid, encoding, rawMesh, meshBytes: mesh.length };
const client = new Voxelizer(address, grpc.credentials.createInsecure());
const stream = client.Voxelize({ deadline: Date.now() + 600_000 });
console.log('i,j,k');
stream.on('data', ({ bricks, summary }) => {
  if (bricks) for (const voxel of voxelsOf(bricks.packed)) console.log(voxel.join());
  if (summary) console.error(`${summary.voxels} voxels, digest ${summary.certificate.digest}`);
});
stream.on('error', (error) => {
  console.error(error.message);
  process.exitCode = 1;
});
stream.on('end', () => client.close());
stream.write({ spec });
for (let at = 0; at < mesh.length; at += 1 << 18) stream.write({ meshPiece: mesh.subarray(at, at + (1 << 18)) });
stream.end();
