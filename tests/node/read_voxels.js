// Prints the content of files of voxels as readers from npm find it, as JSON by path. `node read_voxels.js FILE...` with
// any of .ply, .glb, .vox and .binvox.
import { readFileSync } from 'node:fs';
import binvox from 'binvox';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import readVox from 'vox-reader';

globalThis.self = globalThis; // as in a browser

function components(attribute, size = attribute.itemSize) {
  return Array.from({ length: attribute.count }, (_, n) => Array.from({ length: size }, (_, m) => attribute.getComponent(n, m)));
}

// All properties, by the names of the header's lines.
function ply(bytes) {
  const [header] = bytes.toString('latin1').split('end_header', 1);
  const names = [...header.matchAll(/^property \w+ (.+)$/gm)].map(([, name]) => name);
  const loader = new PLYLoader();
  loader.setCustomPropertyNameMapping(Object.fromEntries(names.map((name) => [`of ${name}`, [name]])));
  const { attributes } = loader.parse(new Uint8Array(bytes).buffer);
  return Object.fromEntries(names.map((name) => [name, components(attributes[`of ${name}`], 1).flat()]));
}

// The corners of all triangles, three by three, in world coordinates, and their colors.
async function glb(bytes) {
  const { scene } = await new GLTFLoader().parseAsync(new Uint8Array(bytes).buffer, '');
  scene.updateMatrixWorld();
  const found = { corners: [], colors: [] };
  scene.traverse((node) => {
    if (!node.isMesh) return;
    const { attributes } = node.geometry.toNonIndexed();
    found.corners.push(...components(attributes.position.applyMatrix4(node.matrixWorld)));
    if (attributes.color) found.colors.push(...components(attributes.color, 3));
  });
  return found;
}

const readers = { ply, glb, vox: readVox, binvox: (bytes) => new binvox.Parser().parse(new Uint8Array(bytes).buffer) };
const found = {};
for (const path of process.argv.slice(2)) found[path] = await readers[path.split('.').at(-1)](readFileSync(path));
console.log(JSON.stringify(found));
