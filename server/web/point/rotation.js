// Rotation speed and torque over time at both ends of the string: from the history, or else from the snapshots.

import { Problem } from "../data/api.js";
import { keptWindow } from "../data/motion-requests.js";
import { signRules } from "../data/signs.js";
import { frames, snapshotsOf } from "../data/snapshots.js";
import { number, say, shown, title } from "../data/units.js";
import { canvas, draw, LINES } from "../draw/plots.js";
import { TimeLine } from "../draw/time-line.js";
import { h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { python, pythonNode } from "../ui/snippets.js";

/** Nodes of all snapshots together from which the lines are taken. */
const TAKEN = 300_000;
/** Samples of a history in a picture. */
const SHOWN = 4000;
const QUANTITIES = ["rotation_speed", "torque"];

/** Reason for missing lines. */
export const RECORD_ENDS =
  "Rotation speed and torque at the bit are not in this result: torsion was not solved for, or recording.outputs leaves them out.";

/**
 * One quantity at one end, in served units.
 * @typedef {{end: "bit" | "top", node: number, quantity: string, source: "history" | "snapshots", time: number[], values: (number | null)[]}} EndLine
 */

/**
 * Rotation speed and torque at bit and top, as far as they were recorded: of each end from the history where it is there, which has more
 * samples a second than the snapshots.
 * @param {import("./part.js").PointContext} context
 * @param {{from: number, to: number}} window [s]
 * @returns {Promise<EndLine[]>}
 */
async function endsOf(context, window) {
  const history = await endsOfHistory(context, window);
  const isMissing = (/** @type {string} */ end) => !history.some((line) => line.end === end);
  if (!isMissing("bit") && !isMissing("top")) return history;
  return [...history, ...(await endsOfSnapshots(context, window)).filter(({ end }) => isMissing(end))];
}

/**
 * @param {import("./part.js").PointContext} context
 * @param {{from: number, to: number}} window
 * @returns {Promise<EndLine[]>}
 */
export async function endsOfSnapshots(context, window) {
  const there = await snapshotsOf(context);
  if (!there?.names.includes("torque")) return [];
  const { nodes } = there;
  const { count, first, interval, columns } = await frames(context, QUANTITIES, window, nodes, TAKEN);
  if (!count) return [];
  const time = Array.from({ length: count }, (_, frame) => first + frame * interval);
  return QUANTITIES.flatMap((quantity) =>
    /** @type {["bit" | "top", number][]} */ ([
      ["bit", nodes],
      ["top", 1],
    ]).map(([end, node]) => ({
      end,
      node,
      quantity,
      source: "snapshots",
      time,
      values: time.map((_, frame) => columns[quantity][frame * nodes + node - 1]),
    })),
  );
}

/**
 * @param {import("./part.js").PointContext} context
 * @param {{from: number, to: number}} window
 * @returns {Promise<EndLine[]>}
 */
export async function endsOfHistory(context, window) {
  // The service would refuse, which the browser writes of.
  if (!context.point.tables.includes("history")) return [];
  const kept = keptWindow(context.point);
  const part = { from: Math.max(kept.from, window.from), to: Math.min(kept.to, window.to) };
  if (part.from >= part.to) return [];
  try {
    // One sample tells the columns.
    const [statics, sample] = await Promise.all([
      context.table("statics", { fields: "node" }),
      context.table("history", { max_points: 1 }),
    ]);
    const [top, bit] = [statics.columns.node[0], statics.columns.node.at(-1)];
    const has = (/** @type {number} */ node) =>
      QUANTITIES.every((quantity) => `${quantity}_${node}` in sample.columns);
    if (!has(bit)) return [];
    const ends = /** @type {["bit" | "top", number][]} */ ([
      ["bit", bit],
      ["top", top],
    ]).filter(([, node]) => has(node));
    const found = await Promise.all(
      ends.map(async ([end, node]) => {
        const names = QUANTITIES.map((quantity) => `${quantity}_${node}`);
        const { columns } = await context.table("history", {
          node,
          ...part,
          fields: ["time", ...names].join(","),
          max_points: SHOWN,
          decimation: "minmax",
        });
        return QUANTITIES.map(
          (quantity, index) =>
            /** @type {EndLine} */ ({
              end,
              node,
              quantity,
              source: "history",
              time: columns.time,
              values: columns[names[index]],
            }),
        );
      }),
    );
    return found.flat();
  } catch (error) {
    // Files expire.
    if (error instanceof Problem && error.status === 404) return [];
    throw error;
  }
}

/**
 * The requests behind those lines that are of the history.
 * @param {EndLine[]} lines
 * @param {{from: number, to: number} | null} [window] [s]
 * @returns {import("./part.js").PartRequest}
 */
export function endsRequest(lines, window = null) {
  const nodes = [...new Set(lines.filter(({ source }) => source === "history").map(({ node }) => node))];
  const columns = (/** @type {number} */ node) => [
    "time",
    ...QUANTITIES.map((quantity) => `${quantity}_${node}`),
  ];
  return {
    asked: nodes.map((node) => ({
      table: "history",
      name: `history_${node}`,
      query: { node, ...window, fields: columns(node).join(",") },
    })),
    python: nodes
      .map(
        (node) =>
          `history_${node} = point.history(${pythonNode({ node }, window)}).to_pandas()[${python(columns(node))}]`,
      )
      .join("\n"),
  };
}

/** Sources of the lines, in words. @param {EndLine[]} lines */
function saySources(lines) {
  const of = (/** @type {string} */ end) => lines.find((line) => line.end === end)?.source;
  const words = { history: "the recorded history", snapshots: "the snapshots" };
  const [bit, top] = [of("bit"), of("top")];
  if (bit && top && bit !== top) return `The bit is from ${words[bit]}, the top from ${words[top]}.`;
  const source = bit ?? top;
  return source ? `From ${words[source]}.` : "";
}

/** Sentence about the torque at an end. */
export const TORQUE = `The torque is that of the string's last element at that end. ${signRules(["torque"])}`;

/**
 * Sentence about its difference from the torque on bit.
 * @param {any} point
 */
function sayTorqueOnBit({ scenario }) {
  return `At the bit it differs from the torque on bit, which is constant at ${say("torque", scenario.operation.torque_on_bit)}, by the friction of the wall and the inertia below the middle of that element.`;
}

/** @param {import("./part.js").PointContext} context */
export function rotation(context) {
  const place = canvas("Rotation speed and torque at bit and top", "rotation");
  const cursor = new TimeLine(place, context.time, context.signal);
  const caption = h("figcaption", {});
  const begin = generations();
  const element = h(
    "div",
    { class: "panel" },
    h("h2", {}, "Rotation speed and torque at bit and top"),
    h("figure", {}, place, caption, cursor.reading),
  );
  return {
    element,
    /**
     * Draws what there is.
     * @param {{from: number, to: number}} window [s]
     * @returns {Promise<EndLine[] | null>} null where another window has been asked for since
     */
    async draw(window) {
      const isNewest = begin();
      const lines = await endsOf(context, window);
      if (!isNewest()) return null;
      element.hidden = !lines.length;
      if (!lines.length) return lines;
      const has = (/** @type {string} */ end) => lines.some((line) => line.end === end);
      const colours = {
        bit: { rotation_speed: LINES[0], torque: LINES[1] },
        top: { rotation_speed: LINES[5], torque: LINES[3] },
      };
      caption.textContent = `${saySources(lines)} ${has("top") ? "The top turns at the imposed speed; its torque is the torque of the drive. " : "The top was not recorded. "}${TORQUE} ${sayTorqueOnBit(context.point)}`;
      await draw(
        place,
        lines.map(({ end, quantity, time, values }) => ({
          type: "scatter",
          mode: "lines",
          x: time,
          y: shown(quantity, values),
          yaxis: quantity === "torque" ? "y2" : "y",
          name: `${quantity === "torque" ? "torque" : "speed"}, ${end}`,
          line: { color: /** @type {any} */ (colours)[end][quantity], width: 1.2 },
          describe: (/** @type {{x: number, y: number}} */ { x, y }) => `${number(x)} s: ${number(y)}`,
        })),
        { showlegend: true, ...twoPanels() },
        context.signal,
      );
      return lines;
    },
  };
}

/** Rotation speed above torque over one axis of time. */
function twoPanels() {
  return {
    xaxis: { title: "time [s]", anchor: "y2" },
    yaxis: { title: title("rotation_speed"), quantity: "rotation_speed", domain: [0.54, 1] },
    yaxis2: { title: title("torque"), quantity: "torque", domain: [0, 0.46], anchor: "x" },
  };
}
