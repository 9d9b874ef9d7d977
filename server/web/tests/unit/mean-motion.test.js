// Motion about the mean position, and the factor that suits it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { magnified, meansOf, suitedMagnification } from "../../data/mean-motion.js";

// Two nodes in four snapshots: one at rest, one that circles with 2 mm about (30, -4) mm.
const circle = [0, 1, 2, 3].map((quarter) => (quarter * Math.PI) / 2);
const frames = {
  nodes: 2,
  count: 4,
  columns: {
    u: Float32Array.from(circle.flatMap((angle) => [0.01, 0.03 + 0.002 * Math.cos(angle)])),
    v: Float32Array.from(circle.flatMap((angle) => [0, -0.004 + 0.002 * Math.sin(angle)])),
  },
};

test("the mean of each node and the largest distance from it are found", () => {
  const { u, v, reach } = meansOf(frames);
  near(u[0], 0.01, 1e-6);
  near(u[1], 0.03, 1e-6);
  near(v[1], -0.004, 1e-6);
  near(reach, 0.002, 1e-5);
});

test("motion is multiplied about the mean, which stays", () => {
  const means = meansOf(frames);
  const [u, v] = magnified(means, 1, [0.032, -0.004], 5);
  near(u, 0.04, 1e-6);
  near(v, -0.004, 1e-6);
  const still = magnified(means, 0, [means.u[0], means.v[0]], 100);
  assert.deepEqual(still, [means.u[0], means.v[0]]);
});

test("the suited factor fills two fifths of the widest clearance at most", () => {
  assert.equal(suitedMagnification(0.002, [0.0001, 0.05]), 10);
  assert.equal(suitedMagnification(0.00201, [0.05]), 5);
  assert.equal(suitedMagnification(1, [0.05]), 1);
  assert.equal(suitedMagnification(0, [0.05]), 200);
});
