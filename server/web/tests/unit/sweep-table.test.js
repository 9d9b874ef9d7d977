// Columns of a sweep's table that the page makes.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { LARGEST_ORBIT, largestOf, SweepTable } from "../../data/sweep-table.js";
import { preferred } from "../../sweep/part.js";

const COLUMNS = {
  ordinal: [1, 2, 3],
  state: ["succeeded", "succeeded", "failed"],
  orbit_radius_rms_10: [0.1, 0.4, null],
  orbit_radius_rms_57_7m: [0.3, 0.2, null],
  spread_orbit_radius_rms_10: [9, 9, 9],
};

/** A table that the service answers with some columns. */
async function tableOf(columns) {
  const answer = globalThis.fetch;
  globalThis.preload.WHOLE = 3000;
  globalThis.fetch = async () => new Response(JSON.stringify({ columns }));
  const table = new SweepTable({ id: "x", counts: { total: 3 } }, new AbortController().signal);
  await table.load();
  globalThis.fetch = answer;
  return table;
}

test("the largest value of each row leaves gaps out", () => {
  assert.deepEqual(
    largestOf([
      [1, null, null],
      [3, -2, null],
    ]),
    [3, -2, null],
  );
  assert.deepEqual(largestOf([]), []);
});

test("a table of several recorded nodes has the largest orbit, which is shown first", async () => {
  const table = await tableOf(COLUMNS);
  assert.deepEqual(table.names.slice(2, 4), [LARGEST_ORBIT, "orbit_radius_rms_10"]);
  assert.equal(preferred(table.results()), LARGEST_ORBIT);
  assert.deepEqual(await table.columns(LARGEST_ORBIT, "ordinal"), [
    [0.3, 0.4, null],
    [1, 2, 3],
  ]);
  // Scripts request the columns behind it.
  assert.deepEqual(table.served(["ordinal", LARGEST_ORBIT]), [
    "ordinal",
    "orbit_radius_rms_10",
    "orbit_radius_rms_57_7m",
  ]);
});

test("a table of one recorded node has that node's orbit alone", async () => {
  const { orbit_radius_rms_57_7m: _, ...columns } = COLUMNS;
  const table = await tableOf(columns);
  assert.ok(!table.names.includes(LARGEST_ORBIT));
  assert.equal(preferred(table.results()), "orbit_radius_rms_10");
});
