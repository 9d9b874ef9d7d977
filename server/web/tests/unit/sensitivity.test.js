// Shares of variance, against decompositions by hand and the indices of the Ishigami function.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near, randoms } from "./browser.js";
import { LEAST_POINTS, shares } from "../../data/sensitivity.js";

/** Columns of a full grid of values. */
function grid(...values) {
  return values.reduce((columns, own) => {
    const rows = columns[0]?.length ?? 1;
    return [
      ...columns.map((column) => own.flatMap(() => column)),
      own.flatMap((value) => Array(rows).fill(value)),
    ];
  }, /** @type {number[][]} */ ([]));
}

/** A result over the rows of a grid. */
function over(columns, result) {
  return columns[0].map((_, row) => result(...columns.map((column) => column[row])));
}

test("shares of a sum are the parts' variances, and nothing is joint", () => {
  const columns = grid([0, 1], [0, 1]);
  // Variances 1 and 1/4.
  const [a, b] = shares(
    columns,
    over(columns, (x, y) => 2 * x + y),
  );
  near(a.first, 0.8);
  near(a.total, 0.8);
  near(b.first, 0.2);
  near(b.total, 0.2);
  assert.equal(a.interval, null);
});

test("an interaction counts in the total indices of both parameters alone", () => {
  const columns = grid([0, 1], [0, 1]);
  // Of x + x y the squares about the mean are 2.75: 2.25 by x, 0.25 by y and 0.25 by both together.
  const [x, y] = shares(
    columns,
    over(columns, (a, b) => a + a * b),
  );
  near(x.first, 2.25 / 2.75);
  near(y.first, 0.25 / 2.75);
  near(x.total, 2.5 / 2.75);
  near(y.total, 0.5 / 2.75);
});

test("a product about zero is all interaction", () => {
  const columns = grid([-1, 1], [-1, 0, 1], [5, 6]);
  const [a, b, c] = shares(
    columns,
    over(columns, (x, y) => x * y),
  );
  for (const share of [a, b]) {
    assert.ok(Math.abs(share.first) < 1e-12);
    near(share.total, 1);
  }
  assert.ok(Math.abs(c.total) < 1e-12);
});

test("first-order indices of a grid and its joint part add up to one", () => {
  const random = randoms(11);
  const columns = grid([1, 2, 3], [10, 20], [5, 6, 7, 8]);
  const found = shares(
    columns,
    over(columns, () => random()),
  );
  const firsts = found.reduce((sum, share) => sum + share.first, 0);
  assert.ok(firsts <= 1);
  for (const share of found) assert.ok(share.first >= 0 && share.first <= share.total && share.total <= 1);
});

test("shares do not depend on the unit of the result nor on the order of points", () => {
  const random = randoms(13);
  const columns = grid([1, 2, 3], [10, 20]);
  const result = over(columns, () => random());
  const found = shares(columns, result);
  const scaled = shares(
    columns,
    result.map((value) => 7 - 3 * value),
  );
  const turned = shares(
    columns.map((column) => column.toReversed()),
    result.toReversed(),
  );
  found.forEach((share, parameter) => {
    near(scaled[parameter].first, share.first, 1e-9);
    near(turned[parameter].total, share.total, 1e-9);
  });
});

test("levels are means with standard errors", () => {
  const columns = grid([0, 1], [0, 1]);
  const [{ levels }] = shares(
    columns,
    over(columns, (x, y) => x + x * y),
  );
  assert.deepEqual(levels[0], { value: 0, mean: 0, error: 0, count: 2 });
  assert.equal(levels[1].mean, 1.5);
  // The values 1 and 2 deviate by half the root of two.
  near(levels[1].error, Math.SQRT1_2 / Math.SQRT2);
});

test("a result that does not vary has no shares", () => {
  const columns = grid([0, 1], [0, 1]);
  for (const share of shares(columns, [4, 4, 4, 4])) {
    assert.equal(share.first, 0);
    assert.equal(share.total, null);
    assert.equal(share.interval, null);
  }
});

test("indices of drawn points are those of the Ishigami function", () => {
  // Exact shares of sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 over (-pi, pi)^3 (Ishigami and Homma 1990).
  const exact = [0.3139, 0.4424, 0];
  const random = randoms(7);
  const columns = exact.map(() => Array.from({ length: 2000 }, () => Math.PI * (2 * random() - 1)));
  const result = over(columns, (a, b, c) => Math.sin(a) + 7 * Math.sin(b) ** 2 + 0.1 * c ** 4 * Math.sin(a));
  shares(columns, result).forEach(({ first, interval: [low, high], total }, parameter) => {
    assert.ok(Math.abs(first - exact[parameter]) < 0.04, `${first}`);
    assert.ok(low <= exact[parameter] && exact[parameter] <= high, `${low} to ${high}`);
    assert.ok(high - low < 0.15);
    assert.equal(total, null);
  });
});

test("an incomplete grid is estimated", () => {
  const columns = grid([1, 2, 3, 4], [1, 2, 3]).map((column) => column.slice(1));
  assert.ok(columns[0].length >= LEAST_POINTS);
  for (const share of shares(
    columns,
    over(columns, (x, y) => x + y),
  )) {
    assert.equal(share.total, null);
    assert.ok(share.interval[0] < share.first && share.first < share.interval[1]);
  }
});
