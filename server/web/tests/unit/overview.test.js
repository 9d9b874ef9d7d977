// Overview of a point: its node, and names of parts that have room.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";

// Pictures are made for a page.
globalThis.ResizeObserver ??= class {};
globalThis.addEventListener ??= () => {};
const { overviewNode } = await import("../../draw/overview.js");
const { namedParts, rangeOf } = await import("../../draw/small-pictures.js");

const POINT = {
  scenario: { recording: { nodes: [{ node: 10 }, { depth: 57.7 }] } },
  summary: { orbit_radius_rms_10: 0.001, orbit_radius_rms_57_7m: 0.003 },
};

test("the overview is of the node of the link, or else of the one with the largest orbit", () => {
  assert.equal(overviewNode(POINT, new URLSearchParams("node=10")), "10");
  assert.equal(overviewNode(POINT, new URLSearchParams("node=99")), "57.7m");
  assert.equal(overviewNode({ ...POINT, scenario: { recording: { nodes: [] } } }, new URLSearchParams()), "");
});

test("parts are named from the bit up, where names do not cover each other", () => {
  const parts = [
    { kind: "tool_joint", from: 0, to: 1 },
    { kind: "drillpipe", from: 1, to: 60 },
    { kind: "drillpipe", from: 60, to: 100 },
    { kind: "collar", from: 100, to: 180 },
    { kind: "stabilizer", from: 180, to: 182 },
    { kind: "collar", from: 182, to: 199 },
    { kind: "bit", from: 199, to: 200 },
  ];
  const names = (perMetre) => namedParts(parts, perMetre).map(({ name }) => name);
  assert.deepEqual(names(1), ["drill pipe", "collar", "stabilizer", "bit"]);
  assert.deepEqual(names(0.1), ["drill pipe", "bit"]);
  assert.deepEqual(names(10), ["drill pipe", "collar", "stabilizer", "collar", "bit"]);
});

test("ends of values leave gaps out, and give a single value room", () => {
  assert.deepEqual(
    rangeOf([
      [1, null, 3],
      [2, -4],
    ]),
    [-4, 3],
  );
  near(rangeOf([[2]])[0], 1);
  assert.deepEqual(rangeOf([[null]]), [0, 1]);
});
