// Ticks of linear and logarithmic scales, and their words.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { logAxisTicks, logTicks, roundValues, tickText } from "../../draw/picture/ticks.js";

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

test("numbers are written in full, but for tiny and huge ones", () => {
  assert.deepEqual([0, 0.001, -8000, 12345.678, 2e-5, -1e-12, 1e9].map(tickText), [
    "0",
    "0.001",
    "−8000",
    "12\u202f345.7",
    "2×10⁻⁵",
    "−10⁻¹²",
    "10⁹",
  ]);
});

test("round values lie between both ends, which count", () => {
  assert.deepEqual(roundValues(0, 1, 5), [0, 0.2, 0.4, 0.6000000000000001, 0.8, 1]);
  assert.deepEqual(roundValues(-3, 3, 4), [-2, 0, 2]);
});

test("a logarithmic axis is written by powers of ten where some numbers are tiny or large", () => {
  const words = (low, high) => logAxisTicks(low, high).map(({ text }) => text);
  assert.deepEqual(words(0.01, 10), ["0.01", "0.1", "1", "10"]);
  assert.deepEqual(words(1e-5, 1e-1), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"]);
  assert.deepEqual(words(1250, 1750), ["1300", "1400", "1500", "1600", "1700"]);
});
