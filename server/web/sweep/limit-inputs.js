// Inputs of the limits of an operating window: a tick, a slider and a number for each column.

import { servedLimit, sliderOf } from "../data/limits.js";
import { meaning, unit } from "../data/units.js";
import { fill, h } from "../ui/dom.js";

/** Digits of a number in an input. */
const DIGITS = 4;

/** @typedef {import("../data/limits.js").Limits} Limits */

export class LimitInputs {
  #changed;
  #label;
  /** Limits in force; null of one that is taken away. @type {Limits} */
  limits = new Map();
  element = h("fieldset", { class: "limits" }, h("legend", {}, "Limits"));

  /**
   * @param {(column: string) => string} label of a column
   * @param {() => void} changed called after each change
   */
  constructor(label, changed) {
    this.#label = label;
    this.#changed = changed;
  }

  /**
   * @param {Record<string, number>} defaults
   * @param {Limits} changes of the defaults
   */
  show(defaults, changes) {
    this.limits = new Map([...Object.entries(defaults), ...changes]);
    const rows = [...this.limits].flatMap(([column, limit]) => {
      const usual = defaults[column] ?? limit;
      return usual === null ? [] : [this.#row(column, usual)];
    });
    fill(this.element, h("legend", {}, "Limits"), rows);
  }

  /** @param {string} column @param {number} usual limit */
  #row(column, usual) {
    const { symbol, size } = unit(column);
    const words = this.#label(column);
    const name = symbol ? `${words} [${symbol}]` : words;
    const { min, max, step } = sliderOf(Number((usual / size).toPrecision(DIGITS)));
    const slider = h("input", { type: "range", min, max, step, "aria-label": `Slider: ${name}` });
    const number = h("input", { type: "number", min: 0, step: "any", "aria-label": name });
    const tick = h("input", { type: "checkbox", "aria-label": `Limit of ${words}` });
    const paint = () => {
      const limit = this.limits.get(column) ?? null;
      tick.checked = limit !== null;
      slider.disabled = number.disabled = limit === null;
      if (limit === null) return;
      const text = String(Number((limit / size).toPrecision(DIGITS)));
      if (document.activeElement !== number) number.value = text;
      slider.value = text;
    };
    const set = (/** @type {number | null} */ limit) => {
      number.setAttribute("aria-invalid", String(Number.isNaN(limit)));
      if (Number.isNaN(limit)) return;
      this.limits.set(column, limit);
      paint();
      this.#changed();
    };
    slider.addEventListener("input", () => set(servedLimit(Number(slider.value), size)));
    number.addEventListener("input", () => set(servedLimit(Number(number.value), size)));
    let last = usual;
    tick.addEventListener("change", () => {
      last = this.limits.get(column) ?? last;
      set(tick.checked ? last : null);
    });
    paint();
    return h(
      "div",
      { class: "limit", title: meaning(column) },
      h("label", { class: "tick" }, tick, h("span", {}, name)),
      h("div", { class: "scale" }, slider, number),
    );
  }
}
