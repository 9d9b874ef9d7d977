// Lines and filters of parallel coordinates.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawnEnds, joined, keptLines, nearestLine } from "../../sweep/parallel-lines.js";

const axis = (values, ranges = []) => ({ name: "a", title: "a", values, ranges });

test("a line is kept that lies in a filter of each axis", () => {
  const dimensions = [
    axis(
      [1, 2, 3, 4],
      [
        [2, 3],
        [4, Infinity],
      ],
    ),
    axis([9, 8, 7, 6], [[-Infinity, 7]]),
    axis([0, 0, 0, 0]),
  ];
  assert.deepEqual(keptLines(dimensions), [2, 3]);
  assert.deepEqual(keptLines([axis([5, 6])]), [0, 1]);
});

test("filters that overlap are one, and ends beyond the values are open", () => {
  assert.deepEqual(
    joined(
      [
        [6, 8],
        [1, 3],
        [2, 4],
      ],
      [0, 10],
    ),
    [
      [1, 4],
      [6, 8],
    ],
  );
  assert.deepEqual(
    joined(
      [
        [-1, 2],
        [9, 12],
      ],
      [0, 10],
    ),
    [
      [-Infinity, 2],
      [9, Infinity],
    ],
  );
});

test("a filter of all values, or of next to none, is none", () => {
  assert.deepEqual(joined([[-1, 11]], [0, 10]), []);
  assert.deepEqual(joined([[5, 5.01]], [0, 10]), []);
});

test("an axis of one value reaches beyond it", () => {
  assert.deepEqual(drawnEnds(axis([5, 5])), [4.5, 5.5]);
  assert.deepEqual(drawnEnds(axis([0])), [-1, 1]);
});

test("the line next to a place is found between two axes, among some lines", () => {
  const axes = [
    { x: 0, heights: [0, 100, 40] },
    { x: 100, heights: [100, 0, 40] },
    { x: 200, heights: [0, 0, 90] },
  ];
  // Halfway lines 0 and 1 cross at 50; a quarter of the way they are at 25 and 75.
  assert.equal(nearestLine(axes, [0, 1, 2], 25, 27), 0);
  assert.equal(nearestLine(axes, [0, 1, 2], 25, 73), 1);
  assert.equal(nearestLine(axes, [1, 2], 25, 27), null);
  assert.equal(nearestLine(axes, [0, 1, 2], 150, 66), 2);
  assert.equal(nearestLine(axes, [0, 1, 2], 250, 50), null);
});
