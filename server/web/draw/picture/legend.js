// The legend of a picture: buttons that show and hide lines, and the same words in a saved file.

import { fill, h } from "../../ui/dom.js";
import { drawLine, drawSymbols } from "./marks.js";

/** Size of the sample of a trace, the gap after it, and that between names [pixels]. */
const SAMPLE = { width: 24, height: 12 };
const [GAP, APART, ROW] = [6, 14, 18];
/** Largest symbol and widest line of a sample [pixels]. */
const [LARGEST, WIDEST] = [9, 4];

/** @typedef {import("./svg-pen.js").Pen} Pen */
/** @typedef {import("./inks.js").Inks} Inks */
/** Name in the legend with the traces that it stands for, the first of which is its sample. @typedef {{name: string, traces: any[]}} Entry */

/**
 * Entries of the legend; traces of a group have one.
 * @param {any[]} traces
 * @param {any} layout
 * @returns {Entry[]}
 */
export function entriesOf(traces, layout) {
  const named = traces.filter((trace) => trace.name && !trace.z && trace.showlegend !== false);
  const isShown = layout.showlegend ?? (named.length > 1 || named.some((trace) => trace.showlegend));
  if (!isShown) return [];
  return named
    .toSorted((a, b) => (a.legendrank ?? 0) - (b.legendrank ?? 0))
    .map((trace) => ({
      name: trace.name,
      traces: [
        trace,
        ...traces.filter(
          (other) =>
            other !== trace && trace.legendgroup !== undefined && other.legendgroup === trace.legendgroup,
        ),
      ],
    }));
}

/**
 * Hidden names after a name is shown or hidden.
 * @param {ReadonlySet<string>} hidden
 * @param {string} name
 * @returns {Set<string>}
 */
export function toggled(hidden, name) {
  const result = new Set(hidden);
  if (!result.delete(name)) result.add(name);
  return result;
}

/**
 * Hidden names after a name is shown alone; all are shown where it was alone.
 * @param {ReadonlySet<string>} hidden
 * @param {string} name
 * @param {string[]} names all of them
 * @returns {Set<string>}
 */
export function isolated(hidden, name, names) {
  const others = names.filter((other) => other !== name);
  const isAlone = !hidden.has(name) && others.every((other) => hidden.has(other));
  return new Set(isAlone ? [] : others);
}

/** Traces that are not hidden. @param {any[]} traces @param {Entry[]} entries @param {ReadonlySet<string>} hidden */
export function shownTraces(traces, entries, hidden) {
  const gone = new Set(entries.filter(({ name }) => hidden.has(name)).flatMap((entry) => entry.traces));
  return traces.filter((trace) => !gone.has(trace));
}

/**
 * @typedef {object} Choices
 * @property {(name: string) => void} toggle shows or hides a name
 * @property {(name: string) => void} isolate shows a name alone
 */

/** Buttons of a legend. */
export class Legend {
  element = h("div", { class: "legend" });
  #choices;
  #shown = "";

  /** @param {Choices} choices */
  constructor(choices) {
    this.#choices = choices;
  }

  /** @param {Entry[]} entries @param {ReadonlySet<string>} hidden @param {Inks} inks */
  show(entries, hidden, inks) {
    const shown = JSON.stringify([
      inks.text,
      entries.map(({ name, traces: [{ line, marker, mode }] }) => [
        name,
        mode,
        line,
        typeof marker?.color === "string" && marker,
      ]),
    ]);
    // Buttons that stay have the keyboard's focus still, and notice a double click.
    if (shown !== this.#shown)
      fill(
        this.element,
        entries.map((entry) => this.#button(entry, inks)),
      );
    this.#shown = shown;
    entries.forEach(({ name }, order) =>
      this.element.children[order].setAttribute("aria-pressed", String(!hidden.has(name))),
    );
  }

  /** @param {Entry} entry @param {Inks} inks */
  #button({ name, traces }, inks) {
    const { toggle, isolate } = this.#choices;
    return h(
      "button",
      {
        type: "button",
        title: "Shows or hides it; with Shift, or by a double click, shows it alone",
        onclick: (/** @type {MouseEvent} */ event) => {
          // The second click of two takes back the first.
          if (event.detail === 2) toggle(name);
          if (event.detail === 2 || event.shiftKey) isolate(name);
          else toggle(name);
        },
      },
      sampleOf(traces[0], inks),
      name,
    );
  }
}

/** Canvas with a sample of a trace. @param {any} trace @param {Inks} inks */
function sampleOf(trace, inks) {
  const scale = devicePixelRatio;
  const { width, height } = SAMPLE;
  const canvas = h("canvas", { width: width * scale, height: height * scale, "aria-hidden": "true" });
  const pen = canvas.getContext("2d");
  if (!pen) return canvas;
  pen.scale(scale, scale);
  drawSample(pen, trace, 0, height / 2, inks);
  return canvas;
}

/** Draws a sample of a trace. @param {Pen} pen @param {any} trace @param {number} left @param {number} middle @param {Inks} inks */
function drawSample(pen, trace, left, middle, inks) {
  const { line, marker = {} } = trace;
  if (trace.type === "bar") {
    pen.fillStyle = marker.color;
    return pen.fillRect(left + 5, middle - 5, SAMPLE.width - 10, 10);
  }
  const places = { x: Float64Array.of(left, left + SAMPLE.width), y: Float64Array.of(middle, middle) };
  if (trace.mode.includes("lines"))
    drawLine(pen, { ...line, width: Math.min(WIDEST, Math.max(1.5, line.width ?? 2)) }, places);
  if (!trace.mode.includes("markers")) return undefined;
  const one = { x: Float64Array.of(left + SAMPLE.width / 2), y: Float64Array.of(middle) };
  const symbol = Array.isArray(marker.symbol) ? marker.symbol[0] : marker.symbol;
  const color = Array.isArray(marker.color) ? inks.soft : (marker.color ?? line?.color);
  const size = Math.min(LARGEST, Math.max(6, marker.size ?? 6));
  return drawSymbols(pen, { marker: { ...marker, symbol, color, size } }, one, inks);
}

/**
 * Places of names in rows as wide as a picture.
 * @param {Entry[]} entries
 * @param {number} width
 * @param {(text: string) => number} measure
 * @returns {{places: {entry: Entry, left: number, top: number}[], height: number}}
 */
export function legendRows(entries, width, measure) {
  let [left, top] = [0, 0];
  const places = entries.map((entry) => {
    const wide = SAMPLE.width + GAP + measure(entry.name);
    if (left > 0 && left + wide > width) [left, top] = [0, top + ROW];
    const place = { entry, left, top };
    left += wide + APART;
    return place;
  });
  return { places, height: entries.length ? top + ROW + 4 : 0 };
}

/** Draws the legend of a saved file. @param {Pen} pen @param {Entry[]} entries @param {number} width @param {(text: string) => number} measure @param {Inks} inks */
export function drawLegend(pen, entries, width, measure, inks) {
  for (const { entry, left, top } of legendRows(entries, width, measure).places) {
    drawSample(pen, entry.traces[0], left, top + ROW / 2, inks);
    pen.fillStyle = inks.text;
    pen.textAlign = "left";
    pen.textBaseline = "middle";
    pen.fillText(entry.name, left + SAMPLE.width + GAP, top + ROW / 2);
  }
}
