// Viewpoints of strings in space, and the parts of a string.

import assert from "node:assert/strict";
import { test } from "node:test";
import { near, randoms } from "./browser.js";
import { kindsOf, partsOf } from "../../data/string-parts.js";
import {
  freeView,
  planView,
  readView,
  roundedView,
  sayView,
  seenFrom,
  sectionView,
} from "../../draw/viewpoint.js";

test("in a section depth is downwards, and the reach of the well to the right in full", () => {
  const random = randoms(3);
  for (let trial = 0; trial < 20; trial += 1) {
    const end = [random() - 0.5, random() - 0.5, random()].map((part) => 1000 * part);
    const seen = seenFrom(sectionView([[0, 0, 0], end]));
    const [right, down] = seen(end);
    near(right, Math.hypot(end[0], end[1]), 1e-9);
    near(down, end[2], 1e-9);
  }
  const [right, down] = seenFrom(
    sectionView([
      [0, 0, 0],
      [0, 0, 100],
    ]),
  )([0, 0, 100]);
  assert.deepEqual([right, down], [0, 100]);
});

test("in a plan north is up and east to the right", () => {
  const seen = seenFrom(planView());
  const [right, down] = seen([3, 2, 77]);
  near(right, 2);
  near(down, -3, 1e-9);
});

test("a view in the link is read as it is written, and the usual one is empty", () => {
  const usual = sectionView([
    [0, 0, 0],
    [10, 20, 30],
  ]);
  assert.equal(sayView(usual, usual), "");
  assert.deepEqual(readView("", usual), usual);
  assert.deepEqual(readView("1:2", usual), usual);
  const section = roundedView(usual);
  assert.deepEqual(readView(Object.values(section).join(":"), usual), section);
  const view = { ...freeView(), size: 2, right: 0.25 };
  assert.deepEqual(readView(sayView(view, usual), usual), view);
  near(readView("0:9:1:0:0", usual).elevation, Math.PI / 2);
});

const SECTIONS = [
  { kind: "drillpipe", count: 2, length: 9.5, tool_joint: { length: 0.3 } },
  { kind: "collar", length: 30 },
  { kind: "stabilizer", length: 2, tool_joint: null },
  { kind: "bit", length: 0.5 },
];

test("a string has a tool joint at both ends of each piece of pipe", () => {
  const parts = partsOf({ sections: SECTIONS });
  assert.deepEqual(
    parts.map(({ kind }) => kind),
    [
      ...["tool_joint", "drillpipe", "tool_joint", "tool_joint", "drillpipe", "tool_joint"],
      ...["collar", "stabilizer", "bit"],
    ],
  );
  near(parts[1].to - parts[1].from, 8.9);
  near(parts.at(-1).to, 2 * 9.5 + 30 + 2 + 0.5);
  for (const [order, part] of parts.slice(1).entries()) near(part.from, parts[order].to);
});

test("elements have the part in their middle", () => {
  const depths = [0, 0.3, 5, 9.2, 9.5, 9.8, 19, 30, 49, 51, 51.5];
  assert.deepEqual(kindsOf(partsOf({ sections: SECTIONS }), depths), [
    ...["tool_joint", "drillpipe", "drillpipe", "tool_joint", "tool_joint", "drillpipe"],
    ...["collar", "collar", "stabilizer", "bit"],
  ]);
  assert.deepEqual(kindsOf([], [0, 1]), ["drillpipe"]);
});
