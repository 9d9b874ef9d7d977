// Contours: lines of equal values on grids, and values between samples.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { between, contourLines } from "../../draw/picture/contour.js";

test("the lines of a slope are straight and at their values", () => {
  const [xs, ys] = [
    [0, 1, 2, 3],
    [0, 1, 2],
  ];
  const z = ys.map(() => xs.map((x) => 10 * x));
  const pieces = contourLines(xs, ys, z, 15);
  assert.equal(pieces.length, 2);
  for (const [x0, , x1] of pieces) {
    near(x0, 1.5);
    near(x1, 1.5);
  }
});

test("the lines of a cone close about its top", () => {
  const axis = Array.from({ length: 41 }, (_, index) => (index - 20) / 10);
  const z = axis.map((y) => axis.map((x) => Math.hypot(x, y)));
  const pieces = contourLines(axis, axis, z, 1.0037);
  const ends = new Map();
  for (const [x0, y0, x1, y1] of pieces) {
    for (const [x, y] of [
      [x0, y0],
      [x1, y1],
    ]) {
      near(Math.hypot(x, y), 1.0037, 5e-3);
      const key = `${x.toFixed(9)} ${y.toFixed(9)}`;
      ends.set(key, (ends.get(key) ?? 0) + 1);
    }
  }
  assert.ok(pieces.length > 40);
  assert.ok([...ends.values()].every((count) => count === 2));
});

test("a saddle has two lines, which depend on its middle", () => {
  const [xs, ys] = [
    [0, 1],
    [0, 1],
  ];
  const lines = (level) =>
    contourLines(
      xs,
      ys,
      [
        [1, 0],
        [0, 1],
      ],
      level,
    );
  // Below the middle the corners of one are connected: lines cut off those of zero, and above it those of one.
  const cutOff = ([x0, y0, x1, y1]) => [Math.round((x0 + x1) / 2), Math.round((y0 + y1) / 2)].join("");
  assert.deepEqual(lines(0.4).map(cutOff).sort(), ["01", "10"]);
  assert.deepEqual(lines(0.6).map(cutOff).sort(), ["00", "11"]);
});

test("next to a gap there is neither line nor value", () => {
  const z = [
    [0, 1, 2],
    [0, null, 2],
  ];
  assert.deepEqual(contourLines([0, 1, 2], [0, 1], z, 0.5), []);
  assert.equal(between(z, 0, 0, 0.5, 0.5), null);
});

test("values between samples are mixed", () => {
  const z = [
    [0, 4],
    [8, 12],
  ];
  assert.equal(between(z, 0, 0, 0, 0), 0);
  assert.equal(between(z, 0, 0, 0.5, 0.5), 6);
  assert.equal(between(z, 0, 0, 1, 0.25), 9);
});
