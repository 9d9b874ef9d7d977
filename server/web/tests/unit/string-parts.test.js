import assert from "node:assert/strict";
import { test } from "node:test";
import { componentAt, partsOf, placedSections } from "../../data/string-parts.js";

test("a depth has the component that holds it, at a boundary the upper one", () => {
  const sections = [{ name: "pipe", count: 3, length: 10 }, { name: "motor", length: 8.65 }, { length: 1 }];
  for (const [depth, name] of [
    [0, "pipe"],
    [30, "pipe"],
    [30 + 1e-9, "pipe"],
    [30.1, "motor"],
    [38.65, "motor"],
    [39.65, ""],
    [50, ""],
  ])
    assert.equal(componentAt({ sections }, /** @type {number} */ (depth)), name);
});

test("sections end at the sum of the lengths above", () => {
  const ends = (/** @type {any[]} */ sections) => placedSections({ sections }).map(({ bottom }) => bottom);
  assert.deepEqual(ends([{ count: 9, length: 9.5 }, { length: 0.5 }]), [85.5, 86]);
  assert.deepEqual(ends([{ length: "31 ft" }, { length: 2 }]), [NaN, NaN]);
});

test("a string with its bit above its end loses pipe at its top", () => {
  const tool_joint = { length: 0.3 };
  /** @type {import("../../data/string-parts.js").Section[]} */
  const sections = [
    { name: "top", kind: "drillpipe", count: 2, length: 9.5 },
    { name: "pipe", kind: "drillpipe", count: 2, length: 9.5, tool_joint },
    { name: "bit", kind: "bit", length: 0.5 },
  ];
  const string = { sections, bit_depth: 12 };
  const metres = (/** @type {number} */ depth) => Number(depth.toFixed(9));
  const parts = partsOf(string).map(({ kind, from, to }) => [kind, metres(from), metres(to)]);
  assert.deepEqual(parts.slice(0, 3), [
    ["drillpipe", 0, 1.7],
    ["tool_joint", 1.7, 2],
    ["tool_joint", 2, 2.3],
  ]);
  assert.deepEqual(parts.at(-1), ["bit", 11.5, 12]);
  const fromBit = { ...string, sections: sections.toReversed(), order: "from_bit" };
  assert.deepEqual(partsOf(fromBit), partsOf(string));
  assert.deepEqual(
    [0, 11, 12].map((depth) => componentAt(string, depth)),
    ["pipe", "pipe", "bit"],
  );
});
