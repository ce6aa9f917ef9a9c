// The lab: files at the left, the work on one of them at the right.

import { byId, fill, make, toast } from "../common/dom.js";
import { getJson, work } from "../common/server.js";
import * as arm from "./arm.js";
import { prepare } from "./charts.js";
import * as files from "./files.js";
import * as findings from "./findings.js";
import * as formulas from "./formulas.js";
import * as mapping from "./mapping.js";
import * as model from "./model.js";

/**
 * What is open: { path, joint, whole (the arm in place of a joint), view (of the server), results (of the
 * comparison), before (those of the model that was added to), diagnosis, discovery }.
 */
const state = { path: null, joint: 0, whole: false, view: null, results: null, before: null, diagnosis: null, discovery: null, busy: false };
let place = null;
let side = null;

const sections = {};

function busy(text, share = null) {
  state.busy = text !== null;
  fill(sections.progress, text === null ? null : [
    make("p", { className: "small quiet", textContent: text, style: "margin-bottom:6px" }),
    make("progress", share === null ? { "aria-label": text } : { max: 1, value: share, "aria-label": text })]);
  sections.progress.hidden = text === null;
  place.setAttribute("aria-busy", String(state.busy));
  model.enable(!state.busy);
}

/** Does something that takes long; what goes wrong is told. Gives null then. */
async function long(text, path, body) {
  if (state.busy) return null;
  busy(text);
  try {
    return await work(path, body, (share) => busy(text, share));
  } catch (error) {
    fill(sections.trouble, make("p", { className: "error", role: "alert", textContent: error.message }));
    sections.trouble.hidden = false;
    return null;
  } finally {
    busy(null);
  }
}

function frame() {
  for (const name of ["head", "trouble", "progress", "diagnosis", "discovery", "charts"]) {
    sections[name] = make(name === "charts" ? "div" : "section", { className: name === "charts" ? "work" : "panel", id: `lab-${name}`, hidden: true });
  }
  fill(place, Object.values(sections));
}

/** Opens a file of the list: an experiment, or a recording. Of an arm the whole, if no joint is said. */
async function open(entry, joint = null, before = null) {
  if (state.busy) return;
  Object.assign(state, { path: entry.path, joint: joint ?? 0, whole: false, view: null, results: null, before, diagnosis: null, discovery: null });
  files.mark(entry.path);
  frame();
  busy(`Reading ${entry.path} …`);
  try {
    if (entry.kind === "recording") {
      const offered = await getJson("/api/lab/offered", { path: entry.path });
      if (!offered.own) {
        busy(null);
        sections.head.hidden = false;
        await map({ files: entry.paths ?? [entry.path] });
        return;
      }
    }
    state.view = await getJson("/api/lab/open", { path: entry.path });
    state.whole = state.view.arm !== null && joint === null;
  } catch (error) {
    fill(sections.trouble, make("p", { className: "error", role: "alert", textContent: error.message }),
      entry.kind === "experiment" ? make("button", { type: "button", id: "again", textContent: "Map its signals again", onclick: again }) : null);
    sections.trouble.hidden = false;
    busy(null);
    return;
  }
  busy(null);
  history.replaceState(null, "", `#lab/${encodeURIComponent(entry.path)}`);
  sections.head.hidden = false;
  (state.whole ? arm : model).show(sections.head, state, actions);
  await compare();
}

/** An experiment file was written: the list knows it, and it is opened. */
async function begun(path, joint = null, before = null) {
  await files.load();
  await open({ path, kind: "experiment" }, joint, before);
}

const target = () => ({ path: state.path, joint: state.joint });

/** What is shown, as `open` takes it. */
const shown = () => (state.whole ? null : state.joint);

async function compare() {
  const results = await long("Holding the model against the recording …", state.whole ? "/api/lab/compare_arm" : "/api/lab/compare", target());
  if (!results) return;
  state.results = results;
  if (state.whole) {
    arm.figures(state, actions);
    return;
  }
  model.figures(state);
  sections.charts.hidden = false;
  await findings.charts(sections.charts, state, actions);
}

async function diagnose() {
  const diagnosis = await long("Trying every effect of the catalogue …", state.whole ? "/api/lab/diagnose_arm" : "/api/lab/diagnose", target());
  if (!diagnosis) return null;
  state.diagnosis = diagnosis;
  sections.diagnosis.hidden = false;
  (state.whole ? arm : findings).diagnosis(sections.diagnosis, state, actions);
  if (state.whole) arm.figures(state, actions);
  return diagnosis;
}

async function discover() {
  const discovery = await long("Searching for a formula …", "/api/lab/discover", target());
  if (!discovery) return;
  state.discovery = discovery;
  sections.discovery.hidden = false;
  await formulas.show(sections.discovery, state, actions);
}

async function add(effect, bounds = []) {
  sections.trouble.hidden = true;
  const done = await long(`Adding ${effect} and fitting again …`, "/api/lab/add", { ...target(), effect, bounds, of_arm: state.whole });
  if (!done) return false;
  const { held_out_before: before, held_out_after: after, joint } = done.added;
  toast(`${done.added.effect}${joint ? ` of ${joint}` : ""}: error on data held out ${after < before ? "falls" : "rises"} by ${Math.abs((1 - after / before) * 100).toFixed(1)} %`);
  await begun(done.path, shown(), state.results);
  return true;
}

async function auto() {
  for (let step = 0; step < (state.whole ? 12 : 8); step++) {
    const diagnosis = await diagnose();
    const best = diagnosis?.candidates[0];
    if (!best || diagnosis.verdict !== "missing") return;
    if (!(await add(state.whole ? diagnosis.names[0] : best.effect))) return;
  }
}

function undo() {
  const steps = state.view.history;
  const parent = steps[steps.length - 2];
  if (parent) actions.open(parent.path);
}

async function report() {
  const done = await long("Writing the report …", "/api/lab/report", target());
  if (!done) return;
  const address = URL.createObjectURL(new Blob([done.html], { type: "text/html" }));
  const name = state.path.split("/").pop().replace(/\.[a-z]+$/, "");
  make("a", { href: address, download: `${name}-report.html` }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000);
  toast("The report is saved by your browser.");
}

/** The form for signals in place of all else. */
async function map(start) {
  if (state.busy) return;
  frame();
  sections.head.hidden = false;
  try {
    await mapping.show(sections.head, start, begun);
  } catch (error) {
    fill(sections.trouble, make("p", { className: "error", role: "alert", textContent: error.message }));
    sections.trouble.hidden = false;
  }
}

/** The experiment that is open, with its signals mapped again. */
const again = () => map({ again: state.path });

/** A recording of ours as a start for an experiment file of its own. */
const own = () => map({ files: [state.path], known: state.view.joints[state.joint] });

const actions = {
  diagnose, discover, add, auto, undo, report, own, again,
  joint: (number) => open({ path: state.path, kind: "experiment" }, number),
  whole: () => open({ path: state.path, kind: "experiment" }),
  open: (path) => open({ path, kind: "experiment" }, shown()),
};

/** Starts the lab. */
export async function start() {
  prepare();
  place = make("div", { className: "work" });
  side = make("aside", { className: "files panel", "aria-label": "Files" });
  fill(byId("lab"), side, place);
  fill(place, make("section", { className: "panel" },
    make("h1", { textContent: "Where is the model off, and what does it lack?" }),
    make("p", { className: "quiet", style: "margin-top:8px;max-width:66ch",
      textContent: "Open an experiment at the left, or a recording of a session. Any other recording (rosbag2, MCAP, tables) is asked for its signals first. Every step writes a new experiment file beside the old one; only mapping signals again replaces what is in a file, and says before what that is." })));
  files.build(side, open);
  await files.load();
  const [, asked] = location.hash.split("/");
  const entry = asked && files.find(decodeURIComponent(asked));
  if (entry) open(entry);
}
