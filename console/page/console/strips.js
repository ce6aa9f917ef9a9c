// Strip charts of the last seconds. Own canvases: a chart library redraws
// live curves at a cost that a page beside a haptic session cannot pay.

import { fill, make, write } from "../common/dom.js";
import { fixed, ticks } from "../common/numbers.js";
import { colours, fitted } from "../common/theme.js";

/** Seconds shown. */
const SPAN = 20;

const length = (pair) => (pair ? Math.hypot(pair[0], pair[1]) : null);
const milli = (value) => (value === null || value === undefined ? null : value * 1e3);

/** What the charts show: title, unit, least span, curves (name, colour, value of a snapshot). */
const CHARTS = [
  {
    id: "position", title: "Position", unit: "mm", least: 10,
    curves: [
      { name: "hand x", colour: "hand", value: (s) => milli(s.hand?.[0]) },
      { name: "tip x", colour: "model", value: (s, a) => (s.tip ? milli((s.tip[0] - a.workspace_offset[0]) / a.position_scale) : null) },
      { name: "hand y", colour: "hand", dash: [4, 3], value: (s) => milli(s.hand?.[1]) },
      { name: "tip y", colour: "model", dash: [4, 3], value: (s, a) => (s.tip ? milli((s.tip[1] - a.workspace_offset[1]) / a.position_scale) : null) },
    ],
  },
  {
    id: "force", title: "Force", unit: "N", least: 5, zero: true,
    curves: [
      { name: "contact", colour: "force", value: (s) => (s.contact.on ? length(s.force) : 0) },
      { name: "hand", colour: "hand", value: (s) => length(s.hand_force) },
    ],
  },
  {
    id: "delay", title: "Delay", unit: "ms", least: 10, zero: true,
    curves: [
      { name: "round trip", colour: "measured", value: (s) => milli(s.link?.round_trip) },
      { name: "jitter", colour: "second", value: (s) => milli(s.link?.jitter) },
    ],
  },
  {
    id: "energy", title: "Energy in − out", unit: "J", least: 0.1,
    curves: [
      { name: "operator's port", colour: "hand", value: (s) => s.link && s.link.energy_in - s.link.energy_out },
      { name: "arm's port", colour: "force", value: (s) => s.follower_link && s.follower_link.energy_in - s.follower_link.energy_out },
    ],
  },
];

let charts = [];

/** Makes the charts in `parent`. */
export function build(parent) {
  charts = CHARTS.map((chart) => {
    const canvas = make("canvas", { role: "img", "aria-label": `${chart.title} of the last ${SPAN} seconds in ${chart.unit}` });
    const value = make("span", { className: "number" });
    const keys = make("span", { className: "keys" }, chart.curves.filter((c) => !c.dash).map((curve) =>
      make("span", {}, make("i", { style: `border-color:var(--${curve.colour})` }), curve.name.replace(" x", ""))));
    const box = make("div", { className: "strip panel", id: `strip-${chart.id}` },
      make("header", {}, make("span", {}, make("b", { textContent: chart.title }), ` [${chart.unit}]`), value, keys), canvas);
    return { ...chart, canvas, value, box };
  });
  fill(parent, charts.map((chart) => chart.box));
}

/** Draws the charts from snapshots, the oldest first. */
export function draw(past, about) {
  const last = past[past.length - 1];
  if (!last) return;
  const from = last.t - SPAN;
  const begin = Math.max(0, past.findIndex((snapshot) => snapshot.t >= from));
  for (const chart of charts) drawOne(chart, past, begin, from, about);
}

function drawOne(chart, past, begin, from, about) {
  const { context: c, width, height } = fitted(chart.canvas);
  if (width < 10) return;
  const columns = chart.curves.map((curve) => {
    const values = [];
    for (let n = begin; n < past.length; n++) values.push(curve.value(past[n], about));
    return values;
  });
  let [low, high] = [chart.zero ? 0 : Infinity, chart.zero ? 0 : -Infinity];
  for (const values of columns) {
    for (const value of values) {
      if (value === null || value === undefined) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(high >= low)) [low, high] = [0, chart.least];
  if (high - low < chart.least) {
    const middle = (low + high) / 2;
    [low, high] = chart.zero ? [0, chart.least] : [middle - chart.least / 2, middle + chart.least / 2];
  }
  const room = (high - low) * 0.06;
  [low, high] = [chart.zero ? 0 : low - room, high + room];
  const [left, right, top, bottom] = [38, width - 2, 4, height - 15];
  const x = (t) => left + ((t - from) / SPAN) * (right - left);
  const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
  c.clearRect(0, 0, width, height);
  c.font = '10.5px system-ui, "DejaVu Sans", sans-serif';
  c.lineWidth = 1;
  c.textAlign = "right";
  const marks = ticks(low, high, 4);
  const decimals = Math.max(0, Math.ceil(-Math.log10(marks.step) - 1e-9));
  for (const value of marks.values) {
    c.strokeStyle = colours.grid;
    c.beginPath();
    c.moveTo(left, y(value));
    c.lineTo(right, y(value));
    c.stroke();
    c.fillStyle = colours.quiet;
    c.fillText(fixed(value, decimals), left - 5, y(value) + 3.5);
  }
  c.textAlign = "left";
  c.fillText(`−${SPAN} s`, left, height - 3);
  c.textAlign = "right";
  c.fillText("now", right, height - 3);
  chart.curves.forEach((curve, number) => {
    c.strokeStyle = colours[curve.colour];
    c.lineWidth = 1.6;
    c.setLineDash(curve.dash || []);
    c.beginPath();
    let drawing = false;
    columns[number].forEach((value, n) => {
      if (value === null || value === undefined) { drawing = false; return; }
      const at = [x(past[begin + n].t), y(value)];
      if (drawing) c.lineTo(...at); else c.moveTo(...at);
      drawing = true;
    });
    c.stroke();
  });
  c.setLineDash([]);
  const newest = columns[0][columns[0].length - 1];
  write(chart.value, fixed(newest, chart.unit === "J" ? 2 : 1));
  chart.canvas.dataset.newest = newest ?? "";
  chart.canvas.dataset.largest = Math.max(0, ...columns[0].filter((value) => value !== null && value !== undefined));
}
