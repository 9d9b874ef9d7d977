// Views with a picture for each point, side by side on one scale of colours, and rotation at the ends of the
// string.

import { get } from "../data/api.js";
import { largestShown } from "../data/decimation.js";
import { equilibrium } from "../data/equilibrium.js";
import { frames, snapshotTimes } from "../data/snapshots.js";
import { number, shown, title } from "../data/units.js";
import { canvas, draw, laidOut } from "../draw/plots.js";
import { TimeLine } from "../draw/time-line.js";
import { contactMap } from "../point/contacts.js";
import { endsOfHistory, endsOfSnapshots, RECORD_ENDS, TORQUE } from "../point/rotation.js";
import { describe, drawSpectrogram, largestOf, RANGES, spectrogramOf } from "../point/spectrogram.js";
import { StringPlayer } from "../point/string-player.js";
import { fill, h } from "../ui/dom.js";
import { each, Lacking, noteNode } from "./comparison.js";
import { panelsOver } from "./panels.js";

/** @typedef {import("./comparison.js").Comparison} Comparison */
/** @typedef {import("./comparison.js").Compared} Compared */

/**
 * Data and callbacks that views of a point take, for a compared point.
 * @param {Comparison} comparison
 * @param {Compared} point
 * @returns {import("../point/part.js").PointContext}
 */
function contextOf({ query, keep, time, table, drawing }, point) {
  return {
    point: point.detail,
    path: point.path,
    query,
    keep,
    time,
    bias: () => "",
    table: (name, asks) => table(point, name, asks),
    diagnosis: () => get(`${point.path}/diagnosis`, {}, drawing),
    drawn: () => {},
    signal: drawing,
  };
}

/** @param {{query: URLSearchParams}} comparison @returns {number} highest frequency of spectrograms [Hz] */
export function rangeOf({ query }) {
  return Number(RANGES.find((text) => text === query.get("range")) ?? "20");
}

/** @param {HTMLElement} place @param {Comparison} comparison */
export async function drawSpectrograms(place, comparison) {
  const { node, window, drawing } = comparison;
  const range = rangeOf(comparison);
  const found = await each(comparison, async (point) => {
    const table = await spectrogramOf(point.path, { ...node, ...window, range_hz: range }, drawing);
    noteNode(comparison, point, table.attributes.node, table.attributes.measured_depth);
    return table;
  });
  const most = Math.max(...found.map(([, table]) => largestOf(table)));
  const pictures = found.map(([point, table]) => ({
    table,
    heading: point.name,
    picture: canvas(`Spectrogram, point ${point.name}`, `spectrogram${point.number}`),
  }));
  for (const { picture } of pictures) new TimeLine(picture, comparison.time, drawing);
  fill(
    place,
    pictures.map(({ table, heading, picture }) =>
      h(
        "div",
        { class: "panel" },
        h("h2", {}, heading),
        h("figure", {}, picture, h("figcaption", {}, describe(table, range))),
      ),
    ),
  );
  await Promise.all(
    pictures.map(({ table, picture }) =>
      drawSpectrogram(
        picture,
        table,
        { isLog: comparison.query.get("amplitude") !== "linear", range, most },
        drawing,
      ),
    ),
  );
}

/**
 * Describes a point's snapshots; reports a point without any.
 * @param {Comparison} comparison @param {Compared} point
 */
async function snapshotsThere(comparison, point) {
  // The service would refuse, which the browser writes of.
  if (!point.detail.scenario.recording.snapshots)
    throw new Lacking("it recorded no snapshots of the whole string (recording.snapshots)");
  /** @type {Parameters<typeof equilibrium>[0]} */
  const table = (name, query) => comparison.table(point, name, query);
  const [times, statics] = await Promise.all([snapshotTimes(table), equilibrium(table)]);
  return { there: { ...times, nodes: statics.node.length }, statics };
}

/** Contacts over depth and time. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawContactMaps(place, comparison) {
  const found = await each(comparison, async (point) => {
    const { there, statics } = await snapshotsThere(comparison, point);
    const { recording, duration } = point.detail.scenario;
    const context = contextOf(comparison, point);
    return {
      context,
      statics,
      motion: await frames(
        context,
        ["normal_force"],
        recording.snapshots.window ?? { from: 0, to: duration },
        there.nodes,
      ),
    };
  });
  const most = Math.max(...found.map(([, { motion }]) => largestShown(motion.columns.normal_force)));
  const maps = found.map(([point, one]) => ({
    ...one,
    map: contactMap(one.context, { heading: point.name, key: `contacts${point.number}` }),
  }));
  fill(
    place,
    maps.map(({ map }) => map.element),
  );
  await Promise.all(maps.map(({ map, motion, statics }) => map.draw(motion, statics, most)));
}

/** The strings in their holes, on one clock. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawStrings(place, comparison) {
  const found = await each(comparison, (point) => snapshotsThere(comparison, point));
  if (!found.length) return fill(place);
  const player = new StringPlayer(
    found.map(([point, one]) => ({ ...one, context: contextOf(comparison, point), heading: point.name })),
    async () => {},
  );
  fill(place, player.element);
  await player.load();
}

/** The end of the string whose rotation is compared. @param {{query: URLSearchParams}} comparison @returns {"bit" | "top"} */
export function endOf({ query }) {
  return query.get("end") === "top" ? "top" : "bit";
}

/**
 * Rotation speed and torque at one end: from the histories where all points have it there, else from the snapshots where all do, so that
 * no two are sampled differently where that can be.
 * @param {HTMLElement} place @param {Comparison} comparison
 */
export async function drawEnds(place, comparison) {
  const { window, sources } = comparison;
  const end = endOf(comparison);
  const at = (/** @type {import("../point/rotation.js").EndLine[]} */ lines) =>
    lines.filter((line) => line.end === end);
  const found = await each(comparison, async (point) => ({
    history: at(await endsOfHistory(contextOf(comparison, point), window)),
  }));
  const isInHistories = found.every(([, { history }]) => history.length);
  const snapshots = await Promise.all(
    found.map(async ([point]) =>
      isInHistories ? [] : at(await endsOfSnapshots(contextOf(comparison, point), window)),
    ),
  );
  const isInSnapshots = !isInHistories && snapshots.every((lines) => lines.length);
  const panels = found.flatMap(([point, { history }], order) => {
    const isOfHistory = history.length > 0 && !isInSnapshots;
    const lines = isOfHistory ? history : snapshots[order];
    if (!lines.length)
      comparison.lacking.push(
        `Point ${point.number} is missing: ${end === "bit" ? RECORD_ENDS : "Rotation speed and torque at the top are in snapshots, or in the history of the first node where it is recorded; this point has neither."}`,
      );
    else sources.set(point.number, isOfHistory ? "history" : "snapshots");
    return lines.map((line) => endPanel(point, line));
  });
  // Speeds of all points above their torques.
  const [speeds, torques] = [true, false].map((isSpeed) =>
    panels.filter(({ scale }) => (scale === "torque") !== isSpeed),
  );
  await laidOut(place, comparison.signal);
  const { traces, layout } = panelsOver(place, [...speeds, ...torques]);
  const names = [...new Set(sources.values())];
  if (names.length === 1)
    comparison.says.push(names[0] === "history" ? "From the recorded histories." : "From the snapshots.");
  if (names.length > 1)
    comparison.says.push(
      `${[...sources].map(([point, source], order) => `${order ? "point" : "Point"} ${point} is from its ${source}`).join(", ")}: sampled differently.`,
    );
  if (names.length) comparison.says.push(TORQUE);
  return draw(
    place,
    traces,
    { ...layout, shows: [window, end], dragmode: "select", selectdirection: "h" },
    comparison.signal,
  );
}

/**
 * Panel of one quantity at one end of a point's string.
 * @param {Compared} point
 * @param {import("../point/rotation.js").EndLine} line
 * @returns {import("./panels.js").Panel}
 */
function endPanel(point, { quantity, time, values }) {
  const trace = {
    type: "scatter",
    mode: "lines",
    x: time,
    y: shown(quantity, values),
    name: point.name,
    showlegend: quantity !== "torque",
    line: { color: point.colour, width: 1 },
    describe: (/** @type {{x: number, y: number}} */ { x, y }) => `${number(x, 6)} s: ${number(y)}`,
  };
  return { ...point, traces: [trace], scale: quantity, yaxis: { title: title(quantity), quantity } };
}
