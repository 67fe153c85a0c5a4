// Visible facets of the voxels' cells, and points that stand for voxels. Needs voxels.js, no browser.
"use strict";

// A typed array that grows.
class Growing {
  constructor(Type) {
    this.array = new Type(1024);
    this.length = 0;
  }

  push(a, b, c, d) {
    if (this.length + 4 > this.array.length) {
      const longer = new this.array.constructor(2 * this.array.length);
      longer.set(this.array);
      this.array = longer;
    }
    this.array[this.length++] = a;
    this.array[this.length++] = b;
    this.array[this.length++] = c;
    this.array[this.length++] = d;
  }

  values() {
    return this.array.slice(0, this.length);
  }
}

// Calls see(i, j, k, voxel, f) for each facet (that of steps[f]) of each voxel of the set, except facets between two
// voxels. The facets must face the points of `outside`, a function from keys to rows; null: all empty points.
function forEachFacet(set, steps, outside, see) {
  const window = new Window(set, steps), turned = outside === null ? 255 : 0;
  const rowsOf = outside ?? ((key) => set.bricks.get(key)?.rows ?? NONE);
  for (const [key, { corner: [i, j, k], rows, all = rows, voxel }] of set.bricks) {
    window.fill(key, rowsOf);
    for (let row = 0, before = voxel; row < 64; before += BITS[all[row]], ++row) {
      if (rows[row] === 0) continue;
      const at = window.middle + (row >> 3) * window.side + (row & 7);
      for (let f = 0; f < steps.length; ++f) {
        let bits = rows[row] & ((window.rows[at + window.along[f]] >> window.bits[f]) ^ turned);
        for (; bits !== 0; bits &= bits - 1) {
          const low = bits & -bits;
          see(i + (row >> 3), j + (row & 7), k + 31 - Math.clz32(low), before + BITS[all[row] & (low - 1)], f);
        }
      }
    }
  }
}

// Packs a direction into 16 bits: the octahedron unfolded to a square of 255 by 255.
const NO_NORMAL = 65535;
function packed(x, y, z) {
  const sum = Math.abs(x) + Math.abs(y) + Math.abs(z);
  if (sum < 1e-6) return NO_NORMAL;
  const fold = (u, v) => (z < 0 ? (1 - Math.abs(v)) * (u < 0 ? -1 : 1) : u);
  const [u, v] = [x / sum, y / sum];
  return Math.round(127 * (1 + fold(u, v))) | (Math.round(127 * (1 + fold(v, u))) << 8);
}

// Returns the packed normal of the surface at each voxel: the sum of its facets' normals. NO_NORMAL: no facet is
// visible.
function findNormals(set, facets, outside) {
  const sums = new Float32Array(3 * set.count());
  forEachFacet(set, facets.map(({ step }) => step), outside, (i, j, k, voxel, f) => {
    for (let m = 0; m < 3; ++m) sums[3 * voxel + m] += facets[f].normal[m];
  });
  return Uint16Array.from({ length: sums.length / 3 }, (_, n) => packed(sums[3 * n], sums[3 * n + 1], sums[3 * n + 2]));
}

// The points that are not among the `shown` voxels of a set, as three functions from keys to rows: those outside, those
// in hollows, and the hidden voxels. `outside`: as Outside.rowsOf; null: nobody knows, and nothing is a hollow.
function around(set, shown, outside) {
  const cached = (rowsOf) => {
    const known = new Map();
    return (key) => known.get(key) ?? (known.set(key, rowsOf(key)), known.get(key));
  };
  const without = (rows, others) => rows.map((row, n) => row & ~others[n]);
  const full = (key) => set.bricks.get(key)?.rows ?? NONE;
  const empty = cached((key) => (set.bricks.has(key) ? without(ALL, full(key)) : ALL));
  return {
    outside: outside ?? empty,
    hollows: outside === null ? () => NONE : cached((key) => without(empty(key), outside(key))),
    hidden: cached((key) => (shown.bricks.has(key) ? without(full(key), shown.bricks.get(key).rows) : full(key))),
  };
}

// Returns for each step the voxels that show the facet there: four numbers each, coordinates relative to `origin` and
// normalOf(voxel), packed. If `numbered`, returns the numbers of the voxels, too.
function findFacets(set, steps, origin, outside, normalOf, numbered) {
  const cells = steps.map(() => new Growing(Uint16Array)), numbers = steps.map(() => []);
  forEachFacet(set, steps, outside, (i, j, k, voxel, f) => {
    cells[f].push(i - origin[0], j - origin[1], k - origin[2], normalOf(voxel));
    if (numbered) numbers[f].push(voxel);
  });
  return { cells: cells.map((of) => of.values()), numbers };
}

// Returns the facets of several calls of findFacets.
function joined(...found) {
  const join = (arrays) => {
    const all = new Uint16Array(arrays.reduce((sum, { length }) => sum + length, 0));
    arrays.reduce((at, array) => (all.set(array, at), at + array.length), 0);
    return all;
  };
  const steps = found[0].cells.map((_, f) => f);
  return { cells: steps.map((f) => join(found.map(({ cells }) => cells[f]))), numbers: steps.map((f) => found.flatMap(({ numbers }) => numbers[f])) };
}

// Returns for voxels, brick by brick, the shift of the largest cube (2^shift a side) whose first voxel it is.
const COARSEST = 3; // shift of a brick
class Cubes {
  constructor() {
    this.taken = Array.from({ length: COARSEST + 1 }, (_, shift) => new Int32Array(512 >> (3 * shift)));
    this.brick = 0;
    this.place = [];
  }

  shiftOf(i, j, k) {
    const place = [i >> 3, j >> 3, k >> 3];
    if (place.some((n, m) => n !== this.place[m])) (this.place = place), ++this.brick;
    let first = 0;
    for (let shift = 1; shift <= COARSEST; ++shift) {
      const [x, y, z] = [i, j, k].map((n) => (n & 7) >> shift), bits = 3 - shift;
      const cube = (((x << bits) | y) << bits) | z;
      if (this.taken[shift][cube] !== this.brick) first = shift;
      this.taken[shift][cube] = this.brick;
    }
    return first;
  }
}

// Returns the voxels with a normal, in the format of findFacets, ordered so that the first few represent all. One voxel
// of each 8 x 8 x 8 comes first, then one of each remaining 4 x 4 x 4, and so on. The number of voxels of cubes of 2^n
// and more is in ends[n].
function scatter(set, origin, normals) {
  const cubes = new Cubes();
  const levels = Array.from({ length: COARSEST + 1 }, () => ({ found: new Growing(Uint16Array), of: [] }));
  set.forEach((i, j, k, voxel) => {
    if (normals[voxel] === NO_NORMAL) return;
    const level = levels[cubes.shiftOf(i, j, k)];
    level.found.push(i - origin[0], j - origin[1], k - origin[2], normals[voxel]);
    level.of.push(voxel);
  });
  const count = levels.reduce((sum, { of }) => sum + of.length, 0), ends = [];
  const cells = new Uint16Array(4 * count), numbers = new Uint32Array(count);
  let n = 0;
  for (let level = COARSEST; level >= 0; --level) {
    const { found, of } = levels[level], stride = coprime(of.length);
    for (let each = 0, at = 0; each < of.length; ++each, at = (at + stride) % of.length, ++n) {
      cells.set(found.array.subarray(4 * at, 4 * at + 4), 4 * n);
      numbers[n] = of[at];
    }
    ends[level] = n;
  }
  return { cells, numbers, ends };
}

// Returns a number near the golden section of `count` that is coprime to it. Steps of it spread evenly.
function coprime(count) {
  const divisor = (a, b) => (b === 0 ? a : divisor(b, a % b));
  let stride = Math.max(1, Math.round(0.618034 * count));
  while (divisor(count, stride) > 1) ++stride;
  return stride;
}
