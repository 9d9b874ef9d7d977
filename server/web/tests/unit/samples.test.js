// Dots of a map's samples, their inks and the ranges about them.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { inkOn } from "../../draw/picture/colours.js";
import { extremes, hasRoom, sampledRange, sampleTraces } from "../../draw/samples.js";

const LARGE = { clientWidth: 1200, clientHeight: 600 };

/** Samples of a grid with values. */
function samplesOf(values) {
  return values.flatMap((line, row) =>
    line.map((value, column) => ({
      x: column,
      y: 10 * row,
      column,
      row,
      value,
      ink: "#000000",
      text: `${column} ${row}`,
      key: 10 * row + column,
    })),
  );
}

test("a range ends shortly beyond the samples, by logarithms on a logarithmic axis", () => {
  const [from, to] = sampledRange([4, 2, 12], false);
  assert.ok(from < 2 && from > 1.5 && to > 12 && to < 12.5);
  near(2 - from, to - 12);
  const [low, high] = sampledRange([1, 100], true).map(Math.log10);
  assert.ok(low < 0 && low > -0.1 && high > 2 && high < 2.1);
  assert.equal(sampledRange([3], false), undefined);
  assert.equal(sampledRange([0, 3], true), undefined);
});

test("the least and the largest of a few values are found, gaps left out", () => {
  const samples = samplesOf([
    [3, null, 1],
    [7, 2, null],
  ]);
  assert.deepEqual(
    extremes(samples).map(({ key }) => key),
    [2, 10],
  );
  assert.equal(extremes(samplesOf([[3, 4]])), null);
  assert.equal(extremes(samplesOf([[3, 3, 3]])), null);
});

test("values are printed while cells are large, within the cells", () => {
  assert.ok(hasRoom(LARGE, 4, 3));
  assert.ok(!hasRoom(LARGE, 40, 3));
  assert.ok(!hasRoom({ clientWidth: 390, clientHeight: 600 }, 6, 3));
  const [dots] = sampleTraces(
    samplesOf([
      [0.12345, 2, 3],
      [4, null, 6],
    ]),
    LARGE,
  );
  assert.deepEqual(dots.text, ["0.123<br> ", "2", "3", "4", "", "<br>6"]);
  assert.deepEqual(dots.textposition, [
    "top right",
    "top center",
    "top left",
    "bottom right",
    "bottom center",
    "bottom left",
  ]);
  assert.deepEqual(dots.customdata, [0, 1, 2, 10, 11, 12]);
});

test("many samples have rings and no dots", () => {
  const many = samplesOf([Array.from({ length: 1000 }, (_, index) => index)]);
  const traces = sampleTraces(many, LARGE);
  assert.deepEqual(
    traces.map(({ customdata }) => customdata),
    [
      [0, 999],
      [0, 999],
    ],
  );
});

test("ink is white on the dark end of the scale and black on its bright end", () => {
  assert.equal(inkOn(0, [0, 1]), "#ffffff");
  assert.equal(inkOn(1, [0, 1]), "#000000");
});
