// Ticks of logarithmic scales.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { exponentsOf, logTicks } from "../../draw/plots.js";

const RANGES = [
  [2.27, 2.51],
  [1.1, 4.9],
  [1, 1.0000001],
  [9.7, 9.9],
  [0.0031, 0.0049],
  [1e-7, 1e3],
  [1e-200, 1e200],
];
for (const [least, largest] of RANGES) {
  test(`a scale from ${least} to ${largest} has ticks that say their values`, () => {
    const ends = [Math.log10(least), Math.log10(largest)];
    const { tickvals, ticktext } = logTicks(ends[0], ends[1]);
    assert.ok(tickvals.length >= 2 && tickvals.length <= 13, `${ticktext}`);
    assert.equal(new Set(ticktext).size, ticktext.length);
    tickvals.forEach((value, index) => {
      assert.ok(value >= ends[0] - 1e-9 && value <= ends[1] + 1e-9);
      near(Number(ticktext[index]), 10 ** value, 1e-9);
    });
  });
}

test("ticks of a decade are one, two and five", () => {
  assert.deepEqual(logTicks(0, 1).ticktext, ["1", "2", "5", "10"]);
  assert.deepEqual(logTicks(-3, 0).ticktext, ["0.001", "0.01", "0.1", "1"]);
});

test("a range of one value has that value", () => {
  assert.deepEqual(logTicks(Math.log10(3), Math.log10(3)), { tickvals: [Math.log10(3)], ticktext: ["3"] });
});

test("axes are written in full, but for logarithmic ones and tiny values", () => {
  const traces = [
    { x: [-8000, 0], y: [1e-5, null] },
    { x: [3], y: [2], yaxis: "y2" },
  ];
  assert.equal(exponentsOf("xaxis", {}, traces), "none");
  assert.equal(exponentsOf("xaxis", { type: "log" }, traces), "power");
  assert.equal(exponentsOf("yaxis", {}, traces), "power");
  assert.equal(exponentsOf("yaxis2", {}, traces), "none");
});
