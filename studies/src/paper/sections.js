"use strict";
// The page of `ferntast paper`: one section a table or figure of the paper.

function make(parent, tag, text, name) {
  const element = document.createElement(tag);
  if (text !== null && text !== undefined) element.textContent = text;
  if (name) element.className = name;
  parent.append(element);
  return element;
}

const COLOURS = ["--curve-0", "--curve-1", "--curve-2", "--curve-3", "--quiet"];
const colourOf = (n) => COLOURS[n % COLOURS.length];

/** Dots as a curve with holes between, so that no line joins them. */
function drawable(curve, n, many) {
  const colour = many ? COLOURS[0] : colourOf(n);
  if (!curve.dots) return { name: curve.name, colour, x: curve.x, y: curve.y };
  const x = [], y = [];
  curve.x.forEach((value, i) => { x.push(value, value); y.push(curve.y[i], null); });
  return { name: curve.name, colour, dots: true, x, y };
}

function showChart(grid, each) {
  const panel = make(grid, "div", null, "panel");
  make(panel, "h3", each.title);
  const many = each.curves.length > 8;
  if (each.curves.length > 1 && !many) {
    const bar = make(panel, "div", null, "bar");
    each.curves.forEach((curve, n) => {
      const entry = make(bar, "span", null, "quiet");
      make(entry, "span", null, "swatch").style.background = "var(" + colourOf(n) + ")";
      entry.append(curve.name);
    });
  }
  chart(panel, each.curves.map((curve, n) => drawable(curve, n, many)), { x: each.x, y: each.y }, 260);
}

function showItems(parent, items) {
  const wrap = make(parent, "div", null, "scroll panel");
  const rows = make(wrap, "table");
  const head = make(rows, "tr");
  for (const [text, number] of [["item"], ["paper", 1], ["here", 1], ["± error", 1], ["unit"], ["holds"], ["asked for"]]) {
    make(head, "th", text, number ? "number" : "");
  }
  for (const item of items) {
    const row = make(rows, "tr");
    make(row, "td", item.item).style.minWidth = "19em";
    make(row, "td", item.paper === null ? "a statement" : brief(item.paper), "number");
    make(row, "td", brief(item.here), "number");
    make(row, "td", brief(item.std_error), "number");
    make(row, "td", item.unit);
    make(row, "td", item.holds ? "yes" : "NO").style.color = item.holds ? "var(--good)" : "var(--bad)";
    make(row, "td", item.criterion).style.minWidth = "15em";
  }
}

function showTheme(header) {
  const button = make(header, "button", "Dark");
  button.addEventListener("click", () => {
    const root = document.documentElement;
    const dark = root.dataset.theme !== "dark";
    root.dataset.theme = dark ? "dark" : "light";
    button.textContent = dark ? "Light" : "Dark";
    for (const each of allCharts) each.draw();
  });
}

function showPaper(paper) {
  const page = document.getElementById("page");
  const header = make(page, "header");
  const words = make(header, "div");
  make(words, "h1", paper.title);
  make(words, "p", paper.subtitle, "quiet");
  showTheme(header);
  for (const section of paper.sections) {
    make(page, "h2", section.name + ": " + section.title);
    make(page, "p", section.text, "quiet");
    const grid = make(page, "div", null, "maps");
    for (const each of section.charts) showChart(grid, each);
    showItems(page, section.items);
  }
}
