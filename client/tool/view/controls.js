// The panel beside the view, its tools, and what the pointer is at. The address may end in
// #axis=k&layer=40&which=only&by=part&azimuth=30&elevation=22, or #axis=x&offset=0.5, or #axis=1,1,0&offset=0.
"use strict";

function fillPanel(set) {
  byId("title").textContent = document.title = data.title;
  fill(byId("voxels"), data.voxels);
  fill(byId("bricks"), set.bricks.size);
  for (const [name, value] of data.metadata) {
    const row = byId("certificate").insertRow();
    row.appendChild(document.createElement("th")).textContent = name;
    fill(row.insertCell(), value);
  }
}

// Returns a function that returns red, green and blue of each voxel, or null.
function usePaints(wanted) {
  const bytes = bytesOf("paints"), by = byId("by"), length = 3 * data.voxels;
  byId("colors").hidden = data.paints.length === 0;
  by.append(...data.paints.map(({ name }) => new Option(name)), new Option("none"));
  by.value = wanted.get("by") ?? by.options[0].value;
  return () => {
    const n = by.selectedIndex;
    describe(data.paints[n] ?? { legend: [] });
    return n < data.paints.length ? bytes.subarray(length * n, length * (n + 1)) : null;
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
      return div("", ...(color === "" ? [] : [swatch]), text.replace(/\d{4,}(?= voxels)/, brief));
    }));
  }
}

// Returns the direction that the panel names: a letter of the lattice, or a normal in the world; null if it is neither.
function towardsOf(axis, normal) {
  if ("ijk".includes(axis)) return axis;
  if ("xyz".includes(axis)) return [0, 1, 2].map((m) => ("xyz"[m] === axis ? 1 : 0));
  const numbers = normal.split(/[\s,]+/).filter((word) => word !== "").map(Number);
  return numbers.length === 3 && Math.hypot(...numbers) > 0 ? numbers : null;
}

// The layers of the lattice, and planes of the world.
class Cuts {
  constructor(set, view, paints, wanted, inMiddle) {
    Object.assign(this, { set, view, paints, inMiddle });
    const axis = wanted.get("axis") ?? "k", named = "ijkxyz".includes(axis);
    byId("axis").value = named ? axis : "normal";
    if (!named) byId("normal").value = axis;
    byId("which").value = view instanceof FlatView ? "only" : wanted.get("which") ?? "upto";
    byId("which").disabled = view instanceof FlatView;
    for (const each of ["axis", "normal"]) byId(each).addEventListener("change", () => this.turn());
    for (const each of ["layer", "which", "by"]) byId(each).addEventListener("input", () => this.show());
    this.turn(wanted.get("layer") ?? wanted.get("offset"));
    byId("cut").disabled = false;
  }

  // Changes the direction. `offset` is a text, or absent.
  turn(offset) {
    const axis = byId("axis").value, layer = byId("layer"), towards = towardsOf(axis, byId("normal").value);
    byId("normal").hidden = axis !== "normal";
    byId("normal").setCustomValidity(towards === null ? "three numbers, such as 1,1,0" : "");
    if (towards === null) return byId("normal").reportValidity();
    const direction = (this.direction = new Direction(cells, this.set, towards));
    const { low, high } = direction, byLayer = direction.axis >= 0;
    Object.assign(layer, { min: low, max: high, step: byLayer ? 1 : "any" });
    const middle = byLayer ? Math.floor((low + high + 1) / 2) : (low + high) / 2;
    layer.value = offset ?? (this.inMiddle ? middle : high);
    this.show();
  }

  step(layers) {
    const layer = byId("layer"), { axis, thickness } = this.direction;
    layer.value = Number(layer.value) + layers * (axis >= 0 ? 1 : thickness / 2);
    this.show();
  }

  show() {
    const { direction } = this, offset = Number(byId("layer").value), axis = byId("axis").value;
    const cut = direction.cut(offset, byId("which").value === "only"), { layer, upTo } = direction.count(cut);
    byId("at").textContent = `${axis === "normal" ? "offset" : axis} = ${direction.axis >= 0 ? offset : brief(offset)}`;
    fill(byId("inlayer"), layer);
    byId("same").hidden = direction.axis < 0;
    byId("slice").textContent = `latvox slice --axis ${"xyz"[direction.axis]} --index ${offset}`;
    fill(byId("shown"), cut.only ? layer : upTo);
    this.view.show(this.paints(), cut, direction.keepsAll(cut));
  }
}

// The voxel at the pointer.
class Hover {
  constructor(canvas, view) {
    Object.assign(this, { view, values: readValues(), found: null });
    canvas.addEventListener("pointermove", (event) => this.look(event));
    canvas.addEventListener("pointerdown", (event) => this.look(event));
    canvas.addEventListener("pointerleave", () => this.show(null));
  }

  look({ offsetX, offsetY }) {
    this.at = [offsetX, offsetY];
    this.frame ??= requestAnimationFrame(() => {
      this.frame = undefined;
      this.show(this.view.pick(...this.at));
    });
  }

  // Returns names and values, in full.
  describe({ ijk, voxel }) {
    const world = cells.worldOf(ijk).map(String);
    return [["i, j, k", ijk.join()], ["x, y, z", world.join()], ...this.values.map(([name, of]) => [name, of(voxel)])];
  }

  show(found) {
    this.found = found;
    byId("hover").hidden = found === null;
    if (found === null) return;
    byId("hover").replaceChildren(...this.describe(found).map(([name, value]) => {
      const line = document.createElement("div"), swatch = document.createElement("span");
      line.append(`${name}  `, brief(value));
      if (name === "color") (swatch.className = "swatch"), (swatch.style.background = value), line.append(" ", swatch);
      return line;
    }));
  }

  copy() {
    if (this.found !== null) copy(this.describe(this.found).map(([name, value]) => `${name} = ${value}`).join("; "));
  }
}

// The picture has the background of the page.
function save(view, canvas) {
  view.drawFully();
  const copied = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  const context = copied.getContext("2d");
  context.fillStyle = getComputedStyle(document.body).backgroundColor;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(canvas, 0, 0);
  copied.toBlob((blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = `${data.title.replace(/\.vdb$/i, "")}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    say(`saved ${link.download}`);
  });
}

function useTools(view, canvas, cuts, hover) {
  const edges = () => {
    view.edges = !view.edges;
    byId("edges").setAttribute("aria-pressed", view.edges);
    view.change();
  };
  const help = () => (byId("help").open ? byId("help").close() : byId("help").showModal());
  const tools = { home: () => view.home(), save: () => save(view, canvas), edges, ask: help };
  for (const [name, use] of Object.entries(tools)) byId(name).addEventListener("click", use);
  const keys = {
    Home: tools.home, r: tools.home, s: tools.save, e: edges, "?": help, c: () => hover.copy(),
    ",": () => cuts.step(-1), ".": () => cuts.step(1), "+": () => view.zoom(0.8), "=": () => view.zoom(0.8), "-": () => view.zoom(1.25),
    ArrowLeft: () => view.move(-10, 0), ArrowRight: () => view.move(10, 0), ArrowUp: () => view.move(0, 10), ArrowDown: () => view.move(0, -10),
  };
  document.addEventListener("keydown", (event) => {
    const { key, ctrlKey, metaKey, altKey, target } = event;
    if (ctrlKey || metaKey || altKey || target.closest?.("input, select, #panel") || !Object.hasOwn(keys, key)) return;
    keys[key]();
    event.preventDefault();
  });
}

function start() {
  const wanted = new URLSearchParams(location.hash.slice(1)), set = readVoxels(), canvas = byId("canvas");
  fillPanel(set);
  const view = View.on(canvas, set) ?? new FlatView(canvas, set), isFlat = view instanceof FlatView;
  if (isFlat) tell("This browser has no WebGL 2, so the page shows one layer at a time.", true);
  byId("seen").hidden = isFlat;
  view.first = [Number(wanted.get("azimuth") ?? 30), Number(wanted.get("elevation") ?? 22)];
  view.resize();
  // A band begins cut in the middle, because its content is inside.
  const cuts = new Cuts(set, view, usePaints(wanted), wanted, data.band || isFlat);
  useTools(view, canvas, cuts, new Hover(canvas, view));
  view.home();
  return view;
}

let view = null;
try {
  view = start();
} catch (error) {
  tell(`The voxels cannot be drawn: ${error.message}. Their counts and their certificate are complete.`);
  document.body.dataset.busy = "no";
}
