// The address of the page, which repeats a request: first settings, then the mesh.
// #lattice=bcc&resolution=64&set=surface&k=0&fields=distance&up=z&name=a.stl&mesh=SHA256&raw=VERTICES,TRIANGLES,TYPE
// At the end of `raw` are fields of the mesh: material; color, or texture if its colors come from images.
import { counting, counts, faultOf, SETTINGS } from './settings.js';

const ALWAYS = ['lattice', 'resolution', 'set', 'k', 'up'];
const OF_MESH = ['name', 'mesh', 'raw'];
const RAW = /^(\d+),([1-9]\d*),(float32|float64)(,material)?(,color|,texture)?$/;

// `initial`: the texts of the untouched form.
export function addressOf(texts, initial, { name, sha256, spec, textured }) {
  const wanted = Object.entries(counting(texts)).filter(
    ([setting, text]) => ALWAYS.includes(setting) || text !== initial[setting],
  );
  const words = new URLSearchParams(wanted);
  const raw = [spec.vertices, spec.triangles, spec.positions.replace('POSITION_TYPE_', '').toLowerCase()];
  for (const field of spec.fields.slice(1)) {
    const isTexture = field === 'FIELD_COLOR' && textured !== null;
    raw.push(isTexture ? 'texture' : field.replace('FIELD_', '').toLowerCase());
  }
  for (const [word, text] of [['name', name], ['mesh', sha256], ['raw', raw.join()]]) words.set(word, text);
  return `#${words}`;
}

function faultOfNames(names) {
  const known = [...Object.keys(SETTINGS), ...OF_MESH],
    unknown = names.find((name) => !known.includes(name));
  if (unknown !== undefined) return `"${unknown}" is not one of the settings ${known.join(', ')}`;
  const twice = names.find((name, n) => names.indexOf(name) < n);
  return twice === undefined ? null : `${twice}: is there twice`;
}

function faultOfMesh(mesh, raw) {
  if (mesh === null) return raw === null ? null : `raw: "${raw}" counts only with mesh`;
  if (!/^[0-9a-f]{64}$/.test(mesh)) return `mesh: "${mesh}" is not the 64 hexadecimal digits of a SHA-256`;
  return RAW.test(raw ?? '') ? null : `raw: "${raw ?? ''}" is not VERTICES,TRIANGLES,float32 or float64, then fields`;
}

function meshOf(words) {
  const [, vertices, triangles, type, material, colors] = words.get('raw').match(RAW);
  const fields = ['FIELD_PART', ...(material ? ['FIELD_MATERIAL'] : []), ...(colors ? ['FIELD_COLOR'] : [])],
    positions = `POSITION_TYPE_${type.toUpperCase()}`,
    textured = colors === ',texture' ? undefined : null; // a link has no textures
  const spec = { vertices: Number(vertices), triangles: Number(triangles), positions, fields };
  return { name: words.get('name') ?? 'mesh', spec, bytes: null, textured, sha256: words.get('mesh') };
}

// Returns { texts, mesh, fault }: the settings that are right by themselves, the mesh or null if it is wrong or missing,
// and what is wrong or null.
export function readAddress(hash, initial) {
  const words = new URLSearchParams(hash.slice(1)),
    given = Object.fromEntries([...words].filter(([name]) => Object.hasOwn(SETTINGS, name))),
    all = { ...initial, ...given };
  const texts = Object.fromEntries(
    Object.entries(given).filter(([name, text]) => faultOf({ [name]: text }, all) === null),
  );
  const idle = Object.keys(given).find((name) => given[name] !== initial[name] && !counts(name, all));
  const wrongMesh = faultOfMesh(words.get('mesh'), words.get('raw'));
  const fault =
    faultOfNames([...words.keys()]) ??
    faultOf(given, all)?.message ??
    (idle === undefined ? null : `${idle}: "${given[idle]}" counts only ${SETTINGS[idle].only}`) ??
    faultOf(counting(all), all)?.message ??
    wrongMesh;
  return { texts, mesh: wrongMesh === null && words.has('mesh') ? meshOf(words) : null, fault };
}
