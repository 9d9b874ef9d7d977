// Tables that compare points in numbers and words: a row for each fact, a column for each point.

import { get } from "../data/api.js";
import { Biases } from "../data/biases.js";
import { pairedModes } from "../data/mode-pairs.js";
import { biasOver, recordedAs, STATISTICS } from "../data/statistics.js";
import { number, say } from "../data/units.js";
import { accuracyFacts, accuracyReasons, costFacts } from "../point/about.js";
import { fill, h } from "../ui/dom.js";
import { each, noteNode } from "./comparison.js";

/** @typedef {import("./comparison.js").Comparison} Comparison */
/** @typedef {import("./comparison.js").Compared} Compared */

/** Modes are looked for up to this frequency [Hz]. */
const MODES_HZ = 20;

/**
 * @param {HTMLElement} place
 * @param {string} name of the table
 * @param {Compared[]} points
 * @param {[string, (string | HTMLElement | null)[]][]} rows what each is of, and its cells
 */
function drawTable(place, name, points, rows) {
  const heads = points.map((point) =>
    h(
      "th",
      { scope: "col" },
      h("span", { style: `color:${point.colour}`, "aria-hidden": "true" }, "━ "),
      point.name,
    ),
  );
  const body = rows.map(([text, cells]) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, text),
      cells.map((cell) => h("td", {}, cell ?? "–")),
    ),
  );
  fill(
    place,
    points.length > 0 &&
      h(
        "table",
        { "aria-label": name },
        h("thead", {}, h("tr", {}, h("td", {}), heads)),
        h("tbody", {}, body),
      ),
  );
}

/**
 * Rows of facts that have a name each, in the order in which points bring them.
 * @template T
 * @param {[Compared, [string, T][]][]} found
 * @returns {[string, (T | null)[]][]}
 */
function rowsOf(found) {
  const names = [...new Set(found.flatMap(([, facts]) => facts.map(([name]) => name)))];
  const maps = found.map(([, facts]) => new Map(facts));
  return names.map((name) => [name, maps.map((facts) => facts.get(name) ?? null)]);
}

/** Statistics of the orbit over the window, with the bias of those that verifying looks at. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawStatistics(place, comparison) {
  const { drawing, window } = comparison;
  /** @type {Map<string, Promise<Biases>>} */
  const biases = new Map();
  const biasesOf = (/** @type {string} */ id) => {
    const known = biases.get(id) ?? loadBiases(id, drawing);
    biases.set(id, known);
    return known;
  };
  const found = await each(comparison, async (point) => {
    const [{ columns, attributes }, bias] = await Promise.all([
      comparison.table(point, "statistics", { ...comparison.node, ...window }),
      biasesOf(point.id),
    ]);
    const [node] = columns.node;
    noteNode(comparison, point, node, columns.measured_depth[0]);
    const as = recordedAs(point.detail.scenario, node, columns.measured_depth[0]);
    const beside = biasOver(point.detail, window, (name) => bias.beside(`${name}_${as}`, point.ordinal));
    /** @type {[string, string][]} */
    const facts = STATISTICS.map(([name, text]) => [text, say(name, columns[name][0]) + beside(name)]);
    return /** @type {[string, string][]} */ ([...facts, ["Samples", String(attributes.samples)]]);
  });
  drawTable(
    place,
    "Statistics",
    found.map(([point]) => point),
    rowsOf(found),
  );
}

/**
 * @param {string} id of a sweep
 * @param {AbortSignal} signal
 */
async function loadBiases(id, signal) {
  const biases = new Biases();
  await biases.load(await get(`/v1/sweeps/${encodeURIComponent(id)}`, {}, signal), signal);
  return biases;
}

/** Draws the effects that take part, with reasons. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawEffects(place, comparison) {
  const found = await each(comparison, async (point) => {
    const plan = await get(`${point.path}/plan`, {}, comparison.drawing);
    return plan.effects.map((/** @type {any} */ effect) => [
      effect.effect.replaceAll("_", " "),
      h(
        "span",
        {},
        h(
          "span",
          { class: `state ${effect.active ? "succeeded" : "cancelled"}` },
          effect.active ? "on" : "off",
        ),
        h("span", { class: "small soft" }, ` ${effect.reason}`),
      ),
    ]);
  });
  drawTable(
    place,
    "Effects",
    found.map(([point]) => point),
    rowsOf(found),
  );
}

/** Modes about the equilibrium, from the lowest, those that are alike in a row. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawModes(place, comparison) {
  const found = await each(comparison, async (point) => {
    const { modes } = await get(`${point.path}/modes`, { to_hz: MODES_HZ }, comparison.drawing);
    return /** @type {import("../data/mode-pairs.js").Mode[]} */ (modes);
  });
  const rows = pairedModes(found.map(([, modes]) => modes));
  drawTable(
    place,
    "Modes",
    found.map(([point]) => point),
    rows.map((row, index) => {
      const first = row.find((mode) => mode !== null);
      return [String(index + 1), row.map((mode) => mode && sayMode(mode, mode === first ? null : first))];
    }),
  );
  if (found.length > 1) comparison.says.push(PAIRING);
}

/** Pairing of modes, in words. */
const PAIRING =
  "Modes in a row are alike in their kind of motion, in the depths with nine tenths of their energy and of their largest motion, and in frequency after the shift that all modes of their kind have in common; none is in two rows. In brackets, the shift of the frequency from the first point that has the mode.";

/** @param {import("../data/mode-pairs.js").Mode} mode @param {import("../data/mode-pairs.js").Mode | null | undefined} first of its row, if another */
function sayMode({ frequency_hz, kind, growth_rate, measured_depth }, first) {
  const shift = first?.frequency_hz ? frequency_hz / first.frequency_hz - 1 : null;
  return [
    `${say("frequency", frequency_hz)}${shift === null ? "" : ` (${sayShift(shift)})`}`,
    kind,
    growth_rate > 0 ? "growing" : "decaying",
    `most at ${say("measured_depth", measured_depth)}`,
  ].join(", ");
}

/** @param {number} shift relative */
function sayShift(shift) {
  if (Math.abs(shift) < 5e-5) return "no shift";
  return `${shift > 0 ? "+" : "−"}${number(100 * Math.abs(shift), 2)} %`;
}

/** Draws the errors of the numbers. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawAccuracy(place, comparison) {
  const found = await each(
    comparison,
    async ({ detail }) =>
      /** @type {[string, string][]} */ ([
        ...accuracyFacts(detail),
        ...accuracyReasons(detail).map(([of, text]) => [`${of}: condition or reason`, text]),
      ]),
  );
  drawTable(
    place,
    "Accuracy",
    found.map(([point]) => point),
    rowsOf(found),
  );
}

/** Draws the cost of the runs. @param {HTMLElement} place @param {Comparison} comparison */
export async function drawCost(place, comparison) {
  const found = await each(comparison, async (point) => costFacts(point.detail));
  drawTable(
    place,
    "Cost",
    found.map(([point]) => point),
    rowsOf(found),
  );
}
