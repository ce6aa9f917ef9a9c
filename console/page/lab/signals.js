// The rows of the form, one a signal: its column, its unit, what is odd about it; and signals of the user's own.

import { fill, make } from "../common/dom.js";
import { words } from "../common/names.js";
import { significant } from "../common/numbers.js";

/** Words for a column in the list: what is in it. */
function described(column) {
  if (!column.numbers) return column.words ? `${column.name} (words)` : column.name;
  return `${column.name} (${significant(column.least)} … ${significant(column.greatest)}${column.missing ? `, ${column.missing} without a number` : ""})`;
}

/** A menu of columns; one that no file has is offered, too, where it is chosen. */
function columnMenu(columns, value, none, more) {
  const select = make("select", more,
    make("option", { value: "", textContent: none }),
    columns.map((column) => make("option", { value: column.name, textContent: described(column), selected: column.name === value })));
  if (value && !columns.some((column) => column.name === value)) select.append(make("option", { value, textContent: value, selected: true }));
  return select;
}

/**
 * The rows of a form. `at` gives what they are about: `looked()` (what the files hold), `unitsOf(key)`, `says(key)`, `say(key, more)`,
 * `stated` (whether an experiment file says it, which need not say units), `byRate()`; and what is called when something was said:
 * `tried()`, and `drawn()` where rows are others by that.
 */
export function rows(at) {
  const hints = {};

  function choice(key, must) {
    const none = key === "time" ? "none: by the rate" : must ? "choose …" : "none";
    const select = columnMenu(at.looked().columns, at.says(key).column, none, { name: key, id: `signal-${key}`, required: must });
    select.onchange = () => {
      const column = at.looked().columns.find((known) => known.name === select.value);
      const known = at.unitsOf(key);
      const unit = known.includes(column?.unit) ? column.unit : at.says(key).unit ?? known[0] ?? null;
      at.say(key, { column: select.value, unit });
      const menu = document.getElementById(`unit-${key}`);
      if (menu) menu.value = unit ?? "";
      if (key === "time") at.drawn();
      at.tried();
    };
    return select;
  }

  function unitMenu(key) {
    const known = at.unitsOf(key);
    if (!known.length) return null;
    const { column, unit } = at.says(key);
    // The guess leaves it open where it is not sure; an experiment file need not say it.
    const open = unit === "" ? "choose …" : unit === null ? (at.stated && column ? `${known[0]}, not stated` : "unit") : null;
    const select = make("select", { id: `unit-${key}`, "aria-label": `unit of ${words(key)}`, required: unit === "" && column !== "" },
      open ? make("option", { value: "", textContent: open, selected: true }) : null,
      known.map((text) => make("option", { value: text, textContent: text, selected: text === unit })));
    select.onchange = () => { at.say(key, { unit: select.value || null }); at.tried(); };
    return select;
  }

  /** The row of one signal. */
  function row(key, text, must) {
    hints[key] = make("div", { className: "wide hints", id: `hint-${key}` });
    return [make("label", { for: `signal-${key}` }, text), make("div", { className: "signal" }, choice(key, must), unitMenu(key)), hints[key]];
  }

  /** Questions stay until they are answered; doubts come with what was read. */
  function doubt(doubts = []) {
    for (const [key, place] of Object.entries(hints)) {
      const { column, unit } = at.says(key);
      const known = at.unitsOf(key);
      const asked = at.looked().questions.filter((question) => question.signal === key && (column === "" || unit === "") && !(key === "time" && at.byRate()));
      const then = (more) => () => { at.say(key, more); at.drawn(); at.tried(); };
      const take = (column, unit) => make("button", { type: "button", textContent: unit ? `${column} in ${unit}` : column, onclick: then(unit ? { column, unit } : { column }) });
      const choices = (question) => question.choices.map((text) => {
        const colon = text.lastIndexOf(":");
        return colon > 0 && known.includes(text.slice(colon + 1)) ? take(text.slice(0, colon), text.slice(colon + 1)) : take(text, null);
      });
      const odd = doubts.filter((told) => told.signal === key && !asked.length);
      fill(place,
        asked.map((question) => make("p", { className: "note warning" }, `${question.why} `, choices(question))),
        odd.map((told) => make("p", { className: "note warning" }, `${told.text} `,
          known.includes(told.unit) ? make("button", { type: "button", "data-unit": told.unit, textContent: `it is ${told.unit}`, onclick: then({ unit: told.unit }) }) : null)));
    }
  }

  return { row, doubt };
}

/**
 * Signals of the user's own, each with name, column and unit. `list` holds them, `columns` and `units` are offered; `drawn` is called
 * when there are others, `tried` when one is changed.
 */
export function extra({ list, columns, units, drawn, tried }) {
  const row = (own, number) => {
    const id = (part) => `extra-${number}-${part}`;
    const name = make("input", { type: "text", id: id("name"), value: own.name, required: true, placeholder: "name", pattern: "[A-Za-z][A-Za-z0-9_]*", title: "letters, digits and underscores, a letter first", "aria-label": `name of extra signal ${number + 1}` });
    const twice = () => name.setCustomValidity(list.some((other) => other !== own && other.name === own.name) ? "another signal has this name" : "");
    name.oninput = () => { own.name = name.value.trim(); twice(); tried(); };
    twice();
    const column = columnMenu(columns, own.column, "choose …", { id: id("column"), required: true, className: "column", "aria-label": `column of extra signal ${number + 1}` });
    const unit = make("select", { id: id("unit"), className: "unit", "aria-label": `unit of extra signal ${number + 1}` }, make("option", { value: "", textContent: "none" }),
      units.map((text) => make("option", { value: text, textContent: text, selected: text === own.unit })));
    column.onchange = () => {
      own.column = column.value;
      const known = columns.find((other) => other.name === column.value)?.unit;
      if (units.includes(known)) unit.value = own.unit = known;
      tried();
    };
    unit.onchange = () => { own.unit = unit.value || null; tried(); };
    const drop = () => { list.splice(list.indexOf(own), 1); drawn(); tried(); };
    return make("div", { className: "extra" }, name, column, unit,
      make("button", { type: "button", className: "bare", id: id("remove"), textContent: "remove", "aria-label": `Remove extra signal ${own.name || number + 1}`, onclick: drop }));
  };
  const add = () => { list.push({ name: "", column: "", unit: null, time: null }); drawn(); document.getElementById(`extra-${list.length - 1}-name`)?.focus(); };
  return make("fieldset", { className: "extras" }, make("legend", { className: "small quiet", textContent: "extra signals, for effects of your own" }),
    list.map(row), make("button", { type: "button", className: "bare", id: "add-extra", textContent: "add a signal", onclick: add }));
}
