// Checks the facets that the page of `latvox view` shows against an independent search for the outside.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const source = ['voxels', 'cells', 'facets'].map((name) => readFileSync(new URL(`../../client/tool/view/${name}.js`, import.meta.url), 'utf8'));
const { VoxelSet, Outside, findFacets, findNormals, around, scatter, NO_NORMAL, Cells, Direction } = new Function(
  `${source.join('')}; return { VoxelSet, Outside, findFacets, findNormals, around, scatter, NO_NORMAL, Cells, Direction };`)();

const both = (steps) => steps.flatMap((step) => [step, step.map((n) => -n)]);
const STEPS = {
  cartesian: both([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
  hexagonal: both([[1, 0, 0], [0, 1, 0], [1, -1, 0], [0, 0, 1]]),
  fcc: both([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, -1, 0], [1, 0, -1], [0, 1, -1]]),
  bcc: both([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, -1], [0, 1, -1], [1, 1, -1], [1, 1, -2]]),
  far: both([[1, 0, 0], [0, 1, 0], [0, 0, 1], [8, -3, 1]]),
};

// Returns a deterministic number from 0 to 1.
function randomOf(seed) {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

// Returns voxels by their names, and as a set of bricks in the page's order, which numbers them.
function setOf(voxels, low, high) {
  const bricks = new Map(), set = new VoxelSet(low, high), numbers = [];
  for (const [i, j, k] of voxels) {
    const name = [i >> 3, j >> 3, k >> 3].join();
    if (!bricks.has(name)) bricks.set(name, { corner: [i & ~7, j & ~7, k & ~7], rows: new Uint8Array(64) });
    bricks.get(name).rows[((i & 7) << 3) | (j & 7)] |= 1 << (k & 7);
  }
  for (const { corner, rows } of bricks.values()) {
    set.addBrick(corner, rows, numbers.length);
    rows.forEach((row, n) => {
      for (let z = 0; z < 8; ++z) {
        if ((row >> z) & 1) numbers.push([corner[0] + (n >> 3), corner[1] + (n & 7), corner[2] + z].join());
      }
    });
  }
  return { set, numbers };
}

// Returns the names of empty points that are reached from outside, within the box and a margin.
function search(names, steps, low, high) {
  const far = 1 + Math.max(...steps.flat()), found = new Set(), next = [low.map((n) => n - far)];
  while (next.length > 0) {
    const at = next.pop();
    if (at.some((n, m) => n < low[m] - far || n >= high[m] + far) || names.has(at.join()) || found.has(at.join())) continue;
    found.add(at.join());
    for (const step of steps) next.push(at.map((n, m) => n + step[m]));
  }
  return found;
}

// Returns a hollow box with or without a hole, and some more voxels in and about it.
function shapeOf(random, hole) {
  const low = [-5, 3, -12], high = [9, 14, 6], voxels = new Map();
  const add = (...ijk) => voxels.set(ijk.join(), ijk);
  for (let i = low[0]; i < high[0]; ++i) {
    for (let j = low[1]; j < high[1]; ++j) {
      for (let k = low[2]; k < high[2]; ++k) {
        const rim = [i, j, k].some((n, m) => n < low[m] + 2 || n >= high[m] - 2);
        if (rim ? !(hole && i === 2 && j >= high[1] - 2 && k === -2) : random() < 0.05) add(i, j, k);
      }
    }
  }
  return { voxels, low, high };
}

for (const [lattice, steps] of Object.entries(STEPS)) {
  test(`facets of ${lattice} are those towards what is outside`, () => {
    const count = [false, true].map((hole) => {
      const { voxels, low, high } = shapeOf(randomOf(7), hole), { set, numbers } = setOf(voxels.values(), low, high);
      assert.deepEqual(new Set(numbers), new Set(voxels.keys()));
      assert.equal(set.count(), voxels.size);
      const wanted = (towards) => [...voxels].flatMap(([name, ijk]) => steps.flatMap((step, f) =>
        towards(ijk.map((n, m) => n + step[m]).join()) ? [`${f} ${name}`] : [])).sort();
      const facets = (outside) => {
        const { cells, numbers: of } = findFacets(set, steps, low, outside, () => 0, true);
        return cells.flatMap((cell, f) => of[f].map((number, n) => {
          assert.equal(low.map((from, m) => from + cell[4 * n + m]).join(), numbers[number]);
          return `${f} ${numbers[number]}`;
        })).sort();
      };
      assert.deepEqual(facets(null), wanted((name) => !voxels.has(name)));
      const outside = search(voxels, steps, low, high), seen = wanted((name) => outside.has(name));
      assert.deepEqual(facets(Outside.of(set, steps).rowsOf), seen);
      return seen.length;
    });
    if (lattice !== 'far') assert.ok(count[1] > 1.3 * count[0], `the hole matters: ${count}`);
  });
}

test('a part of a set keeps its numbers', () => {
  const { voxels, low, high } = shapeOf(randomOf(3), false), { set, numbers } = setOf(voxels.values(), low, high);
  const part = set.filter((i, j, k) => k <= -3), steps = STEPS.bcc;
  const { cells, numbers: of } = findFacets(part, steps, low, null, () => 0, true);
  cells.forEach((cell, f) => of[f].forEach((number, n) => {
    const ijk = low.map((from, m) => from + cell[4 * n + m]);
    assert.equal(ijk.join(), numbers[number]);
    assert.ok(ijk[2] <= -3);
  }));
  assert.ok(of.flat().length > 0);
  let seen = 0;
  part.forEach((i, j, k, number) => (assert.equal([i, j, k].join(), numbers[number]), ++seen));
  assert.equal(seen, [...voxels.values()].filter(([, , k]) => k <= -3).length);
});

test('points are all that is seen, each once, with a direction outwards', () => {
  const { voxels, low, high } = shapeOf(randomOf(5), false), { set, numbers } = setOf(voxels.values(), low, high);
  const facets = STEPS.cartesian.map((step) => ({ step, normal: step }));
  const normals = findNormals(set, facets, Outside.of(set, STEPS.cartesian).rowsOf);
  const { cells, numbers: of, ends } = scatter(set, low, normals);
  const rim = [...voxels.values()].filter((ijk) => ijk.some((n, m) => n === low[m] || n === high[m] - 1));
  assert.deepEqual([...of].map((number) => numbers[number]).sort(), rim.map((ijk) => ijk.join()).sort());
  of.forEach((number, n) => {
    const ijk = low.map((from, m) => from + cells[4 * n + m]), bits = cells[4 * n + 3];
    assert.equal(ijk.join(), numbers[number]);
    assert.notEqual(bits, NO_NORMAL);
    let [x, y] = [(bits & 255) / 127 - 1, (bits >> 8) / 127 - 1];
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
    [x, y, z].forEach((to, m) => {
      const wanted = ijk[m] === low[m] ? -1 : ijk[m] === high[m] - 1 ? 1 : 0;
      assert.ok(Math.abs(Math.sign(Math.abs(to) < 0.02 ? 0 : to) - wanted) < 1e-9, `${ijk}: ${[x, y, z]}`);
    });
  });
  // For each size of cube, the first points have one in each cube that has any.
  const cubes = (some, shift) => new Set(some.map((ijk) => ijk.map((n) => n >> shift).join()));
  const points = [...of].map((number) => numbers[number].split(',').map(Number));
  assert.equal(ends[0], points.length);
  for (const shift of [1, 2, 3]) {
    assert.deepEqual(cubes(points.slice(0, ends[shift]), shift), cubes(points, shift));
    assert.equal(ends[shift], cubes(points, shift).size);
  }
});

test('the facets of a cut face what is outside, a hollow, or a voxel that is hidden', () => {
  const { voxels, low, high } = shapeOf(randomOf(5), false), { set } = setOf(voxels.values(), low, high), steps = STEPS.bcc;
  const shown = set.filter((i, j, k) => k <= -3), outside = search(voxels, steps, low, high);
  const space = around(set, shown, Outside.of(set, steps).rowsOf);
  const facets = (where) => findFacets(shown, steps, low, where, () => 0, true).cells.flatMap((cell, f) =>
    Array.from({ length: cell.length / 4 }, (_, n) => `${f} ${low.map((from, m) => from + cell[4 * n + m]).join()}`)).sort();
  const wanted = (towards) => [...voxels].flatMap(([name, ijk]) => (ijk[2] > -3 ? [] : steps.flatMap((step, f) => {
    const to = ijk.map((n, m) => n + step[m]);
    return towards(to.join(), to) ? [`${f} ${name}`] : [];
  }))).sort();
  const parts = [
    [space.outside, (name) => outside.has(name)],
    [space.hollows, (name) => !voxels.has(name) && !outside.has(name)],
    [space.hidden, (name, to) => voxels.has(name) && to[2] > -3],
  ].map(([where, towards]) => {
    const found = facets(where);
    assert.ok(found.length > 50);
    assert.deepEqual(found, wanted(towards));
    return found;
  });
  assert.deepEqual(facets(null), parts.flat().sort());
  // Without an answer to what is outside, everything that is empty is.
  const unknown = around(set, shown, null);
  assert.deepEqual(facets(unknown.outside), [...parts[0], ...parts[1]].sort());
  assert.deepEqual(facets(unknown.hollows), []);
});

// Returns the page's data for a lattice with these facets.
function dataOf(basis, steps, low) {
  const vector = (step) => [0, 1, 2].map((m) => step.reduce((sum, n, which) => sum + n * basis[which][m], 0));
  const facets = steps.map((step) => {
    const to = vector(step), length = Math.hypot(...to);
    return { step, normal: to.map((n) => n / length), corners: [to.map((n) => n / 2)] };
  });
  return { basis, low, middle: [7, 5.5, 9], facets, grid: { origin: [10, 20, 30], basis: basis.map((v) => v.map((n) => 50 * n)) } };
}

const BASES = {
  cartesian: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], bcc: [[1, 0, 0], [0, 1, 0], [0.5, 0.5, 0.5]], fcc: [[1, 1, 0], [1, 0, 1], [0, 1, 1]],
};
for (const [lattice, unscaled] of Object.entries(BASES)) {
  const basis = unscaled.map((vector) => vector.map((n) => 0.03 * n));

  test(`a ray through ${lattice} finds the first voxel`, () => {
    const { voxels, low, high } = shapeOf(randomOf(11), true), { set, numbers } = setOf(voxels.values(), low, high);
    const cells = new Cells(dataOf(basis, STEPS[lattice], low)), random = randomOf(17), keep = (i, j, k) => k <= 1;
    const nearest = (place) => [...voxels.values()].map((ijk) => [Math.hypot(...cells.placeOf(ijk).map((n, m) => n - place[m])), ijk])
      .reduce((best, each) => (each[0] < best[0] ? each : best));
    let hits = 0;
    for (let ray = 0; ray < 60; ++ray) {
      const from = [0, 1, 2].map(() => 6 * random() - 3), aim = [0, 1, 2].map(() => 0.3 * random() - 0.15);
      const length = Math.hypot(...from.map((n, m) => aim[m] - n)), along = from.map((n, m) => (aim[m] - n) / length);
      const found = cells.first(set, keep, from, along);
      // Small steps along the ray visit the same cells.
      let wanted = null;
      for (let t = 0; t < 6 && wanted === null; t += 0.0005) {
        const place = from.map((n, m) => n + t * along[m]);
        if (Math.hypot(...place) > 0.999) continue;
        const ijk = cells.at(place);
        if (voxels.has(ijk.join()) && keep(...ijk)) {
          assert.deepEqual(nearest(place)[1], ijk);
          wanted = ijk;
        }
      }
      if (found === null || wanted === null) {
        assert.equal(found?.ijk.join(), wanted?.join());
        continue;
      }
      assert.equal(numbers[found.voxel], found.ijk.join());
      ++hits;
      // A step may jump over the corner of a cell.
      if (found.ijk.join() !== wanted.join()) {
        assert.ok(cells.facets.some(({ step }) => step.every((n, m) => found.ijk[m] + n === wanted[m])), `${found.ijk} ${wanted}`);
      }
    }
    assert.ok(hits > 20, `${hits}`);
  });

  test(`planes across ${lattice} keep what lies below them`, () => {
    const { voxels, low, high } = shapeOf(randomOf(11), true), { set } = setOf(voxels.values(), low, high);
    const cells = new Cells(dataOf(basis, STEPS[lattice], low)), normal = [1, -2, 0.5], length = Math.hypot(...normal);
    const direction = new Direction(cells, set, normal);
    const heights = new Map([...voxels].map(([name, ijk]) => [name, cells.worldOf(ijk).reduce((sum, n, m) => sum + (n * normal[m]) / length, 0)]));
    assert.ok(Math.abs(direction.low - Math.min(...heights.values())) < 1e-9);
    assert.ok(Math.abs(direction.high - Math.max(...heights.values())) < 1e-9);
    const offset = 0.4 * direction.low + 0.6 * direction.high, cut = direction.cut(offset, false);
    const below = [...voxels].filter(([name, ijk]) => (assert.equal(cut.keep(...ijk), heights.get(name) <= offset), cut.keep(...ijk)));
    assert.equal(direction.count(cut).upTo, below.length);
    assert.ok(below.length > 0 && below.length < voxels.size && !direction.keepsAll(cut));
    assert.ok(direction.keepsAll(direction.cut(direction.high, false)));
    // The layer has every voxel that the cut lays open.
    const layer = below.filter(([, ijk]) => cut.inLayer(...ijk));
    assert.equal(direction.count(cut).layer, layer.length);
    for (const [name, ijk] of below) {
      const open = STEPS[lattice].some((step) => voxels.has(ijk.map((n, m) => n + step[m]).join()) && !cut.keep(...ijk.map((n, m) => n + step[m])));
      assert.ok(!open || cut.inLayer(...ijk), name);
    }
  });
}
