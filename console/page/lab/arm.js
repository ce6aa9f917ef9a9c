// A whole arm: the errors of all joints, and what is missing in any of them or in the arm.

import { fill, make } from "../common/dom.js";
import { words } from "../common/names.js";
import { percent, significant } from "../common/numbers.js";
import { VERDICTS, dependsOn, notTested, ranking } from "./findings.js";
import { dataOf, figure, headline, tabs } from "./model.js";

let parts = {};

/** The effects that may be added to the arm. */
function adding({ view }, actions) {
  const has = new Set(view.history.at(-1).effects);
  const select = make("select", { id: "add-effect", "aria-label": "Effect of the arm to add" },
    make("option", { value: "", textContent: "add an effect of the arm …" }),
    view.arm.filter(({ effect }) => !has.has(effect)).map(({ effect, equation }) => make("option", { value: effect, textContent: words(effect), title: equation })));
  select.onchange = () => { if (select.value) actions.add(select.value); };
  return select;
}

/** Shows the arm in `parent`. */
export function show(parent, state, actions) {
  const { view, path } = state;
  const { effects, added } = view.history.at(-1);
  parts = {
    title: make("h1", { textContent: path }), figures: make("div", { className: "figures" }), warnings: make("div", { id: "warnings" }),
    joints: make("div", { className: "scroll" }), parameters: make("div", { className: "scroll" }),
  };
  fill(parent,
    headline(parts.title, state, `${view.joints.length} joints, ${dataOf(view.joints[0])}`, actions),
    tabs(state, actions),
    make("div", { className: "tags", "aria-label": "The model" }, effects.map((effect) => make("span", { className: `tag${effect === added ? " new" : ""}`, textContent: words(effect) }))),
    parts.figures, parts.warnings, parts.joints, parts.parameters,
    make("div", { style: "margin-top:14px;max-width:760px" }, adding(state, actions)));
}

/** Shows the errors of all joints, beside those of the model before where one was added to. */
export function figures({ results: found, before, diagnosis, view }, actions) {
  parts.title.textContent = found.title;
  fill(parts.figures,
    figure(`${significant(found.rms.held_out)} ${found.unit}`, "error on data held out, over all joints, each weighted by its noise"),
    figure(`${significant(found.rms.train)} ${found.unit}`, "error on data fitted"),
    figure(found.samples.toLocaleString("en"), `samples of each joint; ${found.used.toLocaleString("en")} rows of all used`));
  fill(parts.warnings, [...found.warnings, ...found.notes].map((text) => make("p", { className: "note warning", textContent: text })));
  const was = new Map(before?.joints.map((own) => [own.joint, own.rms.held_out]));
  const right = (textContent, more = {}) => make("td", { className: "right number", textContent, ...more });
  fill(parts.joints, make("table", { id: "arm-joints" },
    make("thead", {}, make("tr", {}, ["joint", "error held out", before ? "before" : null, before ? "change" : null, "of what is measured", "fitted", diagnosis ? "verdict" : null]
      .filter((name) => name !== null).map((name, n) => make("th", { textContent: name, className: n && name !== "verdict" ? "right" : "" })))),
    make("tbody", {}, found.joints.map(({ joint, rms, relative_error_held_out: relative }, number) => {
      const { unit } = view.joints[number];
      const error = (value) => `${significant(value)} ${unit}`;
      const verdict = diagnosis?.joints[joint].verdict;
      return make("tr", { "data-joint": joint, "data-error": rms.held_out },
        make("td", {}, make("button", { type: "button", textContent: words(joint), title: "Its curves and residuals", onclick: () => actions.joint(number) })),
        right(error(rms.held_out)),
        before ? [right(error(was.get(joint))), right(percent(rms.held_out / was.get(joint) - 1))] : null,
        right(percent(relative)), right(error(rms.train)),
        verdict ? make("td", { textContent: verdict, "data-verdict": verdict }) : null);
    }))));
  const rows = Object.entries(found.arm).flatMap(([effect, own]) => Object.entries(own).map(([name, parameter]) => [effect, name, parameter]));
  fill(parts.parameters, rows.length ? make("table", { id: "arm-parameters" },
    make("thead", {}, make("tr", {}, ["effect of the arm", "parameter", "value", "± std error", "unit"].map((name, n) => make("th", { textContent: name, className: n === 2 || n === 3 ? "right" : "" })))),
    make("tbody", {}, rows.map(([effect, name, own]) => make("tr", { "data-parameter": `${effect}.${name}` },
      make("td", { textContent: words(effect) }), make("td", { textContent: name }), right(significant(own.value)),
      right(own.std_error === null ? "–" : significant(own.std_error, 2)), make("td", { className: "quiet", textContent: own.unit }))))) : null);
}

/** What residuals depend on: of each joint the strongest, the rest on request. */
function dependences(all) {
  if (!all.length) return null;
  const seen = new Map();
  const [first, rest] = [[], []];
  for (const own of all) {
    const count = seen.get(own.joint) ?? 0;
    seen.set(own.joint, count + 1);
    (count < 3 ? first : rest).push(own);
  }
  const table = (rows) => make("table", {}, make("tbody", {}, rows.map((own) => make("tr", {},
    make("td", { textContent: words(own.joint) }), make("td", { textContent: dependsOn(own) }), make("td", { className: "right number", textContent: percent(own.strength) })))));
  return [
    make("h2", { textContent: "Residuals depend on", style: "margin-top:14px" }), table(first),
    rest.length ? make("details", {}, make("summary", { textContent: `${rest.length} more, weaker ones of the same joints` }), table(rest)) : null];
}

/** What is missing in the arm: the verdict with its ranking and evidence. */
export function diagnosis(parent, { diagnosis: found, results, view }, actions) {
  fill(parent,
    make("h2", { textContent: "Diagnosis of the arm" }),
    make("div", { className: `verdict ${found.verdict}`, role: "status", id: "verdict", "data-verdict": found.verdict }, make("b", { textContent: found.told_misread.length ? "Joints are read otherwise than the model has them. Mend that first." : VERDICTS[found.verdict] })),
    make("p", { className: "quiet small", textContent: `${found.tried} variants tried in ${view.joints.length} joints and in the arm.` }),
    found.told_misread.map((text) => make("p", { className: "note warning misread", textContent: text })),
    found.candidates.length ? ranking(found.candidates, {
      unitOf: ({ joint }) => view.joints.find((own) => own.title === joint)?.unit ?? results.unit,
      nameOf: (_, rank) => found.names[rank],
      whereOf: ({ joint, partner }) => `${words(joint ?? "the arm")}${partner ? ` from ${words(partner)}` : ""}`,
      add: (name) => actions.add(name),
    }) : null,
    found.suspected.map((own) => make("p", { className: "note", textContent: `suspected, not proven: ${words(own.effect)} of ${words(own.joint)} (p ${own.p_value.toFixed(2)}); next experiment: ${words(own.next_experiment)}` })),
    dependences(found.residual_depends_on),
    notTested(found));
}
