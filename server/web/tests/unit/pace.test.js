// The time left of a sweep, from its progress while points ran.

import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { near } from "./browser.js";
import { Pace } from "../../data/pace.js";

/**
 * Time left after looks at a sweep of 100 points.
 * @param {[second: number, progress: number, running: number, state?: string][]} looks
 * @param {number | null} [pointSeconds]
 */
function left(looks, pointSeconds = null) {
  mock.timers.enable({ apis: ["Date"], now: 0 });
  const pace = new Pace();
  for (const [second, progress, running, state = "running"] of looks) {
    mock.timers.setTime(1000 * second);
    pace.note({ state, progress, counts: { total: 100, running } });
  }
  mock.timers.reset();
  pace.pointSeconds = pointSeconds;
  return pace.left();
}

test("a tenth in ten seconds leaves nine of these", () => {
  near(
    left([
      [0, 0, 2],
      [10, 0.1, 2],
    ]),
    90,
  );
});

test("pauses and waits for a worker do not count", () => {
  const looks = [
    [0, 0, 0],
    [1000, 0, 2],
    [1010, 0.1, 2, "paused"],
    [4610, 0.1, 2],
    [4620, 0.2, 2],
  ];
  near(left(looks), 80);
});

test("only the last two minutes count", () => {
  near(
    left([
      [0, 0, 2],
      [1000, 0.8, 2],
      [1200, 0.9, 2],
    ]),
    200,
  );
});

test("before that a point's time counts: 75 points, two at a time", () => {
  near(left([[0, 0.25, 2]], 4), 150);
  // Less than three seconds say too little.
  near(
    left(
      [
        [0, 0.25, 2],
        [2, 0.3, 2],
      ],
      4,
    ),
    140,
  );
});

test("added points and new tries do not count as progress", () => {
  near(
    left(
      [
        [0, 0, 2],
        [10, 0.1, 2],
        [20, 0.05, 2],
      ],
      4,
    ),
    ((0.95 / 0.1) * 10_000) / 1000,
  );
});

test("the time left is unknown before anything is, and while nothing runs", () => {
  assert.equal(left([]), null);
  assert.equal(left([[0, 0.25, 2]]), null);
  assert.equal(
    left(
      [
        [0, 0, 2],
        [10, 0.1, 0],
      ],
      4,
    ),
    null,
  );
  assert.equal(
    left(
      [
        [0, 0, 2],
        [10, 0.1, 2, "paused"],
      ],
      4,
    ),
    null,
  );
});
