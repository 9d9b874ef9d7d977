// Search for what a picture shows at a place: the nearest point of a line, a cell, a bar, or the points of all lines at one value.

import { barAt } from "./bars.js";

/** Greatest distance from the mouse of a point of a line, of a dot, and of a mark over cells [pixels]. */
const [NEAR, NEAR_DOT, NEAR_MARK] = [20, 8, 10];

/** @typedef {import("./marks.js").Places} Places */
/** @typedef {import("./layout.js").Panel} Panel */
/**
 * A trace as it is drawn in a panel: places of its points, or ends of its cells, or its bars.
 * @typedef {{trace: any, panel: Panel, x: import("./axis.js").Axis, y: import("./axis.js").Axis, places?: Places, across?: ArrayLike<number>, up?: ArrayLike<number>, bars?: import("./bars.js").Bar[]}} Drawn
 */
/**
 * A point that is read: its trace, its row there (and column in a grid), its values, its key for clicks, and its place [pixels].
 * @typedef {{trace: any, row: number, column: number, x: any, y: any, z: any, customdata: any, at: {x: number, y: number}}} Reading
 */

/**
 * The row of places that is nearest to a place; `null` if none is near.
 * @param {Places} places
 * @param {number} px
 * @param {number} py
 * @param {number} most distance [pixels]
 * @returns {{row: number, distance: number} | null}
 */
export function nearestPlace({ x, y }, px, py, most) {
  let [row, least] = [-1, most ** 2];
  for (let at = 0; at < x.length; at += 1) {
    const [across, down] = [x[at] - px, y[at] - py];
    const square = across * across + down * down;
    if (square <= least) [row, least] = [at, square];
  }
  return row < 0 ? null : { row, distance: Math.sqrt(least) };
}

/**
 * The row whose place along one direction is nearest to a pixel; the last of equals, which is drawn above the others.
 * @param {ArrayLike<number>} along
 * @param {ArrayLike<number>} aside gaps here are left out
 * @param {number} pixel
 * @returns {number} -1 without any
 */
export function nearestAlong(along, aside, pixel) {
  let [row, least] = [-1, Infinity];
  for (let at = 0; at < along.length; at += 1) {
    const apart = Math.abs(along[at] - pixel);
    if (apart <= least && !Number.isNaN(aside[at])) [row, least] = [at, apart];
  }
  return row;
}

/**
 * Number of the cell between whose ends a pixel lies.
 * @param {ArrayLike<number>} edges
 * @param {number} pixel
 * @returns {number} -1 outside
 */
export function cellOf(edges, pixel) {
  for (let cell = 0; cell + 1 < edges.length; cell += 1) {
    const [one, other] = [edges[cell], edges[cell + 1]];
    if (pixel >= Math.min(one, other) && pixel < Math.max(one, other)) return cell;
  }
  return -1;
}

/**
 * The one point next to a place in a panel.
 * @param {Drawn[]} drawn traces of the panel
 * @param {number} px
 * @param {number} py
 * @returns {Reading | null}
 */
export function closest(drawn, px, py) {
  const isOverCells = drawn.some(({ across }) => across);
  /** @type {{reading: () => Reading, distance: number} | null} */
  let best = null;
  for (const one of drawn) {
    if (!one.places || one.trace.isSilent) continue;
    const { trace, places } = one;
    const most = trace.type === "dots" ? NEAR_DOT : isOverCells ? NEAR_MARK : NEAR;
    const found = nearestPlace(places, px, py, best ? Math.min(most, best.distance) : most);
    if (found) best = { distance: found.distance, reading: () => pointOf(one, found.row) };
  }
  if (best) return best.reading();
  for (const one of drawn.toReversed()) {
    const bar = one.bars && barAt(one.bars, px, py);
    if (bar) return pointOf(one, bar.row, { x: bar.x + bar.width, y: bar.y + bar.height });
    const cell = one.across && cellTold(one, px, py);
    if (cell) return cell;
  }
  return null;
}

/** The cell at a place. @param {Drawn} drawn @param {number} px @param {number} py @returns {Reading | null} */
function cellTold({ trace, x, y, across = [], up = [] }, px, py) {
  const [column, row] = [cellOf(across, px), cellOf(up, py)];
  const z = row < 0 || column < 0 ? null : trace.z[row][column];
  if (z === null || z === undefined) {
    const isTold = row >= 0 && column >= 0 && trace.hoverongaps && trace.text?.[row]?.[column];
    if (!isTold) return null;
  }
  const middle = (/** @type {ArrayLike<number>} */ edges, /** @type {number} */ cell) =>
    (edges[cell] + edges[cell + 1]) / 2;
  const at = { x: middle(across, column), y: middle(up, row) };
  return {
    trace,
    row,
    column,
    x: valueOf(trace.x, column, trace.z[0].length, x, at.x),
    y: valueOf(trace.y, row, trace.z.length, y, at.y),
    z,
    customdata: trace.customdata?.[row]?.[column],
    at,
  };
}

/** Value of a cell: as it is given, or in the middle between its ends. @param {ArrayLike<any>} values @param {number} cell @param {number} cells @param {import("./axis.js").Axis} axis @param {number} pixel */
function valueOf(values, cell, cells, axis, pixel) {
  return values.length === cells ? values[cell] : axis.toValue(pixel);
}

/**
 * The points of all lines of some panels that are nearest to a place along one direction.
 * @param {Drawn[]} drawn
 * @param {"x" | "y"} direction
 * @param {number} pixel along it
 * @returns {Reading[]}
 */
export function alongside(drawn, direction, pixel) {
  return drawn.flatMap((one) => {
    if (!one.places || one.trace.isSilent) return [];
    const { x, y } = one.places;
    const row = direction === "x" ? nearestAlong(x, y, pixel) : nearestAlong(y, x, pixel);
    return row < 0 ? [] : [pointOf(one, row)];
  });
}

/** @param {Drawn} drawn @param {number} row @param {{x: number, y: number}} [at] @returns {Reading} */
function pointOf({ trace, places }, row, at) {
  return {
    trace,
    row,
    column: 0,
    x: trace.x[row],
    y: trace.y[row],
    z: null,
    customdata: trace.customdata?.[row],
    at: at ?? { x: places?.x[row] ?? NaN, y: places?.y[row] ?? NaN },
  };
}
