// The controls beside the scene.

import { byId, fill, make, toast, write } from "../common/dom.js";
import { fixed, percent } from "../common/numbers.js";
import * as banner from "./banner.js";
import * as channel from "./channel.js";
import { operates, ownLink, send, session } from "./connection.js";
import * as feel from "./feel.js";
import { letGo, takeHere } from "./hand.js";
import * as log from "./log.js";

const parts = {};
let rumble = false;

function section(title, ...children) {
  return make("section", { className: "panel" }, make("h2", { textContent: title }), ...children);
}

function button(id, text, onclick, more = {}) {
  parts[id] = make("button", { id, type: "button", textContent: text, onclick, ...more });
  return parts[id];
}

function rearm() {
  // A hand that was left somewhere begins anew, where the tip is.
  letGo();
  setTimeout(takeHere, 60);
  // It has to be on its way before the arm listens to it again.
  setTimeout(() => send({ type: "state", word: "rearm" }), 250);
}

function arm() {
  letGo();
  send({ type: "state", word: "arm" });
}

const ACTS = { reset: stop, arm, rearm, operate: () => send({ type: "operate" }) };

/** Stops: drives off. Anybody may. */
export function stop() {
  letGo();
  send({ type: "state", word: "stop" });
}

function pairs(...names) {
  return make("dl", { className: "pair" }, names.map(([id, name]) => {
    parts[id] = make("dd", { id, textContent: "–" });
    return [make("dt", { textContent: name }), parts[id]];
  }));
}

/** Makes the controls. */
export function build() {
  const { about } = session;
  parts.meter = make("i", { id: "force-bar" });
  parts.nodes = make("table", { className: "nodes" });
  parts.label = make("input", { id: "mark-label", type: "text", placeholder: "what to note", maxLength: 90, "aria-label": "Label of the mark" });
  fill(byId("panel"),
    section("Control",
      make("div", { className: "row" }, button("operate", "Take the controls", () => send({ type: operates() ? "watch" : "operate" }), { className: "primary" })),
      make("div", { className: "row" },
        button("arm", "Arm", arm),
        button("hold", "Hold", () => { letGo(); send({ type: "state", word: "hold" }); }),
        button("rearm", "Re-arm", rearm)),
      make("div", { className: "row", style: "margin-bottom:8px" }, button("disable", "Disable", stop, { title: "Drives off; out of a fault, too. Anybody may." })),
      pairs(["holder", "authority"], ["pages", "pages open"])),
    section("Force on the hand",
      make("div", { className: "row", style: "margin-bottom:6px" },
        make("div", { className: "meter grow", role: "meter", "aria-label": "Force on the hand", id: "force-meter", "aria-valuemin": 0, "aria-valuemax": about.force_limit }, parts.meter),
        parts.force = make("span", { className: "number", id: "force-value", style: "width:62px;text-align:right" })),
      make("div", { className: "row" },
        button("sound", "Sound", () => toggle("sound", (on) => feel.sound(on)), { "aria-pressed": "false" }),
        button("rumble", "Rumble", () => toggle("rumble", (on) => { rumble = on; }), { "aria-pressed": "false" }))),
    section("Link",
      channel.build(about),
      about.rearm_after_gap > 0
        ? make("p", { id: "rearms", className: "quiet small", style: "margin-top:8px", textContent: `After gaps of up to ${fixed(about.rearm_after_gap, 1)} s in the link the arm goes on by itself, slowly: this scenario says so.` })
        : null,
      make("p", { id: "measured", className: "quiet small number", style: "margin-top:8px" }),
      make("p", { id: "told", className: "small told", role: "status" })),
    section("Recording",
      make("div", { className: "row" }, button("record", "Record", record)),
      make("div", { className: "row" }, make("div", { className: "grow" }, parts.label), button("mark", "Mark", mark, { style: "flex:none" })),
      make("p", { id: "recording", className: "quiet small", style: "margin-top:8px;overflow-wrap:anywhere" })),
    make("section", { className: "panel" }, make("details", {}, make("summary", { textContent: "Nodes" }), parts.nodes)));
  parts.label.addEventListener("keydown", (event) => { if (event.key === "Enter") mark(); });
}

/** This page began the recording that runs: who watches may end no other. */
let begun = false;

function record() {
  const on = session.now?.recorder.on;
  begun = !on;
  send(on ? { type: "end_record" } : { type: "record", folder: "" });
}

function mark() {
  send({ type: "mark", label: parts.label.value || "mark" });
  toast(session.now?.recorder.on ? "Marked." : "Marked, but nothing is being recorded.", 3);
  parts.label.value = "";
}

function toggle(id, change) {
  const on = parts[id].getAttribute("aria-pressed") !== "true";
  parts[id].setAttribute("aria-pressed", String(on));
  change(on);
}

function holder({ authority }) {
  if (!authority) return "?";
  if (authority.holder === "own") return session.about.hand;
  if (authority.holder === "page") return Number(authority.identity) === session.page ? "this page" : `page ${authority.identity}`;
  if (authority.holder === "client") return `ROS 2 client ${authority.identity.slice(0, 8)}…`;
  return "nobody";
}

const TONE = { ENABLED: "good", PAUSED: "warn", FAULT: "bad", DISABLED: "" };

function chip(tone, name, value) {
  return make("span", { className: `chip ${tone}` }, make("i", { className: "dot", "aria-hidden": "true" }), name, " ", make("b", { textContent: value }));
}

/** How long a node's word stays [ms]: it may be true for a moment only. */
const TOLD_FOR = 10_000;
const told = new Map();

/** What link, gateway and hand have to say: who was refused, and why there is nothing to hear. */
function words() {
  for (const node of session.nodes) {
    if (node.message && !node.faults.includes(node.message) && ["link_leader", "link_follower", "gateway", "master"].includes(node.name)) {
      const what = node.faults.find((fault) => fault.startsWith("stranger")) || "";
      told.set(node.name, { text: `${node.name}: ${what}${what && " – "}${node.message}`, until: Date.now() + TOLD_FOR });
    }
  }
  for (const [name, { until }] of told) if (until < Date.now()) told.delete(name);
  return [...told.values()].map(({ text }) => text).join(" · ");
}

let chipsShown = "";

/** Shows what is slow: a few times a second. */
export function slow(snapshot) {
  const mine = operates();
  const other = snapshot.seat.operator && !mine;
  write(parts.operate, mine ? "Give up the controls" : other ? `Page ${snapshot.seat.operator} has the controls` : "Take the controls");
  parts.operate.classList.toggle("primary", !mine && !other);
  parts.operate.disabled = Boolean(other);
  for (const id of ["arm", "hold", "rearm"]) parts[id].disabled = !mine;
  for (const control of Object.values(channel.controls)) control.disabled = !mine;
  const state = snapshot.states.follower?.state || "?";
  const leader = snapshot.states.leader?.state || "?";
  const word = banner.word(snapshot);
  parts.rearm.disabled ||= word !== "rearm";
  parts.hold.disabled ||= state !== "ENABLED";
  parts.arm.disabled ||= word !== "arm";
  parts.disable.disabled = state === "DISABLED" && leader === "DISABLED";
  write(parts.disable, state === "FAULT" || leader === "FAULT" ? "Reset the fault" : "Disable");
  for (const [id, own] of [["arm", "arm"], ["rearm", "rearm"], ["disable", "reset"]]) parts[id].classList.toggle("primary", mine && word === own);
  banner.show(banner.advice(snapshot, session.about, { connected: session.connected, mine, events: session.events }), (own) => ACTS[own]());
  write(parts.holder, holder(snapshot));
  write(parts.pages, String(snapshot.seat.pages));
  const link = ownLink(snapshot);
  write(byId("measured"), link
    ? `measured: ${fixed(link.round_trip && link.round_trip * 1e3, 1)} ms, ±${fixed(link.jitter * 1e3, 1)} ms, ${percent(link.loss)} lost`
    : "measured: –");
  write(byId("told"), words());
  channel.show(snapshot);
  const { recorder, contact } = snapshot;
  const { end } = session.about;
  parts.record.disabled = recorder.on && !mine && !begun;
  write(parts.record, recorder.on ? "End the recording" : "Record");
  parts.record.setAttribute("aria-pressed", String(recorder.on));
  write(byId("recording"), recorder.on ? `${recorder.messages} messages in ${recorder.folder}` : recorder.folder ? `last: ${recorder.folder}` : "Nothing is being recorded.");
  const chips = JSON.stringify([state, leader, link?.connected, session.connected, holder(snapshot), contact?.on, contact?.edge, recorder.on]);
  if (chips !== chipsShown) {
    chipsShown = chips;
    // What was so when the connection was lost may be otherwise now.
    fill(byId("status"), ...(session.connected ? [
      chip(TONE[state], "arm", state), end === "arm" ? null : chip(TONE[leader], "master", leader),
      chip(link?.connected ? "good" : "bad", "link", link?.connected ? "up" : "down"),
      end === "operator" && !contact ? null : chip(contact?.on ? "warn" : "", "contact", contact ? contact.on ? contact.edge : "free" : "?"),
      end === "arm" ? null : chip("", "hand", holder(snapshot)),
      recorder.on ? chip("bad", "rec", "on") : null,
    ] : [chip("bad", "page", "no connection")]));
  }
  log.show(session.events);
  if (parts.nodes.parentElement.open) {
    fill(parts.nodes, session.nodes.map((node) => {
      const tone = { ok: "good", warning: "warn" }[node.level] || "bad";
      const title = [...node.faults, node.message].filter(Boolean).join("; ");
      return make("tr", { title, className: tone },
        make("td", {}, make("i", { className: "dot" }), node.name, node.level === "ok" ? "" : ` (${node.level})`),
        make("td", { textContent: `${fixed(node.rate, 0)} Hz  ${fixed(node.late, 0)} µs` }));
    }));
  }
}

/** Shows what is quick: the force; it is felt, too, where asked for, or where a gamepad holds the hand. */
export function quick(snapshot, held) {
  const newton = Math.hypot(...(snapshot.hand_force || [0]));
  const limit = session.about.force_limit;
  parts.meter.style.width = `${Math.min(100, (newton / limit) * 100).toFixed(1)}%`;
  write(parts.force, snapshot.hand_force ? `${fixed(newton, 1)} N` : "–");
  feel.feel(newton, limit, rumble || held);
}
