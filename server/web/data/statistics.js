// Statistics of a window of a node's motion, and what verifying a sweep says of them.

import { depthOfRecorded, nodeInLink, verifiedWindow } from "./motion-requests.js";

/** Statistics by their names in the service, with those on the page. @type {[string, string][]} */
export const STATISTICS = [
  ["orbit_radius_rms", "Orbit size (rms about the mean)"],
  ["orbit_mean_radius", "Mean radius"],
  ["orbit_radius_deviation", "Deviation of the radius"],
  ["orbit_largest_radius", "Largest radius"],
  ["orbit_smallest_radius", "Smallest radius"],
  ["orbit_offset", "Offset of the mean position"],
  ["peak_to_peak_u", "Peak to peak of u"],
  ["peak_to_peak_v", "Peak to peak of v"],
];
/** Part of a run within which the ends of two windows count as the same: the link rounds them. */
const SAME = 1e-4;

/** Columns that show whether a point has settled. */
export const SETTLING = ["motion_regime", "growing_mode_hz"];

/**
 * Whether a point's statistics may be those of its start alone: it has not settled, or a mode still grows.
 * @param {any} regime
 * @param {any} growing
 */
export function isUnsettled(regime, growing) {
  return regime === "not_settled" || typeof growing === "number";
}

/** Samples that a spectrum needs. */
export const FEWEST = 8;

/**
 * The number of a point's window of spectra that a window is, from 1; 0 of any other.
 * @param {any} point
 * @param {{from: number, to: number}} window [s]
 */
export function spectrumWindow(point, window) {
  const { recording, duration } = point.scenario;
  if (recording.orbit_window === "settled" && !recording.spectrum_windows)
    return isSame(window, verifiedWindow(point), duration) ? 1 : 0;
  const first = Math.round(((duration * 5) / 6) * recording.rate_hz) / recording.rate_hz;
  const usual = (duration - first) * recording.rate_hz >= FEWEST ? [{ from: first, to: duration }] : [];
  return (
    1 +
    (recording.spectrum_windows ?? usual).findIndex((/** @type {{from: number, to: number}} */ known) =>
      isSame(window, known, duration),
    )
  );
}

/**
 * Suffix of a recorded node in the names of a summary's columns: its number, or the place for which it is recorded.
 * @param {any} scenario
 * @param {number} node as the service numbers it
 * @param {number} depth its measured depth [m]
 * @returns {string}
 */
export function recordedAs({ recording: { nodes }, string }, node, depth) {
  const places = nodes.filter((/** @type {any} */ one) => one.node === undefined);
  if (!places.length || nodes.some((/** @type {any} */ one) => one.node === node)) return String(node);
  const off = (/** @type {any} */ one) => Math.abs((depthOfRecorded(one, string) ?? NaN) - depth);
  const nearest = places.reduce((/** @type {any} */ a, /** @type {any} */ b) => (off(b) < off(a) ? b : a));
  return nodeInLink(nearest).replace(".", "_");
}

/**
 * Bias to show next to a statistic of a window: empty unless verifying used that window.
 * @param {any} point
 * @param {{from: number, to: number}} window [s]
 * @param {(name: string) => string} bias
 */
export function biasOver(point, { from, to }, bias) {
  const verified = verifiedWindow(point);
  return isSame({ from, to }, verified, point.scenario.duration) ? bias : () => "";
}

/**
 * The window in which points are compared: the one of their statistics if it is the same for all; otherwise the overlap of their windows, or
 * the last third of the shortest run if there is none.
 * @param {any[]} points
 * @returns {{from: number, to: number, isShared: boolean, isOverlap: boolean}} [s]
 */
export function comparedWindow(points) {
  const shortest = Math.min(...points.map(({ scenario }) => scenario.duration));
  // A point without results has no statistics that another window would contradict.
  const complete = points.filter(({ summary }) => summary);
  const windows = (complete.length ? complete : points).map(verifiedWindow);
  const [first] = windows;
  const isShared = windows.every((window) => isSame(window, first, shortest)) && first.from < shortest;
  if (isShared) return { from: first.from, to: Math.min(first.to, shortest), isShared, isOverlap: true };
  const from = Math.max(...windows.map((window) => window.from));
  const to = Math.min(shortest, ...windows.map((window) => window.to));
  const isOverlap = to - from > SAME * shortest;
  return {
    ...(isOverlap ? { from, to } : { from: (shortest * 2) / 3, to: shortest }),
    isShared: false,
    isOverlap,
  };
}

/**
 * @param {{from: number, to: number}} one
 * @param {{from: number, to: number}} other
 * @param {number} duration of the run [s]
 */
function isSame(one, other, duration) {
  return [one.from - other.from, one.to - other.to].every((apart) => Math.abs(apart) <= SAME * duration);
}

/**
 * Statistics of some samples of an orbit, as the service calls them.
 * @param {{u: number[], v: number[]}} columns
 * @param {number} first @param {number} end rows, half-open
 * @returns {Record<string, number> | null} null of none
 */
export function orbitStatistics({ u, v }, first, end) {
  const count = end - first;
  if (count <= 0) return null;
  let [meanU, meanV, meanRadius] = [0, 0, 0];
  for (let row = first; row < end; row += 1) {
    meanU += u[row] / count;
    meanV += v[row] / count;
    meanRadius += Math.hypot(u[row], v[row]) / count;
  }
  let [square, deviation, largest, smallest] = [0, 0, 0, Infinity];
  for (let row = first; row < end; row += 1) {
    const radius = Math.hypot(u[row], v[row]);
    square += ((u[row] - meanU) ** 2 + (v[row] - meanV) ** 2) / count;
    deviation += (radius - meanRadius) ** 2 / count;
    largest = Math.max(largest, radius);
    smallest = Math.min(smallest, radius);
  }
  return {
    orbit_radius_rms: Math.sqrt(square),
    orbit_mean_radius: meanRadius,
    orbit_radius_deviation: Math.sqrt(deviation),
    orbit_largest_radius: largest,
    orbit_smallest_radius: smallest,
    orbit_offset: Math.hypot(meanU, meanV),
    peak_to_peak_u: reach(u, first, end),
    peak_to_peak_v: reach(v, first, end),
  };
}

/** Distance from the least to the largest of some values. @param {number[]} values @param {number} first @param {number} end half-open */
function reach(values, first, end) {
  let [least, largest] = [Infinity, -Infinity];
  for (let row = first; row < end; row += 1) {
    least = Math.min(least, values[row]);
    largest = Math.max(largest, values[row]);
  }
  return largest - least;
}

/**
 * Root mean square distance of each node from its mean position.
 * @param {import("./snapshots.js").Frames} frames
 */
export function amplitudes({ nodes, count, columns: { u, v } }) {
  return Array.from({ length: nodes }, (_, node) => {
    const [sums, squares] = [
      [0, 0],
      [0, 0],
    ];
    [u, v].forEach((column, part) => {
      // About the first value, so that nothing cancels.
      const start = column[node];
      for (let frame = 0; frame < count; frame += 1) {
        const value = column[frame * nodes + node] - start;
        sums[part] += value;
        squares[part] += value * value;
      }
    });
    return Math.sqrt(
      Math.max(
        0,
        [0, 1].reduce((sum, part) => sum + squares[part] / count - (sums[part] / count) ** 2, 0),
      ),
    );
  });
}
