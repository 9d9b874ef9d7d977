// Pressures of the mud's circuit and equivalent circulating densities, by three sets of formulas side by side.

import { get } from "../data/api.js";
import { aligner } from "../data/columns.js";
import { number, say, shown, unit } from "../data/units.js";
import { fill, h } from "../ui/dom.js";

/** Pressures at one depth; lists are in the order of the columns. @typedef {{measured_depth: number, end_of_section: string | null, equivalent_circulating_densities: number[] | null}} CircuitDepth */
/** Pressures by one set of formulas [Pa]. @typedef {{losses: string, rotates: boolean, surface_loss: number, bore_loss: number, tool_loss: number, bit_loss: number, annulus_loss: number, standpipe_pressure: number}} CircuitColumn */
/** @typedef {{losses: string, flow_rate: number, mud_density: number, mean_eccentricity: number, columns: CircuitColumn[], depths: CircuitDepth[]}} Circuit */
/** Values of a quantity by columns, as they are served. @typedef {{text: string, values: number[]}} Row */

/** Digits of the largest number of a group of rows. */
const DIGITS = 5;

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function hydraulics({ point, path, signal }) {
  const element = h("div", {}, h("p", { class: "soft", role: "status" }, "Loading…"));
  return {
    element,
    draw: async () => {
      const circuit = await get(`${path}/hydraulics`, {}, signal);
      fill(element, circuitParts(circuit, point.scenario));
    },
    request: () => ({
      asked: [{ table: "hydraulics", isDocument: true }],
      python: 'import pandas\n\npressures = pandas.DataFrame(point.hydraulics()["columns"])',
    }),
  };
}

/** @param {Circuit} circuit @param {any} scenario of the point */
function circuitParts(circuit, scenario) {
  const mud = `Mud of ${say("mud_density", circuit.mud_density)} at ${say("flow_rate", circuit.flow_rate)}.`;
  return [
    h("h2", {}, "Pressures of the mud's circuit"),
    h("p", { class: "soft" }, mud),
    h(
      "div",
      { class: "scroll", tabindex: "0", role: "region", "aria-label": "Pressures, scrollable" },
      circuitTable(circuit, scenario),
    ),
    h(
      "ul",
      { class: "small" },
      reasons(circuit).map((text) => h("li", {}, text)),
    ),
  ];
}

/** @param {Circuit} circuit @param {any} scenario */
function circuitTable(circuit, scenario) {
  const own = ownColumn(circuit, scenario);
  const heads = circuit.columns.map((column) =>
    h(
      "th",
      { class: "number", scope: "col" },
      heading(column),
      column === own && h("span", { class: "soft" }, " (this point)"),
    ),
  );
  return h(
    "table",
    { "aria-label": "Pressures and densities by sets of formulas" },
    h("thead", {}, h("tr", {}, h("td", {}), heads)),
    rowGroup("Pressure", "standpipe_pressure", pressureRows(circuit, scenario.mud.back_pressure ?? 0)),
    rowGroup("Equivalent circulating density", "equivalent_circulating_density", densityRows(circuit)),
  );
}

/** @param {string} name @param {string} quantity whose unit the values have @param {Row[]} rows */
function rowGroup(name, quantity, rows) {
  if (!rows.length) return null;
  const inUnit = rows.map(({ values }) => shown(quantity, values).map(Number));
  const written = aligner(inUnit.flat(), DIGITS);
  const { symbol } = unit(quantity);
  const columns = rows[0].values.length + 1;
  return h(
    "tbody",
    {},
    h("tr", {}, h("th", { scope: "rowgroup", colspan: columns }, `${name} [${symbol}]`)),
    rows.map(({ text }, row) =>
      h(
        "tr",
        {},
        h("th", { scope: "row" }, text),
        inUnit[row].map((value) => h("td", { class: "number" }, written(value))),
      ),
    ),
  );
}

/**
 * Losses from the pump to the top of the annulus, and their sum.
 * @param {Circuit} circuit
 * @param {number} backPressure [Pa]
 * @returns {Row[]}
 */
export function pressureRows({ columns }, backPressure) {
  const row = (/** @type {string} */ text, /** @type {(column: CircuitColumn) => number} */ value) => ({
    text,
    values: columns.map(value),
  });
  return [
    row("surface lines", (column) => column.surface_loss),
    row("bore", (column) => column.bore_loss),
    row("tools", (column) => column.tool_loss),
    row("bit", (column) => column.bit_loss),
    row("annulus", (column) => column.annulus_loss),
    ...(backPressure ? [row("back pressure", () => backPressure)] : []),
    row("standpipe pressure", (column) => column.standpipe_pressure),
  ];
}

/**
 * Densities at the ends of hole sections, such as casing shoes, and at the bit; none without gravity.
 * @param {Circuit} circuit
 * @returns {Row[]}
 */
export function densityRows({ depths }) {
  const bit = depths.at(-1);
  return depths.flatMap((depth) => {
    const { measured_depth: at, end_of_section: section, equivalent_circulating_densities: values } = depth;
    const place = depth === bit ? "bit" : section === null ? "" : `end of ${section || "a section"}`;
    return place && values ? [{ text: `${place}, ${say("measured_depth", at)}`, values }] : [];
  });
}

/**
 * Column that the point's own pressures have: that of the scenario's formulas, with rotation if the mud has its factor.
 * @param {Circuit} circuit
 * @param {any} scenario
 */
export function ownColumn({ columns, losses }, { mud }) {
  const found = columns.filter((column) => column.losses === losses);
  return found.find((column) => column.rotates === (mud.rotation_factor ?? false)) ?? found[0];
}

/** @param {CircuitColumn} column */
function heading({ losses, rotates }) {
  const name = losses === "rp13d" ? "RP 13D" : losses;
  return rotates ? `${name}, turning` : name;
}

/**
 * Sentences on the differences between the columns (docs/model/hydraulics.md).
 * @param {Circuit} circuit
 */
export function reasons({ columns, mean_eccentricity: eccentricity }) {
  const find = (/** @type {string} */ losses, rotates = false) =>
    columns.find((column) => column.losses === losses && column.rotates === rotates);
  const [eccentric, concentric, standard] = ["eccentric", "concentric", "rp13d"].map((losses) =>
    find(losses),
  );
  const turning = find("eccentric", true);
  const part = (
    /** @type {CircuitColumn | undefined} */ of,
    /** @type {CircuitColumn | undefined} */ to,
    /** @type {"annulus_loss" | "bore_loss"} */ loss,
  ) => (of && to && to[loss] > 0 ? `${number((100 * of[loss]) / to[loss], 3)} %` : "");
  const ofConcentric = part(eccentric, concentric, "annulus_loss");
  const ofStandard = part(standard, concentric, "annulus_loss");
  const ofRest = part(turning, eccentric, "annulus_loss");
  return [
    ofConcentric &&
      `Eccentric has ${ofConcentric} of the concentric annulus loss: the string lies at a mean eccentricity of ${number(eccentricity, 2)} (0 in the middle of the hole, 1 on its wall), and mud passes more easily on the wide side.`,
    ofStandard &&
      `RP 13D has ${ofStandard} of the concentric annulus loss and ${part(standard, concentric, "bore_loss")} of its bore loss: it takes the string in the middle of the hole, other limits of the flow regimes, and in turbulence the flow index of the mud in place of that at the wall.`,
    ofRest &&
      `Turning has ${ofRest} of the annulus loss at rest: shear thins laminar flow. It is a lower bound, because vortices and waves of a real string raise its losses and no formula here contains them; the larger of the concentric columns is the safer estimate of an ECD.`,
  ].filter(Boolean);
}
