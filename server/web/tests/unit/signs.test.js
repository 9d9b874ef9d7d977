// Sign rules of quantities.

import assert from "node:assert/strict";
import { test } from "node:test";
import { signRules } from "../../data/signs.js";

test("signed quantities have their rules, each once", () => {
  assert.equal(
    signRules(["torque_top", "torque_mean_49", undefined, "flow_rate"]),
    "Torque is negative if it opposes clockwise rotation.",
  );
  assert.equal(
    signRules(["effective_tension", "tension_min_10"]),
    "Tension is positive, compression negative.",
  );
  assert.match(signRules(["torque", "tension_bit"]), /^Tension .*negative\. Torque .*rotation\.$/);
});

test("energies, ranges and parameters have none", () => {
  const names = [
    "work_flow_and_torque",
    "torque_top_range",
    "operation.torque_on_bit",
    "flow_rate",
    "kinetic",
  ];
  assert.equal(signRules(names), "");
});
