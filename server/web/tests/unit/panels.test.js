// Panels of compared points.

import "./browser.js";
import assert from "node:assert/strict";
import { test } from "node:test";
import { near } from "./browser.js";
import {
  columnsOf,
  largestFirst,
  linesOf,
  panelsInPlane,
  panelsOver,
  rangeOf,
} from "../../compare/panels.js";

const panel = (name, y, scale = "") => ({
  name,
  colour: "#0072b2",
  traces: [{ x: y.map((_, index) => index), y }],
  scale,
  yaxis: { title: "torque" },
});

test("panels over time have one scale for each quantity and do not overlap", () => {
  const place = { style: {}, clientWidth: 900 };
  const panels = [panel("a", [0, 2], "v"), panel("b", [-4, 6], "v"), panel("c", [100, null], "T")];
  const { traces, layout } = panelsOver(place, panels);
  assert.deepEqual(
    traces.map(({ yaxis }) => yaxis),
    ["y", "y2", "y3"],
  );
  assert.deepEqual(layout.yaxis.range, layout.yaxis2.range);
  assert.equal(layout.yaxis2.matches, "y");
  assert.equal(layout.yaxis3.matches, undefined);
  assert.ok(layout.yaxis.range[0] < -4 && layout.yaxis.range[1] > 6);
  const domains = [layout.yaxis, layout.yaxis2, layout.yaxis3].map(({ domain }) => domain);
  for (const [order, [from, to]] of domains.entries()) {
    assert.ok(from < to);
    if (order) assert.ok(to < domains[order - 1][0]);
  }
  assert.equal(layout.annotations.length, 3);
});

test("names of panels are text and no markup", () => {
  const { layout } = panelsOver({ style: {}, clientWidth: 900 }, [panel("<b>x</b> & y", [1])]);
  assert.equal(layout.annotations[0].text, "<b>x</b> & y");
  assert.equal(layout.annotations[0].mark, "#0072b2");
});

test("long names are broken into lines where a panel ends, and none is cut", () => {
  const name = "1: flow rate 0.0266 m³/s, mud density 1650 kg/m³";
  const shown = (width) => {
    const place = { style: {}, clientWidth: width };
    return { place, note: panelsOver(place, [panel("2", [1]), panel(name, [1])]).layout.annotations[1] };
  };
  assert.equal(shown(900).note.text, name);
  const lines = shown(350).note.text.split("<br>");
  assert.equal(lines.join(" "), name);
  assert.equal(lines.length, 2);
  // Panels keep their heights.
  assert.equal(parseFloat(shown(350).place.style.height), parseFloat(shown(900).place.style.height));
  const high = (width) => {
    const place = { style: {}, clientWidth: width };
    panelsOver(place, Array(6).fill(panel(name, [1])));
    return parseFloat(place.style.height);
  };
  assert.equal(high(350) - high(900), 6 * 15);
});

test("words that are longer than a line are broken, and no letter is lost", () => {
  assert.deepEqual(linesOf("abcdefghij kl mn", 5), ["abcde", "fghij", "kl mn"]);
  assert.deepEqual(linesOf("", 5), [""]);
});

test("orbits are in a plane of equal panels, below each other on a phone", () => {
  const axes = {
    xaxis: { title: "across", range: [-1, 1], scaleanchor: "y" },
    yaxis: { title: "up", range: [-1, 1] },
  };
  const panels = ["a", "b", "c", "d"].map((name) => panel(name, [0]));
  const wide = panelsInPlane({ style: {}, clientWidth: 1100 }, panels, axes).layout;
  const widths = ["xaxis", "xaxis2", "xaxis3", "xaxis4"].map(
    (name) => wide[name].domain[1] - wide[name].domain[0],
  );
  for (const width of widths) near(width, widths[0]);
  assert.equal(wide.xaxis.scaleanchor, "y");
  assert.equal(wide.xaxis2.scaleanchor, undefined);
  assert.equal(wide.xaxis4.matches, "x");
  near(wide.xaxis4.domain[1], 1);
  assert.ok(wide.yaxis3.domain[1] < wide.yaxis.domain[0]);
  const phone = panelsInPlane({ style: {}, clientWidth: 350 }, panels, axes).layout;
  assert.deepEqual(phone.xaxis4.domain, [0, 1]);
  assert.ok(phone.yaxis4.domain[1] < phone.yaxis3.domain[0]);
});

test("as many panels stand in a row as have room", () => {
  assert.deepEqual(
    [1, 2, 3, 4, 5, 6].map((count) => columnsOf(count, 1100)),
    [1, 2, 3, 2, 3, 3],
  );
  assert.deepEqual(
    [1, 2, 6].map((count) => columnsOf(count, 350)),
    [1, 1, 1],
  );
});

test("a range holds all values, and none without any", () => {
  assert.equal(rangeOf([panel("a", [null])]), undefined);
  const [from, to] = rangeOf([panel("a", [3]), panel("b", [3])]);
  assert.ok(from < 3 && to > 3);
});

test("of lines in one picture the largest lies below, and the legend keeps their order", () => {
  const traces = [
    { name: "a", y: [0, 1] },
    { name: "b", y: [-8, null, 2] },
    { name: "c", y: [100, 103] },
  ];
  assert.deepEqual(
    largestFirst(traces).map(({ name, legendrank }) => [name, legendrank]),
    [
      ["b", 2],
      ["c", 3],
      ["a", 1],
    ],
  );
});
