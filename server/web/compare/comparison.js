// Up to six points that are compared: each view draws the points that have the data it needs, and reports the data that the others lack.

import { Problem } from "../data/api.js";
import { say } from "../data/units.js";

/** @typedef {{number: number, id: string, ordinal: number, path: string, detail: any, name: string, colour: string, dash: string}} Compared */

/**
 * Data and callbacks for a view of a comparison.
 * @typedef {object} Comparison
 * @property {Compared[]} points
 * @property {URLSearchParams} query
 * @property {string[]} profiles chosen quantities over depth
 * @property {Record<string, any>} node asks each point for its recorded node that is nearest to the chosen depth
 * @property {{from: number, to: number}} window [s]
 * @property {(changes: Record<string, string | null>) => void} keep keeps a choice in the link
 * @property {(point: Compared, name: string, query?: Record<string, any>) => Promise<any>} table
 * @property {import("../draw/time-cursor.js").TimeCursor} time at which views over time are read
 * @property {string[]} lacking sentences about what points lack, which a view adds to
 * @property {Map<number, string>} sources tables that points are drawn from, by their numbers, where a view has a choice
 * @property {string[]} says sentences of the caption, which a view adds to
 * @property {{depths: number[], read: (depth: number, points: any[]) => import("../ui/dom.js").Child[]}} [profiled] what a depth cursor reads of a
 *   view over depth, which sets it
 * @property {Map<number, string>} nodes which node of each point is shown, by the point's number
 * @property {AbortSignal} signal of the view, whose one picture stays while it is drawn anew
 * @property {AbortSignal} drawing the same, which ends as well when what is shown is asked for anew: of requests, and of what is made anew
 */

/**
 * Reason for a point without any result; empty if it has one.
 * @param {any} detail
 */
function withoutResult({ summary, state, error }) {
  if (summary) return "";
  if (error) return `it failed (${error.class}): ${error.reason}`;
  return state === "cancelled" ? "it was cancelled" : `it is ${state}, without results yet`;
}

/** Data that a view needs and a point lacks, in words. */
export class Lacking extends Error {}

/**
 * Reads data from each point that has them, and reports the data that the others lack.
 * @template T
 * @param {Comparison} comparison
 * @param {(point: Compared) => Promise<T>} read
 * @param {string} [part] of the view that is drawn without them, where that is not all
 * @returns {Promise<[Compared, T][]>}
 */
export async function each({ points, lacking, drawing }, read, part = "") {
  const found = await Promise.all(
    points.map(async (point) => {
      const nothing = withoutResult(point.detail);
      if (nothing) return { point, lacks: `Point ${point.number} is missing: ${nothing}.` };
      try {
        return { point, value: await read(point) };
      } catch (error) {
        if (error instanceof Lacking)
          return { point, lacks: `Point ${point.number} is missing: ${error.message}.` };
        if (drawing.aborted || !(error instanceof Problem) || error.status === 401) throw error;
        return {
          point,
          lacks: `Point ${point.number} is missing${part && ` from ${part}`}: ${error.errors[0]?.detail ?? error.message}.`,
        };
      }
    }),
  );
  const sentences = found.flatMap(({ lacks }) => lacks ?? []);
  lacking.push(...sentences.filter((sentence) => !lacking.includes(sentence)));
  return found.flatMap(({ point, value, lacks }) =>
    lacks ? [] : [/** @type {[Compared, T]} */ ([point, value])],
  );
}

/** @param {Comparison} comparison @param {Compared} point @param {number} node @param {number} depth [m] */
export function noteNode({ nodes }, point, node, depth) {
  nodes.set(point.number, `point ${point.number} node ${node} at ${say("measured_depth", depth)}`);
}
