// One strip chart on a canvas: curves over the last seconds, on up to two axes, marks of events, a cursor.

import { fixed, ticks } from "../common/numbers.js";
import { colours, fitted } from "../common/theme.js";

const FONT = '10.5px system-ui, "DejaVu Sans", sans-serif';
const TONES = { ok: "quiet", warning: "warn", error: "bad", stale: "bad" };

/** The margins of a chart [px]; the right one is for a second axis. */
export function frame(chart, width, height) {
  const second = chart.curves.some((curve) => curve.axis === "right");
  return { left: 38, right: width - (second ? 30 : 2), top: 4, bottom: height - 15 };
}

const missing = (value) => value === null || value === undefined;

/** The range of an axis that holds `columns`: at least `least` long, from zero where `zero` says so. */
function range(columns, least, zero) {
  let [low, high] = [zero ? 0 : Infinity, zero ? 0 : -Infinity];
  for (const values of columns) {
    for (const value of values) {
      if (missing(value)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(high >= low)) [low, high] = [0, least];
  if (high - low < least) {
    const middle = (low + high) / 2;
    [low, high] = zero ? [0, least] : [middle - least / 2, middle + least / 2];
  }
  const room = (high - low) * 0.06;
  return [zero ? 0 : low - room, high + room];
}

function axis(c, { low, high, y, at, align, grid, colour }, box) {
  const marks = ticks(low, high, 4);
  const decimals = Math.max(0, Math.ceil(-Math.log10(marks.step) - 1e-9));
  c.textAlign = align;
  for (const value of marks.values) {
    if (grid) {
      c.strokeStyle = colours.grid;
      c.beginPath();
      c.moveTo(box.left, y(value));
      c.lineTo(box.right, y(value));
      c.stroke();
    }
    c.fillStyle = colour;
    c.fillText(fixed(value, decimals), at, y(value) + 3.5);
  }
}

function vertical(c, x, box, colour, dash) {
  c.strokeStyle = colour;
  c.setLineDash(dash);
  c.beginPath();
  c.moveTo(x, box.top);
  c.lineTo(x, box.bottom);
  c.stroke();
  c.setLineDash([]);
}

/**
 * Draws `chart` with what `columns` hold, a list of values a curve at the times `times` [s]; from `from` on, `span` long.
 * `events` are marked, and `cursor` [s], where there is one.
 */
export function drawChart(chart, { times, columns, from, span, events, cursor }) {
  const { context: c, width, height } = fitted(chart.canvas);
  if (width < 10) return;
  const box = frame(chart, width, height);
  const x = (t) => box.left + ((t - from) / span) * (box.right - box.left);
  c.clearRect(0, 0, width, height);
  c.font = FONT;
  c.lineWidth = 1;
  const sides = {};
  for (const [side, least] of [["left", chart.least], ["right", chart.leastRight]]) {
    const own = columns.filter((_, number) => (chart.curves[number].axis || "left") === side);
    if (!own.length) continue;
    const [low, high] = range(own, least, chart.zero);
    sides[side] = { low, high, y: (value) => box.bottom - ((value - low) / (high - low)) * (box.bottom - box.top) };
  }
  axis(c, { ...sides.left, at: box.left - 5, align: "right", grid: true, colour: colours.quiet }, box);
  if (sides.right) {
    const curve = chart.curves.find((own) => own.axis === "right");
    axis(c, { ...sides.right, at: box.right + 5, align: "left", grid: false, colour: colours[curve.colour] }, box);
  }
  c.fillStyle = colours.quiet;
  c.textAlign = "left";
  c.fillText(`−${span} s`, box.left, height - 3);
  c.textAlign = "right";
  c.fillText("now", box.right, height - 3);
  for (const event of events) {
    const at = x(event.t);
    if (at < box.left || at > box.right) continue;
    const colour = colours[TONES[event.level] || "quiet"];
    vertical(c, at, box, colour, [2, 3]);
    c.fillStyle = colour;
    c.beginPath();
    c.moveTo(at - 3.5, box.top - 4);
    c.lineTo(at + 3.5, box.top - 4);
    c.lineTo(at, box.top + 2);
    c.fill();
  }
  chart.curves.forEach((curve, number) => {
    const { y } = sides[curve.axis || "left"];
    c.strokeStyle = colours[curve.colour];
    c.lineWidth = 1.6;
    c.setLineDash(curve.dash || []);
    c.beginPath();
    let drawing = false;
    columns[number].forEach((value, n) => {
      if (missing(value)) { drawing = false; return; }
      if (drawing) c.lineTo(x(times[n]), y(value)); else c.moveTo(x(times[n]), y(value));
      drawing = true;
    });
    c.stroke();
  });
  c.setLineDash([]);
  c.lineWidth = 1;
  if (cursor !== null) vertical(c, x(cursor), box, colours.text, []);
}
