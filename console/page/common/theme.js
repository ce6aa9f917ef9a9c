// The style sheet's colours, for what is drawn.

const NAMES = [
  "page", "panel", "raised", "line", "grid", "text", "quiet", "accent", "measured", "model", "residual", "force",
  "hand", "second", "good", "warn", "bad", "wall", "shade", "link", "joint", "tool", "thing", "table", "dark",
];

/** Colours by name; they change with the theme. */
export const colours = {};

const listeners = new Set();

function read() {
  const style = getComputedStyle(document.documentElement);
  for (const name of NAMES) colours[name] = style.getPropertyValue(`--${name}`).trim();
}

read();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  read();
  listeners.forEach((listener) => listener());
});

/** Calls `listener` when the theme changes. */
export function onTheme(listener) {
  listeners.add(listener);
}

/** A canvas as large as it is shown, in pixels of the screen; its context is scaled to CSS pixels. */
export function fitted(canvas) {
  const scale = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
  }
  const context = canvas.getContext("2d");
  context.setTransform(scale, 0, 0, scale, 0, 0);
  return { context, width, height };
}
