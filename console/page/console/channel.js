// What the link is like: sliders, presets, the delay law. They show the session's channel as it is.

import { make, write } from "../common/dom.js";
import { fixed } from "../common/numbers.js";
import { ownLink, send, session } from "./connection.js";

const parts = {};
/** The elements that only who operates may use. */
export const controls = parts;

/** The sliders: what they set, in which unit, and how far they go. */
const SLIDERS = {
  "link-delay": { text: "round trip", of: "round_trip", factor: 1e3, max: 1000, step: 1, unit: "ms", decimals: 0 },
  "link-jitter": { text: "jitter, ±", of: "jitter", factor: 1e3, max: 20, step: 0.5, unit: "ms", decimals: 1 },
  "link-loss": { text: "loss each way", of: "loss", factor: 100, max: 30, step: 0.1, unit: "%", decimals: 1 },
};

function slider(id) {
  const { text, max, step, unit, decimals } = SLIDERS[id];
  const output = make("output", { for: id, textContent: "–" });
  const input = make("input", { id, type: "range", min: 0, max, step, value: 0, "aria-describedby": "measured" });
  // The number is that of the channel, which may be beyond the slider's end.
  input.tell = (value) => write(output, `${fixed(value, decimals)} ${unit}`);
  input.addEventListener("input", () => { input.tell(Number(input.value)); sendLink(); });
  parts[id] = input;
  return make("div", { className: "slider" }, make("label", { for: id, textContent: text }), output, input);
}

let linkTimer = 0;
let linkAsked = 0;
let lawAsked = 0;
/** So long a choice stands, until the session has heard of it and told [ms]. */
const HEARD_WITHIN = 5000;

function sendLink() {
  linkAsked = Date.now();
  clearTimeout(linkTimer);
  // While the slider moves, a few times a second is enough.
  linkTimer = setTimeout(() => {
    const wish = { type: "link" };
    for (const [id, { of, factor }] of Object.entries(SLIDERS)) wish[of] = Number(parts[id].value) / factor;
    send(wish);
  }, 120);
}

/** Sets the sliders to a channel. */
function setSliders(channel) {
  for (const [id, { of, factor }] of Object.entries(SLIDERS)) {
    const value = channel[of] * factor;
    parts[id].value = value;
    parts[id].tell(value);
  }
}

/** Whether the sliders cannot tell the channels apart. */
function alike(a, b) {
  return Object.values(SLIDERS).every(({ of, factor, step }) => Math.abs(a[of] - b[of]) * factor < step);
}

/** Shows the channel as it is: this page's choice, another page's, the scenario's. */
function follow(channel) {
  if (!channel) return;
  const wished = Object.fromEntries(Object.entries(SLIDERS).map(([id, { of, factor }]) => [of, Number(parts[id].value) / factor]));
  if (Date.now() - linkAsked < HEARD_WITHIN && !alike(channel, wished)) return;
  setSliders(channel);
  const known = session.about.presets.findIndex((preset) => alike(preset, channel));
  if (document.activeElement !== parts.preset) parts.preset.value = known < 0 ? "" : session.about.presets[known].name;
}

function choosePreset() {
  const preset = session.about.presets.find(({ name }) => name === parts.preset.value);
  if (!preset) return;
  setSliders(preset);
  sendLink();
  parts.preset.blur();
}

function labelled(id, text, element) {
  return make("div", { className: "row", style: "margin-top:8px" }, make("label", { className: "quiet small", for: id, textContent: text }), make("div", { className: "grow" }, element));
}

/** Makes the controls. */
export function build(about) {
  parts.law = make("select", { id: "law", "aria-label": "Delay law" },
    about.laws.map((law) => make("option", { textContent: law.replaceAll("_", "–"), value: law, selected: law === about.law })));
  parts.law.addEventListener("change", () => { lawAsked = Date.now(); send({ type: "law", law: parts.law.value }); });
  parts.preset = make("select", { id: "preset", "aria-label": "A link to be like" },
    make("option", { textContent: "as set below", value: "" }),
    about.presets.map(({ name, description }) => make("option", { textContent: description, value: name })));
  parts.preset.addEventListener("change", choosePreset);
  return [labelled("preset", "like", parts.preset), Object.keys(SLIDERS).map(slider), labelled("law", "law", parts.law)];
}

/** Shows what the session tells of its channel and law. */
export function show(snapshot) {
  const link = ownLink(snapshot);
  follow(snapshot.channel);
  // A change takes a round trip; until then the choice stands.
  if (link?.law && link.law !== parts.law.value && Date.now() - lawAsked > HEARD_WITHIN) parts.law.value = link.law;
}
