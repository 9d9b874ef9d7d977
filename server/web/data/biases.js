// Biases found by verifying a sample of a sweep's points, shown next to the affected numbers.

import { get } from "./api.js";
import { number, say } from "./units.js";

/** Biases of frequencies are differences [Hz]; all others are relative to the reference. */
const FREQUENCIES = /^(ensemble_mean_)?line_frequency_hz/;

/** Relative biases below this are said to be so. */
const LEAST = 1e-4;

/** Orbit sizes of recorded nodes, or their means over an ensemble. */
const ORBIT_SIZE = /^(ensemble_mean_)?orbit_radius_rms_/;

/**
 * A bias with its unit and sign.
 * @param {string} name of the quantity that is biased
 * @param {number} value
 */
export function sayBias(name, value) {
  const sign = value > 0 ? "+" : value < 0 ? "−" : "";
  const size = Math.abs(value);
  if (!FREQUENCIES.test(name) && size < LEAST) return `below ${number(100 * LEAST)} %`;
  return (
    sign +
    (FREQUENCIES.test(name)
      ? say("frequency", size, 2)
      : `${number(Number((100 * size).toPrecision(2)), 2)} %`)
  );
}

/**
 * The worst bias that verification found in a sweep.
 * @param {{bias: number, ordinal: number, promised?: number | null}} worst of orbit size, relative
 */
export function sayWorst({ bias, ordinal, promised }) {
  const kept = promised ? ` (promised: ${sayBias("orbit_radius_rms", promised).replace("+", "")})` : "";
  return `Verified against reference runs: worst bias of orbit size ${sayBias("orbit_radius_rms", bias)} at point ${ordinal}${kept}.`;
}

/** The findings of a sweep that verifies points; none of one that does not. */
export class Biases {
  /** @type {Record<string, any>} */
  #statistics = {};
  /** The biases of each verified point, by its number. @type {Map<number, Record<string, number | null>>} */
  #points = new Map();

  /** @param {any} sweep @param {AbortSignal} signal */
  async load(sweep, signal) {
    if (!sweep.verification) return;
    const table = await get(
      `/v1/sweeps/${encodeURIComponent(sweep.id)}/verification`,
      { format: "json" },
      signal,
    );
    this.#statistics = table.attributes?.statistics ?? {};
    const names = Object.keys(table.columns).filter((name) => name.startsWith("bias_"));
    this.#points = new Map(
      table.columns.ordinal.map((/** @type {number} */ ordinal, /** @type {number} */ row) => [
        ordinal,
        Object.fromEntries(names.map((name) => [name.slice("bias_".length), table.columns[name][row]])),
      ]),
    );
  }

  /**
   * In words what was found of a quantity; empty where nothing was.
   * @param {string} name
   */
  say(name) {
    const found = this.#statistics[name];
    if (!found) return "";
    const interval = found.interval
      ? ` (95 % interval ${sayBias(name, found.interval[0])} to ${sayBias(name, found.interval[1])})`
      : "";
    const promised =
      found.promised !== undefined && found.promised !== null
        ? `; ${sayBias(name, found.promised).replace("+", "")} promised${found.exceeding ? `, exceeded at ${found.exceeding}` : ""}`
        : "";
    return `Bias against reference runs at ${found.verified} ${found.verified === 1 ? "point" : "points"}: mean ${sayBias(name, found.mean)}${interval}, largest ${sayBias(name, found.largest)} at point ${found.largest_at}${promised}.`;
  }

  /**
   * The mean bias alone, for the head of a column; empty where nothing was found.
   * @param {string} name
   */
  brief(name) {
    const found = this.#statistics[name];
    return found ? `mean bias ${sayBias(name, found.mean)}` : "";
  }

  /**
   * The bias of one point, to stand next to its number; empty where that is not known.
   * @param {string} name
   * @param {number} ordinal
   */
  at(name, ordinal) {
    const bias = this.#points.get(ordinal)?.[name];
    return typeof bias === "number" ? `bias ${sayBias(name, bias)}` : "";
  }

  /** Ordinals of the verified points. */
  get verified() {
    return [...this.#points.keys()];
  }

  /**
   * Largest bias of orbit size at a point, or else at all verified points of the sweep; null without any.
   * @param {number} ordinal
   * @returns {import("./accuracy.js").Measured | null}
   */
  orbitSize(ordinal) {
    const own = Object.entries(this.#points.get(ordinal) ?? {}).flatMap(([name, value]) =>
      ORBIT_SIZE.test(name) && typeof value === "number" ? [{ value, name, verified: 1, isOwn: true }] : [],
    );
    const all = Object.entries(this.#statistics).flatMap(([name, { largest, verified }]) =>
      ORBIT_SIZE.test(name) ? [{ value: largest, name, verified, isOwn: false }] : [],
    );
    const [worst] = (own.length ? own : all).sort((a, b) => Math.abs(b.value) - Math.abs(a.value));
    return worst ?? null;
  }

  /**
   * Text next to a number of a point: its own bias, or else the mean one of the sweep.
   * @param {string} name
   * @param {number} ordinal
   */
  beside(name, ordinal) {
    const own = this.at(name, ordinal);
    const mean = own || this.brief(name);
    return mean && ` (${mean}${own ? "" : " of the sweep"})`;
  }
}
