// glTF files as three.js has them, with the buffers beside them, and without pictures.

import { readFileSync } from 'node:fs';
import path from 'node:path';
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { factsOfScene, white } from './mesh_facts.js';
import { decodeDraco } from './read_draco.js';

const toArrayBuffer = (bytes) => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

const arrayTypes = { Int8Array, Uint8Array, Int16Array, Uint16Array, Int32Array, Uint32Array, Float32Array };

const dracoLoader = {
  preload() {},
  decodeDracoFile(bytes, done, ids, types, colorSpace, failed) {
    try {
      const named = Object.fromEntries(Object.entries(types).map(([name, type]) => [name, arrayTypes[type]]));
      done(decodeDraco(bytes, () => ids, named));
    } catch (error) {
      failed(error);
    }
  },
};

// Returns the document and the bytes of its own buffer.
function openGltf(bytes) {
  if (bytes.toString('latin1', 0, 4) !== 'glTF') return { json: JSON.parse(bytes.toString().replace(/^\uFEFF/, '')) };
  if (bytes.readUInt32LE(4) < 2) return { json: { asset: { version: '1.0' } } };
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.toString('utf8', 20, 20 + length));
  const next = 20 + length;
  const own = next + 8 <= bytes.length ? bytes.subarray(next + 8, next + 8 + bytes.readUInt32LE(next)) : null;
  return { json, own };
}

function bufferOf(uri, own, folder) {
  if (uri === undefined) {
    if (!own) throw new Error('a buffer has no bytes');
    return own;
  }
  const data = /^data:[^,]*,/.exec(uri);
  if (data) return Buffer.from(uri.slice(data[0].length), data[0].includes(';base64') ? 'base64' : 'utf8');
  return readFileSync(path.join(folder, decodeURIComponent(uri)));
}

export async function readGltf(bytes, folder) {
  const { json, own } = openGltf(bytes);
  if (Number(json.asset?.version) < 2) throw new Error('glTF before 2.0');
  for (const texture of json.textures ?? []) delete texture.extensions;
  const buffers = (json.buffers ?? []).map(({ uri }) => bufferOf(uri, own, folder));
  const loader = new GLTFLoader().setDRACOLoader(dracoLoader).setMeshoptDecoder(MeshoptDecoder);
  let parser;
  loader.register((made) => {
    parser = made;
    made.loadBuffer = (number) => Promise.resolve(toArrayBuffer(buffers[number]));
    made.loadTexture = () => Promise.resolve(new THREE.Texture());
    return { name: 'files' };
  });
  const { scene } = await loader.parseAsync(JSON.stringify(json), '');
  const isOfFile = (material) => parser.associations.get(material)?.materials !== undefined;
  const colorOf = (material, ofVertex) => {
    if (!ofVertex && !isOfFile(material)) return null;
    const color = material.color ?? white;
    return ofVertex ? ofVertex.clone().multiply(color) : color;
  };
  return factsOfScene(scene, colorOf);
}
