// All swept parameters and a few results side by side, a line a point.

import { say, shown, unit } from "../data/units.js";
import { laidOut } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { link, rounded } from "../ui/router.js";
import { axisControls } from "./parallel-controls.js";
import { endsOf, keptLines } from "./parallel-lines.js";
import { ParallelPicture } from "./parallel-picture.js";
import { preferred, undelayed } from "./part.js";

const HOW =
  "Drag along an axis, or enter a range below, to filter the points; drag a filter or its ends to change it, and click it to remove it. Drag an axis by its name, or use the buttons below, to move it. Point at a line, or move the point cursor, to read its values.";

/** @typedef {import("./part.js").Context} Context */
/** @typedef {import("./parallel-lines.js").Dimension} Dimension */

/**
 * Dragging along an axis filters the points to the range that was dragged over.
 * @param {Context} context
 * @returns {import("./part.js").Part}
 */
export function parallel(context) {
  const coordinates = new ParallelCoordinates(context);
  return {
    element: coordinates.element,
    draw: undelayed(() => coordinates.redraw(), context),
    fields: () => ["ordinal", ...usualNames(context)],
  };
}

/** Columns that can be chosen, and the chosen ones. @param {Context} context */
function chosenIn({ table, axes, query }) {
  const results = table.results().filter((name) => !axes.includes(name) && name !== "state");
  const colour = results.includes(query.get("colour") ?? "")
    ? (query.get("colour") ?? "")
    : preferred(results);
  const first = results.find((name) => name === "friction_coefficient_max") ?? colour;
  const beside = results.includes(query.get("beside") ?? "") ? (query.get("beside") ?? "") : first;
  return { results, colour, beside };
}

/** Names of the axes in their usual order. @param {Context} context */
function usualNames(context) {
  const { colour, beside } = chosenIn(context);
  return [...new Set([...context.axes, beside, colour])];
}

class ParallelCoordinates {
  #context;
  #picture;
  /** On a narrow screen the picture is scrolled sideways. */
  #scroller;
  #caption = h("figcaption", {});
  #reading = h("p", { class: "small", role: "status", "aria-label": "The point that is read" });
  #left = h("p", { class: "small", role: "status", "aria-label": "Points that are kept" });
  #controls = h("div", { class: "controls" });
  #cursor = h("input", {
    type: "range",
    min: 0,
    max: 0,
    step: 1,
    value: "0",
    "aria-label": "Point cursor",
    onfocus: () => this.#moveCursor(),
    oninput: () => this.#moveCursor(),
  });
  #fields = axisControls(
    (name, ranges) => this.#filter(name, ranges),
    (name, places) => this.#move(name, places),
  );
  #begin = generations();
  /** @type {Dimension[]} */
  #dimensions = [];
  /** Reads the point of a line. @type {(line: number) => void} */
  #readLine = () => {};

  /** @param {Context} context */
  constructor(context) {
    this.#context = context;
    this.#picture = new ParallelPicture(
      {
        filtered: () => this.#describe(),
        released: () =>
          context.keep({
            brush:
              this.#dimensions
                .flatMap(({ name, ranges }) => ranges.map((range) => writtenRange(name, range)))
                .join(",") || null,
          }),
        moved: (names) => this.#keep(this.#inLink(names)),
        read: (line) => this.#readLine(line),
      },
      context.signal,
    );
    this.#scroller = h(
      "div",
      { class: "scroll", tabindex: "0", role: "region", "aria-label": "Parallel coordinates, scrollable" },
      this.#picture.element,
    );
    const cursor = h(
      "label",
      { class: "field wide" },
      h("span", {}, "Point cursor: arrow keys move it over the points that are kept"),
      this.#cursor,
    );
    this.element = h(
      "div",
      {},
      this.#controls,
      h("figure", {}, this.#scroller, this.#reading, this.#left, this.#caption),
      cursor,
      this.#fields.element,
    );
  }

  /** Keeps choices in the link and draws by them. @param {Record<string, string | null>} choices */
  #keep(choices) {
    this.#context.keep(choices);
    attend(this.redraw(), this.#context.signal);
  }

  /** Filters the points by ranges of an axis. @param {string} name @param {number[][]} ranges */
  #filter(name, ranges) {
    const others = (this.#context.query.get("brush") ?? "")
      .split(",")
      .filter((part) => part && part.split(":")[0] !== name);
    this.#keep({ brush: [...others, ...ranges.map((range) => writtenRange(name, range))].join(",") || null });
  }

  /** Moves an axis. @param {string} name @param {number} places */
  #move(name, places) {
    const names = this.#namesInOrder();
    const at = names.indexOf(name);
    const to = at + places;
    // Pressed again before it is redrawn, a button may lead beyond the end of the row.
    if (!names[to]) return;
    [names[at], names[to]] = [names[to], name];
    this.#keep(this.#inLink(names));
  }

  /** Names of the axes in the order of the link. */
  #namesInOrder() {
    const usual = usualNames(this.#context);
    const moved = (this.#context.query.get("order") ?? "").split(",").filter((name) => usual.includes(name));
    return [...new Set([...moved, ...usual])];
  }

  /** An order as the link holds it, which leaves the usual one out. @param {string[]} names */
  #inLink(names) {
    const order = names.join(",");
    return { order: order === usualNames(this.#context).join(",") ? null : order };
  }

  async redraw() {
    const isNewest = this.#begin();
    const { table, biases, depths, signal } = this.#context;
    const { colour, beside } = this.#drawControls();
    const names = this.#namesInOrder();
    const [ordinals, ...columns] = await table.columns("ordinal", ...names);
    if (!isNewest()) return;
    const rows = columns[0]
      .map((_, index) => index)
      .filter((index) => columns.every((column) => typeof column[index] === "number"));
    if (!rows.length) {
      fill(this.#caption, "No point has all of these values yet.");
      return;
    }
    await laidOut(this.#scroller, signal);
    if (!isNewest()) return;
    this.#dimensions = this.#dimensionsOf(names, columns, rows);
    fill(
      this.#caption,
      HOW,
      [...new Set([beside, colour])].map(
        (name) => biases.say(name) && ` ${depths.label(name)}: ${biases.say(name)}`,
      ),
    );
    this.#readLine = (line) =>
      this.#read(
        Number(ordinals[rows[line]]),
        names,
        columns.map((column) => column[rows[line]]),
      );
    this.#picture.show(this.#dimensions, names.indexOf(colour));
    this.#describe();
  }

  #drawControls() {
    const { results, colour, beside } = chosenIn(this.#context);
    const options = results.map(
      (name) => /** @type {[string, string]} */ ([name, this.#context.depths.label(name)]),
    );
    fill(
      this.#controls,
      choice("Colour and last axis", options, colour, (value) => this.#keep({ colour: value })),
      choice("Further axis", options, beside, (value) => this.#keep({ beside: value })),
      /** @type {("png" | "svg")[]} */ (["png", "svg"]).map((format) => {
        const save = () => attend(this.#picture.save(format), this.#context.signal);
        return h("button", { onclick: save }, `Save as ${format.toUpperCase()}`);
      }),
    );
    return { colour, beside };
  }

  /**
   * @param {string[]} names
   * @param {import("../data/sweep-table.js").Values[]} columns
   * @param {number[]} rows that have all values
   * @returns {Dimension[]}
   */
  #dimensionsOf(names, columns, rows) {
    const kept = brushed(this.#context.query.get("brush") ?? "");
    return names.map((name, order) => ({
      name,
      title: this.#context.depths.title(name),
      values: /** @type {number[]} */ (
        shown(
          name,
          rows.map((index) => /** @type {number} */ (columns[order][index])),
        )
      ),
      ranges: (kept.get(name) ?? []).map((range) => range.map((end) => end / unit(name).size)),
    }));
  }

  /** Shows the filters as numbers, and how many points pass them. */
  #describe() {
    const dimensions = this.#dimensions;
    this.#fields.show(dimensions.map((dimension) => ({ ...dimension, ends: endsOf(dimension) })));
    const kept = keptLines(dimensions).length;
    const isFiltered = dimensions.some(({ ranges }) => ranges.length);
    this.#left.textContent = isFiltered ? `${kept} of ${dimensions[0].values.length} points are kept.` : "";
    this.#cursor.max = String(Math.max(0, kept - 1));
    this.#cursor.disabled = !kept;
  }

  /** Marks and reads the point of the cursor. */
  #moveCursor() {
    const line = keptLines(this.#dimensions)[this.#cursor.valueAsNumber];
    if (line === undefined) return;
    this.#picture.mark(line);
    this.#readLine(line);
    this.#cursor.setAttribute("aria-valuetext", this.#reading.textContent ?? "");
  }

  /** Shows the point of a line. @param {number} ordinal @param {string[]} names @param {unknown[]} values */
  #read(ordinal, names, values) {
    const { sweep, biases, depths } = this.#context;
    const words = names.map(
      (name, order) => `${depths.label(name)} ${say(name, values[order])}${biases.beside(name, ordinal)}`,
    );
    fill(
      this.#reading,
      h("a", { href: link(["sweeps", sweep.id, "points", String(ordinal)]) }, `Point ${ordinal}`),
      `: ${words.join(" · ")}`,
    );
  }
}

/**
 * Filters of axes, as the link holds them in the service's units: `flow_rate:0.01:0.02,mud_density::1500`.
 * @param {string} text
 * @returns {Map<string, number[][]>} by column; an end that is not given is infinite
 */
function brushed(text) {
  /** @type {Map<string, number[][]>} */
  const kept = new Map();
  for (const part of text.split(",")) {
    const [name, ...ends] = part.split(":");
    const range = ends.map((end, index) => (end ? Number(end) : index ? Infinity : -Infinity));
    if (range.length === 2 && !range.some(Number.isNaN)) kept.set(name, [...(kept.get(name) ?? []), range]);
  }
  return kept;
}

/** @param {string} name @param {number[]} range in the unit in which it is shown */
function writtenRange(name, range) {
  return [name, ...range.map((end) => (Number.isFinite(end) ? rounded(end * unit(name).size) : ""))].join(
    ":",
  );
}
