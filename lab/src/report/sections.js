// What a report shows, from top to bottom.

function percent(before, after) {
  if (!(before > 0) || !isFinite(after)) return "–";
  const change = (100 * (after - before)) / before;
  return (change > 0 ? "+" : "−") + Math.abs(change).toFixed(1) + " %";
}

function showTraces(page, plots) {
  const part = section(page, "Measured against model",
    "Wheel: zoom. Drag: move. Shift and drag: frame a stretch. Double click: all. Grey: not used; green: held out, validates.");
  const panel = make(part, "div", null, "panel");
  const bar = make(panel, "div", null, "bar");
  let choice = null;
  if (plots.length > 1) {
    choice = make(bar, "select");
    choice.setAttribute("aria-label", "session");
    plots.forEach((plot, n) => { make(choice, "option", plot.title).value = n; });
  } else {
    make(bar, "h3", plots[0].title);
  }
  const names = [...new Set(plots.flatMap((plot) => plot.curves.map((curve) => curve.name)))];
  const colourOf = (name) => curveColour(names.indexOf(name));
  const hidden = legend(bar, names, colourOf, () => {
    for (const curve of drawn.curves) curve.visible = !hidden.has(curve.name);
    drawn.draw();
  });
  const curves = (plot) => plot.curves.map((curve) => ({
    ...curve, colour: colourOf(curve.name), visible: !hidden.has(curve.name),
  }));
  const labels = { x: "time [s]", y: "[" + plots[0].unit + "]" };
  const shades = (plot) => (plot.shades || []).map((each) => ({
    ...each, colour: each.what === "validates" ? "--check" : "--off",
  }));
  const drawn = chart(panel, curves(plots[0]), labels, 340, shades(plots[0]));
  const show = (n) => {
    labels.y = "[" + plots[n].unit + "]";
    drawn.show(curves(plots[n]), shades(plots[n]));
  };
  if (choice) choice.addEventListener("change", () => show(Number(choice.value)));
  return (title, from, to) => {
    const n = plots.findIndex((plot) => plot.title === title);
    if (n < 0) return;
    if (choice) choice.value = n;
    show(n);
    drawn.look(from, to);
    panel.scrollIntoView({ block: "center" });
  };
}

function showMaps(page, maps) {
  const part = section(page, "Where the residual lies",
    "Mean of the residual in bins, and its standard deviation as a band. A model that is complete leaves flat lines at zero.");
  const grid = make(part, "div", null, "maps");
  for (const map of maps) {
    const panel = make(grid, "div", null, "panel");
    make(panel, "h3", "over " + map.signal);
    const bins = map.bins;
    chart(panel, [{
      name: "residual", colour: "--curve-0", dots: bins.length < 60,
      x: bins.map((bin) => bin.center), y: bins.map((bin) => bin.mean),
      band: bins.map((bin) => bin.spread || 0),
      tell: (i) => " (" + bins[i].count + " samples)",
    }], { x: map.signal + " [" + map.signal_unit + "]", y: "residual [" + map.unit + "]" }, 220);
  }
}

function showUsed(page, shares) {
  table(section(page, "What the verdict rests on", "Every sample of the recordings, by what becomes of it."),
    [["samples"], ["number", 1], ["part", 1], [""]],
    shares.map((each) => [each.what, String(each.samples), (100 * each.share).toFixed(1) + " %", each.used ? "used" : ""]));
}

function showCandidates(page, candidates, title, words) {
  const part = section(page, title, words);
  const most = Math.max(...candidates.map((each) => each.held_out_before - each.held_out_after), 1e-300);
  table(part, [["effect"], ["before", 1], ["after", 1], ["change", 1], [""], ["p", 1], ["cannot be told from"], ["separate by"]],
    candidates.map((each) => {
      const bar = document.createElement("span");
      bar.className = "gain";
      bar.style.width = Math.max(0, (90 * (each.held_out_before - each.held_out_after)) / most) + "px";
      return [each.effect, brief(each.held_out_before) + " " + each.unit, brief(each.held_out_after) + " " + each.unit,
        percent(each.held_out_before, each.held_out_after), bar,
        each.p_value !== null && each.p_value < 1e-4 ? "< 0.0001" : brief(each.p_value),
        each.indistinguishable_from.join(", ") || "–", each.separate_by || "–"];
    }));
}

function showHistory(page, steps) {
  const part = section(page, "The falling error", "Error on data that were not fitted, one effect added after another.");
  const panel = make(part, "div", null, "panel");
  if (steps.length > 1) {
    chart(panel, [{
      name: "held out", colour: "--curve-0", dots: true,
      x: steps.map((_, n) => n), y: steps.map((step) => step.held_out),
      tell: (i) => "  " + steps[i].label,
    }], { x: "effects added", step: 1, y: "error [" + steps[0].unit + "]" }, 220);
  }
  table(part, [["step"], ["held out", 1], ["since the step before", 1], ["since the first", 1]],
    steps.map((step, n) => [step.label, brief(step.held_out) + " " + step.unit,
      n ? percent(steps[n - 1].held_out, step.held_out) : "–",
      n ? percent(steps[0].held_out, step.held_out) : "–"]));
}

function showReport(report) {
  const page = begin(report.title, report.subtitle);
  if (report.verdict) {
    const box = make(page, "div", null, "verdict " + report.verdict.kind);
    make(box, "b", report.verdict.kind);
    make(box, "span", report.verdict.text);
  }
  for (const warning of report.warnings) make(page, "p", warning, "warning");
  if (report.figures.length) {
    const grid = make(page, "div", null, "figures");
    for (const each of report.figures) {
      const box = make(grid, "div", null, "figure");
      make(box, "span", each.label, "quiet");
      make(box, "strong", each.value);
      if (each.note) make(box, "span", each.note, "quiet");
    }
  }
  const plots = report.plots.filter((plot) => plot.curves.length);
  const jump = plots.length ? showTraces(page, plots) : null;
  if (report.candidates.length) {
    showCandidates(page, report.candidates, "Effects that may be missing", "The best first; errors on data that were not fitted.");
  }
  if (report.helps_in_part.length) {
    showCandidates(page, report.helps_in_part, "Effects that help in part",
      "They lower the error, but are not the explanation: the residual has another shape.");
  }
  if (report.used.length) showUsed(page, report.used);
  if (report.dependences.length) {
    table(section(page, "What the residual depends on", "The parts overlap, since the signals go together: their sum says nothing."), [["signals"], ["part of the mean square", 1]],
      report.dependences.map((each) => [each.signals.join(" × ") + (each.period_s ? `, period ${each.period_s.toPrecision(4)} s` : ""), (100 * each.strength).toFixed(1) + " %"]));
  }
  if (report.history.length) showHistory(page, report.history);
  if (report.maps.length) showMaps(page, report.maps);
  if (report.worst.length) {
    table(section(page, "Where the model fails most"), [["session"], ["from", 1], ["to", 1], ["error", 1], [""]],
      report.worst.map((each) => {
        const button = document.createElement("button");
        button.textContent = "Show";
        button.disabled = !jump;
        const room = each.end - each.start;
        button.addEventListener("click", () => jump(each.session, each.start - room, each.end + room));
        return [each.session, brief(each.start) + " s", brief(each.end) + " s", brief(each.rms) + " " + each.unit, button];
      }));
  }
  if (report.parameters.length) {
    table(section(page, "Parameters", "Standard errors by sessions, or blocks of time, left out in turn; the interval holds the true value with 95 %."),
      [["parameter"], ["value", 1], ["standard error", 1], ["95 %", 1], ["unit"], ["effect"], [""]],
      report.parameters.map((each) => [each.name, brief(each.value), brief(each.std_error),
        each.interval_95 ? each.interval_95.map(brief).join(" … ") : "–", each.unit, each.effect,
        each.excited ? "" : "the data say nothing about it"]));
  }
  if (report.rivals.length) {
    table(section(page, "Tried and not named", "The strongest of the other effects."),
      [["effect"], ["part of the mean square", 1], ["p", 1], ["why not"]],
      report.rivals.map((each) => [each.effect, (100 * each.share).toFixed(2) + " %", brief(each.p_value), each.why]));
  }
  if (report.about.length) {
    table(section(page, "Model and data"), [["", 0], ["", 0]], report.about.map((each) => [each.name, each.value]));
  }
  if (report.notes.length) {
    const list = make(section(page, "Notes"), "ul");
    for (const note of report.notes) make(list, "li", note);
  }
}
