// Which of the swept parameters matters to a result.

import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { canvas, draw, LINES } from "../draw/plots.js";
import { LEAST_POINTS, shares } from "../data/sensitivity.js";
import { preferred, undelayed } from "./part.js";
import { label, title, unit } from "../data/units.js";

/**
 * @param {import("./part.js").Context} context
 * @returns {import("./part.js").Part}
 */
export function effects(context) {
  const { table, axes, query } = context;
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

  function chosen() {
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

  async function redraw() {
    const isNewest = begin();
    const { results, result } = chosen();
    fill(
      controls,
      choice(
        "Result",
        results.map((name) => [name, label(name)]),
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
    const order = found.map((_, index) => index).sort((a, b) => found[a].first - found[b].first);
    const names = order.map((index) => label(axes[index]));
    const firsts = order.map((index) => found[index].first);
    const hasTotals = found.every((share) => share.total !== null);
    const intervals = order.map((index) => found[index].interval);
    const shownEnds = hasTotals ? [] : intervals.flatMap((interval) => interval ?? []);
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
        ...(hasTotals
          ? {}
          : {
              error_x: {
                type: "data",
                symmetric: false,
                array: intervals.map((one, at) => (one ? Math.max(0, one[1] - firsts[at]) : 0)),
                arrayminus: intervals.map((one, at) => (one ? Math.max(0, firsts[at] - one[0]) : 0)),
                color: LINES[1],
                thickness: 2,
              },
            }),
      },
    ].filter(Boolean);
    fill(
      caption,
      `Of the variance of ${label(result)} over ${rows.length} points. `,
      hasTotals
        ? "The points are a full grid: the shares are its exact decomposition, over the values that it has."
        : "The points are no full grid: first-order indices are estimated from the points as they are, by ratios of correlation within groups along each parameter, less what groups of unrelated points would show. Lines are 95 % intervals (jackknife).",
      ` ${context.biases.say(result)}`,
    );
    bars.setAttribute(
      "aria-label",
      `Shares of the variance of ${label(result)}: ${order
        .toReversed()
        .map((index) => `${label(axes[index])} ${Math.round(100 * found[index].first)} %`)
        .join(", ")}`,
    );
    const layout = {
      grid: { rows: 1, columns: axes.length, pattern: "independent" },
      showlegend: false,
      ...Object.fromEntries(
        axes.flatMap((axis, index) => [
          [
            `xaxis${index || ""}`.replace(/^xaxis(\d+)$/, (_, at) => `xaxis${Number(at) + 1}`),
            {
              title: title(axis),
              quantity: axis,
              type: context.spans[axis]?.scale === "log" ? "log" : "linear",
            },
          ],
          [
            `yaxis${index ? index + 1 : ""}`,
            { title: index ? "" : title(result), quantity: result, matches: index ? "y" : undefined },
          ],
        ]),
      ),
    };
    await Promise.all([
      draw(
        bars,
        traces,
        {
          xaxis: {
            title: "share of the variance (Sobol index)",
            range: [Math.min(0, ...firsts, ...shownEnds) - 0.01, Math.max(1, ...shownEnds) + 0.02],
          },
          yaxis: { title: "", gridcolor: "rgba(0,0,0,0)", automargin: true },
          barmode: "group",
          margin: { l: 20, r: 16, t: 30, b: 50 },
        },
        context.signal,
      ),
      draw(
        curves,
        axes.map((axis, index) => ({
          type: "scatter",
          mode: "lines+markers",
          x: found[index].levels.map((level) => level.value / unit(axis).size),
          y: found[index].levels.map((level) => level.mean),
          error_y: { type: "data", array: found[index].levels.map((level) => level.error), thickness: 1.2 },
          line: { color: LINES[index % LINES.length] },
          xaxis: `x${index ? index + 1 : ""}`,
          yaxis: `y${index ? index + 1 : ""}`,
          name: label(axis),
          hoverinfo: "x+y",
        })),
        layout,
        context.signal,
      ),
    ]);
  }

  const element = axes.length
    ? h("div", {}, controls, empty, pictures)
    : h("p", { class: "empty" }, "This sweep varies nothing.");
  return {
    element,
    draw: axes.length ? undelayed(redraw, context) : async () => {},
    fields: () => (axes.length ? ["ordinal", ...axes, chosen().result] : []),
  };
}
