// Statistics of orbits, against circles and lines, and the windows that verifying looks at.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import {
  amplitudes,
  biasOver,
  comparedWindow,
  isUnsettled,
  orbitStatistics,
  recordedAs,
  spectrumWindow,
} from "../../data/statistics.js";

const SAMPLES = 400;
const angles = Array.from({ length: SAMPLES }, (_, sample) => (2 * Math.PI * sample) / SAMPLES);

/** An ellipse about a place: its half axes along u and v. */
function ellipse([u, v], [along, across]) {
  return {
    u: angles.map((angle) => u + along * Math.cos(angle)),
    v: angles.map((angle) => v + across * Math.sin(angle)),
  };
}

test("a circle about the axis has its radius for size, mean, largest and smallest", () => {
  const found = orbitStatistics(ellipse([0, 0], [2, 2]), 0, SAMPLES);
  for (const name of [
    "orbit_radius_rms",
    "orbit_mean_radius",
    "orbit_largest_radius",
    "orbit_smallest_radius",
  ]) {
    near(found[name], 2);
  }
  assert.ok(found.orbit_radius_deviation < 1e-12);
  assert.ok(found.orbit_offset < 1e-12);
  near(found.peak_to_peak_u, 4);
  near(found.peak_to_peak_v, 4);
});

test("the size of an ellipse is the root of its mean squares, wherever it lies", () => {
  // Mean squares of a cosine and a sine are a half each.
  const size = Math.sqrt((3 ** 2 + 1 ** 2) / 2);
  for (const place of [
    [0, 0],
    [3, 4],
    [-30, 40],
  ]) {
    const found = orbitStatistics(ellipse(place, [3, 1]), 0, SAMPLES);
    near(found.orbit_radius_rms, size);
    near(found.peak_to_peak_u, 6);
    near(found.peak_to_peak_v, 2);
    assert.ok(Math.abs(found.orbit_offset - Math.hypot(...place)) < 1e-12);
  }
});

test("an orbit off the axis has radii from the nearest to the farthest place", () => {
  const found = orbitStatistics(ellipse([5, 0], [2, 2]), 0, SAMPLES);
  near(found.orbit_largest_radius, 7);
  near(found.orbit_smallest_radius, 3);
  // Mean of the square of the radius is that of its mean and its deviation.
  near(found.orbit_mean_radius ** 2 + found.orbit_radius_deviation ** 2, 5 ** 2 + 2 ** 2);
});

test("statistics are of the rows of the window alone, whose end is open", () => {
  const columns = { u: [9, 1, 3, 9], v: [9, 0, 0, 9] };
  const found = orbitStatistics(columns, 1, 3);
  near(found.orbit_offset, 2);
  near(found.orbit_radius_rms, 1);
  near(found.orbit_mean_radius, 2);
  near(found.peak_to_peak_u, 2);
  assert.equal(found.peak_to_peak_v, 0);
  assert.equal(orbitStatistics(columns, 2, 2), null);
});

test("whirl amplitudes are root mean squares about the mean position of each node", () => {
  const nodes = 3;
  const [u, v] = [new Float64Array(SAMPLES * nodes), new Float64Array(SAMPLES * nodes)];
  angles.forEach((angle, frame) => {
    // A circle far off the axis, a line, and a node at rest.
    u[frame * nodes] = 1e6 + 1e-3 * Math.cos(angle);
    v[frame * nodes] = -1e6 + 1e-3 * Math.sin(angle);
    u[frame * nodes + 1] = 4 * Math.cos(angle);
    u[frame * nodes + 2] = 7;
  });
  const [circle, line, rest] = amplitudes({ nodes, count: SAMPLES, columns: { u, v } });
  near(circle, 1e-3, 1e-6);
  near(line, 4 / Math.sqrt(2));
  assert.equal(rest, 0);
});

/** A point of 60 s at 1 kHz. */
function point(recording, summary) {
  return { scenario: { duration: 60, recording: { rate_hz: 1000, nodes: [], ...recording } }, summary };
}

test("a bias is that of the window that verifying looks at", () => {
  const bias = () => "bias";
  // Without a window of its own a run is verified over its last third.
  assert.equal(biasOver(point({}), { from: 40, to: 60 }, bias)("x"), "bias");
  assert.equal(biasOver(point({}), { from: 40.004, to: 60 }, bias)("x"), "bias");
  assert.equal(biasOver(point({}), { from: 30, to: 60 }, bias)("x"), "");
  const own = point({ orbit_window: { from: 10, to: 20 } });
  assert.equal(biasOver(own, { from: 10, to: 20 }, bias)("x"), "bias");
  assert.equal(biasOver(own, { from: 40, to: 60 }, bias)("x"), "");
  // A run that settles keeps at most 80 s of the window that it reports.
  const settled = { ...point({ orbit_window: "settled" }, { statistics_from: 100, statistics_to: 300 }) };
  assert.equal(biasOver(settled, { from: 220, to: 300 }, bias)("x"), "bias");
  assert.equal(biasOver(settled, { from: 100, to: 300 }, bias)("x"), "");
});

test("windows of spectra are numbered from one, and others are zero", () => {
  const windows = [
    { from: 10, to: 20 },
    { from: 50, to: 60 },
  ];
  const given = point({ spectrum_windows: windows });
  assert.deepEqual(
    [...windows, { from: 0, to: 60 }].map((window) => spectrumWindow(given, window)),
    [1, 2, 0],
  );
  // The usual window is the last sixth of the run.
  assert.equal(spectrumWindow(point({}), { from: 50, to: 60 }), 1);
  assert.equal(spectrumWindow(point({}), { from: 40, to: 60 }), 0);
  assert.equal(spectrumWindow(point({ spectrum_windows: [] }), { from: 50, to: 60 }), 0);
});

test("a node is named by the depth that it is recorded for, or else by its number", () => {
  const byDepth = { recording: { nodes: [{ depth: 57.7 }, { depth: 192 }] } };
  assert.equal(recordedAs(byDepth, 49, 57.73), "57_7m");
  assert.equal(recordedAs(byDepth, 257, 191.9), "192m");
  const above = {
    recording: { nodes: [{ above_bit: 12.5 }, { depth: 57.7 }] },
    string: { sections: [{ length: 200 }] },
  };
  assert.equal(recordedAs(above, 290, 187.6), "12_5m_above_bit");
  assert.equal(recordedAs({ ...above, string: { ...above.string, bit_depth: 70 } }, 49, 57.73), "57_7m");
  assert.equal(recordedAs({ recording: { nodes: [{ node: 49 }] } }, 49, 57.73), "49");
  assert.equal(recordedAs({ recording: { nodes: [{ depth: 57.7 }, { node: 49 }] } }, 49, 57.73), "49");
});

test("a point is unsettled by its regime or a growing mode", () => {
  assert.ok(isUnsettled("not_settled", null));
  assert.ok(isUnsettled("regular", 2.5));
  assert.ok(!isUnsettled("regular", null));
  assert.ok(!isUnsettled(undefined, undefined));
});

/** A complete point with its duration and the window of its statistics [s]. */
function runOf(duration, orbit_window, summary = {}) {
  return { scenario: { duration, recording: { orbit_window } }, summary };
}

test("points are compared in the window of their statistics if it is the same for all", () => {
  const { from, to, isShared } = comparedWindow([runOf(60, null), runOf(60, { from: 40, to: 60 })]);
  near(from, 40);
  near(to, 60);
  assert.ok(isShared);
});

test("a point without results has no say in the compared window", () => {
  const { from, to, isShared } = comparedWindow([
    runOf(60, { from: 15, to: 25 }),
    runOf(60, null, null),
    runOf(60, { from: 15, to: 25 }),
  ]);
  assert.deepEqual({ from, to, isShared }, { from: 15, to: 25, isShared: true });
});

test("windows that differ are compared in their overlap, or in the last third of the shortest run", () => {
  assert.deepEqual(comparedWindow([runOf(60, { from: 15, to: 45 }), runOf(50, { from: 30, to: 50 })]), {
    from: 30,
    to: 45,
    isShared: false,
    isOverlap: true,
  });
  const { from, to, isShared, isOverlap } = comparedWindow([runOf(30, null), runOf(90, null)]);
  near(from, 20);
  assert.deepEqual({ to, isShared, isOverlap }, { to: 30, isShared: false, isOverlap: false });
});
