// Colors of a mesh: those of its vertices, and those of its textures at any point of a triangle. three.js' loaders give
// linear levels from 0 to 1; latvox wants sRGB from 0 to 255.
const REPEAT = 1000,
  MIRROR = 1002,
  NEAREST = 1003; // three.js' numbers

const linear = (level) => (level <= 0.04045 ? level / 12.92 : ((level + 0.055) / 1.055) ** 2.4);
const LINEAR = Float32Array.from({ length: 256 }, (_, level) => linear(level / 255));

function encoded(level) {
  const within = Math.min(Math.max(level, 0), 1);
  return Math.round(255 * (within <= 0.0031308 ? 12.92 * within : 1.055 * within ** (1 / 2.4) - 0.055));
}

const numberOf = ([r, g, b]) => (encoded(r) << 16) | (encoded(g) << 8) | encoded(b);

// In Chromium, a canvas of more than 65,535 pixels on a side, or 2^28 in all, stays empty without any error. Firefox
// takes 32,767 on a side.
const MOST_SIDE = 16384;

class Texture {
  constructor(map) {
    const { image, wrapS, wrapT, magFilter, name } = map,
      { width, height } = image;
    if (Math.max(width, height) > MOST_SIDE)
      throw new Error(
        `texture "${name}" has ${width} × ${height} pixels, more than ${MOST_SIDE} on a side; use the tool latvox`,
      );
    const context = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d');
    context.drawImage(image, 0, 0);
    map.updateMatrix();
    Object.assign(this, { width, height, wraps: [wrapS, wrapT], sharp: magFilter === NEAREST });
    this.pixels = context.getImageData(0, 0, width, height).data;
    this.matrix = map.matrix.elements;
  }

  // Returns a row or column of the image.
  wrapped(place, size, wrap) {
    if (wrap !== REPEAT && wrap !== MIRROR) return Math.min(Math.max(place, 0), size - 1);
    const period = wrap === MIRROR ? 2 * size : size,
      within = ((place % period) + period) % period;
    return within < size ? within : period - 1 - within;
  }

  // Adds a share of a pixel to the sum.
  add(sum, x, y, share) {
    const column = this.wrapped(x, this.width, this.wraps[0]),
      row = this.wrapped(y, this.height, this.wraps[1]);
    const at = 4 * (row * this.width + column);
    for (let n = 0; n < 3; ++n) sum[n] += share * LINEAR[this.pixels[at + n]];
  }

  // Returns the linear levels at a place from 0 to 1.
  at(u, v) {
    const m = this.matrix,
      x = (m[0] * u + m[3] * v + m[6]) * this.width,
      y = (m[1] * u + m[4] * v + m[7]) * this.height;
    const sum = [0, 0, 0];
    if (this.sharp) {
      this.add(sum, Math.floor(x), Math.floor(y), 1);
      return sum;
    }
    const left = Math.floor(x - 0.5),
      top = Math.floor(y - 0.5),
      right = x - 0.5 - left,
      below = y - 0.5 - top;
    this.add(sum, left, top, (1 - right) * (1 - below));
    this.add(sum, left + 1, top, right * (1 - below));
    this.add(sum, left, top + 1, (1 - right) * below);
    this.add(sum, left + 1, top + 1, right * below);
    return sum;
  }
}

const isWhite = ({ r, g, b }) => r === 1 && g === 1 && b === 1;
const hasColors = ({ geometry: { attributes }, material }) =>
  attributes.color !== undefined || Boolean(material?.map) || (material?.color && !isWhite(material.color));

// The colors of the vertices of all parts, one after the other: factors, places in textures, and both together.
export class Colors {
  // `partOf`: the part of each vertex. Precondition: some part has colors.
  constructor(parts, partOf) {
    const maps = new Map(parts.filter(({ material }) => material?.map).map(({ material: { map } }) => [map, null]));
    for (const map of maps.keys()) maps.set(map, new Texture(map));
    this.textures = parts.map(({ material }) => maps.get(material?.map) ?? null);
    this.partOf = partOf;
    this.factors = new Float32Array(3 * partOf.length).fill(1);
    this.places = new Float32Array(2 * partOf.length);
    let first = 0;
    for (const part of parts) {
      this.fill(part, first);
      first += part.geometry.attributes.position.count;
    }
  }

  static of(parts, partOf) {
    return parts.some(hasColors) ? new Colors(parts, partOf) : null;
  }

  get hasTextures() {
    return this.textures.some(Boolean);
  }

  fill({ geometry: { attributes }, material }, first) {
    const { position, color } = attributes,
      { r = 1, g = 1, b = 1 } = material?.color ?? {};
    const uv = material?.map && attributes[material.map.channel > 0 ? `uv${material.map.channel}` : 'uv'];
    for (let n = 0; n < position.count; ++n) {
      // OBJLoader has NaN for a vertex without a color.
      const levels = color && !Number.isNaN(color.getX(n)) ? [color.getX(n), color.getY(n), color.getZ(n)] : [1, 1, 1];
      this.factors.set([levels[0] * r, levels[1] * g, levels[2] * b], 3 * (first + n));
      if (uv) this.places.set([uv.getX(n), uv.getY(n)], 2 * (first + n));
    }
  }

  // Returns the colors of vertices as RawMesh has them.
  numbers() {
    const { factors, places } = this;
    return Uint32Array.from(this.partOf, (part, vertex) =>
      this.numberOf(part, factors.subarray(3 * vertex, 3 * vertex + 3), places[2 * vertex], places[2 * vertex + 1]),
    );
  }

  // Returns the color of a triangle's point, which is corner 1 + u (corner 2 - corner 1) + v (corner 3 - corner 1).
  numberAt(corners, u, v) {
    const weights = [1 - u - v, u, v];
    const mean = (values, size, n) =>
      weights.reduce((sum, weight, corner) => sum + weight * values[size * corners[corner] + n], 0);
    const levels = [0, 1, 2].map((n) => mean(this.factors, 3, n));
    return this.numberOf(this.partOf[corners[0]], levels, mean(this.places, 2, 0), mean(this.places, 2, 1));
  }

  // Returns the product of levels and the part's texture at a place.
  numberOf(part, levels, u, v) {
    const texture = this.textures[part];
    if (texture === null) return numberOf(levels);
    const image = texture.at(u, v);
    return numberOf([levels[0] * image[0], levels[1] * image[1], levels[2] * image[2]]);
  }
}

// Returns three bytes for each voxel, from the nearest triangles and points. `corners`: of the mesh's triangles.
export function colorsOfVoxels(colors, corners, triangles, points) {
  const numbers = new Uint32Array(triangles.buffer),
    weights = new Float32Array(points.buffer),
    bytes = new Uint8Array(3 * numbers.length);
  numbers.forEach((triangle, voxel) => {
    const three = corners.subarray(3 * triangle, 3 * triangle + 3),
      color = colors.numberAt(three, weights[2 * voxel], weights[2 * voxel + 1]);
    bytes.set([color >> 16, (color >> 8) & 255, color & 255], 3 * voxel);
  });
  return bytes;
}
