// The page: a mesh and a request on the left, the viewer on the right. The address repeats the request.
import { addressOf, readAddress } from './address.js';
import { Job } from './job.js';
import { readMesh } from './meshes.js';
import { npzOf } from './npz.js';
import { csvOf, download } from './save.js';
import { Service } from './service.js';
import { counting, counts, faultOf, SETTINGS, settingsOf } from './settings.js';

const byId = (id) => document.getElementById(id),
  form = byId('form');
const count = (number, one) => `${Number(number).toLocaleString('en-US')} ${one}${Number(number) === 1 ? '' : 's'}`;
const service = new Service(() => byId('token').value.trim());
// `fault`: what is wrong with the address, until somebody presses the button. `keepsUp`: the address says what is up.
const state = { mesh: null, job: null, fault: null, keepsUp: false };

function say(text, error = false) {
  byId('status').textContent = error ? '' : text;
  byId('error').textContent = error ? text : '';
  byId('error').hidden = !error;
}

const elementsOf = (name) => [...form.querySelectorAll(`[name="${name}"]`)];

// Returns the texts of the form: see settings.js.
function texts() {
  const textOf = (name) => {
    const elements = elementsOf(name);
    if (elements[0].type !== 'checkbox') return elements[0].value;
    return elements
      .filter(({ checked }) => checked)
      .map(({ value }) => value)
      .join();
  };
  return Object.fromEntries(Object.keys(SETTINGS).map((name) => [name, textOf(name)]));
}

function fill(name, text) {
  for (const element of elementsOf(name)) {
    if (element.type === 'checkbox') element.checked = text.split(',').includes(element.value);
    else element.value = text;
  }
}

// Returns whether a mesh has the values of a field; any mesh has those that the server finds.
const hasField = ({ spec }, name) =>
  !['part', 'material', 'color'].includes(name) || spec.fields.includes(`FIELD_${name.toUpperCase()}`);

// Shows the settings that count, and lets nobody ask for a field that the mesh lacks.
function adapt() {
  const all = texts();
  for (const name of Object.keys(SETTINGS)) {
    for (const element of elementsOf(name)) element.closest('label').hidden = !counts(name, all);
  }
  for (const box of elementsOf('fields')) {
    box.disabled = !box.checked && state.mesh !== null && !hasField(state.mesh, box.value);
  }
}

function show(mesh) {
  state.mesh = mesh;
  byId('mesh').textContent = mesh.name;
  byId('facts').textContent = `${count(mesh.spec.triangles, 'triangle')}${mesh.bytes ? '' : ', kept by the server'}`;
  byId('run').disabled = false;
  document.title = `latvox: ${mesh.name}`;
  adapt();
}

async function take(file) {
  if (file === undefined) return;
  state.job?.cancel();
  say(`reading ${file.name}`);
  document.body.dataset.busy = 'yes';
  try {
    if (!crypto.subtle)
      throw new Error('This page needs https, or an address of this machine: browsers compute SHA-256 only there.');
    const { spec, bytes, up, textured } = await readMesh(file);
    const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
    const sha256 = [...digest].map((n) => n.toString(16).padStart(2, '0')).join('');
    show({ name: file.name, spec, bytes, textured, sha256 });
    if (!state.keepsUp) fill('up', up);
    state.keepsUp = false;
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

// Says what is wrong, and shows where.
function refuse(name, message) {
  say(message, true);
  const [element] = elementsOf(name);
  if (byId('more').contains(element)) byId('more').open = true;
  element.focus();
}

// Returns nothing, and says why, for a setting that is wrong.
function jobOf() {
  say('');
  const all = texts(),
    fault = faultOf(counting(all), all);
  if (fault !== null) return refuse(fault.name, fault.message);
  const settings = settingsOf(all),
    lacking = settings.fields.find((name) => !hasField(state.mesh, name));
  if (lacking === undefined) return new Job(service, state.mesh, settings, byId('viewer'));
  const has = state.mesh.spec.fields.map((field) => field.replace('FIELD_', '').toLowerCase());
  const setting = settings.labels === lacking ? 'labels' : 'fields';
  return refuse(setting, `${setting}: "${lacking}" is not in ${state.mesh.name}, which has ${has.join(', ')}`);
}

// Starts the request of the form.
async function run() {
  if (state.mesh === null) return;
  state.job?.cancel();
  const job = (state.job = state.fault === null ? jobOf() : sayFault());
  byId('result').hidden = true;
  setRunning(Boolean(job));
  if (!job) return;
  try {
    history.replaceState(null, '', addressOf(texts(), INITIAL, state.mesh));
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

function sayFault() {
  say(`The address is wrong. ${state.fault}. "Voxelize" takes the settings of this form.`, true);
}

// Starts the request of the form, whatever the address says.
function press() {
  state.fault = null;
  return run();
}

function fail(job, error) {
  if (job.canceled) return say('canceled');
  const { name } = state.mesh,
    { reason } = error;
  const message = reason === 'BAD_MESH' ? error.message.replace(/^mesh:/, `${name}:`) : error.message || error.code;
  if (reason === 'MESH_NOT_FOUND') say(`The server no longer has ${name}: drop the file once more.`, true);
  else say(`${message}${reason ? ` (${reason})` : ''}`, true);
  // There are the boxes that the server's message names.
  if (/force_open|allow_outside|(solid|enclosed)\.labels/.test(error.message)) byId('more').open = true;
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
  if (!summary.voxels) say('The result has no voxels.');
  else if (!shown) say('The viewer shows up to 4,000,000 voxels, and 20,000,000 colors. The files have all of them.');
  else say(hasLostTextures() ? `A link has no textures: drop ${state.mesh.name} once more for all of its colors.` : '');
}

// The vertices of such a mesh have the colors that their textures have there.
const hasLostTextures = () => state.mesh.textured === undefined && state.job.settings.fields.includes('color');

function saveNpz() {
  const { bricks, scene, fields, layout } = state.job;
  try {
    const name = `${state.mesh.name.replace(/\.\w+$/, '')}.npz`;
    download(name, [npzOf(bricks, scene, fields, layout)], 'application/zip');
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
  state.job?.cancel();
  state.job = null;
  byId('result').hidden = true; // its buttons save the last job
  setRunning(false);
  const token = byId('token').value;
  form.reset();
  byId('token').value = token;
  const { texts: given, mesh, fault } = readAddress(location.hash, INITIAL);
  for (const [name, text] of Object.entries(given)) fill(name, text);
  Object.assign(state, { fault, keepsUp: 'up' in given });
  const folded = [...byId('more').querySelectorAll('[name]')].filter(({ name }) => name in given);
  byId('more').open = folded.some(({ type, checked }) => type !== 'checkbox' || checked);
  adapt();
  // A mesh that was dropped has its bytes and textures.
  if (mesh !== null) show(mesh.sha256 === state.mesh?.sha256 ? state.mesh : mesh);
  if (fault !== null) sayFault();
  else if (mesh !== null) run();
}

function copyLink() {
  const done = navigator.clipboard?.writeText(location.href) ?? Promise.reject(new Error('no clipboard'));
  done.then(
    () => say('The link is copied. It works as long as the server keeps the mesh.'),
    () => say('Copy the address of this page: it repeats the request.'),
  );
}

form.addEventListener('submit', (event) => (event.preventDefault(), press()));
form.addEventListener('change', adapt);
addEventListener('hashchange', restore);
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
  if (key === 'Enter' && (ctrlKey || metaKey)) press();
});
document.body.dataset.busy = 'no';
form.reset(); // Firefox keeps what was there before a reload
const INITIAL = texts();
restore();
