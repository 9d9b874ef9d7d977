import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { choicesOf, depthsOf, frictionOf, linesOf, requested } from "../../point/drag.js";

const choices = (/** @type {string} */ text) => choicesOf(new URLSearchParams(text), 200);

test("a link without choices has the usual ones, of a stiff string with fewer depths", () => {
  assert.deepEqual(requested(choices("")), {
    modes: "pick_up,slack_off,rotate",
    depths: "5:200:40",
  });
  assert.deepEqual(requested(choices("string=stiff")), {
    modes: "pick_up,slack_off,rotate",
    depths: "50:200:4",
    stiff: "true",
  });
  const wrong = "motions=fly&friction=x&bit=200:5:4&travelling=-1&ream=fast&string=elastic";
  assert.deepEqual(choices(wrong), choices(""));
});

test("choices of a link are requested", () => {
  const link = "motions=ream,pick_up&friction=0.2,0.3&bit=50:150:3&travelling=2e5&ream=-0.1";
  assert.deepEqual(requested(choices(link)), {
    modes: "pick_up,ream",
    depths: "50:150:3",
    friction: "0.2,0.3",
    travelling_weight: "200000",
    axial_speed: "-0.1",
  });
  const { depths, axial_speed: speed } = requested(choices("bit=80:120:1&ream=0.1"));
  assert.equal(depths, "120");
  assert.equal(speed, undefined);
});

test("friction factors and depths of a text are numbers in their bounds", () => {
  assert.deepEqual(frictionOf(" 0.2, 0.25;0 "), [0.2, 0.25, 0]);
  assert.deepEqual(frictionOf(""), []);
  for (const text of ["-0.1", "0.2, x", "Infinity"]) assert.equal(frictionOf(text), null);
  assert.deepEqual(depthsOf("80:80:1"), { from: 80, to: 80, count: 1 });
  for (const text of ["", "0:200:4", "80:200", "80:200:0", "80:200:1.5", "80:Infinity:2", "80:200:3:4"])
    assert.equal(depthsOf(text), null);
});

test("a motion with a friction factor has a line", () => {
  const columns = {
    drag_mode: ["pick_up", "pick_up", "pick_up", "rotate"],
    friction_factor: [0.2, 0.2, 0.3, null],
    bit_depth: [100, 200, 100, 100],
  };
  assert.deepEqual(linesOf(columns), [
    { motion: "pick_up", friction: 0.2, rows: [0, 1] },
    { motion: "pick_up", friction: 0.3, rows: [2] },
    { motion: "rotate", friction: null, rows: [3] },
  ]);
});
