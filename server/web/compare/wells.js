// Compared wells in space, each string in the colour of its point or all by a quantity on one scale.

import { label } from "../data/units.js";
import { onNodes } from "../data/well-frames.js";
import { QUANTITIES, tableOf } from "../point/profiles.js";
import { exaggeration, LEGEND, saysExaggeration } from "../point/well.js";
import { WellPictures } from "../point/well-pictures.js";
import { fill, h } from "../ui/dom.js";
import { each } from "./comparison.js";

/** Factor by which a string's distance from the axis of its hole is multiplied, unless the link has another one. */
const EXAGGERATION = 100;

/** @typedef {import("./comparison.js").Comparison} Comparison */

/** The quantity that colours strings; undefined if each has the colour of its point. @param {URLSearchParams} query */
export function wellColour(query) {
  return QUANTITIES.find(([name]) => name === query.get("colour"))?.[0];
}

/** Factor by which the distance from the axis of the hole is multiplied. @param {URLSearchParams} query */
export function wellFactor(query) {
  return exaggeration(query, EXAGGERATION);
}

/** @param {HTMLElement} place @param {Comparison} comparison */
export async function drawWells(place, comparison) {
  const { query, keep, drawing } = comparison;
  const colour = wellColour(query);
  const factor = wellFactor(query);
  const found = await each(comparison, async (point) => {
    const names = ["statics", ...(colour && tableOf(colour) !== "statics" ? [tableOf(colour)] : [])];
    const [{ columns: statics }, table] = await Promise.all(
      names.map((name) => comparison.table(point, name)),
    );
    const { columns } = table ?? { columns: statics };
    if (colour && !columns[colour]) comparison.lacking.push(`Point ${point.number} has no ${label(colour)}.`);
    return {
      statics,
      values: colour && columns[colour] ? onNodes(columns, colour, statics.measured_depth.length) : null,
    };
  });
  if (!found.length) return fill(place);
  const strings = found.map(([point, { statics }]) => ({
    statics,
    string: point.detail.scenario.string,
    heading: point.name,
    colour: point.colour,
  }));
  const pictures = new WellPictures(strings, { query, keep, signal: drawing });
  pictures.show(factor, colour ? { name: colour, values: found.map(([, { values }]) => values) } : null);
  comparison.says.push(`${saysExaggeration("The strings at rest; their", factor)} ${LEGEND}`);
  fill(place, h("div", { class: "controls" }, pictures.buttons()), pictures.element);
}
