// A client of the service written from proto/latvox/v1/voxelizer.proto alone, sharing no code with latvox.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import grpc from '@grpc/grpc-js';
import loader from '@grpc/proto-loader';
import { decompress } from 'fzstd';
import { xxhash128 } from 'hash-wasm';

export const BIN = process.env.LATVOX_BIN;
const PROTO = fileURLToPath(new URL('../../proto', import.meta.url));
const draco3d = createRequire(import.meta.url)('draco3d');

const describe = (file) => loader.loadSync(file, { includeDirs: [PROTO], longs: String, defaults: true, oneofs: true });
const { Voxelizer } = grpc.loadPackageDefinition(describe('latvox/v1/voxelizer.proto')).latvox.v1;

// Starts a latvoxd on a socket in `directory`; resolves once it answers.
export async function startServer(directory) {
  const address = `unix:${directory}/latvoxd.socket`;
  const child = spawn(path.join(BIN, 'latvoxd'), ['--listen', address], { stdio: ['ignore', 'ignore', 'inherit'] });
  const client = new Voxelizer(address, grpc.credentials.createInsecure());
  await new Promise((resolve, reject) => {
    client.waitForReady(Date.now() + 30_000, (error) => (error ? reject(error) : resolve()));
  });
  const stop = async () => {
    client.close();
    child.kill('SIGTERM');
    const [code] = await once(child, 'exit');
    return code;
  };
  return { address, client, stop };
}

export function getLimits(client) {
  return new Promise((resolve, reject) => {
    client.GetLimits({}, (error, limits) => (error ? reject(error) : resolve(limits)));
  });
}

// Sends the messages unchanged. Resolves with all answers, or rejects with the gRPC error.
export function call(client, messages) {
  return new Promise((resolve, reject) => {
    const stream = client.Voxelize({ deadline: Date.now() + 60_000 });
    const answers = [];
    stream.on('data', (answer) => answers.push(answer));
    stream.on('error', reject);
    stream.on('end', () => resolve(answers));
    for (const message of messages) stream.write(message);
    stream.end();
  });
}

// Makes one whole request, and checks its answers against the documented order and format.
export async function voxelize(client, spec, drc, pieceBytes = 1 << 16) {
  const messages = [{ spec }];
  for (let at = 0; at < drc.length; at += pieceBytes) messages.push({ meshPiece: drc.subarray(at, at + pieceBytes) });
  const answers = await call(client, messages);
  const kinds = answers.map((answer) => answer.part);
  const expected = ['accepted', ...Array(Math.max(0, kinds.length - 2)).fill('bricks'), 'summary'];
  if (kinds.join() !== expected.join()) throw new Error(`answers in a wrong order: ${kinds}`);
  const bricks = answers.slice(1, -1).flatMap((answer) => bricksOf(answer.bricks));
  const batches = answers.slice(1, -1).map((answer) => answer.bricks);
  return { accepted: answers[0].accepted, bricks, batches, summary: answers.at(-1).summary };
}

function bricksOf({ brickIjk, masks, packed, packedBytes }) {
  if (packed.length > 0) {
    if (masks.length > 0 || brickIjk.length > 0) throw new Error('a batch is both masks and packed');
    const plain = packedBytes > 0 ? Buffer.from(decompress(packed)) : packed;
    if (packedBytes > 0 && plain.length !== packedBytes) throw new Error(`${plain.length} bytes, not ${packedBytes}`);
    return unpack(plain);
  }
  if (masks.length * 3 !== brickIjk.length * 64) throw new Error('masks and brick_ijk do not match');
  const bricks = [];
  for (let n = 0; 64 * n < masks.length; ++n) {
    bricks.push({ ijk: brickIjk.slice(3 * n, 3 * n + 3), mask: masks.subarray(64 * n, 64 * n + 64) });
  }
  return bricks;
}

// BrickBatch.packed: tiles.
function unpack(packed) {
  const bricks = [];
  let at = 0;
  const octree = () => {
    if (packed.readUInt8(at) === 0) {
      ++at;
      return Array.from({ length: 512 }, (_, n) => [n >> 6, (n >> 3) & 7, n & 7]);
    }
    let boxes = [[0, 0, 0]]; // low corners
    for (const half of [4, 2, 1]) {
      boxes = boxes.flatMap(([x, y, z]) => {
        const node = packed.readUInt8(at++);
        if (node === 0) throw new Error('a node without cells');
        const octants = [0, 1, 2, 3, 4, 5, 6, 7].filter((n) => node & (1 << n));
        return octants.map((n) => [x + half * (n >> 2), y + half * ((n >> 1) & 1), z + half * (n & 1)]);
      });
    }
    return boxes;
  };
  while (at < packed.length) {
    const tile = [0, 4, 8].map((n) => packed.readInt32LE(at + n));
    at += 12;
    const places = octree().sort(([a, b, c], [d, e, f]) => a - d || b - e || c - f);
    for (const place of places) {
      const mask = Buffer.alloc(64);
      for (const [x, y, z] of octree()) mask[8 * x + y] |= 1 << z;
      bricks.push({ ijk: place.map((p, m) => 8 * tile[m] + p), mask });
    }
  }
  return bricks;
}

// Returns all voxels of some bricks as "i,j,k".
export function voxelsOf(bricks) {
  const voxels = new Set();
  for (const { ijk, mask } of bricks) {
    for (let x = 0; x < 8; ++x) {
      const word = mask.readBigUInt64LE(8 * x);
      for (let bit = 0; bit < 64; ++bit) {
        if ((word >> BigInt(bit)) & 1n) voxels.add(`${8 * ijk[0] + x},${8 * ijk[1] + (bit >> 3)},${8 * ijk[2] + (bit & 7)}`);
      }
    }
  }
  return voxels;
}

// Computes Certificate.digest anew.
export async function digestOf(bricks) {
  let sum = 0n;
  for (const { ijk, mask } of bricks) {
    const bytes = Buffer.alloc(76);
    ijk.forEach((x, m) => bytes.writeInt32LE(x, 4 * m));
    mask.copy(bytes, 12);
    sum += BigInt('0x' + (await xxhash128(bytes)));
  }
  return (sum & ((1n << 128n) - 1n)).toString(16).padStart(32, '0');
}

// Returns the google.rpc.ErrorInfo of a gRPC error.
export function errorInfoOf(error) {
  const [bytes] = error.metadata.get('grpc-status-details-bin');
  const status = describe('google/rpc/status.proto')['google.rpc.Status'].deserialize(bytes);
  if (status.code !== error.code) throw new Error(`code ${error.code}, but details of ${status.code}`);
  const info = status.details.find((any) => any.type_url === 'type.googleapis.com/google.rpc.ErrorInfo');
  return describe('google/rpc/error_details.proto')['google.rpc.ErrorInfo'].deserialize(info.value);
}

// Returns a mesh as Draco bytes, with unquantized positions. positions: flat x, y, z; triangles: flat indices.
export async function encode({ positions, triangles }) {
  const draco = await draco3d.createEncoderModule({});
  const [mesh, builder, encoder, out] = [new draco.Mesh(), new draco.MeshBuilder(), new draco.Encoder(), new draco.DracoInt8Array()];
  builder.AddFacesToMesh(mesh, triangles.length / 3, Uint32Array.from(triangles));
  builder.AddFloatAttributeToMesh(mesh, draco.POSITION, positions.length / 3, 3, Float32Array.from(positions));
  encoder.SetEncodingMethod(draco.MESH_EDGEBREAKER_ENCODING);
  const length = encoder.EncodeMeshToDracoBuffer(mesh, out);
  const bytes = Buffer.from(Int8Array.from({ length }, (_, n) => out.GetValue(n)));
  [mesh, builder, encoder, out].forEach((object) => draco.destroy(object));
  return bytes;
}
