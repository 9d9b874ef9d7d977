// Points that are chosen in the scatter.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { pointsWithin } from "../../sweep/scatter.js";

test("an area has the points whose values are both in it", () => {
  const area = { x: [1, 2], y: [-1, 0] };
  const places = [
    [1, 2, 3, 1.5, null],
    [0, -1, 0, 0.1, 0],
  ];
  assert.deepEqual(pointsWithin(area, [7, 8, 9, 10, 11], places), [7, 8]);
});

test("words have no ends along an axis", () => {
  const places = [
    ["whirl", null],
    [0, 0],
  ];
  assert.deepEqual(pointsWithin({ x: [0, 0.2], y: [-1, 1] }, [1, 2], places), [1]);
});
