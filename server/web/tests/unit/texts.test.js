// Texts that readers type: values of axes, conditions of tables.

import "./browser.js";
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { choose } from "../../data/settings.js";
import { loadQuantities } from "../../data/units.js";
import { changeOf, object, read, span, Unreadable, written } from "../../submit/values.js";
import { conditions } from "../../sweep/table.js";
import { tickedIn } from "../../sweep/ticked.js";

await loadQuantities();
beforeEach(() => choose("units", "si"));

const AXES = [
  ["0.01, 0.02", { values: [0.01, 0.02] }],
  ["1300", { values: [1300] }],
  ["0.01:0.06:6", { from: 0.01, to: 0.06, count: 6 }],
  ["1:100:3:log", { from: 1, to: 100, count: 3, scale: "log" }],
];
test("values of an axis are a list or a range, and are written as they are read", () => {
  for (const [text, axis] of AXES) {
    assert.deepEqual(span(text, "x", false), axis);
    assert.equal(written(axis), text);
  }
});

test("a design that draws takes a range without a count", () => {
  assert.deepEqual(span("0.01:0.06", "x", true), { from: 0.01, to: 0.06 });
  assert.deepEqual(span("1 : 100 : log", "x", true), { from: 1, to: 100, scale: "log" });
});

test("a text that is no axis is refused at its field", () => {
  const texts = {
    "0.01:0.06": /needs a count/,
    "0.01:": /An empty value is not a number/,
    "1,,2": /An empty value/,
    "1, two": /^two is not a number/,
    "1:log": /from:to:count/,
  };
  for (const [text, message] of Object.entries(texts)) {
    assert.throws(
      () => span(text, "mud.density", false),
      (error) =>
        error instanceof Unreadable && message.test(error.message) && error.pointer === "/axes/mud.density",
    );
  }
});

test("values of changes are JSON, or else words", () => {
  assert.equal(read("2.5"), 2.5);
  assert.equal(read("draft"), "draft");
  assert.deepEqual(read("[1, null]"), [1, null]);
  assert.equal(changeOf({ name: "duration", values: "60" }), 60);
  assert.throws(() => changeOf({ name: "duration", values: " " }), {
    constructor: Unreadable,
    pointer: "/set/duration",
  });
  assert.deepEqual(object('{"a": 1}'), { a: 1 });
  for (const text of ["", "[1]", "3", "{"]) assert.equal(object(text), null);
});

/** Values that pass the conditions of a text. */
function passing(text, name, values) {
  const { tests, problem } = conditions(text, ["flow_rate", "state", "mud_density"]);
  assert.equal(problem, "");
  return values.filter((value) => tests.every((one) => one.name !== name || one.holds(value)));
}

test("conditions compare numbers and words", () => {
  const rates = [0.01, 0.02, 0.03, null];
  assert.deepEqual(passing("flow_rate>0.02", "flow_rate", rates), [0.03]);
  assert.deepEqual(passing("flow_rate>=0.02 state=failed", "flow_rate", rates), [0.02, 0.03]);
  assert.deepEqual(passing("flow_rate<0.03 flow_rate!=0.01", "flow_rate", rates), [0.02]);
  assert.deepEqual(passing("state=failed", "state", ["failed", "succeeded", null]), ["failed"]);
  assert.deepEqual(passing("state!=failed", "state", ["failed", "succeeded", null]), ["succeeded", null]);
});

test("conditions are in the units shown, to rounding", () => {
  choose("units", "field");
  const tenPounds = (10 * 0.45359237) / (231 * 0.0254 ** 3);
  assert.deepEqual(passing("mud_density=10", "mud_density", [10, tenPounds]), [tenPounds]);
});

test("a condition that cannot be read is named", () => {
  assert.match(conditions("flow_rate>0.02 nothing", ["flow_rate"]).problem, /: nothing is not\.$/);
  assert.equal(conditions("depth>3", ["flow_rate"]).problem, "There is no column depth.");
});

test("ticked points of a link are ordinals, each once, six at most", () => {
  assert.deepEqual(tickedIn(""), []);
  assert.deepEqual(tickedIn("3,12,3"), [3, 12]);
  assert.deepEqual(tickedIn("a,-1,0,2.5,4"), [4]);
  assert.equal(tickedIn("1,2,3,4,5,6,7").length, 6);
});
