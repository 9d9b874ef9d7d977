// Points of a grid to which finer grids were added, as grids that lie on each other: in one grid of all values most cells would be empty.

/** Values this near to each other, relative to their size, are one. */
const SAME = 1e-9;

/**
 * A grid: its values, and which point is in each cell.
 * @typedef {{across: number[], up: number[], at: (number | undefined)[][]}} Layer
 */

/**
 * @param {number[]} xs of each point
 * @param {number[]} ys
 * @param {{x: any, y: any}[]} requests how the sweep's request, and each that added points, gives the values
 * @returns {Layer[]} in the order of the requests
 */
export function layered(xs, ys, requests) {
  const all = xs.map((_, point) => point);
  /** @type {Layer[]} */
  const layers = [];
  const drawn = new Set();
  for (const { x, y } of requests) {
    const [isX, isY] = [among(valuesOf(x)), among(valuesOf(y))];
    // Points that were there already are part of a finer grid as well.
    const points = all.filter((point) => isX(xs[point]) && isY(ys[point]));
    if (points.every((point) => drawn.has(point))) continue;
    layers.push(grid(points, xs, ys));
    for (const point of points) drawn.add(point);
  }
  const rest = all.filter((point) => !drawn.has(point));
  return rest.length || !layers.length ? [...layers, grid(rest, xs, ys)] : layers;
}

/** Half the size of a cell whose value is the only one, relative to that value. */
const ALONE = 0.05;

/**
 * Ends of cells: halfway between neighbours, by ratio on a logarithmic axis, and at the rim the outermost values themselves, beyond which
 * nothing was computed.
 * @param {number[]} values of a layer, in order
 * @param {number[]} all that there are, in order
 * @param {boolean} [isLog] whether the axis is logarithmic
 */
export function ends(values, all, isLog = false) {
  const middle = (/** @type {number} */ a, /** @type {number} */ b) =>
    isLog && a > 0 && b > 0 ? Math.sqrt(a * b) : (a + b) / 2;
  if (values.length > 1) {
    const between = values.slice(1).map((value, index) => middle(values[index], value));
    return [values[0], ...between, values[values.length - 1]];
  }
  const [value] = values;
  const half = ALONE * Math.abs(value) || 0.5;
  if (all.length < 2) return [value - half, value + half];
  const index = all.indexOf(value);
  return [middle(all[index - 1] ?? value, value), middle(value, all[index + 1] ?? value)];
}

/** @param {number[]} points @param {number[]} xs @param {number[]} ys @returns {Layer} */
function grid(points, xs, ys) {
  const sorted = (/** @type {number[]} */ values) => [...new Set(values)].sort((a, b) => a - b);
  const [across, up] = [sorted(points.map((point) => xs[point])), sorted(points.map((point) => ys[point]))];
  const [column, row] = [across, up].map((values) => new Map(values.map((value, index) => [value, index])));
  /** @type {(number | undefined)[][]} */
  const at = up.map(() => Array(across.length).fill(undefined));
  for (const point of points) at[row.get(ys[point]) ?? 0][column.get(xs[point]) ?? 0] = point;
  return { across, up, at };
}

/** The values of an axis of a request; none where it does not list them. @param {any} span @returns {number[]} */
function valuesOf(span) {
  if (span?.values) return span.values;
  if (!span?.count) return [];
  const { from, to, count, scale } = span;
  const part = (/** @type {number} */ index) => (count > 1 ? index / (count - 1) : 0);
  return Array.from({ length: count }, (_, index) =>
    scale === "log" ? from * (to / from) ** part(index) : from + (to - from) * part(index),
  );
}

/** @param {number[]} values @returns {(value: number) => boolean} whether a value is one of them */
function among(values) {
  const scale = Math.max(...values.map(Math.abs), 0) * SAME;
  const sorted = [...values].sort((a, b) => a - b);
  return (value) => {
    let [low, high] = [0, sorted.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (sorted[middle] < value - scale) low = middle + 1;
      else high = middle;
    }
    return low < sorted.length && sorted[low] <= value + scale;
  };
}
