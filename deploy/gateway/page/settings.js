// The settings of a request: names, allowed values, and when they count. Form and links have them as texts by name; ''
// stands for a box that is not ticked. The names are those of the tool's options. Needs no browser.
import { FIELDS, LINK_FIELDS } from './fields.js';

const SOLIDS = ['solid', 'supercover-solid', 'interior'],
  ENCLOSED = ['enclosed', 'enclosed-interior'],
  WALKS = [...ENCLOSED, 'region'];
const SETS = ['surface', 'supercover', ...SOLIDS, 'band', ...WALKS, 'links'];
const SEPARATING = ['surface', 'solid', ...WALKS, 'links'];
const CELL_FIELDS = ['fraction', 'label_fractions'];
const NAMES_OF_FIELDS = Object.keys(FIELDS);

export const listOf = (text) => text.split(',').filter((word) => word !== '');
export const numbersOf = (text) => text.trim().split(/[\s,]+/).map((word) => (word === '' ? NaN : Number(word)));

// Each returns what is wrong with a text, or ''.
const oneOf = (values) => (text) => (values.includes(text) ? '' : `is not one of ${values.join(', ')}`);
const ticked = (text) => (['', 'yes'].includes(text) ? '' : 'is not yes');
const number = (least, most, what = 'a number') => (text) => {
  const [value, ...others] = numbersOf(text),
    isOfKind = others.length === 0 && Number.isFinite(value) && (what === 'a number' || Number.isInteger(value));
  const range = most === Infinity ? `of at least ${least}` : `from ${least} to ${most}`;
  return isOfKind && value >= least && value <= most ? '' : `is not ${what} ${range}`;
};
const numbers = (count, what) => (text) => {
  const found = numbersOf(text);
  return found.length === count && found.every(Number.isFinite) ? '' : `is not ${what}`;
};
const resolution = number(2, 65536, 'a whole number');

function fields(text) {
  const words = listOf(text),
    unknown = words.find((word) => !NAMES_OF_FIELDS.includes(word));
  if (unknown !== undefined) return `has "${unknown}", which is not one of ${NAMES_OF_FIELDS.join(', ')}`;
  return new Set(words).size === words.length ? '' : 'names a field twice';
}

const withSet = (...sets) => ({ when: ({ set }) => sets.includes(set), only: `with set ${sets.join(', ')}` });
const hasField = ({ fields }, names) => listOf(fields).some((name) => names.includes(name));
const withField = (...names) => ({
  when: (texts) => hasField(texts, names),
  only: `with fields ${names.join(', ')}`,
});

// `check` gets the text and all texts. A setting without `when` always counts; `only` puts `when` into words.
export const SETTINGS = {
  lattice: { check: oneOf(['cartesian', 'bcc', 'fcc', 'hexagonal', 'basis']) },
  resolution: { check: (text, { lattice }) => (text === '' && lattice === 'basis' ? '' : resolution(text)) },
  basis: {
    check: numbers(9, 'nine numbers a1,a2,a3,b1,b2,b3,c1,c2,c3'),
    when: ({ lattice }) => lattice === 'basis',
    only: 'with lattice basis',
  },
  set: { check: oneOf(SETS) },
  k: {
    check: oneOf(['0', '1', '2']),
    // A supercover is the same for every k. Only the number of its redundant voxels is not.
    when: (texts) =>
      SEPARATING.includes(texts.set) ||
      (texts.set === 'supercover' && texts.verify === 'yes') ||
      hasField(texts, LINK_FIELDS),
    only: `with set ${SEPARATING.join(', ')}, with verify, or with fields of links`,
  },
  width: { check: number(0.001, 256), ...withSet('band') },
  seed: { check: numbers(3, 'three numbers x,y,z'), ...withSet('region') },
  close: { check: number(0, Infinity), ...withSet(...WALKS) },
  'allow-outside': { check: ticked, ...withSet('region') },
  side: { check: oneOf(['both', 'inside', 'outside']), ...withSet('links') },
  rule: {
    check: oneOf(['auto', 'parity', 'winding', 'positive']),
    when: (texts) =>
      SOLIDS.includes(texts.set) ||
      (texts.set === 'links' && texts.side !== 'both') ||
      (hasField(texts, ['distance']) && texts.signed === 'yes') ||
      hasField(texts, CELL_FIELDS),
    only: `with set ${SOLIDS.join(', ')}, with signed, with a fraction, or with one side of links`,
  },
  labels: { check: oneOf(['none', 'part', 'material']), ...withSet(...SOLIDS, ...ENCLOSED) },
  'force-open': { check: ticked, ...withSet(...SOLIDS) },
  fields: { check: fields },
  'fraction-n': { check: number(2, 16, 'a whole number'), ...withField(...CELL_FIELDS) },
  signed: { check: ticked, ...withField('distance') },
  verify: { check: ticked, ...withSet('surface', 'supercover') },
  up: { check: oneOf(['y', 'z']) },
};

export const counts = (name, texts) => SETTINGS[name].when?.(texts) ?? true;

// Returns the texts of those settings that count.
export const counting = (texts) => Object.fromEntries(Object.entries(texts).filter(([name]) => counts(name, texts)));

// Returns { name, message } of the first text that is wrong, or null.
export function faultOf(texts, all = texts) {
  for (const [name, text] of Object.entries(texts)) {
    const wrong = SETTINGS[name].check(text, all);
    if (wrong !== '') return { name, message: `${name}: "${text}" ${wrong}` };
  }
  return null;
}

// Returns the settings of texts that are right, with a list of fields: a labeled set carries the field of its labels.
export function settingsOf(texts) {
  const found = counting(texts),
    labels = (found.labels ?? 'none') === 'none' ? [] : [found.labels];
  return { ...found, fields: [...new Set([...listOf(found.fields), ...labels])] };
}
