// Sets of voxels, and the space outside of them. Needs no browser.
//
//   brick   8 x 8 x 8 lattice points as 64 rows, bytes: bit z of row x << 3 | y
//   key     index of a brick in the box of all bricks, which has a margin of one empty brick on every side
//   step    from a lattice point to the neighbor behind a facet of its cell
"use strict";

const NONE = new Uint8Array(64), ALL = new Uint8Array(64).fill(255);
const BITS = Uint8Array.from({ length: 256 }, (_, byte) => [...byte.toString(2)].filter((bit) => bit === "1").length);
const MOST_BRICKS = 1 << 24; // largest box in which the outside is computed

class VoxelSet {
  // Holds lattice points from `low` to below `high`.
  constructor(low, high) {
    this.first = low.map((n) => (n >> 3) - 1); // brick of key 0
    this.size = high.map((n, m) => ((n - 1) >> 3) - this.first[m] + 2);
    this.strides = [this.size[1] * this.size[2], this.size[2], 1];
    this.bricks = new Map(); // key -> { corner, rows, voxel, all }; voxel: number of the first voxel of `all`
  }

  keyOf(i, j, k) {
    const [x, y, z] = this.first;
    return (((i >> 3) - x) * this.size[1] + (j >> 3) - y) * this.size[2] + (k >> 3) - z;
  }

  placeOf(key) {
    const [far, side] = this.strides;
    return [Math.floor(key / far), Math.floor((key % far) / side), key % side];
  }

  // `voxel` is the number of its first voxel. Voxels are counted in the order of rows and bits.
  addBrick(corner, rows, voxel) {
    this.bricks.set(this.keyOf(...corner), { corner, rows, voxel });
  }

  has(i, j, k) {
    const brick = this.bricks.get(this.keyOf(i, j, k));
    return brick !== undefined && ((brick.rows[((i & 7) << 3) | (j & 7)] >> (k & 7)) & 1) === 1;
  }

  // Returns the number of a voxel, or -1 where there is none, anywhere.
  numberOf(i, j, k) {
    if ([i, j, k].some((n, m) => (n >> 3) < this.first[m] || (n >> 3) >= this.first[m] + this.size[m])) return -1;
    const brick = this.bricks.get(this.keyOf(i, j, k)), row = ((i & 7) << 3) | (j & 7), bit = 1 << (k & 7);
    if (brick === undefined || (brick.rows[row] & bit) === 0) return -1;
    const { rows, all = rows, voxel } = brick;
    let number = voxel + BITS[all[row] & (bit - 1)];
    for (let before = 0; before < row; ++before) number += BITS[all[before]];
    return number;
  }

  // Calls visit(i, j, k, number of the voxel).
  forEach(visit) {
    for (const { corner: [i, j, k], rows, all = rows, voxel } of this.bricks.values()) {
      for (let row = 0, before = voxel; row < 64; before += BITS[all[row]], ++row) {
        for (let bits = rows[row]; bits !== 0; bits &= bits - 1) {
          const low = bits & -bits;
          visit(i + (row >> 3), j + (row & 7), k + 31 - Math.clz32(low), before + BITS[all[row] & (low - 1)]);
        }
      }
    }
  }

  // Returns the voxels with keep(i, j, k). They keep their numbers.
  filter(keep) {
    const kept = Object.assign(new VoxelSet([0, 0, 0], [0, 0, 0]), this, { bricks: new Map() });
    for (const [key, { corner, rows, voxel }] of this.bricks) {
      const [i, j, k] = corner, some = new Uint8Array(64);
      for (let row = 0; row < 64; ++row) {
        for (let bits = rows[row]; bits !== 0; bits &= bits - 1) {
          const low = bits & -bits;
          if (keep(i + (row >> 3), j + (row & 7), k + 31 - Math.clz32(low))) some[row] |= low;
        }
      }
      if (some.some((row) => row !== 0)) kept.bricks.set(key, { corner, rows: some, all: rows, voxel });
    }
    return kept;
  }

  count() {
    let voxels = 0;
    for (const { rows } of this.bricks.values()) for (const row of rows) voxels += BITS[row];
    return voxels;
  }
}

// The rows around a brick, and the offsets of steps in them. Step f leads to the row `along[f]` farther on. That row,
// shifted right by `bits[f]`, has in bit z the end of the step from z.
class Window {
  constructor(set, steps) {
    this.set = set;
    this.reach = Math.max(...steps.flat().map(Math.abs)); // at most 8
    this.side = 8 + 2 * this.reach;
    this.along = steps.map(([x, y]) => x * this.side + y);
    this.bits = steps.map(([, , z]) => z + this.reach);
    this.rows = new Uint32Array(this.side * this.side);
  }

  // Returns the index of row (0, 0) of the brick.
  get middle() {
    return this.reach * this.side + this.reach;
  }

  // Fills the window around a brick. rowsOf(key) returns the rows of a brick.
  fill(key, rowsOf) {
    const { reach, side, rows } = this, [farX, farY] = this.set.strides, mask = (1 << reach) - 1;
    const near = [];
    for (let x = -1; x <= 1; ++x) {
      for (let y = -1; y <= 1; ++y) {
        const at = key + x * farX + y * farY;
        near.push(rowsOf(at - 1), rowsOf(at), rowsOf(at + 1));
      }
    }
    for (let x = -reach, n = 0; x < 8 + reach; ++x) {
      for (let y = -reach; y < 8 + reach; ++y, ++n) {
        const at = 9 * ((x >> 3) + 1) + 3 * ((y >> 3) + 1), row = ((x & 7) << 3) | (y & 7);
        const before = near[at][row] >> (8 - reach), after = (near[at + 2][row] & mask) << (8 + reach);
        rows[n] = before | (near[at + 1][row] << reach) | after;
      }
    }
    return side;
  }
}

// The empty points that are reachable from outside through facets. rowsOf(key) returns them.
class Outside {
  // Returns null if the box is too large.
  static of(set, steps) {
    return set.size[0] * set.strides[0] > MOST_BRICKS ? null : new Outside(set, steps);
  }

  constructor(set, steps) {
    this.set = set;
    this.window = new Window(set, steps);
    this.open = new Uint8Array(set.size[0] * set.strides[0]); // empty bricks that are outside
    this.reached = new Map([...set.bricks.keys()].map((key) => [key, new Uint8Array(64)])); // reached points of the other bricks
    this.rowsOf = (key) => this.reached.get(key) ?? (this.open[key] === 1 ? ALL : NONE);
    this.spread();
  }

  // Spreads from the corner. Empty bricks come first, because they cost least.
  spread() {
    const waiting = new Uint8Array(this.open.length), empty = [], others = [];
    const wake = (key) => this.forEachNear(key, (next) => {
      if (waiting[next] === 1 || this.open[next] === 1) return;
      waiting[next] = 1;
      (this.reached.has(next) ? others : empty).push(next);
    });
    this.open[0] = 1;
    wake(0);
    while (empty.length > 0 || others.length > 0) {
      const key = empty.pop() ?? others.pop();
      waiting[key] = 0;
      if (this.reached.has(key) ? this.grow(key) : this.enter(key)) wake(key);
    }
  }

  forEachNear(key, visit) {
    const place = this.set.placeOf(key), [nx, ny, nz] = this.set.size;
    for (let x = Math.max(0, place[0] - 1); x <= Math.min(nx - 1, place[0] + 1); ++x) {
      for (let y = Math.max(0, place[1] - 1); y <= Math.min(ny - 1, place[1] + 1); ++y) {
        for (let z = Math.max(0, place[2] - 1); z <= Math.min(nz - 1, place[2] + 1); ++z) {
          const next = x * this.set.strides[0] + y * this.set.strides[1] + z;
          if (next !== key) visit(next);
        }
      }
    }
  }

  // Tests whether an empty brick is outside. It is outside as a whole if any of its points is.
  enter(key) {
    const place = this.set.placeOf(key), rim = place.some((n, m) => n === 0 || n === this.set.size[m] - 1);
    const beside = this.set.strides.some((far) => this.open[key - far] === 1 || this.open[key + far] === 1);
    if (!rim && !beside) {
      this.window.fill(key, this.rowsOf);
      let any = 0;
      for (let row = 0; row < 64; ++row) any |= this.reachedFrom(row);
      if (any === 0) return false;
    }
    this.open[key] = 1;
    return true;
  }

  // Returns the points of a row with a step to a reached point.
  reachedFrom(row) {
    const { rows, along, bits, side, middle } = this.window;
    const at = middle + (row >> 3) * side + (row & 7);
    let found = 0;
    for (let f = 0; f < along.length; ++f) found |= rows[at + along[f]] >> bits[f];
    return found & 255;
  }

  // Extends the reached points of a brick with voxels. Returns whether there are new ones.
  grow(key) {
    const reached = this.reached.get(key), full = this.set.bricks.get(key).rows;
    this.window.fill(key, this.rowsOf);
    let grown = false, more = true;
    for (let pass = 0; more; ++pass) {
      more = false;
      for (let n = 0; n < 64; ++n) {
        const row = pass % 2 === 0 ? n : 63 - n;
        const added = this.reachedFrom(row) & ~full[row] & ~reached[row];
        if (added === 0) continue;
        reached[row] |= added;
        this.window.rows[this.window.middle + (row >> 3) * this.window.side + (row & 7)] |= added << this.window.reach;
        more = grown = true;
      }
    }
    return grown;
  }
}
