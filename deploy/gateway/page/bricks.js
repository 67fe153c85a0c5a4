// Decodes BrickBatch.packed: see the head of BrickBatch in the protocol. Needs no browser.

// Reads the octree at `at` into 64 rows: bit z of row x << 3 | y. Returns where it ends.
function readOctree(bytes, at, rows) {
  if (bytes[at] === 0) {
    rows.fill(255);
    return at + 1;
  }
  rows.fill(0);
  let boxes = [[0, 0, 0]]; // low corners
  for (const half of [4, 2, 1]) {
    const inner = [];
    for (const [x, y, z] of boxes) {
      const node = bytes[at++];
      if (!(node > 0)) throw new Error('a batch has an octree node without cells');
      for (let n = 0; n < 8; ++n) {
        if ((node >> n) & 1) inner.push([x + half * (n >> 2), y + half * ((n >> 1) & 1), z + half * (n & 1)]);
      }
    }
    boxes = inner;
  }
  for (const [x, y, z] of boxes) rows[(x << 3) | y] |= 1 << z;
  return at;
}

// Returns the bricks: coordinates of the brick as three 32-bit integers, then its 64 rows, 76 bytes each.
export function unpack(packed) {
  const view = new DataView(packed.buffer, packed.byteOffset, packed.length),
    tile = new Uint8Array(64),
    rows = new Uint8Array(64);
  const found = [];
  for (let at = 0; at < packed.length;) {
    const corner = [0, 4, 8].map((n) => 8 * view.getInt32(at + n, true));
    at = readOctree(packed, at + 12, tile);
    for (let row = 0; row < 64; ++row) {
      for (let z = 0; z < 8; ++z) {
        if (((tile[row] >> z) & 1) === 0) continue;
        at = readOctree(packed, at, rows);
        const brick = new Uint8Array(76),
          place = new DataView(brick.buffer);
        [row >> 3, row & 7, z].forEach((n, m) => place.setInt32(4 * m, corner[m] + n, true));
        brick.set(rows, 12);
        found.push(brick);
      }
    }
  }
  return joined(found);
}

export function joined(parts) {
  const all = new Uint8Array(parts.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

// Calls visit(i, j, k, number) for each voxel, in the order of the fields' values. Returns the number of voxels.
export function forEachVoxel(bricks, visit = () => {}) {
  const view = new DataView(bricks.buffer, bricks.byteOffset, bricks.length);
  let number = 0;
  for (let at = 0; at < bricks.length; at += 76) {
    const [i, j, k] = [0, 4, 8].map((n) => 8 * view.getInt32(at + n, true));
    for (let row = 0; row < 64; ++row) {
      for (let bits = bricks[at + 12 + row], z = 0; bits !== 0; bits >>= 1, ++z) {
        if (bits & 1) visit(i + (row >> 3), j + (row & 7), k + z, number++);
      }
    }
  }
  return number;
}
