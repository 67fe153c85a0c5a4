// Meshes, and the expected voxels of a box, found by trying every lattice link.
import { readFileSync } from 'node:fs';

export function octahedron(radius = 1) {
  const positions = [radius, 0, 0, -radius, 0, 0, 0, radius, 0, 0, -radius, 0, 0, 0, radius, 0, 0, -radius];
  const triangles = [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5];
  return { positions, triangles };
}

export function box(low, high) {
  const positions = [];
  for (let corner = 0; corner < 8; ++corner) {
    for (let m = 0; m < 3; ++m) positions.push((corner >> m) & 1 ? high[m] : low[m]);
  }
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  return { positions, triangles: sides.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]) };
}

export function readObj(file) {
  const positions = [], triangles = [];
  for (const line of readFileSync(file, 'utf8').split('\n')) {
    const [kind, ...words] = line.trim().split(/\s+/);
    if (kind === 'v') positions.push(...words.slice(0, 3).map(Number));
    if (kind === 'f') triangles.push(...words.slice(0, 3).map((word) => parseInt(word) - 1));
  }
  return { positions, triangles };
}

const world = (basis, ijk) => [0, 1, 2].map((m) => ijk[0] * basis[0][m] + ijk[1] * basis[1][m] + ijk[2] * basis[2][m]);

// Returns where the segment p to p + step meets the surface of the box, as parameters between 0 and 1. No end of the
// segment may lie on the surface.
function crossings(p, step, low, high) {
  let [enter, leave] = [-Infinity, Infinity];
  for (let m = 0; m < 3; ++m) {
    if (step[m] === 0) {
      if (p[m] < low[m] || p[m] > high[m]) return [];
      continue;
    }
    const [a, b] = [(low[m] - p[m]) / step[m], (high[m] - p[m]) / step[m]];
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
  }
  return enter <= leave ? [enter, leave].filter((s) => s > 0 && s < 1) : [];
}

// Returns all crossed links of a box's surface: { ends: ["i,j,k", "i,j,k"], nearer: Set of the nearer ends }. Each pair of
// neighbors has one entry in `directions`, in lattice coordinates.
export function crossedEdges({ basis, directions, low, high, range }) {
  const edges = [];
  for (let i = range[0]; i < range[1]; ++i) {
    for (let j = range[0]; j < range[1]; ++j) {
      for (let k = range[0]; k < range[1]; ++k) {
        for (const q of directions) {
          const found = crossings(world(basis, [i, j, k]), world(basis, q), low, high);
          if (found.length === 0) continue;
          const ends = [`${i},${j},${k}`, `${i + q[0]},${j + q[1]},${k + q[2]}`];
          if (found.includes(0.5)) throw new Error('the box was to have no ties');
          edges.push({ ends, nearer: new Set(found.map((s) => ends[s < 0.5 ? 0 : 1])) });
        }
      }
    }
  }
  return edges;
}

// One of each pair +-q of the k-neighbors of the Cartesian lattice.
export function cartesianDirections(k) {
  const all = [];
  for (const i of [0, 1]) for (const j of [-1, 0, 1]) for (const l of [-1, 0, 1]) all.push([i, j, l]);
  const positive = all.filter(([i, j, l]) => i > 0 || (i === 0 && (j > 0 || (j === 0 && l > 0))));
  return positive.filter((q) => q.filter((x) => x !== 0).length <= 3 - k);
}

// The same for the body-centered lattice with columns (2,0,0) (0,2,0) (1,1,1): three long steps, four diagonals.
export const BCC = [[2, 0, 0], [0, 2, 0], [1, 1, 1]];
export const bccDirections = [[1, 0, 0], [0, 1, 0], [-1, -1, 2], [0, 0, 1], [1, 0, -1], [0, 1, -1], [1, 1, -1]];
