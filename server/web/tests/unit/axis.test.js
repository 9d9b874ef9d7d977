// Axes of pictures: their ranges, places of values, and ticks.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { Axis, edgesOf } from "../../draw/picture/axis.js";

/** An axis at a place of the picture. */
function placed(name, own, traces, offset = 10, length = 200) {
  return Object.assign(new Axis(name, own, traces), { offset, length });
}
const line = (x, y) => ({ type: "scatter", mode: "lines", x, y });

test("lines end at the sides and have room above and below", () => {
  const trace = line([2, null, 6], [10, 20, 30]);
  assert.deepEqual(new Axis("x", {}, [trace]).whole, [2, 6]);
  assert.deepEqual(new Axis("y", {}, [trace]).whole, [9, 31]);
  const marks = { ...trace, mode: "lines+markers" };
  assert.deepEqual(new Axis("x", {}, [marks]).whole, [1.8, 6.2]);
});

test("a range that is given holds, and an axis is reversed", () => {
  const trace = line([0, 1], [0, 100]);
  assert.deepEqual(new Axis("x", { range: [-3, 9] }, [trace]).whole, [-3, 9]);
  const { whole } = new Axis("y", { autorange: "reversed" }, [trace]);
  assert.deepEqual(whole, [105, -5]);
});

test("single values, none, and zeros have a range", () => {
  const around = new Axis("x", {}, [line([5], [5])]).whole;
  assert.ok(around[0] < 5 && around[1] > 5);
  const zero = new Axis("x", {}, [line([0], [0])]).whole;
  assert.ok(zero[0] < 0 && zero[1] > 0);
  assert.deepEqual(new Axis("x", {}, [line([null], [null])]).whole, [0, 1]);
});

test("a logarithmic axis spans positive values alone, and has them at equal ratios", () => {
  const axis = placed("x", { type: "log" }, [line([-4, 0, 0.01, 100], [1, 1, 1, 1])]);
  assert.deepEqual(axis.whole.map(Math.log10).map(Math.round), [-2, 2]);
  near(axis.toPixel(1), 110);
  near(axis.toValue(110), 1);
  assert.ok(Number.isNaN(axis.toPixel(0)) && Number.isNaN(axis.toPixel(-1)));
});

test("values and places belong to each other on both axes", () => {
  const trace = line([0, 10], [0, 10]);
  for (const own of [{ range: [0, 10] }, { range: [10, 0] }]) {
    for (const name of ["x", "y"]) {
      const axis = placed(name, own, [trace]);
      for (const value of [0, 2.5, 10]) near(axis.toValue(axis.toPixel(value)), value, 1e-9);
    }
  }
  near(placed("x", { range: [0, 10] }, [trace]).toPixel(0), 10);
  near(placed("y", { range: [0, 10] }, [trace]).toPixel(0), 210);
});

test("gaps have no place", () => {
  const axis = placed("x", {}, [line([0, null, 4], [1, 1, 1])]);
  assert.ok(Number.isNaN(axis.toPixel(null)));
  assert.deepEqual([...axis.toPixels([0, null, 4])].map(Number.isNaN), [false, true, false]);
});

test("words stand in their order, first those that are named", () => {
  const axis = placed("y", { categoryarray: ["c", "b"] }, [line([1, 2], ["a", "b"])]);
  assert.deepEqual(axis.words, ["c", "b", "a"]);
  assert.deepEqual(axis.whole, [-0.5, 2.5]);
  assert.ok(axis.toPixel("c") > axis.toPixel("b"));
  assert.ok(Number.isNaN(axis.toPixel("other")));
  assert.deepEqual(
    axis.ticks().map(({ text }) => text),
    ["c", "b", "a"],
  );
});

test("bars begin at zero, and error bars are seen whole", () => {
  const bars = { type: "bar", orientation: "h", x: [3, 5], y: ["a", "b"] };
  near(new Axis("x", {}, [bars]).whole[0], 0);
  const errors = {
    ...line([1, 2], [10, 20]),
    error_y: { array: [1, 30], arrayminus: [5, 0] },
  };
  const { whole } = new Axis("y", {}, [errors]);
  assert.ok(whole[0] < 5 && whole[1] > 50);
});

test("cells reach half a cell beyond their middles, contours do not", () => {
  const z = [
    [1, 2],
    [3, 4],
  ];
  assert.deepEqual(new Axis("x", {}, [{ type: "heatmap", x: [0, 2], y: [0, 1], z }]).whole, [-1, 3]);
  assert.deepEqual(new Axis("x", {}, [{ type: "contour", x: [0, 2], y: [0, 1], z }]).whole, [0, 2]);
  assert.deepEqual(edgesOf([0, 1, 4], 2), [0, 1, 4]);
  assert.deepEqual(edgesOf([7], 1), [6.5, 7.5]);
  edgesOf([1, 100], 2, true).forEach((edge, order) => near(edge, [0.1, 10, 1000][order]));
});

test("a range is zoomed about its middle, in the direction of the axis", () => {
  const trace = line([0, 10], [0, 10]);
  const close = (found, expected) => found.forEach((end, order) => near(end, expected[order], 1e-9));
  close(placed("x", { range: [0, 10] }, [trace]).widened(0.5), [2.5, 7.5]);
  close(placed("y", { range: [10, 0] }, [trace]).widened(2), [15, -5]);
  const axis = placed("y", { range: [0, 10] }, [trace]);
  close(axis.between(axis.toPixel(8), axis.toPixel(2)), [2, 8]);
});

test("a low axis has two numbers at least", () => {
  const axis = placed("y", { range: [-37.9, -34.3] }, [line([0, 1], [-37, -35])], 0, 110);
  assert.deepEqual(
    axis.ticks().map(({ value }) => value),
    [-37, -36, -35],
  );
});
