// Downloads of a result.
import { forEachVoxel } from './bricks.js';

const LINES = 100_000; // in one part of a file

export function download(name, parts, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob(parts, { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

// Returns { name, valueOf } of each column of a field.
function columnsOf({ name, bytes }) {
  if (name === 'color')
    return ['red', 'green', 'blue'].map((level, n) => ({ name: level, valueOf: (voxel) => bytes[3 * voxel + n] }));
  const values = name === 'distance' ? new Float32Array(bytes.buffer) : new Uint32Array(bytes.buffer);
  return [{ name, valueOf: (voxel) => values[voxel] }];
}

// Returns the lines of a .csv: lattice coordinates, world positions, and fields, as `latvox -o a.csv` has them.
export function csvOf(bricks, { origin, basis: [a, b, c] }, fields) {
  const parts = [],
    columns = fields.flatMap(columnsOf);
  let lines = [['i,j,k,x,y,z', ...columns.map(({ name }) => name)].join()];
  forEachVoxel(bricks, (i, j, k, number) => {
    const at = [0, 1, 2].map((m) => origin[m] + i * a[m] + j * b[m] + k * c[m]);
    lines.push([i, j, k, ...at, ...columns.map(({ valueOf }) => valueOf(number))].join());
    if (lines.length === LINES) {
      parts.push(`${lines.join('\n')}\n`);
      lines = [];
    }
  });
  return [...parts, lines.length > 0 ? `${lines.join('\n')}\n` : ''];
}
