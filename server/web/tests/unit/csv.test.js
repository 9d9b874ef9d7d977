// Tables as CSV.

import assert from "node:assert/strict";
import { test } from "node:test";
import { csvOf } from "../../data/csv.js";

test("rows are written in their order, gaps empty and texts quoted if they need it", () => {
  const columns = [
    [1, 2, 3],
    [0.1, null, 1e-7],
    ["succeeded", 'it "failed", twice', "a\nb"],
  ];
  assert.equal(
    csvOf(["ordinal", "x", "error"], columns, [2, 0, 1]),
    'ordinal,x,error\r\n3,1e-7,"a\nb"\r\n1,0.1,succeeded\r\n2,,"it ""failed"", twice"\r\n',
  );
});
