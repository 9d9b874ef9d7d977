// All swept parameters and a few results side by side, a line a point.

import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { axisControls } from "./parallel-controls.js";
import { followLines, isKept, rangesOf } from "./parallel-lines.js";
import { canvas, colourBar, draw, lineScale } from "../draw/plots.js";
import { link, rounded } from "../ui/router.js";
import { preferred, undelayed } from "./part.js";
import { label, say, shown, title, unit } from "../data/units.js";

const HOW =
  "Drag along an axis, or give the ends of a stretch below, to keep the points that pass there; drag an axis by its name, or use the buttons below, to move it. Point at a line to read its values.";

/**
 * Dragging along an axis keeps what passes there.
 * @param {import("./part.js").Context} context
 * @returns {import("./part.js").Part}
 */
export function parallel(context) {
  const { table, axes, query } = context;
  const place = canvas("Parallel coordinates of the sweep", "parallel", "tall", "whole");
  const caption = h("figcaption", {});
  const reading = h("p", { class: "small", role: "status", "aria-label": "The point that the mouse is at" });
  const left = h("p", { class: "small", role: "status", "aria-label": "Points that are kept" });
  const controls = h("div", { class: "controls" });
  const begin = generations();

  function chosen() {
    const results = table.results().filter((name) => !axes.includes(name) && name !== "state");
    const colour = results.includes(query.get("colour") ?? "")
      ? (query.get("colour") ?? "")
      : preferred(results);
    const first = results.find((name) => name === "friction_coefficient_max") ?? colour;
    const beside = results.includes(query.get("beside") ?? "") ? (query.get("beside") ?? "") : first;
    return { results, colour, beside };
  }

  /** Says what a line of the picture is of. @type {(line: number) => void} */
  let toldOf = () => {};
  followLines(place, (line) => toldOf(line), context.signal);

  const fields = axisControls(
    (name, ranges) => {
      const others = (query.get("brush") ?? "")
        .split(",")
        .filter((part) => part && part.split(":")[0] !== name);
      context.keep({
        brush: [...others, ...ranges.map((range) => writtenRange(name, range))].join(",") || null,
      });
      attend(redraw(), context.signal);
    },
    (name, places) => {
      const names = namesInOrder();
      const at = names.indexOf(name);
      const to = at + places;
      // Pressed again before it is redrawn, a button may lead beyond the end of the row.
      if (!names[to]) return;
      [names[at], names[to]] = [names[to], name];
      context.keep(inLink(names));
      attend(redraw(), context.signal);
    },
  );

  /** The axes' names in their usual order. */
  function usualNames() {
    const { colour, beside } = chosen();
    return [...new Set([...axes, beside, colour])];
  }

  /** The same in the order of the link. */
  function namesInOrder() {
    const usual = usualNames();
    const moved = (query.get("order") ?? "").split(",").filter((name) => usual.includes(name));
    return [...new Set([...moved, ...usual])];
  }

  /** An order as the link holds it; the usual one it does not. @param {string[]} names */
  function inLink(names) {
    const order = names.join(",");
    return { order: order === usualNames().join(",") ? null : order };
  }

  /** Says to which stretches points are kept in the picture, and how many are. @param {import("./parallel-lines.js").Dimension[]} dimensions */
  function tell(dimensions) {
    fields.show(
      dimensions.map((dimension) => ({
        name: dimension.name,
        ends: endsOf(dimension),
        ranges: opened(dimension),
      })),
    );
    const filters = dimensions.filter((dimension) => rangesOf(dimension).length);
    const all = dimensions[0].values.length;
    const kept = dimensions[0].values.filter((_, line) =>
      filters.every((dimension) => isKept(dimension, line)),
    ).length;
    left.textContent = filters.length ? `${kept} of ${all} points are kept.` : "";
  }

  async function redraw() {
    const isNewest = begin();
    const { results, colour, beside } = chosen();
    const set = (/** @type {string} */ key) => (/** @type {string} */ value) => {
      context.keep({ [key]: value });
      attend(redraw(), context.signal);
    };
    const options = results.map((name) => /** @type {[string, string]} */ ([name, label(name)]));
    fill(
      controls,
      choice("Colour and last axis", options, colour, set("colour")),
      choice("Further axis", options, beside, set("beside")),
    );
    const names = namesInOrder();
    const [ordinals, ...columns] = await table.columns("ordinal", ...names);
    if (!isNewest()) return;
    const rows = columns[0]
      .map((_, index) => index)
      .filter((index) => columns.every((column) => typeof column[index] === "number"));
    if (!rows.length) {
      fill(caption, "No point has all of these values yet.");
      return;
    }
    const kept = brushed(query.get("brush") ?? "");
    const dimensions = names.map((name, order) => {
      const values = /** @type {number[]} */ (
        shown(
          name,
          rows.map((index) => /** @type {number} */ (columns[order][index])),
        )
      );
      const ranges = kept.get(name)?.map((range) => range.map((end) => end / unit(name).size));
      return {
        name,
        label: title(name),
        constraintrange: ranges && closed({ name, values, constraintrange: ranges }),
        values,
      };
    });
    const last = dimensions[names.indexOf(colour)];
    fill(
      caption,
      HOW,
      [...new Set([beside, colour])].map(
        (name) => context.biases.say(name) && ` ${label(name)}: ${context.biases.say(name)}`,
      ),
    );
    const shape = await draw(
      place,
      [
        {
          type: "parcoords",
          dimensions,
          line: { color: last.values, colorscale: lineScale(), colorbar: colourBar(title(colour)) },
          labelangle: dimensions.length > 4 ? -12 : 0,
          labelfont: { size: 12 },
        },
      ],
      { margin: { l: 80, r: 60, t: 70, b: 30 } },
      context.signal,
    );
    toldOf = (line) =>
      read(
        Number(ordinals[rows[line]]),
        names,
        columns.map((column) => column[rows[line]]),
      );
    tell(dimensions);
    shape.removeAllListeners?.("plotly_restyle");
    shape.on?.("plotly_restyle", () => {
      const { dimensions } = shape.data[0];
      context.keep({
        brush: written(dimensions) || null,
        ...inLink(dimensions.map((/** @type {{name: string}} */ { name }) => name)),
      });
      tell(dimensions);
    });
  }

  /** Says which point a line is of. @param {number} ordinal @param {string[]} names @param {unknown[]} values */
  function read(ordinal, names, values) {
    const words = names.map(
      (name, order) => `${label(name)} ${say(name, values[order])}${context.biases.beside(name, ordinal)}`,
    );
    fill(
      reading,
      h("a", { href: link(["sweeps", context.sweep.id, "points", String(ordinal)]) }, `Point ${ordinal}`),
      `: ${words.join(" · ")}`,
    );
  }

  return {
    element: h("div", {}, controls, h("figure", {}, place, reading, left, caption), fields.element),
    draw: undelayed(redraw, context),
    fields: () => ["ordinal", ...usualNames()],
  };
}

/**
 * The stretches of axes to which points are kept, as the link has them in the service's units: `flow_rate:0.01:0.02,mud_density::1500`.
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

/** The least and the largest value of an axis. @param {import("./parallel-lines.js").Dimension} dimension */
function endsOf({ values }) {
  return [
    values.reduce((a, b) => Math.min(a, b), Infinity),
    values.reduce((a, b) => Math.max(a, b), -Infinity),
  ];
}

/** The stretches of an axis whose ends are infinite where they are at or beyond those of the values, which so need not be written. @param {import("./parallel-lines.js").Dimension} dimension */
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
