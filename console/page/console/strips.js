// Strip charts of the last seconds. Own canvases: a chart library redraws
// live curves at a cost that a page beside a haptic session cannot pay.

import { fill, make, write } from "../common/dom.js";
import { fixed } from "../common/numbers.js";
import { drawChart, frame } from "./chart.js";
import { ownLink, session } from "./connection.js";

/** Seconds shown. */
const SPAN = 20;
/** An event is told where the pointer is as near [s]. */
const NEAR = 0.4;

const length = (force) => (force ? Math.hypot(...force) : null);
const milli = (value) => (value === null || value === undefined ? null : value * 1e3);

/** Dashes of the curves along x, y and z. */
const DASHES = [null, [4, 3], [1.5, 2.5]];
const AXES = ["x", "y", "z"];

/** Hand and tip along an axis, both where the hand is. */
const along = (axis) => [
  { name: `hand ${AXES[axis]}`, colour: "hand", dash: DASHES[axis], value: (s) => milli(s.hand?.[axis]) },
  { name: `tip ${AXES[axis]}`, colour: "model", dash: DASHES[axis], value: (s, a) => (s.tip ? milli((s.tip[axis] - a.workspace_offset[axis]) / a.position_scale) : null) },
];

/** What the charts show: title, unit, least span of each axis, curves (name, colour, value of a snapshot, axis). */
const shown = (axes) => [
  {
    id: "position", title: "Position", unit: "mm", least: 10, decimals: 1, axes,
    curves: Array.from({ length: axes }, (_, axis) => along(axis)).flat(),
  },
  {
    id: "force", title: "Force", unit: "N", least: 5, leastRight: 1, zero: true, decimals: 1,
    curves: [
      { name: "contact", colour: "force", value: (s) => s.contact && (s.contact.on ? length(s.force) : 0) },
      { name: "hand", colour: "hand", axis: "right", value: (s) => s.hand_force && length(s.hand_force) },
    ],
  },
  {
    id: "delay", title: "Delay", unit: "ms", least: 10, zero: true, decimals: 1,
    curves: [
      { name: "round trip", colour: "measured", value: (s) => milli(ownLink(s)?.round_trip) },
      { name: "jitter", colour: "second", value: (s) => milli(ownLink(s)?.jitter) },
    ],
  },
  {
    id: "energy", title: "Energy in − out", unit: "J", least: 0.1, decimals: 3,
    curves: [
      { name: "operator's port", colour: "hand", value: (s) => s.link && s.link.energy_in - s.link.energy_out },
      { name: "arm's port", colour: "force", value: (s) => s.follower_link && s.follower_link.energy_in - s.follower_link.energy_out },
    ],
  },
];

let charts = [];
/** What was there when the charts were paused; null while they run. */
let paused = null;
/** Where the pointer is: chart, and share of the time shown; null where it is on none. */
let pointer = null;
let last = null;

function legend(chart) {
  const line = (style, text) => make("span", {}, make("i", { style }), text);
  const solid = chart.curves.filter((curve) => !curve.dash);
  const keys = solid.map((curve) => line(`border-color:var(--${curve.colour})`,
    (chart.axes ? curve.name.replace(" x", "") : curve.name) + (curve.axis === "right" ? " (right)" : "")));
  const styles = ["", ";border-top:2px dashed;width:17px", ";border-top:2px dotted;width:13px"];
  return [...keys, ...styles.slice(0, chart.axes || 0).map((style, axis) => line(`border-color:var(--quiet)${style}`, AXES[axis]))];
}

function pause() {
  paused = paused ? null : session.past.slice();
  show();
  if (session.about) draw(session.past, session.about);
}

function show() {
  const button = document.querySelector("#pause");
  write(button, paused ? "Go on" : "Pause");
  button.setAttribute("aria-pressed", String(Boolean(paused)));
}

function follow(chart) {
  const move = (event) => {
    const box = chart.canvas.getBoundingClientRect();
    const { left, right } = frame(chart, box.width, box.height);
    const share = (event.clientX - box.left - left) / (right - left);
    pointer = share >= 0 && share <= 1 ? { chart, share } : null;
    if (last) draw(session.past, last);
  };
  chart.canvas.addEventListener("pointermove", move);
  chart.canvas.addEventListener("pointerdown", move);
  chart.canvas.addEventListener("pointerleave", () => {
    pointer = null;
    if (last) draw(session.past, last);
  });
}

/** Makes the charts in `parent`. */
export function build(parent) {
  paused = pointer = null;
  charts = shown(session.about.planar ? 2 : 3).map((chart) => {
    const canvas = make("canvas", { role: "img", "aria-label": `${chart.title} of the last ${SPAN} seconds in ${chart.unit}` });
    const value = make("span", { className: "number" });
    const keys = make("span", { className: "keys" }, legend(chart));
    const tip = make("div", { className: "tip", hidden: true });
    const box = make("div", { className: "strip panel", id: `strip-${chart.id}` },
      make("header", {}, make("span", {}, make("b", { textContent: chart.title }), ` [${chart.unit}]`), value, keys), canvas, tip);
    const own = { ...chart, canvas, value, box, tip };
    follow(own);
    return own;
  });
  const button = make("button", { id: "pause", type: "button", className: "bare", textContent: "Pause", "aria-pressed": "false", onclick: pause });
  fill(parent, make("div", { className: "strips-head" },
    make("span", { className: "quiet small", textContent: `The last ${SPAN} s; point at a chart to read it. Dotted lines with a mark are events.` }), button),
  charts.map((chart) => chart.box));
}

/** Draws the charts from snapshots, the oldest first. */
export function draw(past, about) {
  const seen = paused || past;
  const newest = seen[seen.length - 1];
  if (!newest) return;
  last = about;
  const from = newest.t - SPAN;
  const begin = Math.max(0, seen.findIndex((snapshot) => snapshot.t >= from));
  const shown = seen.slice(begin);
  const times = shown.map((snapshot) => snapshot.t);
  const cursor = pointer ? from + pointer.share * SPAN : null;
  for (const chart of charts) {
    const columns = chart.curves.map((curve) => shown.map((snapshot) => curve.value(snapshot, about)));
    drawChart(chart, { times, columns, from, span: SPAN, events: session.events, cursor });
    read(chart, { times, columns, cursor, now: newest.t });
  }
}

/** What is read at the right, and where the pointer is. */
function read(chart, { times, columns, cursor, now }) {
  const [first] = columns;
  const newest = first[first.length - 1];
  write(chart.value, fixed(newest, chart.unit === "J" ? 2 : 1));
  chart.canvas.dataset.newest = newest ?? "";
  chart.canvas.dataset.largest = Math.max(0, ...first.filter((value) => value !== null && value !== undefined));
  chart.tip.hidden = pointer?.chart !== chart;
  if (chart.tip.hidden) return;
  let nearest = 0;
  for (let n = 1; n < times.length; n++) if (Math.abs(times[n] - cursor) < Math.abs(times[nearest] - cursor)) nearest = n;
  const there = Math.abs(times[nearest] - cursor) < NEAR;
  const values = chart.curves.map((curve, number) => make("div", {}, make("i", { style: `border-color:var(--${curve.colour})${curve.dash ? ";border-top-style:dashed" : ""}` }),
    `${curve.name} `, make("b", { textContent: `${there ? fixed(columns[number][nearest], chart.decimals) : "–"} ${chart.unit}` })));
  const events = session.events.filter((event) => Math.abs(event.t - cursor) < NEAR);
  fill(chart.tip, make("div", { className: "quiet", textContent: `${fixed(cursor - now, 1)} s` }), values,
    events.map((event) => make("div", { className: "event", textContent: event.text })));
  chart.tip.style.left = pointer.share > 0.5 ? "8px" : "auto";
  chart.tip.style.right = pointer.share > 0.5 ? "auto" : "8px";
}
