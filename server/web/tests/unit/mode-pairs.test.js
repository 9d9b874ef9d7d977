// Modes of points paired by likeness.

import assert from "node:assert/strict";
import { test } from "node:test";
import { likeness, pairedModes } from "../../data/mode-pairs.js";

const mode = (frequency_hz, kind, measured_depth, extent) => ({
  frequency_hz,
  growth_rate: -0.1,
  kind,
  lateral_share: kind === "lateral" ? 1 : 0,
  torsional_share: kind === "torsional" ? 1 : 0,
  axial_share: kind === "axial" ? 1 : 0,
  measured_depth,
  extent,
});
const ENDS = [
  [10, 40],
  [30, 90],
  [80, 120],
  [100, 170],
  [150, 200],
];
const lateral = (factor) =>
  ENDS.map(([from, to], index) => mode(factor * (2 + 0.1 * index), "lateral", (from + to) / 2, [from, to]));

test("modes are paired by their depths where a common shift crosses their order by frequency", () => {
  // 20 % lower, each lateral mode has the frequency of another one; the torsional mode passes four of them.
  const torsional = mode(2.05, "torsional", 190, [90, 200]);
  const [one, other] = [
    [...lateral(1), torsional],
    [torsional, ...lateral(0.8)],
  ];
  const rows = pairedModes([one, other]);
  assert.equal(rows.length, 6);
  for (const [a, b] of rows) {
    assert.deepEqual([a.kind, a.extent], [b.kind, b.extent]);
    assert.ok(Math.abs(b.frequency_hz / a.frequency_hz - (a.kind === "lateral" ? 0.8 : 1)) < 1e-12);
  }
  // Rows are in the order of frequency.
  const lowest = rows.map(([a]) => a.frequency_hz);
  assert.deepEqual(
    lowest,
    lowest.toSorted((a, b) => a - b),
  );
});

test("of modes alike in all else the nearest frequency decides, and each is in one row", () => {
  const alike = [1.0, 1.2, 1.4, 1.6].map((frequency) => mode(frequency, "lateral", 50, [0, 100]));
  const rows = pairedModes([alike, alike.slice(1).reverse()]);
  assert.deepEqual(
    rows.map((row) => row.map((one) => one?.frequency_hz ?? null)),
    [
      [1.0, null],
      [1.2, 1.2],
      [1.4, 1.4],
      [1.6, 1.6],
    ],
  );
});

test("modes that differ have rows of their own, also of a point before or after", () => {
  const [low, high, axial] = [
    mode(2, "lateral", 20, [0, 40]),
    mode(2, "lateral", 180, [160, 200]),
    mode(2, "axial", 20, [0, 40]),
  ];
  const rows = pairedModes([[low], [high], [axial, high]]);
  assert.equal(rows.length, 3);
  for (const row of rows) assert.equal(row.length, 3);
  assert.ok(rows.some((row) => row[0] === null && row[1] === high && row[2] === high));
  assert.deepEqual(pairedModes([]), []);
});

test("likeness is 1 of a mode and itself, symmetric, and 0 of other motions", () => {
  const one = mode(2, "lateral", 20, [0, 40]);
  const other = mode(3, "lateral", 30, [10, 50]);
  assert.equal(likeness(one, one, 200), 1);
  assert.equal(likeness(one, other, 200), likeness(other, one, 200));
  // Of 50 m with energy in either, 30 m are common; the largest motions are half of a tenth of the string apart.
  assert.ok(Math.abs(likeness(one, other, 200) - 0.6 * (0.5 + 0.5 * Math.exp(-0.5))) < 1e-12);
  assert.equal(likeness(one, mode(2, "axial", 20, [0, 40]), 200), 0);
});
