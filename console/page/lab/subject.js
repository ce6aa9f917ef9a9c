// What an experiment is about: a joint, a contact or a whole arm, and what only one of them has.

import { make } from "../common/dom.js";
import { urdfs } from "./files.js";

export const KINDS = [
  ["revolute", "revolute (rad, Nm)"], ["prismatic", "prismatic (m, N)"], ["contact", "no joint, a contact (m, N)"], ["arm", "a whole arm (URDF)"],
];

/** Signals: key, what it is, whether it must be. */
const OF_JOINT = [
  ["position", "position", true],
  ["motor_torque", "motor torque (or force, current, voltage)", true],
  ["joint_torque", "joint torque sensor", false],
  ["temperature", "temperature", false],
];
const PLACE = [["position", "place along the contour", true]];
const TIP = [["tip[0]", "x of the tip", true], ["tip[1]", "y of the tip", true]];
const FORCES = [
  ["tangential_force", "tangential force, opposes motion to larger places", true],
  ["normal_force", "normal force, pushes the tip out", true],
  ["temperature", "temperature", false],
];
const VALID = ["valid", "what counts, above 0.5", false];

/** The signals that this is about. */
export function signals(own) {
  if (own.joint === "contact") return [...(own.byTip ? TIP : PLACE), ...FORCES, VALID];
  if (own.joint !== "arm") return [...OF_JOINT, VALID];
  return [...own.arm.joints.flatMap((joint) => [[`position@${joint}`, `${joint}: position`, true], [`motor_torque@${joint}`, `${joint}: motor torque (or force)`, true]]), VALID];
}

/** Numbers out of what was typed: null where nothing was, undefined where it is something else. */
function numbers(text) {
  const words = text.split(/[\s,;]+/).filter(Boolean);
  if (!words.length) return null;
  const values = words.map(Number);
  return values.every(Number.isFinite) ? values : undefined;
}

/** Corners [m], as typed. */
function corners(text) {
  const all = text.split(/[,;]/).filter((part) => part.trim()).map(numbers);
  if (!all.length) return null;
  return all.every((corner) => corner?.length === 2) ? all : undefined;
}

const typed = (values) => values?.map((own) => (Array.isArray(own) ? own.join(" ") : own)).join(", ") ?? "";

/** What is said of a contact and of an arm at the beginning; `mapping` is that of an experiment file. */
export function beginning(mapping) {
  const arm = mapping?.arm;
  return {
    byTip: Boolean(mapping && (mapping.contour || "tip[0]" in mapping.signals)), contour: typed(mapping?.contour),
    arm: { urdf: arm?.urdf ?? "", joints: arm?.joints ?? [], there: arm?.joints ?? [], said: Boolean(arm), armature: typed(arm?.armature), gear: typed(arm?.gear_ratio), gain: typed(arm?.drive_gain) },
  };
}

/** The part of a mapping that only a contact or an arm has. */
export function part(own) {
  const { urdf, joints, armature, gear, gain } = own.arm;
  return {
    contour: own.joint === "contact" && own.byTip ? corners(own.contour) ?? null : null,
    arm: own.joint === "arm" ? { urdf, joints, armature: numbers(armature) ?? null, gear_ratio: numbers(gear) ?? null, drive_gain: numbers(gain) ?? null } : null,
  };
}

/** Takes over which joints the server found. */
export function found(own, chain) {
  if (!chain) return;
  own.arm.there = chain.there;
  own.arm.joints = chain.joints.map((joint) => joint.name);
}

/** A line of numbers that is told of where it is something else. */
function typing(id, value, placeholder, read, set) {
  const input = make("input", { id, type: "text", value, placeholder });
  const check = () => input.setCustomValidity(read(input.value) === undefined ? `as in ${placeholder.replace(/^[a-z ]+, or /, "")}` : "");
  input.oninput = () => { set(input.value); check(); };
  check();
  return input;
}

/** Rows above the signals. `look` is called where other signals are wanted, `tried` where numbers are others. */
export function rows(own, look, tried) {
  const label = (id, text, unit) => make("label", { for: id }, text, unit ? make("small", { className: "quiet", textContent: ` ${unit}` }) : null);
  if (own.joint === "contact") {
    const by = make("select", { id: "by-tip" }, [["", "a place along it"], ["tip", "the tip's x and y"]].map(([value, text]) => make("option", { value, textContent: text, selected: (value === "tip") === own.byTip })));
    by.onchange = () => { own.byTip = by.value === "tip"; look(); };
    const contour = typing("contour", own.contour, "0.2 -0.03, 0.4 -0.03", corners, (text) => { own.contour = text; tried(); });
    contour.required = true;
    // Corners are long.
    const laid = make("div", { className: "wide" }, label("contour", "contour that the tip is laid on", "corners x y, x y, … [m]"), contour);
    return [label("by-tip", "where it is touched, by"), by, own.byTip ? laid : []];
  }
  if (own.joint !== "arm") return [];
  const { arm } = own;
  const files = urdfs();
  if (arm.urdf && !files.includes(arm.urdf)) files.push(arm.urdf);
  const urdf = make("select", { id: "urdf", required: true }, make("option", { value: "", textContent: files.length ? "choose …" : "no .urdf in the lab's folder" }),
    files.map((path) => make("option", { value: path, textContent: path, selected: path === arm.urdf })));
  urdf.onchange = () => { Object.assign(arm, { urdf: urdf.value, joints: [], there: [], said: false }); look(); };
  const check = (name) => make("label", { className: "check" }, make("input", { type: "checkbox", name: `joint-${name}`, value: name, checked: arm.joints.includes(name),
    onchange: (event) => { arm.joints = arm.there.filter((other) => (other === name ? event.target.checked : arm.joints.includes(other))); arm.said = true; look(); } }), name);
  const line = (id, text, unit, key, empty) => [label(id, text, unit), typing(id, arm[key], `${empty}, or 0.6, 0.4, …`, numbers, (value) => { arm[key] = value; tried(); })];
  return [
    label("urdf", "arm"), urdf,
    arm.there.length ? make("fieldset", { id: "joints" }, make("legend", { className: "small quiet", textContent: "joints, from the base on" }), arm.there.map(check)) : [],
    line("armature", "armatures", "[kg m² or kg], one a joint", "armature", "fitted"), line("gears", "gear ratios", "[1], one a joint", "gear", "not known"),
    line("gains", "drive gains", "[Nm/A, …], one a joint", "gain", "torques are recorded"),
  ];
}
