// The data of the page, and the elements that show them. The data's format: see client/tool/view/page.h.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const cells = new Cells(data), steps = data.facets.map(({ step }) => step);

function bytesOf(id) {
  return Uint8Array.from(atob(byId(id).textContent), (c) => c.charCodeAt(0));
}

// Reads brick coordinates (int32, 3) and masks (8 words of 64 bits), little-endian, 76 bytes per brick.
function readVoxels() {
  const bytes = bytesOf("masks"), view = new DataView(bytes.buffer), set = new VoxelSet(data.low, data.high);
  for (let at = 0, voxel = 0; at < bytes.length; at += 76) {
    const rows = bytes.subarray(at + 12, at + 76);
    set.addBrick([0, 4, 8].map((n) => 8 * view.getInt32(at + n, true)), rows, voxel);
    for (const row of rows) voxel += BITS[row];
  }
  return set;
}

// Means that no link of the voxel is crossed: the number of its triangle. Its share is then NaN.
const UNCROSSED = 0xffffffff;

// Returns the values of each voxel: [name, a function from its number to text that copies in full].
function readValues() {
  const values = bytesOf("values"), colors = bytesOf("paints"), count = data.voxels;
  let at = 0;
  return data.paints.flatMap(({ name, values: kind, components }, n) => {
    if (kind === "none") return [];
    if (kind === "rgb") {
      const hex = (voxel) => [...colors.subarray(3 * (count * n + voxel), 3 * (count * n + voxel + 1))].map((level) => level.toString(16).padStart(2, "0"));
      return [[name, (voxel) => `#${hex(voxel).join("")}`]];
    }
    const from = at, view = new DataView(values.buffer), names = namesOf(name);
    at += 4 * count * components;
    const numberOf = kind === "float32" ? (word) => shortest(view.getFloat32(from + 4 * word, true)) : (word) => view.getUint32(from + 4 * word, true);
    const isNone = (number) => Number.isNaN(number) || number === UNCROSSED;
    const named = (number) => (isNone(number) ? "none" : names[number] ? `${number} (${names[number]})` : String(number));
    return [[name, (voxel) => Array.from({ length: components }, (_, m) => named(numberOf(components * voxel + m))).join()]];
  });
}

// Returns the names of parts or materials by their numbers, as far as the file has them.
function namesOf(attribute) {
  const found = data.metadata.find(([name]) => name === `${attribute}_names`);
  try {
    return JSON.parse(found?.[1] ?? "[]");
  } catch {
    return []; // of another program
  }
}

// Returns the number of fewest digits that is the same as a float32.
function shortest(number) {
  for (let digits = 1; digits < 9; ++digits) {
    const short = Number(number.toPrecision(digits));
    if (Math.fround(short) === number) return short;
  }
  return number;
}

// Returns numbers as people read them: separators between thousands, and six digits. Returns other text unchanged, and
// also a digest that happens to look like a number.
function brief(text) {
  const number = (word) => (/^-?\d/.test(word) && word.length <= 24 && Number.isFinite(Number(word)) ? Number(word) : null);
  const words = String(text).split(","), numbers = words.map(number);
  if (numbers.includes(null)) return String(text);
  const readable = (n) => (Number.isInteger(n) ? n.toLocaleString("en-US") : String(Number(n.toPrecision(6))));
  return numbers.map(readable).join(", ");
}

// Shows a value briefly. A click copies it in full.
function fill(element, value) {
  const button = document.createElement("button");
  button.className = "value";
  button.textContent = brief(value);
  button.title = `${value}\n(a click copies it)`;
  button.addEventListener("click", () => copy(String(value)));
  element.replaceChildren(button);
}

function copy(text) {
  const done = navigator.clipboard?.writeText(text) ?? Promise.reject(new Error("no clipboard"));
  done.then(() => say(`copied: ${text}`), () => say("The browser does not let this page copy."));
}

// Says something that is soon no longer of interest.
function say(what) {
  byId("said").textContent = what;
  clearTimeout(say.timer);
  say.timer = setTimeout(() => (byId("said").textContent = ""), 3000);
}

// `calm`: it is no error.
function tell(what, calm = false) {
  byId("error").hidden = what === "";
  byId("error").className = calm ? "quiet" : "";
  byId("error").textContent = what;
}
