// Energy by account: what was put in, where it went, and what the ledger misses.

import { label, number, say, unit } from "../data/units.js";
import { canvas, DASHES, draw, LINES } from "../draw/plots.js";
import { TimeLine } from "../draw/time-line.js";
import { fill, h } from "../ui/dom.js";

const SUPPLIED = [
  "work_unbalance",
  "work_rotation",
  "work_flow_and_torque",
  "work_bit",
  "work_excitation",
  "work_drive",
];
const DISSIPATED = [
  "dissipated_structure",
  "dissipated_fluid",
  "dissipated_friction",
  "dissipated_contact",
  "radiated_top",
];
/** Accounts of few strings, which are shown if they hold anything. */
const OF_FEW = ["work_bit", "work_excitation", "work_drive", "radiated_top"];
/** Accounts of energy that can be gained or lost. */
export const HELD = ["kinetic", "stored"];

/** Energies below this part of the largest are not drawn. */
const LEAST = 1e-9;
/** Width of a bar [pixels]. */
const BAR = 13;
/** All accounts, and what the ledger misses. */
export const ACCOUNTS = [...SUPPLIED, ...DISSIPATED, ...HELD, "residual"];

/**
 * The accounts that a ledger has, what is supplied first, and by what each has changed over the run.
 * @param {any} columns
 * @returns {{accounts: string[], change: (name: string) => number}}
 */
export function ledger(columns) {
  const last = columns.time.length - 1;
  return {
    accounts: [...SUPPLIED, ...DISSIPATED, ...HELD].filter(
      (name) => columns[name] && (!OF_FEW.includes(name) || columns[name].some(Boolean)),
    ),
    change: (name) => Number(columns[name][last]) - Number(columns[name][0]),
  };
}

/** Number of an account's group: supplied, dissipated or held. @param {string} name */
function groupOf(name) {
  if (SUPPLIED.includes(name)) return 0;
  return DISSIPATED.includes(name) ? 1 : 2;
}

/** Name of an account with its sign in words. @param {string} name @param {number} change */
function wordsOf(name, change) {
  if (groupOf(name) < 2) return label(name);
  return `${name === "kinetic" ? "kinetic" : "stored"} energy ${change < 0 ? "lost" : "gained"}`;
}

/**
 * Accounts by the size of their change, the largest first.
 * @param {any} columns
 * @returns {{name: string, group: number, change: number, words: string}[]}
 */
export function sortedAccounts(columns) {
  const { accounts, change } = ledger(columns);
  return accounts
    .map((name) => ({ name, group: groupOf(name), change: change(name), words: wordsOf(name, change(name)) }))
    .sort((a, b) => Math.abs(b.change) - Math.abs(a.change));
}

/**
 * Power of ten at which a logarithmic scale of energies begins.
 * @param {number[]} changes
 * @returns {number}
 */
export function floorOf(changes) {
  const sizes = changes.map(Math.abs).filter((size) => size > 0);
  const largest = sizes.reduce((a, b) => Math.max(a, b), 0) || 1;
  const least = sizes.filter((size) => size > LEAST * largest).reduce((a, b) => Math.min(a, b), largest);
  return Math.ceil(Math.log10(least)) - 1;
}

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function energy(context) {
  const bars = canvas("Energy by account at the end of the run", "bars", "low");
  const curves = canvas("Energy over time", "curves");
  const line = new TimeLine(curves, context.time, context.signal);
  const caption = h("figcaption", {});

  async function redraw() {
    const { columns } = await context.table("energy");
    const last = columns.time.length - 1;
    fill(
      caption,
      `The change of each account over ${say("time", columns.time[last])}. The ledger misses ${say("residual", columns.residual?.[last])}, ${say("energy_residual_ratio", context.point.summary.energy_residual_ratio, 2)} of the energy that it counts: the error of the integration.`,
    );
    await Promise.all([drawBars(bars, columns, context.signal), drawCurves(curves, columns, context.signal)]);
  }

  return {
    element: h(
      "div",
      {},
      h("h2", {}, "By account"),
      h("figure", {}, bars, caption),
      h("h2", {}, "Over time"),
      h("figure", {}, curves, line.reading),
    ),
    draw: redraw,
    request: () => ({ asked: [{ table: "energy" }], python: "energy = point.energy().to_pandas()" }),
  };
}

/** Draws the change of each account over the run as a bar on a logarithmic scale. @param {HTMLElement} place @param {any} columns @param {AbortSignal} signal */
function drawBars(place, columns, signal) {
  const accounts = sortedAccounts(columns);
  const { symbol, size } = unit("kinetic");
  const floor = 10 ** floorOf(accounts.map(({ change }) => change / size));
  const named = accounts.map((account) => ({
    ...account,
    category: `${account.words}, ${say(account.name, Math.abs(account.change), 3)}`,
    end: Math.max(floor, Math.abs(account.change) / size),
  }));
  const traces = ["supplied", "dissipated", "gained or lost"].map((name, group) => {
    const bars = named.filter((account) => account.group === group);
    return {
      type: "scatter",
      mode: "lines",
      name,
      // A gap ends each bar.
      x: bars.flatMap(({ end }) => [floor, end, null]),
      y: bars.flatMap(({ category }) => [category, category, category]),
      line: { color: LINES[group], width: BAR },
      showlegend: bars.length > 0,
      describe: (/** @type {{y: string}} */ { y }) => y,
    };
  });
  const largest = Math.max(...named.map(({ end }) => end));
  const xaxis = {
    title: `energy [${symbol}], logarithmic`,
    type: "log",
    range: [floor, largest * 10 ** 0.1],
  };
  const yaxis = {
    title: "",
    categoryarray: named.map(({ category }) => category).toReversed(),
  };
  return draw(
    place,
    traces,
    { showlegend: true, xaxis, yaxis, margin: { l: 20, r: 30, t: 30, b: 50 } },
    signal,
  );
}

/** Draws the sizes of the accounts over time. @param {HTMLElement} place @param {any} columns @param {AbortSignal} signal */
function drawCurves(place, columns, signal) {
  const accounts = sortedAccounts(columns);
  const { symbol, size } = unit("kinetic");
  const floor = size * 10 ** floorOf(accounts.map(({ change }) => change / size));
  const traces = accounts.map(({ name, group }, order) => {
    const dash = group === 2 ? "dot" : DASHES[Math.floor(order / LINES.length)];
    const words = group === 2 ? `${name} energy` : label(name);
    const sizes = columns[name].map((/** @type {number | null} */ value) =>
      value !== null && Math.abs(value) >= floor ? Math.abs(value) : null,
    );
    return {
      type: "scatter",
      mode: "lines",
      name: words,
      symbol,
      x: columns.time,
      y: scaled(sizes, size),
      line: { color: LINES[order % LINES.length], dash, width: 1.4 },
      showlegend: true,
      describe: (/** @type {{y: number}} */ { y }) => `${words}: ${number(y)} ${symbol}`,
    };
  });
  return draw(
    place,
    traces,
    {
      xaxis: { title: "time [s]" },
      yaxis: { title: `size of the energy since the start [${symbol}]`, type: "log" },
      hovermode: "x",
    },
    signal,
  );
}

/** Values by a size of their unit; gaps stay gaps. @param {(number | null)[]} values @param {number} size */
export function scaled(values, size) {
  return values.map((value) => (value === null ? null : value / size));
}
