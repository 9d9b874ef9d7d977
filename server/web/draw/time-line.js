// The time cursor in a picture: a line over an axis of time that the mouse and arrow keys move, or dots at the places of that time.
// Both lie above the canvas, which is not drawn anew for them: a player moves them at each frame.

import { valueAtTime } from "../data/at-time.js";
import { number, say, unit } from "../data/units.js";
import { h } from "../ui/dom.js";
import { pictureOf } from "./picture/picture.js";

/** Steps of the arrow keys in the range that is shown. */
const STEPS = 200;
/** Keys that move the cursor, and by how many steps. @type {Record<string, number>} */
const KEYS = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageDown: -10,
  PageUp: 10,
  Home: -Infinity,
  End: Infinity,
};

/** @typedef {import("./time-cursor.js").TimeCursor} TimeCursor */

/**
 * Time after a key, within a range.
 * @param {string} key
 * @param {number} time [s]
 * @param {[number, number]} range [s]
 * @returns {number | null} null of a key that moves nothing
 */
export function movedByKey(key, time, [from, to]) {
  const steps = KEYS[key];
  if (!steps) return null;
  return Math.max(from, Math.min(to, time + (steps * (to - from)) / STEPS));
}

/**
 * Values of curves over time, in words.
 * @param {any[]} traces of a picture
 * @param {(trace: any) => string} symbolOf the unit of a trace
 * @param {number} time [s]
 * @returns {string[]} of each curve that has a value at the time
 */
export function valuesAt(traces, symbolOf, time) {
  return traces.flatMap((trace) => {
    if (trace.type !== "scatter" || !trace.mode?.includes("lines") || trace.isSilent) return [];
    const value = valueAtTime(trace.x, trace.y, time);
    if (value === null) return [];
    const words = `${number(value)} ${symbolOf(trace)}`.trim();
    return [trace.name ? `${trace.name} ${words}` : words];
  });
}

/** The line of a time cursor across all panels of a picture over time. */
export class TimeLine {
  #place;
  #cursor;
  #label = h("span", {});
  #grip = h("div", { class: "grip" });
  #element = h(
    "div",
    {
      class: "time-line",
      role: "slider",
      tabindex: "0",
      hidden: true,
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.#step(event),
      onpointerdown: (/** @type {PointerEvent} */ event) => this.#hold(event),
      onpointermove: (/** @type {PointerEvent} */ event) => this.#drag(event),
    },
    this.#label,
    this.#grip,
  );
  /** Values at the cursor, in words. */
  reading = h("p", { class: "small soft", hidden: true });

  /**
   * @param {HTMLElement} place of the picture, whose axis `x` is of time [s]
   * @param {TimeCursor} cursor
   * @param {AbortSignal} signal of the view
   */
  constructor(place, cursor, signal) {
    this.#place = place;
    this.#cursor = cursor;
    cursor.follow(() => this.#put(), signal);
    signal.addEventListener("abort", () => this.#element.remove(), { once: true });
    place.addEventListener("painted", () => this.#put(), { signal });
    place.addEventListener(
      "placeclick",
      (event) => cursor.move(/** @type {CustomEvent} */ (event).detail.x),
      { signal },
    );
  }

  /** Ends of the axis as it is shown [s]. @returns {[number, number]} */
  get #range() {
    const axis = pictureOf(this.#place)?.axis("xaxis");
    if (!axis) return [0, 0];
    const [from, to] = axis.range;
    return [Math.min(from, to), Math.max(from, to)];
  }

  /** Puts the line at the cursor's time: at the end of the axis that is nearest if it is not shown. */
  #put() {
    const picture = pictureOf(this.#place);
    const axis = picture?.axis("xaxis");
    if (!picture || !axis) return;
    if (this.#element.parentElement !== this.#place) this.#place.append(this.#element);
    const { time } = this.#cursor;
    const [from, to] = this.#range;
    const shown = Math.max(from, Math.min(to, time ?? from));
    const { top, bottom } = picture.frame;
    this.#element.hidden = false;
    this.#element.classList.toggle("away", time !== shown);
    Object.assign(this.#element.style, {
      left: `${axis.toPixel(shown)}px`,
      top: `${top}px`,
      height: `${bottom - top}px`,
    });
    this.#describe(time, shown, [from, to]);
  }

  /** @param {number | null} time @param {number} shown its place on the axis @param {[number, number]} range */
  #describe(time, shown, [from, to]) {
    const values = time === null ? [] : this.#values(time);
    const words = time === null ? "none chosen" : say("time", time);
    this.#label.textContent = time === shown ? words : "";
    for (const [name, value] of Object.entries({
      "aria-label": `Time cursor: ${this.#place.getAttribute("aria-label")}`,
      "aria-valuemin": String(from),
      "aria-valuemax": String(to),
      "aria-valuenow": String(shown),
      "aria-valuetext": [words, ...values].join(", "),
    }))
      this.#element.setAttribute(name, value);
    this.reading.hidden = values.length === 0;
    this.reading.textContent = values.length ? `At ${words}: ${values.join(" · ")}.` : "";
  }

  /** @param {number} time [s] */
  #values(time) {
    const { traces = [], axes } = pictureOf(this.#place) ?? {};
    const symbolOf = (/** @type {any} */ trace) => {
      const { quantity } = axes?.get(trace.yaxis ?? "y")?.own ?? {};
      return trace.symbol ?? (quantity ? unit(quantity).symbol : "");
    };
    return valuesAt(traces, symbolOf, time);
  }

  /** @param {KeyboardEvent} event */
  #step(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const range = this.#range;
    const time = movedByKey(event.key, this.#cursor.time ?? range[0], range);
    if (time === null) return;
    event.preventDefault();
    this.#cursor.move(time);
  }

  /** @param {PointerEvent} event */
  #hold(event) {
    if (event.button !== 0) return;
    event.preventDefault();
    this.#element.setPointerCapture(event.pointerId);
    this.#element.focus({ preventScroll: true });
  }

  /** @param {PointerEvent} event */
  #drag(event) {
    const axis = pictureOf(this.#place)?.axis("xaxis");
    if (!axis || !this.#element.hasPointerCapture(event.pointerId)) return;
    const time = axis.toValue(event.clientX - this.#place.getBoundingClientRect().left);
    const [from, to] = this.#range;
    this.#cursor.move(Math.max(from, Math.min(to, time)));
  }
}

/** A place of the cursor's time in a picture. @typedef {{x: number, y: number, xaxis?: string, yaxis?: string}} Dot */

/**
 * Dots at the places of the cursor's time in a picture of two displacements, such as an orbit.
 * @param {HTMLElement} place of the picture
 * @param {TimeCursor} cursor
 * @param {(time: number) => Dot[]} dotsAt in the units in which they are shown
 * @param {AbortSignal} signal of the view
 */
export function timeDots(place, cursor, dotsAt, signal) {
  const element = h("div", { class: "time-dots", "aria-hidden": "true" });
  const put = () => {
    const picture = pictureOf(place);
    if (!picture) return;
    if (element.parentElement !== place) place.append(element);
    const found = cursor.time === null ? [] : dotsAt(cursor.time);
    const dots = found.flatMap(({ x, y, xaxis = "x", yaxis = "y" }) => {
      const [across, up] = [picture.axes.get(xaxis), picture.axes.get(yaxis)];
      if (!across || !up) return [];
      const [left, top] = [across.toPixel(x), up.toPixel(y)];
      const isSeen = (/** @type {number} */ pixel, /** @type {{offset: number, length: number}} */ axis) =>
        pixel >= axis.offset && pixel <= axis.offset + axis.length;
      if (!isSeen(left, across) || !isSeen(top, up)) return [];
      return [h("i", { style: `left:${left}px;top:${top}px` })];
    });
    element.replaceChildren(...dots);
  };
  cursor.follow(put, signal);
  place.addEventListener("painted", put, { signal });
  signal.addEventListener("abort", () => element.remove(), { once: true });
}
