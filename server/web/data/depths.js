// The depths of the nodes that columns are of.

import { get, Problem } from "./api.js";
import { label, say, unit } from "./units.js";

/** Depths by node, of the first point of a sweep that has them. */
export class Depths {
  /** @type {Map<number, number>} */
  #depths = new Map();
  #isAsked = false;
  /** Whether a name was shown without the depth of its node. */
  isMissed = false;

  /**
   * Reads them once there is a result; where its equilibrium is not kept, or not any more, they stay unknown: names do without them. It does not fail.
   * @param {any} sweep
   * @param {AbortSignal} signal
   */
  async load(sweep, signal) {
    if (this.#isAsked || !sweep.counts.succeeded) return;
    this.#isAsked = true;
    try {
      await this.#read(sweep, signal);
    } catch (error) {
      // An unreachable service is asked again with the next result.
      this.#isAsked = error instanceof Problem;
    }
  }

  /** @param {any} sweep @param {AbortSignal} signal */
  async #read(sweep, signal) {
    const path = `/v1/sweeps/${encodeURIComponent(sweep.id)}/points`;
    const { points } = await get(path, { state: "succeeded", limit: 1 }, signal);
    if (!points[0]) return;
    const { tables } = await get(`${path}/${points[0].ordinal}`, {}, signal);
    if (!JSON.stringify(tables ?? []).includes("statics")) return;
    const { columns } = await get(
      `${path}/${points[0].ordinal}/statics`,
      { format: "json", fields: "node,measured_depth" },
      signal,
    );
    this.#depths = new Map(
      columns.node.map((/** @type {number} */ node, /** @type {number} */ row) => [
        node,
        columns.measured_depth[row],
      ]),
    );
  }

  /** The label of a column, with the depth of its node in place of its number. @param {string} name */
  label(name) {
    return label(name).replace(/, node (\d+)/, (text, node) => {
      const depth = this.#depths.get(Number(node));
      this.isMissed ||= depth === undefined;
      return depth === undefined ? text : ` at ${say("measured_depth", depth)}`;
    });
  }

  /** The same with its unit in brackets. @param {string} name */
  title(name) {
    const { symbol } = unit(name);
    return symbol ? `${this.label(name)} [${symbol}]` : this.label(name);
  }
}
