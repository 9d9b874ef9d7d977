// Rows and reasons of the circuit's pressures.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { loadQuantities } from "../../data/units.js";

await loadQuantities();
const { densityRows, ownColumn, pressureRows, reasons } = await import("../../point/hydraulics.js");

/** @param {string} losses @param {boolean} rotates @param {number} bore @param {number} annulus */
function column(losses, rotates, bore, annulus) {
  const own = { losses, rotates, surface_loss: 1e5, bore_loss: bore, tool_loss: 5e5, bit_loss: 2e6 };
  return { ...own, annulus_loss: annulus, standpipe_pressure: 3.6e6 + bore + annulus };
}

const CIRCUIT = {
  losses: "concentric",
  flow_rate: 0.03,
  mud_density: 1200,
  mean_eccentricity: 0.56,
  columns: [
    column("eccentric", false, 4e6, 1.5e6),
    column("eccentric", true, 4e6, 1.35e6),
    column("concentric", false, 4e6, 2e6),
    column("concentric", true, 4e6, 1.9e6),
    column("rp13d", false, 5e6, 1.9e6),
  ],
  depths: [
    { measured_depth: 0, end_of_section: null, equivalent_circulating_densities: null },
    { measured_depth: 800, end_of_section: "casing", equivalent_circulating_densities: [1, 2, 3, 4, 5] },
    { measured_depth: 900, end_of_section: "", equivalent_circulating_densities: [2, 3, 4, 5, 6] },
    { measured_depth: 950, end_of_section: null, equivalent_circulating_densities: [3, 4, 5, 6, 7] },
    { measured_depth: 1000, end_of_section: null, equivalent_circulating_densities: [4, 5, 6, 7, 8] },
  ],
};

test("losses of a column add up to its standpipe pressure", () => {
  const [standpipe, ...parts] = pressureRows(CIRCUIT, 1e6).toReversed();
  assert.equal(standpipe.text, "standpipe pressure");
  standpipe.values.forEach((sum, at) =>
    assert.equal(
      parts.reduce((total, { values }) => total + values[at], 0),
      sum,
    ),
  );
});

test("a well without back pressure has no row of it", () => {
  const names = pressureRows(CIRCUIT, 0).map(({ text }) => text);
  assert.deepEqual(names, ["surface lines", "bore", "tools", "bit", "annulus", "standpipe pressure"]);
});

test("densities stand at the ends of sections and at the bit alone", () => {
  assert.deepEqual(densityRows(CIRCUIT), [
    { text: "end of casing, 800 m", values: [1, 2, 3, 4, 5] },
    { text: "end of a section, 900 m", values: [2, 3, 4, 5, 6] },
    { text: "bit, 1000 m", values: [4, 5, 6, 7, 8] },
  ]);
});

test("the point's column has its formulas, and rotation if the mud has its factor", () => {
  const { columns } = CIRCUIT;
  assert.equal(ownColumn(CIRCUIT, { mud: { rotation_factor: true } }), columns[3]);
  assert.equal(ownColumn(CIRCUIT, { mud: {} }), columns[2]);
  // API RP 13D has none for rotation.
  const standard = { ...CIRCUIT, losses: "rp13d" };
  assert.equal(ownColumn(standard, { mud: { rotation_factor: true } }), columns[4]);
});

test("sentences have the shares of the losses", () => {
  const [eccentric, standard, turning, ...others] = reasons(CIRCUIT);
  assert.match(eccentric, /^Eccentric has 75 % of the concentric annulus loss: .* eccentricity of 0\.56 /);
  assert.match(standard, /^RP 13D has 95 % of the concentric annulus loss and 125 % of its bore loss: /);
  assert.match(turning, /^Turning has 90 % of the annulus loss at rest: .* lower bound/);
  assert.deepEqual(others, []);
});

test("mud at rest and a string at rest have no shares to name", () => {
  const still = CIRCUIT.columns.map((one) => ({ ...one, bore_loss: 0, annulus_loss: 0 }));
  assert.deepEqual(reasons({ ...CIRCUIT, columns: still }), []);
  const atRest = CIRCUIT.columns.filter(({ rotates }) => !rotates);
  assert.equal(reasons({ ...CIRCUIT, columns: atRest }).length, 2);
});
