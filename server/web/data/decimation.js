// Fewer values that stand for many, and the ranges of values that scales of colours cover.

/** @typedef {import("./snapshots.js").Frames} Frames */

/** Part of the forces that touch, from the smallest on, that the scale of colours covers: stabilizers would dwarf all others. */
const COVERED_FORCES = 0.9;
/** Forces from which that part is estimated. */
const SAMPLED_FORCES = 50_000;
/** Part of other values that a scale of colours covers. */
const COVERED = 0.995;
/** Values from which that part is estimated. */
const SAMPLED = 20_000;

/**
 * The largest value of each node in every few snapshots.
 * @param {Frames} frames
 * @param {string} name of the quantity
 * @param {number} every snapshots that become one
 * @returns {{time: number[], rows: number[][]}} times in the middle of the snapshots, and a row for each node
 */
export function maxima({ nodes, count, first, interval, columns }, name, every) {
  const values = columns[name];
  const length = Math.ceil(count / every);
  const rows = Array.from({ length: nodes }, (_, node) =>
    Array.from({ length }, (__, column) => {
      let most = -Infinity;
      const end = Math.min(count, (column + 1) * every);
      for (let frame = column * every; frame < end; frame += 1)
        most = Math.max(most, values[frame * nodes + node]);
      return most;
    }),
  );
  const time = Array.from(
    { length },
    (_, column) => first + (column * every + (Math.min(every, count - column * every) - 1) / 2) * interval,
  );
  return { time, rows };
}

/**
 * Force at the end of the scale of colours [N].
 * @param {Float32Array} forces
 */
export function largestShown(forces) {
  const every = Math.max(1, Math.floor(forces.length / SAMPLED_FORCES));
  const touching = forces.filter((value, index) => index % every === 0 && value > 0).sort();
  return touching.length ? touching[Math.round(COVERED_FORCES * (touching.length - 1))] : 1;
}

/**
 * Every so many of a quantity's values, about twenty thousand in all.
 * @param {Float32Array} values
 */
export function sampled(values) {
  const every = Math.max(1, Math.floor(values.length / SAMPLED));
  return Array.from({ length: Math.ceil(values.length / every) }, (_, index) => values[index * every]);
}

/** Range of all values but the outermost. @param {number[]} values @returns {[number, number]} */
export function covered(values) {
  const inOrder = values.filter(Number.isFinite).sort((a, b) => a - b);
  if (!inOrder.length) return [0, 1];
  const at = (/** @type {number} */ part) => inOrder[Math.round(part * (inOrder.length - 1))];
  return [at(1 - COVERED), at(COVERED)];
}
