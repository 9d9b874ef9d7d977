// Entries of the form in the reader's units, against the definitions of the units.

import "./browser.js";
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { near } from "./browser.js";
import { choose } from "../../data/settings.js";
import { loadQuantities } from "../../data/units.js";
import { readersText, servedText } from "../../submit/entries.js";
import { isRecording, snapshotBytes } from "../../submit/recording.js";
import { grouped } from "../../submit/source.js";

await loadQuantities();
beforeEach(() => choose("units", "si"));

const GALLON_A_MINUTE = (231 * 0.0254 ** 3) / 60;

test("numbers in field units become SI units to the last digits", () => {
  choose("units", "field");
  assert.equal(servedText("measured_depth", "3"), "0.9144");
  near(Number(servedText("mud.flow_rate", "600")), 600 * GALLON_A_MINUTE, 1e-14);
  const [low, high, count, scale] = servedText("flow_rate", "100:600:6:log").split(":");
  near(Number(low), 100 * GALLON_A_MINUTE, 1e-14);
  near(Number(high), 600 * GALLON_A_MINUTE, 1e-14);
  assert.deepEqual([count, scale], ["6", "log"]);
});

test("an entry may have its unit, in either system", () => {
  for (const system of ["si", "field"]) {
    choose("units", system);
    near(Number(servedText("flow_rate", "600 gpm")), 600 * GALLON_A_MINUTE, 1e-14);
    assert.equal(servedText("flow_rate", "0.02 m³/s"), "0.02");
    assert.equal(servedText("flow_rate", "3 furlongs"), "3 furlongs");
  }
});

test("in SI units entries are as they are typed, and words and lists in any", () => {
  assert.equal(servedText("flow_rate", "1e-2,  0.04"), "1e-2, 0.04");
  choose("units", "field");
  assert.equal(servedText("contact.friction", "0.2"), "0.2");
  assert.equal(servedText("flow_rate", '{"a": 1}'), '{"a": 1}');
  assert.equal(servedText("accuracy", "draft"), "draft");
});

test("served values are shown in the reader's units, and words stay", () => {
  assert.equal(readersText("mud_density", "1200:2100:4"), "1200:2100:4");
  choose("units", "field");
  assert.equal(readersText("mud_density", "1200:2100:4"), "10.0145:17.5253:4");
  assert.equal(readersText("flow_rate", "0.015, abc"), "237.755, abc");
});

test("changes of the recording are shown as lists if they are of known form", () => {
  const row = (name, values) => isRecording({ name: `recording.${name}`, values });
  assert.ok(row("nodes", '[{"node": 49}, {"depth": 57.7}]'));
  assert.ok(!row("nodes", "[49]"));
  assert.ok(row("spectrum_windows", "[]") && row("spectrum_windows", "null"));
  assert.ok(!row("spectrum_windows", "[{}"));
  assert.ok(row("snapshots", '{"rate_hz": 25}') && !row("outputs", "null"));
});

test("snapshots take 44 bytes a node before compression", () => {
  assert.equal(snapshotBytes({ elements: 296, simulated_time: 0.64 }), 16 * 297 * 44);
});

test("presets are in groups by their folders", () => {
  const names = ["paper-200m", "hard/dogleg", "closed/a", "wells/b", "other/c"].map((name) => ({ name }));
  assert.deepEqual(
    grouped(names).map(([group, [first]]) => [group, first]),
    [
      ["The paper's string", "paper-200m"],
      ["Wells", "wells/b"],
      ["Accuracy", "closed/a"],
      ["Hard cases", "hard/dogleg"],
      ["other", "other/c"],
    ],
  );
});
