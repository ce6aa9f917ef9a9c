// What of a page cannot be read: texts that are cut off by the window, by what they are in, or by their canvas.

/** Notes from now on where words are drawn on canvases. */
function watchCanvases() {
  if (window.drawnWords) return;
  window.drawnWords = new Map();
  const pen = CanvasRenderingContext2D.prototype;
  const { fillText, clearRect } = pen;
  pen.clearRect = function (...box) {
    window.drawnWords.set(this.canvas, []);
    return clearRect.apply(this, box);
  };
  pen.fillText = function (text, x, y, ...rest) {
    const size = this.measureText(text), turn = this.getTransform();
    const corners = [[-size.actualBoundingBoxLeft, -size.actualBoundingBoxAscent], [size.actualBoundingBoxRight, size.actualBoundingBoxDescent]]
      .map(([dx, dy]) => turn.transformPoint({ x: x + dx, y: y + dy }));
    const [xs, ys] = [corners.map((own) => own.x), corners.map((own) => own.y)];
    const words = window.drawnWords.get(this.canvas) || [];
    words.push({ text: String(text), left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys), bottom: Math.max(...ys) });
    window.drawnWords.set(this.canvas, words);
    return fillText.call(this, text, x, y, ...rest);
  };
}

/** Complaints, each in words. */
function misfits() {
  const found = new Set();
  const room = document.documentElement.clientWidth;
  const phone = room < 500;
  if (document.documentElement.scrollWidth > room + 1) found.add(`the page is ${document.documentElement.scrollWidth} px wide`);
  const scrolls = (element) => ["auto", "scroll"].includes(getComputedStyle(element).overflowX) && element.scrollWidth > element.clientWidth + 1;
  const cuts = (element) => ["hidden", "clip"].includes(getComputedStyle(element).overflowX);
  const name = (text) => `“${text.trim().replace(/\s+/g, " ").slice(0, 60)}”`;

  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const own = node.parentElement;
    if (!node.textContent.trim() || ["SCRIPT", "STYLE", "NOSCRIPT", "OPTION"].includes(own.tagName)) continue;
    if (own.closest(".skip") || !own.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const box = range.getBoundingClientRect();
    if (!box.width) continue;
    const outside = (frame) => box.left < frame.left - 1.5 || box.right > frame.right + 1.5;
    let scrolled = false;
    for (let frame = own; frame && frame !== document.body; frame = frame.parentElement) {
      if (scrolls(frame)) {
        // A phone's user draws a wide table along; at a desk all of it is seen.
        if (!phone && outside(frame.getBoundingClientRect())) found.add(`${name(node.textContent)} has to be scrolled to`);
        scrolled = true;
        break;
      }
      const svg = frame.tagName === "svg" && frame.ownerSVGElement === null;
      if ((cuts(frame) || svg) && frame.getBoundingClientRect().width && outside(frame.getBoundingClientRect())) {
        found.add(`${name(node.textContent)} is cut off by ${frame.tagName.toLowerCase()}${frame.id ? "#" + frame.id : ""}.${frame.getAttribute("class") || ""}`);
        break;
      }
    }
    if (!scrolled && outside({ left: 0, right: room })) found.add(`${name(node.textContent)} is cut off by the window`);
  }

  for (const [canvas, words] of window.drawnWords || []) {
    if (!canvas.isConnected || !canvas.clientWidth) continue;
    const label = canvas.id || canvas.getAttribute("aria-label") || "canvas";
    for (const word of words) {
      if (word.left < -1 || word.top < -1 || word.right > canvas.width + 1 || word.bottom > canvas.height + 1) found.add(`${name(word.text)} is cut off by the canvas ${label}`);
      const over = canvas.id !== "scene" && words.find((other) => other !== word && other.text !== word.text
        && Math.min(word.right, other.right) - Math.max(word.left, other.left) > 2 && Math.min(word.bottom, other.bottom) - Math.max(word.top, other.top) > 2);
      if (over) found.add(`${name(word.text)} lies on ${name(over.text)} in the canvas ${label}`);
    }
  }
  return [...found];
}
