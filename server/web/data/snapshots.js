// The snapshots of a point: how many there are, and their values by time and node.

import { Problem } from "./api.js";
import { h } from "../ui/dom.js";
import { getArrays } from "./npz.js";
import { link } from "../ui/router.js";

/** Nodes of all snapshots together that the page takes at once; of more every k-th snapshot. */
const TAKEN = 450_000;
/** The rate that is proposed [Hz]. */
const PROPOSED_HZ = 25;

/**
 * Values of one quantity: snapshot after snapshot, in each node after node from the top.
 * @typedef {{nodes: number, count: number, first: number, interval: number, columns: Record<string, Float32Array>}} Frames
 */

/**
 * What there is of snapshots; null where the point has none.
 * @param {import("../point/view.js").PointContext} context
 * @returns {Promise<{names: string[], nodes: number, count: number, first: number, interval: number} | null>}
 */
export async function snapshotsOf(context) {
  if (!context.point.scenario.recording.snapshots) return null;
  try {
    const { columns, attributes } = await context.table("snapshots", { max_frames: 1 });
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
 * @param {import("../point/view.js").PointContext} context
 * @param {string[]} names
 * @param {{from: number, to: number}} window [s]
 * @param {number} nodes of the string
 * @param {number} [taken] nodes of all snapshots together
 * @returns {Promise<Frames>}
 */
export async function frames(context, names, window, nodes, taken = TAKEN) {
  const query = { from: window.from, to: window.to, fields: names.join(","), max_frames: Math.max(2, Math.floor(taken / nodes)) };
  const { columns, attributes } = await getArrays(`${context.path}/snapshots`, query, context.signal);
  return { nodes, count: columns[names[0]].length / nodes, first: attributes.first, interval: attributes.interval, columns };
}

/**
 * What to add to a request where there are no snapshots.
 * @param {import("../point/view.js").PointContext} context
 */
export function withoutSnapshots({ point, path }) {
  const recorded = point.scenario.recording.rate_hz;
  const rate = Number((recorded / Math.max(1, Math.round(recorded / PROPOSED_HZ))).toFixed(6));
  const asked = JSON.stringify({ rate_hz: rate });
  const scenario = { ...point.scenario, recording: { ...point.scenario.recording, snapshots: { rate_hz: rate } } };
  const [, , sweep] = path.split("/").filter(Boolean);
  return h(
    "div",
    { class: "panel empty" },
    h("p", {}, "This point recorded no snapshots of the whole string: its motion and the map of its contacts over depth and time need them."),
    h("p", {}, "Add to the changes of a request: ", h("code", {}, `"recording.snapshots": ${asked}`), "; on the command line: ", h("code", {}, `--set recording.snapshots='${asked}'`), "."),
    h("p", {}, h("a", { class: "button", href: link(["new"], { request: JSON.stringify({ name: `Snapshots of ${sweep.slice(-8)}, point ${point.ordinal}`, scenario, axes: {} }) }) }, "Compute this point with snapshots")),
  );
}
