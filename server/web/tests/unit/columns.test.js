// Numbers of a column below each other, against texts written out.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { aligner, placeIn, rangeOf, roomyRange } from "../../data/columns.js";
import { loadQuantities, THOUSANDS } from "../../data/units.js";
import { variedWords } from "../../list/rows.js";

const written = (/** @type {number[]} */ values) => values.map(aligner(values, 5));

test("numbers of a column have equal decimals, as few as they need", () => {
  assert.deepEqual(written([0.01, 0.04, 0.025]), ["0.010", "0.040", "0.025"]);
  assert.deepEqual(written([1200, 1500]), ["1200", "1500"]);
  assert.deepEqual(written([123.456, -1.5, 0]), ["123.46", "−1.50", "0.00"]);
});

test("small numbers keep three digits next to large ones", () => {
  assert.deepEqual(written([123.456, 0.012345]), ["123.4560", "0.0123"]);
});

test("a range too wide for equal decimals has numbers in their own digits", () => {
  assert.deepEqual(
    written([1e8, 1e-7]),
    ["1.0000e8", "1.0000e-7"].map((_, at) => aligner([], 5)([1e8, 1e-7][at])),
  );
});

test("thousands are apart in a column that has numbers of five digits", () => {
  assert.deepEqual(written([12345.6, 1234]), [`12${THOUSANDS}346`, `1${THOUSANDS}234`]);
});

test("tiny numbers have powers of ten", () => {
  assert.deepEqual(written([1e-5, 2.5e-5]), ["1.0000e-5", "2.5000e-5"]);
});

test("a value has a place in the range of its column, unless all are the same", () => {
  assert.equal(rangeOf([]), null);
  assert.equal(placeIn(/** @type {[number, number]} */ (rangeOf([2, 4, 3])), 3), 0.5);
  assert.equal(placeIn([2, 2], 2), null);
});

test("a range has room beyond its values, also one of a single value", () => {
  assert.deepEqual(roomyRange([0, null, 100], 0.04), [-4, 104]);
  assert.deepEqual(roomyRange([50], 0.04), [48, 52]);
  assert.deepEqual(roomyRange([0, 0], 0.04), [-0.04, 0.04]);
  assert.equal(roomyRange([null], 0.04), undefined);
});

test("varied parameters are named by the vocabulary, and a sweep without them has no words", async () => {
  await loadQuantities();
  assert.equal(variedWords({ varied: ["flow_rate", "mud.density"] }), "Flow rate × mud density");
  assert.equal(variedWords({ varied: ["no.such_field"] }), "No.such field");
  assert.equal(variedWords({ varied: [] }), "");
  assert.equal(variedWords({}), "");
});
