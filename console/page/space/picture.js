// The arm in space: its links, what it can touch, what acts, and what the operator sees of it.

import { coil, disc, endOf, arrow, line, newtons, scaleBar, text } from "../common/strokes.js";
import { atTip } from "../common/mapping.js";
import { fixed } from "../common/numbers.js";
import { colours, fitted } from "../common/theme.js";
import { frames, reach } from "./arm.js";
import { ofArm, ofThings, springHead } from "./bodies.js";
import { floor, patch, plane } from "./ground.js";
import { paint } from "./painter.js";
import { dot, length, minus, plus, unit } from "./vectors.js";
import { look, shown, VIEWS } from "./views.js";

/** The way of a tip down to a plane is told as far as that [m]. */
const NEAR_PLANE = 0.15;
/** How the arm is seen through in views that it stands before [-]. */
const THROUGH = { top: 0.3 };
/** Faces around a link, in the picture and in its corner. */
const FINE = 28;
const COARSE = 12;

let made = null;
let layer = null;
let last = null;

/** The solids of a session's arm and world, made once. */
function model(about) {
  if (made?.about === about) return made;
  const { spatial } = about;
  const things = spatial.things;
  const size = 0.42 * reach(spatial);
  const middle = atTip(about, [0, 0, 0]);
  made = {
    about,
    arm: ofArm(spatial, FINE),
    small: ofArm(spatial, COARSE),
    things: ofThings(things),
    springs: things.filter(({ shape }) => shape.kind === "disc"),
    planes: things.filter(({ shape }) => shape.kind === "plane").map(({ name, shape }) => ({ name, ...patch(shape, middle, size) })),
  };
  return made;
}

const tone = (name) => colours[{ link: "link", joint: "joint", tool: "tool", thing: "thing" }[name]];

/** The arm, by its frames; through a layer of its own where one can see through it. */
function arm(context, eye, own, { placed, alpha, small }) {
  const parts = (small ? own.small : own.arm).map(({ link, tone: name, solid }) => ({ frame: placed[link], solid, colour: tone(name) }));
  const rest = own.things.map(({ tone: name, solid }) => ({ solid, colour: tone(name) }));
  if (alpha === undefined) return paint(context, eye, [...rest, ...parts]);
  const count = paint(context, eye, rest);
  layer ||= document.createElement("canvas");
  Object.assign(layer, { width: context.canvas.width, height: context.canvas.height });
  const other = layer.getContext("2d");
  other.setTransform(context.getTransform());
  const more = paint(other, eye, parts);
  context.save();
  context.globalAlpha = alpha;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.drawImage(layer, 0, 0);
  context.restore();
  return count + more;
}

function springs(context, eye, own, tip) {
  let count = 0;
  for (const { shape } of own.springs) {
    const { head, foot, solid } = springHead(shape, tip);
    const [a, b] = [eye.at(foot), eye.at(head)];
    if (!a || !b) continue;
    coil(context, a, b, 14, Math.max(4, 0.6 * shape.radius * eye.scaleAt(head)), colours.wall);
    count += paint(context, eye, [{ solid, colour: colours.thing }]);
  }
  return count;
}

/** How far the tip is above the nearest plane. */
function height(context, eye, own, tip) {
  const heights = own.planes.map((each) => ({ each, high: dot(each.out, minus(tip, each.middle)) }));
  const nearest = heights.filter(({ high }) => high > 0.0005 && high < NEAR_PLANE).sort((a, b) => a.high - b.high)[0];
  if (!nearest) return;
  const foot = plus(tip, nearest.each.out, -nearest.high);
  const [a, b] = [eye.at(tip), eye.at(foot)];
  if (!a || !b || Math.hypot(a[0] - b[0], a[1] - b[1]) < 14) return;
  line(context, [a, b], colours.quiet, 1.2, [2, 3]);
  disc(context, b, 2.5, colours.quiet);
  text(context, `${fixed(nearest.high * 1e3, 1)} mm`, b[0] - 9, (a[1] + b[1]) / 2 + 4, colours.quiet, { align: "right", size: 11.5, halo: true });
}

/** The arm as the operator sees it: dashed, along its links. */
function ghost(context, eye, about, q) {
  const ends = frames(about.spatial, q).map((own) => own.at);
  const seen = eye.outline(ends, false);
  if (seen.length > 1) line(context, seen, colours.second, 2, [6, 5]);
  const tip = eye.at(ends[ends.length - 1]);
  if (tip) disc(context, tip, 8, null, colours.second, 2);
}

function force(context, eye, from, vector, gain, colour, told) {
  const end = endOf(from, vector, gain);
  const [a, b] = [eye.at(from), end && eye.at(end)];
  if (!a || !b) return;
  arrow(context, a, b, colour, 4);
  if (told) newtons(context, length(vector), b, b[0] >= a[0], eye.region.width, colour);
}

/** Hand, its target and force, the tip and what it feels. */
function acting(context, eye, about, snapshot, tip, target) {
  const hand = snapshot.hand && atTip(about, snapshot.hand);
  const at = hand && eye.at(hand);
  if (at) {
    const wanted = target && eye.at(atTip(about, target));
    if (wanted) {
      if (Math.hypot(at[0] - wanted[0], at[1] - wanted[1]) > 6) coil(context, at, wanted, 10, 6, colours.hand, 1.6);
      disc(context, wanted, 4, colours.hand);
    }
    disc(context, at, 10, null, colours.hand, 2.5);
    if (snapshot.hand_force) force(context, eye, hand, snapshot.hand_force, about.hand_arrow, colours.hand);
  }
  const here = eye.at(tip);
  if (!here) return;
  disc(context, here, 6.5, colours.model, colours.panel, 1.5);
  if (snapshot.contact?.on) force(context, eye, tip, snapshot.force, 1, colours.force, true);
}

/** The directions of the base frame. */
function compass(context, eye, x, y) {
  const size = 20;
  // The longest first: where two lie upon each other, one is enough.
  const axes = ["x", "y", "z"].map((name, axis) => ({ name, way: [eye.right[axis], eye.up[axis]] }));
  axes.sort((a, b) => Math.hypot(...b.way) - Math.hypot(...a.way));
  const told = [];
  for (const { name, way } of axes) {
    if (Math.hypot(...way) < 0.3 || told.some((own) => Math.hypot(own[0] - way[0], own[1] - way[1]) < 0.5)) continue;
    told.push(way);
    line(context, [[x, y], [x + way[0] * size, y - way[1] * size]], colours.quiet, 1.5);
    text(context, name, x + way[0] * (size + 9), y - way[1] * (size + 9) + 4, colours.quiet, { align: "center", size: 11 });
  }
}

/** One picture of it in the region of `eye`; gives how many faces there are. */
function scene(context, eye, about, own, what) {
  const { placed, snapshot, delayed, target } = what;
  const tip = placed[placed.length - 1].at;
  floor(context, eye, reach(about.spatial));
  const ends = placed.map((frame) => frame.at);
  const thick = 0.03 * reach(about.spatial);
  const stylus = { points: ends.slice(-2), radius: thick / 4 };
  // From near, the arm's would be everywhere.
  const shadows = what.near ? [stylus] : [{ points: ends.slice(0, -1), radius: thick }, stylus];
  const [behind, before] = [true, false].map((front) => own.planes.filter((each) => eye.faces(each.out, each.middle) === front));
  behind.forEach((each) => plane(context, eye, each, shadows));
  let count = springs(context, eye, own, tip);
  count += arm(context, eye, own, what);
  before.forEach((each) => plane(context, eye, each, []));
  height(context, eye, own, tip);
  if (delayed?.q) ghost(context, eye, about, delayed.q);
  acting(context, eye, about, snapshot, tip, target);
  return count;
}

/** The other look, small in a corner: the whole arm where the view is close, the tip where it is not. */
function inset(context, eye, about, own, what) {
  const { width, height: high } = eye.region;
  const size = Math.min(190, width * 0.28, high * 0.42);
  const region = { left: width - size - 12, top: high - size - 12, width: size, height: size };
  const view = what.near ? "orbit" : "side";
  context.save();
  context.beginPath();
  context.roundRect(region.left, region.top, size, size, 6);
  context.fillStyle = colours.panel;
  context.strokeStyle = colours.line;
  context.lineWidth = 1;
  context.fill();
  context.stroke();
  context.clip();
  scene(context, look(about, what.placed, region, view), about, own, { ...what, small: true, near: !what.near });
  context.restore();
  text(context, view === "orbit" ? "whole arm" : "tip, from the side", region.left + 8, region.top + size - 8, colours.quiet, { size: 11, halo: true });
}

/**
 * Draws `snapshot`. `delayed` is the snapshot that the operator would see now, or null; `target` where the pointer
 * wants the hand, or null.
 */
export function draw(canvas, about, snapshot, delayed, target) {
  const { context, width, height: high } = fitted(canvas);
  context.clearRect(0, 0, width, high);
  const { spatial } = about;
  const q = snapshot.q?.length === spatial.joints.length ? snapshot.q : null;
  if (!q || !VIEWS.includes(shown())) return;
  const own = model(about);
  const placed = frames(spatial, q);
  const tip = placed[placed.length - 1].at;
  const eye = look(about, placed, { left: 0, top: 0, width, height: high });
  last = { about, eye, tip };
  const what = { placed, snapshot, delayed, target, near: shown() !== "orbit" };
  const faces = scene(context, eye, about, own, { ...what, alpha: THROUGH[shown()] });
  inset(context, eye, about, own, what);
  compass(context, eye, 40, high - 54);
  scaleBar(context, eye.scaleAt(tip), 110, 16, high - 16, eye.flat ? "" : " at the tip");
  const seen = delayed?.q && frames(spatial, delayed.q).at(-1).at;
  // For those who look at the page by a program.
  Object.assign(canvas.dataset, {
    view: shown(), links: own.arm.length, things: spatial.things.length, faces, scale: eye.scaleAt(tip),
    tip: tip.join(" "), measured: (snapshot.tip || []).join(" "), ghost: seen ? seen.join(" ") : "",
  });
}

/**
 * The plane in which a pointer moves the tip: the directions of the base frame that are right, up and away on the
 * screen, and pixels a metre there. Null before anything was drawn.
 */
export function axes(canvas, about) {
  if (last?.about !== about) return null;
  const { eye, tip } = last;
  return { right: eye.right, up: eye.up, away: unit(eye.back.map((value) => -value)), scale: eye.scaleAt(tip) };
}
