import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { largestRow, linesOf, speedsOf } from "../../point/forced.js";

test("a component has a line, and each of two of one name its own", () => {
  const columns = {
    component: ["collar", "collar", "collar", "collar", "bit", "bit"],
    rotation_speed_rpm: [60, 120, 60, 120, 60, 120],
    forced_displacement: [1, 2, 3, 4, null, 5],
  };
  assert.deepEqual(
    linesOf(columns, "forced_displacement").map(({ component, values }) => [component, values]),
    [
      ["collar", [1, 2]],
      ["collar", [3, 4]],
      ["bit", [null, 5]],
    ],
  );
  assert.equal(largestRow(columns.forced_displacement), 5);
});

test("speeds of a link that are none are the usual ones", () => {
  assert.deepEqual(speedsOf("60:180"), [60, 180]);
  for (const text of [null, "", "60", "180:60", "0:60", "60:x", "60:180:3"])
    assert.deepEqual(speedsOf(text), [40, 240]);
});
