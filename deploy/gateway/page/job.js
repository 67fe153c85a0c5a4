// One request: the upload of the mesh, the stream of bricks, and what the viewer shows of them.
import { forEachVoxel, joined, unpack } from './bricks.js';
import { colorsOfVoxels } from './colors.js';
import { flattened, MOST_VOXELS, paintOf, sceneOf } from './scene.js';
import { base64Of, bytesOf } from './service.js';

export const NAMED = {
  cartesian: 'NAMED_LATTICE_CARTESIAN',
  bcc: 'NAMED_LATTICE_BCC',
  fcc: 'NAMED_LATTICE_FCC',
  hexagonal: 'NAMED_LATTICE_HEXAGONAL',
};

// Returns the vectors of a lattice from the nine numbers that `latvox --basis` takes, too.
function basisOf(text) {
  const numbers = text.trim().split(/[\s,]+/).map(Number);
  if (text.trim() === '' || numbers.length !== 9 || !numbers.every(Number.isFinite))
    throw new Error(`basis: "${text}" is not nine numbers a1,a2,a3,b1,b2,b3,c1,c2,c3`);
  const [a, b, c] = [0, 3, 6].map((at) => ({ x: numbers[at], y: numbers[at + 1], z: numbers[at + 2] }));
  return { a, b, c };
}

// The fields of the nearest point, which textures need.
const NEAREST = ['triangle', 'point'];

const SETS = {
  surface: () => ({ surface: {} }),
  supercover: () => ({ supercover: {} }),
  solid: () => ({ solid: {} }),
  interior: () => ({ solid: { surface: 'SOLID_SURFACE_NONE' } }),
  enclosed: () => ({ enclosed: {} }),
  links: () => ({ links: {} }),
  band: ({ width }) => ({ band: { voxels: Number(width) } }),
};

function specOf(mesh, settings, asked) {
  const { lattice, resolution, basis } = settings;
  return {
    lattice: lattice === 'basis' ? { basis: basisOf(basis) } : { named: NAMED[lattice] },
    ...(resolution === '' ? {} : { resolution: Number(resolution) }),
    separability: Number(settings.k),
    verify: settings.verify,
    fields: asked.map((name) => `FIELD_${name.toUpperCase()}`),
    ...SETS[settings.set](settings),
    encoding: 'BRICK_ENCODING_PACKED',
    meshSha256: base64Of(Uint8Array.from(mesh.sha256.match(/../g), (byte) => parseInt(byte, 16))),
    rawMesh: mesh.spec,
  };
}

let opened = 0; // viewers

export class Job {
  // Throws an Error for a setting that is wrong.
  constructor(service, mesh, settings, frame) {
    this.hasTextures = Boolean(mesh.textured) && settings.fields.includes('color');
    const asked = [...new Set([...settings.fields, ...(this.hasTextures ? NEAREST : [])])];
    Object.assign(this, {
      asked,
      service,
      mesh,
      settings,
      frame,
      request: { spec: specOf(mesh, settings, asked) },
      end: new AbortController(),
      canceled: false,
    });
    Object.assign(this, {
      parts: [],
      values: asked.map(() => []),
      voxels: 0,
      live: false,
      waiting: [],
      nextAt: 0,
      shown: false,
    });
  }

  cancel() {
    this.canceled = true;
    this.end.abort();
  }

  // `tell` is called with a text and the share that is done.
  async run(tell) {
    const started = performance.now(),
      { signal } = this.end;
    if (this.mesh.bytes) {
      tell('asking whether the server has the mesh', 0);
      const spec = {
        meshSha256: this.request.spec.meshSha256,
        meshBytes: this.mesh.bytes.length,
        rawMesh: this.mesh.spec,
      };
      await this.service.upload(spec, this.mesh.bytes, signal, (share) => tell('sending the mesh', share));
    }
    tell('voxelizing', 0);
    for await (const message of this.service.stream('VoxelizeStored', this.request, signal)) {
      if (message.accepted) this.accept(message.accepted);
      else if (message.summary) this.summary = message.summary;
      else if (message.bricks) await this.take(message.bricks, tell);
    }
    this.seconds = (performance.now() - started) / 1000;
    this.bricks = joined(this.parts);
    this.fields = this.fieldsOf(new Map(this.asked.map((name, n) => [name, joined(this.values[n])])));
    if (this.voxels !== Number(this.summary.voxels ?? 0))
      throw new Error(`${this.voxels} voxels came, and the summary has ${this.summary.voxels}`);
    await this.show();
  }

  // Returns the fields that the caller wants, with the colors of textures.
  fieldsOf(found) {
    if (this.hasTextures) {
      const { colors, corners } = this.mesh.textured;
      found.set('color', colorsOfVoxels(colors, corners, ...NEAREST.map((name) => found.get(name))));
    }
    return this.settings.fields.map((name) => ({ name, bytes: found.get(name) }));
  }

  accept(accepted) {
    this.accepted = accepted;
    const reach = this.settings.set === 'band' ? Number(this.settings.width) * accepted.grid.voxelSize : 0;
    const empty = { min: {}, max: { i: 1, j: 1, k: 1 } };
    this.scene = sceneOf(
      { ...accepted, indexBox: accepted.indexBox ?? empty },
      { title: this.mesh.name, up: this.settings.up, reach },
    );
  }

  async take({ packed, fields = [], progress = 0 }, tell) {
    const bricks = unpack(bytesOf(packed));
    this.parts.push(bricks);
    fields.forEach(({ values }, n) => this.values[n].push(bytesOf(values)));
    this.voxels += forEachVoxel(bricks);
    this.waiting.push(bricks);
    tell(`${this.voxels.toLocaleString('en-US')} voxels so far`, progress);
    if (this.voxels <= MOST_VOXELS && performance.now() >= this.nextAt) await this.grow();
  }

  // Shows the bricks that have come since the last time. The viewer works at most a third of the time.
  async grow() {
    const bricks = joined(this.waiting);
    this.waiting = [];
    let cost = performance.now();
    if (this.live) {
      cost = this.frame.contentWindow.grow(bricks);
    } else {
      this.live = true;
      await this.open({ ...this.scene, voxels: this.voxels }, bricks);
      cost = performance.now() - cost;
    }
    this.nextAt = performance.now() + 2 * cost + 50;
  }

  // Opens the viewer with all voxels, fields and facts.
  async show() {
    if (this.voxels === 0 || this.voxels > MOST_VOXELS) {
      this.frame.hidden = true;
      return;
    }
    // As in a page of `latvox view`: colors come first, and have no values beside them.
    const fields = [...this.fields].sort((a, b) => (b.name === 'color') - (a.name === 'color')),
      found = fields.map(({ name, bytes }) => paintOf(name, bytes)),
      { settings, scene } = this;
    const metadata = [
      ...flattened(this.summary.certificate),
      ...flattened(this.summary.timings ?? {}),
      ['resolution', settings.resolution],
    ];
    const data = {
      ...scene,
      voxels: this.voxels,
      metadata,
      paints: found.map(({ paint }) => paint),
      band: settings.set === 'band',
    };
    await this.open(
      data,
      this.bricks,
      joined(found.map(({ colors }) => colors)),
      joined(fields.filter(({ name }) => name !== 'color').map(({ bytes }) => bytes)),
    );
    this.shown = true;
  }

  open(data, masks, paints = new Uint8Array(), values = new Uint8Array()) {
    window.latvox = { data, masks, paints, values };
    const camera = this.frame.contentWindow?.camera?.() ?? '';
    this.frame.hidden = false;
    return new Promise((resolve) => {
      this.frame.addEventListener('load', resolve, { once: true });
      // Unlike `src`, it adds nothing to the browser's history.
      this.frame.contentWindow.location.replace(`viewer.html?${++opened}#${camera}`);
    });
  }
}
