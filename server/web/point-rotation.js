// Rotation speed and torque over time at both ends of the string, from the snapshots.

import { h } from "./dom.js";
import { canvas, draw, LINES } from "./plots.js";
import { frames } from "./snapshots.js";
import { shown, title } from "./units.js";

/** Nodes of all snapshots together from which the lines are taken. */
const TAKEN = 300_000;

/** @param {import("./point.js").PointContext} context */
export function rotation(context) {
  const place = canvas("Rotation speed and torque at bit and top", "rotation");
  return {
    element: h("div", { class: "panel" }, h("h2", {}, "Rotation speed and torque at bit and top"), h("figure", {}, place, h("figcaption", {}, "The top turns at the speed that is imposed on it; its torque is what the drive has to hold against. At the bit the torque on bit is constant."))),
    /** @param {{from: number, to: number}} window [s] @param {number} nodes */
    async draw(window, nodes) {
      const { count, first, interval, columns } = await frames(context, ["rotation_speed", "torque"], window, nodes, TAKEN);
      const time = Array.from({ length: count }, (_, frame) => first + frame * interval);
      const at = (/** @type {string} */ name, /** @type {number} */ node) => shown(name, Array.from({ length: count }, (_, frame) => columns[name][frame * nodes + node]));
      const line = (/** @type {string} */ name, /** @type {number} */ node, /** @type {string} */ text, /** @type {any} */ more) => ({ type: "scattergl", mode: "lines", x: time, y: at(name, node), name: text, hovertemplate: "%{x:.2f} s: %{y:.4~g}<extra></extra>", ...more });
      await draw(
        place,
        [
          line("rotation_speed", nodes - 1, "speed, bit", { line: { color: LINES[0], width: 1.2 } }),
          line("rotation_speed", 0, "speed, top", { line: { color: LINES[5], width: 1.2 } }),
          line("torque", nodes - 1, "torque, bit", { yaxis: "y2", line: { color: LINES[1], width: 1.2 } }),
          line("torque", 0, "torque, top", { yaxis: "y2", line: { color: LINES[3], width: 1.2 } }),
        ],
        { showlegend: true, xaxis: { title: "time [s]", anchor: "y2" }, yaxis: { title: title("rotation_speed"), quantity: "rotation_speed", domain: [0.54, 1] }, yaxis2: { title: title("torque"), quantity: "torque", domain: [0, 0.46], anchor: "x" } },
        context.signal,
      );
    },
  };
}
