// VoxelizeSpec of a mesh and settings. Needs no browser.
import { numbersOf } from './settings.js';

const NAMED = {
  cartesian: 'NAMED_LATTICE_CARTESIAN',
  bcc: 'NAMED_LATTICE_BCC',
  fcc: 'NAMED_LATTICE_FCC',
  hexagonal: 'NAMED_LATTICE_HEXAGONAL',
};

function vectorsOf(text) {
  const numbers = numbersOf(text);
  return Array.from({ length: numbers.length / 3 }, (_, n) => {
    const [x, y, z] = numbers.slice(3 * n);
    return { x, y, z };
  });
}

function latticeOf({ lattice, basis }) {
  if (lattice !== 'basis') return { named: NAMED[lattice] };
  const [a, b, c] = vectorsOf(basis);
  return { basis: { a, b, c } };
}

const labelsOf = ({ labels }) => (labels === 'none' ? {} : { labels: `FIELD_${labels.toUpperCase()}` });

const ruleOf = (name, { rule = 'auto' }) =>
  rule === 'auto' ? {} : { [name]: `INTERIOR_RULE_${rule.toUpperCase()}` };

const solid = (surface) => (settings) => ({
  solid: {
    surface: `SOLID_SURFACE_${surface}`,
    forceOpen: settings['force-open'] === 'yes',
    ...ruleOf('rule', settings),
    ...labelsOf(settings),
  },
});
const enclosed = (surface) => (settings) => ({
  enclosed: { surface: `SOLID_SURFACE_${surface}`, close: Number(settings.close), ...labelsOf(settings) },
});

const SETS = {
  surface: () => ({ surface: {} }),
  supercover: () => ({ supercover: {} }),
  solid: solid('SEPARATING'),
  'supercover-solid': solid('SUPERCOVER'),
  interior: solid('NONE'),
  band: ({ width }) => ({ band: { voxels: Number(width) } }),
  enclosed: enclosed('SEPARATING'),
  'enclosed-interior': enclosed('NONE'),
  region: ({ seed, close, 'allow-outside': outside }) => ({
    connected: { seed: vectorsOf(seed)[0], close: Number(close), allowOutside: outside === 'yes' },
  }),
  links: ({ side }) => ({ links: { side: `LINK_SIDE_${side.toUpperCase()}` } }),
};

// `fields`: names. `settings`: see settingsOf.
export function specOf(settings, fields) {
  const { resolution, k = 0, verify, signed, 'fraction-n': fraction = 0 } = settings;
  const set = SETS[settings.set](settings);
  return {
    lattice: latticeOf(settings),
    ...(resolution === '' ? {} : { resolution: Number(resolution) }),
    separability: Number(k),
    verify: verify === 'yes',
    fields: fields.map((name) => `FIELD_${name.toUpperCase()}`),
    signedDistance: signed === 'yes',
    fractionN: Number(fraction),
    ...set,
    ...(set.solid === undefined ? ruleOf('interiorRule', settings) : {}),
    encoding: 'BRICK_ENCODING_PACKED',
  };
}
