// What the comparison and the diagnosis found, as charts and tables.

import { fill, make } from "../common/dom.js";
import { words } from "../common/names.js";
import { percent, significant } from "../common/numbers.js";
import { colours } from "../common/theme.js";
import { axis, draw, tidy } from "./charts.js";
import { offer } from "./formulas.js";

/** What each verdict says. */
export const VERDICTS = {
  missing: "An effect is missing.",
  complete: "Nothing more is found.",
  unexplained: "Something is missing that has no name. Search for a formula, or write an expression of your own.",
};

function evidence(candidate) {
  const alike = candidate.indistinguishable_from;
  return make("div", { className: "evidence" },
    make("p", { textContent: `explains ${percent(candidate.share)} of the residual's mean square; chance alone: p = ${candidate.p_value.toExponential(1)}, for everything that was tried` }),
    alike.length ? make("p", { textContent: `These data cannot tell it from ${alike.map(words).join(", ")}.` }) : null,
    candidate.separate_by ? make("p", { textContent: `next experiment: ${candidate.separate_by}` }) : null);
}

/**
 * A table of candidates with their evidence, best first. `unitOf` gives the unit of one's errors, `nameOf` what it is called
 * where it is added, `whereOf`, if there is a column for that, where it is; `add` adds it, null where nothing can be added.
 */
export function ranking(candidates, { unitOf, nameOf, whereOf = null, add }) {
  const right = { className: "right number" };
  return make("div", { className: "scroll" }, make("table", {},
    make("thead", {}, make("tr", {}, make("th", { textContent: "effect" }), whereOf ? make("th", { textContent: "where" }) : null, make("th", { className: "right", textContent: "error on data held out" }), make("th", { className: "right", textContent: "change" }), make("th", {}))),
    make("tbody", {}, candidates.map((candidate, rank) => {
      const { held_out_before: before, held_out_after: after } = candidate;
      const name = nameOf(candidate, rank);
      return make("tr", {},
        make("td", {}, make("b", { textContent: `${rank + 1}. ${words(candidate.effect)}` }), evidence(candidate)),
        whereOf ? make("td", { textContent: whereOf(candidate) }) : null,
        make("td", { ...right, textContent: `${significant(before)} → ${significant(after)} ${unitOf(candidate)}` }),
        make("td", { ...right, textContent: percent(after / before - 1) }),
        make("td", { className: "right" }, add ? make("button", {
          type: "button", className: rank ? "" : "primary", textContent: "Add", "data-effect": name, "aria-label": `Add ${words(name)}`, onclick: () => add(name),
        }) : null));
    }))));
}

/** What a verdict does not rest on, a line for each reason; null where there is none. */
export function notTested({ why_not_tested: why }) {
  return why.length ? make("div", { className: "note", id: "not-tested" }, "These recordings cannot show ",
    make("ul", {}, why.map((line) => make("li", { textContent: words(line) })))) : null;
}

/** The verdict with its ranking and evidence. */
export function diagnosis(parent, { diagnosis: found, view, joint }, actions) {
  const { unit } = view.joints[joint];
  const add = view.history.length > 0 ? (effect) => actions.add(effect) : null;
  const ranked = (candidates) => ranking(candidates, { unitOf: () => unit, nameOf: (candidate) => candidate.effect, add });
  fill(parent,
    make("h2", { textContent: "Diagnosis" }),
    make("div", { className: `verdict ${found.verdict}`, role: "status", id: "verdict", "data-verdict": found.verdict },
      make("b", { textContent: VERDICTS[found.verdict] }), `${words(found.claim)}.`),
    found.warning ? make("p", { className: "note warning", id: "cutoff-warning", textContent: found.warning }) : null,
    found.together.map((text) => make("p", { className: "note warning", "data-together": "", textContent: text })),
    make("p", { className: "quiet small", textContent: `${found.tried} variants tried, ${found.used.rows.toLocaleString("en")} rows, error ${significant(found.rms.held_out)} ${unit} on data held out.` }),
    found.verdict === "unexplained" ? offer(actions) : null,
    found.candidates.length ? ranked(found.candidates) : null,
    found.helps_in_part.length ? [
      make("h2", { textContent: "These help in part, and are not the explanation", style: "margin-top:14px" }),
      ranked(found.helps_in_part)] : null,
    found.suspected.map((own) => make("p", { className: "note", textContent: `suspected, not proven: ${words(own.effect)} (p ${own.p_value.toFixed(2)}); next experiment: ${words(own.next_experiment)}` })),
    found.residual_depends_on.length ? [
      make("h2", { textContent: "The residual depends on", style: "margin-top:14px" }),
      make("p", { className: "quiet small", textContent: "The parts overlap, since signals go together: their sum says nothing." }),
      make("table", {}, make("tbody", {}, found.residual_depends_on.map((dependence) => make("tr", {},
        make("td", { textContent: dependsOn(dependence) }), make("td", { className: "right number", textContent: percent(dependence.strength) })))))] : null,
    notTested(found));
}

/** What a residual depends on, in words. */
export const dependsOn = (own) => own.signals.map(words).join(" and ") + (own.period_s ? `, with a period of ${significant(own.period_s)} s` : "");

/** Every chart of an experiment. */
export async function charts(parent, state, actions) {
  const box = (title, id, height, note) => {
    const chart = make("div", { className: "chart", id, style: `height:${height}px` });
    return { chart, section: make("section", { className: "panel" }, make("h2", { textContent: title }), note || null, chart) };
  };
  const stairs = box("Error on data held out, step by step", "chart-stairs", 250,
    state.view.arm ? make("p", { className: "quiet small", textContent: "Of earlier steps the error of what was added to: another joint perhaps, or all joints." }) : null);
  const time = box("Measured against model", "chart-time", 380, make("p", { className: "quiet small", textContent: "Grey: not used for the fit or the verdict. Green: held out, validates." }));
  const over = make("section", { className: "panel" }, make("h2", { textContent: "Residual over each signal" }));
  const map = box("Residual over two signals", "chart-map", 360);
  fill(parent, make("div", { className: "two" }, stairs.section, parameters(state)), time.section, over, map.section);
  await tidy();
  await Promise.all([
    staircase(stairs.chart, state, actions), overTime(time, state), residuals(over, state), residualMap(map, state),
  ]);
}

function parameters({ results: { comparison }, view, joint }) {
  const { equation } = view.joints[joint];
  const idle = new Set(comparison.not_excited);
  const formulaOf = (effect) => equation.find((part) => part.effect === effect)?.formula ?? "";
  return make("section", { className: "panel" }, make("h2", { textContent: "Parameters" }),
    make("div", { className: "scroll", style: "max-height:250px" }, make("table", {},
      make("thead", {}, make("tr", {}, ["parameter", "value", "± std error", "95 %", "unit"].map((name, n) => make("th", { textContent: name, className: n > 0 && n < 4 ? "right" : "" })))),
      make("tbody", {}, Object.entries(comparison.parameters).map(([name, own]) => make("tr", { className: idle.has(name) ? "off" : "", title: idle.has(name) ? "These data do not excite it." : formulaOf(own.effect) },
        make("td", { textContent: idle.has(name) ? `${name} (not excited)` : name }),
        make("td", { className: "right number", textContent: significant(own.value) }),
        make("td", { className: "right number", textContent: own.std_error === null ? "–" : significant(own.std_error, 2) }),
        make("td", { className: "right number quiet", textContent: own.interval_95 ? own.interval_95.map((end) => significant(end)).join(" … ") : "–" }),
        make("td", { className: "quiet", textContent: own.unit })))))));
}

async function staircase(element, { view, joint, results }, actions) {
  const { unit } = view.joints[joint];
  const steps = view.history.length ? view.history : [{ path: null, effects: view.joints[joint].effects, added: null, held_out: null }];
  const names = steps.map((step, n) => (step.added ? `+ ${words(step.added)}` : n ? words(step.effects.at(-1)) : "begin"));
  const errors = steps.map((step, n) => (n === steps.length - 1 ? results.comparison.rms.held_out : step.held_out));
  const floor = results.comparison.noise.repeats;
  element.dataset.errors = JSON.stringify(errors);
  await draw(element, () => ({
    data: [{
      type: "bar", x: names.map((_, n) => n), y: errors, text: errors.map((error) => significant(error, 3)), textposition: "outside", cliponaxis: false,
      marker: { color: errors.map((_, n) => (n === errors.length - 1 ? colours.measured : colours.residual)) }, width: 0.62,
      customdata: steps.map((step) => step.path), hovertemplate: `%{y:.4g} ${unit}<extra></extra>`,
    }],
    small: true,
    layout: {
      xaxis: axis("", "", { tickvals: names.map((_, n) => n), ticktext: names, range: [-0.6, Math.max(2.6, names.length - 0.4)], showgrid: false }),
      yaxis: axis("error", unit, { rangemode: "tozero" }), showlegend: false, dragmode: false,
      margin: { l: 56, r: 12, t: 18, b: 34 },
      shapes: floor ? [{ type: "line", xref: "paper", x0: 0, x1: 1, y0: floor, y1: floor, line: { color: colours.good, width: 1.5, dash: "dash" } }] : [],
      annotations: floor ? [{ xref: "paper", x: 1, y: floor, text: "noise between repeats", showarrow: false, xanchor: "right", yanchor: "bottom", bgcolor: colours.panel, borderpad: 1, font: { size: 11, color: colours.good } }] : [],
    },
  }));
  element.removeAllListeners?.("plotly_click");
  element.on?.("plotly_click", (event) => {
    const path = event.points[0]?.customdata;
    if (path && path !== steps.at(-1).path) actions.open(path);
  });
}

/** Behind the curves: y is 1 where it is shaded, else 0. */
const shade = (name, colour, x, y) => ({
  type: "scattergl", mode: "lines", name, x, y, yaxis: "y3", fill: "tozeroy", fillcolor: `${colour}2a`,
  line: { width: 0, color: colour }, hoverinfo: "skip",
});

async function overTime({ chart, section }, { results: { drawings }, view, joint }) {
  const { unit } = view.joints[joint];
  let chosen = "all";
  const show = async () => {
    const sessions = drawings.filter((_, n) => chosen === "all" || String(n) === chosen);
    let from = 0;
    const columns = { x: [], measured: [], modelled: [], residual: [], unused: [], validates: [] };
    const seams = [];
    for (const drawing of sessions) {
      const shift = from - (drawing.time[0] || 0);
      for (let n = 0; n < drawing.time.length; n++) {
        columns.x.push(drawing.time[n] + shift);
        columns.measured.push(drawing.measured[n]);
        columns.modelled.push(drawing.modelled[n]);
        columns.residual.push(drawing.measured[n] - drawing.modelled[n]);
        columns.unused.push(drawing.used[n] ? 0 : 1);
        columns.validates.push(drawing.used[n] && drawing.held_out ? 1 : 0);
      }
      from = (columns.x.at(-1) || 0) + 1;
      // A hole between sessions, so that no line joins them.
      for (const [name, values] of Object.entries(columns)) values.push(name === "x" ? from : null);
      seams.push(from);
    }
    chart.dataset.points = columns.x.length;
    const begun = performance.now();
    const line = (name, y, colour, more = {}) => ({ type: "scattergl", mode: "lines", name, x: columns.x, y, line: { color: colour, width: 1.3 }, hovertemplate: `%{y:.4g} ${unit}<extra>${name}</extra>`, ...more });
    await draw(chart, () => ({
      data: [
        shade("not used", colours.quiet, columns.x, columns.unused),
        columns.validates.includes(1) ? shade("validates", colours.good, columns.x, columns.validates) : null,
        line("measured", columns.measured, colours.measured), line("model", columns.modelled, colours.model),
        line("residual", columns.residual, colours.residual, { yaxis: "y2" }),
      ].filter(Boolean),
      layout: {
        xaxis: axis("time", "s", { anchor: "y2", domain: [0, 1] }),
        yaxis: axis("torque", unit, { domain: [0.36, 1] }), yaxis2: axis("residual", unit, { domain: [0, 0.28] }),
        yaxis3: { domain: [0, 1], range: [0, 1], visible: false, fixedrange: true },
        shapes: seams.slice(0, -1).map((x) => ({ type: "line", yref: "paper", y0: 0, y1: 1, x0: x - 0.5, x1: x - 0.5, line: { color: colours.line, width: 1 } })),
        margin: { l: 56, r: 12, t: 30, b: 40 },
      },
    }));
    chart.dataset.took = performance.now() - begun;
  };
  if (drawings.length > 1) {
    const select = make("select", { "aria-label": "Session", style: "max-width:420px;margin-bottom:8px", onchange: () => { chosen = select.value; show(); } },
      make("option", { value: "all", textContent: `all ${drawings.length} sessions, one behind the other` }),
      drawings.map((drawing, n) => make("option", { value: n, textContent: `${drawing.session}${drawing.held_out ? " (held out)" : ""}` })));
    section.insertBefore(select, chart);
  }
  await show();
}

async function residuals(section, { results: { comparison }, view, joint }) {
  const { unit } = view.joints[joint];
  const grid = make("div", { className: "maps" });
  section.append(grid, make("p", { className: "quiet small", textContent: "Mean residual in each bin, with the standard deviation of the residual as a band." }));
  await Promise.all(comparison.residual_maps.map((map) => {
    const chart = make("div", { className: "chart", style: "height:200px", "data-signal": map.signal });
    grid.append(chart);
    const at = map.bins.map((bin) => bin.at);
    const band = map.bins.map((bin) => bin.mean + bin.spread).concat(map.bins.map((bin) => bin.mean - bin.spread).reverse());
    return draw(chart, () => ({
      data: [
        { x: at.concat([...at].reverse()), y: band, fill: "toself", mode: "lines", line: { width: 0 }, fillcolor: `${colours.measured}2e`, hoverinfo: "skip" },
        { x: at, y: map.bins.map((bin) => bin.mean), mode: "lines+markers", line: { color: colours.measured, width: 2 }, marker: { size: 4 }, customdata: map.bins.map((bin) => bin.count), hovertemplate: `%{y:.4g} ${unit} at %{x:.4g} ${map.unit}<br>%{customdata} rows<extra></extra>` },
      ],
      small: true,
      layout: { showlegend: false, xaxis: axis(words(map.signal), map.unit, { zeroline: false }), yaxis: axis("residual", unit), margin: { l: 50, r: 8, t: 6, b: 38 } },
    }));
  }));
}

/** Bins along each axis of the map. */
const BINS = 40;

function binned(drawings, nameX, nameY) {
  const [x, y, residual] = [[], [], []];
  for (const drawing of drawings) {
    for (let n = 0; n < drawing.time.length; n++) {
      if (!drawing.used[n]) continue;
      x.push(drawing[nameX][n]);
      y.push(drawing[nameY][n]);
      residual.push(drawing.measured[n] - drawing.modelled[n]);
    }
  }
  const range = (values) => {
    const sorted = Float64Array.from(values).sort();
    return [sorted[Math.floor(sorted.length * 0.002)], sorted[Math.ceil(sorted.length * 0.998) - 1]];
  };
  const [[x0, x1], [y0, y1]] = [range(x), range(y)];
  const sums = Array.from({ length: BINS }, () => new Float64Array(BINS));
  const counts = Array.from({ length: BINS }, () => new Float64Array(BINS));
  residual.forEach((value, n) => {
    const i = Math.floor(((x[n] - x0) / (x1 - x0)) * BINS);
    const j = Math.floor(((y[n] - y0) / (y1 - y0)) * BINS);
    if (i < 0 || j < 0 || i >= BINS || j >= BINS) return;
    sums[j][i] += value;
    counts[j][i] += 1;
  });
  const middle = (low, high) => Array.from({ length: BINS }, (_, n) => low + ((high - low) * (n + 0.5)) / BINS);
  return { x: middle(x0, x1), y: middle(y0, y1), z: sums.map((row, j) => Array.from(row, (sum, i) => (counts[j][i] > 2 ? sum / counts[j][i] : null))) };
}

async function residualMap({ chart, section }, { results: { drawings }, view, joint }) {
  const { unit, joint: kind } = view.joints[joint];
  const angle = kind === "revolute" ? "rad" : "m";
  const called = kind === "contact" ? { position: "place", velocity: "tip velocity", acceleration: "tip acceleration", load: "normal force" } : {};
  const nameOf = (name) => called[name] ?? name;
  const units = { position: angle, velocity: `${angle}/s`, acceleration: `${angle}/s²`, load: unit, temperature: "°C", time: "s" };
  const names = Object.keys(units).filter((name) => drawings.every((drawing) => drawing[name].length));
  const select = (label, value) => make("select", { "aria-label": label, style: "width:auto", onchange: () => show() },
    names.map((name) => make("option", { value: name, textContent: nameOf(name), selected: name === value })));
  const [across, up] = [select("signal across", "position"), select("signal up", "velocity")];
  section.insertBefore(make("div", { className: "row", style: "margin-bottom:6px" }, across, make("span", { className: "quiet small", textContent: "against" }), up), chart);
  const show = () => {
    const bins = binned(drawings, across.value, up.value);
    const sizes = bins.z.flat().filter((value) => value !== null).map(Math.abs).sort((a, b) => a - b);
    const most = sizes[Math.floor(sizes.length * 0.98)] || 1;
    return draw(chart, () => ({
      data: [{
        type: "heatmap", ...bins, zmin: -most, zmax: most, hoverongaps: false,
        // Blue to vermilion: told apart by everybody, and by lightness alone from the middle.
        colorscale: [[0, "#0a5fa8"], [0.25, "#6fb1dd"], [0.5, colours.raised], [0.75, "#f0a169"], [1, "#b84300"]],
        colorbar: { title: { text: unit, side: "top" }, thickness: 12, outlinewidth: 0, tickfont: { size: 11 } },
        hovertemplate: `%{x:.4g}, %{y:.4g}: %{z:.4g} ${unit}<extra></extra>`,
      }],
      layout: { xaxis: axis(nameOf(across.value), units[across.value], { zeroline: false }), yaxis: axis(nameOf(up.value), units[up.value], { zeroline: false }) },
    }));
  };
  await show();
}
