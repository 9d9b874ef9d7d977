// Clouds of many points: traces of the type `dots`. The drawing library, which takes seconds for as many marks, draws the axes and the outermost
// points; all dots are painted on a canvas that lies in its picture as an image, and so is saved with it.

import { number } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { colourScale } from "./colours.js";

/** Points beyond which they are dots. */
export const MANY = 3000;
/** Greatest distance of the mouse from a dot that is read, and movement below which a press is a click [pixels]. */
const [NEAR, CLICK_PX] = [8, 4];

/** Traces as the drawing library takes them: of a cloud, its outermost points, which span the axes. @param {any[]} traces */
export function spanned(traces) {
  return traces.map((trace) => {
    if (trace.type !== "dots") return trace;
    const { tell: _, ...rest } = trace;
    const rows = outermost(trace.x, trace.y);
    const { color, cmin, cmax } = trace.marker;
    const pick = (/** @type {ArrayLike<any>} */ values) => rows.map((row) => values[row]);
    const [least, largest] = Array.isArray(color) ? rangeOf(color) : [0, 1];
    return {
      ...rest,
      type: "scatter",
      x: pick(trace.x),
      y: pick(trace.y),
      text: undefined,
      customdata: undefined,
      hoverinfo: "skip",
      marker: Array.isArray(color)
        ? { ...trace.marker, color: pick(color), cmin: cmin ?? least, cmax: cmax ?? largest }
        : trace.marker,
    };
  });
}

/**
 * Rows of points that reach as far as all do on linear and logarithmic axes, and have all words of others.
 * @param {ArrayLike<any>} x
 * @param {ArrayLike<any>} y
 * @returns {number[]}
 */
export function outermost(x, y) {
  const has = (/** @type {any} */ value) => value !== null && value !== undefined;
  const rows = Array.from({ length: x.length }, (_, row) => row).filter((row) => has(x[row]) && has(y[row]));
  /** @type {Set<number>} */
  const found = new Set();
  for (const values of [x, y]) {
    /** @type {Map<string, number>} */
    const words = new Map();
    let [least, positive, largest] = [-1, -1, -1];
    for (const row of rows) {
      const value = values[row];
      if (typeof value === "string") {
        if (!words.has(value)) words.set(value, row);
        continue;
      }
      if (least < 0 || value < values[least]) least = row;
      if (value > 0 && (positive < 0 || value < values[positive])) positive = row;
      if (largest < 0 || value > values[largest]) largest = row;
    }
    for (const row of [...words.values(), least, positive, largest]) if (row >= 0) found.add(row);
  }
  return [...found];
}

/** @param {any[]} values @returns {[number, number]} */
function rangeOf(values) {
  let [least, largest] = [Infinity, -Infinity];
  for (const value of values) {
    if (typeof value !== "number") continue;
    if (value < least) least = value;
    if (value > largest) largest = value;
  }
  return least <= largest ? [least, largest] : [0, 1];
}

/** Colours of a trace's points. @param {any} trace @param {string} without colour of a point without a value @returns {(row: number) => string} */
function coloursOf({ marker: { color, colorscale, cmin, cmax } }, without) {
  if (!Array.isArray(color)) return () => color;
  const [least, largest] = rangeOf(color);
  const of = colourScale(colorscale, cmin ?? least, cmax ?? largest);
  return (row) => (typeof color[row] === "number" ? of(color[row]) : without);
}

/** The dots of a picture, painted anew for each change of its axes. */
export class Cloud {
  #place;
  /** @type {any[]} */
  #traces = [];
  /** Places of the points of each trace in the picture [pixels]; not a number where there is none. @type {{x: Float64Array, y: Float64Array}[]} */
  #at = [];
  #label = h("div", { class: "dot-label", hidden: true });
  /** Newest move of the mouse that is not yet read. @type {PointerEvent | null} */
  #moved = null;

  /** @param {HTMLElement} place that the drawing library has drawn in */
  constructor(place) {
    this.#place = place;
    place.append(this.#label);
    place.addEventListener("pointermove", (event) => this.#point(event));
    place.addEventListener("pointerleave", () => (this.#label.hidden = true));
    place.addEventListener("pointerdown", (event) => this.#press(event), { capture: true });
  }

  /** Takes the traces of dots among some. @param {any[]} traces */
  show(traces) {
    this.#traces = traces.filter(({ type }) => type === "dots");
    this.#at = [];
  }

  /**
   * Paints the dots by the axes of the picture.
   * @param {string} without colour of a point without a value
   * @returns {any[]} images of the picture's layout
   */
  paint(without) {
    this.#label.hidden = true;
    if (!this.#traces.length) return [];
    const { xaxis, yaxis } = /** @type {any} */ (this.#place)._fullLayout;
    const [width, height, scale] = [xaxis._length, yaxis._length, devicePixelRatio || 1];
    const canvas = h("canvas", { width: Math.round(width * scale), height: Math.round(height * scale) });
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.#at = this.#traces.map(({ x, y }) => ({ x: placed(x, xaxis), y: placed(y, yaxis) }));
    this.#traces.forEach((trace, order) => {
      const colour = coloursOf(trace, without);
      const size = Math.max(1, Math.round(trace.marker.size * scale));
      const { x, y } = this.#at[order];
      for (let row = 0; row < x.length; row += 1) {
        pen.fillStyle = colour(row);
        // On whole pixels, which need no shades at the rims.
        pen.fillRect(
          Math.round(x[row] * scale - size / 2),
          Math.round(y[row] * scale - size / 2),
          size,
          size,
        );
      }
    });
    return [
      {
        source: canvas.toDataURL(),
        xref: "paper",
        yref: "paper",
        x: 0,
        y: 1,
        sizex: 1,
        sizey: 1,
        sizing: "stretch",
        layer: "above",
      },
    ];
  }

  /** The dot next to the mouse. @param {{clientX: number, clientY: number}} event */
  #nearest({ clientX, clientY }) {
    const { xaxis, yaxis } = /** @type {any} */ (this.#place)._fullLayout;
    const { left, top } = this.#place.getBoundingClientRect();
    const [across, down] = [clientX - left - xaxis._offset, clientY - top - yaxis._offset];
    if (across < 0 || down < 0 || across > xaxis._length || down > yaxis._length) return null;
    let [best, least] = [/** @type {{trace: any, row: number} | null} */ (null), NEAR ** 2];
    this.#at.forEach(({ x, y }, order) => {
      for (let row = 0; row < x.length; row += 1) {
        const apart = (x[row] - across) ** 2 + (y[row] - down) ** 2;
        if (apart < least) [best, least] = [{ trace: this.#traces[order], row }, apart];
      }
    });
    return /** @type {{trace: any, row: number} | null} */ (best);
  }

  /** @param {PointerEvent} event */
  #point(event) {
    if (!this.#traces.length) return;
    const isDue = this.#moved !== null;
    this.#moved = event;
    if (!isDue) requestAnimationFrame(() => this.#read());
  }

  /** Shows the values of the dot next to the mouse. */
  #read() {
    const event = this.#moved;
    this.#moved = null;
    const found = !event || event.buttons ? null : this.#nearest(event);
    this.#label.hidden = !found;
    if (!event || !found) return;
    const { trace, row } = found;
    const said =
      trace.text?.[row] ?? trace.tell?.(row) ?? [trace.x[row], trace.y[row]].map(wordOf).join(", ");
    fill(
      this.#label,
      String(said)
        .split("<br>")
        .map((line) => h("div", {}, line)),
    );
    const { left, top, width } = this.#place.getBoundingClientRect();
    const isRight = event.clientX - left > width / 2;
    Object.assign(this.#label.style, {
      top: `${event.clientY - top + 12}px`,
      left: isRight ? "auto" : `${event.clientX - left + 12}px`,
      right: isRight ? `${width - (event.clientX - left) + 12}px` : "auto",
    });
  }

  /** @param {PointerEvent} start */
  #press(start) {
    if (start.button !== 0 || !this.#traces.length) return;
    // The library covers the page while the mouse is held.
    const released = (/** @type {PointerEvent} */ event) => {
      const moved = Math.hypot(event.clientX - start.clientX, event.clientY - start.clientY);
      if (moved < CLICK_PX) this.#click(event);
    };
    window.addEventListener("pointerup", released, { capture: true, once: true });
  }

  /** Reports a click on a dot as the drawing library reports one on a mark. @param {PointerEvent} event */
  #click(event) {
    const found = this.#nearest(event);
    if (!found) return;
    const { trace, row } = found;
    const point = { x: trace.x[row], y: trace.y[row], customdata: trace.customdata?.[row] };
    /** @type {any} */ (this.#place).emit("plotly_click", { points: [point] });
  }
}

/** @param {ArrayLike<any>} values @param {any} axis of the drawing library */
function placed(values, axis) {
  return Float64Array.from(values, (value) => (value === null ? NaN : axis.d2p(value)));
}

/** @param {any} value */
function wordOf(value) {
  return typeof value === "number" ? number(value) : String(value);
}
