// Charts by plotly.js, which comes with the program.

import { colours, onTheme } from "../common/theme.js";

let loading = null;
const drawn = new Map();

/** plotly.js, loaded once. */
function plotly() {
  loading ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = "/plotly.js";
    script.onload = () => resolve(window.Plotly);
    script.onerror = () => reject(new Error("plotly.js could not be loaded"));
    document.head.append(script);
  });
  return loading;
}

/** Loads plotly.js once the page has nothing else to do: the first chart need not wait for it. */
export function prepare() {
  // Where it fails, the first chart says so.
  setTimeout(() => plotly().catch(() => {}), 100);
}

/** On a narrow screen the buttons would lie on the legend. */
const NARROW = matchMedia("(max-width: 500px)");
const CONFIG = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };

/** An axis with its title and unit. */
export function axis(title, unit, more = {}) {
  return {
    title: { text: unit ? `${title} [${unit}]` : title, font: { size: 12 }, standoff: 6 },
    gridcolor: colours.grid, zerolinecolor: colours.line, linecolor: colours.line, tickfont: { size: 11 }, automargin: true, ...more,
  };
}

function layout(more) {
  return {
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: colours.text, size: 12, family: 'system-ui, "DejaVu Sans", sans-serif' },
    margin: { l: 56, r: 12, t: 8, b: 40 }, hovermode: "closest", hoverlabel: { font: { size: 12 } },
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0, font: { size: 12 } }, dragmode: "zoom", modebar: { bgcolor: "rgba(0,0,0,0)", color: colours.quiet, activecolor: colours.accent }, uirevision: "keep", ...more,
  };
}

/** Whether a graphics card draws. Without one WebGL is computed, which takes far longer than lines in SVG. */
function byGraphicsCard() {
  const gl = document.createElement("canvas").getContext("webgl", { failIfMajorPerformanceCaveat: true });
  const named = gl?.getExtension("WEBGL_debug_renderer_info");
  return gl !== null && !(named && /swiftshader|llvmpipe|softpipe|software|basic render/i.test(gl.getParameter(named.UNMASKED_RENDERER_WEBGL)));
}
const kind = byGraphicsCard() ? "scattergl" : "scatter";
const drawable = (trace) => (trace.type === "scattergl" ? { ...trace, type: kind } : trace);

/**
 * Draws in `element`. `make` gives { data, layout, small (without buttons) } with
 * the colours of the theme, and is asked again when that changes.
 */
export async function draw(element, make) {
  const library = await plotly();
  drawn.set(element, make);
  const chart = make();
  await library.react(element, chart.data.map(drawable), layout(chart.layout), { ...CONFIG, displayModeBar: chart.small || NARROW.matches ? false : "hover" });
}

/** Forgets charts that are no longer on the page. */
export async function tidy() {
  for (const element of drawn.keys()) {
    if (element.isConnected) continue;
    drawn.delete(element);
    (await plotly()).purge(element);
  }
}

const anew = () => drawn.forEach((make, element) => draw(element, make));
onTheme(anew);
NARROW.addEventListener("change", anew);
