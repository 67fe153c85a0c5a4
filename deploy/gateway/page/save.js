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
    const line = [i, j, k];
    for (let m = 0; m < 3; ++m) line.push(origin[m] + i * a[m] + j * b[m] + k * c[m]);
    for (const { values, columns } of fields) {
      const end = columns.length * (number + 1);
      for (let n = end - columns.length; n < end; ++n) line.push(text(values[n]));
    }
    lines.push(line.join());
    if (lines.length === LINES) {
      parts.push(`${lines.join('\n')}\n`);
      lines = [];
    }
  });
  return [...parts, lines.length > 0 ? `${lines.join('\n')}\n` : ''];
}
