// All swept parameters and a few results side by side, a line a point.

import { choice, fill, h } from "./dom.js";
import { works } from "./newest.js";
import { attend } from "./notices.js";
import { followLines } from "./parallel-lines.js";
import { canvas, colourBar, draw, lineScale } from "./plots.js";
import { link } from "./router.js";
import { preferred, undelayed } from "./sweep-map.js";
import { label, say, shown, title, unit } from "./units.js";

const HOW = "Drag along an axis to keep the points that pass there; drag an axis by its name to move it. Point at a line to read its values.";

/**
 * Dragging along an axis keeps what passes there.
 * @param {import("./sweep.js").Context} context
 * @returns {import("./sweep.js").Part}
 */
export function parallel(context) {
  const { table, axes, query } = context;
  const place = canvas("Parallel coordinates of the sweep", "parallel", "tall", "whole");
  const caption = h("figcaption", {});
  const reading = h("p", { class: "small", role: "status", "aria-label": "The point that the mouse is at" });
  const controls = h("div", { class: "controls" });
  const begin = works();

  function chosen() {
    const results = table.results().filter((name) => !axes.includes(name) && name !== "state");
    const colour = results.includes(query.get("colour") ?? "") ? (query.get("colour") ?? "") : preferred(results);
    const first = results.find((name) => name === "friction_coefficient_max") ?? colour;
    const beside = results.includes(query.get("beside") ?? "") ? (query.get("beside") ?? "") : first;
    return { results, colour, beside };
  }

  /** Says what a line of the picture is of. @type {(line: number) => void} */
  let toldOf = () => {};
  followLines(place, (line) => toldOf(line), context.signal);

  async function redraw() {
    const isNewest = begin();
    const { results, colour, beside } = chosen();
    const set = (/** @type {string} */ key) => (/** @type {string} */ value) => {
      context.keep({ [key]: value });
      attend(redraw(), context.signal);
    };
    const options = results.map((name) => /** @type {[string, string]} */ ([name, label(name)]));
    fill(controls, choice("Colour and last axis", options, colour, set("colour")), choice("Further axis", options, beside, set("beside")));
    const usual = [...new Set([...axes, beside, colour])];
    const moved = (query.get("order") ?? "").split(",").filter((name) => usual.includes(name));
    const names = [...new Set([...moved, ...usual])];
    const [ordinals, ...columns] = await table.columns("ordinal", ...names);
    if (!isNewest()) return;
    const rows = columns[0].map((_, index) => index).filter((index) => columns.every((column) => typeof column[index] === "number"));
    if (!rows.length) {
      fill(caption, "No point has all of these values yet.");
      return;
    }
    const kept = brushed(query.get("brush") ?? "");
    const dimensions = names.map((name, order) => ({ name, label: title(name), constraintrange: kept.get(name)?.map((range) => range.map((end) => end / unit(name).size)), values: shown(name, rows.map((index) => /** @type {number} */ (columns[order][index]))) }));
    const last = dimensions[names.indexOf(colour)];
    fill(caption, HOW, [...new Set([beside, colour])].map((name) => context.biases.say(name) && ` ${label(name)}: ${context.biases.say(name)}`));
    const shape = await draw(place, [{ type: "parcoords", dimensions, line: { color: last.values, colorscale: lineScale(), colorbar: colourBar(title(colour)) }, labelangle: dimensions.length > 4 ? -12 : 0, labelfont: { size: 12 } }], { margin: { l: 80, r: 60, t: 70, b: 30 } }, context.signal);
    toldOf = (line) => read(Number(ordinals[rows[line]]), names, columns.map((column) => column[rows[line]]));
    shape.removeAllListeners?.("plotly_restyle");
    shape.on?.("plotly_restyle", () => {
      const { dimensions } = shape.data[0];
      const order = dimensions.map((/** @type {{name: string}} */ { name }) => name).join(",");
      context.keep({ brush: written(dimensions) || null, order: order === usual.join(",") ? null : order });
    });
  }

  /** Says which point a line is of. @param {number} ordinal @param {string[]} names @param {unknown[]} values */
  function read(ordinal, names, values) {
    const words = names.map((name, order) => `${label(name)} ${say(name, values[order])}${context.biases.beside(name, ordinal)}`);
    fill(reading, h("a", { href: link(["sweeps", context.sweep.id, "points", String(ordinal)]) }, `Point ${ordinal}`), `: ${words.join(" · ")}`);
  }

  return {
    element: h("div", {}, controls, h("figure", {}, place, reading, caption)),
    draw: undelayed(redraw, context),
    fields: () => {
      const { colour, beside } = chosen();
      return [...new Set(["ordinal", ...axes, beside, colour])];
    },
  };
}

/**
 * The stretches of axes to which points are kept, as the link has them in the service's units: `flow_rate:0.01:0.02,mud_density:1200:1500`.
 * @param {string} text
 * @returns {Map<string, number[][]>} by column
 */
function brushed(text) {
  /** @type {Map<string, number[][]>} */
  const kept = new Map();
  for (const part of text.split(",")) {
    const [name, ...ends] = part.split(":");
    const range = ends.map(Number);
    if (range.length === 2 && range.every(Number.isFinite)) kept.set(name, [...(kept.get(name) ?? []), range]);
  }
  return kept;
}

/** The same of a picture. @param {any[]} dimensions */
function written(dimensions) {
  return dimensions.flatMap(({ name, constraintrange }) => {
    const ranges = constraintrange?.length ? (Array.isArray(constraintrange[0]) ? constraintrange : [constraintrange]) : [];
    return ranges.map((/** @type {number[]} */ range) => [name, ...range.map((end) => Number((end * unit(name).size).toPrecision(7)))].join(":"));
  }).join(",");
}
