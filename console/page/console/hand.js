// The operator's hand: pointer or keys on the scene become a target for the master.

import { operates, send, session } from "./connection.js";
import { view } from "./scene.js";

/** How far an arrow key moves the hand [m]. */
const KEY_STEP = 0.001;
/** The hand reaches this far from the middle [m]. */
const REACH = 0.06;

let target = null;
let grip = null;
let sent = 0;

/** Where this page wants the hand [m], leader base frame; null while it does not hold it. */
export function wanted() {
  return target;
}

function move(point) {
  target = point.map((value) => Math.min(REACH, Math.max(-REACH, value)));
}

/** Where a hand would begin [m]: where the one is that is there, else where the tip is. */
function begin() {
  return session.now?.begin || [0, 0];
}

/** Takes the hand where the tip is, if nobody else's is on the master: an arm that nobody moves pauses again at once. */
export function takeHere() {
  const { holder } = session.now.authority;
  if (!target && (holder === "nobody" || holder === "page")) move(begin());
}

/** Lets the hand go. */
export function letGo() {
  if (!target) return;
  target = null;
  grip = null;
  send({ type: "let_go" });
}

/** Takes pointers and keys on `canvas`; `refuse` is told when the page only watches. */
export function listen(canvas, refuse) {
  const point = (event) => {
    const box = canvas.getBoundingClientRect();
    const offset = session.about.workspace_offset;
    const [x, y] = view(canvas, session.about).back(event.clientX - box.left, event.clientY - box.top);
    const scale = session.about.position_scale;
    return [(x - offset[0]) / scale, (y - offset[1]) / scale];
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (!session.about || event.button > 0) return;
    if (!operates()) {
      refuse();
      return;
    }
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    const start = target || begin();
    const at = point(event);
    // The hand is gripped where it is, not moved to the pointer.
    grip = { id: event.pointerId, from: [start[0] - at[0], start[1] - at[1]] };
    move(start);
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (grip?.id !== event.pointerId || !target) return;
    const at = point(event);
    move([at[0] + grip.from[0], at[1] + grip.from[1]]);
  });
  // Who releases the pointer lets go, whatever the arm is doing: nothing goes on pulling.
  const up = (event) => {
    if (grip?.id === event.pointerId) letGo();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("lostpointercapture", up);
  canvas.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.key === " ") {
      letGo();
      event.preventDefault();
    }
    if (!way || !session.about) return;
    event.preventDefault();
    if (!operates()) {
      refuse();
      return;
    }
    const step = KEY_STEP * (event.shiftKey ? 5 : 1);
    const from = target || begin();
    move([from[0] + way[0] * step, from[1] + way[1] * step]);
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
  const moved = target && (grip || touched || !last || last[0] !== target[0] || last[1] !== target[1]);
  if (moved && now - sent >= 14) {
    send({ type: "hand", x: target[0], y: target[1] });
    last = target;
    touched = false;
    sent = now;
  } else if (now - sent >= 60) {
    send({ type: "beat" });
    sent = now;
  }
  if (!target) last = null;
}
