// Accounts of the ledger by the size of their change.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { loadQuantities } from "../../data/units.js";

await loadQuantities();
// Pictures are made for a page.
globalThis.addEventListener ??= () => {};
const { floorOf, sortedAccounts } = await import("../../point/energy.js");

const COLUMNS = {
  time: [0, 20],
  kinetic: [0, 1.7],
  stored: [0, -32.6],
  work_rotation: [0, 905817],
  dissipated_friction: [0, 905845],
  dissipated_contact: [0, 0],
};

test("accounts are sorted by size, with their signs in words", () => {
  const accounts = sortedAccounts(COLUMNS);
  assert.deepEqual(
    accounts.map(({ words }) => words),
    [
      "dissipated by friction",
      "work of the rotation",
      "stored energy lost",
      "kinetic energy gained",
      "dissipated by the wall",
    ],
  );
});

test("a logarithmic scale begins below the least energy that is not nothing next to the largest", () => {
  assert.equal(floorOf([905845, -32.6, 1.7, 0]), 0);
  assert.equal(floorOf([905845, 1e-5]), 5);
  assert.equal(floorOf([100, 100]), 1);
  assert.equal(floorOf([0, 0]), -1);
});
