// Sweeps that have not begun, and those before them.

import assert from "node:assert/strict";
import { test } from "node:test";
import { hasNotBegun, sweepsBefore } from "../../data/queue.js";

const sweep = (
  id,
  { owner = "anne", priority = 0, state = "running", queued = 2, running = 0, ...rest } = {},
) => ({
  id,
  owner,
  priority,
  state,
  progress: 0,
  counts: { total: 2, queued, running, succeeded: 0, failed: 0, ...rest },
});

test("a sweep has not begun while no point of it has run", () => {
  assert.ok(hasNotBegun(sweep("1")));
  assert.ok(!hasNotBegun(sweep("1", { running: 1, queued: 1 })));
  assert.ok(!hasNotBegun(sweep("1", { succeeded: 1, queued: 1 })));
  assert.ok(!hasNotBegun(sweep("1", { state: "paused" })));
  assert.ok(!hasNotBegun({ ...sweep("1"), progress: 0.1 }));
});

test("sweeps before another are older or of higher priority, of its owner, and have points left", () => {
  const mine = sweep("5");
  const all = [
    mine,
    sweep("1"),
    sweep("2", { queued: 0, running: 1 }),
    sweep("3", { queued: 0 }),
    sweep("4", { owner: "bert" }),
    sweep("6"),
    sweep("7", { priority: 1 }),
    sweep("0", { priority: -1 }),
    sweep("00", { state: "paused" }),
  ];
  assert.equal(sweepsBefore(mine, all), 3);
  assert.equal(sweepsBefore(mine, [mine]), 0);
});
