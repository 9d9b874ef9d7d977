// All swept parameters and a few results side by side, a line a point.

import { say, shown, unit } from "../data/units.js";
import { canvas, colourBar, draw, laidOut, lineScale } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { link, rounded } from "../ui/router.js";
import { axisNames } from "./axis-names.js";
import { axisControls } from "./parallel-controls.js";
import { followLines, isKept, rangesOf } from "./parallel-lines.js";
import { preferred, undelayed } from "./part.js";

const HOW =
  "Drag along an axis, or enter a range below, to filter the points. Drag an axis by its name, or use the buttons below, to move it. Point at a line to read its values.";

/** Form of the numbers at axes: no letters for powers of a thousand, since units have their own. */
const TICKS = ".4~r";
/** Least number whose thousands are apart. */
const FIVE_DIGITS = 1e4;

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
  #place = canvas("Parallel coordinates of the sweep", "parallel", "tall", "whole");
  /** On a narrow screen the picture is scrolled sideways. */
  #scroller = h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": "Parallel coordinates, scrollable" },
    this.#place,
  );
  #caption = h("figcaption", {});
  #reading = h("p", { class: "small", role: "status", "aria-label": "The point that the mouse is at" });
  #left = h("p", { class: "small", role: "status", "aria-label": "Points that are kept" });
  #controls = h("div", { class: "controls" });
  #fields = axisControls(
    (name, ranges) => this.#filter(name, ranges),
    (name, places) => this.#move(name, places),
  );
  #begin = generations();
  /** Reads the point of a line. @type {(line: number) => void} */
  #readLine = () => {};

  /** @param {Context} context */
  constructor(context) {
    this.#context = context;
    followLines(this.#place, (line) => this.#readLine(line), context.signal);
    this.element = h(
      "div",
      {},
      this.#controls,
      h("figure", {}, this.#scroller, this.#reading, this.#left, this.#caption),
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
    const named = axisNames(
      names.map((name) => depths.title(name)),
      this.#scroller.clientWidth,
    );
    this.#place.style.minWidth = `${named.width}px`;
    const dimensions = this.#dimensions(names, columns, rows).map((dimension, order) => ({
      ...dimension,
      label: named.labels[order],
    }));
    fill(
      this.#caption,
      HOW,
      [...new Set([beside, colour])].map(
        (name) => biases.say(name) && ` ${depths.label(name)}: ${biases.say(name)}`,
      ),
    );
    const line = {
      color: dimensions[names.indexOf(colour)].values,
      colorscale: lineScale(),
      colorbar: colourBar(depths.title(colour)),
    };
    const trace = {
      type: "parcoords",
      dimensions,
      line,
      labelside: named.side,
      labelfont: { size: 12 },
    };
    const shape = await draw(this.#place, [trace], { margin: named.margin }, signal);
    this.#readLine = (number) =>
      this.#read(
        Number(ordinals[rows[number]]),
        names,
        columns.map((column) => column[rows[number]]),
      );
    this.#tell(dimensions);
    this.#follow(shape);
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
    );
    return { colour, beside };
  }

  /**
   * @param {string[]} names
   * @param {import("../data/sweep-table.js").Values[]} columns
   * @param {number[]} rows that have all values
   */
  #dimensions(names, columns, rows) {
    const kept = brushed(this.#context.query.get("brush") ?? "");
    return names.map((name, order) => {
      const values = /** @type {number[]} */ (
        shown(
          name,
          rows.map((index) => /** @type {number} */ (columns[order][index])),
        )
      );
      const ranges = kept.get(name)?.map((range) => range.map((end) => end / unit(name).size));
      return {
        name,
        tickformat: values.some((value) => Math.abs(value) >= FIVE_DIGITS) ? `,${TICKS}` : TICKS,
        constraintrange: ranges && closed({ name, values, constraintrange: ranges }),
        values,
      };
    });
  }

  /** Takes filters and the order of axes from the picture when the reader drags there. @param {any} shape */
  #follow(shape) {
    shape.removeAllListeners?.("plotly_restyle");
    shape.on?.("plotly_restyle", () => {
      /** @type {Dimension[]} */
      const dimensions = shape.data[0].dimensions;
      this.#context.keep({
        brush: written(dimensions) || null,
        ...this.#inLink(dimensions.map(({ name }) => name)),
      });
      this.#tell(dimensions);
    });
  }

  /** Shows the filters of the picture as numbers, and how many points pass them. @param {Dimension[]} dimensions */
  #tell(dimensions) {
    this.#fields.show(
      dimensions.map((dimension) => ({
        name: dimension.name,
        title: this.#context.depths.title(dimension.name),
        ends: endsOf(dimension),
        ranges: opened(dimension),
      })),
    );
    const filters = dimensions.filter((dimension) => rangesOf(dimension).length);
    const all = dimensions[0].values.length;
    const kept = dimensions[0].values.filter((_, line) =>
      filters.every((dimension) => isKept(dimension, line)),
    ).length;
    this.#left.textContent = filters.length ? `${kept} of ${all} points are kept.` : "";
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

/** The same of a picture. @param {import("./parallel-lines.js").Dimension[]} dimensions */
function written(dimensions) {
  return dimensions
    .flatMap((dimension) => opened(dimension).map((range) => writtenRange(dimension.name, range)))
    .join(",");
}

/** @param {string} name @param {number[]} range in the unit in which it is shown */
function writtenRange(name, range) {
  return [name, ...range.map((end) => (Number.isFinite(end) ? rounded(end * unit(name).size) : ""))].join(
    ":",
  );
}

/** Least and largest value of an axis. @param {import("./parallel-lines.js").Dimension} dimension */
function endsOf({ values }) {
  return [
    values.reduce((a, b) => Math.min(a, b), Infinity),
    values.reduce((a, b) => Math.max(a, b), -Infinity),
  ];
}

/** Filters of an axis, whose ends are infinite at or beyond the ends of its values, and then need not be written. @param {import("./parallel-lines.js").Dimension} dimension */
function opened(dimension) {
  const [least, largest] = endsOf(dimension);
  const ranges = rangesOf(dimension).map(([from, to]) => [
    from <= least ? -Infinity : from,
    to >= largest ? Infinity : to,
  ]);
  return ranges.filter((range) => range.some(Number.isFinite));
}

/** The same with finite ends, as the drawing library needs them. @param {import("./parallel-lines.js").Dimension} dimension */
function closed(dimension) {
  const [least, largest] = endsOf(dimension);
  return rangesOf(dimension).map(([from, to]) => [
    from === -Infinity ? Math.min(least, to) : from,
    to === Infinity ? Math.max(largest, from) : to,
  ]);
}
