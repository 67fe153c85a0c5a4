// Prints the mesh of a .drc file as .obj.
// Usage: node draco_to_obj.js IN.drc

import { readFileSync } from 'node:fs';
import { decodeDraco, draco } from './read_draco.js';

const position = (decoder, mesh) => {
  const number = decoder.GetAttributeId(mesh, draco.POSITION);
  return { position: decoder.GetAttribute(mesh, number).unique_id() };
};
const geometry = decodeDraco(readFileSync(process.argv[2]), position, {});
const { array } = geometry.getAttribute('position');
const corners = geometry.getIndex().array;
const lines = [];
for (let n = 0; n < array.length; n += 3) lines.push(`v ${array[n]} ${array[n + 1]} ${array[n + 2]}`);
for (let n = 0; n < corners.length; n += 3) lines.push(`f ${corners[n] + 1} ${corners[n + 1] + 1} ${corners[n + 2] + 1}`);
process.stdout.write(lines.join('\n') + '\n');
