// Grid lines, ticks and titles of axes, and the bar of colours.

import { colourScale } from "./colours.js";
import { BAR, BAR_LEFT, crossedBy, FREE, LINE, TICK, titleLines, wordsAcross } from "./layout.js";
import { colourEnds, placed } from "./marks.js";
import { roundValues, tickText } from "./ticks.js";

/** Length of the mark of a tick [pixels]. */
const MARK = 5;
/** Pixels between two ticks of the bar of colours, about. */
const APART = 45;
/** Gap between words of ticks [pixels]. */
const GAP = 4;

/** @typedef {import("./svg-pen.js").Pen} Pen */
/** @typedef {import("./axis.js").Axis} Axis */
/** @typedef {import("./layout.js").Panel} Panel */
/** @typedef {import("./layout.js").Frame} Frame */
/** @typedef {import("./inks.js").Inks} Inks */

/** Draws the grid lines of a panel. @param {Pen} pen @param {Panel} panel @param {Inks} inks */
export function drawGridLines(pen, { x, y }, inks) {
  for (const [axis, other] of [
    [x, y],
    [y, x],
  ]) {
    if (axis.own.visible === false) continue;
    const ends = [other.offset, other.offset + other.length];
    pen.lineWidth = 1;
    pen.strokeStyle = inks.line;
    pen.beginPath();
    if (axis.own.showgrid !== false)
      for (const { value } of axis.ticks()) cross(pen, axis, axis.toPixel(value), ends);
    pen.stroke();
    const [low, high] = [Math.min(...axis.range), Math.max(...axis.range)];
    if (axis.isLog || axis.words || axis.own.zeroline === false || low > 0 || high < 0) continue;
    pen.strokeStyle = axis.own.zerolinecolor ?? inks.line;
    pen.beginPath();
    cross(pen, axis, axis.toPixel(0), ends);
    pen.stroke();
  }
}

/** @param {Pen} pen @param {Axis} axis @param {number} pixel along it @param {number[]} ends of the line across it */
function cross(pen, { isAcross }, pixel, [from, to]) {
  // On the middle of a pixel, so that a line is as wide as one.
  const along = Math.round(pixel - 0.5) + 0.5;
  pen.moveTo(...placed(isAcross, along, from));
  pen.lineTo(...placed(isAcross, along, to));
}

/**
 * Draws the ticks and the title of an axis.
 * @param {Pen} pen
 * @param {Axis} axis
 * @param {Panel[]} panels
 * @param {Map<string, Axis>} axes
 * @param {Inks} inks
 * @param {(text: string) => number} measure
 */
export function drawAxis(pen, axis, panels, axes, inks, measure) {
  const crossed = crossedBy(axis, panels, axes);
  if (!crossed || axis.own.visible === false) return;
  const isRight = axis.own.side === "right";
  const start = axis.isAcross || isRight ? crossed.offset + crossed.length : crossed.offset;
  const outward = axis.isAcross || isRight ? 1 : -1;
  pen.lineWidth = 1;
  pen.strokeStyle = inks.line;
  pen.fillStyle = inks.text;
  pen.beginPath();
  for (const { value } of axis.ticks())
    cross(pen, axis, axis.toPixel(value), [start, start + outward * MARK]);
  pen.stroke();
  pen.strokeStyle = inks.soft;
  pen.beginPath();
  const along = Math.round(start - 0.5) + 0.5;
  pen.moveTo(...placed(axis.isAcross, axis.offset, along));
  pen.lineTo(...placed(axis.isAcross, axis.offset + axis.length, along));
  pen.stroke();
  pen.textAlign = axis.isAcross ? "center" : isRight ? "left" : "right";
  pen.textBaseline = axis.isAcross ? "top" : "middle";
  if (axis.isAcross && axis.words) drawWordsAcross(pen, axis, start + TICK, measure);
  else
    for (const { text, pixel } of readable(axis, measure))
      pen.fillText(text, ...placed(axis.isAcross, pixel, start + outward * TICK));
  drawTitle(pen, axis, start, measure);
}

/** @param {Pen} pen @param {Axis} axis @param {number} top of the words @param {(text: string) => number} measure */
function drawWordsAcross(pen, axis, top, measure) {
  const { lines, isTurned } = wordsAcross(axis, axis.length, measure);
  for (const { text } of axis.ticks()) {
    const pixel = axis.toPixel(text);
    if (isTurned)
      turned(pen, pixel, top, Math.PI / 2, () => {
        pen.textAlign = "left";
        pen.textBaseline = "middle";
        pen.fillText(text, 0, 0);
      });
    else lines.get(text)?.forEach((words, order) => pen.fillText(words, pixel, top + LINE * order));
  }
}

/**
 * Ticks whose words do not cover others before them.
 * @param {Axis} axis
 * @param {(text: string) => number} measure
 * @returns {{text: string, pixel: number}[]}
 */
export function readable(axis, measure) {
  let last = -Infinity;
  return axis
    .ticks()
    .map(({ value, text }) => ({ text, pixel: axis.toPixel(value) }))
    .sort((a, b) => a.pixel - b.pixel)
    .filter(({ text, pixel }) => {
      const half = axis.isAcross ? measure(text) / 2 + GAP : LINE / 2 - 1;
      if (pixel - half < last) return false;
      last = pixel + half;
      return true;
    });
}

/** @param {Pen} pen @param {Axis} axis @param {number} start of its ticks @param {(text: string) => number} measure */
function drawTitle(pen, axis, start, measure) {
  const middle = axis.offset + axis.length / 2;
  const lines = titleLines(axis, axis.length, measure);
  pen.textAlign = "center";
  if (axis.isAcross) {
    pen.textBaseline = "top";
    const first = start + TICK + wordsAcross(axis, axis.length, measure).height + FREE / 2;
    lines.forEach((words, order) => pen.fillText(words, middle, first + LINE * order));
    return;
  }
  const widest = Math.max(0, ...axis.ticks().map(({ text }) => measure(text)));
  const isRight = axis.own.side === "right";
  const beside = TICK + widest + FREE + LINE * (lines.length - 0.5);
  turned(pen, start + (isRight ? beside : -beside), middle, -Math.PI / 2, () => {
    pen.textBaseline = "middle";
    lines.forEach((words, order) => pen.fillText(words, 0, LINE * order));
  });
}

/** Draws in turned directions about a place. @param {Pen} pen @param {number} x @param {number} y @param {number} angle @param {() => void} drawn */
function turned(pen, x, y, angle, drawn) {
  pen.save();
  pen.translate(x, y);
  pen.rotate(angle);
  drawn();
  pen.restore();
}

/**
 * The bar of colours of a picture: of the first trace that has one.
 * @param {any[]} traces
 * @param {(text: string) => number} measure
 * @returns {{trace: any, lines: string[], ticks: {value: number, text: string}[] | undefined, ends: [number, number], width: number} | null}
 */
export function colourBarOf(traces, measure) {
  const trace = traces.find((one) => one.marker?.colorbar ?? (one.colorbar && one.showscale !== false));
  const ends = trace && colourEnds(trace);
  if (!ends) return null;
  const { title, tickvals, ticktext } = trace.marker?.colorbar ?? trace.colorbar;
  const lines = String(title?.text ?? "")
    .split("<br>")
    .filter(Boolean);
  const ticks = tickvals?.map((/** @type {number} */ value, /** @type {number} */ order) => ({
    value,
    text: ticktext[order],
  }));
  const [least, largest] = ends;
  const known =
    ticks ?? roundValues(least, largest, PARTS).map((value) => ({ value, text: tickText(value) }));
  const widest = Math.max(0, ...known.map((/** @type {any} */ { text }) => measure(text)));
  const width = BAR_LEFT + BAR + TICK + widest + (lines.length ? LINE * lines.length + FREE : 0);
  return { trace, lines, ticks, ends, width };
}
/** Ticks by which the width of the bar's numbers is known. */
const PARTS = 8;

/**
 * Draws the bar of colours.
 * @param {Pen} pen
 * @param {NonNullable<ReturnType<typeof colourBarOf>>} bar
 * @param {Frame} frame
 * @param {Inks} inks
 */
export function drawColourBar(pen, { trace, lines, ticks, ends: [least, largest], width }, frame, inks) {
  const colour = colourScale(trace.colorscale ?? trace.marker?.colorscale, least, largest);
  const left = frame.right + BAR_LEFT;
  const height = frame.bottom - frame.top;
  for (let row = 0; row < height; row += 1) {
    pen.fillStyle = colour(least + ((row + 0.5) / height) * (largest - least));
    pen.fillRect(left, frame.bottom - row - 1, BAR, 1.5);
  }
  pen.fillStyle = inks.text;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  const shown =
    ticks ??
    roundValues(least, largest, Math.max(2, height / APART)).map((value) => ({
      value,
      text: tickText(value),
    }));
  for (const { value, text } of shown) {
    const up = ((value - least) / (largest - least || 1)) * height;
    pen.fillText(text, left + BAR + TICK, frame.bottom - (largest > least ? up : height / 2));
  }
  turned(pen, frame.right + width - LINE / 2, (frame.top + frame.bottom) / 2, Math.PI / 2, () => {
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    lines.forEach((words, order) => pen.fillText(words, 0, LINE * (lines.length - 1 - order)));
  });
}
