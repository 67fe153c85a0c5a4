// The page: a mesh and a request on the left, the viewer on the right. The address repeats the request:
// #lattice=bcc&resolution=64&set=surface&k=0&up=z&fields=distance&name=a.stl&mesh=SHA256&raw=VERTICES,TRIANGLES,TYPE
// with color or texture at the end for a mesh that has them, and basis=a1,a2,… for a lattice of one's own.
import { Job, NAMED } from './job.js';
import { readMesh } from './meshes.js';
import { npzOf } from './npz.js';
import { csvOf, download } from './save.js';
import { Service } from './service.js';

const byId = (id) => document.getElementById(id),
  form = byId('form');
const SETTINGS = ['lattice', 'resolution', 'set', 'k', 'up', 'width', 'basis'];
const count = (number, one) => `${Number(number).toLocaleString('en-US')} ${one}${Number(number) === 1 ? '' : 's'}`;
const service = new Service(() => byId('token').value.trim());
const state = { mesh: null, job: null };

function say(text, error = false) {
  byId('status').textContent = error ? '' : text;
  byId('error').textContent = error ? text : '';
  byId('error').hidden = !error;
}

// Returns the settings of the form by their names.
function settings() {
  const found = Object.fromEntries(SETTINGS.map((name) => [name, form.elements[name].value]));
  const fields = [...form.querySelectorAll('[name=fields]:checked')].map(({ value }) => value);
  return { ...found, fields, verify: form.elements.verify.checked };
}

function address() {
  const { width, basis, fields, verify, ...others } = settings(),
    { name, sha256, spec } = state.mesh,
    words = new URLSearchParams(others);
  if (others.set === 'band') words.set('width', width);
  if (others.lattice === 'basis') words.set('basis', basis.trim().split(/[\s,]+/).join());
  if (fields.length > 0) words.set('fields', fields.join());
  if (verify) words.set('verify', 'yes');
  words.set('name', name);
  words.set('mesh', sha256);
  const raw = [spec.vertices, spec.triangles, spec.positions.replace('POSITION_TYPE_', '').toLowerCase()];
  if (hasColors(state.mesh)) raw.push(state.mesh.textured === null ? 'color' : 'texture');
  words.set('raw', raw.join());
  return `#${words}`;
}

const hasColors = ({ spec }) => spec.fields.includes('FIELD_COLOR');

function show(mesh) {
  const box = form.querySelector('[name=fields][value=color]');
  box.disabled = !hasColors(mesh);
  box.checked &&= !box.disabled;
  state.mesh = mesh;
  byId('mesh').textContent = mesh.name;
  byId('facts').textContent = `${count(mesh.spec.triangles, 'triangle')}${mesh.bytes ? '' : ', kept by the server'}`;
  byId('run').disabled = false;
  document.title = `latvox: ${mesh.name}`;
}

async function take(file) {
  if (file === undefined) return;
  state.job?.cancel();
  say(`reading ${file.name}`);
  document.body.dataset.busy = 'yes';
  try {
    if (!crypto.subtle)
      throw new Error('This page needs https, or an address of this machine: browsers compute SHA-256 only there.');
    const { spec, bytes, up, textured } = await readMesh(file.name, await file.arrayBuffer());
    const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
    const sha256 = [...digest].map((n) => n.toString(16).padStart(2, '0')).join('');
    show({ name: file.name, spec, bytes, textured, sha256 });
    form.elements.up.value = up;
    say('');
    await run();
  } catch (error) {
    say(error.message, true);
    document.body.dataset.busy = 'no';
  }
}

// Shows what a person may do while a job runs, or while none does.
function setRunning(runs) {
  for (const id of ['cancel', 'progress']) byId(id).hidden = !runs;
  byId('run').hidden = runs;
  document.body.dataset.busy = runs ? 'yes' : 'no';
}

// Returns null, and says why, for a setting that is wrong.
function jobOf() {
  say('');
  if (!form.reportValidity()) return null;
  try {
    return new Job(service, state.mesh, settings(), byId('viewer'));
  } catch (error) {
    say(error.message, true);
    return null;
  }
}

// Starts the request of the form.
async function run() {
  if (state.mesh === null) return;
  state.job?.cancel();
  const job = (state.job = jobOf());
  byId('result').hidden = true; // its buttons save the last job
  setRunning(job !== null);
  if (job === null) return;
  try {
    history.replaceState(null, '', address());
    await job.run((text, share) => {
      say(text);
      byId('progress').value = share;
      byId('empty').hidden = !byId('viewer').hidden;
    });
    if (job === state.job) finish(job);
  } catch (error) {
    if (job === state.job) fail(job, error);
  } finally {
    if (job === state.job) setRunning(false);
  }
}

function fail(job, error) {
  if (job.canceled) return say('canceled');
  const lost = error.reason === 'MESH_NOT_FOUND';
  say(
    lost
      ? `The server no longer has ${state.mesh.name}: drop the file once more.`
      : `${error.message || error.code}${error.reason ? ` (${error.reason})` : ''}`,
    true,
  );
}

function finish({ summary, accepted, seconds, shown }) {
  const { certificate: c, timings: t = {} } = summary,
    ms = (n = 0) => `${Number(n).toFixed(n < 10 ? 2 : 0)} ms`;
  const proofs = [c.tunnelFree && 'no tunnels', c.minimal && 'minimal', c.closed && 'closed mesh']
    .filter(Boolean)
    .join(', ');
  const rows = {
    voxels: Number(summary.voxels ?? 0).toLocaleString('en-US'),
    digest: c.digest,
    ...(proofs && { certificate: proofs }),
    ...(c.verified && { counted: `${count(c.tunnels ?? 0, 'tunnel')}, ${c.redundant ?? 0} redundant` }),
    'voxel size': Number(accepted.grid.voxelSize.toPrecision(6)),
    voxelizing: ms(t.voxelizeMs),
    'in all': `${seconds.toFixed(2)} s`,
  };
  byId('summary').replaceChildren(
    ...Object.entries(rows).map(([name, value]) => {
      const row = document.createElement('tr');
      row.append(
        Object.assign(document.createElement('th'), { textContent: name }),
        Object.assign(document.createElement('td'), { textContent: value }),
      );
      return row;
    }),
  );
  byId('result').hidden = false;
  byId('empty').hidden = !byId('viewer').hidden;
  if (!shown) say('The viewer shows up to 4,000,000 voxels, and at least one. The files have all of them.');
  else say(hasLostTextures() ? `A link has no textures: drop ${state.mesh.name} once more for all of its colors.` : '');
}

// The vertices of such a mesh have the colors that their textures have there.
const hasLostTextures = () => state.mesh.textured === undefined && settings().fields.includes('color');

function saveNpz() {
  const { bricks, scene, fields } = state.job;
  try {
    const name = `${state.mesh.name.replace(/\.\w+$/, '')}.npz`;
    download(name, [npzOf(bricks, scene, fields)], 'application/zip');
  } catch (error) {
    say(error.message, true);
  }
}

function saveCsv() {
  const { bricks, scene, fields } = state.job;
  download(`${state.mesh.name.replace(/\.\w+$/, '')}.csv`, csvOf(bricks, scene.grid, fields), 'text/csv');
}

function saveJson() {
  const { request, accepted, summary } = state.job;
  download(
    `${state.mesh.name.replace(/\.\w+$/, '')}.json`,
    [JSON.stringify({ request, accepted, summary }, null, 2)],
    'application/json',
  );
}

// Takes the request of the address.
function restore() {
  const words = new URLSearchParams(location.hash.slice(1)),
    [vertices, triangles, type, colors] = (words.get('raw') ?? '').split(',');
  for (const name of SETTINGS) if (words.has(name)) form.elements[name].value = words.get(name);
  for (const box of form.querySelectorAll('[name=fields]'))
    box.checked = (words.get('fields') ?? '').split(',').includes(box.value);
  form.elements.verify.checked = words.has('verify');
  adapt();
  if (!/^[0-9a-f]{64}$/.test(words.get('mesh') ?? '')) return;
  const spec = {
    vertices: Number(vertices),
    triangles: Number(triangles),
    positions: `POSITION_TYPE_${type?.toUpperCase()}`,
    fields: ['FIELD_PART', ...(colors ? ['FIELD_COLOR'] : [])],
  };
  const textured = colors === 'texture' ? undefined : null;
  show({ name: words.get('name') ?? 'mesh', spec, bytes: null, textured, sha256: words.get('mesh') });
  run();
}

function adapt() {
  byId('widthlabel').hidden = form.elements.set.value !== 'band';
  const { lattice, resolution } = form.elements;
  if (lattice.value !== 'basis' && !Object.hasOwn(NAMED, lattice.value)) lattice.value = 'cartesian';
  byId('basislabel').hidden = lattice.value !== 'basis';
  resolution.required = lattice.value !== 'basis';
}

function copyLink() {
  const done = navigator.clipboard?.writeText(location.href) ?? Promise.reject(new Error('no clipboard'));
  done.then(
    () => say('The link is copied. It works as long as the server keeps the mesh.'),
    () => say('Copy the address of this page: it repeats the request.'),
  );
}

form.addEventListener('submit', (event) => (event.preventDefault(), run()));
for (const name of ['set', 'lattice']) form.elements[name].addEventListener('change', adapt);
byId('file').addEventListener('change', (event) => take(event.target.files[0]));
for (const [id, use] of Object.entries({
  cancel: () => state.job?.cancel(),
  csv: saveCsv,
  npz: saveNpz,
  json: saveJson,
  link: copyLink,
}))
  byId(id).addEventListener('click', use);
for (const kind of ['dragenter', 'dragover', 'dragleave', 'drop']) {
  addEventListener(kind, (event) => {
    event.preventDefault();
    document.body.classList.toggle('dragging', kind === 'dragover');
    if (kind === 'drop') take(event.dataTransfer.files[0]);
  });
}
addEventListener('keydown', ({ key, ctrlKey, metaKey }) => {
  if (key === 'Escape') state.job?.cancel();
  if (key === 'Enter' && (ctrlKey || metaKey)) run();
});
document.body.dataset.busy = 'no';
restore();
