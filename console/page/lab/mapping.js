// Says which numbers of which recordings are which signals: begins an experiment with
// them, or changes one. What they mean is guessed, read and checked by the server, as for `lab new`.

import { fill, make } from "../common/dom.js";
import { significant } from "../common/numbers.js";
import { getJson, work } from "../common/server.js";
import * as reading from "./reading.js";
import * as recordings from "./recordings.js";

/** Signals: key, what it is, whether it must be. */
const OF_JOINT = [
  ["position", "position", true],
  ["motor_torque", "motor torque (or force, current, voltage)", true],
  ["joint_torque", "joint torque sensor", false],
  ["temperature", "temperature", false],
  ["valid", "what counts, above 0.5", false],
];

/** The same with names by which a path is guessed: the command line has no contacts. */
const OF_CONTACT = [
  ["position", "place along the contour", true, [/measured_cp\.pose\.position\.x/, /place|along/, /position/, /^x/]],
  ["tangential_force", "tangential force, opposes motion to larger places", true, [/contact_cf\.wrench\.force\.x/, /tangential/, /^F_?T/i]],
  ["normal_force", "normal force, pushes the tip out", true, [/contact_cf\.wrench\.force\.z/, /normal/, /^F_?N/i]],
  ["temperature", "temperature", false, [/temperature/, /^temp/, /_degC$/]],
  ["valid", "what counts, above 0.5", false, []],
];

/** Forces on the tip are recorded; friction opposes motion. */
const turned = (key, path) => (key === "tangential_force" && /contact_cf\.wrench\.force\.x$/.test(path) ? `${path}.@negative` : path);

/** Words for a column in the list: what is in it. */
function described(column) {
  if (!column.numbers) return column.words ? `${column.name} (words)` : column.name;
  return `${column.name} (${significant(column.least)} … ${significant(column.greatest)}${column.missing ? `, ${column.missing} without a number` : ""})`;
}

/** What a form begins with: files of the list, an experiment that is mapped again, or a recording of ferntast's own. */
async function beginning({ files, again, known }) {
  const plain = { groups: files?.map((file) => ({ files: [file], held: false })), signals: {}, joint: null, inertia: null, gear: null, effects: new Set(["coulomb", "viscous", "contact_coulomb"]), columns: [], rate: null, join: null, kept: [], again: null, fixed: false, touched: new Set() };
  if (again) {
    const { mapping, kept, version } = await getJson("/api/lab/mapping", { path: again });
    return {
      ...plain, kept, fixed: true, again: { path: again, version }, signals: mapping.signals, joint: mapping.joint, columns: mapping.columns, rate: mapping.rate_hz, join: mapping.join,
      groups: [...mapping.recordings.map((own) => ({ files: own, held: false })), ...mapping.held_out.map((own) => ({ files: own, held: true }))],
      inertia: mapping.inertia === "fit" ? null : mapping.inertia.given, gear: mapping.gear_ratio, effects: new Set(mapping.effects),
      touched: new Set(["joint", "time", ...[...OF_JOINT, ...OF_CONTACT].map(([key]) => key)]),
    };
  }
  if (!known) return plain;
  const { time: _, ...signals } = known.signals;
  return {
    ...plain, joint: known.joint, inertia: known.inertia?.given ?? null, gear: known.gear_ratio, effects: new Set(known.effects.filter((effect) => typeof effect === "string")),
    signals: Object.fromEntries(Object.entries(signals).map(([key, column]) => [key, { column, unit: null, time: null }])), touched: new Set(["joint", ...Object.keys(signals)]),
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
  let looked = { columns: [], tables: false, named: true, questions: [], warnings: [], signals: [] };
  const hints = {};
  const side = make("div", { className: "reading", id: "reading", "aria-live": "polite" });
  const isContact = () => own.joint === "contact";
  const shown = () => (isContact() ? OF_CONTACT : OF_JOINT);
  const all = () => own.groups.flatMap((group) => group.files);

  // What the user says of one signal.
  const says = (key) => own.signals[key] ?? { column: "", unit: null, time: null };
  const say = (key, more) => { own.signals[key] = { ...says(key), ...more }; own.touched.add(key); };

  function plan() {
    const keys = [...shown().map(([key]) => key), ...Object.keys(own.signals).filter((key) => key.startsWith("extra."))];
    if (looked.tables && own.rate === null) keys.push("time");
    const signals = {};
    for (const key of keys) {
      const { column, unit, time } = says(key);
      if (column) signals[key] = { column: turned(key, column), unit: unit || null, time };
    }
    const of = (held) => own.groups.filter((group) => group.held === held).map((group) => group.files);
    return {
      path: name.value, again: own.again,
      mapping: {
        recordings: of(false), held_out: of(true), columns: own.columns, rate_hz: own.rate, join: own.join, joint: own.joint, signals,
        inertia: isContact() || inertia.value === "" ? "fit" : { given: Number(inertia.value) },
        gear_ratio: isContact() || gear.value === "" ? null : Number(gear.value), effects: [...own.effects].filter((id) => catalogue.some((effect) => effect.id === id && (effect.of === "contact") === isContact())),
      },
    };
  }

  const { ask: trial, stop } = reading.trials(side, () => {
    const asked = plan();
    const held = new Set(asked.mapping.held_out.map(([first]) => first));
    const columns = Object.fromEntries(Object.entries(asked.mapping.signals).map(([key, place]) => [key, place.column]));
    return { asked, held, columns };
  }, (found) => { doubt(found.doubts); replaced(found.changes); });

  let looks = 0;

  /** Files are looked at anew; what the user said stays, all else is guessed. */
  async function look() {
    const mine = ++looks;
    stop();
    trouble.hidden = true;
    reading.wait(side, all().join(", "));
    try {
      const found = await work("/api/lab/look", {
        files: recordings.together(own) ? all() : own.groups[0]?.files ?? [], of: own.again?.path ?? null, columns: own.columns, rate_hz: own.rate, join: own.join, joint: own.touched.has("joint") ? own.joint : null,
      });
      if (mine !== looks) return;
      looked = found;
      recordings.found(own, looked.recordings);
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
    for (const key of ["time", ...shown().map(([key]) => key)]) if (!own.touched.has(key)) delete own.signals[key];
    const taken = new Set();
    const take = (key, column, unit) => {
      if (own.touched.has(key)) return;
      own.signals[key] = { column, unit, time: null };
      taken.add(column);
    };
    for (const { signal, column, unit } of looked.signals) if (signal === "time" || !isContact()) take(signal, column, unit);
    if (!isContact()) return fitUnits();
    const paths = looked.columns.map((column) => column.name);
    for (const [key, , , patterns] of OF_CONTACT) {
      const found = patterns.map((pattern) => paths.find((path) => pattern.test(path) && !taken.has(path))).find(Boolean);
      if (found) take(key, found, units.contact[key]?.[0] ?? null);
    }
  }

  const name = make("input", { id: "experiment-name", type: "text", required: true, oninput: () => trial() });
  const [folder, stem] = split(own.again?.path ?? all()[0] ?? "");
  name.value = own.again?.path ?? `${folder}${stem}${start.known ? `-${start.known.title}` : ""}.toml`;
  const kind = make("select", { id: "joint-kind" }, [["revolute", "revolute (rad, Nm)"], ["prismatic", "prismatic (m, N)"], ["contact", "no joint, a contact (m, N)"]].map(([value, text]) => make("option", { value, textContent: text })));
  kind.onchange = () => { own.joint = kind.value; own.touched.add("joint"); fitUnits(); draw(); look(); };
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
  const complain = (error) => { trouble.textContent = error.message; trouble.hidden = false; };

  /** A unit of the old kind of joint gives way to the first of the new one. */
  function fitUnits() {
    for (const [key, place] of Object.entries(own.signals)) {
      const known = units[own.joint][key];
      if (place.unit && known?.length && !known.includes(place.unit)) own.signals[key] = { ...place, unit: known[0] };
    }
  }

  function choice(key, must) {
    const value = says(key).column;
    const paths = looked.columns.map((column) => column.name);
    const none = key === "time" ? "none: by the rate" : must ? "choose …" : "none";
    const select = make("select", { name: key, id: `signal-${key}`, required: must },
      make("option", { value: "", textContent: none }),
      looked.columns.map((column) => make("option", { value: column.name, textContent: described(column), selected: column.name === value })));
    if (value && !paths.includes(value)) select.append(make("option", { value, textContent: value, selected: true }));
    select.onchange = () => {
      const column = looked.columns.find((known) => known.name === select.value);
      const known = units[own.joint][key];
      const unit = known?.includes(column?.unit) ? column.unit : says(key).unit ?? known?.[0] ?? null;
      say(key, { column: select.value, unit });
      const menu = document.getElementById(`unit-${key}`);
      if (menu) menu.value = unit ?? "";
      if (key === "time") {
        if (select.value) [own.rate, rate.value] = [null, ""];
        draw();
      }
      trial();
    };
    return select;
  }

  function unitOf(key) {
    const known = units[own.joint][key];
    if (!known?.length) return null;
    const { column, unit } = says(key);
    // The guess leaves it open where it is not sure; an experiment file need not say it.
    const open = unit === "" ? "choose …" : unit === null ? (own.again && column ? `${known[0]}, not stated` : "unit") : null;
    const select = make("select", { id: `unit-${key}`, "aria-label": `unit of ${key.replaceAll("_", " ")}`, required: unit === "" && column !== "" },
      open ? make("option", { value: "", textContent: open, selected: true }) : null,
      known.map((text) => make("option", { value: text, textContent: text, selected: text === unit })));
    select.onchange = () => { say(key, { unit: select.value || null }); trial(); };
    return select;
  }

  function row(key, text, must) {
    hints[key] = make("div", { className: "wide hints", id: `hint-${key}` });
    return [make("label", { for: `signal-${key}` }, text), make("div", { className: "signal" }, choice(key, must), unitOf(key)), hints[key]];
  }

  /** Questions stay until they are answered; doubts come with what was read. */
  function doubt(doubts = []) {
    for (const [key, place] of Object.entries(hints)) {
      const { column, unit } = says(key);
      const asked = looked.questions.filter((question) => question.signal === key && (column === "" || unit === "") && !(key === "time" && own.rate !== null));
      const take = (column, unit) => make("button", { type: "button", textContent: unit ? `${column} in ${unit}` : column, onclick: () => { say(key, unit ? { column, unit } : { column }); draw(); trial(); } });
      const choices = (question) => question.choices.map((text) => {
        const at = text.lastIndexOf(":");
        return at > 0 && units[own.joint][key]?.includes(text.slice(at + 1)) ? take(text.slice(0, at), text.slice(at + 1)) : take(text, null);
      });
      const odd = doubts.filter((told) => told.signal === key && !asked.length);
      fill(place,
        asked.map((question) => make("p", { className: "note warning" }, `${question.why} `, choices(question))),
        odd.map((told) => make("p", { className: "note warning" }, `${told.text} `,
          units[own.joint][key]?.includes(told.unit) ? make("button", { type: "button", "data-unit": told.unit, textContent: `it is ${told.unit}`, onclick: () => { say(key, { unit: told.unit }); draw(); trial(); } }) : null)));
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
    const timed = looked.tables ? row("time", "time", false) : [];
    // In tables there is a time, or a rate.
    const byRate = looked.tables && !says("time").column;
    const extra = Object.keys(own.signals).filter((key) => key.startsWith("extra."));
    const tip = own.kept.includes("signals.tip");
    fill(rows,
      looked.named && !own.columns.length ? [] : [make("label", { for: "columns" }, "names of the columns", make("small", { className: "quiet", textContent: " in order" })), names],
      timed,
      byRate ? [make("label", { for: "rate" }, "rate", make("small", { className: "quiet", textContent: " [Hz]" })), rate] : [],
      shown().map(([key, text, must]) => row(key, text, must && !(tip && key === "position"))),
      extra.map((key) => row(key, key.slice("extra.".length), false)));
    for (const input of [inertia, gear]) input.disabled = isContact();
    fill(effects, make("legend", { className: "small quiet", textContent: "effects that the model has" }),
      catalogue.filter((effect) => (effect.of === "contact") === isContact()).map((effect) => make("label", { className: "check", title: effect.equation },
        make("input", { type: "checkbox", value: effect.id, checked: own.effects.has(effect.id), onchange: (event) => { own.effects[event.target.checked ? "add" : "delete"](effect.id); trial(); } }), effect.id.replaceAll("_", " "))));
    doubt();
  }

  const label = (id, text, unit) => make("label", { for: id }, text, unit ? make("small", { className: "quiet", textContent: ` ${unit}` }) : null);
  const form = make("form", { className: "form", id: "mapping" }, files, label("joint-kind", "joint"), kind, rows,
    label("inertia", "inertia", "[kg m² or kg], empty: fitted"), inertia, label("gear", "gear ratio", "[1]"), gear,
    effects, label("experiment-name", "experiment file"), name, changes,
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
