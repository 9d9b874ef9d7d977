// Tag and request of a point's cost study.

import assert from "node:assert/strict";
import { test } from "node:test";
import "./browser.js";

const { studyOf, tagOf } = await import("../../point/cost-study-link.js");

const POINT = {
  key: "0123456789abcdef0123456789abcdef",
  scenario: { name: "base", duration: 2, cost_study: null, mesh: "auto" },
};

test("a study is the point's scenario, and found by the point's key", () => {
  assert.equal(tagOf(POINT), "cost-study-0123456789abcdef");
  assert.deepEqual(studyOf(POINT), {
    name: "cost study of base",
    tags: ["cost-study-0123456789abcdef"],
    scenario: { duration: 2, cost_study: {}, mesh: "auto" },
  });
});
