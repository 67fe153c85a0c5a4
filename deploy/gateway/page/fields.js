// The fields of voxels: the types and names of their numbers. Needs no browser.
// `empty`: the number where there is no voxel. Numbers of 32 bits are below 2^31; -1 means that there is no triangle.
const BYTES = { Kind: Uint8Array, empty: 0 },
  SHORTS = { Kind: Uint16Array, empty: 0 },
  NUMBERS = { Kind: Int32Array, empty: -1 },
  FLOATS = { Kind: Float32Array, empty: NaN };

const ofLinks = (name) => ({ neighbors }) => neighbors.map((step) => [name, ...step].join('_'));

// `columns`: a name for each component, or a function of the layout that returns them. As the tool's tables have them.
export const FIELDS = {
  part: { ...NUMBERS, columns: ['part'] },
  material: { ...NUMBERS, columns: ['material'] },
  color: { ...BYTES, columns: ['red', 'green', 'blue'] },
  distance: { ...FLOATS, columns: ['distance'] },
  triangle: { ...NUMBERS, columns: ['triangle'] },
  point: { ...FLOATS, columns: ['u', 'v'] },
  normal: { ...FLOATS, columns: ['nx', 'ny', 'nz'] },
  fraction: { ...SHORTS, columns: ['fraction'] },
  label_fractions: { ...SHORTS, columns: ({ labels }) => labels.map((label) => `fraction_${label}`) },
  links: { ...FLOATS, columns: ofLinks('link') },
  link_triangles: { ...NUMBERS, columns: ofLinks('link_triangle') },
  link_crossings: { ...NUMBERS, columns: ofLinks('link_crossings') },
};

export const LINK_FIELDS = ['links', 'link_triangles', 'link_crossings'];
export const isOfLinks = ({ name }) => LINK_FIELDS.includes(name);

// Returns the layout of fields that have a number for each neighbor, as [i, j, k], or for each label.
export function layoutOf({ neighbors = [], fractionLabels = [] }) {
  return { neighbors: neighbors.map(({ i = 0, j = 0, k = 0 }) => [i, j, k]), labels: fractionLabels };
}

// Returns { name, columns, values, empty } of a field's bytes: values has a number for each voxel and column.
export function fieldOf(name, bytes, layout) {
  const { Kind, empty, columns } = FIELDS[name];
  return { name, values: new Kind(bytes.buffer), empty, columns: Array.isArray(columns) ? columns : columns(layout) };
}
