// The well in space with the string in it at rest, coloured by a quantity.

import { label, say, shown, title, unit } from "../data/units.js";
import { nodeFrames } from "../data/well-frames.js";
import { canvas, colourBar, draw, inks, lineScale } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { pythonColumns, QUANTITIES, tableOf } from "./profiles.js";

/** Factors by which the string's distance from the axis of the hole is multiplied. */
const EXAGGERATIONS = ["1", "20", "100", "300"];
const USUAL = 20;

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function well(context) {
  const { query } = context;
  const place = canvas("The well and the string in it", "well", "tall", "whole");
  const controls = h("div", { class: "controls" });
  const caption = h("figcaption", {});
  const colour = () =>
    QUANTITIES.some(([name]) => name === query.get("colour")) ? (query.get("colour") ?? "") : "normal_force";
  const factor = () => exaggeration(query, USUAL);
  const begin = generations();
  const set = (/** @type {string} */ key) => (/** @type {string} */ value) => {
    context.keep({ [key]: value });
    attend(redraw(), context.signal);
  };

  async function redraw() {
    const isNewest = begin();
    const name = colour();
    fill(
      controls,
      choice(
        "Colour",
        QUANTITIES.map(([entry]) => [entry, label(entry)]),
        name,
        set("colour"),
      ),
      exaggerationChoice(factor(), set("exaggerate")),
    );
    const statics = (await context.table("statics")).columns;
    const table = tableOf(name) === "statics" ? statics : (await context.table(tableOf(name))).columns;
    if (!isNewest()) return;
    const values = onNodes(table, name, statics.measured_depth.length);
    fill(
      caption,
      `${saysExaggeration("The string at rest; its", factor())} The thin grey line is the axis of the hole. Drag to turn, scroll to zoom.`,
    );
    await draw(
      place,
      wellTraces(statics, name, values, factor()),
      { showlegend: false, ...spaceLayout(statics) },
      context.signal,
    );
  }

  return {
    element: h("div", {}, controls, h("figure", {}, place, caption)),
    draw: redraw,
    request: () => requestOf(colour()),
  };
}

/** Requests behind the well. @param {string} name of the quantity that colours the string @returns {import("./part.js").PartRequest} */
function requestOf(name) {
  const table = tableOf(name);
  const space = ["measured_depth", "north", "east", "true_vertical_depth", "u", "v"];
  const statics = [...space, ...(table === "statics" ? [name] : [])];
  const depth = table === "profile" ? ["measured_depth_top", "measured_depth_bottom"] : ["measured_depth"];
  const asked = [
    { table: "statics", query: { fields: [...new Set(statics)].join(",") } },
    ...(table === "statics" ? [] : [{ table, query: { fields: [...depth, name].join(",") } }]),
  ];
  return {
    asked,
    python: asked.map((one) => pythonColumns(one.table, one.query.fields.split(","))).join("\n"),
  };
}

/**
 * Axis of the hole and the string, coloured by values at its nodes.
 * @param {any} statics columns of the table
 * @param {string} name of the values
 * @param {(number | null)[]} values
 * @param {number} factor by which the distance from the axis is multiplied
 */
function wellTraces(statics, name, values, factor) {
  const axis = { north: statics.north, east: statics.east, down: statics.true_vertical_depth };
  const line = (/** @type {typeof axis} */ path) => ({
    x: shown("east", path.east),
    y: shown("north", path.north),
    z: shown("true_vertical_depth", path.down),
  });
  const text = values.map(
    (value, index) =>
      `${say("measured_depth", statics.measured_depth[index])} measured depth<br>${label(name)} ${say(name, value)}`,
  );
  return [
    {
      type: "scatter3d",
      mode: "lines",
      ...line(axis),
      line: { color: inks().soft, width: 2 },
      hoverinfo: "skip",
      name: "axis of the hole",
    },
    {
      type: "scatter3d",
      mode: "lines",
      ...line(displaced(statics, axis, factor)),
      line: {
        color: shown(name, values),
        colorscale: lineScale(),
        width: 9,
        colorbar: colourBar(title(name)),
        showscale: true,
      },
      text,
      hoverinfo: "text",
      name: "string",
    },
  ];
}

/** Distance of the camera, in sizes of the picture. */
const [CAMERA, ABOVE] = [2.2, 0.15];

/**
 * Layout of a picture of wells in space, seen as a vertical section: from the side of the plane through both ends of a well.
 * @param {{north: number[], east: number[]}} statics
 * @param {number} [above] height of the camera over the middle, in the same unit
 */
export function spaceLayout({ north, east }, above = ABOVE) {
  const { soft, line } = inks();
  const reach = (/** @type {number[]} */ values) => values[values.length - 1] - values[0];
  const along = { north: reach(north), east: reach(east) };
  const length = Math.hypot(along.north, along.east) || 1;
  if (!along.north && !along.east) along.east = 1;
  const axis = (/** @type {string} */ text) => ({
    title: { text: `${text} [${unit("north").symbol}]` },
    gridcolor: line,
    zeroline: false,
    color: soft,
    backgroundcolor: "rgba(0,0,0,0)",
  });
  return {
    margin: { l: 0, r: 0, t: 0, b: 0 },
    scene: {
      xaxis: axis("east"),
      yaxis: axis("north"),
      zaxis: { ...axis("true vertical depth"), autorange: "reversed" },
      aspectmode: "data",
      camera: { eye: { x: (CAMERA * along.north) / length, y: (-CAMERA * along.east) / length, z: above } },
    },
  };
}

/**
 * Factor by which the distance from the axis is multiplied, from the link.
 * @param {URLSearchParams} query
 * @param {number} usual
 */
export function exaggeration(query, usual) {
  return EXAGGERATIONS.includes(query.get("exaggerate") ?? "") ? Number(query.get("exaggerate")) : usual;
}

/** @param {number} factor @param {(value: string) => void} onChange */
export function exaggerationChoice(factor, onChange) {
  return choice(
    "Distance from the axis",
    EXAGGERATIONS.map((entry) => [entry, entry === "1" ? "to scale" : `${entry} times`]),
    String(factor),
    onChange,
  );
}

/** @param {string} whose @param {number} factor */
export function saysExaggeration(whose, factor) {
  return `${whose} distance from the axis of the hole is drawn ${factor === 1 ? "to scale" : `${factor} times as large`}.`;
}

/**
 * A quantity at the nodes: of elements, the mean of both that a node joins.
 * @param {any} columns
 * @param {string} name
 * @param {number} nodes
 * @returns {(number | null)[]}
 */
export function onNodes(columns, name, nodes) {
  const values = columns[name];
  if (values.length === nodes) return values;
  return Array.from({ length: nodes }, (_, node) => {
    const [above, below] = [
      values[Math.max(0, node - 1)] ?? null,
      values[Math.min(values.length - 1, node)] ?? null,
    ];
    return above === null || below === null ? (above ?? below) : (above + below) / 2;
  });
}

/**
 * Path of the string, its distance from the axis multiplied.
 * @param {any} statics
 * @param {{north: number[], east: number[], down: number[]}} axis
 * @param {number} factor
 */
export function displaced(statics, axis, factor) {
  const frames = nodeFrames(statics);
  const result = { north: [...axis.north], east: [...axis.east], down: [...axis.down] };
  for (let node = 0; node < axis.north.length; node += 1) {
    const [u, v] = [factor * statics.u[node], factor * statics.v[node]];
    result.north[node] += u * frames.u[node][0] + v * frames.v[node][0];
    result.east[node] += u * frames.u[node][1] + v * frames.v[node][1];
    result.down[node] += u * frames.u[node][2] + v * frames.v[node][2];
  }
  return result;
}
