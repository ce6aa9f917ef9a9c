// The arm at its contour: a close view with what acts there, and the whole arm small in a corner.

import { colours, fitted } from "../common/theme.js";
import { fixed } from "../common/numbers.js";

/** Half of what the close view shows around the nominal tip [m]. */
const HALF = 0.068;
/** Length of force arrows [m/N]. */
const ARROW = 0.0006;
/** Longest arrow [m]. */
const LONGEST = 0.05;

/** Where the tip is for joint angles, and the elbow. */
export function kinematics(about, [q1, q2]) {
  const [l1, l2] = about.lengths;
  const elbow = [l1 * Math.cos(q1), l1 * Math.sin(q1)];
  return { elbow, tip: [elbow[0] + l2 * Math.cos(q1 + q2), elbow[1] + l2 * Math.sin(q1 + q2)] };
}

/** Where the close view shows a point of the base frame, and back. */
export function view(canvas, about) {
  const { context, width, height } = fitted(canvas);
  const scale = Math.min(width, height) / (2 * HALF);
  const [cx, cy] = about.nominal_tip;
  return {
    context, width, height, scale,
    at: ([x, y]) => [width / 2 + (x - cx) * scale, height / 2 - (y - cy) * scale],
    back: (px, py) => [cx + (px - width / 2) / scale, cy - (py - height / 2) / scale],
  };
}

/** How far apart hand and tip are, where the tip is [m]; null where nobody's hand is there. */
export function apart(about, snapshot) {
  if (!snapshot.hand || !snapshot.tip) return null;
  const [x, y] = atTip(about, snapshot.hand);
  return Math.hypot(x - snapshot.tip[0], y - snapshot.tip[1]);
}

/** Where the arm brings its tip when the hand is there: from the leader's base frame to the follower's. */
function atTip(about, [x, y]) {
  const offset = about.workspace_offset;
  return [x * about.position_scale + offset[0], y * about.position_scale + offset[1]];
}

function line(context, points, colour, width, dash = []) {
  context.beginPath();
  points.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
}

function disc(context, [x, y], radius, fill, stroke, width = 2) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  if (fill) { context.fillStyle = fill; context.fill(); }
  if (stroke) { context.strokeStyle = stroke; context.lineWidth = width; context.stroke(); }
}

function text(context, words, x, y, colour, align = "left", size = 12, weight = 400) {
  context.font = `${weight} ${size}px system-ui, "DejaVu Sans", sans-serif`;
  context.textAlign = align;
  context.fillStyle = colour;
  context.fillText(words, x, y);
}

/** A coil spring from a to b; `turns` half waves of `width` pixels. */
function coil(context, a, b, turns, width, colour, thick = 1.8) {
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

function arrow(context, from, to, colour, width) {
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

function grid(v, about) {
  const [cx, cy] = about.nominal_tip;
  for (let n = -20; n <= 20; n++) {
    const strong = n === 0;
    const [x] = v.at([cx + n * 0.01, cy]);
    const [, y] = v.at([cx, cy + n * 0.01]);
    const colour = strong ? colours.line : colours.grid;
    if (x >= 0 && x <= v.width) line(v.context, [[x, 0], [x, v.height]], colour, 1);
    if (y >= 0 && y <= v.height) line(v.context, [[0, y], [v.width, y]], colour, 1);
  }
}

function edges(v, about) {
  for (const edge of about.edges) {
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

function springs(v, about, tip) {
  for (const spring of about.springs) {
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

function labels(v, about) {
  const [cx, cy] = about.nominal_tip;
  const place = {
    unlubricated: [[0.0338, 0.052], "left", "bare edge"],
    lubricated: [[-0.056, -0.0385], "left", "lubricated edge"],
  };
  for (const edge of about.edges) {
    const known = place[edge.surface];
    if (!known) continue;
    const [x, y] = v.at([cx + known[0][0], cy + known[0][1]]);
    text(v.context, known[2], Math.min(x, v.width - 74) + 8, y, colours.quiet, known[1]);
  }
  const [x, y] = [16, v.height - 16];
  line(v.context, [[x, y - 5], [x, y], [x + v.scale * 0.01, y], [x + v.scale * 0.01, y - 5]], colours.text, 1.5);
  text(v.context, "10 mm", x + v.scale * 0.01 + 8, y + 1, colours.quiet);
}

/** The arm's last link, from the elbow to the tip, as a translucent body. */
function limb(v, about, q, colour, alpha, dash) {
  const { elbow, tip } = kinematics(about, q);
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

function inset(v, about, snapshot) {
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
  for (const edge of about.edges) line(c, [at(edge.from), at(edge.to)], colours.wall, 1.5);
  if (snapshot.q) {
    const { elbow, tip } = kinematics(about, snapshot.q);
    c.lineCap = c.lineJoin = "round";
    line(c, [at([0, 0]), at(elbow), at(tip)], colours.measured, 5);
    c.lineCap = "butt";
    disc(c, at([0, 0]), 4.5, colours.panel, colours.measured);
    disc(c, at(elbow), 4, colours.panel, colours.measured);
    disc(c, at(tip), 2.5, colours.model);
  }
  text(c, "whole arm", left + 8, top + size - 8, colours.quiet, "left", 11);
}

/**
 * Draws `snapshot`. `delayed` is the snapshot that the operator would see
 * now, or null; `target` where the pointer wants the tip, or null.
 */
export function draw(canvas, about, snapshot, delayed, target) {
  const v = view(canvas, about);
  const c = v.context;
  c.clearRect(0, 0, v.width, v.height);
  grid(v, about);
  edges(v, about);
  springs(v, about, snapshot.tip);
  labels(v, about);

  const place = (point) => atTip(about, point);
  const hand = snapshot.hand && place(snapshot.hand);
  // Of an arm in space only the tip is drawn, seen from above.
  const planar = about.lengths.length === 2;
  const drawnTip = planar && snapshot.q && limb(v, about, snapshot.q, colours.measured, 0.22);
  const tip = snapshot.tip || drawnTip;
  if (delayed?.q) {
    const seen = planar && limb(v, about, delayed.q, colours.second, 0.9, true);
    if (delayed.tip || seen) disc(c, v.at(delayed.tip || seen), 8, null, colours.second, 2);
  }
  if (hand) {
    if (target) {
      const [a, b] = [v.at(hand), v.at(place(target))];
      if (Math.hypot(a[0] - b[0], a[1] - b[1]) > 6) coil(c, a, b, 10, 6, colours.hand, 1.6);
      disc(c, b, 4, colours.hand);
    }
    disc(c, v.at(hand), 10, null, colours.hand, 2.5);
    force(v, v.at(hand), hand, snapshot.hand_force, about.hand_arrow, colours.hand);
  }
  if (tip) {
    disc(c, v.at(tip), 6.5, colours.model, colours.panel, 1.5);
    if (snapshot.contact.on) force(v, v.at(tip), tip, snapshot.force, 1, colours.force, true);
  }
  if (planar) inset(v, about, snapshot);
  else text(c, "seen from above", v.width - 16, v.height - 16, colours.quiet, "right");
}

function force(v, from, point, [fx, fy], gain, colour, label) {
  const size = Math.hypot(fx, fy);
  if (size < 0.2) return;
  const length = Math.min(size * ARROW * gain, LONGEST);
  const to = v.at([point[0] + (fx / size) * length, point[1] + (fy / size) * length]);
  arrow(v.context, from, to, colour, 4);
  if (!label) return;
  const words = `${fixed(size, 1)} N`;
  const x = Math.min(Math.max(to[0] + (fx >= 0 ? 10 : -10), 40), v.width - 40);
  v.context.strokeStyle = colours.panel;
  v.context.lineWidth = 4;
  v.context.font = '600 14px system-ui, "DejaVu Sans", sans-serif';
  v.context.textAlign = fx >= 0 ? "left" : "right";
  v.context.strokeText(words, x, to[1] - 8);
  text(v.context, words, x, to[1] - 8, colour, fx >= 0 ? "left" : "right", 14, 600);
}
