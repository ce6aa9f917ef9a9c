// The recordings of an experiment: sessions or parts of one run, fitted or held out.

import { fill, make } from "../common/dom.js";
import { recordings } from "./files.js";

const plain = (groups) => groups.length < 2 || groups.every((group) => group.files.length === 1);

/** Whether the files are taken as they are found: no experiment file says otherwise, nor is one joined while others are not. */
export function together({ fixed, groups }) {
  return !fixed && plain(groups);
}

/** Takes over which files the server found to be one recording; what is held out stays so. */
export function found(own, lists) {
  if (!together(own)) return;
  const held = new Set(own.groups.filter((group) => group.held).flatMap((group) => group.files));
  own.groups = lists.map((files) => ({ files, held: lists.length > 1 && files.every((file) => held.has(file)) }));
}

/** Shows them in `parent`. `look` is called when files are others, `told` when what is held out is. */
export function show(parent, own, look, told) {
  const used = new Set(own.groups.flatMap((group) => group.files));
  const several = own.groups.length > 1;
  const drop = (group) => { own.groups = own.groups.filter((other) => other !== group); look(); };
  const rows = own.groups.map((group, number) => {
    const text = group.files.join(" + ");
    const part = make("select", { id: `part-${number}`, "aria-label": `use of ${text}` },
      make("option", { value: "", textContent: "fitted" }), make("option", { value: "held", textContent: "held out", selected: group.held }));
    part.onchange = () => { group.held = part.value === "held"; told(); };
    return make("div", { className: "recording", "data-recording": text }, make("span", { textContent: text }),
      several ? part : null, several ? make("button", { type: "button", className: "bare", textContent: "leave out", "aria-label": `Leave out ${text}`, onclick: () => drop(group) }) : null);
  });
  const more = make("select", { id: "add-recording", "aria-label": "Recording to add" }, make("option", { value: "", textContent: "add a recording …" }),
    recordings().filter((path) => !used.has(path)).map((path) => make("option", { value: path, textContent: path })));
  more.onchange = () => { own.groups = [...own.groups, { files: [more.value], held: false }]; look(); };
  const joined = own.groups.length === 1 && used.size > 1;
  const how = make("select", { id: "together", "aria-label": "What the files are together" },
    [["", joined && !own.join ? "parts of one run, as found" : "sessions, one a file, as found"], ["time", "parts of one run, joined by time"], ["row", "parts of one run, joined row by row"]]
      .map(([value, text]) => make("option", { value, textContent: text, selected: value === (own.join ?? "") })));
  how.onchange = () => {
    own.join = how.value || null;
    own.fixed = false;
    own.groups = [...used].map((file) => ({ files: [file], held: false }));
    look();
  };
  fill(parent, make("legend", { className: "small quiet", textContent: "recordings" }), rows, make("div", { className: "row" }, more, used.size > 1 && plain(own.groups) ? how : null));
}
