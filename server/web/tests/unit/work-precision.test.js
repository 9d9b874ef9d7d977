// Errors against processor times.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import {
  costsOf,
  cpuTime,
  decades,
  effectCosts,
  studyCosts,
  studyRowName,
} from "../../data/work-precision.js";

const POINT = { ordinal: 3, provenance: { transient_cpu_time: 2, statics_cpu_time: 0.5 } };

test("the time of a point is that of its run and its equilibrium", () => {
  assert.equal(cpuTime(POINT), 2.5);
  assert.equal(cpuTime({ ordinal: 1 }), null);
});

test("points without an error or a time are left out, and no error is too small to be shown", () => {
  const costs = costsOf([
    { point: POINT, error: -0.02 },
    { point: POINT, error: 0 },
    { point: POINT, error: null },
    { point: { ordinal: 1 }, error: 0.1 },
  ]);
  assert.deepEqual(costs, [
    { cpu: 2.5, error: 0.02, text: "point 3" },
    { cpu: 2.5, error: 1e-5, text: "point 3" },
  ]);
});

test("an axis has all values and a decade at least", () => {
  const [from, to] = decades([1, 100]).map(Math.log10);
  assert.ok(from < 0 && to > 2);
  const [low, high] = decades([10]).map(Math.log10);
  near(low, 0.5);
  near(high, 1.5);
});

const row = (name, cpu, errors, more = {}) => ({
  name,
  integrator: "generalized_alpha",
  step: 5e-4,
  mesh_factor: 1,
  cpu_time: cpu,
  cpu_per_simulated_second: cpu / 10,
  errors,
  ...more,
});

test("rows of a study are accuracies and other methods with their measured errors", () => {
  const report = {
    methods: [
      row("draft", 1, { orbit_size: { bias: -0.05 } }),
      row("generalized_alpha", 4, { orbit_size: { bias: 0.01 } }),
      row("rk4", 0, null, { failure: "beyond the stability limit" }),
    ],
    references: [row("A", 40, { orbit_size: { bias: 1e-9 } }, { integrator: "rk4", step: 2.5e-5 })],
    meshes: [row("standard", 3, { orbit_size: { bias: 0.02 } }, { mesh_factor: 0.5 })],
    starts: [],
  };
  const { measure, accuracies, others } = studyCosts(report);
  assert.equal(measure, "error of orbit size");
  assert.deepEqual(accuracies, [
    { cpu: 1, error: 0.05, text: "draft" },
    { cpu: 3, error: 0.02, text: "standard, elements times 0.5" },
  ]);
  assert.deepEqual(others, [
    { cpu: 4, error: 0.01, text: "generalized-alpha, 0.5 ms" },
    { cpu: 40, error: 1e-5, text: "rk4, 0.025 ms" },
  ]);
});

test("a study without errors of orbits shows those of the history", () => {
  const methods = [row("esdirk4", 2, { trajectory: 0.003 }, { integrator: "esdirk4", tolerance: 0.01 })];
  const { measure, others } = studyCosts({ methods, references: [], meshes: [], starts: [] });
  assert.equal(measure, "error of the history");
  assert.deepEqual(others, [{ cpu: 2, error: 0.003, text: "esdirk4, 0.5 ms, tolerance 0.01" }]);
  assert.equal(studyRowName(row("reference", 1, {})), "reference");
});

test("an effect that is left out changes statistics and saves time", () => {
  const report = {
    references: [row("standard", 10, {})],
    effects: [
      row(
        "standard",
        6,
        { orbit_size: { bias: 0.3 }, radius_deviation: { bias: -0.1 } },
        { effect: "torsion" },
      ),
      row("standard", 0, null, { effect: "contact", failure: "no equilibrium" }),
    ],
  };
  const [torsion, contact] = effectCosts(report);
  assert.deepEqual([torsion.orbitSize, torsion.deviation, torsion.torsionalSpeed], [0.3, -0.1, null]);
  assert.deepEqual(studyCosts({ methods: [], meshes: [], starts: [], ...report }).accuracies, []);
  near(torsion.saved, 0.4);
  assert.deepEqual([contact.saved, contact.failure], [null, "no equilibrium"]);
});
