// The operator's hand: pointer or keys on the scene become a target for the master.

import { operates, send, session } from "./connection.js";
import { axes } from "./picture.js";

/** How far an arrow key moves the hand [m]. */
const KEY_STEP = 0.001;
/** How far a line of the wheel moves it away [m], and how many pixels of the wheel are a line. */
const WHEEL_STEP = 0.001;
const WHEEL_LINE = 40;

let target = null;
let grip = null;
let sent = 0;

/** Where this page wants the hand [m], leader base frame; null while it does not hold it. */
export function wanted() {
  return target;
}

function move(point) {
  const { reach } = session.about;
  target = point.map((value, axis) => Math.min(reach[axis], Math.max(-reach[axis], value)));
}

/** Where a hand would begin [m]: where the one is that is there, else where the tip is. */
function begin() {
  return session.now?.begin || [0, 0, 0];
}

/** Takes the hand where the tip is, if nobody else's is on the master: an arm that nobody moves pauses again at once. */
export function takeHere() {
  const holder = session.now.authority?.holder ?? "nobody";
  if (!target && (holder === "nobody" || holder === "page")) move(begin());
}

/** Lets the hand go. */
export function letGo() {
  if (!target) return;
  target = null;
  grip = null;
  send({ type: "let_go" });
}

/** Whether a pointer holds the hand. */
export function gripped() {
  return grip !== null;
}

/** Moves the hand on by `way` [m], leader base frame; takes it where it is not held yet. */
export function carry(way) {
  move((target || begin()).map((value, axis) => value + way[axis]));
  touched = true;
}

/** `from`, moved by so many metres of the hand along those directions. */
function along(from, ...ways) {
  return ways.reduce((at, [direction, way]) => at.map((value, axis) => value + way * direction[axis]), from);
}

/**
 * Takes pointers and keys on `canvas`; `refuse` is told when the page only watches, and `turns` whether the pointer is
 * to turn the view instead.
 */
export function listen(canvas, refuse, turns) {
  canvas.addEventListener("pointerdown", (event) => {
    if (!session.about || event.button > 0 || turns()) return;
    if (!operates()) {
      refuse();
      return;
    }
    const plane = axes(canvas, session.about);
    if (!plane) return;
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    const start = target || begin();
    // The hand is gripped where it is, not moved to the pointer, and stays in the plane in which it is gripped.
    grip = { id: event.pointerId, plane, from: start, x: event.clientX, y: event.clientY };
    // For those who look at the page by a program.
    canvas.dataset.grip = start.join(" ");
    move(start);
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (grip?.id !== event.pointerId || !target) return;
    const { right, up, scale } = grip.plane;
    const metre = scale * session.about.position_scale;
    move(along(grip.from, [right, (event.clientX - grip.x) / metre], [up, (grip.y - event.clientY) / metre]));
  });
  canvas.addEventListener("wheel", (event) => {
    const away = grip?.plane.away;
    if (!away || !target) return;
    event.preventDefault();
    // The pointer goes on from there.
    grip.from = along(grip.from, [away, (-event.deltaY / WHEEL_LINE) * WHEEL_STEP]);
    move(along(target, [away, (-event.deltaY / WHEEL_LINE) * WHEEL_STEP]));
    touched = true;
  }, { passive: false });
  // Who releases the pointer lets go, whatever the arm is doing: nothing goes on pulling.
  const up = (event) => {
    if (grip?.id === event.pointerId) letGo();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("lostpointercapture", up);
  canvas.addEventListener("keydown", (event) => {
    const way = {
      ArrowLeft: ["right", -1], ArrowRight: ["right", 1], ArrowUp: ["up", 1], ArrowDown: ["up", -1],
      PageUp: ["away", 1], PageDown: ["away", -1],
    }[event.key];
    if (event.key === " ") {
      letGo();
      event.preventDefault();
    }
    const direction = way && session.about && axes(canvas, session.about)?.[way[0]];
    if (!direction) return;
    event.preventDefault();
    if (!operates()) {
      refuse();
      return;
    }
    const step = KEY_STEP * (event.shiftKey ? 5 : 1);
    move(along(target || begin(), [direction, way[1] * step]));
    touched = true;
  });
  document.addEventListener("visibilitychange", () => {
    if (document.hidden) letGo();
  });
}

let touched = false;
let last = null;

/**
 * Says that the page is alive, and where the hand is wanted. Called from the
 * loop that draws: a page that is hidden or frozen does not say so.
 */
export function beat(now) {
  if (!operates()) {
    target = null;
    grip = null;
    return;
  }
  // The server let go for us: silence, idleness, a stop.
  if (target && session.now.seat.let_go && !session.now.seat.target && now - sent > 400 && !grip) target = null;
  const moved = target && (grip || touched || !last || last.some((value, axis) => value !== target[axis]));
  if (moved && now - sent >= 14) {
    send({ type: "hand", x: target[0], y: target[1], z: target[2] });
    last = target;
    touched = false;
    sent = now;
  } else if (now - sent >= 60) {
    send({ type: "beat" });
    sent = now;
  }
  if (!target) last = null;
}
