// The snapshots of a point: how many there are, and their values by time and node.

import { Problem } from "./api.js";
import { getArrays } from "./npz.js";

/** Nodes of all snapshots together that the page takes at once; of more every k-th snapshot. */
const TAKEN = 450_000;
/**
 * A point with its tables.
 * @typedef {object} Source
 * @property {any} point
 * @property {string} path of the point, from `/v1`
 * @property {(name: string, query?: Record<string, any>) => Promise<any>} table a table of the point's result
 * @property {AbortSignal} signal
 */

/**
 * Values of one quantity: snapshot after snapshot, in each node after node from the top.
 * @typedef {{nodes: number, count: number, first: number, interval: number, columns: Record<string, Float32Array>}} Frames
 */

/**
 * Describes a point's snapshots; `null` if it has none.
 * @param {Source} source
 * @returns {Promise<{names: string[], nodes: number, count: number, first: number, interval: number} | null>}
 */
export async function snapshotsOf(source) {
  if (!source.point.scenario.recording.snapshots) return null;
  try {
    const { columns, attributes } = await source.table("snapshots", { max_frames: 1 });
    // One was served, so that the interval is that of all.
    const { snapshots: count, nodes, first, interval } = attributes;
    return { names: Object.keys(columns), nodes, count, first, interval: interval / Math.max(1, count) };
  } catch (error) {
    if (error instanceof Problem && error.status === 404) return null;
    throw error;
  }
}

/**
 * Some quantities of the snapshots in a window.
 * @param {Source} source
 * @param {string[]} names
 * @param {{from: number, to: number}} window [s]
 * @param {number} nodes of the string
 * @param {number} [taken] nodes of all snapshots together
 * @returns {Promise<Frames>}
 */
export async function frames(source, names, window, nodes, taken = TAKEN) {
  const query = {
    from: window.from,
    to: window.to,
    fields: names.join(","),
    max_frames: Math.max(2, Math.floor(taken / nodes)),
  };
  const { columns, attributes } = await getArrays(`${source.path}/snapshots`, query, source.signal);
  return {
    nodes,
    count: columns[names[0]].length / nodes,
    first: attributes.first,
    interval: attributes.interval,
    columns,
  };
}

/**
 * A value of a node between two snapshots; beyond the first and the last they are continued.
 * @param {Frames} frames
 * @param {string} name of the quantity
 * @param {number} node from 0 at the top
 * @param {number} time [s]
 */
export function valueAt({ nodes, count, first, interval, columns }, name, node, time) {
  const values = columns[name];
  const at = Math.max(0, Math.min(count - 1, (time - first) / interval));
  const frame = Math.min(Math.floor(at), count - 2);
  const [a, b] = [values[frame * nodes + node], values[(frame + 1) * nodes + node]];
  return a + (b - a) * (at - frame);
}
