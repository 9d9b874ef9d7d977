// Pictures with a panel for each point, on one scale: lines over each other would hide all but the last.

import { inks } from "../draw/plots.js";

/** Height of a panel over time, of a name of one line above it, of each further line, and of the axis below all [pixels]. */
const [ROW_PX, NAME_PX, LINE_PX, AXIS_PX] = [150, 26, 15, 74];
/** Least height of a picture [pixels]. */
const LEAST_PX = 420;
/** Width that panels next to each other need, and a panel's largest height [pixels]. */
const [COLUMN_PX, MOST_PX] = [300, 440];
/** Free part of a range beyond its values, and of the width between panels. */
const [SPARE, BETWEEN] = [0.05, 0.07];

/**
 * A panel: what it is called, the colour of its point, its traces, and the name of its scale, which panels of the same name share.
 * @typedef {{name: string, colour: string, traces: any[], scale: string, yaxis: any}} Panel
 */

/**
 * Panels below each other over one axis. Panels of one scale have the range of all their values, or the one that their axis finds itself.
 * @param {HTMLElement} place of the picture, whose height follows their number
 * @param {Panel[]} panels
 * @param {any} [xaxis] of all; of time unless given
 * @returns {{traces: any[], layout: any}}
 */
export function panelsOver(place, panels, xaxis = { title: "time [s]" }) {
  const count = Math.max(1, panels.length);
  const names = namesOf(panels, place.clientWidth);
  const height = Math.max(LEAST_PX, count * (ROW_PX + names.height - NAME_PX) + AXIS_PX);
  place.style.height = `${height}px`;
  const gap = names.height / (height - AXIS_PX);
  /** @type {Record<string, any>} */
  const layout = { showlegend: false, margin: { l: 60, r: 16, t: 8, b: 50 }, annotations: [] };
  panels.forEach((panel, order) => {
    const bottom = 1 - (order + 1) / count;
    const first = panels.findIndex(({ scale }) => scale === panel.scale);
    layout[axisOf("y", order)] = {
      ...panel.yaxis,
      // A panel is too low for its unit on the same line.
      title: panel.yaxis.title.replace(" [", "<br>["),
      domain: [bottom, bottom + 1 / count - gap],
      ...(panel.yaxis.rangemode
        ? {}
        : { range: rangeOf(panels.filter(({ scale }) => scale === panel.scale)) }),
      ...(first === order ? {} : { matches: refOf("y", first) }),
    };
    layout.annotations.push(noteOf(names.texts[order], panel.colour, 0, bottom + 1 / count - gap));
  });
  layout.xaxis = { ...xaxis, anchor: refOf("y", count - 1) };
  const traces = panels.flatMap((panel, order) =>
    panel.traces.map((trace) => ({ ...trace, yaxis: refOf("y", order) })),
  );
  return { traces, layout };
}

/**
 * Panels next to each other of one scale in both directions.
 * @param {HTMLElement} place of the picture
 * @param {Omit<Panel, "scale" | "yaxis">[]} panels
 * @param {{xaxis: any, yaxis: any}} axes common to all, with their ranges
 * @returns {{traces: any[], layout: any}}
 */
export function panelsInPlane(place, panels, { xaxis, yaxis }) {
  const width = place.clientWidth;
  const columns = columnsOf(panels.length, width);
  const rows = Math.ceil(panels.length / columns);
  const wide = (1 - (columns - 1) * BETWEEN) / columns;
  const names = namesOf(panels, wide * width);
  const row = Math.min(MOST_PX, width / columns) + names.height;
  const height = rows * row + AXIS_PX;
  place.style.height = `${height}px`;
  // Below each row stand the numbers of its axis.
  const below = (AXIS_PX - NAME_PX) / height;
  /** @type {Record<string, any>} */
  const layout = { showlegend: false, margin: { l: 60, r: 16, t: 8, b: 50 }, annotations: [] };
  panels.forEach((panel, order) => {
    const [column, line] = [order % columns, Math.floor(order / columns)];
    const left = column * (wide + BETWEEN);
    const top = 1 - line / rows - names.height / height;
    const isLowest = order + columns >= panels.length;
    layout[axisOf("x", order)] = {
      ...xaxis,
      title: isLowest ? xaxis.title : "",
      domain: [left, left + wide],
      anchor: refOf("y", order),
      ...(order ? { scaleanchor: undefined, matches: "x" } : {}),
    };
    layout[axisOf("y", order)] = {
      ...yaxis,
      title: column ? "" : yaxis.title,
      domain: [1 - (line + 1) / rows + (line === rows - 1 ? 0 : below), top],
      anchor: refOf("x", order),
      ...(order ? { matches: "y" } : {}),
    };
    layout.annotations.push(noteOf(names.texts[order], panel.colour, left, top));
  });
  const traces = panels.flatMap((panel, order) =>
    panel.traces.map((trace) => ({ ...trace, xaxis: refOf("x", order), yaxis: refOf("y", order) })),
  );
  return { traces, layout };
}

/**
 * Panels in a row: as many as have room, and rows as even as can be.
 * @param {number} count of panels
 * @param {number} width [pixels]
 */
export function columnsOf(count, width) {
  const most = Math.max(1, Math.min(3, Math.floor(width / COLUMN_PX)));
  return count === 4 ? Math.min(2, most) : Math.max(1, Math.min(count, most));
}

/**
 * Range of all values of some panels.
 * @param {Panel[]} panels
 * @returns {[number, number] | undefined} undefined if there are none
 */
export function rangeOf(panels) {
  let [least, largest] = [Infinity, -Infinity];
  for (const { traces } of panels) {
    for (const { y } of traces) {
      for (const value of y) {
        if (value === null) continue;
        if (value < least) least = value;
        if (value > largest) largest = value;
      }
    }
  }
  if (!(least <= largest)) return undefined;
  const spare = (largest - least) * SPARE || Math.abs(least) * SPARE || 1;
  return [least - spare, largest + spare];
}

/**
 * Lines of one picture in the order in which they are drawn: the one of the largest range first, below the others. The legend keeps their order.
 * @param {any[]} traces
 */
export function largestFirst(traces) {
  const ranges = new Map(traces.map((trace) => [trace, reachOf(trace.y)]));
  return traces
    .toSorted((a, b) => (ranges.get(b) ?? 0) - (ranges.get(a) ?? 0))
    .map((trace) => ({ ...trace, legendrank: traces.indexOf(trace) + 1 }));
}

/** @param {(number | null)[]} values */
function reachOf(values) {
  let [least, largest] = [Infinity, -Infinity];
  for (const value of values) {
    if (value === null) continue;
    if (value < least) least = value;
    if (value > largest) largest = value;
  }
  return largest - least;
}

/** @param {"x" | "y"} letter @param {number} order @returns {string} the axis' name in a layout */
function axisOf(letter, order) {
  return `${letter}axis${order ? order + 1 : ""}`;
}

/** @param {"x" | "y"} letter @param {number} order @returns {string} the axis' name in a trace */
function refOf(letter, order) {
  return `${letter}${order ? order + 1 : ""}`;
}

/** Width of a character of a name, about, and of what is next to it [pixels]. */
const [CHARACTER, BESIDE] = [6.2, 110];

/**
 * Names of panels in lines that have room, and the height above each panel that the longest needs [pixels].
 * @param {{name: string}[]} panels
 * @param {number} width of a panel [pixels]
 */
function namesOf(panels, width) {
  const most = Math.max(8, Math.floor((width - BESIDE) / CHARACTER));
  const lines = panels.map(({ name }) => linesOf(name, most));
  const further = Math.max(1, ...lines.map(({ length }) => length)) - 1;
  return { texts: lines.map((one) => one.join("<br>")), height: NAME_PX + LINE_PX * further };
}

/**
 * Lines of a text, broken between words, and within words that are longer than a line.
 * @param {string} text
 * @param {number} most characters of a line
 */
export function linesOf(text, most) {
  /** @type {string[]} */
  const lines = [];
  const parts = text.split(" ").flatMap((word) => word.match(new RegExp(`.{1,${most}}`, "gu")) ?? [""]);
  for (const part of parts) {
    const last = lines.at(-1);
    if (last !== undefined && last.length + 1 + part.length <= most)
      lines[lines.length - 1] = `${last} ${part}`;
    else lines.push(part);
  }
  return lines;
}

/** Note of a name above the left end of a panel. @param {string} text @param {string} mark its colour @param {number} x @param {number} y parts of the picture */
function noteOf(text, mark, x, y) {
  return {
    text,
    mark,
    xref: "paper",
    yref: "paper",
    x,
    y,
    xanchor: "left",
    yanchor: "bottom",
    showarrow: false,
    font: { color: inks().text, size: 12 },
  };
}
