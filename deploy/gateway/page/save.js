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

// Returns the lines of a .csv: lattice coordinates, world positions, and fields, as `latvox -o a.csv` has them.
export function csvOf(bricks, { origin, basis: [a, b, c] }, fields) {
  const parts = [],
    columns = fields.map(({ name, bytes }) =>
      name === 'distance' ? new Float32Array(bytes.buffer) : new Uint32Array(bytes.buffer),
    );
  let lines = [['i,j,k,x,y,z', ...fields.map(({ name }) => name)].join()];
  forEachVoxel(bricks, (i, j, k, number) => {
    const at = [0, 1, 2].map((m) => origin[m] + i * a[m] + j * b[m] + k * c[m]);
    lines.push([i, j, k, ...at, ...columns.map((values) => values[number])].join());
    if (lines.length === LINES) {
      parts.push(`${lines.join('\n')}\n`);
      lines = [];
    }
  });
  return [...parts, lines.length > 0 ? `${lines.join('\n')}\n` : ''];
}
