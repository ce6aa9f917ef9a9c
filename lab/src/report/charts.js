"use strict";
// Line charts on a canvas: wheel or pinch zooms time, dragging moves it, a
// drag with Shift (or in the box mode of touch) frames, a double click shows all.

/** The value of a colour of the style sheet. */
function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** A number to be read: four digits, or more where it is large. */
function brief(value) {
  if (value === null || value === undefined || !isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e9 || size < 1e-3) return value.toExponential(2);
  return size >= 1e4 ? value.toFixed(0) : String(Number(value.toPrecision(4)));
}

/** A number on an axis: as many decimals as tell neighbours apart. */
function tickText(value, step) {
  if (Math.abs(value) < step * 1e-6) return "0";
  if (step >= 1e6 || step < 1e-4) return value.toExponential(1);
  return value.toFixed(Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
}

/** Round steps that part [low, high] into about `count` pieces, at least `least` apart. */
function ticks(low, high, count, least) {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0) || !isFinite(raw)) return [];
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const steps = [0.2, 0.5, 1, 2, 5, 10].map((n) => n * power);
  let place = steps.findIndex((step) => step >= raw);
  let found = [];
  // One tick alone gives no scale.
  for (; found.length < 2 && place >= 0; place--) {
    const step = Math.max(steps[place], least || 0);
    found = [];
    for (let n = Math.ceil(low / step); n * step <= high + step * 1e-9 && found.length < 50; n++) {
      found.push({ value: n * step, text: tickText(n * step, step) });
    }
  }
  return found;
}

/** Writes `text` in the middle of `room` pixels, smaller where it would not fit. */
function write(pen, text, x, y, room) {
  const font = pen.font, wide = pen.measureText(text).width;
  if (wide > room) pen.font = font.replace(/\d+px/, Math.max(8, Math.floor(12 * room / wide)) + "px");
  pen.fillText(text, x, y);
  pen.font = font;
}

/** First index whose x is not below `wanted`; x ascends. */
function lowerBound(x, wanted) {
  let from = 0, to = x.length;
  while (from < to) {
    const middle = (from + to) >> 1;
    if (x[middle] < wanted) from = middle + 1; else to = middle;
  }
  return from;
}

const allCharts = [];

/**
 * A chart in `parent`. `curves`: [{name, x, y, colour, band (half width, as
 * long as y), dots, ring (dots as rings, on which others are seen), hollow (which of the dots), wide (a broad pale line, on which others
 * are seen), tell (text on a point), visible}], x ascending; `labels`: {x, y, step (least distance of ticks on
 * x)}; `height` in px; `shades`: [{from, to, colour}] behind the curves.
 */
function chart(parent, curves, labels, height, shades) {
  const box = document.createElement("div");
  box.className = "chart";
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", labels.y + " over " + labels.x);
  const hint = document.createElement("div");
  hint.className = "hint";
  box.append(canvas, hint);
  parent.append(box);
  const self = { curves, shades: shades || [], view: null, pointer: null, drag: null };
  const margin = { left: 62, right: 28, top: 10, bottom: 38 };

  function extent() {
    let low = Infinity, high = -Infinity;
    for (const curve of self.curves) {
      if (!curve.x.length) continue;
      low = Math.min(low, curve.x[0]);
      high = Math.max(high, curve.x[curve.x.length - 1]);
    }
    if (!(low < high)) return isFinite(low) ? [low - 0.5, low + 0.5] : [0, 1];
    // Dots at the ends are whole.
    const room = self.curves.some((curve) => curve.dots) ? (high - low) * 0.015 : 0;
    return [low - room, high + room];
  }

  function height_of(from, to) {
    let low = Infinity, high = -Infinity;
    for (const curve of self.curves) {
      if (curve.visible === false) continue;
      const last = Math.min(curve.x.length, lowerBound(curve.x, to) + 1);
      for (let i = Math.max(0, lowerBound(curve.x, from) - 1); i < last; i++) {
        const y = curve.y[i];
        if (y === null) continue;
        const wide = curve.band ? curve.band[i] : 0;
        low = Math.min(low, y - wide);
        high = Math.max(high, y + wide);
      }
    }
    if (!isFinite(low)) return [-1, 1];
    const room = (high - low) * 0.06 || Math.abs(high) * 0.1 || 1;
    return [low - room, high + room];
  }

  function frame() {
    const [from, to] = self.view || extent();
    const [low, high] = height_of(from, to);
    const width = canvas.clientWidth - margin.left - margin.right;
    const tall = height - margin.top - margin.bottom;
    return {
      from, to, low, high, width, tall,
      x: (value) => margin.left + ((value - from) / (to - from)) * width,
      y: (value) => margin.top + (1 - (value - low) / (high - low)) * tall,
      time: (pixel) => from + ((pixel - margin.left) / width) * (to - from),
    };
  }

  function draw() {
    const scale = window.devicePixelRatio || 1;
    canvas.style.height = height + "px";
    const width = canvas.clientWidth;
    if (!width) return;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    const pen = canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, 'DejaVu Sans', sans-serif";
    const flat = frame(), upwards = ticks(flat.low, flat.high, flat.tall / 45);
    // Beside the numbers there is room for the axis's name.
    margin.left = Math.max(62, 26 + Math.max(...upwards.map(({ text }) => pen.measureText(text).width)));
    const f = frame();
    pen.lineWidth = 1;
    pen.strokeStyle = colour("--line");
    pen.fillStyle = colour("--quiet");
    pen.textAlign = "center";
    for (const { value, text } of ticks(f.from, f.to, f.width / 90, labels.step)) {
      pen.beginPath();
      pen.moveTo(f.x(value), margin.top);
      pen.lineTo(f.x(value), margin.top + f.tall);
      pen.stroke();
      pen.fillText(text, f.x(value), height - 22);
    }
    pen.textAlign = "right";
    for (const { value, text } of upwards) {
      pen.beginPath();
      pen.moveTo(margin.left, f.y(value));
      pen.lineTo(margin.left + f.width, f.y(value));
      pen.stroke();
      pen.fillText(text, margin.left - 6, f.y(value) + 4);
    }
    pen.textAlign = "center";
    write(pen, labels.x, margin.left + f.width / 2, height - 5, width);
    pen.save();
    pen.translate(12, margin.top + f.tall / 2);
    pen.rotate(-Math.PI / 2);
    write(pen, labels.y, 0, 0, 2 * margin.top + f.tall - 8);
    pen.restore();
    pen.save();
    pen.beginPath();
    pen.rect(margin.left, margin.top, f.width, f.tall);
    pen.clip();
    for (const { from, to, colour: name } of self.shades) {
      if (to < f.from || from > f.to) continue;
      pen.fillStyle = colour(name);
      pen.fillRect(f.x(from), margin.top, Math.max(0.5, f.x(to) - f.x(from)), f.tall);
    }
    for (const curve of self.curves) if (curve.visible !== false) drawCurve(pen, f, curve);
    if (self.pointer !== null) {
      pen.strokeStyle = colour("--quiet");
      pen.setLineDash([3, 3]);
      pen.beginPath();
      pen.moveTo(self.pointer, margin.top);
      pen.lineTo(self.pointer, margin.top + f.tall);
      pen.stroke();
      pen.setLineDash([]);
    }
    if (self.drag && self.drag.box) {
      pen.fillStyle = colour("--band");
      pen.fillRect(self.drag.begin, margin.top, self.drag.now - self.drag.begin, f.tall);
    }
    pen.restore();
  }

  function drawCurve(pen, f, curve) {
    const first = Math.max(0, lowerBound(curve.x, f.from) - 1);
    const last = Math.min(curve.x.length, lowerBound(curve.x, f.to) + 1);
    if (curve.band) {
      pen.fillStyle = colour("--band");
      pen.beginPath();
      for (let i = first; i < last; i++) pen.lineTo(f.x(curve.x[i]), f.y(curve.y[i] + curve.band[i]));
      for (let i = last - 1; i >= first; i--) pen.lineTo(f.x(curve.x[i]), f.y(curve.y[i] - curve.band[i]));
      pen.closePath();
      pen.fill();
    }
    pen.strokeStyle = pen.fillStyle = colour(curve.colour);
    pen.lineWidth = curve.wide ? 5 : 1.5;
    pen.globalAlpha = curve.wide ? 0.4 : 1;
    pen.lineJoin = "round";
    pen.beginPath();
    let open = false;
    for (let i = first; i < last; i++) {
      if (curve.y[i] === null) { open = false; continue; }
      const x = f.x(curve.x[i]), y = f.y(curve.y[i]);
      if (open) pen.lineTo(x, y); else pen.moveTo(x, y);
      open = true;
    }
    pen.stroke();
    pen.globalAlpha = 1;
    if (curve.dots) {
      for (let i = first; i < last; i++) {
        if (curve.y[i] === null) continue;
        pen.beginPath();
        pen.arc(f.x(curve.x[i]), f.y(curve.y[i]), curve.ring ? 5.5 : 3.5, 0, 7);
        const hollow = curve.hollow && curve.hollow[i];
        pen.fillStyle = hollow ? colour("--panel") : pen.strokeStyle;
        if (!curve.ring) pen.fill();
        if (hollow || curve.ring) pen.stroke();
      }
    }
  }

  function nearest(x, wanted) {
    const after = lowerBound(x, wanted);
    if (after === 0) return 0;
    if (after >= x.length) return x.length - 1;
    return wanted - x[after - 1] < x[after] - wanted ? after - 1 : after;
  }

  function tell(event) {
    const f = frame();
    const wanted = f.time(event.offsetX);
    const lines = [];
    for (const curve of self.curves) {
      if (curve.visible === false || !curve.x.length) continue;
      const i = nearest(curve.x, wanted);
      if (!lines.length) lines.push(labels.x + " " + Number(curve.x[i].toPrecision(6)));
      let line = curve.name + "  " + brief(curve.y[i]);
      if (curve.band) line += " ± " + brief(curve.band[i]);
      if (curve.tell) line += curve.tell(i);
      lines.push(line);
    }
    hint.textContent = lines.join("\n");
    hint.style.display = lines.length ? "block" : "none";
    const right = event.offsetX > canvas.clientWidth / 2;
    hint.style.left = right ? "" : event.offsetX + 14 + "px";
    hint.style.right = right ? canvas.clientWidth - event.offsetX + 14 + "px" : "";
    hint.style.top = margin.top + 4 + "px";
  }

  function look(from, to) {
    const [low, high] = extent();
    const least = (high - low) * 1e-6;
    if (to - from < least) return;
    if (to - from >= high - low) self.view = null;
    else if (from < low) self.view = [low, low + to - from];
    else if (to > high) self.view = [high - (to - from), high];
    else self.view = [from, to];
    draw();
  }

  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const f = frame(), at = f.time(event.offsetX);
    const factor = Math.exp(Math.max(-1, Math.min(1, event.deltaY / 300)));
    look(at - (at - f.from) * factor, at + (f.to - at) * factor);
    tell(event);
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    const f = frame();
    self.drag = { box: event.shiftKey, begin: event.offsetX, now: event.offsetX, from: f.from, to: f.to };
  });
  canvas.addEventListener("pointermove", (event) => {
    self.pointer = event.offsetX;
    if (self.drag) {
      self.drag.now = event.offsetX;
      if (!self.drag.box && self.view) {
        const f = frame();
        const by = ((event.offsetX - self.drag.begin) / f.width) * (self.drag.to - self.drag.from);
        look(self.drag.from - by, self.drag.to - by);
      }
    }
    tell(event);
    draw();
  });
  canvas.addEventListener("pointerup", () => {
    const drag = self.drag;
    self.drag = null;
    if (drag && drag.box && Math.abs(drag.now - drag.begin) > 4) {
      const f = frame();
      look(f.time(Math.min(drag.begin, drag.now)), f.time(Math.max(drag.begin, drag.now)));
    }
    draw();
  });
  canvas.addEventListener("pointerleave", () => {
    self.pointer = null;
    hint.style.display = "none";
    draw();
  });
  canvas.addEventListener("dblclick", () => { self.view = null; draw(); });
  new ResizeObserver(draw).observe(canvas);

  self.draw = draw;
  self.look = look;
  self.show = (next, shaded) => { self.curves = next; self.shades = shaded || []; self.view = null; draw(); };
  allCharts.push(self);
  draw();
  return self;
}
