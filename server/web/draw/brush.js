// A window of time that is dragged across a history, and an orbit that follows it: painted over its picture, which plotly takes several
// frames to draw anew. Plotly's own selection would tell of the window 20 times a second at most.

import { h } from "../ui/dom.js";

/** Share of the picture that the whole motion fills. */
const FILLED = 0.9;

/**
 * Lets a window be dragged across a picture whose `dragmode` is `select`.
 * @param {HTMLElement} place the picture, once it is drawn
 * @param {(range: [number, number]) => void} moved told of the window at most once a frame
 * @param {(range: [number, number] | null) => void} ended told of the window at last; of none where the drag was broken off
 * @param {AbortSignal} signal
 */
export function dragWindow(place, moved, ended, signal) {
  const shade = h("div", { class: "window", hidden: true });
  place.append(shade);
  const layout = () => /** @type {any} */ (place)._fullLayout;
  /** @type {number | null} */
  let start = null;
  let end = 0;
  let isAsked = false;
  /** @param {PointerEvent} event place across the axis [pixels] */
  const across = (event) => {
    const { _offset, _length } = layout().xaxis;
    return Math.max(0, Math.min(_length, event.clientX - place.getBoundingClientRect().left - _offset));
  };
  /** @returns {[number, number]} */
  const range = () => {
    const [from, to] = [start ?? end, end].sort((a, b) => a - b).map((pixel) => layout().xaxis.p2l(pixel));
    return [from, to];
  };
  const isMine = (/** @type {Event} */ event) =>
    layout()?.dragmode === "select" &&
    event.target instanceof Element &&
    event.target.classList.contains("nsewdrag");
  const frame = () => {
    isAsked = false;
    if (start === null) return;
    const { _offset } = layout().xaxis;
    shade.style.left = `${_offset + Math.min(start, end)}px`;
    shade.style.width = `${Math.abs(end - start)}px`;
    moved(range());
  };
  const finish = (/** @type {[number, number] | null} */ chosen) => {
    start = null;
    shade.hidden = true;
    ended(chosen);
  };
  // Before plotly hears of it.
  const keepOut = (/** @type {Event} */ event) => isMine(event) && event.stopPropagation();
  for (const kind of ["mousedown", "touchstart"])
    place.addEventListener(kind, keepOut, { capture: true, signal });
  place.addEventListener(
    "pointerdown",
    (event) => {
      if (!isMine(event) || event.button !== 0) return;
      // Across all panels over the axis of time.
      const { t, h: height } = layout()._size;
      start = end = across(event);
      // Plotly, which would look for what is below the mouse, hears nothing while this place has the pointer.
      place.setPointerCapture(event.pointerId);
      Object.assign(shade.style, { top: `${t}px`, height: `${height}px`, width: "0" });
      shade.hidden = false;
    },
    { signal },
  );
  place.addEventListener(
    "pointermove",
    (event) => {
      if (start === null) return;
      end = across(event);
      if (!isAsked) requestAnimationFrame(frame);
      isAsked = true;
    },
    { signal },
  );
  place.addEventListener(
    "pointerup",
    (event) => {
      if (start === null) return;
      end = across(event);
      finish(range());
    },
    { signal },
  );
  place.addEventListener("pointercancel", () => start !== null && finish(null), { signal });
}

/** The orbit of a window that is being dragged. */
export class Brush {
  #canvas = document.createElement("canvas");
  #place;
  #colour;
  #time;
  /** @type {Float64Array} */
  #x;
  /** @type {Float64Array} */
  #y;

  /**
   * @param {HTMLElement} place the picture of the orbit
   * @param {any} trace of the whole history, as plotly takes it
   * @param {number[]} time of its samples, rising
   */
  constructor(place, trace, time) {
    this.#place = place;
    this.#colour = trace.line.color;
    this.#time = Float64Array.from(time);
    this.#x = Float64Array.from(trace.x);
    this.#y = Float64Array.from(trace.y);
    this.#canvas.className = "brush";
    place.append(this.#canvas);
    place.classList.add("brushed");
  }

  /** Changes of the layout that show the whole motion, so that no brushed part lies outside. */
  layout() {
    const ends = (/** @type {Float64Array} */ values) => [
      values.reduce((a, b) => Math.min(a, b), Infinity),
      values.reduce((a, b) => Math.max(a, b), -Infinity),
    ];
    const [x, y] = [ends(this.#x), ends(this.#y)];
    const half = Math.max(x[1] - x[0], y[1] - y[0]) / (2 * FILLED) || 1;
    const about = (/** @type {number[]} */ [low, high]) => [(low + high) / 2 - half, (low + high) / 2 + half];
    return { "xaxis.range": about(x), "yaxis.range": about(y) };
  }

  /**
   * @param {[number, number]} range of time, half-open
   * @returns {[number, number]} the rows of the history in it, half-open
   */
  rows([from, to]) {
    return [firstNotBelow(this.#time, from), firstNotBelow(this.#time, to)];
  }

  /** @param {[number, number]} range of time, half-open */
  paint(range) {
    this.#draw(this.#x, this.#y, ...this.rows(range));
  }

  /** Paints all of another trace, as one with more samples of the window. @param {any} trace */
  paintTrace(trace) {
    this.#draw(trace.x, trace.y, 0, trace.x.length);
  }

  /**
   * @param {ArrayLike<number>} xs
   * @param {ArrayLike<number>} ys
   * @param {number} first @param {number} end
   */
  #draw(xs, ys, first, end) {
    const { xaxis, yaxis } = /** @type {any} */ (this.#place)._fullLayout;
    const scale = devicePixelRatio;
    const [width, height] = [this.#place.clientWidth * scale, this.#place.clientHeight * scale];
    const pen = this.#canvas.getContext("2d");
    if (!pen) return;
    if (this.#canvas.width !== width || this.#canvas.height !== height)
      [this.#canvas.width, this.#canvas.height] = [width, height];
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.save();
    pen.beginPath();
    pen.rect(xaxis._offset, yaxis._offset, xaxis._length, yaxis._length);
    pen.clip();
    // Axes are linear: two places tell all.
    const along = (/** @type {any} */ axis) => [axis._offset + axis.l2p(0), axis.l2p(1) - axis.l2p(0)];
    const [[left, right], [top, down]] = [along(xaxis), along(yaxis)];
    pen.beginPath();
    for (let row = first; row < end; row += 1) pen.lineTo(left + right * xs[row], top + down * ys[row]);
    pen.strokeStyle = this.#colour;
    pen.lineWidth = 1;
    pen.stroke();
    pen.restore();
    this.#place.dispatchEvent(new CustomEvent("brushed"));
  }

  /** Gives the picture back. */
  end() {
    this.#canvas.remove();
    this.#place.classList.remove("brushed");
  }
}

/** @param {Float64Array} values rising @param {number} value */
function firstNotBelow(values, value) {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}
