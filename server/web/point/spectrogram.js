// The full spectrum of a recorded node over time, forward and backward.

import { Problem } from "../data/api.js";
import { nodeInLink, selectedNode } from "../data/motion-requests.js";
import { getArrays } from "../data/npz.js";
import { number, say, shown, title, unit } from "../data/units.js";
import { logTicks } from "../draw/picture/ticks.js";
import { canvas, colourBar, draw, inks } from "../draw/plots.js";
import { TimeLine } from "../draw/time-line.js";
import { choice, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { pythonNode } from "../ui/snippets.js";
import { sayPlace, sayUnrecorded } from "./part.js";

/** Frequencies up to which spectrograms are shown [Hz]. */
export const RANGES = ["5", "10", "20", "50", "100"];
const LENGTHS = ["1", "2", "4", "8", "16"];
/** Below this part of the highest amplitude a logarithmic scale ends. */
const DEPTH = 1e-3;

/** Choices of a spectrogram, as the link holds them. */
class Choices {
  #query;
  #scenario;

  /** @param {URLSearchParams} query @param {any} scenario */
  constructor(query, scenario) {
    this.#query = query;
    this.#scenario = scenario;
  }

  get node() {
    return this.#query.get("node") ?? nodeInLink(this.#scenario.recording.nodes[0]);
  }

  /** Highest frequency [Hz]. */
  get range() {
    return this.#offered("range", RANGES, "20");
  }

  /** Length of a window [s]; empty for the service's own. */
  get length() {
    return this.#offered("length", ["", ...LENGTHS], "");
  }

  get isLog() {
    return this.#query.get("amplitude") !== "linear";
  }

  /** Query of the table. */
  asks() {
    return {
      ...selectedNode(this.#scenario, this.#query),
      range_hz: Number(this.range),
      ...(this.length ? { window_s: Number(this.length) } : {}),
    };
  }

  /** @param {string} name @param {string[]} offered @param {string} usual */
  #offered(name, offered, usual) {
    const asked = this.#query.get(name);
    return asked !== null && offered.includes(asked) ? asked : usual;
  }
}

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function spectrogram(context) {
  /** @type {any[]} */
  const nodes = context.point.scenario.recording.nodes;
  const choices = new Choices(context.query, context.point.scenario);
  const place = canvas("Spectrogram of the node", "spectrogram", "tall");
  new TimeLine(place, context.time, context.signal);
  const caption = h("figcaption", {});
  const controls = h("div", { class: "controls" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  let generation = 0;

  const set = (/** @type {string} */ name) => (/** @type {string} */ value) => {
    context.keep({ [name]: value || null });
    attend(redraw(), context.signal);
  };

  async function redraw() {
    fill(controls, controlsPart(nodes, choices, set));
    const mine = ++generation;
    wrong.textContent = sayUnrecorded(context.point.scenario, context.query);
    if (wrong.textContent) return;
    let table;
    try {
      table = await spectrogramOf(context.path, choices.asks(), context.signal);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      wrong.textContent = error.errors[0]?.detail ?? error.message;
      return;
    }
    if (mine !== generation) return;
    const { node, measured_depth } = table.attributes;
    place.setAttribute(
      "aria-label",
      `Spectrogram of node ${node} at ${say("measured_depth", measured_depth)}`,
    );
    const range = Number(choices.range);
    fill(caption, describe(table, range));
    await drawSpectrogram(
      place,
      table,
      { isLog: choices.isLog, range, most: largestOf(table) },
      context.signal,
    );
  }

  return {
    element: nodes.length
      ? h("div", { class: "panel" }, controls, wrong, h("figure", {}, place, caption))
      : h("p", { class: "panel empty" }, "This point recorded no node."),
    draw: nodes.length ? redraw : async () => {},
    request: () => {
      if (!nodes.length) return null;
      const { range_hz, window_s, ...which } = /** @type {any} */ (choices.asks());
      return {
        asked: [{ table: "spectrogram", query: choices.asks() }],
        python: `spectrogram = point.spectrogram(${pythonNode(which)}, range_hz=${range_hz}${window_s ? `, window_s=${window_s}` : ""}).to_pandas()`,
      };
    },
  };
}

/**
 * Table of a spectrogram; as arrays it is half the bytes that a reader waits for.
 * @param {string} path of the point
 * @param {Record<string, any>} asks
 * @param {AbortSignal} signal
 */
export async function spectrogramOf(path, asks, signal) {
  const { columns, attributes } = await getArrays(`${path}/spectrogram`, asks, signal);
  const plain = Object.entries(columns).map(([name, values]) => [name, Array.from(values)]);
  return { columns: Object.fromEntries(plain), attributes };
}

/** @param {any[]} nodes @param {Choices} choices @param {(name: string) => (value: string) => void} set */
function controlsPart(nodes, choices, set) {
  return [
    choice(
      "Node",
      nodes.map((node) => [nodeInLink(node), node.node !== undefined ? String(node.node) : sayPlace(node)]),
      choices.node,
      set("node"),
    ),
    choice(
      "Frequencies up to",
      RANGES.map((text) => [text, `${text} Hz`]),
      choices.range,
      set("range"),
    ),
    choice(
      "Length of a window",
      [["", "by the run"], ...LENGTHS.map((text) => /** @type {[string, string]} */ ([text, `${text} s`]))],
      choices.length,
      set("length"),
    ),
    choice(
      "Amplitude",
      [
        ["log", "logarithmic"],
        ["linear", "linear"],
      ],
      choices.isLog ? "log" : "linear",
      set("amplitude"),
    ),
  ];
}

/**
 * The lines of a spectrogram that lie about zero, as wide as the line that the window makes of a mean, are the mean position.
 * @param {number} frequency
 * @param {any} table
 */
function isMeanAt(frequency, table) {
  return Math.abs(frequency) < 2.5 * table.attributes.resolution;
}

/**
 * The highest amplitude without the mean position [m].
 * @param {any} table
 */
export function largestOf(table) {
  const { amplitude, frequency } = table.columns;
  return (
    amplitude.reduce(
      (/** @type {number} */ most, /** @type {number} */ value, /** @type {number} */ row) =>
        isMeanAt(frequency[row], table) ? most : Math.max(most, value),
      0,
    ) || 1
  );
}

/**
 * Describes a spectrogram.
 * @param {any} table
 * @param {number} range [Hz]
 */
export function describe(table, range) {
  const { windows, resolution, window_s, node, measured_depth, resolved_hz } = table.attributes;
  return `Node ${node} at ${say("measured_depth", measured_depth)}: ${windows} windows of ${say("time", window_s)}, resolution ${say("frequency", resolution)}. Positive frequencies are forward whirl; the mean position about 0 is left out.${resolved_hz && resolved_hz < range ? ` Dotted: ${say("frequency", resolved_hz)}; the time steps do not resolve higher frequencies.` : ""}`;
}

/**
 * @param {HTMLElement} place
 * @param {any} table
 * @param {{isLog: boolean, range: number, most: number}} how `range` [Hz] is that of the frequencies, `most` [m] the end of the colours
 * @param {AbortSignal} signal
 */
export async function drawSpectrogram(place, table, { isLog, range, most }, signal) {
  const { windows, resolved_hz } = table.attributes;
  const bins = table.columns.time.length / windows;
  const frequency = table.columns.frequency.slice(0, bins);
  const time = Array.from({ length: windows }, (_, index) => table.columns.time[index * bins]);
  const isMean = frequency.map((/** @type {number} */ value) => isMeanAt(value, table));
  const rows = frequency.map((/** @type {number} */ _, /** @type {number} */ bin) =>
    isMean[bin]
      ? Array(windows).fill(null)
      : time.map((__, index) => table.columns.amplitude[index * bins + bin]),
  );
  const z = rows.map((/** @type {(number | null)[]} */ row) =>
    shown("amplitude", row).map((value) =>
      value === null || !isLog ? value : Math.log10(Math.max(value, 1e-12)),
    ),
  );
  const top = Number(shown("amplitude", [most])[0]);
  const [least, largest] = isLog ? [Math.log10(top * DEPTH), Math.log10(top)] : [0, top];
  const { soft } = inks();
  const limits = resolved_hz && resolved_hz < range ? [resolved_hz, -resolved_hz] : [];
  await draw(
    place,
    [
      {
        type: "heatmap",
        x: time,
        y: frequency,
        z,
        zmin: least,
        zmax: largest,
        customdata: rows.map((/** @type {(number | null)[]} */ row) => shown("amplitude", row)),
        colorbar: { ...colourBar(title("amplitude")), ...(isLog ? logTicks(least, largest) : {}) },
        describe: (/** @type {{x: number, y: number, customdata: number}} */ { x, y, customdata }) =>
          `${number(x)} s, ${number(y)} Hz: ${number(customdata, 3)} ${unit("amplitude").symbol}`,
      },
    ],
    {
      shows: range,
      xaxis: { title: "time [s]" },
      yaxis: { title: "frequency [Hz], backward − and forward + whirl", zerolinecolor: soft },
      shapes: limits.map((y) => ({
        type: "line",
        xref: "paper",
        x0: 0,
        x1: 1,
        y0: y,
        y1: y,
        line: { color: soft, width: 1, dash: "dot" },
      })),
    },
    signal,
  );
}
