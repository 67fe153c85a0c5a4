// Reads mesh files with three.js and draco3d. Each line of standard input is the path of a file, and each line of
// standard output its facts: {"triangles", "min", "max", "colors": {"min", "max", "mean"} or null}, or {"error"}.
// Colors are sRGB, 0 to 255, over the corners of triangles, as in `latvox info --json`.

import { existsSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { DOMParser } from 'linkedom';
import * as THREE from 'three';
import { strFromU8, unzipSync } from 'three/addons/libs/fflate.module.js';
import { ThreeMFLoader } from 'three/addons/loaders/3MFLoader.js';
import { MTLLoader } from 'three/addons/loaders/MTLLoader.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { PLYLoader } from 'three/addons/loaders/PLYLoader.js';
import { STLLoader } from 'three/addons/loaders/STLLoader.js';
import { Facts, factsOfScene } from './mesh_facts.js';
import { decodeDraco, draco } from './read_draco.js';
import { readGltf } from './read_gltf.js';

// three.js expects a browser, which has XML and pictures. Pictures don't matter here.
globalThis.self = globalThis;
// A browser finds elements by their names without a prefix, but linkedom by whole names.
globalThis.DOMParser = class extends DOMParser {
  parseFromString(text, type) {
    return super.parseFromString(text.replace(/<(\/?)[\w.-]+:/g, '<$1'), type);
  }
};
THREE.TextureLoader.prototype.load = () => new THREE.Texture();
for (const level of ['log', 'warn', 'error']) console[level] = () => {};

const toArrayBuffer = (bytes) => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

// Returns the materials of the files that the text names, and of these what is readable.
function readMaterials(text, folder) {
  let all = '';
  for (const [, names] of text.matchAll(/^[ \t]*mtllib[ \t]+(.+?)[ \t]*\r?$/gm)) {
    for (const name of existsSync(path.join(folder, names)) ? [names] : names.split(/\s+/)) {
      const file = path.join(folder, name.replaceAll('\\', '/'));
      if (existsSync(file)) all += `${readFileSync(file, 'latin1')}\n`;
    }
  }
  const materials = new MTLLoader().parse(all, '');
  materials.preload();
  return materials;
}

function readObj(bytes, folder) {
  // three.js makes an object with a line or a point lines or points only. They have no triangles, so leave them out.
  const text = bytes.toString('latin1').replace(/^[ \t]*[lp][ \t].*$/gm, '');
  const materials = readMaterials(text, folder);
  const root = new OBJLoader().setMaterials(materials).parse(text);
  const isColored = (material) => materials.materialsInfo[material.name]?.kd !== undefined;
  return factsOfScene(root, (material, ofVertex) => ofVertex ?? (isColored(material) ? material.color : null));
}

function readStl(bytes) {
  const geometry = new STLLoader().parse(toArrayBuffer(bytes));
  return factsOfScene(new THREE.Mesh(geometry), (material, ofVertex) => ofVertex);
}

function readPly(bytes) {
  const geometry = new PLYLoader().parse(toArrayBuffer(bytes));
  if (!geometry.index) return new Facts(); // points
  return factsOfScene(new THREE.Mesh(geometry), (material, ofVertex) => ofVertex);
}

// Returns the size of the first model's unit, which three.js does not apply.
function millimetersOf(bytes) {
  const files = unzipSync(new Uint8Array(bytes));
  const name = Object.keys(files).find((each) => each.toLowerCase().endsWith('3dmodel.model')) ??
    Object.keys(files).find((each) => each.endsWith('.model'));
  const unit = /<(?:\w+:)?model\b[^>]*\bunit="(\w+)"/.exec(strFromU8(files[name]))?.[1] ?? 'millimeter';
  return { micron: 0.001, millimeter: 1, centimeter: 10, inch: 25.4, foot: 304.8, meter: 1000 }[unit];
}

function read3mf(bytes) {
  const root = new ThreeMFLoader().parse(toArrayBuffer(bytes));
  root.scale.setScalar(millimetersOf(bytes));
  // three.js gives objects without properties a white material of its own.
  return factsOfScene(root, (material, ofVertex) => ofVertex ?? (material.name === THREE.Loader.DEFAULT_MATERIAL_NAME ? null : material.color));
}

function readDraco(bytes) {
  const ids = (decoder, mesh) => {
    const found = {};
    for (const [name, kind] of [['position', draco.POSITION], ['color', draco.COLOR]]) {
      const number = decoder.GetAttributeId(mesh, kind);
      if (number >= 0) found[name] = decoder.GetAttribute(mesh, number).unique_id();
    }
    return found;
  };
  const geometry = decodeDraco(bytes, ids, {});
  return factsOfScene(new THREE.Mesh(geometry), (material, ofVertex) => ofVertex?.convertSRGBToLinear());
}

const readers = { '.obj': readObj, '.ply': readPly, '.stl': readStl, '.3mf': read3mf, '.drc': readDraco, '.gltf': readGltf, '.glb': readGltf };

async function answer(file) {
  try {
    const facts = await readers[path.extname(file).toLowerCase()](readFileSync(file), path.dirname(file));
    return facts.toJson();
  } catch (error) {
    return { error: String(error?.message ?? error).split('\n')[0] };
  }
}

for await (const file of createInterface({ input: process.stdin })) {
  process.stdout.write(`${JSON.stringify(await answer(file))}\n`);
}
