// A sweep's table by columns, fetched as they are needed.

import { get } from "./api.js";

/** Points up to which the whole table is one answer; beyond, columns are fetched as views ask for them. */
const WHOLE = 3000;

/** @typedef {(number | string | null)[]} Values */

export class SweepTable {
  /** @type {Map<string, Values>} */
  #columns = new Map();
  /** @type {string[]} */
  names = [];
  rows = 0;

  /** @param {any} sweep @param {AbortSignal} signal */
  constructor(sweep, signal) {
    this.path = `/v1/sweeps/${encodeURIComponent(sweep.id)}/table`;
    this.self = `/v1/sweeps/${encodeURIComponent(sweep.id)}`;
    this.isWhole = sweep.counts.total <= WHOLE;
    this.signal = signal;
  }

  /** Reads the table anew, or those of its columns that views have asked for. */
  async load() {
    if (this.isWhole) {
      const table = await get(this.path, { format: "json" }, this.signal);
      this.#columns = new Map(Object.entries(table.columns));
      this.names = [...this.#columns.keys()];
    } else {
      const wanted = [...new Set(["ordinal", "state", ...this.#columns.keys()])];
      this.#columns = await this.#fetch(wanted);
      if (this.names.length < 3) this.names = await this.#learn();
    }
    this.rows = this.#columns.get("ordinal")?.length ?? 0;
  }

  /** The names of the columns, from a point that has them: no answer lists them without their values. */
  async #learn() {
    const { points } = await get(`${this.self}/points`, { state: "succeeded", limit: 1 }, this.signal);
    const { points: first } = points.length ? { points } : await get(`${this.self}/points`, { limit: 1 }, this.signal);
    const names = ["ordinal", "state", ...Object.keys(first[0]?.parameters ?? {})];
    if (!points.length) return names;
    const point = await get(`${this.self}/points/${points[0].ordinal}`, {}, this.signal);
    return [...new Set([...names, ...Object.keys(point.summary ?? {}), "error", "error_time", "error_node"])];
  }

  /**
   * @param {string[]} names
   * @returns {Promise<Map<string, Values>>}
   */
  async #fetch(names) {
    const table = await get(this.path, { format: "json", fields: names.join(",") }, this.signal);
    return new Map(Object.entries(table.columns));
  }

  /**
   * Columns by name, in that order; one that the table does not have is all gaps.
   * @param {string[]} names
   * @returns {Promise<Values[]>}
   */
  async columns(...names) {
    const missing = [...new Set(names)].filter((name) => !this.#columns.has(name));
    if (missing.length && !this.isWhole) {
      for (const [name, values] of await this.#fetch(missing)) this.#columns.set(name, values);
    }
    return names.map((name) => this.#columns.get(name) ?? Array(this.rows).fill(null));
  }

  /** Names of columns that hold words or numbers worth a colour or an axis. */
  results() {
    return this.names.filter((name) => name !== "ordinal" && name !== "error");
  }
}

/** @param {Values} values */
export function isText(values) {
  return values.some((value) => typeof value === "string");
}

/**
 * The different values of a column in order.
 * @param {Values} values
 * @returns {(number | string)[]}
 */
export function distinct(values) {
  const all = [...new Set(values)].filter((value) => value !== null);
  return /** @type {(number | string)[]} */ (all).sort((a, b) => (typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b))));
}
