// Views of a comparison, by their names in the link.

import { valueAtTime } from "../data/at-time.js";
import { spectrumRange } from "../data/motion-requests.js";
import { partsOf } from "../data/string-parts.js";
import { signRules } from "../data/signs.js";
import { label, number, say, shown, suitedUnit, title, unit } from "../data/units.js";
import {
  holeTrace,
  orbitLayout,
  orbitTrace,
  seenDownhole,
  spectrumLayout,
  spectrumTrace,
} from "../draw/orbit.js";
import { draw, laidOut } from "../draw/plots.js";
import { sayTrack } from "../draw/string-track.js";
import { timeDots } from "../draw/time-line.js";
import { ACCOUNTS, floorOf, HELD, ledger, scaled } from "../point/energy.js";
import { drawProfiles, nodeDepths, reading, tableOf } from "../point/profiles.js";
import { h } from "../ui/dom.js";
import { each, Lacking, noteNode } from "./comparison.js";
import { largestFirst, panelsInPlane, panelsOver } from "./panels.js";
import { drawContactMaps, drawEnds, drawSpectrograms, drawStrings } from "./side-by-side.js";
import { drawAccuracy, drawCost, drawEffects, drawModes, drawStatistics } from "./tables.js";
import { drawWells } from "./wells.js";

/** Samples of a line over time, and of an orbit in its panel, which is a part of the screen. */
const [SHOWN, OF_ORBIT] = [3000, 2000];
/** Room above compared spectra, as a part of their largest amplitude. */
const OF_NAMES = 0.2;
/** Clearances that differ by less are one [m]. */
const SAME_CLEARANCE = 1e-6;
/** Part of a depth below which the ends of two strings are one. */
const SAME_END = 1e-6;

/** @typedef {import("./comparison.js").Comparison} Comparison */
/** @typedef {import("./comparison.js").Compared} Compared */

/**
 * @typedef {object} CompareView
 * @property {string} name
 * @property {string} table behind it
 * @property {boolean} [isWindowed] whether it is of a window
 * @property {boolean} [isOfNode] whether it is of a recorded node
 * @property {boolean} [hasTime] whether it is drawn over time, so that a window can be dragged across it
 * @property {"table" | "several"} [kind] what it is where it is not one picture
 * @property {boolean} [isDocument] whether the service answers with a document in place of a table
 * @property {(place: HTMLElement, comparison: Comparison) => Promise<unknown>} draw
 */

/** @type {Record<string, CompareView>} */
export const VIEWS = {
  profiles: { name: "Profiles", table: "profile", draw: drawQuantities },
  orbit: { name: "Orbits", table: "orbit", isWindowed: true, isOfNode: true, draw: drawOrbits },
  history: {
    name: "Histories",
    table: "orbit",
    isWindowed: true,
    isOfNode: true,
    hasTime: true,
    draw: drawHistories,
  },
  rotation: {
    name: "Rotation and torque",
    table: "history",
    isWindowed: true,
    isOfNode: true,
    hasTime: true,
    draw: drawRotation,
  },
  spectrum: { name: "Full spectra", table: "spectrum", isWindowed: true, isOfNode: true, draw: drawSpectra },
  statistics: {
    name: "Statistics",
    table: "statistics",
    isWindowed: true,
    isOfNode: true,
    kind: "table",
    draw: drawStatistics,
  },
  spectrogram: {
    name: "Spectrograms",
    table: "spectrogram",
    isWindowed: true,
    isOfNode: true,
    kind: "several",
    draw: drawSpectrograms,
  },
  bit: {
    name: "Rotation at bit and top",
    table: "history",
    isWindowed: true,
    hasTime: true,
    draw: drawEnds,
  },
  string: { name: "Strings in motion", table: "snapshots", kind: "several", draw: drawStrings },
  contacts: { name: "Contacts over time", table: "snapshots", kind: "several", draw: drawContactMaps },
  well: { name: "Well", table: "statics", kind: "several", draw: drawWells },
  energy: { name: "Energy", table: "energy", draw: drawEnergy },
  modes: { name: "Modes", table: "modes", kind: "table", isDocument: true, draw: drawModes },
  effects: { name: "Effects", table: "plan", kind: "table", isDocument: true, draw: drawEffects },
  accuracy: { name: "Accuracy", table: "", kind: "table", isDocument: true, draw: drawAccuracy },
  cost: { name: "Cost", table: "", kind: "table", isDocument: true, draw: drawCost },
};

/** @param {Compared} point @param {number[]} time @param {(number | null)[]} values @param {string} [dash] */
function overTime(point, time, values, dash = point.dash) {
  return {
    type: "scatter",
    mode: "lines",
    name: point.name,
    showlegend: true,
    x: time,
    y: values,
    line: { color: point.colour, dash, width: 1 },
    describe: (/** @type {{x: number, y: number}} */ { x: at, y }) => `${number(at, 6)} s: ${number(y)}`,
  };
}

/** @param {HTMLElement} place @param {Comparison} comparison */
async function drawQuantities(place, comparison) {
  const { profiles } = comparison;
  /** @type {Map<number, Record<string, any>>} */
  const tables = new Map();
  for (const name of new Set(profiles.map(tableOf))) {
    const parts = profiles
      .filter((entry) => tableOf(entry) === name)
      .map(label)
      .join(", ");
    const found = await each(comparison, (point) => comparison.table(point, name), parts);
    for (const [point, table] of found)
      tables.set(point.number, { ...tables.get(point.number), [name]: table });
  }
  const drawable = comparison.points
    .filter((point) => tables.has(point.number))
    .map((point) => ({
      ...point,
      table: (/** @type {string} */ name) => tables.get(point.number)?.[tableOf(name)],
    }));
  const nodes = new Map(drawable.map((point) => [point.number, nodeDepths(profiles, point.table)]));
  const endOfString = (/** @type {number} */ point) => nodes.get(point)?.at(-1) ?? -Infinity;
  const deepest = drawable.reduce(
    (/** @type {number} */ best, one) => (endOfString(one.number) > endOfString(best) ? one.number : best),
    drawable[0]?.number,
  );
  comparison.profiled = {
    depths: nodes.get(deepest) ?? [],
    read: (depth, points) =>
      drawable.map((point) =>
        h(
          "p",
          {},
          `${point.name}: ${
            depth > endOfString(point.number) * (1 + SAME_END)
              ? "its string ends above"
              : reading(
                  profiles,
                  point.table,
                  depth,
                  points.filter(({ trace }) => trace.name === point.name),
                )
          }`,
        ),
      ),
  };
  const [parts, ...others] = drawable.map(({ detail }) => partsOf(detail.scenario.string));
  const isOne = others.every((other) => JSON.stringify(other) === JSON.stringify(parts));
  if (isOne) comparison.says.push(sayTrack(parts));
  comparison.says.push(signRules(profiles));
  const track = isOne ? { parts, nodes: [] } : null;
  return drawProfiles(place, profiles, drawable, track, comparison.signal);
}

/**
 * The orbit of each point's node with what the equilibrium says of that node.
 * @param {Comparison} comparison
 * @param {number} samples at most
 */
function orbits(comparison, samples) {
  return each(comparison, async (point) => {
    const [orbit, { columns }] = await Promise.all([
      comparison.table(point, "orbit", { ...comparison.node, ...comparison.window, max_points: samples }),
      comparison.table(point, "statics", { fields: "node,low_side_angle,clearance" }),
    ]);
    const row = Math.max(0, columns.node.indexOf(orbit.attributes.node));
    noteNode(comparison, point, orbit.attributes.node, orbit.attributes.measured_depth);
    return { orbit, lowSide: columns.low_side_angle[row], clearance: columns.clearance[row] };
  });
}

/** @param {HTMLElement} place @param {Comparison} comparison */
async function drawOrbits(place, comparison) {
  const found = await orbits(comparison, OF_ORBIT);
  if (!found.length) return draw(place, [], {}, comparison.signal);
  await laidOut(place, comparison.signal);
  const isZoomed = (comparison.query.get("zoom") ?? "motion") === "motion";
  const traces = found.map(([point, { orbit, lowSide }]) =>
    orbitTrace(orbit, lowSide, { color: point.colour }, point.name),
  );
  comparison.says.push(sayHoles(found));
  const clearance = Math.max(...found.map(([, one]) => one.clearance));
  const panels = found.map(([point, one], order) => ({
    ...point,
    traces: [holeTrace(one.clearance), traces[order]],
  }));
  const { traces: all, layout } = panelsInPlane(place, panels, orbitLayout(isZoomed, traces, clearance));
  const dotsAt = (/** @type {number} */ time) =>
    found.flatMap(([, { orbit }], order) => {
      const [x, y] = [traces[order].x, traces[order].y].map((values) =>
        valueAtTime(orbit.columns.time, values, time),
      );
      const axis = order ? order + 1 : "";
      return x === null || y === null ? [] : [{ x, y, xaxis: `x${axis}`, yaxis: `y${axis}` }];
    });
  timeDots(place, comparison.time, dotsAt, comparison.drawing);
  return draw(place, all, { ...layout, shows: [comparison.node, isZoomed] }, comparison.signal);
}

/** Sentence about the circles around the nodes that are shown. @param {[Compared, {clearance: number}][]} found */
function sayHoles(found) {
  const wall = "On the grey circle the node touches the wall";
  const [[, first]] = found;
  if (found.every(([, { clearance }]) => Math.abs(clearance - first.clearance) < SAME_CLEARANCE))
    return `${wall}, ${say("clearance", first.clearance)} from the axis.`;
  const walls = found.map(
    ([point, { clearance }]) => `point ${point.number} ${say("clearance", clearance)} from the axis`,
  );
  return `${wall}: ${walls.join("; ")}.`;
}

/** @param {HTMLElement} place @param {Comparison} comparison */
async function drawHistories(place, comparison) {
  const direction = comparison.query.get("direction") ?? "up";
  const found = await orbits(comparison, SHOWN);
  const traces = found.map(([point, { orbit, lowSide }]) => {
    const { time, u, v, radius } = orbit.columns;
    const seen = seenDownhole(u, v, lowSide);
    const values = direction === "radius" ? radius : direction === "across" ? seen.across : seen.up;
    return /** @type {[Compared, any]} */ ([point, overTime(point, time, shown("radius", values), "solid")]);
  });
  const yaxis = { title: `displacement [${unit("radius").symbol}]`, quantity: "radius" };
  return drawOverTime(place, comparison, traces, yaxis, direction);
}

/**
 * Draws a panel for each trace, across which a window is dragged; with another window a zoom is taken back.
 * @param {HTMLElement} place
 * @param {Comparison} comparison
 * @param {[Compared, any][]} found traces
 * @param {any} yaxis of each
 * @param {string} shows
 */
async function drawOverTime(place, { window, signal }, found, yaxis, shows) {
  await laidOut(place, signal);
  const panels = found.map(([point, trace]) => ({ ...point, traces: [trace], scale: "", yaxis }));
  const { traces, layout } = panelsOver(place, panels);
  return draw(
    place,
    traces,
    { ...layout, shows: [window, shows], dragmode: "select", selectdirection: "h" },
    signal,
  );
}

/** @param {HTMLElement} place @param {Comparison} comparison */
async function drawRotation(place, comparison) {
  const quantity = comparison.query.get("quantity") === "torque" ? "torque" : "rotation_speed";
  const found = await each(comparison, async (point) => {
    const { columns } = await comparison.table(point, "statistics", {
      ...comparison.node,
      fields: "node,measured_depth",
    });
    const [node] = columns.node;
    const name = `${quantity}_${node}`;
    const history = await comparison.table(point, "history", {
      node,
      ...comparison.window,
      fields: `time,${name}`,
      max_points: SHOWN,
      decimation: "minmax",
    });
    noteNode(comparison, point, node, columns.measured_depth[0]);
    return overTime(point, history.columns.time, shown(name, history.columns[name]), "solid");
  });
  return drawOverTime(place, comparison, found, { title: title(quantity), quantity }, quantity);
}

/** @param {HTMLElement} place @param {Comparison} comparison */
async function drawSpectra(place, comparison) {
  const range = comparedRange(comparison);
  const found = await each(comparison, async (point) => {
    const spectrum = await comparison.table(point, "spectrum", {
      ...comparison.node,
      ...comparison.window,
      window: "hann",
      range_hz: range,
    });
    noteNode(comparison, point, spectrum.attributes.node, spectrum.attributes.measured_depth);
    return spectrum;
  });
  const least = found.reduce(
    (/** @type {[Compared, any] | null} */ best, one) =>
      one[1].attributes.resolved_hz < (best?.[1].attributes.resolved_hz ?? range) ? one : best,
    null,
  );
  const isAlike = found.every(
    ([, table]) => table.attributes.resolved_hz === least?.[1].attributes.resolved_hz,
  );
  if (least)
    comparison.says.push(
      `Shaded: frequencies that the time steps${isAlike ? "" : ` of point ${least[0].number}`} do not resolve, above ${say("frequency", least[1].attributes.resolved_hz)}${isAlike ? "" : ", the lowest of all"}.`,
    );
  await laidOut(place, comparison.signal);
  const isLog = comparison.query.get("amplitude") === "log";
  const common = spectrumLayout(
    found.map(([, table]) => ({ table })),
    isLog,
  );
  const drawn = found.map(([point, spectrum]) =>
    spectrumTrace(spectrum, { color: point.colour }, point.name),
  );
  const largest = Math.max(...drawn.flatMap(({ y }) => y.map((value) => value ?? 0)));
  // The highest lines have room for their frequencies.
  const yaxis = { ...common.yaxis, ...(isLog ? {} : { range: [0, (1 + OF_NAMES) * largest] }) };
  const panels = found.map(([point], order) => ({ ...point, traces: [drawn[order]], scale: "", yaxis }));
  const { traces, layout } = panelsOver(place, panels, common.xaxis);
  const lines = found.flatMap(([, table], order) =>
    spectrumLayout([{ table }], isLog).annotations.map((note) => ({
      ...note,
      yref: order ? `y${order + 1}` : "y",
    })),
  );
  const annotations = [...layout.annotations, ...lines];
  return draw(
    place,
    traces,
    { ...layout, annotations, shapes: common.shapes, shows: range },
    comparison.signal,
  );
}

/** Highest frequency of compared spectra [Hz]. @param {{query: URLSearchParams, points: Compared[]}} comparison */
export function comparedRange({ query, points }) {
  return spectrumRange(query, comparedRate(points));
}

/** The rate of what was recorded most slowly [Hz]. @param {Compared[]} points */
export function comparedRate(points) {
  return Math.min(...points.map((point) => point.detail.scenario.recording.rate_hz));
}

/** The account whose energy is compared over time; empty where all are by what they changed. @param {URLSearchParams} query */
export function energyAccount(query) {
  return ACCOUNTS.find((name) => name === query.get("account")) ?? "";
}

/** @param {HTMLElement} place @param {Comparison} comparison */
async function drawEnergy(place, comparison) {
  const account = energyAccount(comparison.query);
  if (account) return drawAccount(place, comparison, account);
  const found = await each(comparison, async (point) =>
    ledger((await comparison.table(point, "energy")).columns),
  );
  const accounts = [...new Set(found.flatMap(([, one]) => one.accounts))];
  const { symbol, size } = unit("kinetic");
  const changes = found.map(([, one]) =>
    accounts.map((name) => (one.accounts.includes(name) ? one.change(name) / size : null)),
  );
  const sizes = changes.flat().map((change) => Math.abs(change ?? 0));
  const floor = 10 ** floorOf(sizes);
  const traces = found.map(([point], order) => ({
    type: "bar",
    orientation: "h",
    name: point.name,
    showlegend: true,
    x: changes[order].map((change) => change && Math.max(floor, Math.abs(change))),
    y: accounts.map(label),
    marker: { color: point.colour },
    text: changes[order].map((change, row) =>
      change === null ? "" : `${label(accounts[row])}: ${number(change)} ${symbol}`,
    ),
  }));
  const largestOf = (/** @type {number} */ row) => Math.max(...changes.map((one) => Math.abs(one[row] ?? 0)));
  const order = accounts.map((_, row) => row).sort((a, b) => largestOf(a) - largestOf(b));
  const lost = found.flatMap(([point], which) =>
    HELD.filter((name) => (changes[which][accounts.indexOf(name)] ?? 0) < 0).map(
      (name) => `${name} energy of point ${point.number}`,
    ),
  );
  comparison.says.push(
    `Sizes of the changes over the run${lost.length ? `; negative: ${lost.join(", ")}` : ""}.`,
  );
  return draw(
    place,
    traces,
    {
      shows: "",
      xaxis: {
        title: `energy [${symbol}], logarithmic`,
        type: "log",
        range: [floor, Math.max(floor, ...sizes) * 10 ** 0.1],
      },
      yaxis: { title: "", categoryarray: order.map((row) => label(accounts[row])) },
    },
    comparison.signal,
  );
}

/** @param {HTMLElement} place @param {Comparison} comparison @param {string} account of the ledger */
async function drawAccount(place, comparison, account) {
  const found = await each(comparison, async (point) => {
    const { columns } = await comparison.table(point, "energy");
    if (!columns[account]) throw new Lacking(`its ledger has no account of ${label(account)}`);
    return { point, time: columns.time, values: columns[account] };
  });
  const { symbol, size } = suitedUnit(
    account,
    found.flatMap(([, { values }]) => values),
  );
  return draw(
    place,
    largestFirst(found.map(([, { point, time, values }]) => overTime(point, time, scaled(values, size)))),
    {
      shows: account,
      xaxis: { title: "time [s]" },
      yaxis: { title: `${label(account)} [${symbol}]`, quantity: account, size },
    },
    comparison.signal,
  );
}
