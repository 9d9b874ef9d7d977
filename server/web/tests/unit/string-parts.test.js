import assert from "node:assert/strict";
import { test } from "node:test";
import { componentAt } from "../../data/string-parts.js";

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
    assert.equal(componentAt(sections, /** @type {number} */ (depth)), name);
});
