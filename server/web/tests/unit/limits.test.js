// Limits of an operating window in links, requests and sliders.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { changedLimits, limitsText, parseLimits, servedLimit, sliderOf } from "../../data/limits.js";
import { near } from "./browser.js";

const DEFAULTS = { bit_stick_slip_severity: 1, largest_equivalent_stress: 517106775 };

test("a request has the limits that differ from the defaults", () => {
  const limits = new Map([
    ["bit_stick_slip_severity", 1],
    ["largest_equivalent_stress", null],
    ["largest_side_force", 20000],
  ]);
  assert.equal(limitsText(limits, DEFAULTS), "largest_equivalent_stress:off,largest_side_force:20000");
  assert.deepEqual(changedLimits(limits, DEFAULTS), {
    largest_equivalent_stress: null,
    largest_side_force: 20000,
  });
  assert.equal(limitsText(new Map(Object.entries(DEFAULTS)), DEFAULTS), "");
});

test("a link gives the limits back that were put into it", () => {
  const text = "bit_stick_slip_severity:0.5,largest_side_force:off";
  assert.equal(limitsText(parseLimits(text), DEFAULTS), "bit_stick_slip_severity:0.5");
  assert.equal(
    limitsText(parseLimits("bit_stick_slip_severity:off"), DEFAULTS),
    "bit_stick_slip_severity:off",
  );
  assert.equal(parseLimits(text).get("largest_side_force"), null);
});

test("entries of a link that are no limits are left out", () => {
  assert.deepEqual(
    [...parseLimits("a:0,b:-1,c:much,d,:1,,e:2e3, f : off ")],
    [
      ["e", 2000],
      ["f", null],
    ],
  );
});

test("a slider goes to twice the usual limit, and never to zero", () => {
  const { min, max, step } = sliderOf(75);
  assert.equal(max, 150);
  assert.ok(min > 0);
  near((75 - min) / step, Math.round((75 - min) / step));
});

test("a limit is served in the unit of its column", () => {
  near(servedLimit(75, 6894757.293168361), 75 * 6894757.293168361, 1e-5);
  for (const shown of [0, -1, NaN, Infinity]) assert.ok(Number.isNaN(servedLimit(shown, 1)));
});
