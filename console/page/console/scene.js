// A planar arm at its contour: a close view with what acts there, and the whole arm small in a corner.

import { atTip } from "../common/mapping.js";
import { arrow, coil, disc, endOf, line, newtons, text } from "../common/strokes.js";
import { colours, fitted } from "../common/theme.js";

/** Half of what the close view shows around the nominal tip [m]. */
const HALF = 0.068;

/** Where the tip is for joint angles, and the elbow. */
function kinematics(flat, [q1, q2]) {
  const [l1, l2] = flat.lengths;
  const elbow = [l1 * Math.cos(q1), l1 * Math.sin(q1)];
  return { elbow, tip: [elbow[0] + l2 * Math.cos(q1 + q2), elbow[1] + l2 * Math.sin(q1 + q2)] };
}

/** Where the close view shows a point of the base frame. */
function view(canvas, flat) {
  const { context, width, height } = fitted(canvas);
  const scale = Math.min(width, height) / (2 * HALF);
  const [cx, cy] = flat.nominal_tip;
  return {
    context, width, height, scale,
    at: ([x, y]) => [width / 2 + (x - cx) * scale, height / 2 - (y - cy) * scale],
  };
}

/** The plane in which a pointer moves the tip: what is right and up on the screen, and pixels a metre. */
export function axes(canvas, about) {
  return { right: [1, 0, 0], up: [0, 1, 0], away: null, scale: view(canvas, about.planar).scale };
}

function grid(v, flat) {
  const [cx, cy] = flat.nominal_tip;
  for (let n = -20; n <= 20; n++) {
    const strong = n === 0;
    const [x] = v.at([cx + n * 0.01, cy]);
    const [, y] = v.at([cx, cy + n * 0.01]);
    const colour = strong ? colours.line : colours.grid;
    if (x >= 0 && x <= v.width) line(v.context, [[x, 0], [x, v.height]], colour, 1);
    if (y >= 0 && y <= v.height) line(v.context, [[0, y], [v.width, y]], colour, 1);
  }
}

function edges(v, flat) {
  for (const edge of flat.edges) {
    const [a, b] = [v.at(edge.from), v.at(edge.to)];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const [ux, uy] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    // The free side is on the left of the way in the base frame; on the screen y points down.
    const [ox, oy] = [-uy, ux];
    v.context.save();
    v.context.beginPath();
    v.context.moveTo(...a);
    v.context.lineTo(...b);
    v.context.lineTo(b[0] + ox * 12, b[1] + oy * 12);
    v.context.lineTo(a[0] + ox * 12, a[1] + oy * 12);
    v.context.closePath();
    v.context.fillStyle = colours.raised;
    v.context.fill();
    v.context.clip();
    for (let s = -14; s < length + 14; s += 7) {
      line(v.context, [[a[0] + ux * s, a[1] + uy * s], [a[0] + ux * (s - 10) + ox * 14, a[1] + uy * (s - 10) + oy * 14]], colours.wall, 1);
    }
    v.context.restore();
    line(v.context, [a, b], colours.wall, edge.surface === "lubricated" ? 2 : 3.5);
  }
}

function springs(v, flat, tip) {
  for (const spring of flat.springs) {
    const [dx, dy] = spring.direction;
    let length = spring.rest_length;
    if (tip) {
      const along = (tip[0] - spring.anchor[0]) * dx + (tip[1] - spring.anchor[1]) * dy;
      const across = Math.abs((tip[0] - spring.anchor[0]) * -dy + (tip[1] - spring.anchor[1]) * dx);
      if (across <= spring.half_width && along > 0.005) length = Math.min(length, along);
    }
    const end = [spring.anchor[0] + dx * length, spring.anchor[1] + dy * length];
    const side = (point, sign) => v.at([point[0] - dy * spring.half_width * sign, point[1] + dx * spring.half_width * sign]);
    coil(v.context, v.at(spring.anchor), v.at(end), 12, 9, colours.wall);
    line(v.context, [side(end, -1), side(end, 1)], colours.wall, 3.5);
  }
}

function labels(v, flat) {
  const [cx, cy] = flat.nominal_tip;
  const place = {
    unlubricated: [[0.0338, 0.052], "left", "bare edge"],
    lubricated: [[-0.056, -0.0385], "left", "lubricated edge"],
  };
  for (const edge of flat.edges) {
    const known = place[edge.surface];
    if (!known) continue;
    const [x, y] = v.at([cx + known[0][0], cy + known[0][1]]);
    text(v.context, known[2], Math.min(x, v.width - 74) + 8, y, colours.quiet, { align: known[1] });
  }
  const [x, y] = [16, v.height - 16];
  line(v.context, [[x, y - 5], [x, y], [x + v.scale * 0.01, y], [x + v.scale * 0.01, y - 5]], colours.text, 1.5);
  text(v.context, "10 mm", x + v.scale * 0.01 + 8, y + 1, colours.quiet);
}

/** The arm's last link, from the elbow to the tip, as a translucent body. */
function limb(v, flat, q, colour, alpha, dash) {
  const { elbow, tip } = kinematics(flat, q);
  v.context.save();
  v.context.globalAlpha = alpha;
  v.context.lineCap = "round";
  if (dash) {
    line(v.context, [v.at(elbow), v.at(tip)], colour, 2, [6, 5]);
  } else {
    line(v.context, [v.at(elbow), v.at(tip)], colour, Math.max(14, v.scale * 0.006));
  }
  v.context.restore();
  return tip;
}

function inset(v, flat, snapshot) {
  const size = Math.min(150, v.width * 0.26, v.height * 0.42);
  const [left, top] = [v.width - size - 12, v.height - size - 12];
  const c = v.context;
  c.fillStyle = colours.panel;
  c.strokeStyle = colours.line;
  c.lineWidth = 1;
  c.beginPath();
  c.roundRect(left, top, size, size, 6);
  c.fill();
  c.stroke();
  const scale = size / 0.56;
  const at = ([x, y]) => [left + (x + 0.06) * scale, top + size * 0.42 - y * scale];
  for (const edge of flat.edges) line(c, [at(edge.from), at(edge.to)], colours.wall, 1.5);
  if (snapshot.q) {
    const { elbow, tip } = kinematics(flat, snapshot.q);
    c.lineCap = c.lineJoin = "round";
    line(c, [at([0, 0]), at(elbow), at(tip)], colours.measured, 5);
    c.lineCap = "butt";
    disc(c, at([0, 0]), 4.5, colours.panel, colours.measured);
    disc(c, at(elbow), 4, colours.panel, colours.measured);
    disc(c, at(tip), 2.5, colours.model);
  }
  text(c, "whole arm", left + 8, top + size - 8, colours.quiet, { size: 11 });
}

/**
 * Draws `snapshot`. `delayed` is the snapshot that the operator would see
 * now, or null; `target` where the pointer wants the tip, or null.
 */
export function draw(canvas, about, snapshot, delayed, target) {
  const flat = about.planar;
  const v = view(canvas, flat);
  const c = v.context;
  c.clearRect(0, 0, v.width, v.height);
  grid(v, flat);
  edges(v, flat);
  springs(v, flat, snapshot.tip);
  labels(v, flat);

  const hand = snapshot.hand && atTip(about, snapshot.hand);
  const drawnTip = snapshot.q && limb(v, flat, snapshot.q, colours.measured, 0.22);
  const tip = snapshot.tip || drawnTip;
  if (delayed?.q) {
    const seen = limb(v, flat, delayed.q, colours.second, 0.9, true);
    disc(c, v.at(delayed.tip || seen), 8, null, colours.second, 2);
  }
  if (hand) {
    if (target) {
      const [a, b] = [v.at(hand), v.at(atTip(about, target))];
      if (Math.hypot(a[0] - b[0], a[1] - b[1]) > 6) coil(c, a, b, 10, 6, colours.hand, 1.6);
      disc(c, b, 4, colours.hand);
    }
    disc(c, v.at(hand), 10, null, colours.hand, 2.5);
    if (snapshot.hand_force) force(v, hand, snapshot.hand_force, about.hand_arrow, colours.hand);
  }
  if (tip) {
    disc(c, v.at(tip), 6.5, colours.model, colours.panel, 1.5);
    if (snapshot.contact?.on) force(v, tip, snapshot.force, 1, colours.force, true);
  }
  inset(v, flat, snapshot);
}

function force(v, [x, y], [fx, fy], gain, colour, told) {
  const end = endOf([x, y], [fx, fy], gain);
  if (!end) return;
  const to = v.at(end);
  arrow(v.context, v.at([x, y]), to, colour, 4);
  if (told) newtons(v.context, Math.hypot(fx, fy), to, fx >= 0, v.width, colour);
}
