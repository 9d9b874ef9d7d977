// Errors against processor times of a point and of the verified points of its sweep.

/** Verified points whose times are requested, at most. */
export const MOST_VERIFIED = 20;
/** Least error on a logarithmic scale. */
const LEAST = 1e-5;

/** An error and the processor time that it cost. @typedef {{cpu: number, error: number, text: string}} Cost */

/** Processor time of a run with its equilibrium [s]; null if it is not known. @param {any} point @returns {number | null} */
export function cpuTime({ provenance = {} }) {
  const { transient_cpu_time: run, statics_cpu_time: statics = 0 } = provenance;
  return typeof run === "number" ? run + statics : null;
}

/**
 * Costs of points with their errors, as far as both are known. An error of nothing has the least that the scale shows.
 * @param {{point: any, error: number | null}[]} points
 * @returns {Cost[]}
 */
export function costsOf(points) {
  return points.flatMap(({ point, error }) => {
    const cpu = cpuTime(point);
    return cpu === null || error === null
      ? []
      : [{ cpu, error: Math.max(LEAST, Math.abs(error)), text: `point ${point.ordinal}` }];
  });
}

/**
 * Range of a logarithmic axis around some values, of a decade at least.
 * @param {number[]} values
 * @returns {[number, number]}
 */
export function decades(values) {
  const logs = values.filter((value) => value > 0).map(Math.log10);
  const [least, largest] = [Math.min(...logs), Math.max(...logs)];
  const room = Math.max(0.2, (1 - (largest - least)) / 2);
  return [10 ** (least - room), 10 ** (largest + room)];
}
