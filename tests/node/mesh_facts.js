// Triangles, bounds and colors of the meshes of a three.js scene.

import * as THREE from 'three';

export const white = new THREE.Color(1, 1, 1);

// The triangles, bounds and colors of all meshes.
export class Facts {
  triangles = 0;
  min = [Infinity, Infinity, Infinity];
  max = [-Infinity, -Infinity, -Infinity];
  colored = false;
  colors = { min: [255, 255, 255], max: [0, 0, 0], sum: [0, 0, 0] };

  addCorner(position, rgb) {
    for (let m = 0; m < 3; ++m) {
      const x = position.getComponent(m);
      if (!Number.isFinite(x)) throw new Error('a corner of a triangle is not finite');
      this.min[m] = Math.min(this.min[m], x);
      this.max[m] = Math.max(this.max[m], x);
      this.colors.min[m] = Math.min(this.colors.min[m], rgb[m]);
      this.colors.max[m] = Math.max(this.colors.max[m], rgb[m]);
      this.colors.sum[m] += rgb[m];
    }
  }

  toJson() {
    const { triangles, min, max, colored, colors } = this;
    if (triangles === 0) return { triangles, min: null, max: null, colors: null };
    const mean = colors.sum.map((sum) => sum / (3 * triangles));
    return { triangles, min, max, colors: colored ? { min: colors.min, max: colors.max, mean } : null };
  }
}

// Returns sRGB bytes.
function toBytes(color) {
  const { r, g, b } = color.clone().convertLinearToSRGB();
  return [r, g, b].map((x) => Math.round(255 * Math.min(Math.max(x, 0), 1)));
}

function addMesh(mesh, colorOf, facts) {
  const { geometry } = mesh;
  const vertices = geometry.attributes.position;
  const { index } = geometry;
  const count = index ? index.count : vertices.count;
  const groups = geometry.groups.length > 0 && Array.isArray(mesh.material)
    ? geometry.groups.map((group) => ({ ...group, material: mesh.material[group.materialIndex] }))
    : [{ start: 0, count, material: Array.isArray(mesh.material) ? mesh.material[0] : mesh.material }];
  const places = [];
  for (let i = 0; i < (mesh.isInstancedMesh ? mesh.count : 1); ++i) {
    const place = mesh.matrixWorld.clone();
    if (mesh.isInstancedMesh) {
      const instance = new THREE.Matrix4();
      mesh.getMatrixAt(i, instance);
      place.multiply(instance);
    }
    places.push(place);
  }
  const position = new THREE.Vector3();
  const vertexColor = new THREE.Color();
  for (const { start, count: corners, material } of groups) {
    const triangles = Math.floor(Math.min(corners, count - start) / 3);
    for (const place of places) {
      facts.triangles += triangles;
      for (let corner = start; corner < start + 3 * triangles; ++corner) {
        const vertex = index ? index.getX(corner) : corner;
        if (vertex >= vertices.count) throw new Error('a vertex index is too large');
        const ofVertex = geometry.attributes.color ? vertexColor.fromBufferAttribute(geometry.attributes.color, vertex) : null;
        const color = colorOf(material, ofVertex);
        if (color) facts.colored = true;
        mesh.getVertexPosition(vertex, position).applyMatrix4(place);
        facts.addCorner(position, toBytes(color ?? white));
      }
    }
  }
}

// `colorOf(material, vertex color or null)` returns the linear color, or nothing for a corner without one.
export function factsOfScene(root, colorOf) {
  root.updateMatrixWorld(true);
  const facts = new Facts();
  root.traverse((object) => {
    if (object.isMesh) addMesh(object, colorOf, facts);
  });
  return facts;
}
