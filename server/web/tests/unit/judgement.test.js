// Classes of points with their colours, and the numbers of a point's headline.

import "./browser.js";
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { causeOf, causeWords, classes, headlineNumbers, rankOf } from "../../data/judgement.js";
import { choose } from "../../data/settings.js";
import { loadQuantities } from "../../data/units.js";
import { BLACK, classColour, inkOnClass, WHITE } from "../../draw/picture/colours.js";
import { QUANTITIES } from "./browser.js";

const G = 9.80665;
const KSI = (1000 * 0.45359237 * 9.80665) / 0.0254 ** 2;
const unit = (served, si, field) => ({
  label: "",
  unit: served,
  shown: { unit: si[0], size: si[1] },
  field: { unit: field[0], size: field[1] },
});
Object.assign(QUANTITIES, {
  bit_stick_slip_severity: { label: "", unit: "1" },
  largest_lateral_acceleration_rms: unit("m/s2", ["g", G], ["g", G]),
  largest_equivalent_stress: unit("Pa", ["MPa", 1e6], ["ksi", KSI]),
  largest_orbit_size: unit("m", ["mm", 1e-3], ["in", 0.0254]),
});
await loadQuantities();
const CLASSES = classes().map(({ word }) => word);
beforeEach(() => choose("units", "si"));

const SUMMARY = {
  bit_stick_slip_severity: 1.0912,
  largest_lateral_acceleration_rms: 2 * G,
  largest_lateral_acceleration_rms_depth: 304.8,
  largest_equivalent_stress: 75 * KSI,
  largest_equivalent_stress_depth: 0,
  largest_side_force: null,
  largest_orbit_size: 0.0254,
};

test("numbers of a headline have the reader's units and their depths", () => {
  const shown = () => headlineNumbers(SUMMARY).map(({ value, place }) => `${value} ${place}`.trim());
  assert.deepEqual(shown(), ["1.09", "2 g at 304.8 m", "517 MPa at 0 m", "25.4 mm"]);
  choose("units", "field");
  assert.deepEqual(shown(), ["1.09", "2 g at 1000 ft", "75 ksi at 0 ft", "1 in"]);
});

test("a result without loads has no numbers", () => {
  assert.deepEqual(headlineNumbers({ motion_regime: "regular" }), []);
});

test("classes are ranked by severity, and unknown ones come last", () => {
  assert.ok(rankOf("failed") < rankOf("stick_slip"));
  assert.ok(rankOf("stick_slip") < rankOf("quiet"));
  assert.ok(rankOf("new_class") > rankOf("not_judged"));
});

const lineAt = (frequency_hz, node = 49, window = [40, 60]) => ({
  node,
  window,
  frequency_hz,
  sentence: `${frequency_hz} of ${node} from ${window[0]}`,
});
const DIAGNOSED = [lineAt(2.16), lineAt(-2.16), lineAt(2.17, 10), lineAt(2.18, 49, [0, 10]), lineAt(4.3)];
const causeAt = (frequency, { window = { from: 40, to: 60 }, resolution = 0.05, node = 49 } = {}) =>
  causeOf(DIAGNOSED, { node, frequency, resolution, window })?.sentence ?? null;

test("a spectral line has the cause of the diagnosed line of its node, whirl and window", () => {
  assert.equal(causeAt(2.17), "2.16 of 49 from 40");
  assert.equal(causeAt(-2.15), "-2.16 of 49 from 40");
  assert.equal(causeAt(2.16, { node: 10 }), "2.17 of 10 from 40");
  assert.equal(causeAt(2.22), null);
  assert.equal(causeAt(-4.3), null);
});

test("a window that is chosen has the causes of the diagnosed window that it overlaps most", () => {
  assert.equal(causeAt(2.16, { window: { from: 0, to: 30 }, resolution: 0.04 }), "2.18 of 49 from 0");
  assert.equal(causeAt(2.16, { window: { from: 5, to: 60 }, resolution: 0.04 }), "2.16 of 49 from 40");
  assert.equal(causeAt(2.16, { window: { from: 15, to: 35 } }), null);
});

test("a cause in words leaves the frequency out, which stands next to it", () => {
  const words = (sentence) => causeWords({ sentence });
  assert.equal(words("-2.16 Hz: the torsional mode at 2.162 Hz"), "the torsional mode at 2.162 Hz");
  assert.equal(words("+5.30 Hz: no cause found"), "no cause found");
});

/** Red, green and blue in linear light. */
function linear(colour) {
  return [1, 3, 5].map((start) => {
    const share = Number.parseInt(colour.slice(start, start + 2), 16) / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
}

const times = (matrix, vector) =>
  matrix.map((row) => row.reduce((sum, part, index) => sum + part * vector[index], 0));
/** Colours as they are seen (Machado, Oliveira and Fernandes 2009, severity 1). */
const VISION = {
  usual: [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  protanopia: [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
  ],
  deuteranopia: [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ],
};
const XYZ = [
  [0.4124, 0.3576, 0.1805],
  [0.2126, 0.7152, 0.0722],
  [0.0193, 0.1192, 0.9505],
];
/** CIE L*a*b* of a colour in linear light. */
function lab(light) {
  const [x, y, z] = times(
    XYZ,
    light.map((part) => Math.min(1, Math.max(0, part))),
  ).map((part, index) => {
    const share = part / [0.9505, 1, 1.089][index];
    return share > 216 / 24389 ? Math.cbrt(share) : (841 / 108) * share + 4 / 29;
  });
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

test("colours of classes differ for any common colour vision", () => {
  for (const [name, vision] of Object.entries(VISION)) {
    const seen = CLASSES.map((one) => lab(times(vision, linear(classColour(one)))));
    for (const [order, one] of seen.entries())
      for (const [later, other] of seen.slice(order + 1).entries()) {
        const apart = Math.hypot(...one.map((part, index) => part - other[index]));
        assert.ok(apart > 10, `${name}: ${CLASSES[order]} and ${CLASSES[order + 1 + later]} ${apart}`);
      }
  }
});

test("words on the colours of classes have the contrast of WCAG 2 AA", () => {
  for (const name of CLASSES) {
    const luminance = times(XYZ, linear(classColour(name)))[1];
    const ink = inkOnClass(name);
    assert.ok(ink === BLACK || ink === WHITE);
    const contrast = ink === BLACK ? (luminance + 0.05) / 0.05 : 1.05 / (luminance + 0.05);
    assert.ok(contrast >= 4.5, `${name} ${contrast}`);
  }
});
