// Reads meshes with three.js' loaders, as the arrays of RawMesh.
import { joined } from './bricks.js';
import { Colors } from './colors.js';
import { countFaces } from './ply.js';

const MOST_TRIANGLES = 20_000_000;
const NO_TRIANGLES = 'the file has no triangles that can be read';

// Each returns { read, keyOf }: the loader's geometry or scene, and what tells its materials apart, if it has any.
const READERS = {
  stl: async (bytes) => ({ read: new (await import('three/loaders/STLLoader.js')).STLLoader().parse(bytes) }),
  ply,
  obj: async (bytes) => {
    const { OBJLoader } = await import('three/loaders/OBJLoader.js');
    return { read: new OBJLoader().parse(new TextDecoder().decode(bytes)), keyOf: ({ name }) => name };
  },
  glb: gltf,
  gltf,
};

// Without faces, other code would take the points for corners of triangles. The loader gives a face three colors, even
// if it has four corners.
async function ply(bytes) {
  if (!(countFaces(bytes) > 0)) throw new Error(NO_TRIANGLES);
  const { PLYLoader } = await import('three/loaders/PLYLoader.js');
  const read = new PLYLoader().parse(bytes),
    { position, color = position } = read.attributes;
  if (color.count !== position.count)
    throw new Error('faces of four corners have colors, which this page does not read; use the tool latvox');
  return { read };
}

async function gltf(bytes) {
  const { GLTFLoader } = await import('three/loaders/GLTFLoader.js');
  const { scene, parser } = await new GLTFLoader().parseAsync(bytes, '');
  if (!scene) throw new Error('the file has no scene');
  // The loader makes several materials of one, such as one for meshes without normals.
  return { read: scene, keyOf: (material) => parser.associations.get(material)?.materials ?? '' };
}

const FORMATS = Object.keys(READERS).map((format) => `.${format}`);

// Yields { geometry, material, materials, matrix } of each mesh. `material`: the one for colors. `materials`: of the
// geometry's groups. `matrix`: 16 numbers, column by column, or null.
function* partsOf(read) {
  if (read.isBufferGeometry) return yield { geometry: read, materials: [], matrix: null };
  read.updateMatrixWorld(true);
  const meshes = [];
  read.traverse((node) => node.isMesh && meshes.push(node));
  for (const { isSkinnedMesh, isInstancedMesh, name, geometry, material, matrixWorld } of meshes) {
    if (isSkinnedMesh || isInstancedMesh)
      throw new Error(
        `"${name}" is ${isSkinnedMesh ? 'skinned' : 'instanced'}, which this page does not read; use the tool latvox`,
      );
    yield {
      geometry,
      material: [material].flat()[0],
      materials: [material].flat(),
      matrix: matrixWorld.elements.every((n, m) => n === (m % 5 === 0 ? 1 : 0)) ? null : matrixWorld.elements,
    };
  }
}

// Returns the numbers of the vertices' materials, by first use, or null without any. As in the tool, triangles without
// a material come last.
function materialsOf(parts, sizes, vertices, keyOf) {
  if (keyOf === undefined) return null;
  const stretches = [];
  let first = 0;
  parts.forEach(({ geometry: { groups }, materials }, part) => {
    const end = first + sizes[part].vertices;
    if (materials.length === 1) stretches.push({ key: keyOf(materials[0]), from: first, to: end });
    // Only OBJLoader has several, and it repeats the vertices of each triangle.
    else
      for (const { start, count, materialIndex } of groups)
        stretches.push({ key: keyOf(materials[materialIndex]), from: first + start, to: first + start + count });
    first = end;
  });
  const keys = new Set(stretches.map(({ key }) => key));
  keys.delete('');
  if (keys.size === 0) return null;
  const order = new Map([...keys, ''].map((key, n) => [key, n])),
    numbers = new Uint32Array(vertices);
  for (const { key, from, to } of stretches) numbers.fill(order.get(key), from, to);
  return numbers;
}

// Returns the positions of all vertices. Transforms are multiplied as doubles.
function positionsOf(parts, vertices) {
  const isDouble = parts.some(({ matrix }) => matrix !== null),
    positions = new (isDouble ? Float64Array : Float32Array)(3 * vertices);
  let vertex = 0;
  for (const { geometry, matrix: m } of parts) {
    const { position } = geometry.attributes;
    for (let n = 0; n < position.count; ++n, ++vertex) {
      const [x, y, z] = [position.getX(n), position.getY(n), position.getZ(n)];
      positions.set(
        m ? [0, 1, 2].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]) : [x, y, z],
        3 * vertex,
      );
    }
  }
  return positions;
}

// Returns the corners of all triangles, and the part of each vertex.
function trianglesOf(parts, sizes, vertices, triangles) {
  const corners = new Uint32Array(3 * triangles),
    numbers = new Uint32Array(vertices);
  let vertex = 0,
    corner = 0;
  parts.forEach(({ geometry: { index } }, part) => {
    numbers.fill(part, vertex, vertex + sizes[part].vertices);
    for (let n = 0; n < 3 * sizes[part].triangles; ++n) corners[corner++] = vertex + (index ? index.getX(n) : n);
    vertex += sizes[part].vertices;
  });
  return { corners, numbers };
}

// A loader that reads past the end of a file throws a RangeError. So does a browser that has too little memory.
const reasonOf = (error) =>
  error instanceof RangeError ? `the file is damaged or too large (${error.message})` : error.message;

// Returns { spec: RawMesh, bytes, up, textured }. `part` is the number of the mesh within the file. `textured`: what
// colors.js needs for the textures; null without any. Then the colors of vertices include the textures there.
// Throws an Error that names file and reason.
export async function readMesh(file) {
  const format = file.name.toLowerCase().split('.').pop();
  try {
    if (!Object.hasOwn(READERS, format)) throw new Error(`the file is none of ${FORMATS.join(', ')}`);
    return await meshOf(await READERS[format](await file.arrayBuffer()), format);
  } catch (error) {
    throw new Error(`${file.name}: ${reasonOf(error)}`, { cause: error });
  }
}

async function meshOf({ read, keyOf }, format) {
  const parts = [...partsOf(read)].filter(({ geometry }) => geometry.attributes.position?.count > 0);
  const sizes = parts.map(({ geometry: { index, attributes } }) => ({
    vertices: attributes.position.count,
    triangles: Math.floor((index?.count ?? attributes.position.count) / 3),
  }));
  const vertices = sizes.reduce((sum, each) => sum + each.vertices, 0),
    triangles = sizes.reduce((sum, each) => sum + each.triangles, 0);
  if (triangles === 0) throw new Error(NO_TRIANGLES);
  if (triangles > MOST_TRIANGLES)
    throw new Error(`${triangles} triangles exceed ${MOST_TRIANGLES}; use the tool latvox`);
  const positions = positionsOf(parts, vertices),
    { corners, numbers } = trianglesOf(parts, sizes, vertices, triangles),
    materials = materialsOf(parts, sizes, vertices, keyOf),
    colors = Colors.of(parts, numbers);
  const spec = {
    vertices,
    triangles,
    positions: positions instanceof Float64Array ? 'POSITION_TYPE_FLOAT64' : 'POSITION_TYPE_FLOAT32',
    fields: ['FIELD_PART', ...(materials ? ['FIELD_MATERIAL'] : []), ...(colors ? ['FIELD_COLOR'] : [])],
  };
  const arrays = [positions, corners, numbers, materials, colors?.numbers()].filter(Boolean),
    bytes = joined(arrays.map((array) => new Uint8Array(array.buffer)));
  const up = ['glb', 'gltf', 'obj'].includes(format) ? 'y' : 'z';
  return { spec, bytes, up, textured: colors?.hasTextures ? { colors, corners } : null };
}
