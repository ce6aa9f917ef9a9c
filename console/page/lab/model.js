// The head of an experiment: its model, its errors, what can be done.

import { fill, make } from "../common/dom.js";
import { words } from "../common/names.js";
import { percent, significant } from "../common/numbers.js";
import { getJson } from "../common/server.js";

let parts = {};

/** Lets buttons be pressed, or not while work goes on. */
export function enable(on) {
  for (const button of document.querySelectorAll("#lab .work button")) button.disabled = !on;
}

const nameOf = (effect) => (typeof effect === "string" ? effect : effect.name);

function inertia(joint) {
  if (joint.joint === "contact") return "a contact";
  const unit = joint.joint === "prismatic" ? "kg" : "kg m²";
  return joint.inertia === "fit" ? "inertia fitted" : `inertia ${significant(joint.inertia.given)} ${unit}`;
}

/** A number with what it is. */
export function figure(value, text) {
  return make("div", { className: "figure" }, make("b", { textContent: value }), make("small", { textContent: text }));
}

/** Shows the errors of the model. */
export function figures({ results, view, joint }) {
  const { comparison: c } = results;
  const { unit } = view.joints[joint];
  fill(parts.figures,
    figure(`${significant(c.rms.held_out)} ${unit}`, `error on data held out (${percent(c.relative_error_held_out)} of what is measured)`),
    figure(`${significant(c.rms.train)} ${unit}`, `error on data fitted (${percent(c.relative_error)})`),
    figure(c.noise.repeats === null ? "–" : `${significant(c.noise.repeats)} ${unit}`, "noise between repeats: no model gets below it"),
    figure(percent(c.used.share), `of ${c.used.samples.toLocaleString("en")} samples used; errors by ${c.held_out_by} left out`));
  const [slowest, fastest] = c.used.speed_range ?? [null, null];
  fill(parts.used,
    make("summary", { textContent: "What the verdict rests on" }),
    results.left_out.map(([reason, share]) => make("p", { className: "note", textContent: `${percent(share)} left out: ${reason}` })),
    make("p", { className: "note", textContent: `speeds that remain: ${significant(slowest)} … ${significant(fastest)} ${c.used.speed_unit}` }),
    make("p", { className: "note", textContent: `cut-off of the filter: ${significant(c.used.cutoff_hz)} Hz, ${c.used.cutoff_reason}` }),
    make("p", { className: "note", textContent: `condition of the normal equations: ${significant(c.condition)}` }));
  fill(parts.warnings, results.warnings.map((text) => make("p", { className: "note warning", textContent: text })));
}

function ownEffect(actions, isContact) {
  const signals = isContact ? "r, rd, rdd, F_N, F_T, T, t" : "q, qd, qdd, tau, tau_m, T, t";
  const name = make("input", { type: "text", required: true, id: "own-name", placeholder: "cogging", pattern: "[a-z][a-z0-9_]*" });
  const expression = make("input", { type: "text", required: true, id: "own-expression", placeholder: "a*sin(6*q) + b*cos(6*q)" });
  const bounds = make("input", { type: "text", id: "own-bounds", placeholder: "vs=0.005,0.2   (only of parameters that are searched)" });
  const form = make("form", { className: "form", style: "margin-top:10px" },
    make("label", { for: "own-name", textContent: "name" }), name,
    make("label", { for: "own-expression" }, "expression", make("small", { className: "quiet", textContent: " [Nm or N]" })), expression,
    make("label", { for: "own-bounds", textContent: "bounds" }), bounds,
    make("p", { className: "wide small quiet", textContent: `Over ${signals} and extra signals. Other names are parameters: fitted where they enter linearly, searched where bounds are given.` }),
    make("div", { className: "wide row" }, make("button", { type: "submit", id: "own-add", textContent: "Add this effect" })));
  form.onsubmit = (event) => {
    event.preventDefault();
    actions.add(`${name.value}=${expression.value}`, bounds.value.trim() ? bounds.value.trim().split(/[\s;]+/) : []);
  };
  return make("details", {}, make("summary", { textContent: "An effect of your own" }), form);
}

async function catalogue(select, effects, isContact) {
  const has = new Set(effects.map(nameOf));
  for (const effect of await getJson("/api/lab/effects")) {
    if (!has.has(effect.id) && (effect.of === "contact") === isContact) select.append(make("option", { value: effect.id, textContent: words(effect.id), title: effect.equation }));
  }
}

const act = (text, id, onclick, more = {}) => make("button", { type: "button", id, textContent: text, onclick, ...more });

/** The line with what is open, where its data are from, and buttons for what can be done with it. */
export function headline(title, { view, whole }, data, actions) {
  const isFile = view.history.length > 0;
  return make("div", { className: "headline" },
    make("div", {}, title, make("p", { className: "quiet small", textContent: data })),
    make("div", { className: "row" },
      act("Diagnose", "diagnose", actions.diagnose, { className: "primary" }),
      isFile ? act("Add until complete", "auto", actions.auto) : act("Write an experiment file", "own", actions.own),
      isFile ? act("Map its signals again", "again", actions.again) : null,
      view.history.length > 1 ? act("Undo", "undo", actions.undo, { title: `Back to ${view.history.at(-2).path}` }) : null,
      whole ? null : act("Report", "report", actions.report)));
}

/** Where a joint's data are from. */
export const dataOf = (own) => `${own.sessions.length} session${own.sessions.length === 1 ? "" : "s"} of ${own.recordings.join(", ")}`;

/** Buttons for each joint, and for the arm as a whole; nothing where there is one joint alone. */
export function tabs({ view, joint, whole }, actions) {
  if (view.joints.length < 2) return null;
  return make("div", { className: "row", style: "margin-top:10px" },
    view.arm ? act("whole arm", "whole-arm", actions.whole, { "aria-pressed": String(whole) }) : null,
    view.joints.map((other, number) => act(words(other.title), `joint-${number}`, () => actions.joint(number), { "aria-pressed": String(!whole && number === joint) })));
}

/** Shows the experiment in `parent`. */
export function show(parent, state, actions) {
  const { view, joint, path } = state;
  const own = view.joints[joint];
  const isFile = view.history.length > 0;
  const added = view.history[view.history.length - 1]?.added;
  const select = make("select", { id: "add-effect", "aria-label": "Effect to add" }, make("option", { value: "", textContent: "add an effect of the catalogue …" }));
  select.onchange = () => { if (select.value) actions.add(select.value); };
  catalogue(select, own.effects, own.joint === "contact");
  parts = { figures: make("div", { className: "figures" }), used: make("details", { id: "used" }), warnings: make("div", { id: "warnings" }) };
  fill(parent,
    headline(make("h1", { textContent: isFile ? own.title : `${path}, ${own.title}` }), state, dataOf(own), actions),
    tabs(state, actions),
    make("div", { className: "tags", "aria-label": "The model" },
      make("span", { className: "tag", textContent: inertia(own) }),
      own.effects.map((effect) => make("span", {
        className: `tag${[nameOf(effect), `${nameOf(effect)}@${own.title}`].includes(added) ? " new" : ""}`, title: typeof effect === "string" ? "" : effect.expression, textContent: words(nameOf(effect)),
      }))),
    parts.figures, parts.warnings, parts.used,
    make("details", { id: "equation" }, make("summary", { textContent: "The model's equation" }),
      own.equation.map((part) => make("p", { className: "note" }, make("b", { textContent: `${words(part.effect)}: ` }), part.formula))),
    own.notes.map((note) => make("p", { className: "note", textContent: note })),
    isFile ? make("div", { style: "margin-top:14px;display:grid;gap:10px;max-width:760px" }, select, ownEffect(actions, own.joint === "contact")) : null);
}
