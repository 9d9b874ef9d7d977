// Points of a sweep that are ticked or chosen to be compared, as the link holds them.

import { nodeOfColumn } from "../data/units.js";
import { h } from "../ui/dom.js";
import { MOST } from "../ui/last-comparison.js";
import { link } from "../ui/router.js";

/**
 * Ordinals that a link ticks, each once.
 * @param {string} text such as `3,12`
 */
export function tickedIn(text) {
  const ordinals = text.split(",").map(Number);
  return [...new Set(ordinals)].filter((ordinal) => Number.isInteger(ordinal) && ordinal > 0).slice(0, MOST);
}

/**
 * Link to the comparison of ticked points; a button that is disabled if there are none.
 * @param {string} sweep
 * @param {number[]} ticked ordinals
 * @param {string} column whose node is compared
 */
export function comparePart(sweep, ticked, column) {
  if (!ticked.length) return h("button", { disabled: true, title: "Tick the points to compare" }, "Compare");
  const points = ticked.map((ordinal) => `${sweep}:${ordinal}`).join(",");
  const full = ticked.length >= MOST ? ` (at most ${MOST})` : "";
  return h(
    "a",
    { class: "button", href: link(["compare"], { points, view: "profiles", node: nodeOfColumn(column) }) },
    `Compare ${ticked.length} ${ticked.length === 1 ? "point" : "points"}${full}`,
  );
}
