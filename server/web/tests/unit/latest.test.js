// Answers that are shared by those who ask the same.

import assert from "node:assert/strict";
import { test } from "node:test";
import { latest } from "../../data/latest.js";

test("the same is asked once, and again after a failure", async () => {
  let asked = 0;
  const ask = latest(async (name) => {
    asked += 1;
    if (name === "lost") throw new Error("lost");
    return asked;
  });
  const answers = await Promise.all([
    ask("orbit", { node: 1 }),
    ask("orbit", { node: 1 }),
    ask("orbit", { node: 2 }),
  ]);
  assert.deepEqual(answers, [1, 1, 2]);
  for (const expected of [3, 4]) {
    await assert.rejects(ask("lost"));
    assert.equal(asked, expected);
  }
});

test("old answers are given up", async () => {
  let asked = 0;
  const ask = latest(async () => (asked += 1));
  for (let node = 0; node < 40; node += 1) await ask("orbit", { node });
  assert.equal(await ask("orbit", { node: 39 }), 40);
  assert.equal(await ask("orbit", { node: 0 }), 41);
});
