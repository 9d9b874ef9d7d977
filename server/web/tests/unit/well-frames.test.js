// Frames of nodes in space, against wells whose directions are known.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near, randoms } from "./browser.js";
import { nodeFrames } from "../../data/well-frames.js";

/** A straight well of three nodes: its direction north, east and down. */
function straight([north, east, down], angle = 0) {
  const path = (part) => [0, 1, 2].map((step) => 100 * step * part);
  return nodeFrames({
    north: path(north),
    east: path(east),
    true_vertical_depth: path(down),
    low_side_angle: [angle, angle, angle],
  });
}

function same(actual, expected) {
  actual.forEach((part, index) =>
    assert.ok(Math.abs(part - expected[index]) < 1e-12, `${actual} is not ${expected}`),
  );
}

const dot = (a, b) => a.reduce((sum, part, index) => sum + part * b[index], 0);

test("in a horizontal hole the low side is down", () => {
  const { u, v, tangent } = straight([1, 0, 0]);
  same(tangent[1], [1, 0, 0]);
  same(u[1], [0, 0, 1]);
  // Across it to the left of who looks north.
  same(v[1], [0, -1, 0]);
});

test("in a vertical hole north takes the place of the low side", () => {
  const { u, v, tangent } = straight([0, 0, 1]);
  same(tangent[1], [0, 0, 1]);
  same(u[1], [1, 0, 0]);
  same(v[1], [0, 1, 0]);
});

test("the low side is at its angle from u towards v", () => {
  for (const angle of [0.3, Math.PI / 2, -2]) {
    const { u, v } = straight([1, 0, 0], angle);
    const low = u[1].map((part, index) => Math.cos(angle) * part + Math.sin(angle) * v[1][index]);
    same(low, [0, 0, 1]);
  }
});

test("frames are right-handed and at right angles in any well", () => {
  const random = randoms(17);
  const column = (step) => Array.from({ length: 50 }, (_, node) => step * node + random());
  const statics = {
    north: column(3),
    east: column(-2),
    true_vertical_depth: column(5),
    low_side_angle: column(0),
  };
  const { axis, u, v, tangent } = nodeFrames(statics);
  axis.forEach((place, node) => {
    assert.deepEqual(place, [statics.north[node], statics.east[node], statics.true_vertical_depth[node]]);
    const [a, b, c] = [u[node], v[node], tangent[node]];
    for (const vector of [a, b, c]) near(Math.hypot(...vector), 1);
    for (const product of [dot(a, b), dot(b, c), dot(c, a)]) assert.ok(Math.abs(product) < 1e-12);
    const cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    near(dot(cross, c), 1);
  });
});
