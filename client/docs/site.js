// The menu of narrow screens, and the search. The index of the search is loaded when the search is first used.

const menu = document.getElementById("menu");
const search = document.getElementById("search");
const results = document.getElementById("results");
const MOST = 30; // results

menu.addEventListener("click", () => {
  const open = document.body.classList.toggle("open");
  menu.setAttribute("aria-expanded", open);
});

let loading = null;

// Returns a promise that is kept when SECTIONS is there.
function load() {
  loading ||= new Promise((done) => {
    const script = document.createElement("script");
    script.src = "search_index.js";
    script.onload = done;
    document.head.append(script);
  });
  return loading;
}

// Returns how well a section answers the words; 0: not at all.
function score([, title, heading, text], words) {
  let sum = 0;
  for (const word of words) {
    const places = [title, heading, text].map((place) => place.toLowerCase().split(word).length - 1);
    if (places.every((count) => count === 0)) return 0;
    sum += (places[0] ? 20 : 0) + (places[1] ? 40 : 0) + Math.min(places[2], 10);
    if ([title, heading].some((place) => place.toLowerCase() === word)) sum += 100;
  }
  return sum;
}

// Returns the part of the text around the first of the words.
function excerpt(text, words) {
  const found = words.map((word) => text.toLowerCase().indexOf(word)).filter((place) => place >= 0);
  const from = Math.max(0, Math.min(...found, text.length) - 40);
  return (from > 0 ? "…" : "") + text.slice(from, from + 140);
}

function row([address, title, heading, text], words) {
  const link = document.createElement("a");
  const name = document.createElement("b");
  link.href = address;
  name.textContent = heading && heading !== title ? `${title}: ${heading}` : title;
  link.append(name, document.createElement("br"), excerpt(text, words));
  return link;
}

async function show() {
  const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
  results.hidden = words.length === 0;
  if (results.hidden) return;
  await load();
  // SECTIONS begins with the pages for users, which count up to twice as much as those at its end.
  const weighed = SECTIONS.map((section, n) => [score(section, words) * (1 - n / SECTIONS.length / 2), section]);
  const found = weighed.filter(([sum]) => sum > 0);
  found.sort(([a], [b]) => b - a);
  results.replaceChildren(...found.slice(0, MOST).map(([, section]) => row(section, words)));
  if (found.length === 0) results.textContent = "Nothing found.";
}

function close() {
  results.hidden = true;
}

search.addEventListener("focus", load);
search.addEventListener("input", show);
search.addEventListener("keydown", (event) => {
  if (event.key === "Escape") close();
  if (event.key === "Enter") results.querySelector("a")?.click();
});
results.addEventListener("click", close);
document.addEventListener("keydown", (event) => {
  if (event.key !== "/" || document.activeElement === search) return;
  event.preventDefault();
  search.focus();
});
document.addEventListener("click", (event) => {
  if (!event.target.closest("#bar")) close();
});

const toc = document.querySelector("details.toc");
if (toc && innerWidth > 800) toc.open = true;
document.querySelector("[aria-current]")?.scrollIntoView({ block: "nearest" });
