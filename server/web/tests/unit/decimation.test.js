// Fewer values that stand for many, against values counted by hand.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near, randoms } from "./browser.js";
import { covered, largestShown, maxima, sampled } from "../../data/decimation.js";
import { valueAt } from "../../data/snapshots.js";

/** Five snapshots of two nodes, from 1 s on, half a second apart. */
const FRAMES = {
  nodes: 2,
  count: 5,
  first: 1,
  interval: 0.5,
  columns: { force: Float32Array.from([1, 10, 3, 8, 2, 2, 5, 1, 4, 7]) },
};

test("each column of a map is the largest of its snapshots, at the middle of their times", () => {
  const { time, rows } = maxima(FRAMES, "force", 2);
  assert.deepEqual(rows, [
    [3, 5, 4],
    [10, 2, 7],
  ]);
  assert.deepEqual(time, [1.25, 2.25, 3]);
});

test("a map of every snapshot is the snapshots", () => {
  const { time, rows } = maxima(FRAMES, "force", 1);
  assert.deepEqual(rows, [
    [1, 3, 2, 5, 4],
    [10, 8, 2, 1, 7],
  ]);
  assert.deepEqual(time, [1, 1.5, 2, 2.5, 3]);
});

test("no maximum is lost by decimation", () => {
  const random = randoms(3);
  const count = 997;
  const force = Float32Array.from({ length: count }, random);
  const frames = { nodes: 1, count, first: 0, interval: 1, columns: { force } };
  for (const every of [1, 2, 7, 500, 2000]) {
    const [row] = maxima(frames, "force", every).rows;
    assert.equal(row.length, Math.ceil(count / every));
    assert.equal(Math.max(...row), Math.max(...force));
  }
});

test("the scale of forces ends at nine tenths of those that touch", () => {
  // Zeros are off the wall: of 1 to 101 the value nine tenths up is 91.
  const forces = Float32Array.from([
    ...Array(500).fill(0),
    ...Array.from({ length: 101 }, (_, index) => index + 1),
  ]);
  assert.equal(largestShown(forces), 91);
  assert.equal(largestShown(Float32Array.from([0, 0])), 1);
});

test("the end of the scale is estimated from a part of many forces", () => {
  const random = randoms(5);
  near(largestShown(Float32Array.from({ length: 1_000_000 }, random)), 0.9, 0.01);
});

test("a scale covers all values but half a per cent at either end", () => {
  const values = Array.from({ length: 1001 }, (_, index) => 1000 - index);
  assert.deepEqual(covered(values), [5, 995]);
  assert.deepEqual(covered([...values, NaN, Infinity]), [5, 995]);
  assert.deepEqual(covered([7]), [7, 7]);
  assert.deepEqual(covered([]), [0, 1]);
});

test("samples are every so many values from the first on", () => {
  const values = Float32Array.from({ length: 40_001 }, (_, index) => index);
  const few = sampled(values);
  assert.equal(few.length, 20_001);
  assert.deepEqual(few.slice(0, 3), [0, 2, 4]);
  assert.equal(few.at(-1), 40_000);
  assert.deepEqual(sampled(Float32Array.from([3, 1])), [3, 1]);
});

test("between two snapshots a value is on the straight line, and beyond them it stays", () => {
  const at = (node, time) => valueAt(FRAMES, "force", node, time);
  assert.equal(at(0, 1), 1);
  assert.equal(at(0, 1.25), 2);
  assert.equal(at(1, 2.75), 4);
  assert.equal(at(1, 3), 7);
  assert.equal(at(0, 0), 1);
  assert.equal(at(0, 100), 4);
});
