// One depth at which a picture of profiles is read: where the mouse is, or where the keyboard moves a cursor.

import { say, unit } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { rounded } from "../ui/router.js";
import { inks } from "./picture/inks.js";
import { adjust } from "./plots.js";

/** Keys that move the cursor, and by how many nodes; what is deeper is below, as in the picture. @type {Record<string, number>} */
const STEPS = {
  ArrowUp: -1,
  ArrowLeft: -1,
  ArrowDown: 1,
  ArrowRight: 1,
  PageUp: -10,
  PageDown: 10,
  Home: -Infinity,
  End: Infinity,
};

/** @typedef {import("../ui/dom.js").Child} Child */
/** @typedef {(depth: number, reading: any[]) => Child | Child[]} Read */

/** A slider over the nodes of a picture of profiles, with the values at its depth in words. */
export class DepthCursor {
  #place;
  #link;
  #read;
  #reading = h(
    "div",
    { class: "small soft", role: "status" },
    "Point at a depth, or move the cursor, to read all profiles there.",
  );
  #slider = h("input", {
    type: "range",
    min: 0,
    max: 0,
    step: 1,
    value: "0",
    disabled: true,
    "aria-label": "Depth cursor",
    onkeydown: (/** @type {KeyboardEvent} */ event) => this.#step(event),
    oninput: () => this.#move(this.#slider.valueAsNumber),
  });
  /** @type {number[]} */
  #depths = [];
  /** Whether the picture has a line at the cursor's depth. */
  #isMarked = false;

  /**
   * @param {HTMLElement} place the picture
   * @param {{query: URLSearchParams, keep: (changes: Record<string, string | null>) => void}} link which holds the cursor's depth
   * @param {Read} read values at a depth in the unit in which it is shown, and the points of the picture that the mouse is at
   */
  constructor(place, link, read) {
    this.#place = place;
    this.#link = link;
    this.#read = read;
    place.addEventListener("pointhover", (event) =>
      this.#hover(/** @type {CustomEvent} */ (event).detail.points),
    );
    const cursor = h(
      "label",
      { class: "field wide" },
      h(
        "span",
        {},
        "Depth cursor: arrow keys move it by a node, Page Up and Page Down by ten, Home and End to the ends",
      ),
      this.#slider,
    );
    this.element = h("div", {}, cursor, this.#reading);
  }

  /** @param {import("./picture/nearest.js").Reading[]} reading at the mouse */
  #hover(reading) {
    const { y } = reading[0];
    this.#slideTo(nearest(this.#depths, y));
    // The mouse has a line of its own.
    if (this.#isMarked) this.#mark(null);
    this.#describe(y, reading);
  }

  /** Follows the picture that has just been drawn. @param {number[]} depths of its nodes */
  follow(depths) {
    this.#depths = depths;
    Object.assign(this.#slider, { max: String(Math.max(0, depths.length - 1)), disabled: !depths.length });
    const { query } = this.#link;
    const asked = query.has("cursor") ? Number(query.get("cursor")) : NaN;
    const isAsked = Number.isFinite(asked) && depths.length > 0;
    this.#slideTo(isAsked ? nearest(depths, asked / unit("measured_depth").size) : 0);
    if (isAsked) this.#show(this.#slider.valueAsNumber);
  }

  /** @param {KeyboardEvent} event */
  #step(event) {
    const step = STEPS[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.#move(Math.max(0, Math.min(this.#depths.length - 1, this.#slider.valueAsNumber + step)));
  }

  /** Moves the cursor to a node. @param {number} index */
  #move(index) {
    this.#slideTo(index);
    this.#link.keep({ cursor: String(rounded(this.#depths[index] * unit("measured_depth").size)) });
    this.#show(index);
  }

  /** @param {number} index of a node */
  #slideTo(index) {
    this.#slider.value = String(index);
    this.#slider.setAttribute("aria-valuetext", depthOf(this.#depths[index] ?? 0));
  }

  /** Shows and reads the values at a node. @param {number} index */
  #show(index) {
    this.#mark(this.#depths[index]);
    this.#describe(this.#depths[index], []);
  }

  /** Draws a line at a depth, or none. @param {number | null} depth */
  #mark(depth) {
    this.#isMarked = depth !== null;
    const line = {
      type: "line",
      xref: "paper",
      x0: 0,
      x1: 1,
      y0: depth,
      y1: depth,
      line: { color: inks().text, width: 1 },
    };
    adjust(this.#place, { shapes: this.#isMarked ? [line] : [] });
  }

  /** @param {number} depth in the unit in which it is shown @param {any[]} reading */
  #describe(depth, reading) {
    fill(this.#reading, `At ${depthOf(depth)}: `, this.#read(depth, reading));
  }
}

/** @param {number} depth in the unit in which it is shown */
function depthOf(depth) {
  return say("measured_depth", depth * unit("measured_depth").size);
}

/** Index of the depth that is nearest to another; the first of equals. @param {(number | null)[]} depths @param {number} depth */
export function nearest(depths, depth) {
  return depths.reduce(
    (/** @type {number} */ best, entry, index) =>
      Math.abs(Number(entry) - depth) < Math.abs(Number(depths[best]) - depth) ? index : best,
    0,
  );
}
