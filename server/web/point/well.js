// The view of a well in space with the string in it at rest, coloured by a quantity.

import { label } from "../data/units.js";
import { onNodes } from "../data/well-frames.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { pythonColumns, QUANTITIES, tableOf } from "./profiles.js";
import { WellPictures } from "./well-pictures.js";

/** Factors by which the string's distance from the axis of the hole is multiplied. */
const EXAGGERATIONS = ["1", "20", "100", "300"];
const USUAL = 20;
/** Sentences about pictures of wells. */
export const LEGEND =
  "The dashed line is the axis of the hole, the rings its wall, with marks of measured depth next to it; tool joints, collars and stabilizers are wider than pipe, and the cone is the bit. Drag to turn, with Shift to shift, scroll to zoom.";

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function well(context) {
  const { query } = context;
  const controls = h("div", { class: "controls" });
  const place = h("div", {});
  const caption = h("figcaption", {});
  const colour = () =>
    QUANTITIES.some(([name]) => name === query.get("colour")) ? (query.get("colour") ?? "") : "normal_force";
  const factor = () => exaggeration(query, USUAL);
  const begin = generations();
  /** @type {WellPictures | undefined} */
  let pictures;
  const set = (/** @type {string} */ key) => (/** @type {string} */ value) => {
    context.keep({ [key]: value });
    attend(redraw(), context.signal);
  };

  async function redraw() {
    const isNewest = begin();
    const name = colour();
    const statics = (await context.table("statics")).columns;
    const table = tableOf(name) === "statics" ? statics : (await context.table(tableOf(name))).columns;
    if (!isNewest()) return;
    if (!pictures) {
      const { string } = context.point.scenario;
      pictures = new WellPictures([{ statics, string, heading: "" }], context);
      fill(place, pictures.element);
    }
    fill(
      controls,
      choice(
        "Colour",
        QUANTITIES.map(([entry]) => [entry, label(entry)]),
        name,
        set("colour"),
      ),
      exaggerationChoice(factor(), set("exaggerate")),
      pictures.buttons(),
    );
    pictures.show(factor(), { name, values: [onNodes(table, name, statics.measured_depth.length)] });
    fill(caption, `${saysExaggeration("The string at rest; its", factor())} ${LEGEND}`);
  }

  return {
    element: h("div", {}, controls, place, caption),
    draw: redraw,
    request: () => requestOf(colour()),
  };
}

/** Requests behind the well. @param {string} name of the quantity that colours the string @returns {import("./part.js").PartRequest} */
function requestOf(name) {
  const table = tableOf(name);
  const space = [
    "measured_depth",
    "north",
    "east",
    "true_vertical_depth",
    "u",
    "v",
    "low_side_angle",
    "clearance",
  ];
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
