// Further points between samples of different classes: a round at a time, until every edge is located.

import { Problem, send } from "../data/api.js";
import { number } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { notice } from "../ui/notices.js";
import { MAY_NOT, maySubmit } from "../ui/session.js";
import { bodyLines, python, snippets } from "../ui/snippets.js";

/** @typedef {import("./part.js").Context} Context */

export class RefineEdges {
  #context;
  #limits;
  #budget = numberBox("Points at most", { min: 1, max: 1000, step: 1, value: 50 });
  #resolution = numberBox("Longest edge [% of an axis]", { min: 0.1, max: 50, step: "any", value: 2 });
  #wrong = h("p", { class: "wrong", role: "alert" });
  #state = h("p", { role: "status" });
  #add = h("button", { type: "submit" }, "Add points");
  #snippets = snippets(() => this.#lines(), "The same request");
  element = h(
    "details",
    { class: "panel" },
    h("summary", {}, "Refine the edges between classes"),
    h(
      "p",
      { class: "small soft" },
      "Adds points in the middle between neighbours of different classes, the longest edges first. Repeat it when they have results.",
    ),
    h(
      "form",
      { class: "controls", novalidate: true, onsubmit: (/** @type {Event} */ event) => this.#submit(event) },
      this.#budget.element,
      this.#resolution.element,
      this.#add,
    ),
    this.#state,
    this.#wrong,
    this.#snippets,
  );

  /**
   * @param {Context} context
   * @param {() => string} limits changes of the limits, for a request
   */
  constructor(context, limits) {
    this.#context = context;
    this.#limits = limits;
    this.#add.disabled = !maySubmit();
    this.#add.title = maySubmit() ? "" : MAY_NOT;
  }

  get #path() {
    return `/v1/sweeps/${encodeURIComponent(this.#context.sweep.id)}/points`;
  }

  #request() {
    const { axes, paths, query } = this.#context;
    const x = query.get("x") ?? axes[0];
    const y = query.get("y") ?? axes.find((axis) => axis !== x);
    const limits = this.#limits();
    return {
      refine: {
        by: "class",
        over: [x, y].filter((name) => name !== undefined).map((name) => paths[name] ?? name),
        resolution: this.#resolution.value() / 100,
        ...(limits ? { limits } : {}),
        budget: this.#budget.value(),
      },
    };
  }

  #lines() {
    const { refine } = this.#request();
    const { by, over, resolution, budget } = refine;
    const options = Object.entries({ over, resolution, budget }).map(
      ([name, value]) => `${name}=${python(value)}`,
    );
    return {
      ...bodyLines(this.#path, { refine }),
      python: `from drillsweep import Client\n\nsweep = Client("${location.origin}").sweep("${this.#context.sweep.id}")\nsweep.refine(${[python(by), ...options].join(", ")})\nprint(sweep.refinement)`,
    };
  }

  /** @param {Event} event */
  async #submit(event) {
    event.preventDefault();
    this.#add.disabled = true;
    fill(this.#wrong);
    try {
      const before = this.#context.sweep.counts.total;
      const changed = await send("POST", this.#path, this.#request());
      const added = changed.counts.total - before;
      fill(this.#state, sayState(changed.refinement, added));
      if (added) notice(`${added} ${added === 1 ? "point is" : "points are"} added.`);
      this.#context.changed(changed);
    } catch (error) {
      const details = error instanceof Problem ? error.errors.map(({ detail }) => detail).join(" ") : "";
      fill(this.#wrong, details || (error instanceof Error ? error.message : String(error)));
    } finally {
      this.#add.disabled = !maySubmit();
    }
  }
}

/**
 * State of a refinement in words.
 * @param {{open_edges: number, longest_edge: number}} state
 * @param {number} added
 */
function sayState({ open_edges: open, longest_edge: longest }, added) {
  if (open === 0) return "Every edge between the samples is located to the resolution.";
  const edges = `${open} ${open === 1 ? "edge is" : "edges are"} longer than the resolution, the longest ${number(100 * longest, 2)} % of an axis`;
  return added
    ? `${edges}. ${added} ${added === 1 ? "point is" : "points are"} added.`
    : `${edges}. The points between have no results yet.`;
}

/** A labelled field for a number. @param {string} text @param {Record<string, number | string>} attributes */
function numberBox(text, attributes) {
  const input = h("input", { type: "number", style: "width:6rem", ...attributes });
  return {
    element: h("label", { class: "field" }, h("span", {}, text), input),
    value: () => Number(input.value),
  };
}
