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
  const paint = { name, ramp: false, legend: withRest(legend, rows), values: 'rgb' };
  return { paint, colors: values, values: NO_VALUES };
}

// Returns a choice of colors along a map, for numbers from `least` to `most`.
function paintOfRamp(name, numbers, map, least, most) {
  const colors = new Uint8Array(3 * numbers.length),
    span = most - least;
  numbers.forEach((n, at) => colors.set(between(map, (n - least) / span), 3 * at));
  const legend = Array.from({ length: STEPS + 1 }, (_, n) => [
    hex(between(map, n / STEPS)),
    n % (STEPS / 2) === 0 ? String(Number((least + (span * n) / STEPS).toPrecision(4))) : '',
  ]);
  return { paint: { name, ramp: true, legend }, colors };
}

function paintOfDistances({ name, values }) {
  const most = values.reduce((so, n) => Math.max(so, Math.abs(n)), 0) || 1,
    isSigned = values.some((n) => n < 0);
  const { paint, colors } = paintOfRamp(name, values, isSigned ? RED_BLUE : VIRIDIS, isSigned ? -most : 0, most);
  return { paint: { ...paint, values: 'float32' }, colors, values: rawBytes(values) };
}

function paintOfFractions(name, numbers, points) {
  const { paint, colors } = paintOfRamp(name, numbers, VIRIDIS, 0, points);
  return { paint: { ...paint, values: 'uint32' }, colors, values: rawBytes(Uint32Array.from(numbers)) };
}

function paintOfNumbers({ name, values }) {
  const colors = new Uint8Array(3 * values.length),
    counts = new Map();
  values.forEach((n, at) => {
    counts.set(n, (counts.get(n) ?? 0) + 1);
    colors.set(rgb(PALETTE[n % PALETTE.length]), 3 * at);
  });
  const rows = [...counts].sort(([a], [b]) => a - b);
  const legend = rows
    .slice(0, ENTRIES)
    .map(([n, count]) => [hex(rgb(PALETTE[n % PALETTE.length])), `${name} ${n}: ${voxels(count)}`]);
  const paint = { name, ramp: false, legend: withRest(legend, rows), values: 'uint32' };
  return { paint, colors, values: rawBytes(values) };
}

const PAINTS = {
  color: (field) => [() => paintOfColors(field)],
  part: (field) => [() => paintOfNumbers(field)],
  material: (field) => [() => paintOfNumbers(field)],
  triangle: (field) => [() => paintOfNumbers(field)],
  distance: (field) => [() => paintOfDistances(field)],
  fraction: ({ name, values }, points) => [() => paintOfFractions(name, values, points)],
  label_fractions: ({ columns, values }, points) =>
    columns.map((name, n) => () => {
      const length = values.length / columns.length,
        ofLabel = Uint16Array.from({ length }, (_, voxel) => values[voxel * columns.length + n]);
      return paintOfFractions(name, ofLabel, points);
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
