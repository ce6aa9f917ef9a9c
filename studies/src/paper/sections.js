// The page of `ferntast paper`: one section a table or figure of the paper.

/** Dots as a curve with holes between, so that no line joins them; `below` others that lie on them as rings. */
function drawable(curve, colour, below) {
  if (!curve.dots) return { name: curve.name, colour, x: curve.x, y: curve.y };
  const x = [], y = [];
  curve.x.forEach((value, i) => { x.push(value, value); y.push(curve.y[i], null); });
  return { name: curve.name, colour, dots: true, ring: below, x, y };
}

function showChart(grid, each) {
  const panel = make(grid, "div", null, "panel");
  make(panel, "h3", each.title);
  const many = each.curves.length > 8;
  const colourOf = (n) => curveColour(many ? 0 : n);
  if (each.curves.length > 1 && !many) {
    const bar = make(panel, "div", null, "bar");
    each.curves.forEach((curve, n) => swatch(make(bar, "span", null, "quiet"), colourOf(n), curve.name));
  }
  // The first, which is what was measured, is seen below the others that lie on it.
  const like = (curve) => each.curves.filter((other) => Boolean(other.dots) === Boolean(curve.dots)).length;
  const drawn = each.curves.map((curve, n) => {
    const below = n === 0 && like(curve) > 1 && !many;
    return { ...drawable(curve, colourOf(n), below), wide: below && !curve.dots };
  });
  chart(panel, drawn.filter((curve) => !curve.dots).concat(drawn.filter((curve) => curve.dots)), { x: each.x, y: each.y }, 260);
}

function showItems(parent, items) {
  const verdict = (holds) => {
    const word = document.createElement("span");
    word.textContent = holds ? "yes" : "NO";
    word.style.color = holds ? "var(--good)" : "var(--bad)";
    return word;
  };
  table(parent,
    [["item", 0, "14em"], ["paper", 1], ["here", 1], ["± error", 1], ["unit"], ["holds"], ["asked for", 0, "11em"]],
    items.map((item) => [item.item, item.paper === null ? "a statement" : String(item.paper), brief(item.here),
      brief(item.std_error), item.unit, verdict(item.holds), item.criterion]));
}

function showPaper(paper) {
  const page = begin(paper.title, paper.subtitle);
  for (const own of paper.sections) {
    const part = section(page, own.name + ": " + own.title, own.text);
    const grid = make(part, "div", null, "maps");
    for (const each of own.charts) showChart(grid, each);
    showItems(part, own.items);
  }
}
