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
    text = (value) => (Number.isNaN(value) ? 'nan' : value);
  let lines = [['i,j,k,x,y,z', ...fields.flatMap(({ columns }) => columns)].join()];
  forEachVoxel(bricks, (i, j, k, number) => {
    const at = [0, 1, 2].map((m) => origin[m] + i * a[m] + j * b[m] + k * c[m]);
    const carried = fields.flatMap(({ values, columns: { length } }) =>
      Array.from(values.subarray(length * number, length * (number + 1)), text),
    );
    lines.push([i, j, k, ...at, ...carried].join());
    if (lines.length === LINES) {
      parts.push(`${lines.join('\n')}\n`);
      lines = [];
    }
  });
  return [...parts, lines.length > 0 ? `${lines.join('\n')}\n` : ''];
}
