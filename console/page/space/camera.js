// From where the arm is looked at, and where a point is on the screen.

import { cross, dot, minus, plus, times, unit } from "./vectors.js";

/** What is nearer to the eye is not drawn [m]. */
const NEAR = 0.02;

/**
 * A camera that looks at `middle` out of the direction `back` [unit vector], with `up` upwards. `half` is how much of
 * the world is above the middle [m]; an angle of view of 0 [rad] has no perspective. `region` is where it draws:
 * left, top, width, height [pixels].
 */
export function camera({ middle, back, up, half, angle }, region) {
  const right = unit(cross(up, back));
  const above = cross(back, right);
  const scale = Math.min(region.height, region.width) / 2 / half;
  const distance = angle > 0 ? half / Math.tan(angle / 2) : 0;
  const eye = plus(middle, back, distance);
  const [cx, cy] = [region.left + region.width / 2, region.top + region.height / 2];
  const own = {
    right, up: above, back, eye, region, scale, middle, flat: angle <= 0,
    /** How far a point is in front of the eye [m]; without perspective, of the middle. */
    depth: (point) => -dot(minus(point, eye), back),
    /** Pixels a metre where a point is. */
    scaleAt: (point) => (angle > 0 ? (scale * distance) / Math.max(NEAR, own.depth(point)) : scale),
    /** Where a point is on the screen; null where it is behind the eye. */
    at: (point) => {
      const way = minus(point, eye);
      const deep = -dot(way, back);
      if (angle > 0 && deep < NEAR) return null;
      const size = angle > 0 ? (scale * distance) / deep : scale;
      return [cx + dot(way, right) * size, cy - dot(way, above) * size];
    },
    /** The part of a line or a closed outline that is before the eye, on the screen. */
    outline: (points, closed) => clipped(points, own, angle > 0, closed).map(own.at).filter(Boolean),
    /** Whether a face with that normal, through that point, is seen from its front. */
    faces: (normal, point) => dot(normal, angle > 0 ? minus(eye, point) : back) > 0,
  };
  return own;
}

function clipped(points, own, needed, closed) {
  if (!needed) return points;
  const kept = [];
  const last = closed ? points.length : points.length - 1;
  for (let n = 0; n <= last; n++) {
    const here = points[n % points.length];
    const next = points[(n + 1) % points.length];
    const [a, b] = [own.depth(here) - NEAR * 1.01, own.depth(next) - NEAR * 1.01];
    if (a >= 0 && n < points.length) kept.push(here);
    if (n < last && a * b < 0) kept.push(plus(here, minus(next, here), a / (a - b)));
  }
  return kept;
}

/** The direction out of which one looks, by azimuth from x and elevation [rad]. */
export function from(azimuth, elevation) {
  const flat = Math.cos(elevation);
  return [flat * Math.cos(azimuth), flat * Math.sin(azimuth), Math.sin(elevation)];
}

/** Behind a tool that points along `ahead`, at the side on which the base is, as a camera on the wrist looks at the tip. */
export function behindTool(tip, ahead, size) {
  const towards = minus([0, 0, 0], tip);
  const side = unit(minus(towards, times(ahead, dot(towards, ahead))), [0, 0, 1]);
  const back = unit(plus(times(ahead, -0.85), side, 0.62));
  return { middle: tip, back, up: times(side, -1), half: size, angle: 0.9 };
}
