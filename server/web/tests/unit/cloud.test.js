// Clouds of points: the marks that span the axes of all dots.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near, randoms } from "./browser.js";
import { outermost, spanned } from "../../draw/cloud.js";

test("the outermost points reach as far as all, on linear and logarithmic axes", () => {
  const random = randoms(7);
  const x = Array.from({ length: 5000 }, () => 2 * random() - 1);
  const y = Array.from({ length: 5000 }, () => 100 * random());
  const rows = outermost(x, y);
  assert.ok(rows.length <= 6);
  for (const values of [x, y]) {
    const picked = rows.map((row) => values[row]);
    near(Math.min(...picked), Math.min(...values));
    near(Math.max(...picked), Math.max(...values));
  }
  const positive = (values) => Math.min(...values.filter((value) => value > 0));
  near(positive(rows.map((row) => x[row])), positive(x));
});

test("each word of an axis has a point, and a point without a place none", () => {
  const rows = outermost(["a", "b", "a", "c", "d"], [1, 2, 3, 4, null]);
  assert.deepEqual([...new Set(rows.map((row) => "abac"[row]))].sort(), ["a", "b", "c"]);
  assert.deepEqual(outermost([null], [1]), []);
});

test("colours of the few marks are on the scale of all dots", () => {
  const x = [0, 1, 2, 3];
  const trace = { type: "dots", x, y: x, marker: { size: 4, color: [5, -9, 70, null] }, tell: () => "" };
  const [marks, line] = spanned([trace, { type: "scatter", x }]);
  assert.equal(marks.type, "scatter");
  assert.deepEqual([marks.marker.cmin, marks.marker.cmax], [-9, 70]);
  assert.equal(marks.marker.color.length, marks.x.length);
  assert.equal(line.x, x);
});
