// The nearest computed point, with distances in parts of the parameters' ranges.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { nearestRow, partOf, rangesOf, valueAtPart } from "../../data/nearest-point.js";

const COLUMNS = new Map([
  ["flow_rate", [0.01, 0.01, 0.06, 0.06]],
  ["mud_density", [1200, 2100, 1200, 2100]],
  ["regime", ["a", "b", "a", "b"]],
  ["constant", [1, 1, 1, 1]],
]);

test("parameters that are no numbers or do not vary have no range", () => {
  const spans = rangesOf(COLUMNS, {});
  assert.deepEqual(
    spans.map(({ name }) => name),
    ["flow_rate", "mud_density"],
  );
});

test("places in a range and back, linear and logarithmic", () => {
  const linear = { name: "a", from: 2, to: 6, isLog: false };
  near(partOf(linear, 3), 0.25);
  near(valueAtPart(linear, 0.25), 3);
  const log = { name: "a", from: 1, to: 1e4, isLog: true };
  near(partOf(log, 100), 0.5);
  near(valueAtPart(log, 0.5), 100);
});

test("distances are parts of ranges, whatever the units", () => {
  const spans = rangesOf(COLUMNS, {});
  const at = (flow, density, isComputed = () => true) =>
    nearestRow(
      spans,
      COLUMNS,
      new Map([
        ["flow_rate", flow],
        ["mud_density", density],
      ]),
      isComputed,
    );
  assert.equal(at(0.03, 1700), 1);
  assert.equal(at(0.04, 1600), 2);
  assert.equal(
    at(0.04, 1600, (row) => row !== 2),
    3,
  );
  assert.equal(
    at(0.04, 1600, () => false),
    -1,
  );
});
