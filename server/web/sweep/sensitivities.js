// Sensitivities of a result to the swept parameters.

import { LEAST_POINTS, shares } from "../data/sensitivity.js";
import { label, title, unit } from "../data/units.js";
import { canvas, draw, laidOut, LINES } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { preferred, undelayed } from "./part.js";

/** @typedef {import("./part.js").Context} Context */
/** @typedef {import("../data/sensitivity.js").Share} Share */

/**
 * @param {Context} context
 * @returns {import("./part.js").Part}
 */
export function effects(context) {
  const { table, axes } = context;
  const bars = canvas("Shares of the variance", "shares", "low");
  const curves = canvas("Main effects", "effects");
  const caption = h("figcaption", {});
  const controls = h("div", { class: "controls" });
  const empty = h("p", { class: "empty", hidden: true });
  const begin = generations();
  const pictures = h(
    "div",
    {},
    h("h2", {}, "How much of the variation each parameter explains"),
    h("figure", {}, bars, caption),
    h("h2", {}, "Mean over all other parameters"),
    h("figure", {}, curves, h("figcaption", {}, "Bars are standard errors of the means.")),
  );

  async function redraw() {
    const isNewest = begin();
    const { results, result } = chosenIn(context);
    fill(
      controls,
      choice(
        "Result",
        results.map((name) => [name, context.depths.label(name)]),
        result,
        (value) => {
          context.keep({ result: value });
          attend(redraw(), context.signal);
        },
      ),
    );
    const [values, ...columns] = await table.columns(result, ...axes);
    if (!isNewest()) return;
    const rows = values
      .map((_, index) => index)
      .filter(
        (index) =>
          typeof values[index] === "number" && columns.every((column) => typeof column[index] === "number"),
      );
    empty.hidden = rows.length >= LEAST_POINTS;
    pictures.hidden = rows.length < LEAST_POINTS;
    if (rows.length < LEAST_POINTS) {
      empty.textContent = `${rows.length} points have this result; an estimate needs ${LEAST_POINTS}.`;
      return;
    }
    const { size } = unit(result);
    const found = shares(
      columns.map((column) => rows.map((row) => Number(column[row]))),
      rows.map((row) => Number(values[row]) / size),
    );
    fill(
      caption,
      `Of the variance of ${context.depths.label(result)} over ${rows.length} points. `,
      sayMethod(found),
      ` ${context.biases.say(result)}`,
    );
    bars.setAttribute("aria-label", `Shares of the variance of ${label(result)}: ${sayShares(axes, found)}`);
    await Promise.all([
      drawShares(bars, axes, found, context.signal),
      drawCurves(curves, context, result, found),
    ]);
  }

  const element = axes.length
    ? h("div", {}, controls, empty, pictures)
    : h("p", { class: "empty" }, "This sweep varies nothing.");
  return {
    element,
    draw: axes.length ? undelayed(redraw, context) : async () => {},
    fields: () => (axes.length ? ["ordinal", ...axes, chosenIn(context).result] : []),
  };
}

/** Results that can be chosen, and the chosen one. @param {Context} context */
function chosenIn({ table, axes, query }) {
  const results = table
    .results()
    .filter(
      (name) =>
        !axes.includes(name) &&
        !["state", "error_time", "error_node", "stable", "instability"].includes(name),
    );
  return {
    results,
    result: results.includes(query.get("result") ?? "") ? (query.get("result") ?? "") : preferred(results),
  };
}

/** Whether all shares have a total index. @param {Share[]} found */
function haveTotals(found) {
  return found.every((share) => share.total !== null);
}

/** Places of the shares, from the smallest first-order index up. @param {Share[]} found */
function inOrder(found) {
  return found.map((_, index) => index).sort((a, b) => found[a].first - found[b].first);
}

/** @param {string[]} axes @param {Share[]} found */
function sayShares(axes, found) {
  return inOrder(found)
    .toReversed()
    .map((index) => `${label(axes[index])} ${Math.round(100 * found[index].first)} %`)
    .join(", ");
}

/** @param {Share[]} found */
function sayMethod(found) {
  if (haveTotals(found))
    return "The points are a full grid: the shares are its exact decomposition, over the values that it has.";
  return "The points are no full grid: first-order indices are estimated from the points as they are, by ratios of correlation within groups along each parameter, less what groups of unrelated points would show. Lines are 95 % intervals (jackknife).";
}

/**
 * Draws the shares of the variance as bars, with intervals where they are estimates.
 * @param {HTMLElement} place
 * @param {string[]} axes
 * @param {Share[]} found
 * @param {AbortSignal} signal
 */
function drawShares(place, axes, found, signal) {
  const order = inOrder(found);
  const names = order.map((index) => label(axes[index]));
  const firsts = order.map((index) => found[index].first);
  const hasTotals = haveTotals(found);
  const intervals = order.map((index) => found[index].interval);
  const shownEnds = hasTotals ? [] : intervals.flatMap((interval) => interval ?? []);
  const beyond = (/** @type {(interval: [number, number], first: number) => number} */ reach) =>
    intervals.map((one, at) => (one ? Math.max(0, reach(one, firsts[at])) : 0));
  const error_x = {
    type: "data",
    symmetric: false,
    array: beyond((one, first) => one[1] - first),
    arrayminus: beyond((one, first) => first - one[0]),
    color: LINES[1],
    thickness: 2,
  };
  const traces = [
    hasTotals && {
      type: "bar",
      orientation: "h",
      name: "total index (with interactions)",
      y: names,
      x: order.map((index) => found[index].total),
      marker: { color: LINES[5] },
    },
    {
      type: "bar",
      orientation: "h",
      name: "first-order index (alone)",
      y: names,
      x: firsts,
      marker: { color: LINES[0] },
      ...(hasTotals ? {} : { error_x }),
    },
  ].filter(Boolean);
  const xaxis = {
    title: "share of the variance (Sobol index)",
    range: [Math.min(0, ...firsts, ...shownEnds) - 0.01, Math.max(1, ...shownEnds) + 0.02],
  };
  const yaxis = { title: "", showgrid: false };
  return draw(place, traces, { xaxis, yaxis, margin: { l: 20, r: 16, t: 30, b: 50 } }, signal);
}

/** Room for the numbers of a panel's axis, and the largest part of its width that they take [pixels]. */
const [NUMBERS, MOST] = [48, 0.4];

/**
 * Draws the mean result over each parameter, side by side on one scale.
 * @param {HTMLElement} place
 * @param {Context} context
 * @param {string} result
 * @param {Share[]} found
 */
async function drawCurves(place, { axes, spans, depths, signal }, result, found) {
  const numbered = (/** @type {string} */ name, /** @type {number} */ index) =>
    `${name}${index ? index + 1 : ""}`;
  await laidOut(place, signal);
  // Before each panel but the first, whose numbers stand in the margin.
  const free = Math.min(MOST, (NUMBERS * axes.length) / place.clientWidth);
  const layouts = axes.flatMap((axis, index) => [
    [
      numbered("xaxis", index),
      {
        title: title(axis),
        quantity: axis,
        type: spans[axis]?.scale === "log" ? "log" : "linear",
        domain: [(index + (index ? free : 0)) / axes.length, (index + 1) / axes.length],
        anchor: numbered("y", index),
      },
    ],
    [
      numbered("yaxis", index),
      {
        title: index ? "" : depths.title(result),
        quantity: result,
        matches: index ? "y" : undefined,
        anchor: numbered("x", index),
      },
    ],
  ]);
  const traces = axes.map((axis, index) => {
    const { levels } = found[index];
    return {
      type: "scatter",
      mode: "lines+markers",
      x: levels.map((level) => level.value / unit(axis).size),
      y: levels.map((level) => level.mean),
      error_y: { type: "data", array: levels.map((level) => level.error), thickness: 1.2 },
      line: { color: LINES[index % LINES.length] },
      xaxis: numbered("x", index),
      yaxis: numbered("y", index),
      name: label(axis),
    };
  });
  const layout = {
    showlegend: false,
    ...Object.fromEntries(layouts),
  };
  return draw(place, traces, layout, signal);
}
