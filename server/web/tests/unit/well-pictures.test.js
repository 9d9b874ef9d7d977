// Values and projections of strings at rest.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { rangeOf } from "../../point/well-pictures.js";
import { onNodes } from "../../data/well-frames.js";

test("one range holds the values of all strings, whatever some of them lack", () => {
  assert.deepEqual(rangeOf([[3, null, 5], null, [-2]]), [-2, 5]);
  assert.equal(rangeOf([null, [null]]), null);
});

test("a node between two elements has their mean, at an end or next to a gap the one there is", () => {
  assert.deepEqual(onNodes({ q: [1, 3, null, 7] }, "q", 5), [1, 2, 3, 7, 7]);
  assert.deepEqual(onNodes({ q: [1, 3] }, "q", 2), [1, 3]);
});
