// Shapes made of flat faces: points [m], and for each face the numbers of its corners, seen from outside against the clock.

import { along, cross, length, minus, point, unit } from "./vectors.js";

/** Faces around a body, seen large. */
const SIDES = 28;
/** A face is no longer than that [m], as far as it has no more than so many along an edge: so faces are sorted by distance. */
const CELL = 0.06;
const MOST_CELLS = 8;

const cells = (size) => Math.min(MOST_CELLS, Math.max(1, Math.ceil(size / CELL)));

function body(points, faces) {
  const normals = faces.map(([a, b, c]) => unit(cross(minus(points[b], points[a]), minus(points[c], points[a]))));
  return { points, faces, normals };
}

/** Rings of points [radius, z] about z, joined; a ring of radius 0 is a point. With `lids` the outermost are closed. */
function turnedProfile(profile, sides, lids = false) {
  const points = [];
  const rings = profile.map(([radius, z]) => {
    const count = radius > 1e-9 ? sides : 1;
    const begin = points.length;
    for (let n = 0; n < count; n++) {
      const angle = (2 * Math.PI * n) / sides;
      points.push([radius * Math.cos(angle), radius * Math.sin(angle), z]);
    }
    return (n) => begin + (n % count);
  });
  const faces = [];
  for (let k = 1; k < rings.length; k++) {
    for (let n = 0; n < sides; n++) {
      const corners = [rings[k - 1](n), rings[k - 1](n + 1), rings[k](n + 1), rings[k](n)];
      const own = corners.filter((corner, index) => corner !== corners[(index + 3) % 4]);
      if (own.length > 2) faces.push(own);
    }
  }
  if (lids) {
    const all = Array.from({ length: sides }, (_, n) => n);
    faces.push(all.map(rings[0]).reverse(), all.map(rings[rings.length - 1]));
  }
  return body(points, faces);
}

/** About the origin. */
export function sphere(radius, sides = SIDES) {
  const rings = 16;
  const profile = Array.from({ length: rings + 1 }, (_, k) => {
    const angle = -Math.PI / 2 + (Math.PI * k) / rings;
    return [k === 0 || k === rings ? 0 : radius * Math.cos(angle), radius * Math.sin(angle)];
  });
  return turnedProfile(profile, sides);
}

/** Along z, its middle in the origin; the edges are broken. */
export function cylinder(radius, height, sides = SIDES) {
  const [half, edge] = [height / 2, Math.min(radius, height) * 0.12];
  const count = cells(height);
  const mantle = Array.from({ length: count + 1 }, (_, k) => [radius, (half - edge) * ((2 * k) / count - 1)]);
  return turnedProfile([[radius - edge, -half], ...mantle, [radius - edge, half]], sides, true);
}

/** From a to b, with a ball of its own radius at each end. */
export function capsule(a, b, first, second, sides = SIDES) {
  const way = minus(b, a);
  const far = length(way);
  // Where a cone touches both balls.
  const slope = far > 1e-9 ? Math.asin(Math.max(-1, Math.min(1, (first - second) / far))) : 0;
  const arc = (radius, from, to, z) => Array.from({ length: 5 }, (_, k) => {
    const angle = from + ((to - from) * k) / 4;
    return [Math.abs(Math.cos(angle)) < 1e-6 ? 0 : radius * Math.cos(angle), z + radius * Math.sin(angle)];
  });
  const [below, above] = [arc(first, -Math.PI / 2, slope, 0), arc(second, slope, Math.PI / 2, far)];
  const [begin, end, count] = [below[4], above[0], cells(far)];
  const mantle = Array.from({ length: count - 1 }, (_, k) => begin.map((value, axis) => value + ((end[axis] - value) * (k + 1)) / count));
  const own = turnedProfile([...below, ...mantle, ...above], sides);
  return placed(own, along(a, way));
}

/** About the origin. */
export function box(size) {
  const points = [];
  const faces = [];
  for (let axis = 0; axis < 3; axis++) {
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    const [columns, rows] = [u, v].map((own) => cells(size[own]));
    for (const side of [-1, 1]) {
      const begin = points.length;
      for (let j = 0; j <= rows; j++) {
        for (let i = 0; i <= columns; i++) {
          const corner = [0, 0, 0];
          corner[axis] = (side * size[axis]) / 2;
          corner[u] = size[u] * (i / columns - 0.5);
          corner[v] = size[v] * (j / rows - 0.5);
          points.push(corner);
        }
      }
      const at = (i, j) => begin + j * (columns + 1) + i;
      for (let j = 0; j < rows; j++) {
        for (let i = 0; i < columns; i++) {
          const around = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
          faces.push(side > 0 ? around : around.reverse());
        }
      }
    }
  }
  return body(points, faces);
}

/** From a to b, open at both ends. */
export function cone(a, b, first, second, sides = SIDES) {
  const far = length(minus(b, a));
  const count = cells(far);
  const mantle = Array.from({ length: count + 1 }, (_, k) => [first + ((second - first) * k) / count, (far * k) / count]);
  return placed(turnedProfile(mantle, sides), along(a, minus(b, a)));
}

/** The same in another frame. */
export function placed(own, frame) {
  return body(own.points.map((corner) => point(frame, corner)), own.faces);
}
