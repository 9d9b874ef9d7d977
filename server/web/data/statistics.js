// Statistics of a window of a node's motion, and what verifying a sweep says of them.

import { verifiedWindow } from "./motion-requests.js";

/** What the service calls them, and what the page does. @type {[string, string][]} */
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
 * How names of a summary's columns write a recorded node: its number, or the depth for which it is recorded.
 * @param {any} scenario
 * @param {number} node as the service numbers it
 * @param {number} depth its measured depth [m]
 * @returns {string}
 */
export function recordedAs({ recording: { nodes } }, node, depth) {
  const depths = nodes.flatMap((/** @type {any} */ one) => (one.depth === undefined ? [] : [one.depth]));
  if (!depths.length || nodes.some((/** @type {any} */ one) => one.node === node)) return String(node);
  const nearest = depths.reduce((/** @type {number} */ a, /** @type {number} */ b) =>
    Math.abs(b - depth) < Math.abs(a - depth) ? b : a,
  );
  return `${nearest}m`.replace(".", "_");
}

/**
 * What stands beside a statistic of a window: its bias where that is the one that verifying looks at, else nothing.
 * @param {any} point
 * @param {{from: number, to: number}} window [s]
 * @param {(name: string) => string} bias
 */
export function biasOver(point, { from, to }, bias) {
  const verified = verifiedWindow(point);
  return isSame({ from, to }, verified, point.scenario.duration) ? bias : () => "";
}

/**
 * @param {{from: number, to: number}} one
 * @param {{from: number, to: number}} other
 * @param {number} duration of the run [s]
 */
function isSame(one, other, duration) {
  return [one.from - other.from, one.to - other.to].every((apart) => Math.abs(apart) <= SAME * duration);
}
