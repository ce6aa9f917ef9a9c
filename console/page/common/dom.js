// Elements, made short.

/** The element of that id. */
export function byId(id) {
  return document.getElementById(id);
}

/**
 * An element with properties, attributes (`aria-…`, `data-…`, `role`, `for`),
 * listeners (`onclick`) and children (nodes or texts; null is left out).
 */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === null || value === undefined) continue;
    if (name.includes("-") || name === "role" || name === "for" || name === "list") element.setAttribute(name, value);
    else if (name === "style") element.style.cssText = value;
    else element[name] = value;
  }
  element.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return element;
}

/** Puts `children` in the place of what was in `element`. */
export function fill(element, ...children) {
  element.replaceChildren(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return element;
}

/** Sets the text if it is another one: so the page is laid out no more than needed. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

let toastTimer = 0;

/** Tells something for a moment. */
export function toast(text, seconds = 6) {
  const box = byId("toast");
  box.textContent = text;
  box.hidden = false;
  clearTimeout(toastTimer);
  toastTimer = setTimeout(() => { box.hidden = true; }, seconds * 1000);
}
