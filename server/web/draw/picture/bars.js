// Bars over words, lying or standing; those of one word stand next to each other.

/** Part of a word's place that its bars fill. */
const FILLED = 0.8;

/** @typedef {import("./svg-pen.js").Pen} Pen */
/** @typedef {import("./axis.js").Axis} Axis */
/** A bar: its corner and its size [pixels], the latter negative where it goes left or up. @typedef {{row: number, x: number, y: number, width: number, height: number}} Bar */

/**
 * Bars of a trace.
 * @param {any} trace
 * @param {any[]} all traces of bars on the same axes
 * @param {Axis} x
 * @param {Axis} y
 * @returns {Bar[]}
 */
export function barsOf(trace, all, x, y) {
  const isLying = trace.orientation === "h";
  const [words, lengths] = isLying ? [y, x] : [x, y];
  const [named, measured] = isLying ? ["y", "x"] : ["x", "y"];
  const step = words.scale * FILLED;
  return trace[named].flatMap((/** @type {string} */ word, /** @type {number} */ row) => {
    const value = trace[measured][row];
    if (typeof value !== "number") return [];
    const group = all.filter((other) => other[named].includes(word));
    const thick = step / group.length;
    const start =
      words.toPixel(word) +
      (isLying ? -1 : 1) * (group.indexOf(trace) - (group.length - 1) / 2) * thick -
      thick / 2;
    // A logarithmic axis has no zero: bars stand on its lower end.
    const [zero, end] = [
      lengths.toPixel(lengths.isLog ? Math.min(...lengths.range) : 0),
      lengths.toPixel(value),
    ];
    return isLying
      ? [{ row, x: zero, y: start, width: end - zero, height: thick }]
      : [{ row, x: start, y: zero, width: thick, height: end - zero }];
  });
}

/** Draws the bars of a trace. @param {Pen} pen @param {any} trace @param {Bar[]} bars */
export function drawBars(pen, trace, bars) {
  pen.fillStyle = trace.marker.color;
  for (const { x, y, width, height } of bars) pen.fillRect(x, y, width, height);
}

/** The bar at a place. @param {Bar[]} bars @param {number} px @param {number} py @returns {Bar | undefined} */
export function barAt(bars, px, py) {
  return bars.find(
    ({ x, y, width, height }) =>
      px >= Math.min(x, x + width) &&
      px <= Math.max(x, x + width) &&
      py >= Math.min(y, y + height) &&
      py <= Math.max(y, y + height),
  );
}
