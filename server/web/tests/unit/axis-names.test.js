// Names of parallel axes.

import assert from "node:assert/strict";
import { test } from "node:test";
import { axisNames, wrapped } from "../../sweep/axis-names.js";

const NAMES = [
  "flow rate [m³/s]",
  "mud density [kg/m³]",
  "largest lateral vibration of all recorded nodes [mm]",
];

test("names are broken at blanks, and keep all words", () => {
  const lines = wrapped(NAMES[2]);
  assert.deepEqual(lines, ["largest lateral", "vibration of all", "recorded nodes", "[mm]"]);
  assert.deepEqual(wrapped("unbreakable_name_of_a_column x"), ["unbreakable_name_of_a_column", "x"]);
});

test("names stand above the axes where they have room", () => {
  const { lines, side, width, margin } = axisNames(NAMES, 1400);
  assert.deepEqual([lines.flat(), side, width], [NAMES, "top", 0]);
  // The last name is centred at the last axis.
  assert.ok(margin.r > (NAMES[2].length * 6) / 2);
});

test("on a phone names stand in lines below the axes, which keep a distance", () => {
  const { lines, side, width, margin } = axisNames(NAMES, 350);
  assert.equal(side, "bottom");
  assert.equal(lines[2].length, 4);
  assert.ok(width - margin.l - margin.r >= 2 * 110);
  assert.ok(margin.b >= 5 * 14);
});
