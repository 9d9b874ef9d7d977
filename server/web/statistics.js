// Statistics of a window of a node's motion, and what verifying a sweep says of them.

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

/**
 * The window of a scenario's statistics, which verifying looks at: its own, or the last third of the run.
 * @param {any} scenario
 * @returns {{from: number, to: number}} [s]
 */
export function verifiedWindow({ recording, duration }) {
  return recording.orbit_window ?? { from: (duration * 2) / 3, to: duration };
}

/**
 * What stands beside a statistic of a window: its bias where that is the one that verifying looks at, else nothing.
 * @param {any} scenario
 * @param {{from: number, to: number}} window [s]
 * @param {(name: string) => string} bias
 */
export function biasOver(scenario, { from, to }, bias) {
  const verified = verifiedWindow(scenario);
  const isVerified = [from - verified.from, to - verified.to].every((apart) => Math.abs(apart) <= SAME * scenario.duration);
  return isVerified ? bias : () => "";
}
