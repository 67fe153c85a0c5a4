// One request: the upload of the mesh, the stream of bricks, and what the viewer shows of them.
import { forEachVoxel, joined, unpack } from './bricks.js';
import { colorsOfVoxels } from './colors.js';
import { fieldOf, layoutOf } from './fields.js';
import { specOf } from './request.js';
import { flattened, MOST_COLORS, MOST_VOXELS, paintsOf, sceneOf } from './scene.js';
import { base64Of, bytesOf } from './service.js';

// The fields of the nearest point, which textures need.
const NEAREST = ['triangle', 'point'];

let opened = 0; // viewers

export class Job {
  constructor(service, mesh, settings, frame) {
    this.hasTextures = Boolean(mesh.textured) && settings.fields.includes('color');
    const asked = [...new Set([...settings.fields, ...(this.hasTextures ? NEAREST : [])])];
    const meshSha256 = base64Of(Uint8Array.from(mesh.sha256.match(/../g), (byte) => parseInt(byte, 16)));
    Object.assign(this, {
      asked,
      service,
      mesh,
      settings,
      frame,
      request: { spec: { ...specOf(settings, asked), meshSha256, rawMesh: mesh.spec } },
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
    return this.settings.fields.map((name) => fieldOf(name, found.get(name), this.layout));
  }

  accept(accepted) {
    this.accepted = accepted;
    this.layout = layoutOf(accepted);
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
    const { settings, scene } = this,
      paints = paintsOf(this.fields, this.request.spec.fractionN ** 3);
    if (this.voxels === 0 || this.voxels > MOST_VOXELS || this.voxels * paints.length > MOST_COLORS) {
      this.frame.hidden = true;
      return;
    }
    const metadata = [
      ...flattened(this.summary.certificate),
      ...flattened(this.summary.timings ?? {}),
      ['resolution', settings.resolution],
    ];
    const found = paints.map((paint) => paint());
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
      joined(found.map(({ values }) => values)),
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
