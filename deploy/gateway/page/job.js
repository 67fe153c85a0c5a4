// One request: the upload of the mesh, the stream of bricks, and what the viewer shows of them.
import { forEachVoxel, joined, unpack } from './bricks.js';
import { flattened, MOST_VOXELS, paintOf, sceneOf } from './scene.js';
import { base64Of, bytesOf } from './service.js';

export const NAMED = {
  cartesian: 'NAMED_LATTICE_CARTESIAN',
  bcc: 'NAMED_LATTICE_BCC',
  fcc: 'NAMED_LATTICE_FCC',
  hexagonal: 'NAMED_LATTICE_HEXAGONAL',
};

const SETS = {
  surface: () => ({ surface: {} }),
  supercover: () => ({ supercover: {} }),
  solid: () => ({ solid: {} }),
  interior: () => ({ solid: { surface: 'SOLID_SURFACE_NONE' } }),
  enclosed: () => ({ enclosed: {} }),
  links: () => ({ links: {} }),
  band: ({ width }) => ({ band: { voxels: Number(width) } }),
};

function specOf(mesh, settings) {
  return {
    lattice: { named: NAMED[settings.lattice] },
    resolution: Number(settings.resolution),
    separability: Number(settings.k),
    verify: settings.verify,
    fields: settings.fields.map((name) => `FIELD_${name.toUpperCase()}`),
    ...SETS[settings.set](settings),
    encoding: 'BRICK_ENCODING_PACKED',
    meshSha256: base64Of(Uint8Array.from(mesh.sha256.match(/../g), (byte) => parseInt(byte, 16))),
    rawMesh: mesh.spec,
  };
}

let opened = 0; // viewers

export class Job {
  constructor(service, mesh, settings, frame) {
    Object.assign(this, {
      service,
      mesh,
      settings,
      frame,
      request: { spec: specOf(mesh, settings) },
      end: new AbortController(),
      canceled: false,
    });
    Object.assign(this, {
      parts: [],
      values: settings.fields.map(() => []),
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
    this.fields = this.settings.fields.map((name, n) => ({ name, bytes: joined(this.values[n]) }));
    if (this.voxels !== Number(this.summary.voxels ?? 0))
      throw new Error(`${this.voxels} voxels came, and the summary has ${this.summary.voxels}`);
    await this.show();
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
    const found = this.fields.map(({ name, bytes }) => paintOf(name, bytes)),
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
      joined(this.fields.map(({ bytes }) => bytes)),
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
