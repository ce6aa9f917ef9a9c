// What would be read with the mapping as it stands: numbers, what is odd, curves.

import { fill, make } from "../common/dom.js";
import { words } from "../common/names.js";
import { percent, significant } from "../common/numbers.js";
import { work } from "../common/server.js";
import { colours } from "../common/theme.js";
import { axis, draw, tidy } from "./charts.js";

/** Rest of the user's hands before what they say is tried. */
const REST = 250;
/** More recordings than these are not named above the chart. */
const NAMED = 4;

const AXES = { "tip[0]": "tip x", "tip[1]": "tip y" };

/** A signal in words: of an arm the joint and what of it. */
function signalInWords(key) {
  const [role, joint] = key.replace("extra.", "").split("@");
  const text = AXES[role] ?? words(role);
  return joint ? `${joint}: ${text}` : text;
}

/** The same for an axis, which has little room. */
function shortened(key) {
  const [role, joint] = key.split("@");
  const last = signalInWords(role).split(" ").pop();
  return joint ? `${joint.length > 12 ? `${joint.slice(0, 11)}…` : joint}<br>${last}` : AXES[role] ?? last;
}
const short = (path) => path.split("/").pop();

/** Tells that files are read. */
export function wait(parent, text) {
  parent.dataset.state = "reading";
  fill(parent, make("p", { className: "small quiet", textContent: `Reading ${text} …` }));
}

/** Tells what has to be said before anything can be read. */
function want(parent, text) {
  parent.dataset.state = "asking";
  fill(parent, make("h2", { textContent: "What is read" }), make("p", { className: "note", id: "to-choose", textContent: `Still to choose: ${text}` }));
}

/**
 * Tries the mapping, one trial at a time, and shows it in `parent`. Gives `ask`, to be
 * called whenever the mapping is another, and `stop`. `now` gives { asked (of the server),
 * held, columns }, or { wanting } where that is not enough; `told` is called with each trial.
 */
export function trials(parent, now, told) {
  let wanted = 0, timer = 0, running = false, due = false;
  async function run() {
    if (running) { due = true; return; }
    running = true;
    due = false;
    const mine = wanted;
    const latest = () => mine === wanted && parent.isConnected;
    const { asked, held, columns, wanting } = now();
    if (wanting) {
      want(parent, wanting);
      running = false;
      return;
    }
    try {
      const found = await work("/api/lab/trial", asked);
      if (latest()) {
        told(found);
        // As they stand in the form.
        const order = Object.keys(columns);
        found.signals.sort((a, b) => order.indexOf(a.signal) - order.indexOf(b.signal));
        await show(parent, found, held, columns);
        if (latest()) parent.dataset.state = found.troubles.length ? "refused" : found.missing.length ? "asking" : "read";
      }
    } catch (error) {
      if (latest()) {
        fill(parent, make("p", { className: "error", role: "alert", textContent: error.message }));
        parent.dataset.state = "refused";
      }
    }
    running = false;
    if (due && parent.isConnected) run();
  }
  const stop = () => {
    wanted += 1;
    due = false;
    clearTimeout(timer);
    parent.dataset.state = "reading";
  };
  return { stop, ask: () => { stop(); timer = setTimeout(run, REST); } };
}

/** One line for each signal, over all recordings. */
function lines(signals) {
  const all = new Map();
  for (const own of signals) {
    const known = all.get(own.signal) ?? { signal: own.signal, unit: own.unit, least: Infinity, greatest: -Infinity, missing: 0, gaps: 0, longest: 0, interval: own.interval, first: null };
    const [least, greatest] = own.range ?? [Infinity, -Infinity];
    all.set(own.signal, {
      ...known, least: Math.min(known.least, least), greatest: Math.max(known.greatest, greatest), missing: known.missing + own.missing,
      gaps: known.gaps + own.gaps, longest: Math.max(known.longest, own.longest_gap), first: known.first ?? own.first_missing,
    });
  }
  return [...all.values()];
}

function table(signals, columns) {
  const cell = (text, more = {}) => make("td", { className: "right number", textContent: text, ...more });
  const rows = lines(signals).map((own) => make("tr", { "data-signal": own.signal },
    make("td", {}, signalInWords(own.signal), make("small", { className: "quiet", textContent: ` ${columns[own.signal] ?? ""}` })),
    cell(`${significant(own.least)} … ${significant(own.greatest)} ${own.unit}`, { "data-what": "range" }),
    cell(own.interval ? `${significant(1 / own.interval)} Hz` : "–", { "data-what": "rate" }),
    cell(String(own.missing), { "data-what": "missing", title: own.first ? `the first in ${own.first}` : "" }),
    cell(own.gaps ? `${own.gaps}, up to ${significant(own.longest, 3)} s` : "0", { "data-what": "gaps" })));
  return make("div", { className: "scroll" }, make("table", {},
    make("thead", {}, make("tr", {}, ["signal", "range", "rate", "no number", "gaps"].map((text, n) => make("th", { textContent: text, className: n ? "right" : "" })))),
    make("tbody", {}, rows)));
}

const REASONS = {
  without_number: "without a number", repeated_time: "with the time of the one before", without_other_signal: "where another signal is missing",
  repeats: "repeats until the next value is measured", wrong_readings: "wrong readings of the position",
  not_valid: "that do not count", in_short_stretches: "in stretches that are too short", too_much: "not read, since the file is long", bridged: "bridged by a straight line",
};

function tally(own) {
  const out = Object.entries(REASONS).filter(([key]) => own[key]).map(([key, text]) => `${own[key].toLocaleString("en")} ${text}`);
  return make("p", { className: "note", textContent: `${own.file}: ${own.used.toLocaleString("en")} of ${own.samples.toLocaleString("en")} samples used, in ${own.stretches} ${own.stretches === 1 ? "stretch" : "stretches"}${out.length ? `; ${out.join(", ")}` : ""}` });
}

async function show(parent, found, held, columns) {
  const chart = make("div", { className: "chart", id: "chart-reading", style: `height:${70 + 105 * Math.max(1, new Set(found.signals.map((own) => own.signal)).size)}px` });
  const figure = (value, text, id) => make("div", { className: "figure", id }, make("b", { textContent: value }), make("small", { textContent: text }));
  fill(parent,
    make("h2", { textContent: "What is read" }),
    found.missing.length ? make("p", { className: "note", id: "to-choose", textContent: `Still to choose: ${found.missing.map(signalInWords).join(", ")}` }) : null,
    found.troubles.map((text) => make("p", { className: "error", role: "alert", textContent: text })),
    found.share_used === null ? null : make("div", { className: "figures" },
      figure(`${significant(found.rate_hz)} Hz`, "rate", "read-rate"), figure(percent(found.share_used), "of all samples used", "read-share")),
    found.recordings.map(tally),
    found.warnings.map((text) => make("p", { className: "note warning", textContent: text })),
    found.signals.length ? [table(found.signals, columns), chart] : null);
  await tidy();
  if (found.signals.length && chart.isConnected) await draw(chart, () => curves(found.signals, held, columns));
}

/** Each signal over time in a strip of its own; recordings in colours, what is held out dotted. */
function curves(signals, held, columns) {
  const keys = [...new Set(signals.map((own) => own.signal))];
  const files = [...new Set(signals.map((own) => own.recording))];
  const palette = [colours.measured, colours.model, colours.hand, colours.second, colours.residual];
  const gap = 0.06, height = (1 - gap * (keys.length - 1)) / keys.length;
  const layout = { xaxis: axis("time", "s", { anchor: keys.length > 1 ? `y${keys.length}` : "y" }), showlegend: files.length > 1 && files.length <= NAMED, margin: { l: 62, r: 12, t: 8, b: 40 } };
  keys.forEach((key, n) => {
    const unit = signals.find((own) => own.signal === key).unit;
    const top = 1 - n * (height + gap);
    const text = shortened(key);
    layout[n ? `yaxis${n + 1}` : "yaxis"] = axis("", "", { domain: [Math.max(0, top - height), top], title: { text: `${text}<br>[${unit || "–"}]`, font: { size: 11 }, standoff: 4 }, nticks: 4 });
  });
  const data = signals.map((own) => {
    const n = keys.indexOf(own.signal), file = files.indexOf(own.recording);
    return {
      type: "scattergl", mode: "lines", x: own.time, y: own.value, yaxis: n ? `y${n + 1}` : "y", name: `${short(own.recording)}${held.has(own.recording) ? " (held out)" : ""}`,
      legendgroup: own.recording, showlegend: n === 0, line: { width: 1.2, color: palette[file % palette.length], dash: held.has(own.recording) ? "dot" : "solid" },
      hovertemplate: `%{y:.4g} ${own.unit}, ${columns[own.signal] ?? ""}<extra></extra>`,
    };
  });
  return { data, layout, small: true };
}
