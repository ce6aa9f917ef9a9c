// What the page shows, from top to bottom.

const QUANTITIES = [
  ["position_rmse_m", "position error, free [mm]", 1e3],
  ["force_rmse_N", "force error [N]", 1],
  ["transparency", "stiffness felt by stiffness touched", 1],
  ["drift_m", "drift at the end [mm]", 1e3],
  ["peak_force_N", "peak contact force [N]", 1],
  ["peak_felt_N", "peak force in the hand [N]", 1],
  ["energy_margin_J", "energy margin [J]", 1],
  ["felt_damping_Ns_m", "damping felt in free space [N·s/m]", 1],
  ["task_time_s", "time of the task [s]", 1],
];

const distinct = (rows, key) => [...new Set(rows.map((row) => row[key]))];

function median(values) {
  const sorted = values.filter((v) => v !== null && isFinite(v)).sort((a, b) => a - b);
  return sorted.length ? sorted[sorted.length >> 1] : null;
}

function showLargest(page, data, laws, environments) {
  const part = section(page, "Largest stable round trip [ms]",
    "Up to here every delay of the sweep was stable: without jitter and loss / with any of the sweep.");
  const number = (value) => (value === null ? "–" : String(value));
  grid(make(part, "div", null, "panel"), "law", environments, laws, (row, column) => {
    const own = data.largest_stable.find((e) => e.law === laws[row] && e.environment === environments[column]);
    return { text: own ? number(own.ideal_ms) + " / " + number(own.worst_ms) : "" };
  });
}

function showMaps(page, rows, laws, environments) {
  const delays = distinct(rows, "rtt_ms").sort((a, b) => a - b);
  const part = section(page, "Stability",
    "Stable trials of all jitters, losses and seeds, over the round trip [ms]. ○: the task was not done in time in any of them.");
  for (const environment of environments) {
    const panel = make(part, "div", null, "panel");
    make(panel, "h3", environment);
    grid(panel, "law", delays.map(String), laws, (row, column) => {
      const own = rows.filter((r) => r.environment === environment && r.law === laws[row] && r.rtt_ms === delays[column]);
      const good = own.filter((r) => r.stable).length;
      const kind = good === own.length ? "all" : good === 0 ? "none" : "some";
      const worst = Math.max(...own.map((r) => (r.swing_m === null ? Infinity : r.swing_m)));
      const hint = own.filter((r) => !r.stable).map((r) => `unstable: jitter ${r.jitter_ms} ms, loss ${r.loss}, seed ${r.seed}`).join("\n");
      const idle = own.every((r) => r.task_time_s === null);
      return { text: good + "/" + own.length + (idle ? " ○" : ""), kind, hint: `largest swing ${brief(worst * 1e3)} mm` + (hint ? "\n" + hint : "") };
    }, "map");
  }
}

function showCurves(page, rows, laws, environments) {
  const part = section(page, "Curves", "Medians over the seeds. Hollow: unstable.");
  const bar = make(part, "div", null, "bar");
  const legend = make(part, "div", null, "bar");
  const panel = make(part, "div", null, "panel");
  const hidden = new Set();
  const quantity = choice(bar, "quantity", QUANTITIES.map(([key, text]) => [key, text]), () => show());
  const environment = choice(bar, "environment", environments.map((e) => [e, e]), () => show());
  const pairs = [...new Set(rows.map((r) => r.jitter_ms + "|" + r.loss))];
  const line = choice(bar, "jitter, loss", pairs.map((p) => {
    const [jitter, loss] = p.split("|");
    return [p, `${jitter} ms, ${brief(100 * loss)} %`];
  }), () => show());
  const which = choice(bar, "trials", [["stable", "stable only"], ["all", "all"]], () => show());
  if (environments.includes("hard_wall")) environment.value = "hard_wall";
  laws.forEach((law, n) => {
    const button = make(legend, "button");
    make(button, "span", null, "swatch").style.background = `var(--curve-${n % 6})`;
    button.append(law);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      if (!hidden.delete(law)) hidden.add(law);
      button.setAttribute("aria-pressed", String(!hidden.has(law)));
      show();
    });
  });
  function show() {
    panel.textContent = "";
    const [key, text, factor] = QUANTITIES.find(([name]) => name === quantity.value);
    const [jitter, loss] = line.value.split("|").map(Number);
    const here = rows.filter((r) => r.environment === environment.value && r.jitter_ms === jitter && r.loss === loss);
    const all = laws.map((law, n) => {
      if (hidden.has(law)) return { points: [] };
      const own = here.filter((r) => r.law === law);
      const points = distinct(own, "rtt_ms").sort((a, b) => a - b).map((rtt) => {
        const at = own.filter((r) => r.rtt_ms === rtt);
        const stable = at.every((r) => r.stable);
        const value = median(at.map((r) => r[key]));
        return value === null ? null : { x: rtt, y: factor * value, stable, hint: `${law}, ${rtt} ms: ${brief(factor * value)}${stable ? "" : ", unstable"}` };
      });
      return { colour: `var(--curve-${n % 6})`, points: points.filter((p) => p && (p.stable || which.value === "all")) };
    });
    curves(panel, all, "round trip [ms]", text);
  }
  show();
}

function showSweep(data) {
  const page = document.getElementById("page");
  const laws = distinct(data.rows, "law"), environments = distinct(data.rows, "environment");
  make(page, "h1", "Delay laws over delay, jitter and loss");
  make(page, "p", data.description);
  make(page, "p", `${data.rows.length} trials. Positions and forces are at the hand's scale. A law that claims passivity: ` +
    (laws.filter((law) => data.rows.some((r) => r.law === law && r.claims_passivity)).join(", ") || "none") + ".", "quiet");
  showLargest(page, data, laws, environments);
  showMaps(page, data.rows, laws, environments);
  showCurves(page, data.rows, laws, environments);
}
