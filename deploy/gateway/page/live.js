// Lets the viewer show bricks while they arrive.
"use strict";

// In place of the base64 within a page of `latvox view`.
bytesOf = (id) => parent.latvox[id];

const growing = { voxels: 0 };

// Adds bricks, 76 bytes each. Returns the milliseconds that it took.
function grow(bricks, voxels) {
  const started = performance.now(),
    { set } = view.shape ?? view,
    ints = new DataView(bricks.buffer, bricks.byteOffset, bricks.length);
  growing.voxels ||= set.count();
  for (let at = 0; at < bricks.length; at += 76) {
    const rows = bricks.subarray(at + 12, at + 76);
    set.addBrick(
      [0, 4, 8].map((n) => 8 * ints.getInt32(at + n, true)),
      rows,
      growing.voxels,
    );
    for (const row of rows) growing.voxels += BITS[row];
  }
  for (const [id, count] of [
    ["voxels", growing.voxels],
    ["bricks", set.bricks.size],
    ["shown", growing.voxels],
  ])
    fill(byId(id), count);
  if (view instanceof View) {
    view.shape.cloud?.dispose();
    view.shape.surface?.dispose();
    view.shape = new Shape(set);
    view.show(null, new Direction(cells, set, "k").cut(Infinity, false), true);
  }
  return performance.now() - started;
}

// Returns where the camera is, for the address of the viewer.
function camera() {
  const { controls } = view ?? {};
  if (!controls) return "";
  const degrees = 180 / Math.PI;
  return `azimuth=${degrees * controls.getAzimuthalAngle()}&elevation=${90 - degrees * controls.getPolarAngle()}`;
}
