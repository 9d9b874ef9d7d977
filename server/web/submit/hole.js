// The hole of a new sweep as a table of its sections, casings and open hole.

import { nameBox } from "./fields.js";
import { importFile } from "./import-file.js";
import { withoutNulls } from "./members.js";
import { tablePart } from "./table.js";
import { read } from "./values.js";

/** Path of the table. */
export const HOLE = "well.section";

/** @type {import("./table.js").Table} */
const TABLE = {
  path: HOLE,
  heading: "Hole sections",
  one: "hole section",
  columns: [
    { name: "name", text: "Name", cell: nameBox },
    { name: "from", text: "From" },
    { name: "hole_diameter", text: "Diameter", isOptional: true },
    { name: "static_friction", text: "Static friction", isOptional: true },
    { name: "dynamic_friction", text: "Dynamic friction", isOptional: true },
  ],
  proposed: { from: 0 },
};

/** Choices that a file of a hole may leave open. @type {import("./import-file.js").Choices} */
const CHOICES = {
  assumed_units: {
    label: "Columns of the hole without a unit",
    options: [
      ["", "are refused"],
      ["si", "are in m, mm"],
      ["field", "are in ft, in"],
    ],
  },
};

/** True of a change that this part of the form can show. @param {import("./rows.js").Row} row */
export function isHole({ name, values }) {
  if (name !== HOLE) return false;
  const value = read(values);
  return Array.isArray(value) && value.every((row) => typeof row === "object" && row !== null);
}

/**
 * The table, drawn anew by each call, with a chooser of a file that stays.
 * @param {AbortSignal} signal of the view
 * @returns {(edited: import("./fields.js").Edited) => HTMLElement[]}
 */
export function holePart(signal) {
  /** @type {import("./fields.js").Edited} */
  let shown;
  const taken = (/** @type {{sections: any[]}} */ { sections }) =>
    shown.set(HOLE, sections.map(withoutNulls));
  const file = importFile("hole", CHOICES, () => ({}), taken, signal);
  return (edited) => {
    shown = edited;
    return [tablePart(TABLE, edited, [file])];
  };
}
