// What the page of `ferntast sweep` shows, from top to bottom.

const QUANTITIES = [
  ["position_rmse_m", "position error, free [mm]", 1e3],
  ["force_rmse_N", "force error [N]", 1],
  ["transparency", "stiffness felt by stiffness touched", 1],
  ["felt_stiffness_N_per_m", "stiffness felt in the hand [N/m]", 1],
  ["force_step_N_per_ms", "largest step of the force in the hand [N/ms]", 1],
  ["held_s", "time for which the arm was held [s]", 1],
  ["drift_mm", "drift at the end [mm]", 1],
  ["peak_force_N", "peak contact force [N]", 1],
  ["peak_felt_N", "peak force in the hand [N]", 1],
  ["true_energy_J", "true energy margin [J]", 1],
  ["drag_N_s_per_m", "damping felt in free space [N·s/m]", 1],
  ["task_time_s", "time of the task [s]", 1],
];

const distinct = (rows, key) => [...new Set(rows.map((row) => row[key]))];

function median(values) {
  const sorted = values.filter((v) => v !== null && isFinite(v)).sort((a, b) => a - b);
  return sorted.length ? sorted[sorted.length >> 1] : null;
}

function choice(parent, label, options, show) {
  const box = make(parent, "label", label + " ");
  const select = make(box, "select");
  options.forEach(([value, text]) => { make(select, "option", text).value = value; });
  select.addEventListener("change", show);
  return select;
}

/** Medians and worst cases of each law over all trials, the law that does most of its tasks first. */
function showRanking(page, rows, laws) {
  const part = section(page, "Which law",
    "Over all trials of the sweep: medians, of the energy the worst. Ordered by the share of trials that are stable, which needs " +
    "the task done; then by how near the stiffness felt is to the one touched.");
  const of = (law) => {
    const own = rows.filter((row) => row.law === law);
    const stable = own.filter((row) => row.stable);
    const mid = (key) => median(stable.map((row) => row[key]));
    const transparency = mid("transparency");
    return {
      law, stable: stable.length / own.length, energy: Math.min(0, ...own.map((row) => row.true_energy_J ?? -Infinity)),
      transparency, off: transparency > 0 ? Math.abs(Math.log(transparency)) : Infinity,
      drag: mid("drag_N_s_per_m"), step: mid("force_step_N_per_ms"), peak: mid("peak_force_N"), drift: mid("drift_mm"), held: mid("held_s"),
    };
  };
  const ranked = laws.map(of).sort((a, b) => b.stable - a.stable || a.off - b.off);
  const number = (value) => (value === null ? "–" : brief(value));
  table(part, [["law"], ["stable [%]", 1], ["energy made [J]", 1], ["felt by touched", 1], ["drag [N·s/m]", 1],
    ["force step [N/ms]", 1], ["contact peak [N]", 1], ["drift [mm]", 1], ["held [s]", 1]],
  ranked.map((own) => [own.law, brief(100 * own.stable), brief(-own.energy), number(own.transparency), number(own.drag),
    number(own.step), number(own.peak), number(own.drift), number(own.held)]));
}

function showLargest(page, data, laws, environments) {
  const part = section(page, "Largest stable round trip [ms]",
    "Up to here every delay of the sweep was stable: without jitter and loss / with any of the sweep.");
  const number = (value) => (value === null ? "–" : String(value));
  const cell = (law, environment) => {
    const own = data.largest_stable.find((each) => each.law === law && each.environment === environment);
    return own ? number(own.ideal_ms) + " / " + number(own.worst_ms) : "";
  };
  table(part, [["law"], ...environments.map((name) => [name, 1])],
    laws.map((law) => [law, ...environments.map((environment) => cell(law, environment))]));
}

/** How many of the trials `own` are stable, on the colour of all, some or none. */
function stability(own) {
  const good = own.filter((row) => row.stable).length;
  const idle = own.every((row) => row.task_time_s === null);
  const worst = Math.max(...own.map((row) => (row.swing_m === null ? Infinity : row.swing_m)));
  const unstable = own.filter((row) => !row.stable)
    .map((row) => `\nunstable: jitter ${row.jitter_ms} ms, loss ${row.loss}, seed ${row.seed}`);
  const mark = document.createElement("span");
  mark.className = "mark " + (good === own.length ? "all" : good === 0 ? "none" : "some");
  mark.textContent = good + "/" + own.length + (idle ? " ○" : "");
  mark.title = `largest swing ${brief(worst * 1e3)} mm` + unstable.join("");
  return mark;
}

function showMaps(page, rows, laws, environments) {
  const delays = distinct(rows, "rtt_ms").sort((a, b) => a - b);
  const part = section(page, "Stability",
    "Stable trials of all jitters, losses and seeds, over the round trip [ms]. ○: the task was not done in time in any of them.");
  for (const environment of environments) {
    make(part, "h3", environment);
    const cell = (law, delay) => stability(
      rows.filter((row) => row.environment === environment && row.law === law && row.rtt_ms === delay));
    table(part, [["law"], ...delays.map((delay) => [String(delay)])],
      laws.map((law) => [law, ...delays.map((delay) => cell(law, delay))]));
  }
}

function showCurves(page, rows, laws, environments) {
  const part = section(page, "Curves", "Medians over the seeds. Hollow: unstable.");
  const bar = make(part, "div", null, "bar");
  const quantity = choice(bar, "quantity", QUANTITIES.map(([key, text]) => [key, text]), () => show());
  const environment = choice(bar, "environment", environments.map((name) => [name, name]), () => show());
  const pairs = [...new Set(rows.map((row) => row.jitter_ms + "|" + row.loss))];
  const line = choice(bar, "jitter, loss", pairs.map((pair) => {
    const [jitter, loss] = pair.split("|");
    return [pair, `${jitter} ms, ${brief(100 * loss)} %`];
  }), () => show());
  const which = choice(bar, "trials", [["stable", "stable only"], ["all", "all"]], () => show());
  if (environments.includes("hard_wall")) environment.value = "hard_wall";
  const colourOf = (law) => curveColour(laws.indexOf(law));
  const hidden = legend(make(part, "div", null, "bar"), laws, colourOf, () => show());
  const panel = make(part, "div", null, "panel");
  const labels = { x: "round trip [ms]", y: "" };
  const drawn = chart(panel, [], labels, 380);
  const nothing = make(panel, "p", "Nothing to show: every trial here is unstable, or the quantity is not measured.", "quiet");

  /** The curve of one law through the medians of `own`, its trials. */
  function curve(law, own, key, factor) {
    const points = distinct(own, "rtt_ms").sort((a, b) => a - b).map((x) => {
      const at = own.filter((row) => row.rtt_ms === x);
      return { x, y: median(at.map((row) => row[key])), stable: at.every((row) => row.stable) };
    }).filter((point) => point.y !== null && (point.stable || which.value === "all"));
    return {
      name: law, colour: colourOf(law), dots: true, hollow: points.map((point) => !point.stable),
      x: points.map((point) => point.x), y: points.map((point) => factor * point.y),
      tell: (i) => (points[i].stable ? "" : ", unstable"),
    };
  }

  function show() {
    const [key, text, factor] = QUANTITIES.find(([name]) => name === quantity.value);
    const [jitter, loss] = line.value.split("|").map(Number);
    const here = rows.filter((row) => row.environment === environment.value && row.jitter_ms === jitter && row.loss === loss);
    const curves = laws.filter((law) => !hidden.has(law))
      .map((law) => curve(law, here.filter((row) => row.law === law), key, factor));
    labels.y = text;
    drawn.show(curves);
    nothing.hidden = curves.some((each) => each.x.length > 0);
  }
  show();
}

function showSweep(data) {
  const page = begin(data.title, data.description);
  const laws = distinct(data.rows, "law"), environments = distinct(data.rows, "environment");
  make(page, "p", `${data.rows.length} trials. Positions and forces are at the hand's scale. A law that claims passivity: ` +
    (laws.filter((law) => data.rows.some((row) => row.law === law && row.claims_passivity)).join(", ") || "none") + ".", "quiet");
  showRanking(page, data.rows, laws);
  showLargest(page, data, laws, environments);
  showMaps(page, data.rows, laws, environments);
  showCurves(page, data.rows, laws, environments);
}
