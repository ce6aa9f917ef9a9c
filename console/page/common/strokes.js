// What pictures are drawn with, in pixels of a canvas.

import { colours } from "./theme.js";
import { fixed } from "./numbers.js";

/** A line through points. */
export function line(context, points, colour, width, dash = []) {
  context.beginPath();
  points.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
}

/** A disc, a ring, or both. */
export function disc(context, [x, y], radius, fill, stroke, width = 2) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  if (fill) { context.fillStyle = fill; context.fill(); }
  if (stroke) { context.strokeStyle = stroke; context.lineWidth = width; context.stroke(); }
}

/** Words; with `halo` they stand out from what is behind them. */
export function text(context, words, x, y, colour, { align = "left", size = 12, weight = 400, halo = false } = {}) {
  context.font = `${weight} ${size}px system-ui, "DejaVu Sans", sans-serif`;
  context.textAlign = align;
  if (halo) {
    context.strokeStyle = colours.panel;
    context.lineWidth = 4;
    context.lineJoin = "round";
    context.strokeText(words, x, y);
  }
  context.fillStyle = colour;
  context.fillText(words, x, y);
}

/** A coil spring from a to b; `turns` half waves of `width` pixels. */
export function coil(context, a, b, turns, width, colour, thick = 1.8) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(dx, dy) || 1;
  const [nx, ny] = [-dy / length, dx / length];
  const points = [a];
  for (let n = 1; n <= turns; n++) {
    const along = (n - 0.5) / turns;
    const side = (n % 2 ? 1 : -1) * width;
    points.push([a[0] + dx * along + nx * side, a[1] + dy * along + ny * side]);
  }
  line(context, [...points, b], colour, thick);
}

/** An arrow; none where it would be shorter than its head can be seen. */
export function arrow(context, from, to, colour, width) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (length < 3) return;
  const head = Math.min(11, length * 0.6);
  const [ux, uy] = [dx / length, dy / length];
  const neck = [to[0] - ux * head * 0.8, to[1] - uy * head * 0.8];
  line(context, [from, neck], colour, width);
  context.beginPath();
  context.moveTo(...to);
  context.lineTo(to[0] - ux * head - uy * head * 0.45, to[1] - uy * head + ux * head * 0.45);
  context.lineTo(to[0] - ux * head + uy * head * 0.45, to[1] - uy * head - ux * head * 0.45);
  context.fillStyle = colour;
  context.fill();
}

/** Length of force arrows [m/N], and of the longest [m]. */
const ARROW = 0.0006;
const LONGEST = 0.05;
/** Forces below are not drawn [N]. */
const LEAST = 0.2;

/** Where the arrow of a force [N] at a point [m] ends [m]; null where the force is too small. */
export function endOf(point, force, gain = 1) {
  const size = Math.hypot(...force);
  if (size < LEAST) return null;
  const length = Math.min(size * ARROW * gain, LONGEST);
  return point.map((value, axis) => value + (force[axis] / size) * length);
}

/** The size of a force [N] beside the end of its arrow, within `width` pixels. */
export function newtons(context, size, [x, y], rightwards, width, colour) {
  const at = Math.min(Math.max(x + (rightwards ? 10 : -10), 40), width - 40);
  text(context, `${fixed(size, 1)} N`, at, y - 8, colour, { align: rightwards ? "left" : "right", size: 14, weight: 600, halo: true });
}

/** A length to scale, [0, limit] pixels long at most, from `x`, `y` to the right; `scale` in pixels a metre. */
export function scaleBar(context, scale, limit, x, y, beside = "") {
  const steps = [1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.2, 0.5, 1];
  const step = steps.findLast((own) => own * scale <= limit) || steps[0];
  const end = x + step * scale;
  line(context, [[x, y - 5], [x, y], [end, y], [end, y - 5]], colours.text, 1.5);
  text(context, `${step * 1e3} mm${beside}`, end + 8, y + 1, colours.quiet);
}
