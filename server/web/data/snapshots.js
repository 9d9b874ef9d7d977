// The snapshots of a point: how many there are, and their values by time and node.

import { Problem } from "./api.js";
import { ALONG, TIMES } from "./motion-requests.js";
import { getArrays } from "./npz.js";

/** Nodes of all snapshots together that the page takes at once; of more every k-th snapshot. */
const TAKEN = 450_000;
/** Motion that is requested first [s], little enough for a slow network, and the growth of each further part. */
const FIRST_S = 0.25,
  GROWTH = 4;
/** Part of an interval within which a time counts as the one of a snapshot, as in the service. */
const NEAR = 1e-2;

/** Number and times of all snapshots. @typedef {{nodes: number, count: number, first: number, interval: number}} Times */
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
 * Names and times of a point's snapshots.
 * @param {(name: string, query: Record<string, any>) => Promise<any>} table a table of the point's result
 */
export async function snapshotTimes(table) {
  const { columns, attributes } = await table("snapshots", TIMES);
  const { snapshots: count, first, interval } = attributes;
  return { names: Object.keys(columns), count, first, interval: interval / Math.max(1, count) };
}

/**
 * Describes a point's snapshots; `null` if it has none.
 * @param {Source} source
 * @returns {Promise<{names: string[], nodes: number, count: number, first: number, interval: number} | null>}
 */
export async function snapshotsOf(source) {
  if (!source.point.scenario.recording.snapshots) return null;
  try {
    const [times, along] = await Promise.all([
      snapshotTimes(source.table),
      source.table("statics", { fields: ALONG }),
    ]);
    return { ...times, nodes: along.columns.node.length };
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
    max_frames: Math.max(1, Math.floor(taken / nodes)),
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
 * Windows in which the snapshots of a window are requested one after the other: a short one first, each further one longer. Together they
 * have the same snapshots as one request for at most `most` of them.
 * @param {Times} times
 * @param {{from: number, to: number}} window [s]
 * @param {number} most
 * @returns {{from: number, to: number, frames: number}[]} with the number of snapshots of each; one for all if there are few
 */
export function windowsOf({ count, first, interval }, window, most) {
  const below = (/** @type {number} */ end) =>
    Math.max(0, Math.min(count, Math.ceil((end - first) / interval - NEAR)));
  const start = below(window.from);
  const there = Math.max(0, below(window.to) - start);
  const stride = Math.max(1, Math.ceil(there / most));
  const kept = Math.ceil(there / stride);
  const time = (/** @type {number} */ frame) => first + (start + frame * stride) * interval;
  const ends = [];
  for (let size = Math.max(2, Math.ceil(FIRST_S / (interval * stride)) + 1), end = size; end < kept / 2;) {
    ends.push(end);
    size *= GROWTH;
    end += size;
  }
  if (!ends.length) return [{ ...window, frames: kept }];
  // The service thins a part evenly: a last one that is no whole multiple of the stride would be thinned by less.
  if (there % stride) ends.push(kept - 1);
  const begins = [0, ...ends];
  return begins.map((begin, part) => {
    const end = begins[part + 1] ?? kept;
    return { from: time(begin), to: part + 1 < begins.length ? time(end) : window.to, frames: end - begin };
  });
}

/**
 * Some quantities of the snapshots in a window, shown as they arrive.
 * @param {Source} source
 * @param {string[]} names
 * @param {{from: number, to: number}} window [s]
 * @param {Times} times of all snapshots
 * @param {(frames: Frames, isWhole: boolean) => void} onPart called with all snapshots from the first on that are there
 */
export async function streamFrames(source, names, window, times, onPart) {
  const { nodes } = times;
  const windows = windowsOf(times, window, Math.max(2, Math.floor(TAKEN / nodes)));
  if (windows.length === 1) return onPart(await frames(source, names, window, nodes), true);
  const request = (/** @type {{from: number, to: number, frames: number}} */ { from, to, frames: most }) =>
    frames(source, names, { from, to }, nodes, most * nodes);
  let next = request(windows[0]);
  /** @type {Frames | null} */
  let all = null;
  for (const [part] of windows.entries()) {
    const arrived = await next;
    // The next part is under way while this one is shown.
    if (part + 1 < windows.length) {
      next = request(windows[part + 1]);
      // A failure is met by the next turn.
      next.catch(() => {});
    }
    all = all ? appended(all, arrived) : arrived;
    onPart(all, part + 1 === windows.length);
  }
}

/**
 * Snapshots of consecutive windows together.
 * @param {Frames} before
 * @param {Frames} after
 * @returns {Frames}
 */
export function appended(before, after) {
  const columns = Object.fromEntries(
    Object.entries(after.columns).map(([name, values]) => {
      const joined = new Float32Array(before.columns[name].length + values.length);
      joined.set(before.columns[name]);
      joined.set(values, before.columns[name].length);
      return [name, joined];
    }),
  );
  return { ...before, count: before.count + after.count, columns };
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
