// Overview of a point: its node, and names of parts that have room.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";

// Pictures are made for a page.
globalThis.ResizeObserver ??= class {};
globalThis.addEventListener ??= () => {};
const { overviewNode } = await import("../../draw/overview.js");
const { rangeOf } = await import("../../draw/small-pictures.js");
const { AXIS, namedParts, recordedAt, trackTraces } = await import("../../draw/string-track.js");

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

test("a track has each kind of part at its depths, with names and recorded nodes, on an axis of its own", () => {
  const parts = [
    { kind: "drillpipe", from: 0, to: 100 },
    { kind: "collar", from: 100, to: 190 },
    { kind: "collar", from: 190, to: 199.9 },
    { kind: "bit", from: 199.9, to: 200 },
  ];
  const traces = trackTraces(parts, [57.7], 2);
  const named = (name) => traces.find((trace) => trace.name === name);
  assert.ok(traces.every(({ xaxis, yaxis, isSilent }) => xaxis === AXIS && yaxis === "y" && isSilent));
  assert.deepEqual(named("collar").y, [100, 190, null, 190, 199.9, null]);
  // A bit is seen though it is shorter than a pixel.
  assert.deepEqual(named("bit").y, [199.9, 201.9, null]);
  assert.deepEqual(named("names").text, ["drill pipe", "collar", "bit"]);
  assert.deepEqual(named("names").y, [50, 145, 199.95]);
  assert.deepEqual(named("recorded nodes").y, [57.7]);
});

test("recorded nodes are at the depths that they name, or at those of their numbers", () => {
  const recording = { nodes: [{ depth: 57.7 }, { node: 3 }, { node: 9 }] };
  assert.deepEqual(recordedAt({ recording }, { node: [1, 3], measured_depth: [0, 12] }), [57.7, 12]);
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
