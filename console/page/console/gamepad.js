// A gamepad moves the operator's hand, as long as one of its triggers is held.
//
// The left stick moves it over the ground as the picture shows that: to the right, and away. The right stick moves it up
// and down. Who releases the trigger, unplugs the pad, or leaves the page lets go. What is where on a pad is that of the
// standard gamepad of W3C's Gamepad.

import { operates, session } from "./connection.js";
import * as hand from "./hand.js";
import { axes } from "./picture.js";

/** Share of a stick's way that counts as its middle. */
const DEAD_ZONE = 0.15;
/** How fast a stick at its end moves the hand [m/s], and how quickly that changes at most [m/s²]. */
const SPEED = 0.05;
const ACCELERATION = 0.4;
/** A trigger that is pulled so far takes the hand; one that is let out so far lets it go. */
const TAKES = 0.5;
const LETS_GO = 0.3;
/** Longest time between two looks that counts [s]. */
const LONGEST = 0.05;
/** Buttons: both triggers, and the right one of the four (B, or the circle), which stops. */
const TRIGGERS = [6, 7];
const STOP = 1;
/** Axes: the left stick's two, and the right stick's second. All count to the right and downwards. */
const [LEFT_X, LEFT_Y, RIGHT_Y] = [0, 1, 3];

/** The pad that holds the hand, by its place; null where none does. */
let holder = null;
let velocity = [0, 0, 0];
let looked = null;
/** Pads whose trigger was out since it last did something, and those whose stop was. */
const ready = new Set();
const stops = new Set();

function pads() {
  const all = [...(navigator.getGamepads?.() || [])];
  return all.filter((pad) => pad?.connected && pad.mapping === "standard");
}

/** Whether there is a pad that could move the hand. */
export function present() {
  return pads().length > 0;
}

/** Whether a pad holds the hand. */
export function holds() {
  return holder !== null;
}

const pulled = (pad) => Math.max(...TRIGGERS.map((button) => pad.buttons[button]?.value || 0));

/** Ways of sticks without their middles, 1 at most together. */
function clear(...ways) {
  const far = Math.hypot(...ways);
  if (!(far > DEAD_ZONE)) return ways.map(() => 0);
  const share = Math.min(1, (far - DEAD_ZONE) / (1 - DEAD_ZONE)) / far;
  return ways.map((way) => way * share);
}

/** Where the sticks want the hand to go [m/s], leader base frame, by what is to the right in the picture. */
function wanted(pad, { right: [x, y] }, planar) {
  const [across, down] = clear(pad.axes[LEFT_X] || 0, pad.axes[LEFT_Y] || 0);
  const [sink] = clear(pad.axes[RIGHT_Y] || 0);
  const level = Math.hypot(x, y);
  const [toRight, toBack] = level > 0 ? [x / level, y / level] : [1, 0];
  return [across * toRight + down * toBack, across * toBack - down * toRight, planar ? 0 : -sink].map((share) => SPEED * share);
}

function release() {
  holder = null;
  velocity = [0, 0, 0];
  hand.letGo();
}

function watchStops(all, stop) {
  for (const pad of all) {
    if (!pad.buttons[STOP]?.pressed) stops.add(pad.index);
    else if (stops.delete(pad.index)) stop();
  }
}

/** A pad whose trigger is pulled anew. */
function taking(all) {
  for (const pad of all) {
    if (pulled(pad) < LETS_GO) ready.add(pad.index);
    else if (pulled(pad) >= TAKES && ready.delete(pad.index)) return pad;
  }
  return null;
}

/**
 * Looks at the pads at the time `now` [ms]; called from the loop that draws `canvas`. `stop` is called where a pad's button
 * says so, whoever operates, and `refuse` where one wants the hand while the page only watches.
 */
export function look(now, canvas, stop, refuse) {
  const passed = looked === null ? 0 : Math.min(LONGEST, (now - looked) / 1000);
  looked = now;
  const all = pads();
  watchStops(all, stop);
  const anew = taking(all);
  const hidden = canvas.closest("[hidden]");
  if (holder === null && anew && !hidden) {
    if (!operates()) refuse();
    else if (!hand.gripped()) {
      holder = anew.index;
      hand.carry([0, 0, 0]);
    }
  }
  canvas.dataset.pad = holder ?? "";
  if (holder === null) return;
  const pad = all.find(({ index }) => index === holder);
  // Whoever else let the hand go, or took it, has it: the trigger has to be pulled anew.
  if (!pad || hidden || pulled(pad) < LETS_GO || !operates() || !hand.wanted() || hand.gripped()) {
    if (hand.gripped()) holder = null;
    else release();
    canvas.dataset.pad = "";
    return;
  }
  const plane = axes(canvas, session.about);
  const goal = plane ? wanted(pad, plane, session.about.planar) : [0, 0, 0];
  const change = goal.map((value, axis) => value - velocity[axis]);
  const most = Math.min(1, (ACCELERATION * passed) / (Math.hypot(...change) || 1));
  velocity = velocity.map((value, axis) => value + most * change[axis]);
  hand.carry(velocity.map((value) => value * passed));
}
