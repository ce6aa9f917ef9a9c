// The list of experiments and recordings, and the place to drop one.

import { fill, make, toast } from "../common/dom.js";
import { bytes } from "../common/numbers.js";
import { getJson, sendFile } from "../common/server.js";

let listing = { files: [] };
let list = null;
let filter = null;
let title = null;
let chosen = null;
let open = () => {};

function ago(seconds) {
  const passed = Date.now() / 1000 - seconds;
  if (passed < 90) return "just now";
  if (passed < 5400) return `${Math.round(passed / 60)} min ago`;
  if (passed < 130000) return `${Math.round(passed / 3600)} h ago`;
  return new Date(seconds * 1000).toISOString().slice(0, 10);
}

function show() {
  const words = filter.value.toLowerCase();
  const fits = listing.files.filter((file) => file.path.toLowerCase().includes(words));
  const group = (kind, name) => {
    const files = fits.filter((file) => file.kind === kind);
    if (!files.length) return [];
    return [make("h3", { textContent: name }), ...files.map((file) =>
      make("button", { type: "button", onclick: () => open(file), "aria-current": file.path === chosen ? "true" : null, "data-path": file.path },
        file.path, make("small", { textContent: `${kind === "recording" ? `${bytes(file.size)}, ` : ""}${ago(file.changed)}` })))];
  };
  const shown = [...group("experiment", "Experiments"), ...group("recording", "Recordings")];
  if (!shown.length) shown.push(make("p", { className: "small quiet", style: "padding:10px", textContent: words ? "Nothing of that name." : "No experiments or recordings here." }));
  if (listing.more) shown.push(make("p", { className: "small quiet", style: "padding:10px", textContent: "More files than are listed." }));
  fill(list, shown);
}

/** Marks the file that is open. */
export function mark(path) {
  chosen = path;
  show();
}

/** The file of that path. */
export function find(path) {
  return listing.files.find((file) => file.path === path);
}

/** Paths of all recordings. */
export function recordings() {
  return listing.files.filter((file) => file.kind === "recording").map((file) => file.path);
}

/** Paths of all arms that an experiment can be about. */
export function urdfs() {
  return listing.files.filter((file) => file.kind === "urdf").map((file) => file.path);
}

/** Reads the list anew. */
export async function load() {
  try {
    listing = await getJson("/api/lab/files");
    title.textContent = listing.folder;
  } catch (error) {
    toast(error.message);
  }
  show();
}

/** Several at once are sessions of one joint, or parts of one run. */
async function take(files) {
  const taken = [];
  for (const file of files) {
    toast(`${file.name} is on its way …`, 60);
    try {
      const { path } = await sendFile("/api/lab/upload", { name: file.name }, file);
      taken.push(path);
    } catch (error) {
      toast(error.message, 10);
    }
  }
  if (!taken.length) return;
  if (taken.length === files.length) toast(`${taken.join(", ")}: in the lab's folder.`);
  await load();
  open({ path: taken[0], paths: taken, kind: "recording" });
}

/** Makes the list in `parent`; `opened` is called with the file chosen. */
export function build(parent, opened) {
  open = opened;
  list = make("div", { className: "list" });
  title = make("span", {});
  filter = make("input", { type: "text", placeholder: "filter", "aria-label": "Filter files", oninput: show });
  const pick = make("input", { type: "file", multiple: true, accept: ".mcap,.csv,.tsv,.txt,.dat,.npz,.npy,.mat", onchange: () => take(pick.files) });
  const drop = make("label", { className: "drop" }, "Drop recordings here, or choose some (.mcap, .csv, .npz, .mat, …)", pick);
  for (const target of [drop, document.getElementById("lab")]) {
    target.addEventListener("dragover", (event) => { event.preventDefault(); drop.classList.add("over"); });
    target.addEventListener("dragleave", () => drop.classList.remove("over"));
    target.addEventListener("drop", (event) => {
      event.preventDefault();
      event.stopPropagation();
      drop.classList.remove("over");
      take(event.dataTransfer.files);
    });
  }
  fill(parent,
    make("header", {},
      make("div", { className: "row" }, make("h2", { className: "grow" }, title), make("button", { className: "bare", type: "button", textContent: "refresh", onclick: load })),
      filter),
    list, drop);
}
