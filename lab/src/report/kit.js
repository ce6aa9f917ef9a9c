// What pages are made of: elements, tables, legends, a head with a switch of theme.

function make(parent, tag, text, kind) {
  const element = document.createElement(tag);
  if (text !== undefined && text !== null) element.textContent = text;
  if (kind) element.className = kind;
  parent.append(element);
  return element;
}

function section(page, title, words) {
  const part = make(page, "section");
  make(part, "h2", title);
  if (words) make(part, "p", words, "quiet");
  return part;
}

/** A table; columns: [title, whether it holds numbers, least width]. A cell is text or a node. */
function table(parent, columns, rows) {
  const scroll = make(parent, "div", null, "scroll panel");
  const grid = make(scroll, "table");
  const head = make(make(grid, "thead"), "tr");
  for (const [title, number] of columns) {
    make(head, "th", title, number ? "number" : "").scope = "col";
  }
  const body = make(grid, "tbody");
  for (const row of rows) {
    const line = make(body, "tr");
    row.forEach((cell, n) => {
      const place = make(line, "td", cell instanceof Node ? null : cell, columns[n][1] ? "number" : "");
      if (cell instanceof Node) place.append(cell);
      if (columns[n][2]) place.style.minWidth = columns[n][2];
    });
  }
}

/** The colour of the n-th curve. */
const curveColour = (n) => "--curve-" + (n % 6);

/** A coloured square in front of a curve's name. */
function swatch(parent, colour, name) {
  make(parent, "span", null, "swatch").style.background = "var(" + colour + ")";
  parent.append(name);
}

/** A button for each of `names` that hides and shows it; gives the set of hidden names, which `change` is called after. */
function legend(parent, names, colourOf, change) {
  const hidden = new Set();
  for (const name of names) {
    const button = make(parent, "button");
    swatch(button, colourOf(name), name);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      if (!hidden.delete(name)) hidden.add(name);
      button.setAttribute("aria-pressed", String(!hidden.has(name)));
      change();
    });
  }
  return hidden;
}

function showTheme(header) {
  const button = make(header, "button");
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  let chosen = null;
  const apply = () => {
    const theme = chosen || (dark.matches ? "dark" : "light");
    document.documentElement.dataset.theme = theme;
    button.textContent = theme === "dark" ? "Light" : "Dark";
    for (const each of allCharts) each.draw();
  };
  button.addEventListener("click", () => {
    chosen = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    apply();
  });
  dark.addEventListener("change", apply);
  window.addEventListener("beforeprint", () => { chosen = "light"; apply(); });
  apply();
}

/** The head of a page: title, a line below it, the switch of theme. */
function begin(title, subtitle) {
  const page = document.getElementById("page");
  const header = make(page, "header");
  const words = make(header, "div");
  make(words, "h1", title);
  if (subtitle) make(words, "p", subtitle, "quiet");
  showTheme(header);
  return page;
}
