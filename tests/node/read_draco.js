// Draco meshes as three.js has them, by draco3d.

import { createRequire } from 'node:module';
import * as THREE from 'three';

export const draco = await createRequire(import.meta.url)('draco3d').createDecoderModule();

// Returns a geometry with the named attributes. `ids`: of Draco's attributes, by name; `types`: of arrays, by name.
export function decodeDraco(bytes, ids, types) {
  const decoder = new draco.Decoder();
  const buffer = new draco.DecoderBuffer();
  buffer.Init(new Int8Array(bytes), bytes.byteLength);
  if (decoder.GetEncodedGeometryType(buffer) !== draco.TRIANGULAR_MESH) throw new Error('not a Draco triangle mesh');
  const mesh = new draco.Mesh();
  const status = decoder.DecodeBufferToMesh(buffer, mesh);
  if (!status.ok()) throw new Error(status.error_msg());
  const geometry = new THREE.BufferGeometry();
  for (const [name, id] of Object.entries(ids(decoder, mesh))) {
    const attribute = decoder.GetAttributeByUniqueId(mesh, id);
    const size = attribute.num_components();
    const count = mesh.num_points() * size;
    const values = new draco.DracoFloat32Array();
    // Draco scales normalized attributes to floats from 0 to 1. Bytes and shorts lose nothing as floats.
    decoder.GetAttributeFloatForAllPoints(mesh, attribute, values);
    const Type = attribute.normalized() ? Float32Array : types[name] ?? Float32Array;
    const array = Type.from({ length: count }, (_, n) => values.GetValue(n));
    geometry.setAttribute(name, new THREE.BufferAttribute(array, size));
  }
  const triangles = mesh.num_faces();
  const size = triangles * 3 * 4;
  const pointer = draco._malloc(size);
  decoder.GetTrianglesUInt32Array(mesh, size, pointer);
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(draco.HEAPU8.buffer, pointer, 3 * triangles).slice(), 1));
  draco._free(pointer);
  draco.destroy(mesh);
  draco.destroy(buffer);
  draco.destroy(decoder);
  return geometry;
}
