// Common to the views of a point.

import { nodeInLink, unrecordedNode } from "../data/motion-requests.js";
import { say } from "../data/units.js";

/**
 * Data and callbacks for a view of a point.
 * @typedef {object} PointContext
 * @property {any} point
 * @property {string} path of the point, from `/v1`
 * @property {URLSearchParams} query
 * @property {(changes: Record<string, string | null>) => void} keep keeps a choice in the link
 * @property {(name: string) => string} bias text to show next to a number of the summary, if verifying the sweep found its bias
 * @property {(ordinal: number) => import("../data/accuracy.js").Measured | null} [measured] error of a point's orbit sizes, found by verifying the sweep; absent in comparisons
 * @property {number[]} [verified] ordinals of the sweep's verified points; absent in comparisons
 * @property {() => Promise<any>} diagnosis class, findings, and causes of spectral lines
 * @property {(name: string, query?: Record<string, any>) => Promise<any>} table a table of the point's result
 * @property {import("../draw/time-cursor.js").TimeCursor} time at which views over time are read
 * @property {() => void} drawn says that what is shown is of other requests than before
 * @property {AbortSignal} signal
 */

/**
 * A view of a point, and the requests behind what it shows; none where it shows nothing of the service's.
 * @typedef {{element: HTMLElement, draw: () => Promise<void>, request: () => PartRequest | null}} PointPart
 *
 * A table is a path from that of the point; that of the point itself is empty.
 * @typedef {{asked: {table: string, query?: Record<string, any>, isDocument?: boolean, name?: string}[], python: string}} PartRequest
 */

/**
 * Sentence about a node of the link that was not recorded; empty if it was.
 * @param {any} scenario
 * @param {URLSearchParams} query of the link
 */
export function sayUnrecorded(scenario, query) {
  const asked = unrecordedNode(scenario, query);
  if (!asked) return "";
  const words = (/** @type {string} */ name) => {
    const [, metres, above] = /^(.+)m(_above_bit)?$/.exec(name) ?? [];
    if (metres === undefined) return `node ${name}`;
    return above ? `${metres} m above the bit` : `at ${metres} m`;
  };
  const recorded = scenario.recording.nodes.map((/** @type {any} */ node) => words(nodeInLink(node)));
  return `This point did not record ${/^\d/.test(asked) ? words(asked) : asked}. It recorded ${recorded.join(", ")}: choose one of them.`;
}

/** Place for which a node is recorded, in words. @param {import("../data/motion-requests.js").RecordedNode} recorded */
export function sayPlace({ depth, above_bit }) {
  return above_bit === undefined
    ? say("measured_depth", depth)
    : `${say("measured_depth", above_bit)} above the bit`;
}

/** Choices that other views of the point, and other points, take over. */
const CARRIED = ["node", "from", "to", "time"];

/** @param {URLSearchParams} query of the link @returns {Record<string, string>} node, window and time, as far as the link has them */
export function carried(query) {
  return Object.fromEntries(
    CARRIED.flatMap((name) => (query.has(name) ? [[name, query.get(name) ?? ""]] : [])),
  );
}

/**
 * The requests of a part with their paths from `/v1`.
 * @param {string} path of the point
 * @param {PartRequest} request
 */
export function askedOf(path, { asked }) {
  return asked.map(({ table, name, ...rest }) => ({
    ...rest,
    path: table ? `${path}/${table}` : path,
    name: name ?? (table || "point"),
  }));
}
