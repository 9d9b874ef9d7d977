// What points are compared by side by side, a picture each with one scale of colours, and rotation at the bit.

import { each, noteNode } from "./compare-views.js";
import { fill, h } from "./dom.js";
import { canvas, draw } from "./plots.js";
import { contactMap, largestShown } from "./point-contacts.js";
import { endsOf, RECORD_ENDS, twoPanels } from "./point-rotation.js";
import { describe, drawSpectrogram, largestOf } from "./point-spectrogram.js";
import { frames } from "./snapshots.js";
import { stringPlayer } from "./string-player.js";
import { shown } from "./units.js";

/** @typedef {import("./compare-views.js").Comparison} Comparison */
/** @typedef {import("./compare-views.js").Compared} Compared */

/** Frequencies of spectrograms [Hz]. */
export const RANGES = ["5", "10", "20", "50", "100"];

/**
 * What the views of a point are made with, of one that is compared.
 * @param {Comparison} comparison
 * @param {Compared} point
 * @returns {import("./point.js").PointContext}
 */
function contextOf({ query, keep, table, signal }, point) {
  return { point: point.detail, path: point.path, query, keep, bias: () => "", table: (name, asks) => table(point, name, asks), signal };
}

/** @param {{query: URLSearchParams}} comparison @returns {number} highest frequency of spectrograms [Hz] */
export function rangeOf({ query }) {
  return Number(RANGES.find((text) => text === query.get("range")) ?? "20");
}

/** @param {HTMLElement} place @param {Comparison} comparison */
export async function drawSpectrograms(place, comparison) {
  const { node, window, signal } = comparison;
  const range = rangeOf(comparison);
  const found = await each(comparison, async (point) => {
    const table = await comparison.table(point, "spectrogram", { ...node, ...window, range_hz: range });
    noteNode(comparison, point, table.attributes.node, table.attributes.measured_depth);
    return table;
  });
  const most = Math.max(...found.map(([, table]) => largestOf(table)));
  const pictures = found.map(([point, table]) => ({ table, heading: point.name, picture: canvas(`Spectrogram, point ${point.name}`, `spectrogram${point.number}`) }));
  fill(place, pictures.map(({ table, heading, picture }) => h("div", { class: "panel" }, h("h2", {}, heading), h("figure", {}, picture, h("figcaption", {}, describe(table, range))))));
  await Promise.all(pictures.map(({ table, picture }) => drawSpectrogram(picture, table, { isLog: comparison.query.get("amplitude") !== "linear", range, most }, signal)));
}

/**
 * What there is of a point's snapshots; the service says why there are none.
 * @param {Comparison} comparison @param {Compared} point
 */
async function snapshotsThere(comparison, point) {
  const [snapshots, statics] = await Promise.all([comparison.table(point, "snapshots", { max_frames: 1 }), comparison.table(point, "statics")]);
  const { snapshots: count, nodes, first, interval } = snapshots.attributes;
  // One was served, so that the interval is that of all.
  return { there: { names: Object.keys(snapshots.columns), count, nodes, first, interval: interval / Math.max(1, count) }, statics: statics.columns };
}

/** Contacts over depth and time. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawContactMaps(place, comparison) {
  const found = await each(comparison, async (point) => {
    const { there, statics } = await snapshotsThere(comparison, point);
    const { recording, duration } = point.detail.scenario;
    const context = contextOf(comparison, point);
    return { context, statics, motion: await frames(context, ["normal_force"], recording.snapshots.window ?? { from: 0, to: duration }, there.nodes) };
  });
  const most = Math.max(...found.map(([, { motion }]) => largestShown(motion.columns.normal_force)));
  const maps = found.map(([point, one]) => ({ ...one, map: contactMap(one.context, null, { heading: point.name, key: `contacts${point.number}` }) }));
  fill(place, maps.map(({ map }) => map.element));
  await Promise.all(maps.map(({ map, motion, statics }) => map.draw(motion, statics, most)));
}

/** The strings in their holes, on one clock. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawStrings(place, comparison) {
  const found = await each(comparison, (point) => snapshotsThere(comparison, point));
  if (!found.length) return fill(place);
  const player = stringPlayer(found.map(([point, one]) => ({ ...one, context: contextOf(comparison, point), heading: point.name })), async () => {});
  fill(place, player.element);
  await player.load();
}

/** Rotation speed and torque at the bit. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawBits(place, comparison) {
  const found = await each(comparison, (point) => endsOf(contextOf(comparison, point), comparison.window));
  const traces = found.flatMap(([point, ends]) => {
    const lines = ends.lines.filter(({ end }) => end === "bit");
    if (!lines.length) comparison.lacking.push(`Point ${point.number} is missing: ${RECORD_ENDS}`);
    return lines.map(({ quantity, time, values }) => ({ type: "scattergl", mode: "lines", x: time, y: shown(quantity, values), yaxis: quantity === "torque" ? "y2" : "y", name: point.name, legendgroup: String(point.number), showlegend: quantity !== "torque", line: { color: point.colour, dash: point.dash, width: 1 }, hovertemplate: "%{x:.3f} s: %{y:.4~g}<extra></extra>" }));
  });
  return draw(place, traces, { shows: comparison.window, dragmode: "select", selectdirection: "h", ...twoPanels() }, comparison.signal);
}
