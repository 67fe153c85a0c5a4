// Draws the cross-section of the voxels at a cut, on a canvas without WebGL.
"use strict";

class FlatView {
  constructor(canvas, set) {
    canvas.setAttribute("aria-label", "a layer of the voxels; arrow keys move it");
    Object.assign(this, { canvas, set, edges: true, middle: [0, 0], scale: 1, waiting: false });
    new ResizeObserver(() => this.resize()).observe(byId("scene"));
    canvas.addEventListener("wheel", (event) => (event.preventDefault(), this.zoom(event.deltaY > 0 ? 1.1 : 0.9)), { passive: false });
    canvas.addEventListener("pointermove", ({ buttons, movementX: x, movementY: y }) => {
      if (buttons !== 0) this.shift(x, y);
    });
  }

  // A layer of the lattice consists of its own cells, as those of `latvox slice`. Another plane cuts cells near it.
  show(paints, cut) {
    const turned = this.cut?.form !== cut.form, middle = cut.axis >= 0 ? cut.at : cut.at + 0.5;
    Object.assign(this, { paints, cut, sections: new Map() });
    // x of the page is a direction of the lattice in the plane, or of the world.
    if (turned) this.right = this.across(cut.axis >= 0 ? data.basis[cut.axis === 0 ? 1 : 0] : data.axes[0]);
    this.up = cross(cut.towards, this.right);
    const gradient = dot(cut.form, cells.dual.map((dual) => dot(dual, cut.towards)));
    this.depth = (middle - dot(cut.form, cells.center)) / gradient;
    const near = cut.axis >= 0 ? cut.inLayer : (...ijk) => Math.abs(dot(cut.form, ijk) - middle) < 1;
    this.voxels = [];
    this.set.forEach((i, j, k, voxel) => {
      if (near(i, j, k)) this.voxels.push({ ijk: [i, j, k], voxel, place: cells.placeOf([i, j, k]) });
    });
    if (turned) this.home();
    this.change();
  }

  // Returns the direction in the plane that is nearest to this one, or to another one if it is the normal.
  across(direction) {
    const { towards } = this.cut, inPlane = (v) => plus(v, towards, -dot(v, towards));
    const candidates = [direction, ...data.axes].map(inPlane);
    return unit(candidates.find((v) => Math.hypot(...v) > 1e-3 * Math.hypot(...direction)));
  }

  // Returns the place of the plane's point at a position of the canvas.
  placeAt(x, y) {
    const [u, v] = [(x - this.width / 2) / this.scale + this.middle[0], (this.height / 2 - y) / this.scale + this.middle[1]];
    return plus(plus(plus([0, 0, 0], this.cut.towards, this.depth), this.right, u), this.up, v);
  }

  pick(x, y) {
    const point = this.placeAt(x, y), [a, b, c] = point;
    let nearest = null, least = Infinity;
    for (const each of this.voxels) {
      const [p, q, r] = each.place, square = (p - a) ** 2 + (q - b) ** 2 + (r - c) ** 2;
      if (square < least) (least = square), (nearest = each);
    }
    if (nearest === null) return null;
    const [u, v] = [this.right, this.up].map((axis) => dot(axis, plus(point, nearest.place, -1)));
    return this.walls(this.below(nearest)).every(([a, b, most]) => a * u + b * v <= most) ? nearest : null;
  }

  // Returns how far a voxel is below the plane.
  below({ place }) {
    return this.cut.axis >= 0 ? 0 : this.depth - dot(place, this.cut.towards);
  }

  // Returns the lines around the part of a cell in the plane: a * u + b * v <= most.
  walls(below) {
    const inPlane = (v) => [dot(v, this.right), dot(v, this.up)], { axis, towards } = this.cut;
    if (axis < 0) return cells.facets.map(({ normal, distance }) => [...inPlane(normal), distance - below * dot(normal, towards)]);
    const [p, q] = data.basis.filter((_, m) => m !== axis).map(inPlane), walls = [];
    for (let i = -4; i <= 4; ++i) {
      for (let j = -4; j <= 4; ++j) {
        const to = p.map((n, m) => i * n + j * q[m]);
        if (i !== 0 || j !== 0) walls.push([...to, (to[0] ** 2 + to[1] ** 2) / 2]);
      }
    }
    return walls;
  }

  // Returns the corners of that part, relative to the cell's center.
  sectionOf(below) {
    const name = below.toFixed(6);
    if (!this.sections.has(name)) this.sections.set(name, this.walls(below).reduce(clipped, [[-9, -9], [9, -9], [9, 9], [-9, 9]]));
    return this.sections.get(name);
  }

  home() {
    const places = this.voxels.map(({ place }) => place), size = Math.hypot(...data.basis[0]);
    const extent = [this.right, this.up].map((axis) => {
      const along = places.map((place) => dot(place, axis));
      return [along.reduce((a, b) => Math.min(a, b), Infinity) - size, along.reduce((a, b) => Math.max(a, b), -Infinity) + size];
    });
    this.middle = places.length === 0 ? [0, 0] : extent.map(([low, high]) => (low + high) / 2);
    this.wide = places.length === 0 ? [2, 2] : extent.map(([low, high]) => high - low);
    this.fit();
  }

  fit() {
    this.scale = 0.92 * Math.min(this.width / this.wide[0], this.height / this.wide[1]);
    this.change();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = byId("scene"), ratio = Math.min(2, devicePixelRatio);
    if (width === 0 || height === 0) return;
    Object.assign(this, { width, height });
    Object.assign(this.canvas, { width: ratio * width, height: ratio * height });
    Object.assign(this.canvas.style, { width: `${width}px`, height: `${height}px` });
    if (this.wide !== undefined) this.fit();
  }

  move(right, up) {
    this.shift(4 * right, -4 * up);
  }

  shift(x, y) {
    this.middle = [this.middle[0] - x / this.scale, this.middle[1] + y / this.scale];
    this.change();
  }

  zoom(farther) {
    this.scale /= farther;
    this.change();
  }

  change() {
    if (this.waiting) return;
    this.waiting = true;
    document.body.dataset.busy = "yes";
    requestAnimationFrame(() => ((this.waiting = false), this.drawFully(), (document.body.dataset.busy = "no")));
  }

  drawFully() {
    const context = this.canvas.getContext("2d"), ratio = this.canvas.width / this.width;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.lineJoin = "round";
    context.strokeStyle = "#0008";
    context.lineWidth = 1;
    const lines = this.edges && Math.hypot(...data.basis[0]) * this.scale > 6;
    for (const each of this.voxels) {
      const { voxel, place } = each, corners = this.sectionOf(this.below(each));
      if (corners.length < 3) continue;
      const [x, y] = [dot(place, this.right) - this.middle[0], dot(place, this.up) - this.middle[1]];
      context.beginPath();
      for (const [u, v] of corners) context.lineTo(this.width / 2 + (x + u) * this.scale, this.height / 2 - (y + v) * this.scale);
      context.closePath();
      context.fillStyle = this.paints === null ? "#6f93cf" : `rgb(${this.paints.subarray(3 * voxel, 3 * voxel + 3).join()})`;
      context.fill();
      // Without lines, the gaps that smoothing leaves between neighbors are closed.
      if (!lines) context.strokeStyle = context.fillStyle;
      context.stroke();
    }
  }
}

// Returns the part of a convex polygon with a * u + b * v <= most.
function clipped(corners, [a, b, most]) {
  const over = ([u, v]) => a * u + b * v - most;
  return corners.flatMap((here, n) => {
    const next = corners[(n + 1) % corners.length], [h, i] = [over(here), over(next)];
    const border = here.map((x, m) => x + ((next[m] - x) * h) / (h - i));
    return [...(h <= 0 ? [here] : []), ...(h * i < 0 ? [border] : [])];
  });
}
