// The views of an arm in space, and how each is turned and zoomed.

import { ball, frames, reach } from "./arm.js";
import { atTip } from "../common/mapping.js";
import { behindTool, camera, from } from "./camera.js";
import { direction, length, minus, unit } from "./vectors.js";

/** Their names, the one of the beginning first. */
export const VIEWS = ["orbit", "top", "side", "tool"];
/** Azimuth and elevation of the first look [rad], and the angle of view. */
const FIRST = [-0.95, 0.36];
const ANGLE = 0.5;
/** Bounds of elevation [rad] and zoom [-]. */
const STEEPEST = 1.5;
const ZOOM = [0.15, 12];

const state = { view: VIEWS[0], azimuth: FIRST[0], elevation: FIRST[1], zoom: 1 };
let around = null;

/** Which view is shown. */
export function shown() {
  return state.view;
}

/** Shows a view, as it is at first. */
export function show(view) {
  Object.assign(state, { view, azimuth: FIRST[0], elevation: FIRST[1], zoom: 1 });
}

/** Turns the view by so many radians; from a fixed view it goes on as an orbit from there. */
export function turn(azimuth, elevation) {
  if (state.view !== "orbit") {
    const begin = { top: [-Math.PI / 2, STEEPEST], side: [-Math.PI / 2, 0.05], tool: FIRST }[state.view];
    [state.azimuth, state.elevation] = begin;
    if (state.view !== "tool") state.zoom = 1;
    state.view = "orbit";
  }
  state.azimuth += azimuth;
  state.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, state.elevation + elevation));
}

/** Zooms in (> 1) or out. */
export function zoom(factor) {
  state.zoom = Math.max(ZOOM[0], Math.min(ZOOM[1], state.zoom * factor));
}

/** Forgets the arm that was looked at. */
export function forget() {
  around = null;
  show(VIEWS[0]);
}

/** What the hand can bring the tip to [m], half of it. */
function workspace(about) {
  return Math.max(0.03, Math.max(...about.reach) * about.position_scale);
}

function orbit(about, placed, azimuth, elevation, magnified, tip) {
  const { spatial } = about;
  if (!around) around = ball(spatial.home.length ? frames(spatial, spatial.home) : placed);
  // Zoomed in, one looks at the tip.
  const share = Math.min(1, Math.max(0, Math.log2(magnified) / 2));
  const middle = around.middle.map((value, axis) => value + share * (tip[axis] - value));
  return { middle, back: from(azimuth, elevation), up: [0, 0, 1], half: (1.16 * around.radius) / magnified, angle: ANGLE };
}

/** Close to where the tip works, from one side, without perspective. */
function close(about, back, up, magnified) {
  return { middle: atTip(about, [0, 0, 0]), back, up, half: (1.35 * workspace(about)) / magnified, angle: 0 };
}

/** The direction in which the tool points. */
function ahead(placed) {
  const [before, tip] = placed.slice(-2);
  const way = minus(tip.at, before.at);
  return length(way) > 1e-3 ? unit(way) : direction(tip, [0, 0, 1]);
}

/** The camera of a view for an arm with those frames; `placed` ends with that of the tip. */
export function look(about, placed, region, view = state.view) {
  const tip = placed[placed.length - 1].at;
  const magnified = view === state.view ? state.zoom : 1;
  const small = Math.min(0.09, 0.06 * reach(about.spatial));
  const ways = {
    orbit: () => orbit(about, placed, view === state.view ? state.azimuth : FIRST[0], view === state.view ? state.elevation : FIRST[1], magnified, tip),
    top: () => close(about, [0, 0, 1], [0, 1, 0], magnified),
    side: () => close(about, [0, -1, 0], [0, 0, 1], magnified),
    tool: () => behindTool(tip, ahead(placed), small / magnified),
  };
  return camera(ways[view](), region);
}
