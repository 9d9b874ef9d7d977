// Data kept of each point of a new sweep.

import { choice, fill, h } from "../ui/dom.js";
import { numberBox } from "./fields.js";
import { Unreadable } from "./values.js";

/** Choice of histories in part. */
const PART = "part";
/** @type {[string, string][]} */
const OUTPUTS = [
  ["", "the scenario's"],
  ["full", "everything, with histories"],
  [PART, "histories in part"],
  ["spectra", "spectra, no histories"],
  ["summary", "its row of the table only"],
];
/** A node: its number, or its depth or distance above the bit with a unit. */
const NODE = /^([\d.]+)\s*(?:(m|ft)(\s+above(?: the)? bit)?)?$/;
const FOOT = 0.3048;

/** @typedef {{node: number} | {depth: number} | {above_bit: number}} Node */

/** Nodes of a text such as `49, 57.7 m`; null if it has anything else. @param {string} text @returns {Node[] | null} */
export function nodesOf(text) {
  const words = text
    .split(",")
    .map((word) => word.trim())
    .filter(Boolean);
  const nodes = words.map((word) => {
    const [, number, unit, above] = NODE.exec(word) ?? [];
    if (number === undefined) return null;
    if (unit) {
      const metres = unit === "ft" ? Number((Number(number) * FOOT).toPrecision(15)) : Number(number);
      return above ? { above_bit: metres } : { depth: metres };
    }
    return Number.isInteger(Number(number)) ? { node: Number(number) } : null;
  });
  return nodes.includes(null) ? null : /** @type {Node[]} */ (nodes);
}

/** @param {Node[]} nodes */
export function nodesText(nodes) {
  return nodes
    .map((node) => {
      if ("above_bit" in node) return `${node.above_bit} m above bit`;
      return "node" in node ? String(node.node) : `${node.depth} m`;
    })
    .join(", ");
}

/** Outputs of a request, by a choice with fields for histories in part. */
export class Kept {
  #changed;
  #way;
  /** Histories in part: nodes, window and every how many samples. @type {any} */
  #part;
  #nodes;
  #fields = h("div", { class: "line", "data-pointer": "/outputs" });
  element = h("div", {});

  /** @param {any} outputs of the request that the form begins with @param {() => void} changed */
  constructor(outputs, changed) {
    this.#changed = changed;
    this.#way = outputs && typeof outputs === "object" ? PART : (outputs ?? "");
    this.#part = outputs?.orbits ?? {};
    this.#nodes = nodesText(this.#part.nodes ?? []);
    const choose = choice("Kept of each point", OUTPUTS, this.#way, (way) => {
      this.#way = way;
      this.#draw();
      changed();
    });
    fill(this.element, choose, this.#fields);
    this.#draw();
  }

  /** Outputs of the request; undefined for the scenario's. Throws if the nodes cannot be read. */
  get outputs() {
    if (this.#way !== PART) return this.#way || undefined;
    const nodes = nodesOf(this.#nodes);
    if (!nodes)
      throw new Unreadable("/outputs", "Nodes are numbers or depths, such as 49, 57.7 m or 12 m above bit");
    const { nodes: _, ...part } = this.#part;
    return { orbits: nodes.length ? { nodes, ...part } : part };
  }

  #draw() {
    fill(this.#fields, this.#way === PART && this.#parts());
  }

  #parts() {
    const { decimation = 1, window } = this.#part;
    const put = (/** @type {any} */ change) => {
      this.#part = { ...this.#part, ...change };
      this.#changed();
    };
    const nodes = h("input", {
      value: this.#nodes,
      placeholder: "all recorded; or 49, 57.7 m",
      oninput: () => {
        this.#nodes = nodes.value;
        this.#changed();
      },
    });
    const end = (/** @type {"from" | "to"} */ name) =>
      numberBox(
        `Histories ${name} [s]`,
        "time",
        window?.[name],
        (value) => put({ window: windowWith(this.#part.window, name, value) }),
        { isOptional: true },
      );
    const every = numberBox("Every n-th sample", "", decimation, (value) => put({ decimation: value }), {
      min: 1,
    });
    return [
      h("label", { class: "field" }, h("span", {}, "Histories of nodes"), nodes),
      h("label", { class: "field" }, h("span", {}, "Every n-th sample"), every),
      h("label", { class: "field" }, h("span", {}, "From [s]"), end("from")),
      h("label", { class: "field" }, h("span", {}, "To [s]"), end("to")),
    ];
  }
}

/**
 * A window with another end; none without either.
 * @param {{from?: number, to?: number} | undefined} window
 * @param {"from" | "to"} name
 * @param {number | undefined} value
 */
export function windowWith(window, name, value) {
  const { from, to } = /** @type {{from?: number, to?: number}} */ ({ ...window, [name]: value });
  if (from === undefined && to === undefined) return undefined;
  return { from: from ?? 0, ...(to === undefined ? {} : { to }) };
}
