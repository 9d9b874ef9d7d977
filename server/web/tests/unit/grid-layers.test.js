// Grids to which finer ones were added, as layers.

import assert from "node:assert/strict";
import { test } from "node:test";
import { ends, layered } from "../../data/grid-layers.js";

/** Points of a grid. */
function pointsOf(across, up) {
  return up.flatMap((y) => across.map((x) => [x, y]));
}

/** Layers of points, each with the points in its cells. */
function layersOf(points, ...requests) {
  const found = layered(
    points.map(([x]) => x),
    points.map(([, y]) => y),
    requests,
  );
  return found.map(({ across, up, at }) => ({
    across,
    up,
    points: at.map((row) => row.map((point) => points[point] ?? null)),
  }));
}

const COARSE = { x: { values: [0, 10] }, y: { values: [0, 1] } };
const FINE = { x: { from: 0, to: 5, count: 3 }, y: { values: [0] } };

test("a grid is one layer, whatever the order of its points", () => {
  const points = pointsOf([0, 10], [0, 1]);
  for (const order of [points, points.toReversed()]) {
    assert.deepEqual(layersOf(order, COARSE), [
      {
        across: [0, 10],
        up: [0, 1],
        points: [
          [
            [0, 0],
            [10, 0],
          ],
          [
            [0, 1],
            [10, 1],
          ],
        ],
      },
    ]);
  }
});

test("a finer grid is a layer of its own, with the points that it shares", () => {
  const layers = layersOf([...pointsOf([0, 10], [0, 1]), [2.5, 0], [5, 0]], COARSE, FINE);
  assert.deepEqual(
    layers.map(({ across, up }) => [across, up]),
    [
      [
        [0, 10],
        [0, 1],
      ],
      [[0, 2.5, 5], [0]],
    ],
  );
  assert.deepEqual(layers[1].points, [
    [
      [0, 0],
      [2.5, 0],
      [5, 0],
    ],
  ]);
});

test("a request whose points are all drawn makes no layer", () => {
  const points = pointsOf([0, 10], [0, 1]);
  assert.equal(layersOf(points, COARSE, { x: { values: [10] }, y: { values: [1] } }).length, 1);
});

test("points of no request that lists values are a layer as well", () => {
  const layers = layersOf([...pointsOf([0, 10], [0, 1]), [7, 0.5]], COARSE, { x: undefined, y: undefined });
  assert.deepEqual(layers[1], { across: [7], up: [0.5], points: [[[7, 0.5]]] });
});

test("values of a range are found in spite of rounding, linear and logarithmic", () => {
  const linear = Array.from({ length: 4 }, (_, index) => 0.01 + 0.01 * index);
  const logarithmic = [1, 10, 100].map((value) => value * (1 + 1e-15));
  const request = { x: { from: 0.01, to: 0.04, count: 4 }, y: { from: 1, to: 100, count: 3, scale: "log" } };
  const [layer, rest] = layersOf([...pointsOf(linear, logarithmic), [0.5, 50]], request);
  assert.deepEqual([layer.across, layer.up], [linear, logarithmic]);
  assert.deepEqual([rest.across, rest.up], [[0.5], [50]]);
});

test("cells meet halfway and end at the outermost values, beyond which nothing was computed", () => {
  assert.deepEqual(ends([1, 4, 10], [1, 4, 10]), [1, 2.5, 7, 10]);
  assert.deepEqual(ends([1, 4], [1, 4, 10]), [1, 2.5, 4]);
  assert.deepEqual(ends([1, 100, 10_000], [1, 100, 10_000], true), [1, 10, 1000, 10_000]);
});

test("a single value's cell ends halfway to the next values", () => {
  assert.deepEqual(ends([4], [1, 4, 10]), [2.5, 7]);
  assert.deepEqual(ends([1], [1, 4, 10]), [1, 2.5]);
  assert.deepEqual(ends([10], [1, 4, 10]), [7, 10]);
  assert.deepEqual(ends([4], [4]), [3.8, 4.2]);
  assert.deepEqual(ends([0], [0]), [-0.5, 0.5]);
});
