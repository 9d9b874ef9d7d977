// Lines of parallel coordinates: places of values along axes, filters, and the line next to a place.

/** Greatest distance of a place from a line [pixels]. */
const NEAR = 6;
/** Part of an axis below which a filter is no range. */
const LEAST = 0.01;

/**
 * An axis in the unit in which it is shown: its values by lines, and its filters, whose ends may be infinite.
 * @typedef {{name: string, title: string, values: number[], ranges: number[][]}} Dimension
 */

/** Least and largest value of an axis. @param {{values: number[]}} dimension @returns {[number, number]} */
export function endsOf({ values }) {
  return [
    values.reduce((a, b) => Math.min(a, b), Infinity),
    values.reduce((a, b) => Math.max(a, b), -Infinity),
  ];
}

/** Ends of an axis as it is drawn: one of a single value reaches a little beyond it. @param {{values: number[]}} dimension @returns {[number, number]} */
export function drawnEnds(dimension) {
  const [least, largest] = endsOf(dimension);
  const spare = largest > least ? 0 : Math.abs(least) / 10 || 1;
  return [least - spare, largest + spare];
}

/** Part of an axis from its lower end. @param {number} value @param {[number, number]} ends */
export function partOf(value, [least, largest]) {
  return (value - least) / (largest - least);
}

/** @param {Dimension} dimension @param {number} line */
export function isKept({ values, ranges }, line) {
  return !ranges.length || ranges.some(([from, to]) => values[line] >= from && values[line] <= to);
}

/** Lines that pass the filters of all axes, in their order. @param {Dimension[]} dimensions @returns {number[]} */
export function keptLines(dimensions) {
  const filters = dimensions.filter(({ ranges }) => ranges.length);
  const lines = [...dimensions[0].values.keys()];
  return filters.length
    ? lines.filter((line) => filters.every((dimension) => isKept(dimension, line)))
    : lines;
}

/**
 * Filters without overlaps. Ends at or beyond those of the values are infinite; a range of all values, or of nothing, is none.
 * @param {number[][]} ranges
 * @param {[number, number]} ends of the values
 * @returns {number[][]} rising
 */
export function joined(ranges, [least, largest]) {
  const smallest = LEAST * (largest - least);
  /** @type {number[][]} */
  const result = [];
  for (const [from, to] of ranges.toSorted((a, b) => a[0] - b[0])) {
    const last = result[result.length - 1];
    if (last && from <= last[1]) last[1] = Math.max(last[1], to);
    else if (to - from >= smallest) result.push([from, to]);
  }
  return result
    .map(([from, to]) => [from <= least ? -Infinity : from, to >= largest ? Infinity : to])
    .filter((range) => range.some(Number.isFinite));
}

/**
 * The line next to a place between two axes.
 * @param {{x: number, heights: ArrayLike<number>}[]} axes from the left, each with its place across and the heights of all lines there [pixels]
 * @param {number[]} lines among which it is
 * @param {number} x @param {number} y [pixels]
 * @returns {number | null} null if none is near
 */
export function nearestLine(axes, lines, x, y) {
  const right = axes.findIndex((axis) => axis.x >= x);
  if (right < 1) return null;
  const [before, after] = [axes[right - 1], axes[right]];
  const part = (x - before.x) / (after.x - before.x);
  let [best, least] = [/** @type {number | null} */ (null), NEAR];
  for (const line of lines) {
    const height = before.heights[line] + part * (after.heights[line] - before.heights[line]);
    const apart = Math.abs(height - y);
    if (apart < least) [best, least] = [line, apart];
  }
  return best;
}
