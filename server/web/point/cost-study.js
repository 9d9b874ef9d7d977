// A cost study of a point in words: what leaving out each effect changes and saves, and the cheapest way to some accuracies.

import { effectCosts } from "../data/work-precision.js";
import { number } from "../data/units.js";
import { h } from "../ui/dom.js";

const MINUS = "\u2212";

/** A relative change in per cent, with its sign. @param {number | null} value */
function change(value) {
  if (value === null) return "–";
  const size = 100 * Math.abs(value);
  if (size < 0.01) return "below 0.01 %";
  return `${value > 0 ? "+" : MINUS}${number(size, 2)} %`;
}

/**
 * @param {any} report of the study
 * @returns {HTMLElement[]}
 */
export function studyParts(report) {
  const effects = effectCosts(report);
  const advice = report.recommendations.map((/** @type {any} */ one) => h("li", {}, one.text));
  return [
    ...report.warnings.map((/** @type {string} */ warning) => h("p", { class: "wrong" }, warning)),
    ...(advice.length
      ? [h("h3", {}, "Cheapest ways, by the study"), h("ul", { class: "small" }, advice)]
      : []),
    ...(effects.length ? [h("h3", {}, "Effects, each left out"), effectsTable(effects)] : []),
  ];
}

/** @param {ReturnType<typeof effectCosts>} effects */
function effectsTable(effects) {
  const heads = [
    "Orbit size changes by",
    "Its standard deviation by",
    "Torsional speed by",
    "Processor time saved",
  ].map((text) => h("th", { class: "number", scope: "col" }, text));
  const rows = effects.map(({ effect, orbitSize, deviation, torsionalSpeed, saved, failure }) => {
    const cells = [orbitSize, deviation, torsionalSpeed, saved].map((value) =>
      h("td", { class: "number" }, change(value)),
    );
    const name = h("th", { scope: "row" }, effect.replaceAll("_", " "));
    return failure
      ? h("tr", {}, name, h("td", { colspan: 4, class: "wrong" }, failure))
      : h("tr", {}, name, cells);
  });
  return h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": "Effects, each left out" },
    h(
      "table",
      {},
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Without"), heads)),
      h("tbody", {}, rows),
    ),
  );
}
