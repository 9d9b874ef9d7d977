// Strings at rest in their holes, in pictures next to each other from one viewpoint, at one scale and in one scale of colours.

import { kindsOf, partsOf } from "../data/string-parts.js";
import { label, say, shown, unit } from "../data/units.js";
import { nodeFrames } from "../data/well-frames.js";
import { scaleParts, scaleWords } from "../draw/colour-scale.js";
import { SharedView } from "../draw/shared-view.js";
import { fill, h } from "../ui/dom.js";
import { saveStrings } from "./string-file.js";

/**
 * A string at rest: `statics` has the columns of the table, `heading` is empty if there is one string, and `colour` that of the string
 * where it stands for no values.
 * @typedef {{statics: any, string: import("../data/string-parts.js").DrillString, heading: string, colour?: string}} RestingString
 */

/** @typedef {(number | null)[]} NodeValues */

export class WellPictures {
  #strings;
  #view;
  #scenes;
  #scale = h("div", { class: "scale" });
  #reading = h("p", { class: "small", role: "status", "aria-label": "The place that the mouse is at" });
  /** @type {import("../draw/colour-scale.js").ScaleWords | null} */
  #words = null;
  /** Values of the shown quantity at the nodes of each string. @type {{name: string, values: (NodeValues | null)[]} | null} */
  #coloured = null;

  /**
   * @param {RestingString[]} strings at least one
   * @param {{query: URLSearchParams, keep: (changes: Record<string, string | null>) => void, signal: AbortSignal}} link
   */
  constructor(strings, link) {
    this.#strings = strings.map((one) => ({
      ...one,
      frames: nodeFrames(one.statics),
      kinds: kindsOf(partsOf(one.string), one.statics.measured_depth),
    }));
    this.#view = new SharedView(this.#strings[0].frames.axis, link);
    this.#scenes = strings.map(({ heading }) =>
      this.#view.scene(
        `The string at rest in its hole${heading && `, ${heading}`}; arrow keys turn it, + and - change its size`,
      ),
    );
    const figures = this.#scenes.map((scene, order) => {
      scene.onNode((node) => this.#read(order, node));
      const { heading, colour } = strings[order];
      const mark = h("span", { style: `color:${colour}`, "aria-hidden": "true" }, "━ ");
      return h("figure", {}, heading && h("h2", {}, colour && mark, heading), scene.element);
    });
    this.element = h(
      "div",
      {},
      h("div", { class: strings.length > 1 ? "half" : "" }, figures),
      this.#reading,
      this.#scale,
    );
  }

  /** Buttons for viewpoints and files. */
  buttons() {
    const save = (/** @type {"png" | "svg"} */ format) => () =>
      saveStrings(
        "well",
        format,
        this.#scenes.map((scene, order) => ({ scene, heading: this.#strings[order].heading })),
        this.#words && { time: "", ...this.#words },
      );
    return [
      this.#view.buttons(),
      h("button", { onclick: save("png"), "aria-label": "Save the well as PNG" }, "Save as PNG"),
      h("button", { onclick: save("svg"), "aria-label": "Save the well as SVG" }, "Save as SVG"),
    ];
  }

  /**
   * @param {number} factor by which the distance from the axis is multiplied
   * @param {{name: string, values: (NodeValues | null)[]} | null} coloured values of a quantity at the nodes of each string; none if each
   *   string has a colour of its own
   */
  show(factor, coloured) {
    this.#coloured = coloured;
    const range = coloured && rangeOf(coloured.values);
    this.#words = coloured && range && scaleWords(coloured.name, label(coloured.name), range);
    fill(this.#scale, this.#words && scaleParts(this.#words));
    this.#reading.textContent = "";
    /** @type {import("../draw/string-scene.js").Scene[]} */
    const scenes = this.#strings.map(({ statics, frames, kinds, colour }, order) => ({
      frames,
      kinds,
      clearance: statics.clearance,
      depth: {
        values: shown("measured_depth", statics.measured_depth).map(Number),
        symbol: unit("measured_depth").symbol,
      },
      stretch: [0, statics.measured_depth.length - 1],
      factor,
      place: (/** @type {number} */ node) => [statics.u[node], statics.v[node]],
      rest: null,
      value: (/** @type {number} */ node) => coloured?.values[order]?.[node] ?? null,
      range: range ?? [0, 1],
      colour: coloured ? undefined : colour,
    }));
    scenes.forEach((scene, order) => this.#scenes[order].show({ ...scene, fits: scenes }));
  }

  /** Shows depth and value of a node. @param {number} order of the string @param {number | null} node */
  #read(order, node) {
    if (node === null) return;
    const { statics, heading } = this.#strings[order];
    const depth = `${say("measured_depth", statics.measured_depth[node])} measured depth`;
    const value = this.#coloured?.values[order]?.[node] ?? null;
    const words = this.#coloured && `${label(this.#coloured.name)} ${say(this.#coloured.name, value)}`;
    this.#reading.textContent = [heading, depth, words].filter(Boolean).join(" · ");
  }
}

/**
 * Least and largest of all values.
 * @param {(NodeValues | null)[]} values
 * @returns {[number, number] | null} null if there are none
 */
export function rangeOf(values) {
  let [least, largest] = [Infinity, -Infinity];
  for (const value of values.flatMap((one) => one ?? [])) {
    if (value === null) continue;
    [least, largest] = [Math.min(least, value), Math.max(largest, value)];
  }
  return least <= largest ? [least, largest] : null;
}
