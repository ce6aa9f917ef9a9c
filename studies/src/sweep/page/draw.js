"use strict";
// Elements, tables, and curves as SVG.

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

/** A table with a column of names; `cell(row, column)` gives {text, kind, hint}. */
function grid(parent, corner, columns, rows, cell, kind) {
  const table = make(parent, "table", null, kind);
  const head = make(make(table, "thead"), "tr");
  for (const title of [corner, ...columns]) make(head, "th", title).scope = "col";
  const body = make(table, "tbody");
  rows.forEach((name, row) => {
    const line = make(body, "tr");
    make(line, "th", name).scope = "row";
    columns.forEach((_, column) => {
      const { text, kind: look, hint } = cell(row, column);
      const place = make(line, "td", text, look);
      if (hint) place.title = hint;
    });
  });
}

function choice(parent, label, options, show) {
  const box = make(parent, "label", label + " ");
  const select = make(box, "select");
  options.forEach(([value, text]) => { make(select, "option", text).value = value; });
  select.addEventListener("change", show);
  return select;
}

/** A number to be read. */
function brief(value) {
  if (value === null || value === undefined || !isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(1) : String(Number(value.toPrecision(4)));
}

function ticks(low, high, count) {
  const raw = (high - low) / count;
  if (!(raw > 0)) return [];
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= raw);
  const found = [];
  for (let n = Math.ceil(low / step); n * step <= high + step * 1e-9; n++) found.push(n * step);
  return found;
}

/** Curves [{colour, points: [{x, y, stable, hint}]}] over x; hollow where unstable. */
function curves(parent, all, labelX, labelY) {
  const width = 1000, height = 380, left = 74, right = 20, top = 12, bottom = 44;
  const points = all.flatMap((own) => own.points);
  if (!points.length) { make(parent, "p", "Nothing to show: every trial here is unstable, or the quantity is not measured.", "quiet"); return; }
  const highX = Math.max(...points.map((p) => p.x), 1);
  let low = Math.min(0, ...points.map((p) => p.y)), high = Math.max(0, ...points.map((p) => p.y));
  if (low === high) high = low + 1;
  const x = (value) => left + (value / highX) * (width - left - right);
  const y = (value) => top + (1 - (value - low) / (high - low)) * (height - top - bottom);
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", labelY + " over " + labelX);
  const draw = (tag, attributes, text) => {
    const element = document.createElementNS(svg.namespaceURI, tag);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    svg.append(element);
    return element;
  };
  for (const value of ticks(0, highX, 10)) {
    draw("line", { x1: x(value), x2: x(value), y1: top, y2: height - bottom, stroke: "var(--line)" });
    draw("text", { x: x(value), y: height - bottom + 18, "text-anchor": "middle" }, brief(value));
  }
  for (const value of ticks(low, high, 6)) {
    draw("line", { x1: left, x2: width - right, y1: y(value), y2: y(value), stroke: "var(--line)" });
    draw("text", { x: left - 8, y: y(value) + 4, "text-anchor": "end" }, brief(value));
  }
  draw("text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle" }, labelX);
  draw("text", { transform: `translate(14 ${height / 2}) rotate(-90)`, "text-anchor": "middle" }, labelY);
  for (const { colour, points: own } of all) {
    const path = own.map((p, n) => (n ? "L" : "M") + x(p.x) + " " + y(p.y)).join(" ");
    draw("path", { d: path, fill: "none", stroke: colour, "stroke-width": 2 });
    for (const p of own) {
      const dot = draw("circle", { cx: x(p.x), cy: y(p.y), r: 5, stroke: colour, "stroke-width": 2, fill: p.stable ? colour : "var(--panel)" });
      const hint = document.createElementNS(svg.namespaceURI, "title");
      hint.textContent = p.hint;
      dot.append(hint);
    }
  }
  parent.append(svg);
}
