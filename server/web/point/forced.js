// Forced response of the string over rotation speed, by component: its peaks are critical speeds.

import { Problem } from "../data/api.js";
import { label, number, say, shown, title } from "../data/units.js";
import { canvas, DASHES, draw, LINES } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";

/** Quantities that are shown, the usual first. */
const QUANTITIES = [
  "forced_displacement",
  "forced_acceleration",
  "forced_side_force",
  "forced_bending_stress",
];
/** Speeds between which the response is shown at first [rpm], and their number. */
const USUAL = [40, 240],
  COUNT = 201;

/** Response of a component; gaps are speeds without a number. @typedef {{component: string, speeds: number[], values: (number | null)[]}} ComponentLine */

/**
 * Lines of the components of a table, whose rows are in the order of components and, within one, of speeds.
 * @param {Record<string, any[]>} columns
 * @param {string} quantity
 * @returns {ComponentLine[]}
 */
export function linesOf(columns, quantity) {
  /** @type {ComponentLine[]} */
  const lines = [];
  columns.component.forEach((/** @type {string} */ component, row) => {
    const speed = columns.rotation_speed_rpm[row];
    const last = lines.at(-1);
    const value = columns[quantity][row];
    // Two components of one name follow each other: the speeds begin again.
    if (last?.component === component && (last.speeds.at(-1) ?? Infinity) < speed) {
      last.speeds.push(speed);
      last.values.push(value);
    } else lines.push({ component, speeds: [speed], values: [value] });
  });
  return lines;
}

/**
 * Row of the largest value of a column.
 * @param {(number | null)[]} values
 */
export function largestRow(values) {
  return values.reduce(
    (/** @type {number} */ most, value, row) => ((value ?? 0) > (values[most] ?? 0) ? row : most),
    0,
  );
}

/** Speeds of the link as `60:180`, or the usual ones. @param {string | null} text @returns {number[]} */
export function speedsOf(text) {
  const ends = (text ?? "").split(":").map(Number);
  const isValid = ends.length === 2 && ends[0] > 0 && ends[0] < ends[1] && ends.every(Number.isFinite);
  return isValid ? ends : USUAL;
}

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function forced(context) {
  const place = canvas("Forced response over rotation speed", "forced", "tall");
  const caption = h("figcaption", { "aria-live": "polite" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const begin = generations();
  const { query } = context;
  const quantity = () => QUANTITIES.find((name) => name === query.get("response")) ?? QUANTITIES[0];
  const asks = () => ({ speeds: `${speedsOf(query.get("rpm")).join(":")}:${COUNT}` });
  const keep = (/** @type {Record<string, string>} */ changes) => {
    context.keep(changes);
    attend(redraw(), context.signal);
  };
  const boxes = speedsOf(query.get("rpm")).map((speed, at) =>
    h("input", {
      type: "number",
      step: "any",
      min: 1,
      value: speed,
      "aria-label": `${at ? "Highest" : "Lowest"} speed`,
      onchange: () => {
        const rpm = boxes.map((box) => box.value).join(":");
        const isValid = speedsOf(rpm).join(":") === rpm.split(":").map(Number).join(":");
        wrong.textContent = isValid ? "" : "Speeds must be above 0, the lowest first.";
        if (isValid) keep({ rpm });
      },
    }),
  );
  const controls = h(
    "div",
    { class: "controls" },
    choice(
      "Response",
      QUANTITIES.map((name) => [name, label(name)]),
      quantity(),
      (response) => keep({ response }),
    ),
    h("span", { class: "field" }, h("span", {}, "Rotation speed [rpm]"), boxes[0], " to ", boxes[1]),
  );

  async function redraw() {
    const isNewest = begin();
    let columns;
    try {
      ({ columns } = await context.table("forced_response", asks()));
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      wrong.textContent = error.errors[0]?.detail ?? error.message;
      return;
    }
    if (!isNewest()) return;
    wrong.textContent = "";
    const name = quantity();
    const row = largestRow(columns[name]);
    const depth = columns[`${name}_depth`]?.[row] ?? columns.forced_displacement_depth[row];
    const own = context.point.scenario.operation.rotation_speed_rpm;
    fill(
      caption,
      `Largest at ${say("rotation_speed_rpm", columns.rotation_speed_rpm[row])}: ${say(name, columns[name][row], 3)}, ${columns.component[row]}, ${say("measured_depth", depth)}. The point turns at ${say("rotation_speed_rpm", own)}. Linear vibration about the equilibrium by the unbalance of the scenario, whose closed contacts stay closed: peaks are critical speeds.`,
    );
    await drawLines(place, linesOf(columns, name), name, context.signal);
  }

  return {
    element: h("div", {}, h("h2", {}, "Forced response"), controls, wrong, h("figure", {}, place, caption)),
    draw: redraw,
    request: () => {
      const [from, to] = speedsOf(query.get("rpm"));
      const step = (to - from) / (COUNT - 1);
      return {
        asked: [{ table: "forced_response", query: asks() }],
        python: `response = point.forced_response(speeds=[${from} + ${step} * i for i in range(${COUNT})]).to_pandas()`,
      };
    },
  };
}

/** @param {HTMLElement} place @param {ComponentLine[]} lines @param {string} name of the quantity @param {AbortSignal} signal */
function drawLines(place, lines, name, signal) {
  const traces = lines.map(({ component, speeds, values }, order) => ({
    type: "scatter",
    mode: "lines",
    name: component,
    x: speeds,
    y: shown(name, values),
    line: {
      color: LINES[order % LINES.length],
      dash: DASHES[Math.floor(order / LINES.length) % DASHES.length],
      width: 1.3,
    },
    showlegend: true,
    describe: (/** @type {{x: number, y: number}} */ { x, y }) =>
      `${component}, ${number(x)} rpm: ${number(y)}`,
  }));
  const layout = {
    showlegend: true,
    xaxis: { title: title("rotation_speed_rpm"), quantity: "rotation_speed_rpm" },
    yaxis: { title: title(name), quantity: name },
  };
  return draw(place, traces, layout, signal);
}
