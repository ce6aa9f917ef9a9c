// How parameters went over recordings or dates.

function showTrend(trends) {
  const page = begin("Trend", "What changed between recordings or dates, with standard errors.");
  for (const trend of trends) {
    make(page, "h2", trend.title);
    make(page, "p", "model fitted to all: " + trend.effects.join(", "), "quiet");
    for (const note of trend.notes) make(page, "p", note, "warning");
    const dated = trend.points.every((point) => point.days !== null);
    const at = (point, n) => (dated ? point.days : n);
    table(page, [["recording"], [dated ? "days since the first" : "number", 1], ["sessions", 1], ["°C", 1], ["error held out", 1], ["missing"]],
      trend.points.map((point, n) => [point.name, brief(at(point, n)), String(point.sessions), brief(point.temperature),
        brief(point.held_out) + " " + trend.unit, point.missing || (point.verdict === null ? "not asked" : point.verdict)]));
    if (trend.came_or_went.length) {
      table(page, [["effect"], ["came or went"], ["between"], ["and"], ["said by"]],
        trend.came_or_went.map((turn) => [turn.effect, turn.came ? "came" : "went", turn.from, turn.to,
          turn.by_diagnosis ? "diagnosis" : "its parameters"]));
    }
    const grid = make(page, "div", null, "maps");
    for (const course of trend.parameters) {
      const panel = make(grid, "div", null, "panel");
      make(panel, "h3", course.name + (course.changes ? ": changes" : ": does not change for certain"));
      const there = trend.points.map((point, n) => [at(point, n), point.parameters[course.name], point.name]).filter(([, own]) => own);
      chart(panel, [{
        name: course.name, colour: course.changes ? "--curve-1" : "--curve-0", dots: true,
        x: there.map(([x]) => x), y: there.map(([, own]) => own.value),
        band: there.map(([, own]) => own.std_error || 0), tell: (i) => " " + there[i][2],
      }], { x: dated ? "days since the first" : "recording", y: course.name + " [" + course.unit + "]" }, 200);
    }
  }
}
