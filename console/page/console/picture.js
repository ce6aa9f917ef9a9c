// Which picture of the arm is shown: a planar one at its contour, or the arm in space.

import { byId, fill, make } from "../common/dom.js";
import * as space from "../space/picture.js";
import * as turning from "../space/turning.js";
import * as views from "../space/views.js";
import { operates, session } from "./connection.js";
import * as scene from "./scene.js";

const NAMES = { contour: "Contour", orbit: "Orbit", top: "Top", side: "Side", tool: "Tool" };
/** Zoom of one click. */
const CLICK = 1.4;

let flat = false;
let turns = false;
let changed = () => {};

const picture = () => (flat ? scene : space);

/** Draws a snapshot. */
export function draw(canvas, about, ...what) {
  picture().draw(canvas, about, ...what);
  if (flat) canvas.dataset.view = "contour";
  if (!flat && canvas.dataset.shown !== views.shown()) buttons(canvas);
}

/** The plane in which a pointer moves the tip; null where nothing is drawn. */
export function axes(canvas, about) {
  return picture().axes(canvas, about);
}

/** Whether the left button turns the view, too: by its mode, or since this page has no hand to move. */
export function turnsLeft() {
  return !flat && (turns || !operates());
}

/** What the pointer does, for those who can do it. */
export function hint() {
  return flat ? "" : " Right button turns, wheel zooms.";
}

function choose(view) {
  flat = view === "contour";
  if (!flat) views.show(view);
  buttons(byId("scene"));
  changed();
}

function buttons(canvas) {
  const view = flat ? "contour" : views.shown();
  canvas.dataset.shown = view;
  for (const button of byId("views").querySelectorAll("button[data-view]")) button.setAttribute("aria-pressed", String(button.dataset.view === view));
  for (const button of byId("views").querySelectorAll(".zoom")) button.hidden = flat;
}

/** Makes the choice of views for the session that is there. */
export function build() {
  const { planar } = session.about;
  flat = Boolean(planar);
  views.forget();
  const button = (text, onclick, more) => make("button", { type: "button", textContent: text, onclick, ...more });
  const mode = button("Turn", () => {
    turns = !turns;
    mode.setAttribute("aria-pressed", String(turns));
  }, { className: "zoom", id: "turn", "aria-pressed": "false", title: "The pointer turns the view instead of moving the hand" });
  turns = false;
  fill(byId("views"),
    (planar ? ["contour", ...views.VIEWS] : views.VIEWS).map((view) => button(NAMES[view], () => choose(view), { "data-view": view, "aria-pressed": "false" })),
    mode,
    button("−", () => { views.zoom(1 / CLICK); changed(); }, { className: "zoom", "aria-label": "Zoom out" }),
    button("+", () => { views.zoom(CLICK); changed(); }, { className: "zoom", "aria-label": "Zoom in" }));
  buttons(byId("scene"));
}

/** Takes what turns and zooms; `draws` is called when there is something to draw anew. */
export function listen(canvas, draws) {
  changed = draws;
  turning.listen(canvas, () => !flat && Boolean(session.about), turnsLeft, draws);
}
