// Error of a point's orbit sizes: estimated from its run, measured by verification, promised by its accuracy.

import { number, say } from "./units.js";

/**
 * Largest bias of orbit size that verification measured, relative to the reference.
 * @typedef {object} Measured
 * @property {number} value signed
 * @property {string} name column of the orbit size
 * @property {number} verified number of points behind it
 * @property {boolean} isOwn true if it was measured at the point itself
 */

/** Parts of an estimated error, with their names. @type {[string, string][]} */
const PARTS = [
  ["time_error", "steps"],
  ["mesh_error", "mesh"],
  ["sampling_error", "sampling"],
];

/**
 * Error of orbit size in three ways, and the one to believe.
 * @param {Record<string, any>} summary of the point
 * @param {Measured | null} measured
 * @returns {{estimate: number | null, missing: string[], measured: Measured | null, promised: number | null, believed: "measured" | "estimate" | null, isMet: boolean | null}}
 * relative errors; `missing` names the parts that the estimate lacks; `isMet` is null if nothing is believed or promised
 */
export function accuracyOf(summary, measured) {
  const known = (/** @type {string} */ name) => (typeof summary[name] === "number" ? summary[name] : null);
  const whole = known("whole_error");
  const missing =
    whole === null ? PARTS.filter(([name]) => known(name) === null).map(([, part]) => part) : [];
  const parts = PARTS.map(([name]) => known(name) ?? 0);
  const partial = missing.length < PARTS.length ? Math.hypot(...parts) : null;
  const estimate = whole ?? partial;
  const promised = known("promised_error");
  const believed = measured?.isOwn ? "measured" : estimate !== null && !missing.length ? "estimate" : null;
  const error = believed === "measured" ? Math.abs(measured?.value ?? 0) : estimate;
  // Parts alone exceed a promise, but do not meet one.
  const isExceeded = promised !== null && error !== null && error > promised;
  const isMet = promised === null || (believed === null && !isExceeded) ? null : !isExceeded;
  return { estimate, missing, measured, promised, believed, isMet };
}

/** A relative error in per cent. @param {number | null} value */
export function sayError(value) {
  return value === null ? "not known" : `${number(100 * Math.abs(value), 2)} %`;
}

/**
 * Advice on the error to believe, in words.
 * @param {ReturnType<typeof accuracyOf>} accuracy
 */
export function advice({ believed, missing, isMet }) {
  const kept = isMet === null ? "" : isMet ? ", within the promise" : ", beyond the promise";
  if (believed === "measured") return `Believe the measurement${kept}`;
  if (believed === "estimate") return `Believe the estimate${kept}`;
  return `Verify this point: the estimate lacks ${missing.join(" and ")}${kept}`;
}

/** Place of a measured error in words. @param {Measured | null} measured */
export function placeOf(measured) {
  if (!measured) return "";
  const depth = /_(\d+(?:_\d+)?)m$/.exec(measured.name)?.[1];
  const place = depth
    ? say("measured_depth", Number(depth.replace("_", ".")))
    : `node ${/\d+$/.exec(measured.name)?.[0] ?? ""}`;
  return measured.isOwn
    ? `at ${place}, the worst`
    : `at most, at ${measured.verified} verified ${measured.verified === 1 ? "point" : "points"} of the sweep`;
}
