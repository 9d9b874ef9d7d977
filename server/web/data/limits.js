// Limits by which points are judged, as links and requests hold them: `COLUMN:VALUE` or `COLUMN:off`, separated by commas.

/** Limits by column, in served units; null takes one away. @typedef {Map<string, number | null>} Limits */

/** Steps of a slider. */
const STEPS = 200;
/** Digits of a limit in a request. */
const DIGITS = 6;

/**
 * Changes of the default limits; entries that cannot be read are left out.
 * @param {string} text
 * @returns {Limits}
 */
export function parseLimits(text) {
  /** @type {Limits} */
  const limits = new Map();
  for (const entry of text.split(",")) {
    const [column, value = ""] = entry.split(":").map((part) => part.trim());
    const limit = value === "off" ? null : Number(value);
    if (column && (limit === null || (limit > 0 && Number.isFinite(limit)))) limits.set(column, limit);
  }
  return limits;
}

/**
 * Limits that differ from the defaults, for a request; empty if none does.
 * @param {Limits} limits
 * @param {Record<string, number>} defaults
 */
export function limitsText(limits, defaults) {
  return [...limits]
    .filter(([column, limit]) => limit !== (defaults[column] ?? null))
    .map(([column, limit]) => `${column}:${limit ?? "off"}`)
    .join(",");
}

/**
 * The limits as the Python client takes them.
 * @param {Limits} limits
 * @param {Record<string, number>} defaults
 * @returns {Record<string, number | null>}
 */
export function changedLimits(limits, defaults) {
  return Object.fromEntries([...limits].filter(([column, limit]) => limit !== (defaults[column] ?? null)));
}

/**
 * Range of a slider, from its first step to twice the usual limit. A limit of zero is none.
 * @param {number} usual limit, in any unit
 */
export function sliderOf(usual) {
  const step = (2 * usual) / STEPS;
  return { min: step, max: 2 * usual, step };
}

/**
 * A limit in served units from a number in shown ones.
 * @param {number} shown
 * @param {number} size of the shown unit
 * @returns {number} NaN if the number is no limit
 */
export function servedLimit(shown, size) {
  const limit = Number((shown * size).toPrecision(DIGITS));
  return Number.isFinite(limit) && limit > 0 ? limit : NaN;
}
