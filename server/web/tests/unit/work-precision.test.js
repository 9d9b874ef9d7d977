// Errors against processor times.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { costsOf, cpuTime, decades } from "../../data/work-precision.js";

const POINT = { ordinal: 3, provenance: { transient_cpu_time: 2, statics_cpu_time: 0.5 } };

test("the time of a point is that of its run and its equilibrium", () => {
  assert.equal(cpuTime(POINT), 2.5);
  assert.equal(cpuTime({ ordinal: 1 }), null);
});

test("points without an error or a time are left out, and no error is too small to be shown", () => {
  const costs = costsOf([
    { point: POINT, error: -0.02 },
    { point: POINT, error: 0 },
    { point: POINT, error: null },
    { point: { ordinal: 1 }, error: 0.1 },
  ]);
  assert.deepEqual(costs, [
    { cpu: 2.5, error: 0.02, text: "point 3" },
    { cpu: 2.5, error: 1e-5, text: "point 3" },
  ]);
});

test("an axis has all values and a decade at least", () => {
  const [from, to] = decades([1, 100]).map(Math.log10);
  assert.ok(from < 0 && to > 2);
  const [low, high] = decades([10]).map(Math.log10);
  near(low, 0.5);
  near(high, 1.5);
});
