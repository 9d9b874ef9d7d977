// Points of a comparison: loaded from the link, told from each other, with the depths of their recorded nodes.

import { get, Problem } from "../data/api.js";
import { depthOfRecorded, nodeInLink } from "../data/motion-requests.js";
import { sayParameters } from "../data/units.js";
import { DASHES, LINES } from "../draw/plots.js";

/** Changes of a scenario, at most, that tell points of the same parameters apart. */
const MOST_CHANGES = 3;
/** Depths that differ by less are one [m]. */
const SAME_DEPTH = 1e-3;

/** @typedef {import("./comparison.js").Compared} Compared */

/**
 * A point of the link, or the service's answer if it does not exist.
 * @param {string} key such as `SWEEP:3`
 * @param {number} order
 * @param {AbortSignal} signal
 * @returns {Promise<{point?: Compared, problem?: {key: string, text: string}}>}
 */
export async function pointOf(key, order, signal) {
  const [id, ordinal] = key.split(":");
  const path = `/v1/sweeps/${encodeURIComponent(id)}/points/${ordinal}`;
  try {
    const detail = await get(path, {}, signal);
    const number = order + 1;
    return {
      point: {
        number,
        id,
        ordinal: Number(ordinal),
        path,
        detail,
        name: String(number),
        colour: LINES[order],
        dash: DASHES[order],
      },
    };
  } catch (error) {
    if (!(error instanceof Problem) || error.status !== 404) throw error;
    return { problem: { key, text: `Point ${order + 1} of the link was not found: ${error.message}.` } };
  }
}

/**
 * The points, each told from the others by as few words as do: its parameters, what differs in a few numbers or choices of their
 * scenarios, its sweep, its ordinal.
 * @param {Compared[]} points
 * @param {(id: string) => string} nameOf a sweep
 * @returns {Compared[]}
 */
export function toldApart(points, nameOf) {
  /** Words that tell a point from those that are alike so far. @type {((point: Compared, alike: Compared[]) => string)[]} */
  const tells = [
    ({ detail }) => sayParameters(detail.parameters),
    changesAmong,
    ({ id }) => nameOf(id),
    ({ ordinal }) => `point ${ordinal}`,
  ];
  return points.map((point) => {
    let alike = points;
    /** @type {string[]} */
    const words = [];
    for (const tell of tells) {
      const own = tell(point, alike);
      const rest = alike.filter((other) => tell(other, alike) === own);
      if (!words.length || rest.length < alike.length) words.push(own);
      alike = rest;
      if (alike.length === 1) break;
    }
    return {
      ...point,
      name: `${point.number}: ${words.filter(Boolean).join(", ") || `point ${point.ordinal}`}`,
    };
  });
}

/**
 * Fields in which a point's scenario differs from those of others; empty if there are many.
 * @param {Compared} point
 * @param {Compared[]} alike it and the others
 */
function changesAmong(point, alike) {
  const scenarios = alike.map(({ detail }) => leaves(detail.scenario));
  const own = leaves(point.detail.scenario);
  // A name and what was recorded make no other motion.
  const paths = [...new Set(scenarios.flatMap((one) => [...one.keys()]))].filter(
    (path) =>
      path !== "name" &&
      !path.startsWith("recording.") &&
      scenarios.some((one) => one.get(path) !== own.get(path)),
  );
  return paths.length <= MOST_CHANGES
    ? sayParameters(Object.fromEntries(paths.map((path) => [path, own.get(path)])))
    : "";
}

/**
 * Numbers, words and truths of a document, by their paths; lists are left out.
 * @param {any} document
 * @param {string} [path]
 * @returns {Map<string, any>}
 */
function leaves(document, path = "") {
  const entries = Object.entries(document).flatMap(([name, value]) => {
    if (value === null || Array.isArray(value)) return [];
    return typeof value === "object"
      ? [...leaves(value, `${path}${name}.`)]
      : [/** @type {[string, any]} */ ([path + name, value])];
  });
  return new Map(entries);
}

/**
 * Measured depths at which any of the points recorded a node, from the top, and those of the nodes by their names in links [m].
 * @typedef {{depths: number[], byNode: Map<string, number>}} RecordedDepths
 */

/**
 * @param {Compared[]} points
 * @param {AbortSignal} signal
 * @returns {Promise<RecordedDepths>}
 */
export async function recordedDepths(points, signal) {
  const found = await Promise.all(
    points.map(async ({ detail, path }) => {
      /** @type {any[]} */
      const nodes = detail.summary ? detail.scenario.recording.nodes : [];
      const placed = (/** @type {any} */ entry) => depthOfRecorded(entry, detail.scenario.string);
      const named = (/** @type {any} */ entry, /** @type {number} */ depth) =>
        /** @type {[string, number]} */ ([nodeInLink(entry), depth]);
      if (!nodes.some((entry) => entry.node !== undefined))
        return nodes.map((entry) => named(entry, placed(entry) ?? NaN));
      try {
        const { columns } = await get(
          `${path}/statics`,
          { format: "json", fields: "node,measured_depth" },
          signal,
        );
        return nodes.map((entry) =>
          named(entry, placed(entry) ?? columns.measured_depth[columns.node.indexOf(entry.node)]),
        );
      } catch (error) {
        // Without its equilibrium it has no motion either.
        if (!(error instanceof Problem) || error.status === 401) throw error;
        return [];
      }
    }),
  );
  const entries = found.flat().filter(([, depth]) => Number.isFinite(depth));
  const inOrder = entries.map(([, depth]) => depth).sort((a, b) => a - b);
  return {
    depths: inOrder.filter((depth, index) => index === 0 || depth - inOrder[index - 1] > SAME_DEPTH),
    // The first point's nodes stand.
    byNode: new Map(entries.toReversed()),
  };
}
