// Snapshots that arrive in parts, against those of one request by the service's rules.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { appended, windowsOf } from "../../data/snapshots.js";

const NODES = 3;
const HZ = 25;

/** Numbers of the snapshots that the service returns for a window. */
function served({ count, first, interval }, { from, to }, most) {
  const below = (end) => Math.max(0, Math.min(count, Math.ceil((end - first) / interval - 1e-2)));
  const [start, end] = [below(from), Math.max(below(from), below(to))];
  const stride = Math.max(1, Math.ceil((end - start) / most));
  return Array.from({ length: Math.ceil((end - start) / stride) }, (_, at) => start + at * stride);
}

function* cases() {
  for (const count of [2, 51, 52, 250, 1500, 1501, 1507])
    for (const first of [0, 10, 1 / 3])
      for (const most of [2, 7, 100, 433, 5000])
        for (const [from, to] of [
          [0, 1e3],
          [first + 0.41, first + count / HZ - 0.2],
        ])
          yield { times: { nodes: NODES, count, first, interval: 1 / HZ }, window: { from, to }, most };
}

test("consecutive windows have the snapshots of one, however it is thinned", () => {
  for (const { times, window, most } of cases()) {
    const parts = windowsOf(times, window, most);
    const all = served(times, window, most);
    const together = parts.flatMap((part) => served(times, part, Math.max(1, part.frames)));
    assert.deepEqual(together, all, JSON.stringify({ times, window, most, parts }));
  }
});

test("the first window has a quarter of a second of motion, and each further one is longer", () => {
  const times = { nodes: NODES, count: 1500, first: 0, interval: 1 / HZ };
  const parts = windowsOf(times, { from: 0, to: 60 }, 5000);
  assert.deepEqual(
    parts.map(({ frames }) => frames),
    [8, 32, 128, 512, 820],
  );
  assert.equal(parts[0].from, 0);
  assert.ok(parts[0].to - 1 / HZ >= 0.25);
  // Few snapshots are one request.
  assert.deepEqual(windowsOf(times, { from: 3, to: 3.5 }, 5000), [{ from: 3, to: 3.5, frames: 13 }]);
});

test("a window without snapshots is requested as it is", () => {
  const times = { nodes: NODES, count: 100, first: 0, interval: 0.1 };
  assert.deepEqual(windowsOf(times, { from: 0.01, to: 0.05 }, 50), [{ from: 0.01, to: 0.05, frames: 0 }]);
});

test("parts are appended snapshot after snapshot", () => {
  const part = (first, values) => ({
    nodes: 2,
    count: values.length / 2,
    first,
    interval: 0.5,
    columns: { u: Float32Array.from(values) },
  });
  const both = appended(part(1, [1, 2, 3, 4]), part(2, [5, 6]));
  assert.deepEqual([both.count, both.first, both.interval], [3, 1, 0.5]);
  assert.deepEqual([...both.columns.u], [1, 2, 3, 4, 5, 6]);
});
