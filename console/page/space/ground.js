// What lies behind or below the arm: the floor, planes, and the arm's shadow on them.

import { colours } from "../common/theme.js";
import { line } from "../common/strokes.js";
import { beside, cross, dot, minus, plus, unit } from "./vectors.js";

/** Lines of a plane are so far apart at least [m]. */
const STEP = 0.05;
/** What is higher above a plane than that has no shadow there [m], as a share of the plane's width. */
const HIGH = 1.2;

function filled(context, points, colour, alpha) {
  if (points.length < 3) return;
  context.save();
  context.globalAlpha = alpha;
  context.fillStyle = colour;
  context.beginPath();
  points.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.closePath();
  context.fill();
  context.restore();
}

function net(context, eye, middle, u, v, half, step, colour) {
  const count = Math.round(half / step);
  for (let n = -count; n <= count; n++) {
    for (const [a, b] of [[u, v], [v, u]]) {
      const at = plus(middle, a, n * step);
      const ends = eye.outline([plus(at, b, -half), plus(at, b, half)], false);
      if (ends.length > 1) line(context, ends, colour, 1);
    }
  }
}

/** The floor that the arm stands on. */
export function floor(context, eye, size) {
  const step = size > 0.5 ? 0.1 : 0.05;
  net(context, eye, [0, 0, 0], [1, 0, 0], [0, 1, 0], Math.ceil((0.45 * size) / step) * step, step, colours.grid);
}

/** The part of a plane that is drawn: around what is below `over`, `size` wide. */
export function patch({ point, normal }, over, size) {
  const out = unit(normal);
  const middle = plus(over, out, -dot(out, minus(over, point)));
  // Its lines stand where they are, whatever the patch is of.
  const first = Math.abs(out[0]) < 0.9 ? unit(minus([1, 0, 0], out.map((value) => value * out[0]))) : beside(out);
  const second = cross(out, first);
  const corner = (a, b) => plus(plus(middle, first, (a * size) / 2), second, (b * size) / 2);
  return { out, middle, first, second, half: size / 2, corners: [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)] };
}

/** A plane, and on it the shadow of lines: points and radius [m] of each. */
export function plane(context, eye, own, shadows) {
  const outline = eye.outline(own.corners, true);
  if (outline.length < 3) return;
  const front = eye.faces(own.out, own.middle);
  filled(context, outline, front ? colours.table : colours.wall, front ? 0.9 : 0.18);
  context.save();
  context.beginPath();
  outline.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.closePath();
  context.clip();
  if (front) shadow(context, eye, own, shadows);
  net(context, eye, own.middle, own.first, own.second, own.half, Math.max(STEP, own.half / 8), colours.line);
  context.restore();
  line(context, [...outline, outline[0]], colours.wall, 1.5);
}

function shadow(context, eye, own, shadows) {
  const height = (point) => dot(own.out, minus(point, own.middle));
  const below = (point) => plus(point, own.out, -height(point));
  context.save();
  context.globalAlpha = 0.12;
  context.strokeStyle = colours.dark;
  context.lineCap = context.lineJoin = "round";
  for (const { points, radius } of shadows) {
    const low = points.filter((point) => height(point) > -0.01 && height(point) < HIGH * 2 * own.half);
    const [first] = low;
    if (low.length < 2) continue;
    const ends = eye.outline(low.map(below), false);
    if (ends.length < 2) continue;
    context.lineWidth = Math.max(2, 2 * radius * eye.scaleAt(below(first)));
    context.beginPath();
    ends.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.stroke();
  }
  context.restore();
}
