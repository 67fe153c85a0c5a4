// Reads meshes with three.js' loaders, as the arrays of RawMesh.
import { Colors } from './colors.js';

const MOST_TRIANGLES = 20_000_000;

const READERS = {
  stl: async (bytes) => new (await import('three/loaders/STLLoader.js')).STLLoader().parse(bytes),
  ply: async (bytes) => new (await import('three/loaders/PLYLoader.js')).PLYLoader().parse(bytes),
  obj: async (bytes) =>
    new (await import('three/loaders/OBJLoader.js')).OBJLoader().parse(new TextDecoder().decode(bytes)),
  glb: gltf,
  gltf,
};

async function gltf(bytes) {
  const { GLTFLoader } = await import('three/loaders/GLTFLoader.js');
  return (await new GLTFLoader().parseAsync(bytes, '')).scene;
}

// Yields { geometry, material, matrix } of each mesh; matrix: 16 numbers, column by column, or null.
function* partsOf(read) {
  if (read.isBufferGeometry) return yield { geometry: read, matrix: null };
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
      matrix: matrixWorld.elements.every((n, m) => n === (m % 5 === 0 ? 1 : 0)) ? null : matrixWorld.elements,
    };
  }
}

// Returns { spec: RawMesh, bytes, up, textured }. `part` is the number of the mesh within the file. `textured`: what
// colors.js needs for the textures; null without any. Then the colors of vertices include the textures there.
export async function readMesh(name, bytes) {
  const format = name.toLowerCase().split('.').pop();
  if (!Object.hasOwn(READERS, format)) throw new Error(`"${name}" is not one of .stl, .obj, .ply, .glb, .gltf`);
  const parts = [...partsOf(await READERS[format](bytes))].filter(
    ({ geometry }) => geometry.attributes.position?.count > 0,
  );
  const sizes = parts.map(({ geometry: { index, attributes } }) => ({
    vertices: attributes.position.count,
    triangles: Math.floor((index?.count ?? attributes.position.count) / 3),
  }));
  const vertices = sizes.reduce((sum, each) => sum + each.vertices, 0),
    triangles = sizes.reduce((sum, each) => sum + each.triangles, 0);
  if (triangles === 0) throw new Error(`"${name}" has no triangles`);
  if (triangles > MOST_TRIANGLES)
    throw new Error(`"${name}" has ${triangles} triangles, more than ${MOST_TRIANGLES}; use the tool latvox`);
  // Transforms are multiplied as doubles.
  const double = parts.some(({ matrix }) => matrix !== null),
    positions = new (double ? Float64Array : Float32Array)(3 * vertices);
  const corners = new Uint32Array(3 * triangles),
    numbers = new Uint32Array(vertices);
  let vertex = 0,
    corner = 0;
  parts.forEach(
    (
      {
        geometry: {
          index,
          attributes: { position },
        },
        matrix: m,
      },
      part,
    ) => {
      for (let n = 0; n < position.count; ++n) {
        const [x, y, z] = [position.getX(n), position.getY(n), position.getZ(n)];
        positions.set(
          m ? [0, 1, 2].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]) : [x, y, z],
          3 * (vertex + n),
        );
      }
      numbers.fill(part, vertex, vertex + position.count);
      for (let n = 0; n < 3 * sizes[part].triangles; ++n) corners[corner++] = vertex + (index ? index.getX(n) : n);
      vertex += position.count;
    },
  );
  const colors = Colors.of(parts, numbers);
  const spec = {
    vertices,
    triangles,
    positions: double ? 'POSITION_TYPE_FLOAT64' : 'POSITION_TYPE_FLOAT32',
    fields: ['FIELD_PART', ...(colors ? ['FIELD_COLOR'] : [])],
  };
  const arrays = [positions, corners, numbers, ...(colors ? [colors.numbers()] : [])].map(
    (array) => new Uint8Array(array.buffer),
  );
  const all = new Uint8Array(arrays.reduce((sum, { length }) => sum + length, 0));
  arrays.reduce((at, array) => (all.set(array, at), at + array.length), 0);
  const up = ['glb', 'gltf', 'obj'].includes(format) ? 'y' : 'z';
  return { spec, bytes: all, up, textured: colors?.hasTextures ? { colors, corners } : null };
}
