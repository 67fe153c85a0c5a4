// Shows the voxels of the page: their Voronoi cells' facets, but for those between two cells that are both shown.
// The page's data: see client/view/page.h. The address may end in #axis=k&layer=40&azimuth=30&elevation=22.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);

const VERTEX = `
  attribute vec3 cell;
  attribute float rim;
  uniform mat3 basis;
  uniform vec3 middle;
  varying vec3 turned;
  varying float inside;
  void main() {
    turned = normalize(mat3(viewMatrix) * normal);
    inside = rim;
    gl_Position = projectionMatrix * viewMatrix * vec4(basis * (cell - middle) + position, 1.0);
  }`;

// Lit from above on the left of the viewer; lines where facets are wide enough for them.
const FRAGMENT = `
  uniform vec3 color;
  varying vec3 turned;
  varying float inside;
  void main() {
    float key = max(0.0, dot(turned, normalize(vec3(-0.5, 0.65, 0.55))));
    float fill = max(0.0, dot(turned, normalize(vec3(0.8, 0.1, 0.6))));
    float step = fwidth(inside);
    float line = (1.0 - smoothstep(step, 2.0 * step, inside)) * clamp(1.0 - 5.0 * step, 0.0, 1.0);
    vec3 linear = color * (0.22 + 0.12 * turned.y + 0.15 * fill + 0.95 * key) * (1.0 - 0.45 * line);
    gl_FragColor = vec4(pow(clamp(linear, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
  }`;

// Brick coordinates (int32, 3) and masks (8 words of 64 bits), little-endian, 76 bytes each.
function readBricks() {
  const text = atob(byId("masks").textContent);
  const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer), bricks = new Map();
  for (let at = 0; at < bytes.length; at += 76) {
    const corner = [0, 4, 8].map((n) => 8 * view.getInt32(at + n, true));
    bricks.set(corner.join(), { corner, mask: bytes.subarray(at + 12, at + 76) });
  }
  return bricks;
}

// Bit (y << 3 | z) of word x, which is bit z of byte 8 * x + y.
function has(bricks, i, j, k) {
  const brick = bricks.get(`${i & ~7},${j & ~7},${k & ~7}`);
  return brick !== undefined && (brick.mask[8 * (i & 7) + (j & 7)] >> (k & 7) & 1) === 1;
}

function forEachVoxel({ corner, mask }, visit) {
  for (let row = 0; row < 64; ++row) {
    for (let bits = mask[row]; bits !== 0; bits &= bits - 1) {
      const z = 31 - Math.clz32(bits & -bits);
      visit(corner[0] + (row >> 3), corner[1] + (row & 7), corner[2] + z, brickInner(row, z));
    }
  }
}

// Whether all neighbours one step away are of the same brick.
const brickInner = (row, z) => (row >> 3) % 7 !== 0 && (row & 7) % 7 !== 0 && z % 7 !== 0;

// For each facet of the cell the coordinates of all voxels that show it; of voxels up to `layer` on an axis.
function findFacets(bricks, axis, layer) {
  const cells = data.facets.map(() => []);
  let shown = 0;
  for (const brick of bricks.values()) {
    forEachVoxel(brick, (i, j, k, inner) => {
      const at = [i, j, k];
      if (at[axis] > layer) return;
      ++shown;
      data.facets.forEach(({ step: [a, b, c] }, f) => {
        const next = [i + a, j + b, k + c];
        const there = inner && Math.max(Math.abs(a), Math.abs(b), Math.abs(c)) <= 1
          ? (brick.mask[8 * (next[0] & 7) + (next[1] & 7)] >> (next[2] & 7) & 1) === 1
          : has(bricks, ...next);
        if (!there || next[axis] > layer) cells[f].push(i - data.low[0], j - data.low[1], k - data.low[2]);
      });
    });
  }
  return { cells, shown };
}

// A polygon as a fan about its middle.
function facetGeometry({ corners, normal }) {
  const middle = [0, 1, 2].map((m) => corners.reduce((sum, p) => sum + p[m], 0) / corners.length);
  const points = [middle, ...corners], index = [];
  corners.forEach((_, n) => index.push(0, 1 + n, 1 + (n + 1) % corners.length));
  const geometry = new THREE.InstancedBufferGeometry();
  const attribute = (values, size) => new THREE.BufferAttribute(new Float32Array(values), size);
  geometry.setAttribute("position", attribute(points.flat(), 3));
  geometry.setAttribute("normal", attribute(points.flatMap(() => normal), 3));
  geometry.setAttribute("rim", attribute(points.map((_, n) => (n === 0 ? 1 : 0)), 1));
  geometry.setIndex(index);
  return geometry;
}

class View {
  constructor() {
    this.bricks = readBricks();
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.setClearColor(0xf8f8f6);
    document.body.prepend(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        basis: { value: new THREE.Matrix3().fromArray(data.basis.flat()) },
        middle: { value: new THREE.Vector3(...data.middle) },
        color: { value: new THREE.Color(0.18, 0.34, 0.64) },
      },
    });
    this.meshes = data.facets.map((facet) => {
      const mesh = new THREE.Mesh(facetGeometry(facet), this.material);
      mesh.geometry.instanceCount = 0;
      mesh.frustumCulled = false;
      this.scene.add(mesh);
      return mesh;
    });
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
  }

  show(axis, layer) {
    const { cells, shown } = findFacets(this.bricks, axis, layer);
    this.meshes.forEach((mesh, f) => {
      mesh.geometry.setAttribute("cell", new THREE.InstancedBufferAttribute(new Uint16Array(cells[f]), 3));
      mesh.geometry.instanceCount = cells[f].length / 3;
    });
    byId("shown").textContent = shown;
    byId("facets").textContent = cells.reduce((sum, of) => sum + of.length / 3, 0);
    this.draw();
  }

  // The shape is a ball of radius 1 at most, about 0.
  look(azimuth, elevation) {
    const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
    const distance = 4 / Math.min(1, this.camera.aspect);
    this.camera.position.set(Math.cos(e) * Math.sin(a) * distance, Math.sin(e) * distance, Math.cos(e) * Math.cos(a) * distance);
    this.controls.update();
  }

  // Beside the panel where there is room.
  resize() {
    const panel = byId("panel").getBoundingClientRect();
    const width = innerWidth > 600 ? innerWidth - panel.right : innerWidth;
    this.renderer.setPixelRatio(devicePixelRatio);
    this.renderer.setSize(width, innerHeight);
    this.camera.aspect = width / innerHeight;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // Without the facets that all cells turn away from the viewer: the shape is within 1 of 0.
  draw() {
    const { x, y, z } = this.camera.position;
    this.meshes.forEach((mesh, f) => {
      const [nx, ny, nz] = data.facets[f].normal;
      mesh.visible = mesh.geometry.instanceCount > 0 && nx * x + ny * y + nz * z > -1;
    });
    this.renderer.render(this.scene, this.camera);
  }
}

function fillPanel(bricks) {
  let voxels = 0;
  for (const brick of bricks.values()) forEachVoxel(brick, () => ++voxels);
  byId("title").textContent = document.title = data.title;
  byId("voxels").textContent = voxels;
  byId("bricks").textContent = bricks.size;
  for (const [name, value] of data.metadata) {
    const row = byId("certificate").insertRow();
    row.appendChild(document.createElement("th")).textContent = name;
    row.insertCell().textContent = value;
  }
}

function start() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  byId("about").open = innerWidth > 600;
  const view = new View();
  fillPanel(view.bricks);
  const axis = byId("axis"), layer = byId("layer");
  const cut = () => {
    byId("at").textContent = layer.value;
    view.show(axis.selectedIndex, Number(layer.value));
  };
  const range = (value) => {
    layer.min = data.low[axis.selectedIndex];
    layer.max = data.high[axis.selectedIndex] - 1;
    layer.value = value ?? layer.max;
    cut();
  };
  axis.value = wanted.get("axis") ?? "k";
  axis.addEventListener("change", () => range());
  layer.addEventListener("input", cut);
  addEventListener("resize", () => view.resize());
  view.resize();
  view.look(Number(wanted.get("azimuth") ?? 30), Number(wanted.get("elevation") ?? 22));
  range(wanted.get("layer"));
  document.body.dataset.drawn = "yes";
}

try {
  start();
} catch (error) {
  byId("error").hidden = false;
  byId("error").textContent = `This browser cannot show the voxels: ${error.message}`;
  throw error;
}
