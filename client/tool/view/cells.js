// The Voronoi cells of the page's voxels, and cuts through them. Needs voxels.js, no browser.
//
//   frame   where the page draws: the shape lies within 1 of 0, and y is up; see client/tool/view/page.h
//   world   where the file's positions are
//   form    a linear form of lattice coordinates
"use strict";

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b, times = 1) => a.map((n, m) => n + times * b[m]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((n) => n / Math.hypot(...a));
const combine = (vectors, by) => [0, 1, 2].map((m) => by.reduce((sum, n, which) => sum + n * vectors[which][m], 0));

// Returns the forms that give the coordinates of a position: dual[m] has 1 for basis[m] and 0 for the others.
function dualOf([a, b, c]) {
  const volume = dot(a, cross(b, c));
  return [cross(b, c), cross(c, a), cross(a, b)].map((v) => v.map((n) => n / volume));
}

class Cells {
  // Takes the page's data.
  constructor({ basis, low, middle, facets, grid }) {
    Object.assign(this, { basis, grid, dual: dualOf(basis), center: plus(low, middle) });
    this.facets = facets.map(({ step, normal, corners }) => ({ step, normal, distance: dot(normal, corners[0]) }));
  }

  placeOf(ijk) {
    return combine(this.basis, plus(ijk, this.center, -1));
  }

  worldOf(ijk) {
    return plus(this.grid.origin, combine(this.grid.basis, ijk));
  }

  // Returns the lattice point whose cell holds the place. A step over a facet that the place lies behind comes nearer.
  at(place) {
    let ijk = this.dual.map((form, m) => Math.round(dot(form, place) + this.center[m]) + 0); // never -0
    for (;;) {
      const from = plus(place, this.placeOf(ijk), -1);
      const beyond = this.facets.map(({ normal, distance }) => dot(normal, from) - distance);
      const most = Math.max(...beyond);
      if (most <= 1e-9) return ijk;
      ijk = plus(ijk, this.facets[beyond.indexOf(most)].step);
    }
  }

  // Returns { ijk, voxel } of the first voxel along a ray with keep(i, j, k), or null. `along` has unit length.
  first(set, keep, from, along) {
    const middle = dot(from, along), inside = middle * middle - dot(from, from) + 1;
    if (inside <= 0) return null;
    const end = Math.sqrt(inside) - middle;
    let t = Math.max(0, -Math.sqrt(inside) - middle), ijk = this.at(plus(from, along, t));
    while (t < end) {
      const voxel = set.numberOf(...ijk);
      if (voxel >= 0 && keep(...ijk)) return { ijk, voxel };
      const to = plus(this.placeOf(ijk), from, -1);
      let leave = Infinity, step = null;
      for (const facet of this.facets) {
        const speed = dot(along, facet.normal);
        if (speed <= 1e-12) continue;
        const at = (facet.distance + dot(to, facet.normal)) / speed;
        if (at < leave) (leave = at), (step = facet.step);
      }
      t = leave;
      ijk = plus(ijk, step);
    }
    return null;
  }
}

// The voxels up to a plane, or only the layer at it.
//
//   form      grows by 1 from one side of the layer to the other
//   at        its value in the middle of the layer
//   axis      0, 1 or 2 if the layer is one of the lattice's, else -1
//   towards   the plane's normal in the frame
class Cut {
  constructor({ form, axis, towards }, at, only) {
    Object.assign(this, { form, axis, towards, at, only });
    this.inLayer = (...ijk) => Math.abs(dot(form, ijk) - at) < 0.5;
    this.keep = only ? this.inLayer : (...ijk) => dot(form, ijk) < at + 0.5;
  }
}

// The cuts across one direction, and the numbers of voxels that they keep.
class Direction {
  // `towards` is "i", "j" or "k": layers of the lattice; or a normal in the world. A layer across a normal is as thick
  // as the longest step over a facet, so that it has every voxel that a cut lays open.
  constructor(cells, set, towards) {
    this.axis = "ijk".indexOf(towards);
    this.thickness = 1;
    this.origin = 0;
    this.form = [0, 1, 2].map((m) => (m === this.axis ? 1 : 0));
    if (this.axis < 0) {
      const normal = unit(towards), along = cells.grid.basis.map((vector) => dot(vector, normal));
      this.thickness = Math.max(...cells.facets.map(({ step }) => Math.abs(dot(along, step))));
      this.origin = dot(cells.grid.origin, normal);
      this.form = along.map((n) => n / this.thickness);
    }
    this.towards = unit(combine(cells.dual, this.form));
    this.heights = new Float64Array(set.count());
    let n = 0;
    set.forEach((...ijk) => (this.heights[n++] = dot(this.form, ijk)));
    this.heights.sort();
    this.low = this.offsetOf(this.heights[0] ?? 0);
    this.high = this.offsetOf(this.heights.at(-1) ?? 0);
  }

  offsetOf(height) {
    return this.origin + height * this.thickness;
  }

  // A plane keeps the voxels that lie on it.
  cut(offset, only) {
    const height = (offset - this.origin) / this.thickness, at = this.axis >= 0 ? height : height - 0.5 + 1e-6;
    return new Cut(this, at, only);
  }

  // Returns whether the cut keeps all voxels.
  keepsAll({ at, only }) {
    return !only && !(this.heights.at(-1) >= at + 0.5);
  }

  // Returns the numbers of voxels of the layer, and up to it.
  count({ at }) {
    const below = (height) => {
      let low = 0, high = this.heights.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.heights[middle] < height) low = middle + 1;
        else high = middle;
      }
      return low;
    };
    const upTo = below(at + 0.5);
    return { layer: upTo - below(at - 0.5), upTo };
  }
}
