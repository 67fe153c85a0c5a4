// The panel beside the view: counts, certificate, colors and layers. The address may end in
// #axis=k&layer=40&which=only&by=part&azimuth=30&elevation=22.
"use strict";

// Returns the number of voxels of each layer across each axis.
function countLayers(set) {
  const counts = data.low.map((low, m) => new Uint32Array(data.high[m] - low));
  set.forEach((i, j, k) => {
    ++counts[0][i - data.low[0]];
    ++counts[1][j - data.low[1]];
    ++counts[2][k - data.low[2]];
  });
  return counts;
}

function fillPanel(set) {
  byId("title").textContent = document.title = data.title;
  byId("voxels").textContent = byId("shown").textContent = set.count();
  byId("bricks").textContent = set.bricks.size;
  for (const [name, value] of data.metadata) {
    const row = byId("certificate").insertRow();
    row.appendChild(document.createElement("th")).textContent = name;
    row.insertCell().textContent = value;
  }
  byId("about").open = matchMedia("(min-width: 641px)").matches;
}

// Returns a function that returns red, green and blue of each voxel, or null.
function usePaints(voxels, wanted) {
  const bytes = bytesOf("paints"), by = byId("by");
  byId("colors").hidden = data.paints.length === 0;
  by.append(...data.paints.map(({ name }) => new Option(name)), new Option("none"));
  by.value = wanted.get("by") ?? by.options[0].value;
  return () => {
    const n = by.selectedIndex;
    describe(data.paints[n] ?? { legend: [] });
    return n < data.paints.length ? bytes.subarray(3 * voxels * n, 3 * voxels * (n + 1)) : null;
  };
}

function describe({ ramp, legend }) {
  const div = (name, ...children) => {
    const made = document.createElement("div");
    made.className = name;
    made.append(...children);
    return made;
  };
  if (ramp) {
    const colors = div("ramp"), ends = legend.filter(([, text]) => text !== "").map(([, text]) => div("quiet", text));
    colors.style.background = `linear-gradient(to right, ${legend.map(([color]) => color).join()})`;
    byId("legend").replaceChildren(colors, div("ends", ...ends));
  } else {
    byId("legend").replaceChildren(...legend.map(([color, text]) => {
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = color;
      return div("", ...(color === "" ? [] : [swatch]), text);
    }));
  }
}

// `latvox slice` accepts x, y, z for the lattice coordinates i, j, k.
function useLayers(set, view, paints, wanted) {
  const axis = byId("axis"), layer = byId("layer"), which = byId("which"), counts = countLayers(set);
  const show = () => {
    const m = axis.selectedIndex, n = Number(layer.value), only = which.value === "only";
    const inLayer = counts[m][n - data.low[m]] ?? 0;
    byId("at").textContent = `${axis.value} = ${n}`;
    byId("inlayer").textContent = inLayer;
    byId("slice").textContent = `latvox slice --axis ${"xyz"[m]} --index ${n}`;
    const below = counts[m].subarray(0, n - data.low[m] + 1);
    byId("shown").textContent = only ? inLayer : below.reduce((sum, of) => sum + of, 0);
    view.show(paints(), m, n, only);
  };
  const range = (value) => {
    layer.min = data.low[axis.selectedIndex];
    layer.max = data.high[axis.selectedIndex] - 1;
    layer.value = value ?? layer.max;
    show();
  };
  axis.value = wanted.get("axis") ?? "k";
  which.value = wanted.get("which") ?? "upto";
  axis.addEventListener("change", () => range());
  for (const each of [layer, which, byId("by")]) each.addEventListener("input", show);
  // A band begins cut in the middle, because its content is inside.
  const m = axis.selectedIndex;
  range(wanted.get("layer") ?? (data.band ? Math.floor((data.low[m] + data.high[m]) / 2) : undefined));
  byId("cut").disabled = false;
}

function start() {
  const wanted = new URLSearchParams(location.hash.slice(1)), set = readVoxels();
  fillPanel(set);
  const view = new View(set), paints = usePaints(set.count(), wanted);
  view.first = [Number(wanted.get("azimuth") ?? 30), Number(wanted.get("elevation") ?? 22)];
  useLayers(set, view, paints, wanted);
  view.resize();
  view.home(...view.first);
  return view;
}

let view = null;
try {
  view = start();
} catch (error) {
  tell(`The voxels cannot be drawn: ${error.message}. Their counts and their certificate are complete.`);
  document.body.dataset.busy = "no";
}
