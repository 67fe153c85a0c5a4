// Checks the faces of a .ply: three.js' loader tells neither of faces that it leaves out nor of an end that comes too
// early.
const MOST_HEAD = 1 << 20; // bytes

const NAMES = {
  Int8: ['char', 'int8'],
  Uint8: ['uchar', 'uint8'],
  Int16: ['short', 'int16'],
  Uint16: ['ushort', 'uint16'],
  Int32: ['int', 'int32'],
  Uint32: ['uint', 'uint32'],
  Float32: ['float', 'float32'],
  Float64: ['double', 'float64'],
};
const TYPES = new Map(
  Object.entries(NAMES).flatMap(([type, names]) =>
    names.map((name) => [name, { size: Number(type.match(/\d+/)) / 8, get: `get${type}` }]),
  ),
);

function typeOf(name) {
  if (TYPES.has(name)) return TYPES.get(name);
  throw new Error(`the header has the type "${name}", which is not one of ${[...TYPES.keys()].join(', ')}`);
}

// Both kinds of bodies have `at` and `end`. `read` returns a number, NaN after the end. `skip` passes over `count` of
// them, and after the end leaves `at` beyond it.
class Binary {
  constructor(bytes, at, isLittle) {
    Object.assign(this, { view: new DataView(bytes), at, end: bytes.byteLength, isLittle });
  }

  read({ size, get }) {
    const at = this.at;
    this.at += size;
    return this.at > this.end ? NaN : this.view[get](at, this.isLittle);
  }

  skip({ size }, count) {
    this.at += size * count;
  }
}

class Text {
  constructor(bytes, at) {
    Object.assign(this, { bytes: new Uint8Array(bytes), at, end: bytes.byteLength });
  }

  // Returns where the next word begins; `at` is where it ends.
  next() {
    const { bytes } = this;
    while (bytes[this.at] <= 32) ++this.at;
    const first = this.at;
    while (bytes[this.at] > 32) ++this.at;
    if (this.at === first) this.at = Infinity;
    return first;
  }

  read() {
    const first = this.next();
    return parseInt(String.fromCharCode(...this.bytes.subarray(first, this.at)), 10);
  }

  skip(_, count) {
    for (let n = 0; n < count && this.at <= this.end; ++n) this.next();
  }
}

function elementsOf(head) {
  const elements = [];
  for (const line of head.split(/[\r\n]+/)) {
    const [keyword, ...words] = line.trim().split(/\s+/);
    if (keyword === 'element') elements.push({ name: words[0], count: Number(words[1]), properties: [] });
    if (keyword !== 'property') continue;
    const [count, type] = words[0] === 'list' ? words.slice(1) : [null, words[0]];
    elements.at(-1)?.properties.push({
      isCorners: count !== null && /^vertex_ind(ices|ex)$/.test(words[3]),
      count: count === null ? null : typeOf(count),
      type: typeOf(type),
    });
  }
  return elements;
}

function skipElement(body, { name, count, properties }, n) {
  for (const property of properties) {
    const length = property.count === null ? 1 : body.read(property.count);
    if (name === 'face' && property.isCorners && (length < 3 || length > 4))
      throw new Error(`face ${n} has ${length} corners, and this page reads those with 3 or 4; use the tool latvox`);
    body.skip(property.type, length);
    if (!(length >= 0) || body.at > body.end)
      throw new Error(`the file ends or is damaged at ${name} ${n} of ${count}`);
  }
}

// Returns the number of faces. Throws an Error unless three.js reads all of them, and whatever else makes triangles.
export function countFaces(bytes) {
  const start = new TextDecoder('latin1').decode(bytes.slice(0, MOST_HEAD)),
    [all, head = ''] = start.match(/^ply(\s[^]*?[\r\n])end_header(\r?\n|\r)/) ?? [''];
  const [, format] = head.match(/^format (\w+)/m) ?? [],
    body = format === 'ascii' ? new Text(bytes, all.length) : new Binary(bytes, all.length, /little/.test(format));
  const elements = elementsOf(head),
    faces = elements.filter(({ name }) => name === 'face');
  if (elements.some(({ name, count }) => name === 'tristrips' && count > 0))
    throw new Error('the file has an element tristrips, which this page does not read; use the tool latvox');
  if (faces.some(({ properties }) => !properties.some(({ isCorners }) => isCorners)))
    throw new Error('element face has no list vertex_indices');
  for (const element of elements) for (let n = 0; n < element.count; ++n) skipElement(body, element, n);
  return faces.reduce((sum, { count }) => sum + count, 0);
}
