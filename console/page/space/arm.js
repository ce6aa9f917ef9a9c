// Where the links of an arm are.

import { frame, HERE, length, minus, then, times, turned } from "./vectors.js";

/**
 * The frames of base, links and tip for joint positions `q` [rad] or [m], in the base frame: one more than there are
 * joints, then the tip's. `arm` is the session's `about.spatial`.
 */
export function frames(arm, q) {
  const found = [HERE];
  arm.joints.forEach((joint, number) => {
    const moved = joint.slides ? { ...HERE, at: times(joint.axis, q[number]) } : turned(joint.axis, q[number]);
    found.push(then(found[number], then(frame(joint.frame), moved)));
  });
  found.push(then(found[found.length - 1], frame(arm.tip)));
  return found;
}

/** How long the arm is, stretched out [m]. */
export function reach(arm) {
  const ways = [...arm.joints.map((joint) => joint.frame), arm.tip];
  return Math.max(0.05, ways.reduce((sum, own) => sum + length(own.at), 0));
}

/** The ball around those frames: its middle and radius [m]. */
export function ball(those) {
  const ends = [0, 1, 2].map((axis) => those.map((own) => own.at[axis]));
  const low = ends.map((values) => Math.min(...values));
  const high = ends.map((values) => Math.max(...values));
  return { middle: low.map((value, axis) => (value + high[axis]) / 2), radius: length(minus(high, low)) / 2 };
}
