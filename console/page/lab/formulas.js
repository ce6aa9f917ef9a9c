// Formulas for what no effect of the catalogue explains: a list, each beside what was measured.

import { fill, make } from "../common/dom.js";
import { words } from "../common/names.js";
import { percent, significant } from "../common/numbers.js";
import { colours } from "../common/theme.js";
import { axis, draw, tidy } from "./charts.js";

/** Blue to vermilion: told apart by everybody, and by lightness alone from the middle. */
const scale = () => [[0, "#0a5fa8"], [0.25, "#6fb1dd"], [0.5, colours.raised], [0.75, "#f0a169"], [1, "#b84300"]];

function constants({ parameters }) {
  return Object.entries(parameters).map(([name, own]) => `${name} = ${significant(own.value)} ± ${significant(own.std_error, 2)} ${own.unit}`).join(",  ");
}

function told({ cannot_be_told_from: rivals, separate_by: next }) {
  return make("div", { className: "evidence" },
    rivals.length ? make("p", {}, "These data cannot tell it from ", rivals.flatMap((rival, n) => [n ? ", " : "", make("code", { textContent: rival })]), ".") : null,
    make("p", { textContent: next }));
}

async function curve(chart, { map }, unit) {
  await draw(chart, () => ({
    data: [
      { x: map.axes[0], y: map.measured, mode: "markers", name: "measured", marker: { color: colours.measured, size: 5 } },
      { x: map.axes[0], y: map.formula, mode: "lines", name: "formula", line: { color: colours.model, width: 2 } },
    ],
    small: true,
    layout: { xaxis: axis(words(map.signals[0]), map.units[0], { zeroline: false }), yaxis: axis("residual", unit), margin: { l: 50, r: 8, t: 24, b: 38 } },
  }));
}

async function surface(chart, { map }, unit) {
  const [across, up] = [map.axes[1], map.axes[0]];
  const rows = (values) => up.map((_, n) => values.slice(n * across.length, (n + 1) * across.length));
  const sizes = map.measured.filter((value) => value !== null).map(Math.abs).sort((a, b) => a - b);
  const most = sizes[Math.floor(sizes.length * 0.98)] || 1;
  const part = (values, more) => ({ type: "heatmap", x: across, y: up, z: rows(values), zmin: -most, zmax: most, hoverongaps: false, colorscale: scale(), hovertemplate: `%{x:.4g}, %{y:.4g}: %{z:.4g} ${unit}<extra></extra>`, ...more });
  const title = (text, x) => ({ text, x, y: 1.02, xref: "paper", yref: "paper", yanchor: "bottom", xanchor: "center", showarrow: false, font: { size: 12 } });
  await draw(chart, () => ({
    data: [part(map.measured, { showscale: false }), part(map.formula, { xaxis: "x2", colorbar: { title: { text: unit, side: "top" }, thickness: 12, outlinewidth: 0, tickfont: { size: 11 } } })],
    small: true,
    layout: {
      xaxis: axis(words(map.signals[1]), map.units[1], { domain: [0, 0.47], zeroline: false }), xaxis2: axis(words(map.signals[1]), map.units[1], { domain: [0.53, 1], zeroline: false, matches: "x" }),
      yaxis: axis(words(map.signals[0]), map.units[0], { zeroline: false }), annotations: [title("measured", 0.235), title("formula", 0.765)],
      margin: { l: 56, r: 12, t: 26, b: 40 },
    },
  }));
}

/** The button that begins the search, where the catalogue ends. */
export function offer(actions) {
  return make("div", { className: "row", style: "margin-top:10px" },
    make("button", { type: "button", id: "discover", className: "primary", textContent: "Search for a formula", onclick: actions.discover }),
    make("span", { className: "quiet small", textContent: "Short, with units that work out; a minute or less." }));
}

/** The formulas that were found. */
export async function show(parent, { discovery: found, view, joint }, actions) {
  const { unit } = view.joints[joint];
  const isFile = view.history.length > 0;
  const charts = [];
  const one = (formula, rank) => {
    const chart = make("div", { className: "chart", style: `height:${formula.map.axes.length > 1 ? 260 : 220}px` });
    charts.push([chart, formula]);
    return make("section", { className: "panel", "data-formula": formula.expression },
      make("div", { className: "headline" },
        make("div", {},
          make("h2", {}, `${rank + 1}. `, make("code", { textContent: formula.expression })),
          make("p", { className: "small", textContent: `${significant(formula.held_out_before)} → ${significant(formula.held_out_after)} ${unit} on data held out (${percent(formula.held_out_after / formula.held_out_before - 1)}); chance alone: p = ${formula.p_value.toExponential(1)}, for everything that was searched` })),
        isFile ? make("button", {
          type: "button", className: rank ? "" : "primary", textContent: "Add", "aria-label": `Add formula ${rank + 1}`, onclick: () => actions.add(`${formula.name}=${formula.expression}`),
        }) : null),
      make("p", { className: "quiet small", textContent: `${formula.form}  with  ${constants(formula)}` }),
      chart, told(formula));
  };
  fill(parent,
    make("h2", { textContent: "Formulas" }),
    make("p", { className: "quiet small", id: "formulas", "data-count": found.formulas.length, textContent: found.formulas.length
      ? "The simplest of the best first. Mean residual in each bin, less what the model itself explains, beside the same of the formula."
      : `No formula explains what is left better than chance does; ${found.tried} terms tried.` }),
    found.formulas.map(one));
  await tidy();
  await Promise.all(charts.map(([chart, formula]) => (formula.map.axes.length > 1 ? surface : curve)(chart, formula, unit)));
}
