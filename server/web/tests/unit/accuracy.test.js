// The error to believe: measured at the point, or else estimated as a whole.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { accuracyOf, advice, placeOf, sayError } from "../../data/accuracy.js";
import { Biases, sayWorst } from "../../data/biases.js";
import { loadQuantities } from "../../data/units.js";

await loadQuantities();

const WHOLE = {
  whole_error: 0.064,
  time_error: 0.06,
  mesh_error: 0.02,
  sampling_error: 0.01,
  promised_error: 0.02,
};
const own = (value) => ({ value, name: "orbit_radius_rms_57_7m", verified: 1, isOwn: true });

test("a measurement at the point is believed before an estimate", () => {
  const accuracy = accuracyOf(WHOLE, own(-0.003));
  assert.equal(accuracy.believed, "measured");
  assert.equal(accuracy.isMet, true);
  assert.equal(advice(accuracy), "Believe the measurement, within the promise");
  assert.equal(sayError(accuracy.measured.value), "0.3 %");
  assert.equal(accuracyOf(WHOLE, own(-0.03)).isMet, false);
});

test("a measurement at other points leaves the estimate", () => {
  const accuracy = accuracyOf(WHOLE, { ...own(0.003), isOwn: false, verified: 2 });
  assert.equal(advice(accuracy), "Believe the estimate, beyond the promise");
  assert.equal(placeOf(accuracy.measured), "at most, at 2 verified points of the sweep");
});

test("an estimate without a part can exceed a promise but not meet it", () => {
  const parts = { time_error: 0.003, mesh_error: 0.004, promised_error: 0.02 };
  const accuracy = accuracyOf(parts, null);
  near(accuracy.estimate, 0.005);
  assert.deepEqual([accuracy.believed, accuracy.isMet], [null, null]);
  assert.equal(advice(accuracy), "Verify this point: the estimate lacks sampling");
  assert.equal(accuracyOf({ ...parts, mesh_error: 0.04 }, null).isMet, false);
  assert.equal(accuracyOf({ promised_error: 0.02 }, null).estimate, null);
});

test("the largest bias is that of the point, or else of all verified points", async () => {
  const table = {
    attributes: {
      statistics: {
        orbit_radius_rms_10: { largest: -0.02, verified: 2 },
        line_amplitude_10_w1: { largest: 0.5, verified: 2 },
      },
    },
    columns: { ordinal: [3], bias_orbit_radius_rms_10: [-0.001], bias_orbit_radius_rms_49: [0.0005] },
  };
  globalThis.fetch = async () => new Response(JSON.stringify(table));
  const biases = new Biases();
  await biases.load({ id: "a", verification: {} }, new AbortController().signal);
  assert.deepEqual(biases.orbitSize(3), {
    value: -0.001,
    name: "orbit_radius_rms_10",
    verified: 1,
    isOwn: true,
  });
  assert.deepEqual(biases.orbitSize(4), {
    value: -0.02,
    name: "orbit_radius_rms_10",
    verified: 2,
    isOwn: false,
  });
  assert.equal(new Biases().orbitSize(3), null);
});

test("the worst bias of a sweep has its sign and one per cent sign", () => {
  const said = (worst) => sayWorst(worst).replaceAll("\u202f", " ");
  assert.equal(
    said({ bias: -0.0052, ordinal: 3, promised: 0.08 }),
    "Verified against reference runs: worst bias of orbit size −0.52 % at point 3 (promised: 8 %).",
  );
  assert.equal(
    said({ bias: 1.654, ordinal: 9, promised: null }),
    "Verified against reference runs: worst bias of orbit size +170 % at point 9.",
  );
});
