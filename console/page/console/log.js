// The log: what happened in the session, when and why. The newest is on top.

import { byId, fill, make } from "../common/dom.js";

const TONES = { ok: "", warning: "warn", error: "bad", stale: "bad" };

let shown = "";

function clock(unix) {
  const date = new Date(unix * 1000);
  const two = (number) => String(number).padStart(2, "0");
  return `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}.${String(date.getMilliseconds()).padStart(3, "0")}`;
}

/** Shows `events`, the oldest first. */
export function show(events) {
  const key = `${events.length} ${events.at(-1)?.unix}`;
  if (key === shown) return;
  shown = key;
  fill(byId("log"), make("h2", { textContent: "Events" }),
    events.length ? null : make("p", { className: "quiet small", textContent: "Nothing happened yet." }),
    make("ol", { tabIndex: 0, "aria-label": "Events, the newest first" }, events.toReversed().map((event) =>
      make("li", { className: TONES[event.level] ?? "" }, make("time", { textContent: clock(event.unix) }), make("i", { className: "dot", "aria-hidden": "true" }), make("span", { textContent: event.text })))));
}
