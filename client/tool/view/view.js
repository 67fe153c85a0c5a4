// Shows the voxels of the page by the visible facets of their Voronoi cells, with WebGL. If the device is too slow while
// something moves, shows one point per voxel.
"use strict";

const IN_TIME = 50; // milliseconds per frame
const FEWEST = 20000; // points

// The visible voxels: all, or those of a cut.
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

  // `all`: the cut keeps all voxels.
  cut(cut, all) {
    this.surface?.dispose();
    this.layerCloud?.dispose();
    this.surface = this.layerCloud = null;
    Object.assign(this, { knife: cut, all });
    const height = cut.at - dot(cut.form, data.low);
    if (all || cut.only) this.layer.set(0, 0, 0, 1); // marks nothing
    else this.layer.set(...cut.form, height);
    this.cloud.cut(all ? Infinity : height - 0.5);
    this.cloud.visible = !cut.only;
  }

  get isBuilt() {
    return this.surface !== null;
  }

  facets() {
    if (this.surface === null) {
      const start = performance.now(), { set, all, outside, normals, paints } = this;
      const found = all ? findFacets(set, steps, data.low, outside, (voxel) => normals[voxel], paints !== null) : this.cutOpen();
      this.surface = new Surface(data, found, paints, this.layer);
      this.buildTime = performance.now() - start;
    }
    return this.surface;
  }

  // A shape that is cut shows all facets, each in the light of a surface: the outer one, that of the hollow behind it, or
  // the plane. In the light of one facet or of another surface, small cells would be specks.
  cutOpen() {
    const { set, knife, normals, paints } = this, shown = set.filter(knife.keep), space = around(set, shown, this.outside);
    const inner = (this.innerNormals ??= findNormals(set, data.facets, space.hollows)), plane = packed(...knife.towards);
    const find = (where, normalOf) => findFacets(shown, steps, data.low, where, normalOf, paints !== null);
    return joined(find(space.outside, (voxel) => normals[voxel]), find(space.hollows, (voxel) => inner[voxel]), find(space.hidden, () => plane));
  }

  points() {
    if (this.layerCloud === null) {
      const normals = new Uint16Array(this.normals.length).fill(packed(...this.knife.towards));
      const layer = this.set.filter(this.all ? () => false : this.knife.inLayer);
      this.layerCloud = new Cloud(data, scatter(layer, data.low, normals), this.paints, this.layer);
    }
    return [this.cloud, this.layerCloud];
  }
}

class View {
  // Returns null if the browser has no WebGL 2.
  static on(canvas, set) {
    const slow = drawsInSoftware(), context = canvas.getContext("webgl2", { alpha: true, antialias: !slow });
    return context === null ? null : new View(canvas, context, set, slow);
  }

  constructor(canvas, context, set, slow) {
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    canvas.setAttribute("aria-label", "the voxels; arrow keys turn them");
    canvas.addEventListener("webglcontextlost", () => tell("The graphics device was lost; waiting for it to return."));
    canvas.addEventListener("webglcontextrestored", () => (tell(""), this.change()));
    this.edges = true;
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

  show(paints, cut, all) {
    if (paints !== this.shape.paints) this.shape.paint(paints);
    this.shape.cut(cut, all);
    this.change();
  }

  // The shape lies within radius 1 of 0.
  home() {
    this.controls.target.set(0, 0, 0);
    this.look(...this.first, 4 / Math.min(1, this.camera.aspect));
  }

  // Angles in degrees: about the up axis, and above the horizon.
  look(azimuth, elevation, distance) {
    const [a, e] = [azimuth, Math.max(-89.9, Math.min(89.9, elevation))].map((degrees) => (degrees * Math.PI) / 180);
    const towards = new THREE.Vector3(Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a));
    this.camera.position.copy(this.controls.target).addScaledVector(towards, distance);
    this.controls.update();
    this.change();
  }

  // Turns by degrees.
  move(right, up) {
    const degrees = 180 / Math.PI, { controls } = this;
    const [azimuth, elevation] = [controls.getAzimuthalAngle() * degrees, 90 - controls.getPolarAngle() * degrees];
    this.look(azimuth + right, elevation + up, controls.getDistance());
  }

  zoom(farther) {
    const { controls, camera } = this;
    camera.position.sub(controls.target).multiplyScalar(farther).add(controls.target);
    controls.update();
    this.change();
  }

  // Returns the voxel that is seen at a point of the canvas, as Cells.first does.
  pick(x, y) {
    const { clientWidth: width, clientHeight: height } = byId("scene"), { camera, shape } = this;
    const far = new THREE.Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(camera);
    const along = far.sub(camera.position).normalize();
    return cells.first(shape.set, shape.all ? () => true : shape.knife.keep, camera.position.toArray(), along.toArray());
  }

  // Draws, so that the canvas has a picture until the browser's next frame.
  drawFully() {
    this.draw("facets");
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
      if (what === "facets") each.prepare(camera.position, pixels / Math.max(camera.near, distance - 0.7), this.edges);
      else each.prepare(this.most, pixels);
    }
    this.scene.clear();
    this.scene.add(...shown);
    this.renderer.render(this.scene, camera);
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    showAxes(camera, this.shape.knife);
    if (what === "facets") fill(byId("facets"), this.shape.surface.count);
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

// Draws the world's axes, and the direction across layers, from one of the lattice's to the next if they are these.
function showAxes(camera, { axis, towards }) {
  const step = axis < 0 ? ["n", towards] : ["ijk"[axis], data.basis[axis]];
  const arrows = [...data.axes.map((to, m) => ["axis", "xyz"[m], to]), ["step", ...step]];
  byId("axes").innerHTML = arrows.map(([kind, name, vector]) => {
    const { x, y } = new THREE.Vector3(...vector).normalize().transformDirection(camera.matrixWorldInverse);
    const text = kind === "axis" ? 38 : 24;
    return `<line class="${kind}" x1="0" y1="0" x2="${30 * x}" y2="${-30 * y}"/>` +
      `<text x="${text * x + (kind === "step" ? 9 : 0)}" y="${4 - text * y}">${name}</text>`;
  }).join("");
}
