// Scale of the colours of a string: what they stand for, with the values at its ends.

import { shown, signed, unit } from "../data/units.js";
import { h } from "../ui/dom.js";
import { GRADIENT } from "./picture/colours.js";

/** @typedef {{text: string, least: string, largest: string}} ScaleWords */

/**
 * A scale in words, in the units shown.
 * @param {string} name of the quantity
 * @param {string} called its name on the page
 * @param {[number, number]} range
 * @returns {ScaleWords}
 */
export function scaleWords(name, called, range) {
  const { symbol } = unit(name);
  const [least, largest] = shown(name, range).map((value) =>
    signed(String(Number(Number(value).toPrecision(3)))),
  );
  return { text: `${called}${symbol ? ` [${symbol}]` : ""}`, least, largest };
}

/** @param {ScaleWords} words */
export function scaleParts({ text, least, largest }) {
  return [
    h("span", { class: "small" }, text),
    h("span", { class: "small number" }, least),
    h("span", { class: "gradient", style: `background:${GRADIENT}`, "aria-hidden": "true" }),
    h("span", { class: "small number" }, largest),
  ];
}
