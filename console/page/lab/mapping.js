// Says which numbers of which recordings are which signals: begins an experiment with
// them, or changes one. What they mean is guessed, read and checked by the server, as for `lab new`.

import { fill, make } from "../common/dom.js";
import { words } from "../common/names.js";
import { getJson, work } from "../common/server.js";
import { urdfs } from "./files.js";
import * as reading from "./reading.js";
import * as recordings from "./recordings.js";
import * as signals from "./signals.js";
import * as subject from "./subject.js";

const EXTRA = "extra.";
const isExtra = ([key]) => key.startsWith(EXTRA);

/** What a form begins with: files of the list, an experiment that is mapped again, or a recording of ferntast's own. */
async function beginning({ files, again, known }) {
  const plain = {
    groups: files?.map((file) => ({ files: [file], held: false })), signals: {}, extras: [], joint: null, inertia: null, gear: null, effects: new Set(["coulomb", "viscous", "contact_coulomb"]),
    columns: [], rate: null, join: null, kept: [], again: null, fixed: false, touched: new Set(), ...subject.beginning(null),
  };
  if (again) {
    const { mapping, kept, version } = await getJson("/api/lab/mapping", { path: again });
    const all = Object.entries(mapping.signals);
    const own = {
      ...plain, kept, fixed: true, again: { path: again, version }, joint: mapping.arm ? "arm" : mapping.joint, columns: mapping.columns, rate: mapping.rate_hz, join: mapping.join,
      groups: [...mapping.recordings.map((own) => ({ files: own, held: false })), ...mapping.held_out.map((own) => ({ files: own, held: true }))],
      signals: Object.fromEntries(all.filter((entry) => !isExtra(entry))), extras: all.filter(isExtra).map(([key, place]) => ({ name: key.slice(EXTRA.length), ...place })),
      inertia: mapping.inertia === "fit" ? null : mapping.inertia.given, gear: mapping.gear_ratio, effects: new Set(mapping.effects), ...subject.beginning(mapping),
    };
    // What the file does not have is not guessed into it.
    own.touched = new Set(["joint", "time", ...subject.signals(own).map(([key]) => key), ...Object.keys(own.signals)]);
    return own;
  }
  if (!known) return plain;
  const { time: _, ...all } = known.signals;
  return {
    ...plain, joint: known.joint, inertia: known.inertia?.given ?? null, gear: known.gear_ratio, effects: new Set(known.effects.filter((effect) => typeof effect === "string")),
    signals: Object.fromEntries(Object.entries(all).map(([key, column]) => [key, { column, unit: null, time: null }])), touched: new Set(["joint", ...Object.keys(all)]),
  };
}

/** The file's name without its ending, and the folder that it lies in. */
function split(path) {
  const folder = path.includes("/") ? path.slice(0, path.lastIndexOf("/") + 1) : "";
  return [folder, path.slice(folder.length).replace(/\.(mcap|csv|tsv|txt|dat|npz|npy|mat)$/i, "")];
}

/**
 * Shows the form in `parent` and what is read in `side`. `start` has `files` of the list,
 * `again` (an experiment file) or `known` (a joint of a recording of ferntast's own).
 * `begun` is called with the experiment file that was written.
 */
export async function show(parent, start, begun) {
  const [catalogue, units, own] = await Promise.all([getJson("/api/lab/effects"), getJson("/api/lab/units"), beginning(start)]);
  let looked = { columns: [], tables: false, named: true, questions: [], warnings: [], signals: [], arm: null };
  const side = make("div", { className: "reading", id: "reading", "aria-live": "polite" });
  const isContact = () => own.joint === "contact";
  const isArm = () => own.joint === "arm";
  const shown = () => subject.signals(own);
  const all = () => own.groups.flatMap((group) => group.files);
  // Effects of the catalogue go with what they are of; others stand in the file that is mapped again.
  const others = [...own.effects].filter((id) => !catalogue.some((effect) => effect.id === id));
  const offered = () => catalogue.filter((effect) => (effect.of === "contact") === isContact()).map((effect) => effect.id).concat(isArm() ? others : []);

  // What the user says of one signal.
  const says = (key) => own.signals[key] ?? { column: "", unit: null, time: null };
  const say = (key, more) => {
    own.signals[key] = { ...says(key), ...more };
    own.touched.add(key);
    if (key === "time" && own.signals.time.column) [own.rate, rate.value] = [null, ""];
  };

  /** Units that a signal may have; those of an arm's joints are as the joints are. */
  function unitsOf(key) {
    const [role, joint] = key.split("@");
    if (joint) return looked.arm?.joints.find((known) => known.name === joint)?.units[role] ?? [];
    return units[isArm() ? "revolute" : own.joint]?.[role] ?? [];
  }

  function plan() {
    const keys = shown().map(([key]) => key);
    if (looked.tables && own.rate === null) keys.push("time");
    const places = [...keys.map((key) => [key, says(key)]), ...(isArm() ? [] : own.extras.filter((extra) => extra.name).map((extra) => [EXTRA + extra.name, extra]))];
    const stated = places.filter(([, place]) => place.column).map(([key, { column, unit, time }]) => [key, { column, unit: unit || null, time }]);
    const of = (held) => own.groups.filter((group) => group.held === held).map((group) => group.files);
    const simple = !isContact() && !isArm();
    const fits = offered();
    return {
      path: name.value, again: own.again,
      mapping: {
        recordings: of(false), held_out: of(true), columns: own.columns, rate_hz: own.rate, join: own.join, joint: isArm() ? looked.joint ?? "revolute" : own.joint, signals: Object.fromEntries(stated), ...subject.part(own),
        inertia: !simple || inertia.value === "" ? "fit" : { given: Number(inertia.value) }, gear_ratio: !simple || gear.value === "" ? null : Number(gear.value),
        effects: [...own.effects].filter((id) => fits.includes(id)),
      },
    };
  }

  const { ask: trial, stop } = reading.trials(side, () => {
    if (isArm() && !own.arm.joints.length) return { wanting: own.arm.urdf ? "the arm's joints" : "the arm's URDF" };
    const asked = plan();
    const held = new Set(asked.mapping.held_out.map(([first]) => first));
    const columns = Object.fromEntries(Object.entries(asked.mapping.signals).map(([key, place]) => [key, place.column]));
    return { asked, held, columns };
  }, (found) => { table.doubt(found.doubts); replaced(found.changes); });

  let looks = 0;

  /** Files are looked at anew; what the user said stays, all else is guessed. */
  async function look() {
    const mine = ++looks;
    stop();
    trouble.hidden = true;
    reading.wait(side, all().join(", "));
    try {
      const found = await work("/api/lab/look", {
        files: recordings.together(own) ? all() : own.groups[0]?.files ?? [], of: own.again?.path ?? null, columns: own.columns, rate_hz: own.rate, join: own.join, joint: own.touched.has("joint") && !isArm() ? own.joint : null,
        by_tip: isContact() && own.byTip, arm: isArm() && own.arm.urdf ? { urdf: own.arm.urdf, joints: own.arm.said ? own.arm.joints : [] } : null,
      });
      if (mine !== looks) return;
      looked = found;
      recordings.found(own, looked.recordings);
      subject.found(own, looked.arm);
    } catch (error) {
      if (mine !== looks) return;
      complain(error);
    }
    if (!own.touched.has("joint")) own.joint = looked.joint ?? own.joint ?? "revolute";
    guessed();
    draw();
    trial();
  }

  function guessed() {
    const keys = ["time", ...shown().map(([key]) => key)].filter((key) => !own.touched.has(key));
    for (const key of keys) delete own.signals[key];
    for (const { signal, column, unit } of looked.signals) if (keys.includes(signal)) own.signals[signal] = { column, unit, time: null };
    fitUnits();
  }

  const name = make("input", { id: "experiment-name", type: "text", required: true, oninput: () => trial() });
  const [folder, stem] = split(own.again?.path ?? all()[0] ?? "");
  name.value = own.again?.path ?? `${folder}${stem}${start.known ? `-${start.known.title}` : ""}.toml`;
  const kind = make("select", { id: "joint-kind" }, subject.KINDS.map(([value, text]) => make("option", { value, textContent: text })));
  kind.onchange = () => {
    own.joint = kind.value;
    own.touched.add("joint");
    const files = urdfs();
    if (isArm() && !own.arm.urdf && files.length === 1) [own.arm.urdf] = files;
    fitUnits();
    draw();
    look();
  };
  const number = (id, value, placeholder) => make("input", { id, type: "number", step: "any", min: 0, value: value ?? "", placeholder, oninput: () => trial() });
  const inertia = number("inertia", own.inertia, "fitted");
  const gear = number("gear", own.gear, "not known");
  const rate = number("rate", own.rate, "Hz");
  rate.oninput = null;
  rate.onchange = () => { own.rate = rate.value === "" ? null : Number(rate.value); look(); };
  const names = make("input", { id: "columns", type: "text", value: own.columns.join(","), placeholder: "t,q,i" });
  names.onchange = () => { own.columns = names.value.split(",").map((word) => word.trim()).filter(Boolean); look(); };
  const trouble = make("p", { className: "error wide", role: "alert", id: "mapping-trouble", hidden: true });
  const effects = make("fieldset", {});
  const files = make("fieldset", { className: "recordings" });
  const rows = make("div", { className: "contents" });
  const changes = make("div", { className: "wide", id: "changes" });
  const save = make("button", { className: "primary", type: "submit", id: "begin", textContent: "Begin" });
  const table = signals.rows({
    looked: () => looked, unitsOf, says, say, stated: Boolean(own.again), byRate: () => own.rate !== null, tried: () => trial(), drawn: () => draw(),
  });
  const complain = (error) => { trouble.textContent = error.message; trouble.hidden = false; };

  /** A unit of the old kind of joint gives way to the first of the new one. */
  function fitUnits() {
    for (const [key, place] of Object.entries(own.signals)) {
      const known = unitsOf(key);
      if (place.unit && known.length && !known.includes(place.unit)) own.signals[key] = { ...place, unit: known[0] };
    }
  }

  /** What is replaced in a file that is there is said before. */
  function replaced(list) {
    const over = own.again && name.value === own.again.path;
    save.textContent = over ? `Replace this in ${own.again.path}` : own.again ? `Write ${name.value}` : "Begin";
    save.disabled = Boolean(over) && !list.length;
    if (!own.again) return fill(changes);
    return fill(changes,
      make("p", { className: "small quiet", textContent: list.length ? (over ? `In ${own.again.path} this is replaced, all else stays:` : `A copy of ${own.again.path} with this replaced:`) : "Nothing is changed yet." }),
      list.map((change) => make("p", { className: "note", "data-change": change.key }, make("b", { textContent: `${change.key}: ` }), `${change.before || "nothing"} → ${change.after || "nothing"}`)),
      own.kept.length ? make("p", { className: "note", textContent: `Stays as it is: ${own.kept.join(", ")}${own.kept.includes("lineage") ? " (whose errors are those of the mapping before)" : ""}` }) : null);
  }

  function draw() {
    kind.value = own.joint;
    recordings.show(files, own, look, () => { draw(); trial(); });
    // In tables there is a time, or a rate.
    const byRate = looked.tables && !says("time").column;
    fill(rows,
      subject.rows(own, () => { draw(); look(); }, () => trial()),
      looked.named && !own.columns.length ? [] : [make("label", { for: "columns" }, "names of the columns", make("small", { className: "quiet", textContent: " in order" })), names],
      looked.tables ? table.row("time", "time", false) : [],
      byRate ? [make("label", { for: "rate" }, "rate", make("small", { className: "quiet", textContent: " [Hz]" })), rate] : [],
      shown().map(([key, text, must]) => table.row(key, text, must)),
      isArm() ? [] : signals.extra({ list: own.extras, columns: looked.columns, units: units.revolute.extra, drawn: draw, tried: () => trial() }),
      isContact() || isArm() ? [] : [label("inertia", "inertia", "[kg m² or kg], empty: fitted"), inertia, label("gear", "gear ratio", "[1]"), gear]);
    const equations = new Map(catalogue.map((effect) => [effect.id, effect.equation]));
    fill(effects, make("legend", { className: "small quiet", textContent: isArm() ? "effects that every joint has" : "effects that the model has" }),
      offered().map((id) => make("label", { className: "check", title: equations.get(id) ?? "" },
        make("input", { type: "checkbox", value: id, checked: own.effects.has(id), onchange: (event) => { own.effects[event.target.checked ? "add" : "delete"](id); trial(); } }), words(id))));
    table.doubt();
  }

  const label = (id, text, unit) => make("label", { for: id }, text, unit ? make("small", { className: "quiet", textContent: ` ${unit}` }) : null);
  const form = make("form", { className: "form", id: "mapping" }, files, label("joint-kind", "joint"), kind, rows, effects, label("experiment-name", "experiment file"), name, changes,
    make("div", { className: "wide row" }, save), trouble);
  form.onsubmit = async (event) => {
    event.preventDefault();
    trouble.hidden = true;
    // What stands in the form counts, also where a script has put it there.
    for (const select of form.querySelectorAll("select[name]")) if (select.value !== says(select.name).column) say(select.name, { column: select.value });
    save.disabled = true;
    try {
      const { path } = await work("/api/lab/start", plan());
      await begun(path);
    } catch (error) {
      complain(error);
    } finally {
      save.disabled = false;
    }
  };
  fill(parent,
    make("h1", { textContent: own.again ? `${own.again.path}: its signals` : all().length > 1 ? `${all().length} recordings` : all()[0] }),
    make("p", { className: "quiet", style: "margin:4px 0 14px", textContent: "Say which number is which signal. Nothing is written before it can be read." }),
    make("div", { className: "mapping" }, form, side));
  await look();
}
