// A .npz as `latvox -o a.npz` writes it: dense arrays over the box of the voxels, and the place of that box.
import { zipSync } from 'fflate';
import { forEachVoxel } from './bricks.js';
import { isOfLinks } from './fields.js';

const MOST_BYTES = 1 << 30; // of all arrays of a file

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

// Returns i, j, k of each voxel, in the order of the fields' values.
function placesOf(bricks) {
  const places = new Int32Array(3 * forEachVoxel(bricks));
  forEachVoxel(bricks, (i, j, k, number) => places.set([i, j, k], 3 * number));
  return places;
}

// Returns the smallest box of the voxels.
function boxOf(places) {
  if (places.length === 0) return { low: [0, 0, 0], size: [0, 0, 0] };
  const low = [...places.subarray(0, 3)],
    high = [...low];
  places.forEach((n, at) => {
    low[at % 3] = Math.min(low[at % 3], n);
    high[at % 3] = Math.max(high[at % 3], n);
  });
  return { low, size: high.map((n, m) => n + 1 - low[m]) };
}

// Returns a .npy of `components` numbers of each voxel, from the one of the number `first` on.
function denseOf(places, { low, size }, { values, columns, empty }, first, components) {
  const array = new values.constructor(components * size[0] * size[1] * size[2]).fill(empty);
  for (let number = 0; 3 * number < places.length; ++number) {
    const [x, y, z] = [0, 1, 2].map((m) => places[3 * number + m] - low[m]),
      at = (x * size[1] + y) * size[2] + z;
    for (let n = 0; n < components; ++n) array[components * at + n] = values[columns.length * number + first + n];
  }
  return npyOf(array, components > 1 ? [...size, components] : size);
}

// Returns [name, .npy] of each array of a field. Labels have one each.
function arraysOf(places, box, field) {
  const { name, columns } = field;
  if (name === 'label_fractions') return columns.map((label, n) => [label, denseOf(places, box, field, n, 1)]);
  return [[name, denseOf(places, box, field, 0, columns.length)]];
}

// Returns the arrays of links: a row for each voxel, and none for other points of the box.
function linksOf(voxels, neighbors, fields) {
  return [
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

const sum = (numbers) => numbers.reduce((total, n) => total + n, 0);

// Returns the bytes of the file. Throws an Error for too large arrays.
export function npzOf(bricks, { grid }, fields, { neighbors }) {
  const places = placesOf(bricks),
    voxels = places.length / 3,
    box = boxOf(places),
    data = { name: 'data', values: new Uint8Array(voxels).fill(1), empty: 0, columns: ['data'] };
  const dense = [data, ...fields.filter((field) => !isOfLinks(field))],
    ofLinks = fields.filter(isOfLinks);
  const element = sum(dense.map(({ values, columns }) => columns.length * values.BYTES_PER_ELEMENT)),
    rows = places.byteLength + sum(ofLinks.map(({ values }) => values.byteLength)),
    bytes = box.size.reduce((product, n) => product * n, element) + rows;
  if (bytes > MOST_BYTES) {
    const about = `arrays over ${box.size.join(' × ')} points have ${bytes} bytes, more than ${MOST_BYTES}`;
    throw new Error(`.npz: ${about}; the .csv has all voxels`);
  }
  const all = [
    ...dense.flatMap((field) => arraysOf(places, box, field)),
    ['ijk', npyOf(places, [voxels, 3])],
    ...(ofLinks.length > 0 ? linksOf(voxels, neighbors, ofLinks) : []),
    ...Object.entries(placeOf(box, grid)),
  ];
  return zipSync(Object.fromEntries(all.map(([name, array]) => [`${name}.npy`, array])), { level: 1 });
}
