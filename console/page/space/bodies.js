// What an arm and its world look like: solids, each in the frame of what carries it.

import { reach } from "./arm.js";
import { box, capsule, cone, cylinder, placed, sphere } from "./solids.js";
import { along, frame, length, plus, rolled, unit } from "./vectors.js";

/** Radii of links that nobody has drawn, at the base and at the wrist, as a share of the arm's length. */
const THICK = 0.04;
const THIN = 0.024;
/** How much of a link is within the housings of its joints, as a share of its radius there. */
const WITHIN = 1;
/** Radius of what such an arm touches with [m]. */
const POINT = 0.003;

const SOLIDS = {
  box: ({ size }) => box(size),
  cylinder: ({ radius, length: height }, sides) => cylinder(radius, height, sides),
  sphere: ({ radius }, sides) => sphere(radius, sides),
};

/** A link from its frame to the next one, where its file does not tell what it looks like. */
function rod(arm, link, whole, sides) {
  const { joints } = arm;
  const radius = (number) => whole * (THICK + ((THIN - THICK) * number) / joints.length);
  const end = link < joints.length ? joints[link].frame.at : arm.tip.at;
  if (length(end) < 1e-3) return [];
  // It stands on a plate.
  const foot = link === 0 ? [{ link, tone: "tool", solid: placed(cylinder(1.9 * radius(0), 0.4 * radius(0), sides), along([0, 0, 0], end)) }] : [];
  if (link < joints.length) {
    const [first, second] = [link, link + 1].map(radius);
    const way = unit(end);
    const between = length(end) - WITHIN * (first + second) > 0;
    const ends = [plus([0, 0, 0], way, link === 0 ? 0 : WITHIN * first), plus(end, way, -WITHIN * second)];
    return between ? [...foot, { link, tone: "link", solid: cone(...ends, first, second, sides) }] : foot;
  }
  // The last one is a stylus: a flange, and a point.
  const [neck, tip] = [0.5, 1].map((share) => plus([0, 0, 0], end, share));
  const back = plus(tip, unit(end), -POINT);
  return [
    { link, tone: "link", solid: capsule([0, 0, 0], neck, radius(link), radius(link) * 0.6, sides) },
    { link, tone: "tool", solid: capsule(neck, back, radius(link) * 0.3, POINT, sides) },
  ];
}

/** The housing of a joint, in the frame of the link that it carries. */
function housing(arm, number, whole, sides) {
  const radius = whole * (THICK + ((THIN - THICK) * number) / arm.joints.length) * 1.16;
  return { link: number + 1, tone: "joint", solid: placed(cylinder(radius, 2.3 * radius, sides), along([0, 0, 0], arm.joints[number].axis)) };
}

/** The solids of an arm (`about.spatial`) with so many faces around: the link that carries it, tone, solid. */
export function ofArm(arm, sides) {
  const whole = reach(arm);
  const drawn = new Set(arm.shapes.map((shape) => shape.link));
  const solids = arm.shapes.map((shape) => ({ link: shape.link, tone: "link", solid: placed(SOLIDS[shape.kind](shape, sides), frame(shape.frame)) }));
  for (let link = 0; link <= arm.joints.length; link++) if (!drawn.has(link)) solids.push(...rod(arm, link, whole, sides));
  arm.joints.forEach((_, number) => { if (!drawn.has(number + 1)) solids.push(housing(arm, number, whole, sides)); });
  return solids;
}

/** The solids of what can be touched; planes and springs are no solids. */
export function ofThings(things) {
  return things.flatMap(({ shape }) => {
    if (shape.kind === "box") return [{ tone: "thing", solid: placed(box(shape.size), rolled(shape.center, shape.roll_pitch_yaw)) }];
    if (shape.kind === "sphere") return [{ tone: "thing", solid: placed(sphere(shape.radius), along(shape.center, [0, 0, 1])) }];
    return [];
  });
}

/** The head of a spring, where it is now: pressed in by the tip as far as that is behind it. */
export function springHead({ center, normal, radius, travel }, tip) {
  const out = unit(normal);
  let pressed = 0;
  if (tip) {
    const away = tip.map((value, axis) => value - center[axis]);
    const depth = -(away[0] * out[0] + away[1] * out[1] + away[2] * out[2]);
    const aside = length(plus(away, out, depth));
    if (depth > 0 && depth <= travel && aside <= radius) pressed = depth;
  }
  const thick = Math.min(0.006, radius * 0.3);
  const head = plus(center, out, -pressed);
  return {
    head, foot: plus(center, out, -travel),
    solid: placed(cylinder(radius, thick), along(plus(head, out, -thick / 2), out)),
  };
}
