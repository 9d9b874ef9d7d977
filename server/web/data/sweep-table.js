// A sweep's table by columns, fetched as they are needed.

import { get } from "./api.js";

/** @typedef {(number | string | null)[]} Values */

/** Column of the page: the largest orbit size of all recorded nodes. */
export const LARGEST_ORBIT = "largest_orbit_radius_rms";
/** Orbit size of a node, by its number or its depth. */
const ORBIT = /^orbit_radius_rms_\d+(_\d+m|m)?$/;

export class SweepTable {
  /** @type {Map<string, Values>} */
  #columns = new Map();
  /** @type {string[]} */
  names = [];
  rows = 0;

  /** @param {any} sweep @param {AbortSignal} signal */
  constructor(sweep, signal) {
    this.path = `/v1/sweeps/${encodeURIComponent(sweep.id)}/table`;
    // Beyond, columns are fetched as views ask for them.
    this.isWhole = sweep.counts.total <= preload.WHOLE;
    this.signal = signal;
  }

  /** Reads the table anew, or those of its columns that views have asked for. */
  async load() {
    if (this.isWhole) {
      const table = await get(this.path, { format: "json" }, this.signal);
      this.#columns = new Map(Object.entries(table.columns));
      this.names = [...this.#columns.keys()];
    } else {
      // At first nothing is wanted yet: the view asks for all that it needs at once.
      const wanted = [...this.#columns.keys()];
      const [columns, listed] = await Promise.all([
        wanted.length ? this.#fetch(wanted) : this.#columns,
        get(`${this.path}/columns`, {}, this.signal),
      ]);
      this.#columns = columns;
      this.names = listed.columns.map((/** @type {any} */ column) => column.name);
    }
    this.#nameLargest();
    this.#count();
  }

  #count() {
    const [column] = this.#columns.values();
    this.rows = column?.length ?? 0;
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
    const missing = this.served(names).filter((name) => !this.#columns.has(name));
    if (missing.length && !this.isWhole) {
      for (const [name, values] of await this.#fetch(missing)) this.#columns.set(name, values);
      this.#count();
    }
    const gaps = () => Array(this.rows).fill(null);
    return names.map((name) =>
      name === LARGEST_ORBIT
        ? largestOf(this.#orbits().map((orbit) => this.#columns.get(orbit) ?? gaps()))
        : (this.#columns.get(name) ?? gaps()),
    );
  }

  /**
   * Columns of the service behind those of the page.
   * @param {string[]} names
   */
  served(names) {
    return [...new Set(names.flatMap((name) => (name === LARGEST_ORBIT ? this.#orbits() : name)))];
  }

  /** Columns of the orbit size at each recorded node. */
  #orbits() {
    return this.names.filter((name) => ORBIT.test(name));
  }

  /** Adds the column of the largest orbit, if several nodes were recorded. */
  #nameLargest() {
    if (this.#orbits().length > 1)
      this.names.splice(
        this.names.findIndex((name) => ORBIT.test(name)),
        0,
        LARGEST_ORBIT,
      );
  }

  /** Names of columns that hold words or numbers worth a colour or an axis. */
  results() {
    return this.names.filter((name) => name !== "ordinal" && name !== "error");
  }
}

/**
 * Largest value of each row; a gap if a row has none.
 * @param {Values[]} columns of numbers
 * @returns {Values}
 */
export function largestOf(columns) {
  return (columns[0] ?? []).map((_, row) =>
    columns.reduce((/** @type {number | null} */ most, column) => {
      const value = column[row];
      return typeof value === "number" && (most === null || value > most) ? value : most;
    }, null),
  );
}

/** Paths of a scenario that the table calls by a shorter name. @type {Record<string, string>} */
export const SHORT = { "mud.flow_rate": "flow_rate", "mud.density": "mud_density" };

/**
 * The swept parameters, as the table calls them: in the request's order, how it gives the values of each, and what it calls them.
 * @param {any} sweep with its request, unless that is long
 * @param {string[]} names of the table's columns
 * @returns {{axes: string[], spans: Record<string, any>, paths: Record<string, string>}}
 */
export function sweptBy(sweep, names) {
  const given = sweep.request?.axes ?? {};
  /** @type {string[]} */
  const varied = sweep.varied ?? [];
  const known = varied
    .map((path) => ({ path, name: names.includes(path) ? path : (SHORT[path] ?? path) }))
    .filter(({ name }) => names.includes(name));
  return {
    axes: known.map(({ name }) => name),
    spans: Object.fromEntries(known.map(({ path, name }) => [name, given[path]])),
    paths: Object.fromEntries(known.map(({ path, name }) => [name, path])),
  };
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
  return /** @type {(number | string)[]} */ (all).sort((a, b) =>
    typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b)),
  );
}
