import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { near } from "./browser.js";
import { rowBefore, valueAtTime } from "../../data/at-time.js";
import { TimeCursor, timeInLink } from "../../draw/time-cursor.js";
import { movedByKey, valuesAt } from "../../draw/time-line.js";

test("a value between two samples is on the line between them, and there is none outside or in a gap", () => {
  const times = [1, 2, 4];
  assert.equal(valueAtTime(times, [10, 20, 0], 1.5), 15);
  assert.equal(valueAtTime(times, [10, 20, 0], 3), 10);
  assert.equal(valueAtTime(times, [10, 20, 0], 4), 0);
  for (const time of [0.9, 4.1]) assert.equal(valueAtTime(times, [10, 20, 0], time), null);
  assert.equal(valueAtTime(times, [10, null, 0], 1.5), null);
  assert.equal(valueAtTime(times, [10, null, 0], 2), null);
  assert.equal(valueAtTime([], [], 1), null);
  assert.deepEqual(
    [0, 1, 1.5, 9].map((time) => rowBefore(times, time)),
    [-1, 0, 0, 2],
  );
});

test("a cursor begins at the time of the link, and none of a text that is no number", () => {
  assert.equal(timeInLink(new URLSearchParams("time=12.5")), 12.5);
  assert.equal(timeInLink(new URLSearchParams("time=0")), 0);
  for (const text of ["", "time=", "time=late"]) assert.equal(timeInLink(new URLSearchParams(text)), null);
});

test("a cursor that is moved tells all that follow it at once, and the link once it rests", () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const [kept, told] = [[], []];
  const [view, part] = [new AbortController(), new AbortController()];
  const link = { query: new URLSearchParams(), keep: (changes) => kept.push(changes) };
  const cursor = new TimeCursor(link, view.signal);
  cursor.follow((time) => told.push(["view", time]), view.signal);
  cursor.follow((time) => told.push(["part", time]), part.signal);
  cursor.move(1);
  cursor.move(1);
  cursor.move(NaN);
  part.abort();
  cursor.move(2.00004);
  assert.deepEqual(told, [
    ["view", 1],
    ["part", 1],
    ["view", 2.00004],
  ]);
  assert.deepEqual(kept, []);
  mock.timers.tick(1000);
  assert.deepEqual(kept, [{ time: "2" }]);
  cursor.move(3);
  view.abort();
  mock.timers.tick(1000);
  assert.equal(kept.length, 1, "a view that is gone leaves the link alone");
  mock.timers.reset();
});

test("keys move a cursor by parts of what is shown, and not beyond it", () => {
  near(movedByKey("ArrowRight", 10, [0, 40]), 10.2);
  near(movedByKey("PageDown", 10, [0, 40]), 8);
  assert.equal(movedByKey("PageUp", 39, [0, 40]), 40);
  assert.equal(movedByKey("Home", 10, [5, 40]), 5);
  assert.equal(movedByKey("End", 10, [5, 40]), 40);
  assert.equal(movedByKey("a", 10, [5, 40]), null);
});

test("the curves of a picture are read at the cursor with their units", () => {
  const curve = { type: "scatter", mode: "lines", x: [0, 2] };
  const traces = [
    { ...curve, y: [1, 3], name: "torque", yaxis: "y2" },
    { ...curve, y: [5, 5] },
    { ...curve, y: [null, 5], name: "gap" },
    { ...curve, y: [1, 1], name: "hole", isSilent: true },
    { type: "heatmap", x: [0, 2], y: [0], z: [[1, 2]] },
  ];
  const symbolOf = ({ yaxis }) => (yaxis ? "kN·m" : "");
  assert.deepEqual(valuesAt(traces, symbolOf, 1), ["torque 2 kN·m", "5"]);
});
