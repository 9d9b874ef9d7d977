// Places of axes and panels, ranges that belong together, legends, and what is zoomed to.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import { zoomBox } from "../../draw/picture/interaction.js";
import { arrange, axesOf, panelsOf } from "../../draw/picture/layout.js";
import { entriesOf, isolated, legendRows, shownTraces, toggled } from "../../draw/picture/legend.js";

const MARGIN = { l: 60, r: 16, t: 16, b: 50 };
const measure = (text) => 6 * text.length;

/** Axes and panels of traces in a picture of 800 by 400 pixels. */
function laid(traces, layout, room = {}) {
  const axes = axesOf(traces, layout);
  const panels = panelsOf(traces, axes);
  const size = { width: 800, height: 400, top: 0, bar: 0, measure, ...room };
  const frame = arrange(axes, panels, { margin: MARGIN, ...layout }, size);
  return { axes, panels, frame };
}
const line = (more = {}) => ({ type: "scatter", mode: "lines", x: [0, 1], y: [0, 2], ...more });

test("the frame leaves the margins, more where words need it, and room for a legend and a bar", () => {
  const { frame } = laid([line()], {});
  assert.deepEqual([frame.left, frame.top, frame.right, frame.bottom], [60, 16, 784, 350]);
  const names = ["a name that is very long indeed", "b"];
  const wide = laid([line({ y: names })], {}, { top: 40, bar: 90 }).frame;
  assert.ok(wide.left > measure(names[0]));
  assert.deepEqual([wide.top, wide.right], [40, 694]);
});

test("panels have their parts of the frame", () => {
  const { axes, panels } = laid([line(), line({ yaxis: "y2" })], {
    xaxis: { anchor: "y2" },
    yaxis: { domain: [0.5, 1] },
    yaxis2: { domain: [0, 0.4], anchor: "x" },
  });
  assert.equal(panels.length, 2);
  const [upper, lower] = [axes.get("y"), axes.get("y2")];
  near(upper.offset, 16);
  near(upper.length, 167);
  near(lower.offset + lower.length, 350);
  assert.ok(lower.offset > upper.offset + upper.length);
});

test("an axis over another one has its place and panel", () => {
  const { axes, panels } = laid([line(), line({ yaxis: "y2", y: [0, 5000] })], {
    yaxis2: { overlaying: "y", side: "right" },
  });
  assert.equal(panels.length, 1);
  assert.deepEqual(panels[0].over, [axes.get("y2")]);
  assert.equal(axes.get("y2").offset, axes.get("y").offset);
  assert.notDeepEqual(axes.get("y2").range, axes.get("y").range);
});

test("axes that match have the range of all of them", () => {
  const { axes } = laid([line(), line({ xaxis: "x2", yaxis: "y2", y: [-8, 1] })], {
    yaxis2: { matches: "y", anchor: "x2" },
  });
  assert.deepEqual(axes.get("y").range, axes.get("y2").range);
  assert.ok(axes.get("y").range[0] < -8 && axes.get("y").range[1] > 2);
});

test("tied axes have one scale in all panels", () => {
  const { axes } = laid([line(), line({ xaxis: "x2", yaxis: "y2" })], {
    xaxis: { range: [-1, 1], scaleanchor: "y", domain: [0, 0.45] },
    yaxis: { range: [-2, 2] },
    xaxis2: { range: [-1, 1], matches: "x", domain: [0.55, 1], anchor: "y2" },
    yaxis2: { range: [-2, 2], matches: "y", anchor: "x2", domain: [0, 0.9] },
  });
  const scales = ["x", "y", "x2", "y2"].map((name) => axes.get(name).scale);
  for (const scale of scales) near(scale, scales[0], 1e-9);
});

test("the range of hidden traces is not reserved", () => {
  const traces = [line({ name: "a" }), line({ name: "b", y: [0, 1000] })];
  const shown = shownTraces(traces, entriesOf(traces, {}), new Set(["b"]));
  assert.deepEqual(shown, [traces[0]]);
  assert.ok(axesOf(traces, {}, shown).get("y").range[1] < 3);
});

test("legends name what has a name, groups once, in their order", () => {
  const traces = [
    line({ name: "b", legendrank: 2, legendgroup: "1" }),
    line({ name: "a", legendrank: 1 }),
    line({ name: "b", legendgroup: "1", showlegend: false }),
    line({}),
    { ...line({ name: "map" }), type: "heatmap", z: [[1]] },
  ];
  const entries = entriesOf(traces, {});
  assert.deepEqual(
    entries.map(({ name }) => name),
    ["a", "b"],
  );
  assert.equal(entries[1].traces.length, 2);
  assert.deepEqual(entriesOf(traces, { showlegend: false }), []);
  assert.deepEqual(entriesOf([line({ name: "alone" })], {}), []);
  assert.equal(entriesOf([line({ name: "alone", showlegend: true })], {}).length, 1);
});

test("names are hidden, shown, and shown alone", () => {
  const names = ["a", "b", "c"];
  assert.deepEqual([...toggled(new Set(), "a")], ["a"]);
  assert.deepEqual([...toggled(new Set(["a"]), "a")], []);
  assert.deepEqual([...isolated(new Set(["b"]), "b", names)], ["a", "c"]);
  assert.deepEqual([...isolated(new Set(["a", "c"]), "b", names)], []);
});

test("long legends take several rows", () => {
  const entries = ["one", "another", "the third"].map((name) => ({ name, traces: [] }));
  const { places, height } = legendRows(entries, 150, measure);
  assert.deepEqual(
    places.map(({ left, top }) => [left > 0, top > 0]),
    [
      [false, false],
      [true, false],
      [false, true],
    ],
  );
  assert.ok(height > legendRows(entries.slice(0, 1), 150, measure).height);
  assert.equal(legendRows([], 150, measure).height, 0);
});

test("a thin area zooms one direction, and one scale keeps the panel's shape", () => {
  const { panels } = laid([line()], {});
  const [panel] = panels;
  const start = { x: 100, y: 100 };
  assert.deepEqual(zoomBox(start, { x: 300, y: 200 }, panel, false), { x: [100, 300], y: [100, 200] });
  assert.deepEqual(zoomBox(start, { x: 300, y: 105 }, panel, false), { x: [100, 300], y: null });
  assert.deepEqual(zoomBox(start, { x: 104, y: 200 }, panel, false), { x: null, y: [100, 200] });
  assert.equal(zoomBox(start, { x: 104, y: 105 }, panel, false), null);
  // What lies beyond the panel does not count.
  assert.deepEqual(zoomBox(start, { x: 2000, y: 200 }, panel, false).x, [100, 784]);
  const { x, y } = zoomBox(start, { x: 300, y: 110 }, panel, true);
  near((x[1] - x[0]) / (y[1] - y[0]), panel.x.length / panel.y.length);
});
