// Snippets that read the data of a comparison.

import { profileTables, tableOf } from "../point/profiles.js";
import { python, pythonNode, requestLines } from "../ui/snippets.js";
import { VIEWS } from "./views.js";
import { wellColour } from "./wells.js";

/** @typedef {import("./comparison.js").Compared} Compared */
/** @typedef {import("./choices.js").Choices} Choices */

/**
 * @param {Choices} choices
 * @param {string[]} profiles that are shown
 * @param {Map<number, string>} sources tables that points are drawn from, by their numbers, if the view has a choice
 * @returns {import("../ui/snippets.js").Lines}
 */
export function comparisonLines(choices, profiles, sources) {
  const { points, view } = choices;
  const { isDocument } = VIEWS[view];
  const requests = (/** @type {Compared} */ point) => requestsOf(point, choices, profiles, sources);
  const asked = points.flatMap((point) =>
    requests(point).map(({ table, query }, _, { length }) => ({
      path: table ? `${point.path}/${table}` : point.path,
      query,
      name: `point${point.number}${view === "profiles" || length > 1 ? `_${table}` : ""}`,
      isDocument,
    })),
  );
  const start = `from drillsweep import Client, plot\n\nclient = Client("${location.origin}")\npoints = [${points.map((point) => `client.sweep("${point.id}").point(${point.ordinal})`).join(", ")}]\n`;
  return requestLines(asked, start + pythonLines(choices, profiles, requests));
}

/**
 * Requests behind the view for one point: tables with their queries.
 * @param {Compared} point
 * @param {Choices} choices
 * @param {string[]} profiles
 * @param {Map<number, string>} sources
 * @returns {{table: string, query: Record<string, any>}[]}
 */
function requestsOf(point, choices, profiles, sources) {
  if (choices.view === "profiles")
    return profileTables(profiles).map(({ table, fields }) => ({
      table,
      query: { fields: fields.join(",") },
    }));
  if (choices.view === "well") return wellTables(choices).map((table) => ({ table, query: {} }));
  const { isOfNode, node, isWindowed, window, hasRange } = choices;
  const table = sources.get(point.number) ?? VIEWS[choices.view].table;
  return [
    {
      table,
      query: {
        ...(isOfNode ? node : {}),
        ...(isWindowed ? window : {}),
        ...(hasRange ? { range_hz: choices.range } : {}),
      },
    },
  ];
}

/** Tables behind the wells: the equilibrium, and the table of the quantity that colours them. @param {Choices} choices */
function wellTables({ query }) {
  const colour = wellColour(query);
  return [...new Set(["statics", ...(colour ? [tableOf(colour)] : [])])];
}

/** @param {Choices} choices @param {string[]} profiles @param {(point: Compared) => {table: string}[]} requests */
function pythonLines(choices, profiles, requests) {
  const { view, points, isOfNode, isWindowed, hasRange, node, window } = choices;
  const { isDocument, table: shownTable } = VIEWS[view];
  const cut = isOfNode ? pythonNode(node, window) : isWindowed ? `time=(${window.from}, ${window.to})` : "";
  const given = hasRange ? `${cut}, range_hz=${choices.range}` : cut;
  if (view === "profiles")
    return profileTables(profiles)
      .map(
        ({ table, fields }) =>
          `${table} = [point.${table}().to_pandas()[${python(fields)}] for point in points]`,
      )
      .join("\n");
  if (view === "well")
    return wellTables(choices)
      .map((table) => `${table} = [point.${table}().to_pandas() for point in points]`)
      .join("\n");
  if (isDocument)
    return shownTable
      ? `documents = [point.${shownTable}() for point in points]`
      : `documents = [point.${view === "accuracy" ? "summary" : "provenance"} for point in points]`;
  if (view === "orbit" || view === "spectrum")
    return `for point in points:\n    plot.${view}(point, ${given})`;
  if (view === "bit")
    return points
      .map(
        (point) =>
          `point${point.number} = client.sweep("${point.id}").point(${point.ordinal}).${requests(point)[0].table}(${given}).to_pandas()`,
      )
      .join("\n");
  return `tables = [point.${shownTable}(${given}).to_pandas() for point in points]`;
}
