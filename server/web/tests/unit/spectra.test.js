// Orbits as seen downhole, and lines of spectra with their modes.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { isWallSeen, modeOf, multiple, peaksTrace, seenDownhole } from "../../draw/orbit.js";
import { loadQuantities } from "../../data/units.js";

await loadQuantities();

test("the low side is down in the picture", () => {
  // A node that lies on the low side, wherever that is.
  for (const angle of [0, 1, Math.PI, -2.5]) {
    const { across, up } = seenDownhole([3 * Math.cos(angle)], [3 * Math.sin(angle)], angle);
    near(up[0], -3);
    assert.ok(Math.abs(across[0]) < 1e-12);
  }
});

test("forward whirl, from u towards v, goes clockwise", () => {
  const angles = [0, 0.1];
  const { across, up } = seenDownhole(angles.map(Math.cos), angles.map(Math.sin), 0.7);
  assert.ok(across[0] * up[1] - up[0] * across[1] < 0);
  near(Math.hypot(across[1], up[1]), 1);
});

test("the wall is seen if its circle passes through the picture", () => {
  const picture = (x, y) => ({ xaxis: { range: x }, yaxis: { range: y } });
  // A circle of 10 mm.
  assert.ok(isWallSeen(picture([-11, 11], [-11, 11]), 0.01));
  assert.ok(isWallSeen(picture([-1, 1], [-10.5, -9]), 0.01));
  assert.ok(!isWallSeen(picture([-1, 1], [-9.9, -8]), 0.01), "inside");
  assert.ok(!isWallSeen(picture([7.2, 8], [-8, -7.2]), 0.01), "outside");
  assert.ok(isWallSeen(picture([7, 8], [-8, -7]), 0.01), "a corner inside");
});

test("marks of a spectrum are at the interpolated lines that are resolved", () => {
  const peaks = [
    { frequency: -2.15, amplitude: 0.0005, whirl: "backward" },
    { frequency: 0, amplitude: 0.03, whirl: "offset" },
    { frequency: 40, amplitude: 0.0001, whirl: "forward", is_resolved: false },
  ];
  const { x, y } = peaksTrace({ attributes: { peaks } }, {});
  assert.deepEqual(x, [-2.15]);
  near(y[0], 0.5);
});

test("multiples of a frequency are those within half the resolution, up to twelve", () => {
  assert.equal(multiple(4.32, 2.16, 0.05, "rotation"), "2 × rotation");
  assert.equal(multiple(-4.33, 2.16, 0.05, "rotation"), "2 × rotation");
  assert.equal(multiple(4.36, 2.16, 0.05, "rotation"), "");
  assert.equal(multiple(24, 2, 0.05, "rotation"), "12 × rotation");
  assert.equal(multiple(26, 2, 0.05, "rotation"), "");
  assert.equal(multiple(0.5, 2, 0.05, "rotation"), "");
  assert.equal(multiple(1, 0, 0.05, "rotation"), "");
});

/** Frequency of the mode of a line. */
function modeNear(line, frequencies, resolution, whirl = 1) {
  const modes = frequencies.map((frequency_hz) => ({ frequency_hz, whirl, kind: "lateral" }));
  return modeOf(line, modes, resolution)?.frequency_hz ?? null;
}

const ALONE = [0.9, 2, 3.1, 4.4];

test("a line has the mode that is within half the resolution and a hundredth of its frequency", () => {
  assert.equal(modeNear(2.03, ALONE, 0.1), 2);
  assert.equal(modeNear(2.0699, ALONE, 0.1), 2);
  assert.equal(modeNear(2.1, ALONE, 0.1), null);
});

test("a mode of the other sense of whirl is not that of a line, but motion to and fro is of both", () => {
  assert.equal(modeNear(-2.03, ALONE, 0.1), null);
  assert.equal(modeNear(-2.03, ALONE, 0.1, -1), 2);
  assert.equal(modeNear(-2.03, ALONE, 0.1, 0), 2);
});

test("no mode is that of a line if modes are so dense that one is near any line", () => {
  const dense = Array.from({ length: 199 }, (_, index) => 0.05 * (index + 1));
  assert.equal(modeNear(2.03, dense, 0.1), null);
});
