// Says which numbers of a recording are which signals, and begins an experiment with them.

import { fill, make } from "../common/dom.js";
import { getJson, work } from "../common/server.js";

/** Signals: name, what it is, unit, whether it must be, words by which a path is guessed. */
const OF_JOINT = [
  ["position", "position", "rad or m", true, [/position/, /^q(_m)?$/, /^pos/, /_q$/]],
  ["motor_torque", "motor torque", "Nm or N, joint side", true, [/motor.*(effort|torque)/, /^tau_m/, /effort/, /current/, /torque/, /force/, /^f/]],
  ["joint_torque", "joint torque sensor", "Nm or N", false, [/measured_js\.effort/, /^tau$/, /joint.*torque/]],
  ["temperature", "temperature", "°C", false, [/temperature/, /^temp/, /_degC$/]],
];

const OF_CONTACT = [
  ["position", "place along the contour", "m", true, [/measured_cp\.pose\.position\.x/, /place|along/, /position/, /^x/]],
  ["tangential_force", "tangential force", "N, opposes motion to larger places", true, [/contact_cf\.wrench\.force\.x/, /tangential/, /^F_?T/i]],
  ["normal_force", "normal force", "N, pushes the tip out", true, [/contact_cf\.wrench\.force\.z/, /normal/, /^F_?N/i]],
  ["temperature", "temperature", "°C", false, [/temperature/, /^temp/, /_degC$/]],
];

/** Forces on the tip are recorded; friction opposes motion. */
const turned = (name, path) => (name === "tangential_force" && /contact_cf\.wrench\.force\.x$/.test(path) ? `${path}.@negative` : path);

function guess(paths, patterns, taken) {
  for (const pattern of patterns) {
    const found = paths.find((path) => pattern.test(path) && !taken.has(path));
    if (found) return found;
  }
  return "";
}

function choice(name, paths, value, must) {
  const select = make("select", { name, id: `signal-${name}`, required: must },
    make("option", { value: "", textContent: must ? "choose …" : "none" }),
    paths.map((path) => make("option", { value: path, textContent: path, selected: path === value })));
  if (value && !paths.includes(value)) select.append(make("option", { value, textContent: value, selected: true }));
  return select;
}

/**
 * Shows the form in `parent`. `offered` are the recording's own paths; `known`
 * what a recording of ferntast's own is already taken for. `begun` is called
 * with the experiment file that was written.
 */
export async function show(parent, entry, offered, begun, known = null) {
  const catalogue = await getJson("/api/lab/effects");
  offered ??= await getJson("/api/lab/offered", { path: entry.path });
  const paths = offered.paths;
  const signalsOf = (kind) => {
    const taken = new Set(offered.time ? [offered.time] : []);
    return (kind === "contact" ? OF_CONTACT : OF_JOINT).flatMap(([name, text, unit, must, patterns]) => {
      const value = known ? known.signals[name] || "" : guess(paths, patterns, must ? taken : new Set([...taken, ...paths.filter((path) => !patterns[0].test(path))]));
      if (value) taken.add(value);
      return [make("label", { for: `signal-${name}` }, text, make("small", { className: "quiet", textContent: ` [${unit}]` })), choice(name, paths, value, must)];
    });
  };
  const isCsv = entry.path.toLowerCase().endsWith(".csv");
  const time = isCsv ? [make("label", { for: "signal-time" }, "time", make("small", { className: "quiet", textContent: " [s]" })), choice("time", paths, offered.time, true)] : [];
  const kind = make("select", { id: "joint-kind" }, make("option", { value: "revolute", textContent: "revolute (rad, Nm)" }), make("option", { value: "prismatic", textContent: "prismatic (m, N)", selected: known?.joint === "prismatic" }),
    make("option", { value: "contact", textContent: "no joint, a contact (m, N)", selected: known?.joint === "contact" }));
  const given = known?.inertia?.given;
  const inertia = make("input", { id: "inertia", type: "number", step: "any", min: 0, value: given ?? "", placeholder: "fitted", "aria-describedby": "inertia-note" });
  const ratio = make("input", { id: "gear", type: "number", step: "any", min: 0, value: known?.gear_ratio ?? "", placeholder: "not known" });
  const used = new Set(known ? known.effects.filter((effect) => typeof effect === "string") : ["coulomb", "viscous", "contact_coulomb"]);
  const effects = make("fieldset", {});
  const effectsOf = (kind) => fill(effects, make("legend", { className: "small quiet", textContent: "effects that the model has" }),
    catalogue.filter((effect) => (effect.of === "contact") === (kind === "contact")).map((effect) => make("label", { className: "check", title: effect.equation }, make("input", { type: "checkbox", value: effect.id, checked: used.has(effect.id) }), effect.id.replaceAll("_", " "))));
  const folder = entry.path.includes("/") ? `${entry.path.slice(0, entry.path.lastIndexOf("/"))}/` : "";
  const stem = entry.path.slice(folder.length).replace(/\.(mcap|csv)$/i, "");
  const name = make("input", { id: "experiment-name", type: "text", required: true, value: `${folder}${stem}${known ? `-${known.title}` : ""}.toml` });
  const trouble = make("p", { className: "error wide", role: "alert", hidden: true });
  const rows = make("div", { style: "display:contents" });
  const form = make("form", { className: "form" }, rows, time,
    make("label", { for: "joint-kind", textContent: "joint" }), kind,
    make("label", { for: "inertia" }, "inertia", make("small", { id: "inertia-note", className: "quiet", textContent: " [kg m² or kg], empty: fitted" })), inertia,
    make("label", { for: "gear" }, "gear ratio", make("small", { className: "quiet", textContent: " [1]" })), ratio,
    effects,
    make("label", { for: "experiment-name", textContent: "experiment file" }), name,
    make("div", { className: "wide row" }, make("button", { className: "primary", type: "submit", id: "begin", textContent: "Begin" })), trouble);
  const ofKind = () => {
    fill(rows, signalsOf(kind.value));
    effectsOf(kind.value);
    for (const input of [inertia, ratio]) input.disabled = kind.value === "contact";
  };
  kind.onchange = ofKind;
  ofKind();
  form.onsubmit = async (event) => {
    event.preventDefault();
    trouble.hidden = true;
    const signals = {};
    for (const select of form.querySelectorAll("select[name]")) if (select.value) signals[select.name] = turned(select.name, select.value);
    const up = "../".repeat(name.value.split("/").length - 1);
    const experiment = {
      recordings: [`${up}${entry.path}`], signals, joint: kind.value,
      inertia: inertia.value === "" ? "fit" : { given: Number(inertia.value) },
      gear_ratio: ratio.value === "" || kind.value === "contact" ? null : Number(ratio.value),
      effects: [...effects.querySelectorAll("input:checked")].map((box) => box.value),
    };
    try {
      const { path } = await work("/api/lab/start", { path: name.value, experiment });
      begun(path);
    } catch (error) {
      trouble.textContent = error.message;
      trouble.hidden = false;
    }
  };
  fill(parent,
    make("h1", { textContent: entry.path }),
    make("p", { className: "quiet", style: "margin:4px 0 14px", textContent: `${paths.length} numbers are in this recording. Say which is which.` }),
    form);
}
