// Common to the views of a sweep's points.

import { LARGEST_ORBIT } from "../data/sweep-table.js";
import { attend } from "../ui/notices.js";
import { CLASS } from "./categories.js";

/**
 * Data and callbacks for a view of a sweep's points.
 * @typedef {object} Context
 * @property {any} sweep
 * @property {string[]} axes the swept parameters, as the table calls them
 * @property {Record<string, any>} spans how the request gives the values of each
 * @property {Record<string, string>} paths what the request calls each
 * @property {import("../data/sweep-table.js").SweepTable} table
 * @property {import("../data/biases.js").Biases} biases found by verifying a sample of the points
 * @property {import("../data/depths.js").Depths} depths of the nodes that columns are of
 * @property {URLSearchParams} query
 * @property {(changes: Record<string, string | null>) => void} keep keeps a choice in the link
 * @property {() => void} drawn says that what is shown is other columns than before
 * @property {(ordinal: number, column?: string) => void} open a point, at the node that a column is of
 * @property {(changed: any) => void} changed takes the sweep as an answer shows it
 * @property {AbortSignal} signal
 */

/**
 * A view of a sweep's points: its element, how it is drawn anew when there are further results, the columns that it shows, and those
 * of other sweeps; or else the lines that get what it shows.
 * @typedef {{element: HTMLElement, draw: () => Promise<void>, fields: () => string[], others?: () => import("./snippets.js").Shown[], lines?: () => import("../ui/snippets.js").Lines}} Part
 */

/**
 * The first drawing waits for its place in the page, which the view takes when it is complete; so it is not waited for.
 * @param {() => Promise<void>} redraw
 * @param {Context} context
 */
export function undelayed(redraw, context) {
  let isFirst = true;
  return async () => {
    const work = redraw();
    if (!isFirst) return work;
    isFirst = false;
    attend(work, context.signal);
  };
}

/** The result that an engineer asks for first. @param {string[]} results */
export function preferred(results) {
  return (
    results.find((name) => name === LARGEST_ORBIT) ??
    results.find((name) => name.startsWith("orbit_radius_rms")) ??
    results.find((name) => name === "friction_coefficient_max") ??
    results.find((name) => !["state", CLASS, "error_time", "error_node"].includes(name)) ??
    "state"
  );
}
