// The console: what is drawn when.

import { byId, fill, make, toast } from "../common/dom.js";
import { fixed } from "../common/numbers.js";
import { onTheme } from "../common/theme.js";
import { connect, on, operates, session } from "./connection.js";
import * as gamepad from "./gamepad.js";
import * as hand from "./hand.js";
import * as panel from "./panel.js";
import * as picture from "./picture.js";
import * as strips from "./strips.js";

/** Time between drawings of the scene on average, and least time of strips and texts [ms]. */
const SCENE = 1000 / 36;
const STRIPS = 125;
const TEXTS = 200;

let drawn = { scene: 0, strips: 0, texts: 0 };
let shown = null;

/** Whether the arm is seen over the link, late as it is. */
const afar = () => session.about.end === "operator";

/** The snapshot that has crossed the link by now: what the operator would see; null where that is what there is. */
function delayed() {
  if (afar()) return null;
  const way = session.now.link?.delay;
  if (!way) return null;
  const seen = session.now.t - way;
  for (let n = session.past.length - 1; n >= 0; n--) {
    if (session.past[n].t <= seen) return session.past[n];
  }
  return session.past[0];
}

function legend() {
  byId("delayed").parentElement.hidden = afar();
  const key = (style, colour, text) => make("span", {}, make("i", { className: style, style: colour }), text);
  fill(byId("scene-legend"),
    key("disc", "background:var(--model)", "tip"), key("", "border-color:var(--measured)", "arm"),
    key("ring", "border-color:var(--hand)", "hand, its force and spring"), key("", "border-color:var(--force)", "contact force"),
    afar() ? null : key("ring dash", "border-color:var(--second)", "delayed image: the arm (dashed) as the operator sees it"));
}

function frame(time) {
  requestAnimationFrame(frame);
  if (session.now && session.about) gamepad.look(time, byId("scene"), panel.stop, refuse);
  hand.beat(time);
  const visible = !byId("console").hidden;
  if (!session.now || !session.about) return;
  if (time - drawn.texts >= TEXTS) {
    drawn.texts = time;
    panel.slow(session.now);
    hint();
  }
  if (!visible) return;
  if (session.now !== shown && time >= drawn.scene) {
    // Due by the average: a frame of the browser that comes late costs no other.
    drawn.scene = Math.max(drawn.scene, time - SCENE) + SCENE;
    shown = session.now;
    const image = byId("delayed").checked ? delayed() : null;
    const target = hand.wanted() || session.now.seat.target;
    picture.draw(byId("scene"), session.about, session.now, image, target);
    panel.quick(session.now, gamepad.holds());
    counted += 1;
  }
  if (time - drawn.strips >= STRIPS) {
    drawn.strips = time;
    strips.draw(session.past, session.about);
  }
}

let counted = 0;

/** An arm of which nothing new came for this long is not seen any more [s]: no link's way is that long. */
const LOST = 10;
/** How late it may be seen without a word [s]. */
const SOON = 0.15;

/** What of the session is on another host, where its ends are apart. */
function elsewhere() {
  const { q_age: age } = session.now;
  if (session.about.end === "arm") return "The hand is on the other host.";
  if (!afar()) return "";
  if (age === null) return "The arm is on the other host: nothing is seen of it yet.";
  if (age > LOST) return `The arm is on the other host: not seen for ${fixed(age, 0)} s.`;
  return `The arm is on the other host, seen over the link${age < SOON ? "" : `, ${fixed(age, 1)} s late`}.`;
}

function hint() {
  const mine = operates();
  const canvas = byId("scene");
  canvas.classList.toggle("hold", mine && !hand.wanted());
  canvas.classList.toggle("holding", Boolean(hand.wanted()));
  canvas.dataset.drawn = counted;
  const own = !mine ? "Take the controls to move the hand." : hand.wanted()
    ? "Release, or Space, lets the hand go." : gamepad.present() ? "Drag, arrow keys or the gamepad's trigger take the hand."
      : "Drag, or arrow keys, to take the hand.";
  const text = session.about.end === "arm" ? elsewhere() : [own + picture.hint(), elsewhere()].join(" ").trim();
  if (byId("scene-hint").textContent !== text) byId("scene-hint").textContent = text;
}

function refuse() {
  toast("Take the controls first: the button at the right, “Take the controls”.", 4);
}

/** Starts the console. */
export function start() {
  on("hello", () => {
    legend();
    picture.build();
    panel.build();
    strips.build(byId("strips"));
  });
  on("refused", (reason) => toast(reason));
  on("connection", () => { if (session.now) panel.slow(session.now); });
  const anew = () => { shown = null; };
  onTheme(anew);
  hand.listen(byId("scene"), refuse, picture.turnsLeft);
  picture.listen(byId("scene"), anew);
  byId("stop").onclick = panel.stop;
  addEventListener("keydown", (event) => { if (event.key === "Escape") panel.stop(); });
  connect();
  requestAnimationFrame(frame);
}
