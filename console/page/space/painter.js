// Solids on a canvas: faces that look at the eye, shaded, the farthest first. It needs no graphics card.

import { direction, dot, HERE, point, unit } from "./vectors.js";

/** So many shades has a colour. */
const SHADES = 48;
const palettes = new Map();

/** A colour `#rrggbb` from shadow to light. */
function palette(colour) {
  let found = palettes.get(colour);
  if (!found) {
    const parts = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
    found = Array.from({ length: SHADES }, (_, n) => {
      const light = 0.5 + (0.66 * n) / (SHADES - 1);
      const shade = parts.map((part) => Math.round(Math.min(255, light <= 1 ? part * light : part + (255 - part) * (light - 1) * 1.7)));
      return `rgb(${shade.join(",")})`;
    });
    palettes.set(colour, found);
  }
  return found;
}

/**
 * Paints `parts`: frame, solid and colour of each, as `eye`, a camera, sees them. Gives how many faces it painted.
 * Solids that reach into each other come out right but for the width of a face.
 */
export function paint(context, eye, parts) {
  // Light from above at the left of who looks.
  const light = unit([0, 1, 2].map((axis) => eye.back[axis] * 0.62 + eye.up[axis] * 0.66 - eye.right[axis] * 0.42));
  const seen = [];
  for (const { frame = HERE, solid, colour } of parts) {
    const shades = palette(colour);
    const world = solid.points.map((corner) => point(frame, corner));
    const screen = world.map(eye.at);
    solid.faces.forEach((face, number) => {
      const normal = direction(frame, solid.normals[number]);
      if (!eye.faces(normal, world[face[0]])) return;
      const corners = face.map((corner) => screen[corner]);
      if (corners.includes(null)) return;
      const deep = face.reduce((sum, corner) => sum + eye.depth(world[corner]), 0) / face.length;
      const bright = Math.max(0, dot(normal, light));
      seen.push({ corners, deep, fill: shades[Math.round(bright * (SHADES - 1))] });
    });
  }
  seen.sort((a, b) => b.deep - a.deep);
  context.lineWidth = 0.7;
  context.lineJoin = "round";
  for (const { corners, fill } of seen) {
    context.beginPath();
    corners.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.closePath();
    context.fillStyle = context.strokeStyle = fill;
    context.fill();
    // Else the background shines through between faces.
    context.stroke();
  }
  return seen.length;
}
