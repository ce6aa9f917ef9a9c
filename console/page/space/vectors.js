// Vectors of three, and frames: where one is in another.

export const plus = (a, b, gain = 1) => [a[0] + gain * b[0], a[1] + gain * b[1], a[2] + gain * b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);

/** Of length 1; `other` where it has none. */
export function unit(a, other = [0, 0, 1]) {
  const size = length(a);
  return size > 1e-9 ? times(a, 1 / size) : other;
}

/** A unit vector at right angles to the unit vector `a`. */
export function beside(a) {
  return unit(cross(a, Math.abs(a[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
}

/** A frame: origin and the directions of its axes x, y, z. */
export const HERE = { at: [0, 0, 0], axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] };

/** A direction of `frame`, outside it. */
export function direction({ axes: [x, y, z] }, [a, b, c]) {
  return [x[0] * a + y[0] * b + z[0] * c, x[1] * a + y[1] * b + z[1] * c, x[2] * a + y[2] * b + z[2] * c];
}

/** A point of `frame`, outside it. */
export const point = (frame, inner) => plus(frame.at, direction(frame, inner));

/** Where `inner`, which is given in `frame`, is outside it. */
export const then = (frame, inner) => ({ at: point(frame, inner.at), axes: inner.axes.map((axis) => direction(frame, axis)) });

/** The frame at `at` turned by a unit quaternion x, y, z, w. */
export function frame({ at, turn: [x, y, z, w] }) {
  return {
    at,
    axes: [
      [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
      [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
      [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
    ],
  };
}

/** Turned by `angle` [rad] about the unit vector `axis`. */
export function turned(axis, angle) {
  const sine = Math.sin(angle / 2);
  return frame({ at: [0, 0, 0], turn: [...times(axis, sine), Math.cos(angle / 2)] });
}

/** A frame at `at` whose z axis has that direction. */
export function along(at, z) {
  const third = unit(z);
  const first = beside(third);
  return { at, axes: [first, cross(third, first), third] };
}

/** A frame as URDF has it: turned by roll, pitch and yaw [rad] about the fixed axes x, y, z. */
export function rolled(at, [roll, pitch, yaw]) {
  const turn = then(turned([0, 0, 1], yaw), then(turned([0, 1, 0], pitch), turned([1, 0, 0], roll)));
  return { at, axes: turn.axes };
}
