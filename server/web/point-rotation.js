// Rotation speed and torque over time at both ends of the string: from the snapshots, or else from the history.

import { Problem } from "./api.js";
import { h } from "./dom.js";
import { python } from "./lines.js";
import { canvas, draw, LINES } from "./plots.js";
import { frames, snapshotsOf } from "./snapshots.js";
import { say, shown, title } from "./units.js";

/** Nodes of all snapshots together from which the lines are taken. */
const TAKEN = 300_000;
/** Samples of a history in a picture. */
const SHOWN = 4000;
const QUANTITIES = ["rotation_speed", "torque"];

/** Why there may be no such lines. */
export const RECORD_ENDS = "Rotation speed and torque at the bit are not in this result: torsion was not solved for, or what is kept is chosen (recording.outputs).";

/**
 * One quantity at one end, in served units.
 * @typedef {{end: "bit" | "top", node: number, quantity: string, time: number[], values: (number | null)[]}} EndLine
 */

/**
 * Rotation speed and torque at bit and top, as far as they were recorded; where the bit is not, none.
 * @param {import("./point.js").PointContext} context
 * @param {{from: number, to: number}} window [s]
 * @returns {Promise<{lines: EndLine[], source: "snapshots" | "history" | ""}>}
 */
export async function endsOf(context, window) {
  const snapshots = await endsOfSnapshots(context, window);
  if (snapshots.length) return { lines: snapshots, source: "snapshots" };
  const lines = await endsOfHistory(context, window);
  return { lines, source: lines.length ? "history" : "" };
}

/**
 * @param {import("./point.js").PointContext} context
 * @param {{from: number, to: number}} window
 * @returns {Promise<EndLine[]>}
 */
export async function endsOfSnapshots(context, window) {
  const there = await snapshotsOf(context);
  if (!there?.names.includes("torque")) return [];
  const { nodes } = there;
  const { count, first, interval, columns } = await frames(context, QUANTITIES, window, nodes, TAKEN);
  const time = Array.from({ length: count }, (_, frame) => first + frame * interval);
  return QUANTITIES.flatMap((quantity) => /** @type {["bit" | "top", number][]} */ ([["bit", nodes], ["top", 1]]).map(([end, node]) => ({ end, node, quantity, time, values: time.map((_, frame) => columns[quantity][frame * nodes + node - 1]) })));
}

/**
 * @param {import("./point.js").PointContext} context
 * @param {{from: number, to: number}} window
 * @returns {Promise<EndLine[]>}
 */
export async function endsOfHistory(context, window) {
  try {
    // One sample tells the columns.
    const [statics, sample] = await Promise.all([context.table("statics", { fields: "node" }), context.table("history", { max_points: 1 })]);
    const [top, bit] = [statics.columns.node[0], statics.columns.node.at(-1)];
    const has = (/** @type {number} */ node) => QUANTITIES.every((quantity) => `${quantity}_${node}` in sample.columns);
    if (!has(bit)) return [];
    const ends = /** @type {["bit" | "top", number][]} */ ([["bit", bit], ["top", top]]).filter(([, node]) => has(node));
    const found = await Promise.all(ends.map(async ([end, node]) => {
      const names = QUANTITIES.map((quantity) => `${quantity}_${node}`);
      const { columns } = await context.table("history", { node, ...window, fields: ["time", ...names].join(","), max_points: SHOWN, decimation: "minmax" });
      return QUANTITIES.map((quantity, index) => ({ end, node, quantity, time: columns.time, values: columns[names[index]] }));
    }));
    return found.flat();
  } catch (error) {
    // Without histories, or without torsion, there are none.
    if (error instanceof Problem && error.status !== 401) return [];
    throw error;
  }
}

/**
 * The requests behind lines from histories.
 * @param {EndLine[]} lines
 * @returns {import("./point.js").PartRequest}
 */
export function endsRequest(lines) {
  const nodes = [...new Set(lines.map(({ node }) => node))];
  const columns = (/** @type {number} */ node) => ["time", ...QUANTITIES.map((quantity) => `${quantity}_${node}`)];
  return {
    asked: nodes.map((node) => ({ table: "history", name: `history_${node}`, query: { node, fields: columns(node).join(",") } })),
    python: nodes.map((node) => `history_${node} = point.history(node=${node}).to_pandas()[${python(columns(node))}]`).join("\n"),
  };
}

/** What the torque at an end is. */
export const TORQUE = "The torque is what the string carries in its last element at that end.";

/**
 * How that differs from the torque on bit.
 * @param {any} point
 */
function sayTorqueOnBit({ scenario }) {
  return `At the bit it differs from the torque on bit, which is constant at ${say("torque", scenario.operation.torque_on_bit)}, by what the friction of the wall and the inertia below the middle of that element take.`;
}

/** @param {import("./point.js").PointContext} context */
export function rotation(context) {
  const place = canvas("Rotation speed and torque at bit and top", "rotation", "", "whole");
  const caption = h("figcaption", {});
  return {
    element: h("div", { class: "panel" }, h("h2", {}, "Rotation speed and torque at bit and top"), h("figure", {}, place, caption)),
    /**
     * Draws what there is.
     * @param {{from: number, to: number}} window [s]
     * @returns {Promise<EndLine[]>}
     */
    async draw(window) {
      const { lines, source } = await endsOf(context, window);
      if (!lines.length) return lines;
      const has = (/** @type {string} */ end) => lines.some((line) => line.end === end);
      const colours = { bit: { rotation_speed: LINES[0], torque: LINES[1] }, top: { rotation_speed: LINES[5], torque: LINES[3] } };
      caption.textContent = `From the ${source === "snapshots" ? "snapshots" : "recorded history"}. ${has("top") ? "The top turns at the speed that is imposed on it; its torque is what the drive has to hold against. " : "The top was not recorded. "}${TORQUE} ${sayTorqueOnBit(context.point)}`;
      await draw(
        place,
        lines.map(({ end, quantity, time, values }) => ({ type: "scattergl", mode: "lines", x: time, y: shown(quantity, values), yaxis: quantity === "torque" ? "y2" : "y", name: `${quantity === "torque" ? "torque" : "speed"}, ${end}`, line: { color: /** @type {any} */ (colours)[end][quantity], width: 1.2 }, hovertemplate: "%{x:.2f} s: %{y:.4~g}<extra></extra>" })),
        { showlegend: true, ...twoPanels() },
        context.signal,
      );
      return lines;
    },
  };
}

/** Rotation speed above torque over one axis of time. */
export function twoPanels() {
  return { xaxis: { title: "time [s]", anchor: "y2" }, yaxis: { title: title("rotation_speed"), quantity: "rotation_speed", domain: [0.54, 1] }, yaxis2: { title: title("torque"), quantity: "torque", domain: [0, 0.46], anchor: "x" } };
}
