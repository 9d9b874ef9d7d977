// The string of a new sweep as tables: its sections (the tally), gauges and unbalance masses.

import { partsOf, placedSections } from "../data/string-parts.js";
import { inputUnit, number, say } from "../data/units.js";
import { drawTrack, smallCanvas } from "../draw/small-pictures.js";
import { partsInWords } from "../draw/string-track.js";
import { h } from "../ui/dom.js";
import { nameBox, numberBox, wordBox } from "./fields.js";
import { readersNumber } from "./entries.js";
import { importFile } from "./import-file.js";
import { memberOf, withoutNulls } from "./members.js";
import { namesOfPipes, pipeColumn } from "./pipes.js";
import { tablePart } from "./table.js";
import { read } from "./values.js";

/** Paths of the tables. */
export const STRING = ["string.sections", "string.gauges", "string.unbalance"];
const [SECTIONS, GAUGES, UNBALANCE] = STRING;

/** Materials with a name (docs/model/beam.md, Section). @type {[name: string, material: Material][]} */
const MATERIALS = [
  ["steel", { youngs_modulus: 2.03e11, density: 7900, poissons_ratio: 0.3 }],
  ["aluminium 2014-T6", { youngs_modulus: 7.3e10, density: 2800, poissons_ratio: 0.33 }],
  ["non-magnetic steel", { youngs_modulus: 2e11, density: 7920, poissons_ratio: 0.27 }],
  ["titanium Ti-6Al-4V", { youngs_modulus: 1.1e11, density: 4430, poissons_ratio: 0.31 }],
];
const GRADES = ["E-75", "X-95", "G-105", "S-135", "HWDP-55", "collar-110", "collar-100"];

/** @typedef {{youngs_modulus: number, density: number, poissons_ratio: number, grade?: string}} Material */

/** Columns of materials with what holds for a row that has none. @type {[name: string, text: string, inherits: string][]} */
const MATERIAL_COLUMNS = [
  ["material", "Material", "the string's"],
  ["tool_joint.material", "Joint material", "the section's"],
];

/** Columns by one of which a place on the string is given, the last next to a section. @type {import("./table.js").Column[]} */
const PLACE_COLUMNS = [
  { name: "measured_depth", text: "Measured depth", isOptional: true },
  { name: "above_bit", text: "or above the bit", isOptional: true },
  {
    name: "section",
    text: "or in section",
    cell: (label, value, row, set) => nameBox(label, value, row, (name) => set(name || undefined)),
  },
  { name: "above_end", text: "above its end", isOptional: true },
];

/** @type {import("./table.js").Table[]} */
const TABLES = [
  {
    path: SECTIONS,
    heading: "Tally",
    one: "section",
    columns: [
      { name: "name", text: "Name", cell: nameBox },
      { name: "kind", text: "Kind", words: ["drillpipe", "collar", "stabilizer", "bit"] },
      { name: "count", text: "Pieces", isOptional: true },
      { name: "length", text: "Length of one" },
      { name: "outer_diameter", text: "Outer diameter" },
      { name: "inner_diameter", text: "Inner diameter" },
      { name: "mass_per_length", text: "Mass per length", isOptional: true },
      { name: "stiffness_outer_diameter", text: "Stiffness outer d.", isOptional: true },
      { name: "stiffness_inner_diameter", text: "Stiffness inner d.", isOptional: true },
      { name: "blade_diameter", text: "Blade diameter", isOptional: true },
      { name: "blade_above_end", text: "Blades above end", isOptional: true },
      { name: "make_up_torque", text: "Make-up torque", isOptional: true },
      { name: "tool_joint.length", text: "Joint length", isOptional: true },
      { name: "tool_joint.outer_diameter", text: "Joint outer d.", isOptional: true },
      { name: "tool_joint.inner_diameter", text: "Joint inner d.", isOptional: true },
      ...MATERIAL_COLUMNS.map(([name, text, inherits]) => ({
        name,
        text,
        cell: (
          /** @type {string} */ label,
          /** @type {any} */ value,
          /** @type {any} */ row,
          /** @type {(entered: unknown) => void} */ set,
        ) => materialBox(label, inherits, value, name.startsWith("tool_joint") && !row.tool_joint, set),
      })),
    ],
    proposed: { kind: "drillpipe", length: 9.5, outer_diameter: 0.127, inner_diameter: 0.108 },
  },
  {
    path: GAUGES,
    heading: "Gauges: further blades by depth and clearance",
    one: "gauge",
    columns: [...PLACE_COLUMNS, { name: "clearance", text: "Radial clearance" }],
    proposed: { measured_depth: 0, clearance: 1e-4 },
  },
  {
    path: UNBALANCE,
    heading: "Unbalance masses",
    one: "mass",
    columns: [
      ...PLACE_COLUMNS,
      { name: "mass", text: "Mass" },
      { name: "radius", text: "Distance from the axis" },
      { name: "phase_deg", text: "Phase", isOptional: true, isSigned: true },
    ],
    proposed: { measured_depth: 0, mass: 1.6, radius: 0.064 },
  },
];

/** True of a change that this part of the form can show. @param {import("./rows.js").Row} row */
export function isTally({ name, values }) {
  if (!TABLES.some(({ path }) => path === name)) return false;
  const value = read(values);
  return Array.isArray(value) && value.every((row) => typeof row === "object" && row !== null);
}

/** Name of a material; `own` for other numbers, empty if there is none. @param {Material | null | undefined} material */
export function materialName(material) {
  if (!material) return "";
  const isSame = (/** @type {Material} */ one) =>
    one.youngs_modulus === material.youngs_modulus &&
    one.density === material.density &&
    one.poissons_ratio === material.poissons_ratio;
  return MATERIALS.find(([, one]) => isSame(one))?.[0] ?? "own";
}

/** Choices that a file of a tally may leave open. @type {import("./import-file.js").Choices} */
const CHOICES = {
  order: {
    label: "Listed",
    options: [
      ["", "as the bit shows"],
      ["from_bit", "from the bit up"],
      ["from_top", "from the top down"],
    ],
  },
  lengths: {
    label: "Lengths of several joints",
    options: [
      ["", "as cumulative lengths show"],
      ["each", "of each joint"],
      ["total", "of all joints"],
    ],
  },
  assumed_units: {
    label: "Columns without a unit",
    options: [
      ["", "are refused"],
      ["si", "are in m, mm, kg/m"],
      ["field", "are in ft, in, lb/ft"],
    ],
  },
};

/**
 * The fields, drawn anew by each call, with a chooser of a file that stays.
 * @param {AbortSignal} signal of the view
 * @returns {(edited: import("./fields.js").Edited) => HTMLElement[]}
 */
export function stringPart(signal) {
  /** @type {import("./fields.js").Edited} */
  let shown;
  const taken = (/** @type {{sections: any[]}} */ { sections }) => {
    const fromTop = sections.map(withoutNulls);
    shown.set(SECTIONS, shown.value("string.order") === "from_bit" ? fromTop.reverse() : fromTop);
  };
  const file = importFile("tally", CHOICES, () => ({}), taken, signal);
  const names = namesOfPipes();
  const tables = TABLES.map((table) =>
    table.path === SECTIONS
      ? { ...table, columns: table.columns.toSpliced(1, 0, pipeColumn(signal)) }
      : table,
  );
  return (edited) => {
    shown = edited;
    return stringFields(tables, edited, [file, names]);
  };
}

/**
 * @param {import("./table.js").Table[]} tables
 * @param {import("./fields.js").Edited} edited
 * @param {HTMLElement[]} last parts below the tally
 * @returns {HTMLElement[]}
 */
function stringFields(tables, edited, last) {
  /** @type {any[]} */
  const sections = edited.value(SECTIONS) ?? [];
  const [order, bit_depth] = ["order", "bit_depth"].map((name) => edited.value(`string.${name}`));
  const below = [
    ...ownMaterials(sections, edited),
    lengthLine(sections, edited),
    picturePart({ sections, order, bit_depth }),
    ...last,
  ];
  const shows = {
    head: `Down to [${inputUnit("measured_depth").symbol}]`,
    texts: (/** @type {any[]} */ rows) =>
      placedSections({ sections: rows, order, bit_depth })
        .toSorted((a, b) => a.index - b.index)
        .map(({ bottom }) =>
          Number.isFinite(bottom) && bottom > 0 ? number(readersNumber("measured_depth", bottom), 6) : "–",
        ),
  };
  return tables.map((table) =>
    table.path === SECTIONS ? tablePart({ ...table, shows }, edited, below) : tablePart(table, edited),
  );
}

/** @param {string} label @param {string} inherits @param {Material | undefined} value @param {boolean} isDisabled @param {(value: Material | undefined) => void} set */
function materialBox(label, inherits, value, isDisabled, set) {
  const chosen = materialName(value);
  /** @type {[string, string][]} */
  const options = [
    ["", inherits],
    ...MATERIALS.map(([name]) => /** @type {[string, string]} */ ([name, name])),
  ];
  if (chosen === "own") options.push(["own", "own numbers"]);
  const box = wordBox(label, options, chosen, (name) => {
    if (name !== "own") set(MATERIALS.find(([one]) => one === name)?.[1]);
  });
  box.disabled = isDisabled;
  return box;
}

/** Numbers of the materials that rows have of their own. @param {any[]} rows @param {import("./fields.js").Edited} edited */
function ownMaterials(rows, edited) {
  return rows.flatMap((row, at) =>
    MATERIAL_COLUMNS.flatMap(([name, text]) => {
      const material = memberOf(row, name);
      const heading = `${text} of section ${at + 1}`;
      return material ? [materialLine(`${SECTIONS}[${at}].${name}`, heading, material, edited)] : [];
    }),
  );
}

/** @param {string} path of the material @param {string} heading @param {any} material @param {import("./fields.js").Edited} edited */
function materialLine(path, heading, material, edited) {
  const set = (/** @type {string} */ name, /** @type {unknown} */ value) =>
    edited.setMember(SECTIONS, `${path.slice(SECTIONS.length)}.${name}`, value);
  const boxes = [
    ["youngs_modulus", "E"],
    ["density", "density"],
    ["poissons_ratio", "Poisson's ratio"],
  ].map(([name, text]) => {
    const { symbol } = inputUnit(`${path}.${name}`);
    return h(
      "label",
      { class: "field" },
      h("span", {}, symbol ? `${text} [${symbol}]` : text),
      numberBox(`${heading}: ${text}`, `${path}.${name}`, material[name], (value) => set(name, value)),
    );
  });
  /** @type {[string, string][]} */
  const grades = [
    ["", "grade unknown"],
    ...GRADES.map((grade) => /** @type {[string, string]} */ ([grade, grade])),
  ];
  return h(
    "div",
    { class: "line" },
    `${heading}:`,
    boxes,
    wordBox(`${heading}: grade`, grades, material.grade ?? "", (grade) => set("grade", grade || undefined)),
  );
}

/**
 * The string as results show it, so that a wrong length or order is seen before it is computed.
 * @param {import("../data/string-parts.js").DrillString} string
 */
function picturePart(string) {
  const ends = placedSections(string).map(({ bottom }) => bottom);
  if (!ends.length || !ends.every(Number.isFinite)) return h("p", { hidden: true });
  const parts = partsOf(string);
  const picture = smallCanvas(`String over depth: ${partsInWords(parts)}`);
  drawTrack(picture, parts, { depths: [], curves: [], nodes: [] });
  return picture;
}

/** Length of the string next to the depth to which its survey reaches. @param {any[]} sections @param {import("./fields.js").Edited} edited */
function lengthLine(sections, edited) {
  const length = placedSections({ sections }).at(-1)?.bottom ?? 0;
  const reach = edited.value("well.survey")?.at(-1)?.measured_depth;
  if (!Number.isFinite(length)) return h("p", { hidden: true });
  return h(
    "p",
    { class: "small soft" },
    `The string is ${say("measured_depth", length, 6)} long${typeof reach === "number" ? `; the scenario's survey reaches ${say("measured_depth", reach, 6)}` : ""}.`,
  );
}
