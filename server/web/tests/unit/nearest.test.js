// What a picture tells of at a place, and which points of long lines are drawn.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near, randoms } from "./browser.js";
import { Axis } from "../../draw/picture/axis.js";
import { barAt, barsOf } from "../../draw/picture/bars.js";
import { cellAt, cellEdges } from "../../draw/picture/cells.js";
import { thinned } from "../../draw/picture/marks.js";
import { alongside, cellOf, closest, nearestAlong, nearestPlace } from "../../draw/picture/nearest.js";

/** A trace as it is drawn, on axes of a pixel a unit. */
function drawn(trace) {
  const x = Object.assign(new Axis("x", { range: [0, 100] }, [trace]), { offset: 0, length: 100 });
  const y = Object.assign(new Axis("y", { range: [0, 100] }, [trace]), { offset: 0, length: 100 });
  if (trace.z) return { trace, x, y, ...cellEdges(trace, x, y) };
  return { trace, x, y, places: { x: x.toPixels(trace.x), y: y.toPixels(trace.y) } };
}
const marks = (x, y, more = {}) => ({ type: "scatter", mode: "markers", x, y, ...more });

test("the nearest of many places is that of a search through all", () => {
  const random = randoms(3);
  const count = 20_000;
  const places = {
    x: Float64Array.from({ length: count }, () => 1000 * random()),
    y: Float64Array.from({ length: count }, () => 500 * random()),
  };
  const found = nearestPlace(places, 500, 250, 20);
  const apart = (row) => Math.hypot(places.x[row] - 500, places.y[row] - 250);
  const least = Array.from({ length: count }, (_, row) => apart(row)).reduce((a, b) => Math.min(a, b));
  near(apart(found.row), least);
  near(found.distance, least);
});

test("what is too far and gaps are not read", () => {
  const places = { x: Float64Array.of(0, NaN), y: Float64Array.of(0, 5) };
  assert.equal(nearestPlace(places, 30, 0, 20), null);
  assert.equal(nearestPlace(places, 3, 4, 5).row, 0);
  assert.equal(nearestAlong(Float64Array.of(0, 1), Float64Array.of(NaN, 7), 0), 1);
});

test("of equally near samples the last one is read, which ends an element", () => {
  assert.equal(nearestAlong(Float64Array.of(0, 10, 10, 20), Float64Array.of(1, 2, 3, 4), 11), 2);
});

test("the mark above another one is read, with its key", () => {
  const one = drawn(marks([50], [50], { customdata: [7] }));
  const other = drawn(marks([50], [50], { customdata: [8] }));
  const reading = closest([one, other], 52, 50);
  assert.equal(reading.customdata, 8);
  assert.deepEqual([reading.x, reading.y], [50, 50]);
  assert.equal(closest([one], 50, 75), null);
  assert.equal(closest([drawn(marks([50], [50], { isSilent: true }))], 50, 50), null);
});

test("a mark is read before the cell below it, and else the cell", () => {
  const cells = drawn({
    type: "heatmap",
    x: [0, 50, 100],
    y: [0, 50, 100],
    z: [
      [1, 2],
      [3, null],
    ],
    customdata: [
      [11, 12],
      [13, 14],
    ],
  });
  const mark = drawn(marks([25], [25], { customdata: [99] }));
  assert.equal(closest([cells, mark], 25, 77).customdata, 99);
  const reading = closest([cells, mark], 10, 20);
  assert.deepEqual([reading.customdata, reading.x, reading.y, reading.z], [13, 25, 75, 3]);
  assert.equal(closest([cells, mark], 90, 10), null);
});

test("cells are found between their ends, rising or falling", () => {
  for (const edges of [
    [0, 10, 30, 60],
    [60, 30, 10, 0],
  ]) {
    const find = cellAt(edges);
    for (let pixel = 0.5; pixel < 60; pixel += 1) {
      assert.equal(find(pixel), cellOf(edges, pixel));
      assert.equal(find(60 - pixel), cellOf(edges, 60 - pixel));
    }
    assert.equal(find(-1), -1);
    assert.equal(find(61), -1);
  }
});

test("all lines are read along a cursor", () => {
  const lines = [drawn(marks([0, 10, 20], [1, 2, 3])), drawn(marks([0, 11, 20], [4, null, 6]))];
  assert.deepEqual(
    alongside(lines, "x", 12).map(({ y }) => y),
    [2, 6],
  );
});

test("bars of one word stand next to each other and are found", () => {
  const traces = [
    { type: "bar", x: ["a", "b"], y: [3, -2], marker: {} },
    { type: "bar", x: ["a", "b"], y: [1, null], marker: {} },
  ];
  const x = Object.assign(new Axis("x", {}, traces), { offset: 0, length: 100 });
  const y = Object.assign(new Axis("y", { range: [-5, 5] }, traces), { offset: 0, length: 100 });
  const [first, second] = traces.map((trace) => barsOf(trace, traces, x, y));
  assert.equal(second.length, 1);
  near(first[0].x + first[0].width, second[0].x);
  assert.equal(barAt(first, first[1].x + 1, 60).row, 1);
  assert.equal(barAt(first, first[1].x + 1, 40), undefined);
});

test("a long line keeps its ends, extremes and gaps", () => {
  const count = 100_000;
  const x = Float64Array.from({ length: count }, (_, row) => (row / count) * 800);
  const y = Float64Array.from({ length: count }, (_, row) => Math.sin(row));
  y[51_234] = 50;
  y[70_000] = NaN;
  const kept = thinned({ x, y });
  assert.ok(kept.x.length < 8000, `${kept.x.length}`);
  assert.equal(kept.x[0], x[0]);
  assert.equal(kept.x.at(-1), x[count - 1]);
  assert.ok(kept.y.includes(50));
  assert.ok(kept.y.some(Number.isNaN));
  assert.ok(kept.x.every((value, row) => row === 0 || value >= kept.x[row - 1]));
});
