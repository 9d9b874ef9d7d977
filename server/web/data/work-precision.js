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

/** Errors of a study that a picture can show, with the words for them; the first that any row has is shown. @type {[string, string][]} */
const MEASURES = [
  ["orbit_size", "error of orbit size"],
  ["radius_deviation", "error of the radius' standard deviation"],
  ["trajectory", "error of the history"],
];
/** Names of the accuracies. */
const PRESETS = ["draft", "standard", "reference"];

/** A relative error of a row; null if it is not known. @param {any} row of a study @param {string} measure @returns {number | null} */
function errorOf({ errors }, measure) {
  const found = errors?.[measure];
  return typeof found === "number" ? found : (found?.bias ?? null);
}

/** Row of a study in words, such as `esdirk4, 0.5 ms`. @param {any} row */
export function studyRowName({ name, integrator, step, tolerance, mesh_factor: mesh }) {
  const elements = mesh === 1 ? "" : `, elements times ${Number(mesh.toPrecision(3))}`;
  if (PRESETS.includes(name)) return `${name}${elements}`;
  const method = `${integrator.replaceAll("_", "-")}, ${Number((1000 * step).toPrecision(3))} ms`;
  const adapted = typeof tolerance === "number" ? `, tolerance ${tolerance}` : "";
  return `${method}${adapted}${elements}`;
}

/**
 * Measured rows of a cost study: accuracies, and other methods, meshes and starts.
 * @param {any} report
 * @returns {{measure: string, accuracies: Cost[], others: Cost[]}} `measure` in words; rows that failed or have no such error are left out
 */
export function studyCosts(report) {
  // A study of effects has the whole scenario for its reference, which has no error.
  const rows = report.effects?.length
    ? []
    : [...report.methods, ...report.references, ...report.meshes, ...report.starts];
  const [name, measure] =
    MEASURES.find(([entry]) => rows.some((row) => errorOf(row, entry) !== null)) ?? MEASURES[0];
  const known = rows.filter((row) => errorOf(row, name) !== null && row.cpu_time > 0);
  const cost = (/** @type {any} */ row) => ({
    cpu: row.cpu_time,
    error: Math.max(LEAST, Math.abs(errorOf(row, name) ?? 0)),
    text: studyRowName(row),
  });
  const isAccuracy = (/** @type {any} */ row) => PRESETS.includes(row.name);
  return {
    measure,
    accuracies: known.filter(isAccuracy).map(cost),
    others: known.filter((row) => !isAccuracy(row)).map(cost),
  };
}

/**
 * Changes of statistics and of time by leaving out one effect at a time, relative to the whole scenario.
 * @param {any} report of a study of effects
 * @returns {{effect: string, orbitSize: number | null, deviation: number | null, torsionalSpeed: number | null, saved: number | null, failure: string | null}[]}
 */
export function effectCosts({ effects, references }) {
  const whole = references[0]?.cpu_per_simulated_second;
  return effects.map((/** @type {any} */ row) => ({
    effect: row.effect,
    orbitSize: errorOf(row, "orbit_size"),
    deviation: errorOf(row, "radius_deviation"),
    torsionalSpeed: errorOf(row, "torsional_speed"),
    saved: whole && !row.failure ? 1 - row.cpu_per_simulated_second / whole : null,
    failure: row.failure ?? null,
  }));
}
