// The banner on the picture: what happened, why, and the one thing to do about it.

import { byId, write } from "../common/dom.js";
import { apart } from "../common/mapping.js";
import { fixed } from "../common/numbers.js";
import { ownLink } from "./connection.js";

const NAMES = { follower: "The arm", leader: "The master" };
/** What a device may be in beside ENABLED, what has to be left first first. */
const STATES = {
  FAULT: { tone: "bad", what: "is in fault, its drives are off", word: "reset" },
  DISABLED: { tone: "off", what: "is off", word: "arm" },
  PAUSED: { tone: "warn", what: "holds", word: "rearm" },
};
const WORDS = { reset: "Reset the fault", arm: "Arm", rearm: "Re-arm", operate: "Take the controls" };
const LET_GO = {
  wanted: "The hand was let go.",
  silent: "The hand was let go: the page was hidden or stood still.",
  idle: "The hand was let go: nobody touched the page for 20 s.",
};
/** Reasons as a servo or master tells them, in the words of the page. What the banner's button does is not said. */
const REASONS = [
  ["started", "It has just been started."],
  ["disable was asked for", "It was told to stop."],
  ["pause was asked for", "It was told to hold."],
  ["told over the link", "Its host says so, and not why yet."],
  ["commands fell silent", "No commands came: the hand, the link or this computer stood still."],
  ["measurements fell silent", "No measurements came: the arm's driver, or this computer, stood still."],
];
/** What is less apart than that is together [m]. */
const TOGETHER = 0.001;

function sentence(reason) {
  const known = REASONS.find(([begin]) => reason.startsWith(begin));
  if (known) return known[1];
  const rest = reason.replace(/[,;] (disable, then enable|send enable|send resume)$/, "");
  return rest ? `${rest[0].toUpperCase()}${rest.slice(1)}.` : "";
}

/** The word that takes a device one step nearer to following commands; null where none does. */
export function word(snapshot) {
  const found = Object.keys(STATES).find((state) => Object.values(snapshot.states).some((own) => own.state === state));
  return found ? STATES[found].word : null;
}

/** So long before a state an event may be what led to it [s]. */
const BEFORE = 3;

/** Which crash was it, where it was one: of the log's events, the newest before `device` came into `state`. */
function crash(events, device, state) {
  const begin = `${device === "follower" ? "arm" : "master"} ${state}:`;
  const entered = events.findLast((event) => event.text.startsWith(begin));
  const died = entered && events.findLast((event) => /^node .* died/.test(event.text)
    && event.t > entered.t - BEFORE && event.t < entered.t + BEFORE);
  return died ? `${died.text[0].toUpperCase()}${died.text.slice(1).split(";")[0]}.` : null;
}

function distance(snapshot, about, state) {
  const way = apart(about, snapshot);
  if (way === null && state === "FAULT") return "";
  if (about.end === "operator" && !snapshot.tip) return "How far it is from the hand is not seen: it comes to the hand slowly.";
  if (about.end === "arm") return "It goes on when the operator, on the other host, arms it again.";
  if (way === null) return "The hand begins where the tip is.";
  if (way < TOGETHER) return "Hand and tip are together.";
  const far = `Hand and tip are ${fixed(way * 1e3, 0)} mm apart`;
  return state === "FAULT" ? `${far}.` : `${far}: the arm comes to the hand slowly.`;
}

/**
 * What the banner says: tone, what, why, and the word of its button, or null where there is nothing to be done.
 * Null where all is well. `page` tells whether it is `connected`, whether it operates (`mine`), and the `events` that it heard of.
 */
export function advice(snapshot, about, page) {
  if (!page.connected) return { tone: "bad", what: "No connection to the session", why: "This page tries again by itself.", word: null };
  const devices = Object.entries(snapshot.states);
  const silent = devices.find(([, own]) => own.silent);
  if (silent) {
    return { tone: "bad", what: `Nothing is heard of ${NAMES[silent[0]].toLowerCase()}`, why: "Its process does not run, or stands still. It is started again by itself.", word: null };
  }
  const state = Object.keys(STATES).find((each) => devices.some(([, own]) => own.state === each));
  if (!state) return null;
  const { tone, what } = STATES[state];
  const those = devices.filter(([, own]) => own.state === state);
  const [device, { reason }] = those[0];
  const name = those.length > 1 ? "Arm and master" : NAMES[device];
  const told = {
    tone,
    what: those.length > 1 ? `${name} ${what.replace("is ", "are ").replace("holds", "hold").replace("its", "their")}` : `${name} ${what}`,
    why: [crash(page.events, device, state), (state === "PAUSED" && reason.startsWith("commands") && LET_GO[snapshot.seat.let_go]) || sentence(reason)],
    word: STATES[state].word,
  };
  const link = ownLink(snapshot);
  if (state !== "FAULT" && link && !link.connected) {
    told.why.push("The link is down: it has to come back first.");
    told.word = null;
  } else {
    told.why.push(distance(snapshot, about, state));
    const other = snapshot.seat.operator && !page.mine;
    // Anybody may take the drives off; the rest is the operator's.
    if (told.word !== "reset" && other) {
      told.why.push(`Page ${snapshot.seat.operator} has the controls.`);
      told.word = null;
    } else if (told.word !== "reset" && !page.mine) {
      told.word = "operate";
    }
  }
  return { ...told, why: told.why.filter(Boolean).join(" ") };
}

/** Shows what `told` says; `act` is told the word of the button when it is clicked. */
export function show(told, act) {
  const box = byId("banner");
  box.hidden = !told;
  if (!told) return;
  box.className = `banner ${told.tone}`;
  write(byId("what"), told.what);
  write(byId("why"), told.why);
  const button = byId("act");
  button.hidden = !told.word;
  if (told.word) write(button, WORDS[told.word]);
  button.dataset.word = told.word || "";
  button.onclick = () => act(told.word);
}
