// Prints the content of a .glb that three.js reads: corners in world coordinates, number of triangles, colors. `node
// read_glb.js FILE`.
import { readFileSync } from 'node:fs';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

globalThis.self = globalThis; // as in a browser
const { scene } = await new GLTFLoader().parseAsync(new Uint8Array(readFileSync(process.argv[2])).buffer, '');
scene.updateMatrixWorld();
const found = { corners: [], triangles: 0, colors: [] };
scene.traverse((node) => {
  if (!node.isMesh) return;
  const { attributes, index } = node.geometry;
  const numbers = (attribute) => Array.from({ length: attribute.count }, (_, n) => [0, 1, 2].map((m) => attribute.getComponent(n, m)));
  found.corners.push(...numbers(attributes.position.clone().applyMatrix4(node.matrixWorld)));
  found.triangles += index.count / 3;
  if (attributes.color) found.colors.push(...numbers(attributes.color));
});
console.log(JSON.stringify(found));
