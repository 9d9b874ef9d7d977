// Names, units and numbers, against the definitions of the units.

import "./browser.js";
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { near } from "./browser.js";
import { choose } from "../../data/settings.js";
import * as units from "../../data/units.js";

await units.loadQuantities();
beforeEach(() => choose("units", "si"));

const INCH = 0.0254;
const FOOT = 12 * INCH;
const GALLON = 231 * INCH ** 3;
const POUND = 0.45359237;
const POUND_FORCE = POUND * 9.80665;

test("units of the oil field have the sizes of their definitions", () => {
  choose("units", "field");
  const sizes = {
    flow_rate: ["gpm", GALLON / 60],
    mud_density: ["ppg", POUND / GALLON],
    normal_force: ["klbf", 1000 * POUND_FORCE],
    measured_depth: ["ft", FOOT],
    radius: ["in", INCH],
    torque: ["ft·lbf", FOOT * POUND_FORCE],
  };
  for (const [name, [symbol, size]] of Object.entries(sizes)) {
    assert.equal(units.unit(name).symbol, symbol);
    near(units.unit(name).size, size, 1e-9);
  }
});

test("columns are shown in the chosen units, and gaps stay gaps", () => {
  assert.deepEqual(units.shown("normal_force", [4448.2216152605, null, 0]), [4.4482216152605, null, 0]);
  const served = [0.01, 0.02];
  assert.equal(units.shown("flow_rate", served), served);
  choose("units", "field");
  near(units.shown("flow_rate", served)[1], 0.02 / (GALLON / 60), 1e-9);
});

test("values are written with their units", () => {
  assert.equal(units.say("flow_rate", 0.01), "0.01 m³/s");
  assert.equal(units.say("torque", 1500), "1.5 kN·m");
  assert.equal(units.say("friction_coefficient", 0.25), "0.25");
  assert.equal(units.say("motion_regime", "not_settled"), "not settled");
  assert.equal(units.say("flow_rate", null), "–");
  choose("units", "field");
  assert.equal(units.say("flow_rate", 0.01), "158.5 gpm");
  assert.equal(units.say("mud_density", 1200), "10.01 ppg");
  assert.equal(units.say("normal_force", 4448.2216152605), "1 klbf");
});

test("errors and relative biases are shown in per cent", () => {
  for (const name of ["time_error", "whole_error", "mesh_error_mean_radius", "relative_spread"])
    assert.equal(units.say(name, 0.16398), "16.4 %");
  assert.equal(units.say("bias_orbit_radius_rms_49", -0.02), "−2 %");
  assert.equal(units.say("bias_line_frequency_hz_49_w1", -0.02), "−0.02 Hz");
  assert.equal(units.title("time_error"), "error by time steps [%]");
  assert.equal(units.say("error_estimate_displacement", 2e-6), "0.002 mm");
});

test("names of columns are labels with node, depth, window and variant", () => {
  const label = "lateral vibration";
  assert.equal(units.label("orbit_radius_rms_49"), `${label}, node 49`);
  assert.equal(units.label("orbit_radius_rms_57_7m"), `${label} at 57.7 m`);
  assert.equal(units.label("orbit_radius_rms_12_5m_above_bit"), `${label} 12.5 m above the bit`);
  assert.equal(units.label("orbit_radius_rms_980m"), `${label} at 980 m`);
  assert.equal(units.label("spread_orbit_radius_rms_49"), `spread of ${label}, node 49`);
  assert.match(units.label("line_frequency_hz_49_w2"), /, node 49, window 2$/);
  assert.equal(units.label("largest_orbit_radius_rms"), `largest ${label} of all recorded nodes`);
  assert.equal(units.label("largest_normal_force"), "largest side force");
  assert.equal(units.label("mud.density"), "mud density");
  assert.equal(units.label("unknown_name"), "unknown name");
});

test("columns of a node name it as links do", () => {
  assert.equal(units.nodeOfColumn("orbit_radius_rms_49"), "49");
  assert.equal(units.nodeOfColumn("line_frequency_hz_57_7m_w2"), "57.7m");
  assert.equal(units.nodeOfColumn("line_frequency_hz_12_5m_above_bit_w2"), "12.5m_above_bit");
  assert.equal(units.nodeOfColumn("friction_coefficient_max"), "");
  assert.equal(units.nodeOfColumn(""), "");
});

test("units of variants are those of the quantity, but biases are per cent", () => {
  assert.deepEqual(units.unit("orbit_radius_rms_49"), { symbol: "mm", size: 0.001 });
  assert.deepEqual(units.unit("confidence_orbit_radius_rms_49"), { symbol: "mm", size: 0.001 });
  assert.deepEqual(units.unit("bias_orbit_radius_rms_49"), { symbol: "%", size: 0.01 });
  assert.equal(units.title("orbit_radius_rms_49"), "lateral vibration, node 49 [mm]");
  assert.equal(units.servedUnit("orbit_radius_rms_49"), "m");
  assert.equal(units.servedUnit("friction_coefficient"), "");
});

test("the meaning of a column ends with the column's name in scripts", () => {
  assert.match(units.meaning("torque_top"), /Column torque_top\.$/);
  assert.equal(units.meaning("unknown_name"), "");
});

test("paths of a scenario are those of the vocabulary, whatever their indices", () => {
  assert.ok(units.pathNames().includes("mud.density"));
  assert.ok(!units.pathNames().includes("mud_density"));
  assert.equal(units.label("well.survey[3].measured_depth"), units.label("well.survey.measured_depth"));
});

test("numbers have a few significant digits", () => {
  const written = [
    [0, "0"],
    [-3, "−3"],
    [9999, "9999"],
    [999999, "999\u202f999"],
    [1234567, "1\u202f235\u202f000"],
    [-12345.67, "−12\u202f350"],
    [1.234567e9, "1.235e9"],
    [12.3456, "12.35"],
    [0.012346, "0.01235"],
    [0.00012346, "1.235e-4"],
    [-0.5, "−0.5"],
  ];
  for (const [value, text] of written) assert.equal(units.number(value), text);
  assert.equal(units.number(12.3456, 2), "12");
});

test("a number that is written keeps its value to the digits written", () => {
  for (let power = -12; power <= 12; power += 1) {
    for (const digits of [2, 3, 4, 6]) {
      near(
        Number(units.number(1.7320508 * 10 ** power, digits).replaceAll(units.THOUSANDS, "")),
        1.7320508 * 10 ** power,
        0.5 * 10 ** (1 - digits),
      );
    }
  }
});

test("large values have the unit that makes them short", () => {
  assert.equal(units.say("kinetic", 1.37e6), "1.37 MJ");
  assert.equal(units.say("kinetic", 9999), "9999 J");
  assert.equal(units.say("kinetic", -20_000), "−20 kJ");
  assert.equal(units.say("normal_force", 8e6), "8000 kN");
  assert.equal(units.say("normal_force", 2.4e7), "24 MN");
  assert.equal(units.say("mud_density", 12_345.6), "12\u202f350 kg/m³");
  assert.deepEqual(units.suitedUnit("kinetic", [3, null, -5e7]), { symbol: "MJ", size: 1e6 });
  assert.deepEqual(units.suitedUnit("kinetic", [3]), { symbol: "J", size: 1 });
  choose("units", "field");
  assert.equal(units.suitedUnit("kinetic", [5e7]).symbol, "ft·lbf");
});

test("durations and sizes have the unit that suits them", () => {
  const durations = [
    [0.05, "50 ms"],
    [42, "42 s"],
    [60, "1 min"],
    [3600, "1 h 0 min"],
    [5430, "1 h 31 min"],
    [2 * 86_400, "2 days"],
  ];
  for (const [seconds, text] of durations) assert.equal(units.duration(seconds), text);
  const sizes = [
    [0, "0 bytes"],
    [999, "999 bytes"],
    [1500, "1.5 kB"],
    [2.5e9, "2.5 GB"],
    [5e15, "5000 TB"],
  ];
  for (const [count, text] of sizes) assert.equal(units.bytes(count), text);
});

test("moments are in the reader's time zone", () => {
  const moment = new Date(2026, 0, 2, 3, 4, 5).toISOString();
  assert.equal(units.moment(moment), "2026-01-02 03:04");
  assert.equal(units.moment(moment, "second"), "2026-01-02 03:04:05");
});
