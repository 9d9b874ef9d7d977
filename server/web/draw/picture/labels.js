// Labels next to the mouse, and the line of a cursor across all panels.

import { number } from "../../data/units.js";
import { fill, h } from "../../ui/dom.js";

/** Distance of a label from its point [pixels]. */
const AWAY = 12;

/** @typedef {import("./nearest.js").Reading} Reading */

/**
 * Lines that are said of a point: by its trace, or else its values.
 * @param {Reading} reading
 * @returns {string[]}
 */
export function linesOf(reading) {
  const { trace, row, column } = reading;
  const text = (trace.hovertext ?? trace.text)?.[row];
  const said = trace.describe?.(reading) ?? (Array.isArray(text) ? text[column] : text);
  return String(said ?? [reading.x, reading.y].map(wordOf).join(", "))
    .split("<br>")
    .filter((line) => line.trim() !== "");
}

/** @param {any} value */
function wordOf(value) {
  return typeof value === "number" ? number(value) : String(value);
}

/** Labels of a picture. */
export class Labels {
  element = h("div", { class: "labels" });
  #value = h("span", {});
  #cursor = h("div", { class: "cursor", hidden: true }, this.#value);

  hide() {
    this.#cursor.hidden = true;
    fill(this.element, this.#cursor);
  }

  /** Shows a label at each of some groups of points, which stand below each other in it. @param {Reading[][]} groups */
  show(groups) {
    const labels = groups.map((group) =>
      h(
        "div",
        { class: "reading" },
        group.flatMap((reading) =>
          linesOf(reading).map((line) => this.#line(line, group.length > 1 ? reading : null)),
        ),
      ),
    );
    fill(this.element, this.#cursor, labels);
    groups.forEach((group, order) => this.#put(labels[order], group[0].at));
  }

  /**
   * Draws a line across all panels, with its value.
   * @param {"x" | "y"} direction along which it stands at a pixel
   * @param {number} pixel
   * @param {any} value
   * @param {import("./layout.js").Frame} frame
   */
  cross(direction, pixel, value, { left, top, right, bottom }) {
    this.#cursor.hidden = false;
    this.#cursor.dataset.direction = direction;
    this.#value.textContent = wordOf(value);
    const isUpright = direction === "x";
    Object.assign(this.#cursor.style, {
      left: `${isUpright ? pixel : left}px`,
      top: `${isUpright ? top : pixel}px`,
      width: isUpright ? "0" : `${right - left}px`,
      height: isUpright ? `${bottom - top}px` : "0",
    });
  }

  /** @param {string} words @param {Reading | null} marked the point whose colour stands before the words */
  #line(words, marked) {
    const mark = marked && h("span", { class: "mark" });
    if (mark) mark.style.background = marked.trace.line?.color ?? "";
    return h("div", {}, mark, words);
  }

  /** Puts a label next to a place, within the picture. @param {HTMLElement} label @param {{x: number, y: number}} at */
  #put(label, { x, y }) {
    const { clientWidth, clientHeight } = this.element;
    const { offsetWidth, offsetHeight } = label;
    const left = x > clientWidth / 2 ? x - AWAY - offsetWidth : x + AWAY;
    label.style.left = `${Math.max(0, Math.min(clientWidth - offsetWidth, left))}px`;
    label.style.top = `${Math.max(0, Math.min(clientHeight - offsetHeight, y - offsetHeight / 2))}px`;
  }
}
