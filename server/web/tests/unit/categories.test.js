// Words of categorical columns, in their order and colours.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { classes } from "../../data/judgement.js";
import { loadQuantities } from "../../data/units.js";
import { classColour } from "../../draw/picture/colours.js";
import { preferred } from "../../sweep/part.js";
import { sortable, wordColour, wordsOf } from "../../sweep/categories.js";

await loadQuantities();
const CLASSES = classes().map(({ word }) => word);

test("classes are in the order of their severity, other words in that of the alphabet", () => {
  const values = ["quiet", "stick_slip", null, "failed", "quiet", "backward_whirl"];
  assert.deepEqual(wordsOf("class", values), ["failed", "stick_slip", "backward_whirl", "quiet"]);
  assert.deepEqual(wordsOf("motion_regime", values), ["backward_whirl", "failed", "quiet", "stick_slip"]);
});

test("rows are sorted by the severity of their classes, and gaps stay gaps", () => {
  assert.deepEqual(sortable("class", ["failed", null, "not_judged"]), [0, null, CLASSES.length - 1]);
  const numbers = [3, null, 1];
  assert.equal(sortable("flow_rate", numbers), numbers);
});

test("a class has one colour, whichever other words a column has", () => {
  for (const word of CLASSES) assert.equal(wordColour("class", word, "#000000"), classColour(word));
  assert.equal(new Set(CLASSES.map(classColour)).size, CLASSES.length);
  assert.equal(wordColour("motion_regime", "regular", "#123456"), "#123456");
});

test("a sweep without results shows states first, which its points have, and no classes", () => {
  assert.equal(preferred(["state", "class", "error_time"]), "state");
  assert.equal(preferred(["state", "class", "torque_top"]), "torque_top");
});
