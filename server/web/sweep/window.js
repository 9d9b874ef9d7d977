// Operating window of a sweep: the class of each point over the parameters, by limits that the reader moves.

import { get, Problem } from "../data/api.js";
import { classes, classWords } from "../data/judgement.js";
import { changedLimits, limitsText, parseLimits } from "../data/limits.js";
import { classWord } from "../draw/class-word.js";
import { debounced, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { link } from "../ui/router.js";
import { python, tableLines } from "../ui/snippets.js";
import { CLASS } from "./categories.js";
import { LimitInputs } from "./limit-inputs.js";
import { SweepMap } from "./map.js";
import { OperatingPoint } from "./operating-point.js";
import { undelayed } from "./part.js";
import { RefineEdges } from "./refine-edges.js";

/** Time without a change after which points are judged anew [ms]. */
const REST_MS = 250;
/** Uncertain points that are listed, at most. */
const LISTED = 100;

/** @typedef {import("./part.js").Context} Context */

/**
 * @param {Context} context
 * @returns {import("./part.js").Part}
 */
export function operatingWindow(context) {
  const shown = new OperatingWindow(context);
  return {
    element: shown.element,
    draw: () => shown.redraw(),
    fields: () => ["ordinal", ...context.axes, CLASS],
    lines: () => shown.lines(),
  };
}

class OperatingWindow {
  #context;
  #path;
  #begin = generations();
  #inputs;
  #drawMap;
  #point;
  #wrong = h("p", { class: "wrong", role: "alert" });
  #counts = h("ul", { class: "counts", "aria-label": "Points by class" });
  #uncertain = h("div", {});
  #links = h("div", { class: "controls" });
  /** Limits without changes; null until they are known. @type {Record<string, number> | null} */
  #defaults = null;
  /** Class of each point, and the reason for which it is uncertain, by ordinal. @type {Map<number, {word: string | null, doubt: string}>} */
  #points = new Map();

  /** @param {Context} context */
  constructor(context) {
    this.#context = context;
    this.#path = `/v1/sweeps/${encodeURIComponent(context.sweep.id)}/window`;
    const judge = () => {
      context.keep({ limits: this.#changes || null });
      attend(this.redraw(), context.signal);
    };
    this.#inputs = new LimitInputs(
      (column) => context.depths.label(column),
      debounced(judge, REST_MS, context.signal),
    );
    const map = new SweepMap(context, {
      name: CLASS,
      wordOf: (ordinal) => this.#points.get(ordinal)?.word ?? null,
      doubtOf: (ordinal) => this.#points.get(ordinal)?.doubt ?? "",
    });
    const draw = async () => {
      await map.redraw();
      await this.#point.redraw((ordinal) => this.#points.get(ordinal));
    };
    this.#point = new OperatingPoint(
      context,
      /** @type {HTMLElement} */ (map.element.querySelector(".plot")),
      () => attend(draw(), context.signal),
    );
    this.#drawMap = undelayed(draw, context);
    this.element = h(
      "div",
      {},
      this.#inputs.element,
      this.#wrong,
      this.#counts,
      map.element,
      this.#point.element,
      new RefineEdges(context, () => this.#changes).element,
      this.#uncertain,
      this.#links,
    );
  }

  /** Changes of the default limits, for a request. */
  get #changes() {
    return this.#defaults
      ? limitsText(this.#inputs.limits, this.#defaults)
      : (this.#context.query.get("limits") ?? "");
  }

  async redraw() {
    const isNewest = this.#begin();
    try {
      const window = await this.#judged();
      if (!isNewest()) return;
      this.#wrong.textContent = "";
      this.#take(window);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (isNewest()) this.#wrong.textContent = error.errors[0]?.detail ?? error.message;
    }
    await this.#drawMap();
  }

  /** The window by the limits that are chosen; at first with the limits without changes. @returns {Promise<any>} */
  async #judged() {
    const { signal } = this.#context;
    const judged = (/** @type {string} */ limits) => get(this.#path, { format: "json", limits }, signal);
    if (this.#defaults) return judged(this.#changes);
    const asked = this.#changes;
    const usual = await judged("");
    this.#defaults = /** @type {Record<string, number>} */ (usual.attributes.limits);
    this.#inputs.show(this.#defaults, parseLimits(asked));
    return asked ? judged(asked) : usual;
  }

  /** @param {any} window */
  #take({ columns, attributes }) {
    const ordinals = /** @type {number[]} */ (columns.ordinal);
    this.#points = new Map(
      ordinals.map((ordinal, row) => [
        ordinal,
        { word: columns.class[row], doubt: classWords(columns.class_uncertain[row] ?? "") },
      ]),
    );
    const counts = /** @type {Record<string, number>} */ (attributes.points_by_class);
    const known = classes().map(({ word }) => word);
    const judged = known.reduce((sum, name) => sum + (counts[name] ?? 0), 0);
    fill(
      this.#counts,
      known.filter((name) => counts[name]).map((name) => h("li", {}, classWord(name), ` ${counts[name]}`)),
      judged < ordinals.length && h("li", {}, `without a result ${ordinals.length - judged}`),
    );
    this.#listUncertain();
    const query = { limits: this.#changes };
    const to = (/** @type {string} */ format) => preload.address(this.#path, { format, ...query });
    fill(
      this.#links,
      h("a", { class: "button", href: to("svg") }, "Picture (SVG)"),
      h("a", { class: "button", href: to("json") }, "Table (JSON)"),
    );
  }

  #listUncertain() {
    const { sweep } = this.#context;
    const doubtful = [...this.#points].filter(([, { doubt }]) => doubt);
    const items = doubtful
      .slice(0, LISTED)
      .map(([ordinal, { word, doubt }]) =>
        h(
          "li",
          { title: doubt },
          h("a", { href: link(["sweeps", sweep.id, "points", String(ordinal)]) }, `point ${ordinal}`),
          ` ${classWords(word ?? "")}: ${doubt}`,
        ),
      );
    const rest = doubtful.length - items.length;
    fill(
      this.#uncertain,
      items.length > 0 &&
        h(
          "details",
          {},
          h(
            "summary",
            {},
            `${doubtful.length} uncertain ${doubtful.length === 1 ? "point" : "points"}, marked by a cross`,
          ),
          h("ul", {}, items),
          rest > 0 && h("p", { class: "soft" }, `${rest} more are not listed.`),
        ),
    );
  }

  /** @returns {import("../ui/snippets.js").Lines} */
  lines() {
    const changes = changedLimits(this.#inputs.limits, this.#defaults ?? {});
    const given = Object.keys(changes).length ? python(changes) : "";
    const client = `from drillsweep import Client\n\nclient = Client("${location.origin}")\n`;
    return tableLines(
      this.#path,
      { limits: this.#changes },
      `${client}window = client.sweep("${this.#context.sweep.id}").window(${given})\ntable = window.to_pandas()\nprint(table)`,
    );
  }
}
