// A .npz as `latvox -o a.npz` writes it: dense arrays over the box of the voxels, and the place of that box.
import { zipSync } from 'fflate';
import { forEachVoxel } from './bricks.js';
import { isOfLinks } from './fields.js';

const MOST_CELLS = 1 << 26;

const TYPES = new Map([
  [Uint8Array, '|u1'],
  [Uint16Array, '<u2'],
  [Int32Array, '<i4'],
  [Float32Array, '<f4'],
  [Float64Array, '<f8'],
]);

// Returns a .npy.
function npyOf(array, shape) {
  const comma = shape.length === 1 ? ',' : '',
    type = TYPES.get(array.constructor),
    about = `{'descr': '${type}', 'fortran_order': False, 'shape': (${shape.join(', ')}${comma}), }`;
  const head = `${about.padEnd(64 * Math.ceil((about.length + 11) / 64) - 11)}\n`,
    bytes = new Uint8Array(10 + head.length + array.byteLength);
  bytes.set([0x93, ...new TextEncoder().encode('NUMPY'), 1, 0, head.length & 255, head.length >> 8]);
  bytes.set(new TextEncoder().encode(head), 10);
  bytes.set(new Uint8Array(array.buffer), 10 + head.length);
  return bytes;
}

// Returns a .npy of `components` numbers of each voxel, from the one of the number `first` on.
function denseOf(bricks, { low, size }, { values, columns, empty }, first, components) {
  const array = new values.constructor(components * size[0] * size[1] * size[2]).fill(empty);
  forEachVoxel(bricks, (i, j, k, number) => {
    const at = ((i - low[0]) * size[1] + j - low[1]) * size[2] + k - low[2];
    for (let n = 0; n < components; ++n) array[components * at + n] = values[columns.length * number + first + n];
  });
  return npyOf(array, components > 1 ? [...size, components] : size);
}

// Returns [name, .npy] of each array of a field. Labels have one each.
function arraysOf(bricks, box, field) {
  const { name, columns } = field;
  if (name === 'label_fractions') return columns.map((label, n) => [label, denseOf(bricks, box, field, n, 1)]);
  return [[name, denseOf(bricks, box, field, 0, columns.length)]];
}

// Returns the arrays of links: a row for each voxel, and none for other points of the box.
function linksOf(bricks, voxels, neighbors, fields) {
  const places = new Int32Array(3 * voxels);
  forEachVoxel(bricks, (i, j, k, number) => places.set([i, j, k], 3 * number));
  return [
    ['ijk', npyOf(places, [voxels, 3])],
    ['neighbors', npyOf(Int32Array.from(neighbors.flat()), [neighbors.length, 3])],
    ...fields.map(({ name, values }) => [name, npyOf(values, [voxels, neighbors.length])]),
  ];
}

function placeOf({ low }, { origin, basis }) {
  const corner = origin.map((n, m) => n + low[0] * basis[0][m] + low[1] * basis[1][m] + low[2] * basis[2][m]),
    rows = [0, 1, 2].flatMap((m) => [basis[0][m], basis[1][m], basis[2][m], corner[m]]);
  return {
    index_min: npyOf(Int32Array.from(low), [3]),
    affine: npyOf(Float64Array.from([...rows, 0, 0, 0, 1]), [4, 4]),
    basis: npyOf(Float64Array.from(basis.flat()), [3, 3]),
    origin: npyOf(Float64Array.from(origin), [3]),
  };
}

// Returns the bytes of the file. Throws an Error for too large a box.
export function npzOf(bricks, { low, high, grid }, fields, { neighbors }) {
  const box = { low, size: high.map((n, m) => n - low[m]) },
    cells = box.size.reduce((product, n) => product * n, 1);
  if (cells > MOST_CELLS)
    throw new Error(`.npz: the voxels' box has ${cells} points, more than ${MOST_CELLS}; the .csv has all voxels`);
  const voxels = forEachVoxel(bricks),
    data = { name: 'data', values: new Uint8Array(voxels).fill(1), empty: 0, columns: ['data'] },
    ofLinks = fields.filter(isOfLinks);
  const all = [
    ...[data, ...fields.filter((field) => !isOfLinks(field))].flatMap((field) => arraysOf(bricks, box, field)),
    ...(ofLinks.length > 0 ? linksOf(bricks, voxels, neighbors, ofLinks) : []),
    ...Object.entries(placeOf(box, grid)),
  ];
  return zipSync(Object.fromEntries(all.map(([name, bytes]) => [`${name}.npy`, bytes])), { level: 1 });
}
