// Shows the voxels of the page by the visible facets of their Voronoi cells. If the device is too slow while something
// moves, shows one point per voxel.
// The page's data: see client/tool/view/page.h.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const steps = data.facets.map(({ step }) => step);
const IN_TIME = 50; // milliseconds per frame
const FEWEST = 20000; // points

function bytesOf(id) {
  return Uint8Array.from(atob(byId(id).textContent), (c) => c.charCodeAt(0));
}

// Reads brick coordinates (int32, 3) and masks (8 words of 64 bits), little-endian, 76 bytes per brick.
function readVoxels() {
  const bytes = bytesOf("masks"), view = new DataView(bytes.buffer), set = new VoxelSet(data.low, data.high);
  for (let at = 0, voxel = 0; at < bytes.length; at += 76) {
    const rows = bytes.subarray(at + 12, at + 76);
    set.addBrick([0, 4, 8].map((n) => 8 * view.getInt32(at + n, true)), rows, voxel);
    for (const row of rows) voxel += BITS[row];
  }
  return set;
}

// The visible voxels: all, those up to a layer, or one layer.
class Shape {
  constructor(set) {
    this.set = set;
    this.outside = Outside.of(set, steps)?.rowsOf ?? null;
    this.normals = findNormals(set, data.facets, this.outside);
    this.layer = new THREE.Vector4();
    this.scattered = scatter(set, data.low, this.normals);
    this.buildTime = 0;
  }

  // `paints` has red, green and blue of each voxel, or is null.
  paint(paints) {
    this.cloud?.dispose();
    this.paints = paints;
    this.cloud = new Cloud(data, this.scattered, paints, this.layer);
  }

  cut(axis, layer, only) {
    this.surface?.dispose();
    this.layerCloud?.dispose();
    this.surface = this.layerCloud = null;
    this.axis = axis;
    this.all = !only && layer >= data.high[axis] - 1;
    this.keep = (...ijk) => (only ? ijk[axis] === layer : ijk[axis] <= layer);
    this.inLayer = (...ijk) => ijk[axis] === layer;
    const offset = layer - data.low[axis];
    this.layer.set(0, 0, 0, this.all || only ? -1 : offset).setComponent(axis, 1);
    this.cloud.cut(this.all ? Infinity : offset - 0.5);
    this.cloud.visible = !only;
  }

  get isBuilt() {
    return this.surface !== null;
  }

  // A shape that is cut shows all facets, because it has no inside.
  facets() {
    if (this.surface === null) {
      const start = performance.now(), { set, all, keep, outside, normals, paints } = this;
      const shown = all ? set : set.filter(keep);
      const found = findFacets(shown, steps, data.low, all ? outside : null, normals, paints !== null);
      this.surface = new Surface(data, found, paints, this.layer);
      this.buildTime = performance.now() - start;
    }
    return this.surface;
  }

  points() {
    if (this.layerCloud === null) {
      const some = new Uint16Array(this.normals.length); // zero normals, so that scatter keeps every voxel
      const layer = this.set.filter(this.all ? () => false : this.inLayer);
      this.layerCloud = new Cloud(data, scatter(layer, data.low, some), this.paints, this.layer);
    }
    return [this.cloud, this.layerCloud];
  }
}

class View {
  constructor(set) {
    const canvas = document.createElement("canvas"), slow = drawsInSoftware();
    const context = canvas.getContext("webgl2", { alpha: true, antialias: !slow });
    if (context === null) throw new Error("WebGL 2 is switched off, or the browser or its graphics driver does not support it");
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    byId("scene").append(canvas);
    canvas.tabIndex = 0;
    canvas.setAttribute("aria-label", "the voxels; arrow keys turn them");
    canvas.addEventListener("webglcontextlost", () => tell("The graphics device was lost; waiting for it to return."));
    canvas.addEventListener("webglcontextrestored", () => (tell(""), this.change()));
    canvas.addEventListener("keydown", (event) => this.press(event));
    this.shape = new Shape(set);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { zoomToCursor: true, minDistance: 0.02, maxDistance: 40 });
    this.controls.addEventListener("change", () => this.change());
    new ResizeObserver(() => this.resize()).observe(byId("scene"));
    this.cost = slow ? set.count() / 400 : 0; // milliseconds to draw all facets
    this.most = 10 * FEWEST; // points
    this.waiting = false;
  }

  show(paints, axis, layer, only) {
    if (paints !== this.shape.paints) this.shape.paint(paints);
    this.shape.cut(axis, layer, only);
    this.change();
  }

  // The shape lies within radius 1 of 0.
  home(azimuth, elevation) {
    this.controls.target.set(0, 0, 0);
    this.look(azimuth, elevation, 4 / Math.min(1, this.camera.aspect));
  }

  // Angles in degrees: about the up axis, and above the horizon.
  look(azimuth, elevation, distance) {
    const [a, e] = [azimuth, Math.max(-89.9, Math.min(89.9, elevation))].map((degrees) => (degrees * Math.PI) / 180);
    const towards = new THREE.Vector3(Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a));
    this.camera.position.copy(this.controls.target).addScaledVector(towards, distance);
    this.controls.update();
    this.change();
  }

  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const turn = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, 10], ArrowDown: [0, -10] }[event.key];
    const farther = { "+": 0.8, "=": 0.8, "-": 1.25 }[event.key];
    if (event.key === "Home") {
      this.home(...this.first);
    } else if (turn !== undefined || farther !== undefined) {
      const degrees = 180 / Math.PI, [right, up] = turn ?? [0, 0], { controls } = this;
      const [azimuth, elevation] = [controls.getAzimuthalAngle() * degrees, 90 - controls.getPolarAngle() * degrees];
      this.look(azimuth + right, elevation + up, controls.getDistance() * (farther ?? 1));
    } else {
      return;
    }
    event.preventDefault();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = byId("scene"), size = `${width} ${height} ${devicePixelRatio}`;
    if (width === 0 || height === 0 || size === this.size) return;
    this.size = size;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    if (this.drawn !== undefined) this.draw(this.drawn); // resizing clears the canvas
    this.change();
  }

  change() {
    this.changed = performance.now();
    this.stale = true;
    this.wake();
  }

  wake() {
    if (this.waiting) return;
    this.waiting = true;
    document.body.dataset.busy = "yes";
    requestAnimationFrame(() => ((this.waiting = false), this.frame()));
  }

  // At most one frame is in flight, so that the picture is never late.
  frame() {
    const now = performance.now(), gl = this.renderer.getContext();
    if (this.fence) {
      if (gl.clientWaitSync(this.fence, 0, 0) === gl.TIMEOUT_EXPIRED) return this.wake();
      gl.deleteSync(this.fence);
      this.fence = null;
      this.learn(now - this.started);
    }
    if (this.stale) {
      this.draw(this.cost + (this.shape.isBuilt ? 0 : this.shape.buildTime) <= IN_TIME ? "facets" : "points");
    } else if (this.drawn === "points" && now - this.changed > Math.max(250, this.cost / 2)) {
      this.draw("facets");
    }
    if (this.fence || this.drawn === "points") this.wake();
    else document.body.dataset.busy = "no";
  }

  learn(cost) {
    if (this.drawn === "facets") this.cost = cost;
    else this.most = Math.max(FEWEST, Math.min(this.shape.cloud.count, (this.most * IN_TIME) / Math.max(1, cost)));
  }

  draw(what) {
    const shown = what === "facets" ? [this.shape.facets()] : this.shape.points(), { camera } = this;
    const distance = camera.position.length(), gl = this.renderer.getContext();
    this.started = performance.now();
    camera.near = Math.max(0.005, distance - 1.05);
    camera.far = distance + 1.05;
    camera.updateProjectionMatrix();
    const pixels = this.cellPixels();
    for (const each of shown) {
      if (what === "facets") each.prepare(camera.position, pixels / Math.max(camera.near, distance - 0.7));
      else each.prepare(this.most, pixels);
    }
    this.scene.clear();
    this.scene.add(...shown);
    this.renderer.render(this.scene, camera);
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    showAxes(camera, this.shape.axis);
    if (what === "facets") byId("facets").textContent = this.shape.surface.count;
    this.drawn = what;
    this.stale = false;
  }

  // Returns the approximate width of a cell at distance 1.
  cellPixels() {
    const [a, b, c] = data.basis.map((vector) => new THREE.Vector3(...vector));
    const perUnit = this.renderer.domElement.height / (2 * Math.tan((15 * Math.PI) / 180));
    return Math.cbrt(Math.abs(a.dot(b.clone().cross(c)))) * perUnit;
  }
}

// Returns whether there is no graphics device. Smooth edges would then take most of the time.
function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl?.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

// Draws the world's axes, and the step from one layer to the next.
function showAxes(camera, axis) {
  const arrows = [...data.axes.map((to, m) => ["axis", "xyz"[m], to]), ["step", "ijk"[axis], data.basis[axis]]];
  byId("axes").innerHTML = arrows.map(([kind, name, vector]) => {
    const { x, y } = new THREE.Vector3(...vector).normalize().transformDirection(camera.matrixWorldInverse);
    const text = kind === "axis" ? 38 : 24;
    return `<line class="${kind}" x1="0" y1="0" x2="${30 * x}" y2="${-30 * y}"/>` +
      `<text x="${text * x + (kind === "step" ? 9 : 0)}" y="${4 - text * y}">${name}</text>`;
  }).join("");
}

function tell(what) {
  byId("error").hidden = what === "";
  byId("error").textContent = what;
}
