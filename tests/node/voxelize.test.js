// The service as seen by a program in any language. Needs LATVOX_BIN.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import grpc from '@grpc/grpc-js';
import { BIN, call, digestOf, encode, errorInfoOf, getLimits, startServer, voxelize, voxelsOf } from './latvox.js';
import { BCC, bccDirections, box, cartesianDirections, crossedEdges, octahedron, readObj } from './meshes.js';

const BUNNY = '/usr/share/glmark2/models/bunny.obj';
const vector = ([x, y, z]) => ({ x, y, z });
const CARTESIAN = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const asGiven = (basis) => ({ basis: { a: vector(basis[0]), b: vector(basis[1]), c: vector(basis[2]) } });
const byResolution = (named, resolution) => ({ lattice: { named }, resolution });

let server, directory;

before(async () => {
  directory = mkdtempSync(path.join(tmpdir(), 'latvox-node-'));
  server = await startServer(directory);
});

after(async () => {
  const code = await server.stop();
  rmSync(directory, { recursive: true });
  assert.equal(code, 0, 'latvoxd drains on SIGTERM');
});

// Checks every answer, and returns its voxels.
async function check({ accepted, bricks, summary }) {
  const voxels = voxelsOf(bricks);
  assert.equal(String(voxels.size), summary.voxels);
  assert.equal(String(bricks.length), summary.bricks);
  assert.ok(bricks.every(({ mask }) => mask.some((byte) => byte !== 0)), 'no brick is empty');
  assert.equal(new Set(bricks.map(({ ijk }) => ijk.join())).size, bricks.length, 'no brick comes twice');
  assert.equal(await digestOf(bricks), summary.certificate.digest);
  if (bricks.length > 0) {
    const [min, max] = [accepted.indexBox.min, accepted.indexBox.max];
    for (const voxel of voxels) {
      const [i, j, k] = voxel.split(',').map(Number);
      assert.ok(i >= min.i && i < max.i && j >= min.j && j < max.j && k >= min.k && k < max.k, `${voxel} is in the box`);
    }
  }
  return voxels;
}

// Brute force on a box, with the lattice as given: exact in doubles.
const LOW = [0.25, 0.375, 0.125], HIGH = [10.25, 9.375, 11.125];
const LATTICES = [
  ...[0, 1, 2].map((k) => ({ name: `cartesian, k = ${k}`, k, basis: CARTESIAN, directions: cartesianDirections(k) })),
  { name: 'bcc', k: 0, basis: BCC, directions: bccDirections },
];
for (const { name, k, basis, directions } of LATTICES) {
  const spec = { lattice: asGiven(basis), origin: vector([0, 0, 0]), separability: k, verify: true };
  const edges = crossedEdges({ basis, directions, low: LOW, high: HIGH, range: [-12, 16] });

  test(`${name}: a box is the nearer end of every crossed edge`, async () => {
    const result = await voxelize(server.client, { ...spec, minimal: false }, await encode(box(LOW, HIGH)));
    const expected = new Set(edges.flatMap(({ nearer }) => [...nearer]));
    assert.deepEqual([...(await check(result))].sort(), [...expected].sort());
    assert.equal(result.summary.certificate.tunnels, '0');
    assert.equal(result.accepted.mesh.closed, true);
  });

  test(`${name}: a minimal box covers every crossed edge, and needs every voxel`, async () => {
    const result = await voxelize(server.client, { ...spec, minimal: true }, await encode(box(LOW, HIGH)));
    const voxels = await check(result);
    const essential = new Set();
    for (const { ends } of edges) {
      const kept = ends.filter((end) => voxels.has(end));
      assert.ok(kept.length > 0, `a tunnel: ${ends.join(' to ')}`);
      if (kept.length === 1) essential.add(kept[0]);
    }
    assert.deepEqual([...voxels].sort(), [...essential].sort());
    assert.deepEqual([result.summary.certificate.tunnels, result.summary.certificate.redundant], ['0', '0']);
  });
}

test('a cube of side 10 has as many 6-separating voxels as can be counted by hand', async () => {
  const spec = { lattice: asGiven(CARTESIAN), origin: vector([0, 0, 0]), separability: 2 };
  const cube = await encode(box([0.25, 0.25, 0.25], [10.25, 10.25, 10.25]));
  // Three low sides of 10 x 10 outside the cube, three high ones inside, where they share edges and a corner.
  const all = 300 + (300 - 30 + 1);
  const thick = await check(await voxelize(server.client, { ...spec, minimal: false }, cube));
  assert.equal(thick.size, all);
  // A low side's voxel covers one link. Where a high side meets it, the link's other end is also in the set.
  const thin = await check(await voxelize(server.client, { ...spec, minimal: true }, cube));
  assert.equal(thin.size, all - 3 * 19);
});

test('a solid box of side 20 has its volume in voxels, in every encoding', async () => {
  const solid = { surface: 'SOLID_SURFACE_NONE' };
  const cube = await encode(box([0, 0, 0], [20, 20, 20]));
  for (const encoding of ['MASKS', 'PACKED', 'PACKED_ZSTD']) {
    const spec = { lattice: asGiven(CARTESIAN), origin: vector([0, 0, 0]), solid, encoding: `BRICK_ENCODING_${encoding}` };
    const result = await voxelize(server.client, spec, cube);
    assert.equal((await check(result)).size, 8000);
    const { set, solid: facts } = result.summary.certificate;
    assert.deepEqual([set, facts.rule, facts.unbalancedLines], ['interior', 'winding', '0']);
  }
});

test('the bunny is the same from this client and from the command line', async () => {
  const drc = await encode(readObj(BUNNY));
  const file = path.join(directory, 'bunny.drc'), csv = path.join(directory, 'bunny.csv');
  writeFileSync(file, drc);
  const result = await voxelize(server.client, byResolution('NAMED_LATTICE_FCC', 64), drc, 10_007);
  const voxels = await check(result);
  assert.equal(result.accepted.mesh.triangles, '69666');
  assert.equal(result.accepted.mesh.quantizationBits, 0);
  const options = ['voxelize', file, '-o', csv, '--json', '--lattice', 'fcc', '--resolution', '64'];
  const { stdout } = await promisify(execFile)(path.join(BIN, 'latvox'), options);
  assert.equal(JSON.parse(stdout).digest, result.summary.certificate.digest);

  const lines = readFileSync(csv, 'utf8').trimEnd().split('\n').slice(1).map((line) => line.split(','));
  assert.deepEqual(lines.map((cells) => cells.slice(0, 3).join()).sort(), [...voxels].sort());
  const { basis, origin } = result.accepted.grid;
  for (const cells of lines) {
    const [i, j, k, ...position] = cells.map(Number);
    ['x', 'y', 'z'].forEach((axis, m) => {
      const expected = origin[axis] + i * basis.a[axis] + j * basis.b[axis] + k * basis.c[axis];
      assert.ok(Math.abs(position[m] - expected) <= 1e-12, `${cells}: ${axis}`);
    });
  }
});

test('mesh pieces of any size give the same voxels', async () => {
  const drc = await encode(octahedron());
  const digests = new Set();
  for (const pieceBytes of [1, 7, 64, 1 << 20]) {
    const { summary } = await voxelize(server.client, byResolution('NAMED_LATTICE_BCC', 32), drc, pieceBytes);
    assert.equal(summary.meshBytes, String(drc.length));
    digests.add(summary.certificate.digest);
  }
  assert.equal(digests.size, 1);
});

test('bricks are the same as masks, packed, and packed with zstd', async () => {
  const drc = await encode(readObj(BUNNY));
  for (const lattice of ['NAMED_LATTICE_CARTESIAN', 'NAMED_LATTICE_FCC']) {
    const spec = { ...byResolution(lattice, 200), origin: vector([-0.3, 0.7, 0.2]) };
    const masks = await voxelize(server.client, spec, drc);
    assert.ok(masks.batches.every(({ packed }) => packed.length === 0), 'masks are what comes without a wish');
    const wireBytes = new Map();
    for (const encoding of ['BRICK_ENCODING_PACKED', 'BRICK_ENCODING_PACKED_ZSTD']) {
      const packed = await voxelize(server.client, { ...spec, encoding }, drc);
      assert.deepEqual(packed.bricks, masks.bricks);
      assert.equal(await digestOf(packed.bricks), packed.summary.certificate.digest);
      assert.ok(packed.batches.every(({ packedBytes }) => packedBytes > 0 === (encoding === 'BRICK_ENCODING_PACKED_ZSTD')));
      wireBytes.set(encoding, packed.batches.reduce((sum, { packed }) => sum + packed.length, 0));
    }
    const [packed, zstd] = [...wireBytes.values()];
    assert.ok(packed < 26 * masks.bricks.length && zstd < (7 / 8) * packed, `${packed} and ${zstd} bytes`);
  }
});

test('wrong requests are INVALID_ARGUMENT and say which field', async () => {
  const drc = await encode(octahedron());
  const good = byResolution('NAMED_LATTICE_BCC', 16);
  const wrong = [
    ['resolution', [{ spec: byResolution('NAMED_LATTICE_BCC', 70000) }, { meshPiece: drc }]],
    ['resolution', [{ spec: byResolution('NAMED_LATTICE_BCC', 1) }, { meshPiece: drc }]],
    ['voxel_size', [{ spec: { lattice: { named: 'NAMED_LATTICE_BCC' }, voxelSize: -1 } }, { meshPiece: drc }]],
    ['separability', [{ spec: { ...good, separability: 3 } }, { meshPiece: drc }]],
    ['encoding', [{ spec: { ...good, encoding: 4 } }, { meshPiece: drc }]],
    ['lattice', [{ spec: { resolution: 16 } }, { meshPiece: drc }]],
    ['lattice', [{ spec: byResolution('NAMED_LATTICE_UNSPECIFIED', 16) }, { meshPiece: drc }]],
    ['basis', [{ spec: { lattice: asGiven([[1, 0, 0], [0, 1, 0], [1, 1, 0]]) } }, { meshPiece: drc }]],
    ['origin', [{ spec: { ...good, origin: vector([NaN, 0, 0]) } }, { meshPiece: drc }]],
    ['mesh_bytes', [{ spec: { ...good, meshBytes: drc.length + 1 } }, { meshPiece: drc }]],
    ['mesh', [{ spec: good }, { meshPiece: drc.subarray(0, drc.length - 9) }]],
    ['mesh', [{ spec: good }, { meshPiece: Buffer.from('no mesh, whatever it says') }]],
    ['mesh', [{ spec: good }]],
    ['spec', [{ meshPiece: drc }]],
    ['spec', [{ spec: good }, { spec: good }, { meshPiece: drc }]],
    ['spec', []],
  ];
  for (const [field, messages] of wrong) {
    const error = await call(server.client, messages).then(
      () => assert.fail(`a wrong ${field} was accepted`),
      (error) => error,
    );
    assert.equal(error.code, grpc.status.INVALID_ARGUMENT, error.message);
    const info = errorInfoOf(error);
    assert.equal(info.domain, 'latvox');
    assert.match(info.reason, /^[A-Z][A-Z0-9_]+$/);
    assert.match(`${info.metadata.field} ${error.message}`, new RegExp(field));
    await check(await voxelize(server.client, good, drc));
  }
});

test('a value over a limit is told with both', async () => {
  const messages = [{ spec: byResolution('NAMED_LATTICE_BCC', 70000) }, { meshPiece: await encode(octahedron()) }];
  const info = errorInfoOf(await call(server.client, messages).catch((error) => error));
  const { field, value, limit } = info.metadata;
  assert.deepEqual([field, value, limit], ['resolution', '70000', '65536']);
});

test('the limits are told', async () => {
  const limits = await getLimits(server.client);
  assert.ok(limits.maxExtent >= 65536);
  assert.equal(limits.subvoxelBits, 8);
  assert.ok(Number(limits.maxMeshBytes) > 0 && Number(limits.maxTriangles) > 0 && limits.maxJobs > 0);
  assert.match(limits.version, /^\d+\.\d+\.\d+$/);
  assert.match(limits.commit, /^([0-9a-f]{40}(-modified)?|unknown)$/);
  assert.ok(limits.libraries.some(({ name, version }) => name === 'gRPC' && /^1\.\d+/.test(version)));
});
