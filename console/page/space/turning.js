// The pointer that turns the view: right or middle button, or the left one where it has no hand to move.

import { turn, zoom } from "./views.js";

/** Turn for a pixel [rad], and zoom for a pixel of the wheel [-]. */
const TURN = 0.006;
const WHEEL = 0.0012;

/**
 * Takes such pointers on `canvas` while `on()`. `free()` tells whether the left button turns, too; `changed()` is
 * called when there is something to draw anew.
 */
export function listen(canvas, on, free, changed) {
  let grip = null;
  canvas.addEventListener("contextmenu", (event) => { if (on()) event.preventDefault(); });
  canvas.addEventListener("pointerdown", (event) => {
    if (!on() || grip || !(event.button > 0 || free())) return;
    canvas.setPointerCapture(event.pointerId);
    grip = { id: event.pointerId, x: event.clientX, y: event.clientY };
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (grip?.id !== event.pointerId) return;
    turn((grip.x - event.clientX) * TURN, (event.clientY - grip.y) * TURN);
    Object.assign(grip, { x: event.clientX, y: event.clientY });
    changed();
  });
  const up = (event) => { if (grip?.id === event.pointerId) grip = null; };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("wheel", (event) => {
    // With the hand taken, the wheel moves it away.
    if (!on() || event.defaultPrevented) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * WHEEL));
    changed();
  }, { passive: false });
}
