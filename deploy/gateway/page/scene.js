// The data of the viewer: see client/tool/view/page.h.
import { facetsOf } from './cell.js';

// As client/tool/view/page.h and paints.h have them.
export const MOST_VOXELS = 4_000_000,
  MOST_COLORS = 20_000_000; // of all choices of colors together

// As client/tool/output/voxel_colors.cc has them.
const PALETTE = [
  0xe69f00, 0x56b4e9, 0x009e73, 0xf0e442, 0x0072b2, 0xd55e00, 0xcc79a7, 0x332288, 0x882255, 0x999933, 0xddcc77,
  0xaa4499,
];
const VIRIDIS = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725];
const RED_BLUE = [
  0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b, 0x67001f,
];
const ENTRIES = 24,
  STEPS = 32; // of legends

const UNCROSSED = [0xbb, 0xbb, 0xbb]; // the color of a voxel without a crossed link
const rgb = (color) => [16, 8, 0].map((shift) => (color >> shift) & 255);
const hex = (levels) => `#${levels.map((level) => level.toString(16).padStart(2, '0')).join('')}`;
const voxels = (count) => `${count} voxel${count === 1 ? '' : 's'}`;
const list = ({ x = 0, y = 0, z = 0 } = {}) => [x, y, z];
const ijk = ({ i = 0, j = 0, k = 0 } = {}) => [i, j, k];

function between(map, share) {
  const place = Math.min(Math.max(share, 0), 1) * (map.length - 1),
    first = Math.min(Math.floor(place), map.length - 2);
  const [low, high] = [rgb(map[first]), rgb(map[first + 1])];
  return low.map((level, n) => Math.round(level + (place - first) * (high[n] - level)));
}

// Returns a direction of the world in the view, where y is up.
const turned = ([x, y, z], up) => (up === 'y' ? [x, y, z] : [x, z, -y]);

// Returns the viewer's data without voxels. `reach`: how far voxels may lie outside of the mesh's box.
export function sceneOf(accepted, { title, up, reach }) {
  const basis = ['a', 'b', 'c'].map((name) => list(accepted.grid.basis[name])),
    origin = list(accepted.grid.origin);
  const low = list(accepted.mesh.min),
    high = list(accepted.mesh.max),
    first = ijk(accepted.indexBox.min);
  const center = low.map((n, m) => (n + high[m]) / 2);
  const radius =
    Math.hypot(...low.map((n, m) => (high[m] - n) / 2)) + reach + basis.reduce((sum, v) => sum + Math.hypot(...v), 0);
  const corner = origin.map((n, m) => n + first.reduce((sum, step, which) => sum + step * basis[which][m], 0));
  const shown = basis.map((v) =>
    turned(
      v.map((n) => n / radius),
      up,
    ),
  );
  return {
    title,
    low: first,
    high: ijk(accepted.indexBox.max),
    grid: { origin, basis },
    basis: shown,
    axes: [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ].map((axis) => turned(axis, up)),
    middle: coordinates(
      basis,
      center.map((n, m) => n - corner[m]),
    ),
    facets: facetsOf(shown),
    voxels: 0,
    metadata: [],
    paints: [],
    band: false,
  };
}

// Returns the coordinates of a vector in a basis, by Cramer's rule.
function coordinates([a, b, c], v) {
  const volume = (p, q, r) =>
    p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
  const all = volume(a, b, c);
  return [volume(v, b, c) / all, volume(a, v, c) / all, volume(a, b, v) / all];
}

const NO_VALUES = new Uint8Array();
const rawBytes = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

function withRest(legend, rows) {
  return rows.length > ENTRIES ? [...legend, ['', `and ${rows.length - ENTRIES} more`]] : legend;
}

// Returns a choice of colors whose voxels have the values of `field`, in 4 bytes each.
function withValues({ paint, colors }, { values, columns }) {
  const kind = values instanceof Float32Array ? 'float32' : 'uint32',
    wide = values instanceof Uint16Array ? Uint32Array.from(values) : values;
  return { paint: { ...paint, values: kind, components: columns.length }, colors, values: rawBytes(wide) };
}

// Returns a choice of colors, which have no values beside them. The legend has the most frequent ones.
function paintOfColors({ name, values }) {
  const counts = new Map();
  for (let at = 0; at < values.length; at += 3) {
    const color = (values[at] << 16) | (values[at + 1] << 8) | values[at + 2];
    counts.set(color, (counts.get(color) ?? 0) + 1);
  }
  const rows = [...counts].sort(([, a], [, b]) => b - a);
  const legend = rows.slice(0, ENTRIES).map(([color, count]) => {
    const name = hex(rgb(color));
    return [name, `${name}: ${voxels(count)}`];
  });
  const paint = { name, ramp: false, legend: withRest(legend, rows), values: 'rgb', components: 1 };
  return { paint, colors: values, values: NO_VALUES };
}

// Returns a choice of colors along a map, for numbers from `least` to `most`.
function paintOfRamp(name, numbers, map, least, most) {
  const colors = new Uint8Array(3 * numbers.length),
    span = most - least;
  numbers.forEach((n, at) => colors.set(Number.isNaN(n) ? UNCROSSED : between(map, (n - least) / span), 3 * at));
  const legend = Array.from({ length: STEPS + 1 }, (_, n) => [
    hex(between(map, n / STEPS)),
    n % (STEPS / 2) === 0 ? String(Number((least + (span * n) / STEPS).toPrecision(4))) : '',
  ]);
  return { paint: { name, ramp: true, legend }, colors };
}

function paintOfDistances(field) {
  const { name, values } = field;
  const most = values.reduce((so, n) => Math.max(so, Math.abs(n)), 0) || 1,
    isSigned = values.some((n) => n < 0);
  return withValues(paintOfRamp(name, values, isSigned ? RED_BLUE : VIRIDIS, isSigned ? -most : 0, most), field);
}

function paintOfFractions(field, points) {
  return withValues(paintOfRamp(field.name, field.values, VIRIDIS, 0, points), field);
}

// Returns a choice of colors that `colorOf` gives to the components of each voxel. `legend`: components and their text.
function paintOfVectors(field, colorOf, legend) {
  const { name, values, columns } = field,
    count = values.length / columns.length,
    colors = new Uint8Array(3 * count);
  for (let n = 0; n < count; ++n) {
    colors.set(colorOf(...values.subarray(columns.length * n, columns.length * (n + 1))), 3 * n);
  }
  const entries = legend.map(([text, ...vector]) => [hex(colorOf(...vector)), text]);
  return withValues({ paint: { name, ramp: false, legend: entries }, colors }, field);
}

const level = (share) => Math.round(255 * Math.min(Math.max(share, 0), 1));
const colorOfWeights = (u, v) => [1 - u - v, u, v].map(level);
const colorOfNormal = (...normal) => normal.map((n) => level((n + 1) / 2));
const CORNERS = [
  ['corner 1', 0, 0],
  ['corner 2', 1, 0],
  ['corner 3', 0, 1],
];
const DIRECTIONS = [
  ['x', 1, 0, 0],
  ['y', 0, 1, 0],
  ['z', 0, 0, 1],
  ['-x', -1, 0, 0],
  ['-y', 0, -1, 0],
  ['-z', 0, 0, -1],
];

// Returns the field with one number for each voxel: `pick` of those of its links.
function oneOfLinks({ name, values, columns }, pick) {
  const length = values.length / columns.length,
    ofVoxel = (n) => values.subarray(columns.length * n, columns.length * (n + 1));
  return { name, values: values.constructor.from({ length }, (_, n) => ofVoxel(n).reduce(pick)), columns: [name] };
}

// NaN stands for a link that is not crossed.
const leastShare = (a, b) => (a <= b || Number.isNaN(b) ? a : b);
// As unsigned numbers, so that -1, which stands for no triangle, is the largest.
const firstTriangle = (a, b) => (a >>> 0 <= b >>> 0 ? a : b);

function paintOfNumbers(field, none) {
  const { name, values } = field,
    colorOf = (n) => (n === none ? UNCROSSED : rgb(PALETTE[n % PALETTE.length])),
    textOf = (n) => (n === none ? 'no crossed link' : `${name} ${n}`);
  const colors = new Uint8Array(3 * values.length),
    counts = new Map();
  values.forEach((n, at) => {
    counts.set(n, (counts.get(n) ?? 0) + 1);
    colors.set(colorOf(n), 3 * at);
  });
  const rows = [...counts].sort(([a], [b]) => a - b);
  const legend = rows
    .slice(0, ENTRIES)
    .map(([n, count]) => [hex(colorOf(n)), `${textOf(n)}: ${voxels(count)}`]);
  return withValues({ paint: { name, ramp: false, legend: withRest(legend, rows) }, colors }, field);
}

const PAINTS = {
  color: (field) => [() => paintOfColors(field)],
  part: (field) => [() => paintOfNumbers(field)],
  material: (field) => [() => paintOfNumbers(field)],
  triangle: (field) => [() => paintOfNumbers(field)],
  distance: (field) => [() => paintOfDistances(field)],
  point: (field) => [() => paintOfVectors(field, colorOfWeights, CORNERS)],
  normal: (field) => [() => paintOfVectors(field, colorOfNormal, DIRECTIONS)],
  links: (field) => [
    () => {
      const one = oneOfLinks(field, leastShare);
      return withValues(paintOfRamp(one.name, one.values, VIRIDIS, 0, 1), one);
    },
  ],
  link_triangles: (field) => [() => paintOfNumbers(oneOfLinks(field, firstTriangle), -1)],
  link_crossings: (field) => [() => paintOfNumbers(oneOfLinks(field, (a, b) => Math.max(a, b)), 0)],
  fraction: (field, points) => [() => paintOfFractions(field, points)],
  label_fractions: ({ columns, values }, points) =>
    columns.map((name, n) => () => {
      const length = values.length / columns.length,
        ofLabel = Uint16Array.from({ length }, (_, voxel) => values[voxel * columns.length + n]);
      return paintOfFractions({ name, values: ofLabel, columns: [name] }, points);
    }),
};

// Returns a function for each choice of colors that the fields give. It returns { paint, colors, values }: for each
// voxel, 3 bytes of colors, and 4 or none of values. As in a page of `latvox view`, colors come first. `points`: of a
// cell, for fractions.
export function paintsOf(fields, points) {
  const colorsFirst = [...fields].sort((a, b) => (b.name === 'color') - (a.name === 'color'));
  return colorsFirst.flatMap((field) => PAINTS[field.name]?.(field, points) ?? []);
}

// Returns names and values of a message, with paths as names.
export function flattened(message, path = '') {
  return Object.entries(message).flatMap(([name, value]) => {
    const at = path === '' ? name : `${path}.${name}`;
    return value !== null && typeof value === 'object' && !Array.isArray(value)
      ? flattened(value, at)
      : [[at, Array.isArray(value) ? JSON.stringify(value) : String(value)]];
  });
}
