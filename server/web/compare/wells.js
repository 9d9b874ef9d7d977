// Compared wells in space, each in the colour of its point or all by a quantity on one scale.

import { label, say, shown, title } from "../data/units.js";
import { colourBar, draw, lineScale } from "../draw/plots.js";
import { QUANTITIES, tableOf } from "../point/profiles.js";
import { displaced, exaggeration, onNodes, saysExaggeration, spaceLayout } from "../point/well.js";
import { each } from "./comparison.js";

/** Factor by which a string's distance from the axis of its hole is multiplied, unless the link has another one. */
const EXAGGERATION = 100;
/** Part of a well's length by which coloured wells are drawn aside of each other. */
const APART = 0.12;

/** @typedef {import("./comparison.js").Comparison} Comparison */
/** @typedef {import("./comparison.js").Compared} Compared */

/** The quantity that colours wells; undefined if each has the colour of its point. @param {URLSearchParams} query */
export function wellColour(query) {
  return QUANTITIES.find(([name]) => name === query.get("colour"))?.[0];
}

/** Height of the camera over wells that are aside of each other, in sizes of the picture. */
const RAISED = 0.9;

/** Factor by which the distance from the axis of the hole is multiplied. @param {URLSearchParams} query */
export function wellFactor(query) {
  return exaggeration(query, EXAGGERATION);
}

/** @param {HTMLElement} place @param {Comparison} comparison */
export async function drawWells(place, comparison) {
  const colour = wellColour(comparison.query);
  const factor = wellFactor(comparison.query);
  comparison.says.push(saysExaggeration("The strings at rest; their", factor));
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
  // One scale for all.
  const finite = colour
    ? found.flatMap(([, { values }]) => shown(colour, values ?? []).filter((value) => value !== null))
    : [];
  const scale = {
    colorscale: lineScale(),
    cmin: finite.reduce((a, b) => Math.min(a, b), Infinity),
    cmax: finite.reduce((a, b) => Math.max(a, b), -Infinity),
  };
  const barOf = found.find(([, { values }]) => values)?.[0];
  const aside = colour && found.length > 1 ? asideOf(found[0][1].statics) : null;
  if (aside) comparison.says.push("Wells are drawn aside of each other, so that each is seen.");
  const traces = found.map(([point, { statics, values }], order) => {
    const shift = { north: order * (aside?.north ?? 0), east: order * (aside?.east ?? 0) };
    const bar = colour && point === barOf ? { colorbar: colourBar(title(colour)), showscale: true } : {};
    const line =
      colour && values
        ? { color: shown(colour, values), ...scale, width: 9, ...bar }
        : { color: point.colour, width: 5 };
    return {
      type: "scatter3d",
      ...toldBy(point, statics, colour, values),
      name: point.name,
      ...pathOf(statics, shift, factor),
      line,
    };
  });
  const { north = [0], east = [0] } = found[0]?.[1].statics ?? {};
  // Wells aside of each other would cover each other in a section.
  const layout = spaceLayout({ north, east }, aside ? RAISED : undefined);
  return draw(place, traces, layout, comparison.signal);
}

/**
 * Shift from one well to the next, horizontally and across: most often all points have the same well.
 * @param {any} statics
 */
function asideOf({ north, east, measured_depth }) {
  const last = north.length - 1;
  const [along, across] = [north[last] - north[0], east[last] - east[0]];
  const apart = (APART * (measured_depth[last] - measured_depth[0])) / (Math.hypot(along, across) || 1);
  return Math.hypot(along, across)
    ? { north: -across * apart, east: along * apart }
    : { north: 0, east: APART * measured_depth[last] };
}

/** Coordinates of the string in its shifted well. @param {any} statics @param {{north: number, east: number}} shift @param {number} factor */
function pathOf(statics, shift, factor) {
  const shifted = (/** @type {number[]} */ path, /** @type {number} */ by) => path.map((value) => value + by);
  const axis = {
    north: shifted(statics.north, shift.north),
    east: shifted(statics.east, shift.east),
    down: statics.true_vertical_depth,
  };
  const path = displaced(statics, axis, factor);
  return {
    x: shown("east", path.east),
    y: shown("north", path.north),
    z: shown("true_vertical_depth", path.down),
  };
}

/**
 * Names of a well: of the legend, or a number at its end where colours stand for values.
 * @param {Compared} point
 * @param {any} statics
 * @param {string | undefined} colour
 * @param {(number | null)[] | null} values
 */
function toldBy(point, statics, colour, values) {
  if (!colour) return { mode: "lines", hoverinfo: "name", showlegend: true };
  const last = statics.measured_depth.length - 1;
  const text = statics.measured_depth.map((/** @type {number} */ _, /** @type {number} */ index) =>
    index === last ? `point ${point.number}` : "",
  );
  const hovertext = values?.map(
    (value, index) =>
      `${point.name}<br>${say("measured_depth", statics.measured_depth[index])} measured depth<br>${label(colour)} ${say(colour, value)}`,
  );
  return { mode: "lines+text", text, hovertext, hoverinfo: "text", showlegend: false };
}
