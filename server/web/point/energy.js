// Energy by account: what was put in, where it went, and what the ledger misses.

import { label, say, suitedUnit } from "../data/units.js";
import { canvas, DASHES, draw, LINES } from "../draw/plots.js";
import { fill, h } from "../ui/dom.js";

const SUPPLIED = ["work_unbalance", "work_rotation", "work_flow_and_torque"];
const DISSIPATED = ["dissipated_structure", "dissipated_fluid", "dissipated_friction", "dissipated_contact"];
const HELD = ["kinetic", "stored"];

/** Widths of a number beside a bar and of the accounts' names, about [pixels]; of a place that has no size yet, the usual one. */
const [BESIDE, NAMES, USUAL] = [64, 190, 1000];
/** Part of the bars' width that is given to numbers at an end, at most. */
const MOST_BESIDE = 0.3;
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
    accounts: [...SUPPLIED, ...DISSIPATED, ...HELD].filter((name) => columns[name]),
    change: (name) => Number(columns[name][last]) - Number(columns[name][0]),
  };
}

/** Number of an account's group: supplied, dissipated or held. @param {string} name */
function groupOf(name) {
  if (SUPPLIED.includes(name)) return 0;
  return DISSIPATED.includes(name) ? 1 : 2;
}

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function energy(context) {
  const bars = canvas("Energy by account at the end of the run", "bars", "low");
  const curves = canvas("Energy over time", "curves");
  const caption = h("figcaption", {});

  async function redraw() {
    const { columns } = await context.table("energy");
    const last = columns.time.length - 1;
    fill(
      caption,
      `Over ${say("time", columns.time[last])}. The ledger misses ${say("residual", columns.residual?.[last])}, ${say("energy_residual_ratio", context.point.summary.energy_residual_ratio, 2)} of the energy that it counts: the error of the integration.`,
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
      h("figure", {}, curves),
    ),
    draw: redraw,
    request: () => ({ asked: [{ table: "energy" }], python: "energy = point.energy().to_pandas()" }),
  };
}

/** Draws the change of each account over the run. @param {HTMLElement} place @param {any} columns @param {AbortSignal} signal */
function drawBars(place, columns, signal) {
  const { accounts, change } = ledger(columns);
  const backwards = accounts.toReversed();
  const { symbol, size } = suitedUnit("kinetic", accounts.map(change));
  const traces = ["supplied", "dissipated", "gained"].map((name, group) => {
    const names = backwards.filter((account) => groupOf(account) === group);
    return {
      type: "bar",
      orientation: "h",
      name,
      y: names.map(label),
      x: names.map((account) => change(account) / size),
      marker: { color: LINES[group] },
      showlegend: true,
      text: names.map((account) => say(account, change(account), 3)),
      textposition: "outside",
      cliponaxis: false,
      hovertemplate: `%{y}: %{x:.4~g} ${symbol}<extra></extra>`,
    };
  });
  const values = accounts.map((account) => change(account) / size);
  const [least, largest] = [Math.min(0, ...values), Math.max(0, ...values)];
  // Numbers stand beyond the ends of bars.
  const part = Math.min(MOST_BESIDE, BESIDE / Math.max(1, (place.clientWidth || USUAL) - NAMES));
  const room = (part / (1 - 2 * part)) * (largest - least || 1);
  const xaxis = {
    title: `energy [${symbol}]`,
    quantity: backwards[0],
    size,
    range: [least < 0 ? least - room : 0, largest + room],
  };
  const yaxis = { title: "", automargin: true, categoryorder: "array", categoryarray: backwards.map(label) };
  return draw(place, traces, { xaxis, yaxis, margin: { l: 20, r: 80, t: 30, b: 50 } }, signal);
}

/** Draws the accounts over time. @param {HTMLElement} place @param {any} columns @param {AbortSignal} signal */
function drawCurves(place, columns, signal) {
  const { accounts } = ledger(columns);
  const { symbol, size } = suitedUnit(
    "kinetic",
    accounts.flatMap((name) => columns[name]),
  );
  const traces = accounts.map((name, order) => {
    const dash = DASHES[Math.floor(order / LINES.length) + (groupOf(name) === 2 ? 1 : 0)];
    return {
      type: "scatter",
      mode: "lines",
      name: label(name),
      x: columns.time,
      y: scaled(columns[name], size),
      line: { color: LINES[order % LINES.length], dash, width: 1.4 },
      showlegend: true,
      hovertemplate: `${label(name)}: %{y:.4~g} ${symbol}<extra></extra>`,
    };
  });
  return draw(
    place,
    traces,
    {
      xaxis: { title: "time [s]" },
      yaxis: { title: `energy since the start [${symbol}]`, quantity: accounts.at(-1), size },
      hovermode: "x",
    },
    signal,
  );
}

/** Values by a size of their unit; gaps stay gaps. @param {(number | null)[]} values @param {number} size */
export function scaled(values, size) {
  return values.map((value) => (value === null ? null : value / size));
}
