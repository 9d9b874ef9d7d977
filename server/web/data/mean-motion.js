// Mean positions of nodes over a window, and their motion about these.

/** Factors by which the motion about the mean position is multiplied. */
export const MAGNIFICATIONS = [1, 2, 5, 10, 20, 50, 100, 200];
/** Part of the widest clearance that the largest motion may fill. */
const FILLED = 0.4;

/** Mean u and v of each node, and the largest distance of a node from its mean [m]. @typedef {{u: Float64Array, v: Float64Array, reach: number}} Means */

/**
 * @param {import("./snapshots.js").Frames} frames with u and v
 * @returns {Means}
 */
export function meansOf({ nodes, count, columns: { u, v } }) {
  const mean = (/** @type {Float32Array} */ values) => {
    const sums = new Float64Array(nodes);
    for (let at = 0; at < nodes * count; at += 1) sums[at % nodes] += values[at];
    return sums.map((sum) => sum / count);
  };
  const means = { u: mean(u), v: mean(v) };
  let reach = 0;
  for (let at = 0; at < nodes * count; at += 1)
    reach = Math.max(reach, Math.hypot(u[at] - means.u[at % nodes], v[at] - means.v[at % nodes]));
  return { ...means, reach };
}

/**
 * Largest factor at which the motion fills no more than a part of the hole.
 * @param {number} reach of the motion [m]
 * @param {number[]} clearance of the nodes [m]
 */
export function suitedMagnification(reach, clearance) {
  const room = FILLED * Math.max(...clearance);
  return MAGNIFICATIONS.findLast((factor) => factor * reach <= room) ?? MAGNIFICATIONS[0];
}

/**
 * Place of a node with its motion about the mean multiplied.
 * @param {Means} means
 * @param {number} node
 * @param {[number, number]} place u and v [m]
 * @param {number} factor
 * @returns {[number, number]}
 */
export function magnified(means, node, [u, v], factor) {
  return [means.u[node] + factor * (u - means.u[node]), means.v[node] + factor * (v - means.v[node])];
}
