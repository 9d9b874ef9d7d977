// Fields of the form that are changed in whole, against requests written out.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { accuracyWay } from "../../submit/accuracy.js";
import { nodesOf, nodesText, windowWith } from "../../submit/kept.js";
import { changedField, memberOf, withMember } from "../../submit/members.js";
import { isMesh, proposedMesh, wayOf } from "../../submit/mesh.js";
import { withPipe } from "../../submit/pipes.js";
import { isRecording, wayOf as windowWay } from "../../submit/recording.js";
import { numbersOf } from "../../submit/table.js";
import { isTally, materialName } from "../../submit/tally.js";

const SECTIONS = [
  { kind: "drillpipe", count: 9, length: 9.5, tool_joint: { length: 0.3, outer_diameter: 0.16 } },
  { kind: "bit", length: 0.5 },
];

test("a member is read and changed in a copy", () => {
  assert.equal(memberOf(SECTIONS, "[0].tool_joint.length"), 0.3);
  assert.equal(memberOf(SECTIONS, "[1].tool_joint.length"), undefined);
  const longer = withMember(SECTIONS, "[0].tool_joint.length", 0.4);
  assert.deepEqual(longer[0].tool_joint, { length: 0.4, outer_diameter: 0.16 });
  assert.equal(SECTIONS[0].tool_joint.length, 0.3);
  assert.deepEqual(withMember(undefined, "reference.mesh_factor", 0.5), { reference: { mesh_factor: 0.5 } });
});

test("an object whose last member is removed goes with it", () => {
  const one = withMember(SECTIONS, "[0].tool_joint.length", undefined);
  assert.deepEqual(one[0].tool_joint, { outer_diameter: 0.16 });
  const none = withMember(one, "[0].tool_joint.outer_diameter", undefined);
  assert.deepEqual(none[0], { kind: "drillpipe", count: 9, length: 9.5 });
  assert.deepEqual(withMember({ members: 5 }, "members", undefined), {});
});

test("a field has the changes in whole and of its members", () => {
  const rows = { "string.sections[1].length": 0.4 };
  const changes = {
    get: (/** @type {string} */ name) => rows[name],
    within: (/** @type {string} */ path) => Object.keys(rows).filter((name) => name.startsWith(`${path}[`)),
  };
  assert.equal(changedField(changes, "string.sections", SECTIONS)[1].length, 0.4);
  rows["string.sections"] = [
    { kind: "bit", length: 1 },
    { kind: "bit", length: 1 },
  ];
  assert.deepEqual(
    changedField(changes, "string.sections", SECTIONS).map(({ length }) => length),
    [1, 0.4],
  );
});

test("a mesh is given in one of three ways, and another value stays text", () => {
  const lengths = { bit: 0.3, collar: 0.5, drillpipe: 1, stabilizer: 0.5, tool_joint: 0.1 };
  assert.deepEqual([wayOf("auto"), wayOf({ auto: 0.5 }), wayOf(lengths)], ["auto", "factor", "lengths"]);
  assert.equal(wayOf({ bit: 0.3 }), undefined);
  assert.ok(isMesh({ name: "mesh", values: '{"auto":0.5}' }));
  assert.ok(!isMesh({ name: "mesh", values: '{"bit":0.5}' }));
  assert.ok(!isMesh({ name: "mesh.auto", values: "0.5" }));
  assert.deepEqual(proposedMesh("lengths", "auto"), { ...lengths });
  assert.deepEqual(proposedMesh("factor", { auto: 0.4 }), { auto: 0.4 });
});

test("the window of the statistics is fixed, settled or the last third", () => {
  assert.deepEqual([null, undefined, "settled", { from: 1, to: 2 }, "other"].map(windowWay), [
    "last",
    "last",
    "settled",
    "fixed",
    undefined,
  ]);
  assert.ok(isRecording({ name: "recording.orbit_window", values: "settled" }));
  assert.ok(!isRecording({ name: "recording.orbit_window.from", values: "3" }));
});

test("tables are fields with a list", () => {
  assert.ok(isTally({ name: "string.gauges", values: "[]" }));
  assert.ok(!isTally({ name: "string.sections", values: "all" }));
});

test("materials are named by their numbers", () => {
  assert.equal(materialName(undefined), "");
  assert.equal(
    materialName({ youngs_modulus: 7.3e10, density: 2800, poissons_ratio: 0.33 }),
    "aluminium 2014-T6",
  );
  assert.equal(materialName({ youngs_modulus: 7.4e10, density: 2800, poissons_ratio: 0.33 }), "own");
});

test("nodes of histories in part are numbers or depths", () => {
  assert.deepEqual(nodesOf("49, 57.7 m, 100 ft"), [{ node: 49 }, { depth: 57.7 }, { depth: 30.48 }]);
  assert.deepEqual(nodesOf("12.5 m above bit"), [{ above_bit: 12.5 }]);
  assert.deepEqual(nodesOf(nodesText([{ above_bit: 3 }])), [{ above_bit: 3 }]);
  assert.deepEqual(nodesOf(""), []);
  assert.equal(nodesOf("4.5"), null);
  assert.equal(nodesOf("bit"), null);
  assert.equal(nodesText([{ node: 49 }, { depth: 57.7 }]), "49, 57.7 m");
});

test("a window without ends is none", () => {
  assert.deepEqual(windowWith(undefined, "to", 5), { from: 0, to: 5 });
  assert.deepEqual(windowWith({ from: 0, to: 5 }, "from", 2), { from: 2, to: 5 });
  assert.equal(windowWith({ from: 2 }, "from", undefined), undefined);
});

test("numbers of a list are separated by commas", () => {
  assert.deepEqual(numbersOf("0.5, 1e-3,"), [0.5, 0.001]);
  assert.equal(numbersOf("0.5; 1"), null);
});

test("an accuracy is a name, an allowed error or a step, and another value stays text", () => {
  assert.deepEqual(
    [undefined, "draft", { statistics: 0.01 }, { trajectory: 0.01 }, { integrator: "rk4", step: 1e-4 }].map(
      accuracyWay,
    ),
    ["", "draft", "statistics", "trajectory", "steps"],
  );
  assert.deepEqual(["fine", "steps", {}, null].map(accuracyWay), Array(4).fill(undefined));
});

test("a pipe of the catalogue takes the place of a section but for its number and length", () => {
  const row = {
    name: "motor",
    kind: "collar",
    count: 3,
    length: 9.1,
    mass_per_length: 200,
    blade_diameter: 0.3,
  };
  const collar = { name: "DC", kind: "collar", outer_diameter: 0.16, mass_per_length: 136, tool_joint: null };
  const expected = {
    name: "DC",
    kind: "collar",
    outer_diameter: 0.16,
    mass_per_length: 136,
    count: 3,
    length: 9.1,
  };
  assert.deepEqual(withPipe(row, collar), expected);
  const joint = { length: 0.25, outer_diameter: 0.168, material: null };
  assert.deepEqual(withPipe({ length: 9 }, { ...collar, tool_joint: joint }).tool_joint, {
    length: 0.25,
    outer_diameter: 0.168,
  });
});
