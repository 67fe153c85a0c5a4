// The Voronoi cell of a lattice, as the viewer wants it: normal, corners and step of each facet. Needs no browser.
const FAR = 3; // steps along each vector of a reduced basis
const PAIRS = [0, 1, 2].flatMap((n) => [0, 1, 2].filter((m) => m !== n).map((m) => [n, m]));

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, times = 1) => a.map((n, m) => n + times * b[m]);
const unit = (a) => a.map((n) => n / Math.hypot(...a));

// Returns the part of a polygon with dot(p, normal) <= most.
function clipped(polygon, normal, most, tolerance) {
  return polygon.flatMap((p, n) => {
    const q = polygon[(n + 1) % polygon.length],
      at = dot(p, normal) - most,
      next = dot(q, normal) - most;
    const kept = at <= tolerance ? [p] : [];
    if ((at < -tolerance && next > tolerance) || (at > tolerance && next < -tolerance))
      kept.push(plus(p, plus(q, p, -1), at / (at - next)));
    return kept;
  });
}

function withoutTwins(polygon, tolerance) {
  return polygon.filter((p, n) => Math.hypot(...plus(p, polygon[(n + 1) % polygon.length], -1)) > tolerance);
}

// Returns a basis of the same lattice in which no vector gets shorter by adding or subtracting another one, and the
// given coordinates of its vectors. A skewed basis has neighbors many steps away.
function reduced(given) {
  const basis = given.map((v) => [...v]),
    steps = given.map((_, n) => given.map((_, m) => Number(n === m)));
  const shorten = ([n, m]) => {
    const times = Math.round(dot(basis[n], basis[m]) / dot(basis[m], basis[m])),
      shorter = plus(basis[n], basis[m], -times);
    if (times === 0 || dot(shorter, shorter) >= dot(basis[n], basis[n]) * (1 - 1e-12)) return false;
    basis[n] = shorter;
    steps[n] = plus(steps[n], steps[m], -times);
    return true;
  };
  while (PAIRS.some(shorten));
  return { basis, steps };
}

export function facetsOf(given) {
  const { basis, steps: vectors } = reduced(given);
  const range = Array.from({ length: 2 * FAR + 1 }, (_, n) => n - FAR),
    size = Math.max(...basis.map((v) => Math.hypot(...v)));
  const steps = range
    .flatMap((i) => range.flatMap((j) => range.map((k) => [i, j, k])))
    .filter((step) => step.some((n) => n !== 0));
  const bisectors = steps
    .map((step) => {
      const to = [0, 1, 2].map((m) => step.reduce((sum, n, which) => sum + n * basis[which][m], 0)),
        normal = unit(to);
      const inGiven = [0, 1, 2].map((m) => step.reduce((sum, n, which) => sum + n * vectors[which][m], 0));
      return { step: inGiven, normal, most: Math.hypot(...to) / 2 };
    })
    .sort((a, b) => a.most - b.most);
  return bisectors.flatMap(({ step, normal, most }) => {
    const aside = unit(cross(normal, Math.abs(normal[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0])),
      up = cross(normal, aside);
    const middle = normal.map((n) => n * most),
      far = 4 * size;
    let corners = [
      [-1, -1],
      [1, -1],
      [1, 1],
      [-1, 1],
    ].map(([u, v]) => plus(plus(middle, aside, far * u), up, far * v));
    for (const other of bisectors) {
      if (other.step === step) continue;
      corners = clipped(corners, other.normal, other.most, 1e-9 * size);
      if (corners.length < 3) return [];
    }
    corners = withoutTwins(corners, 1e-7 * size);
    return corners.length < 3 ? [] : [{ step, normal, corners }];
  });
}
