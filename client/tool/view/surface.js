// Draws cells by their facets, or by one point each, which costs little. Both read a voxel from a texel or a vertex:
// its coordinates relative to the low corner of the page, and a packed normal.
"use strict";

const LOT = 1 << 15, ROW = 2048; // facets per call; texels per row

// Light from above on the left of the viewer. Plain colors look as in the legend. `normal` is in the frame of the view.
const LIGHT = `
  varying vec3 tone, smooth_normal;
  varying float plain;
  vec3 lit(vec3 normal, float line) {
    float key = max(0.0, dot(normal, normalize(vec3(-0.5, 0.65, 0.55))));
    float fill = max(0.0, dot(normal, normalize(vec3(0.8, 0.1, 0.6))));
    float light = mix(0.24 + 0.12 * normal.y + 0.15 * fill + 0.95 * key, 1.0, plain);
    vec3 linear = tone * light * (1.0 - 0.55 * line);
    return pow(clamp(linear, 0.0, 1.0), vec3(1.0 / 2.2));
  }`;

const CELL = `
  uniform mat3 basis;
  uniform vec3 middle, color, mark;
  uniform vec4 layer;
  varying vec3 tone, smooth_normal;
  varying float plain;
  bool in_layer(vec3 cell) { return abs(dot(layer.xyz, cell) - layer.w) < 0.5; }
  vec3 unpacked(float bits) {
    vec2 uv = vec2(mod(bits, 256.0), floor(bits / 256.0)) / 127.0 - 1.0;
    vec3 to = vec3(uv, 1.0 - abs(uv.x) - abs(uv.y));
    if (to.z < 0.0) to.xy = (1.0 - abs(to.yx)) * vec2(to.x < 0.0 ? -1.0 : 1.0, to.y < 0.0 ? -1.0 : 1.0);
    return mat3(viewMatrix) * normalize(to);
  }`;

const FACET_VERTEX = `${CELL}
  uniform vec3 facing, corners[CORNERS + 1];
  uniform int first;
  uniform highp usampler2D cells;
  #ifdef PAINTED
  uniform sampler2D paints;
  #endif
  uniform float facets;
  varying vec3 facet_normal;
  varying float inside;
  void main() {
    int facet = first + gl_VertexID / (CORNERS + 1), corner = gl_VertexID % (CORNERS + 1);
    ivec2 texel = ivec2(facet % ROW, facet / ROW);
    vec4 cell = vec4(texelFetch(cells, texel, 0));
    #ifdef PAINTED
    tone = pow(texelFetch(paints, texel, 0).rgb, vec3(2.2));
    plain = in_layer(cell.xyz) ? 1.0 : 0.0;
    #else
    tone = in_layer(cell.xyz) ? mark : color;
    plain = 0.0;
    #endif
    facet_normal = mat3(viewMatrix) * facing;
    smooth_normal = unpacked(cell.w);
    if (cell.w == 65535.0) smooth_normal = facet_normal;
    if (dot(smooth_normal, facet_normal) < 0.0) smooth_normal = -smooth_normal;
    inside = corner == CORNERS ? 1.0 : 0.0;
    gl_Position = projectionMatrix * viewMatrix * vec4(basis * (cell.xyz - middle) + corners[corner], 1.0);
  }`;

// Draws lines only if facets have a middle vertex. Cells too small to tell apart show the shape that they form.
const FACET_FRAGMENT = `${LIGHT}
  uniform float lines, facets;
  varying vec3 facet_normal;
  varying float inside;
  void main() {
    float width = fwidth(inside);
    float line = (1.0 - smoothstep(width, 2.0 * width, inside)) * clamp(1.0 - 5.0 * width, 0.0, 1.0) * lines;
    gl_FragColor = vec4(lit(normalize(mix(smooth_normal, facet_normal, facets)), line), 1.0);
  }`;

const POINT_VERTEX = `${CELL}
  attribute vec4 cell;
  #ifdef PAINTED
  attribute vec3 paint;
  #endif
  uniform float size, below;
  void main() {
    #ifdef PAINTED
    tone = pow(paint, vec3(2.2));
    plain = in_layer(cell.xyz) ? 1.0 : 0.0;
    #else
    tone = in_layer(cell.xyz) ? mark : color;
    plain = 0.0;
    #endif
    smooth_normal = cell.w == 65535.0 ? vec3(0.0, 0.0, 1.0) : unpacked(cell.w);
    if (smooth_normal.z < 0.0) smooth_normal = -smooth_normal;
    gl_Position = projectionMatrix * viewMatrix * vec4(basis * (cell.xyz - middle), 1.0);
    gl_PointSize = size / gl_Position.w;
    if (dot(layer.xyz, cell.xyz) > below) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  }`;

const POINT_FRAGMENT = `${LIGHT}
  void main() {
    gl_FragColor = vec4(lit(smooth_normal, 0.0), 1.0);
  }`;

function cellUniforms(data, layer) {
  return {
    basis: { value: new THREE.Matrix3().fromArray(data.basis.flat()) },
    middle: { value: new THREE.Vector3(...data.middle) },
    color: { value: new THREE.Color(0.2, 0.36, 0.66) },
    mark: { value: new THREE.Color(0.85, 0.3, 0.04) },
    layer: { value: layer },
  };
}

// Returns the triangles of a lot of polygons of n corners. With lines, each polygon gets more triangles, around its
// middle.
const lots = new Map();
function lotOf(n, withLines) {
  const name = `${n} ${withLines}`;
  if (!lots.has(name)) {
    const one = [];
    for (let corner = withLines ? 0 : 2; corner < n; ++corner) {
      one.push(...(withLines ? [n, corner, (corner + 1) % n] : [0, corner - 1, corner]));
    }
    const index = new Uint32Array(LOT * one.length);
    for (let facet = 0, at = 0; facet < LOT; ++facet) for (const corner of one) index[at++] = facet * (n + 1) + corner;
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    lots.set(name, { geometry, length: one.length });
  }
  return lots.get(name);
}

// Returns a texture of four numbers per texel, padded to full rows.
function textureOf(values, format, type) {
  const rows = Math.ceil(values.length / 4 / ROW), texels = new values.constructor(4 * ROW * rows);
  texels.set(values);
  const texture = new THREE.DataTexture(texels, ROW, rows, format, type);
  texture.needsUpdate = true;
  return texture;
}

// Returns red, green and blue of the voxels with these numbers, four bytes each.
function painted(numbers, paints) {
  const colors = new Uint8Array(4 * numbers.length);
  numbers.forEach((voxel, n) => colors.set(paints.subarray(3 * voxel, 3 * voxel + 3), 4 * n));
  return colors;
}

// Draws the facets of findFacets in lots for each direction. The shader computes vertices from the voxel, which is in a
// texture, and the corner. Instances would cost a call each in software rendering, and vertices would cost memory.
class Surface extends THREE.Group {
  //   data     the page's; see client/tool/view/page.h
  //   paints   red, green and blue of each voxel, or null
  //   layer    normal and offset of the layer whose cells have another color
  constructor(data, { cells, numbers }, paints, layer) {
    super();
    this.data = data;
    this.layer = layer;
    this.count = 0;
    this.lines = { value: 0 };
    this.flat = { value: 1 };
    cells.forEach((of, f) => {
      if (of.length > 0) this.addFacets(data.facets[f], of, paints === null ? null : painted(numbers[f], paints));
    });
  }

  addFacets(facet, cells, colors) {
    const material = this.materialOf(facet, cells, colors), count = cells.length / 4;
    for (let first = 0; first < count; first += LOT) {
      const mesh = new THREE.Mesh(undefined, material);
      mesh.facet = facet;
      mesh.frustumCulled = false;
      mesh.onBeforeRender = (renderer, scene, camera, geometry) => {
        geometry.setDrawRange(0, Math.min(LOT, count - first) * mesh.length);
        material.uniforms.first.value = first;
        material.uniformsNeedUpdate = true;
      };
      this.add(mesh);
    }
    this.count += count;
  }

  materialOf({ corners, normal }, cells, colors) {
    const middle = [0, 1, 2].map((m) => corners.reduce((sum, p) => sum + p[m], 0) / corners.length);
    const uniforms = {
      ...cellUniforms(this.data, this.layer),
      facing: { value: new THREE.Vector3(...normal) },
      corners: { value: [...corners, middle].map((p) => new THREE.Vector3(...p)) },
      first: { value: 0 },
      cells: { value: textureOf(cells, THREE.RGBAIntegerFormat, THREE.UnsignedShortType) },
      paints: { value: colors === null ? null : textureOf(colors, THREE.RGBAFormat, THREE.UnsignedByteType) },
      lines: this.lines,
      facets: this.flat,
    };
    const defines = { CORNERS: corners.length, ROW, ...(colors === null ? {} : { PAINTED: "" }) };
    return new THREE.ShaderMaterial({ vertexShader: FACET_VERTEX, fragmentShader: FACET_FRAGMENT, defines, uniforms });
  }

  // Hides the facets that all cells turn away from the viewer. The shape lies within 1 of 0. `pixels` is the size of a
  // cell; `edges` tells whether cells that are large enough have lines along their edges.
  prepare(position, pixels, edges) {
    const withLines = edges && pixels > 8;
    this.lines.value = withLines ? 1 : 0;
    this.flat.value = Math.min(1, Math.max(0.15, (pixels - 1) / 14));
    for (const mesh of this.children) {
      const { corners, normal: [x, y, z] } = mesh.facet;
      mesh.visible = x * position.x + y * position.y + z * position.z > -1;
      Object.assign(mesh, lotOf(corners.length, withLines));
    }
  }

  dispose() {
    for (const { material } of this.children) {
      material.uniforms.cells.value.dispose();
      material.uniforms.paints.value?.dispose();
      material.dispose();
    }
  }
}

// Draws the voxels of scatter as points.
class Cloud extends THREE.Points {
  // Takes the arguments of Surface.
  constructor(data, { cells, numbers, ends }, paints, layer) {
    const uniforms = { ...cellUniforms(data, layer), size: { value: 1 }, below: { value: Infinity } };
    const defines = paints === null ? {} : { PAINTED: "" };
    const [vertexShader, fragmentShader] = [POINT_VERTEX, POINT_FRAGMENT];
    super(new THREE.BufferGeometry(), new THREE.ShaderMaterial({ vertexShader, fragmentShader, defines, uniforms }));
    this.geometry.setAttribute("cell", new THREE.BufferAttribute(cells, 4));
    if (paints !== null) {
      this.geometry.setAttribute("paint", new THREE.BufferAttribute(painted(numbers, paints), 4, true));
    }
    this.frustumCulled = false;
    this.count = numbers.length;
    this.ends = ends;
  }

  // Shows up to `most` points, large enough to stand for the others. `pixels` is the size of a cell at distance 1.
  prepare(most, pixels) {
    const shown = Math.min(this.count, most), level = this.ends.findIndex((end) => end <= shown);
    const coarser = level < 0 ? this.ends.length : level;
    const from = this.ends[coarser] ?? 0, to = this.ends[coarser - 1] ?? Infinity;
    const share = (shown - from) / (to - from); // share of the finer level
    this.geometry.setDrawRange(0, shown);
    this.material.uniforms.size.value = 1.45 * pixels * 2 ** coarser * (1 - 0.45 * share);
  }

  // Hides the cells beyond this layer.
  cut(below) {
    this.material.uniforms.below.value = below;
  }

  dispose() {
    this.geometry.dispose();
    this.material.dispose();
  }
}
