// Small pictures of the overview of a point, on canvases: curves in a frame, and the string over depth.

import { number, shown } from "../data/units.js";
import { inks, LINES } from "./plots.js";
import { HALF, inkOf, LEAST, namedParts } from "./string-track.js";
import { h } from "../ui/dom.js";

/** @typedef {{x: (number | null)[], y: (number | null)[], colour: string, isDots?: boolean}} Curve values as they are shown */
/** @typedef {import("../data/string-parts.js").Part} Part */

/** Room for the numbers at the ends of the axes [pixels]. */
const [LEFT, BOTTOM, TOP, RIGHT] = [46, 18, 8, 8];
/** A canvas for a small picture. @param {string} name @param {string} [size] */
export function smallCanvas(name, size = "") {
  return h("canvas", { class: `small-picture ${size}`, role: "img", "aria-label": name });
}

/** Painters of canvases that have been drawn. @type {WeakMap<Element, () => void>} */
const painters = new WeakMap();
const resized = new ResizeObserver((entries) => {
  for (const { target } of entries) painters.get(target)?.();
});

/** Paints a canvas now, and again if its size changes. @param {HTMLCanvasElement} canvas @param {() => void} paint */
function painted(canvas, paint) {
  painters.set(canvas, paint);
  resized.observe(canvas);
  paint();
}

/** Pen of a canvas of the size at which it is shown. @param {HTMLCanvasElement} canvas */
function penOf(canvas) {
  const [width, height, scale] = [canvas.clientWidth, canvas.clientHeight, devicePixelRatio];
  [canvas.width, canvas.height] = [width * scale, height * scale];
  const pen = canvas.getContext("2d");
  if (!pen) return null;
  pen.scale(scale, scale);
  pen.font = "11px system-ui, sans-serif";
  pen.textBaseline = "middle";
  return { pen, width, height };
}

/**
 * Ends of some values; around a single one there is room.
 * @param {(number | null)[][]} columns
 * @returns {[number, number]}
 */
export function rangeOf(columns) {
  let [least, largest] = [Infinity, -Infinity];
  for (const column of columns)
    for (const value of column)
      if (value !== null) [least, largest] = [Math.min(least, value), Math.max(largest, value)];
  if (!(least <= largest)) return [0, 1];
  const spare = largest > least ? 0 : Math.abs(least) / 2 || 0.5;
  return [least - spare, largest + spare];
}

/**
 * Draws curves in a frame, with the numbers at its corners.
 * @param {HTMLCanvasElement} canvas
 * @param {Curve[]} curves
 * @param {{isEqual?: boolean, isFromZero?: boolean, level?: number, at?: number}} [options] one scale for both axes; an axis from zero up; height of a
 *   dashed line; place of an upright line
 */
export function drawCurves(canvas, curves, options = {}) {
  painted(canvas, () => paintCurves(canvas, curves, options));
}

/** @param {HTMLCanvasElement} canvas @param {Curve[]} curves @param {NonNullable<Parameters<typeof drawCurves>[2]>} options */
function paintCurves(canvas, curves, { isEqual = false, isFromZero = false, level, at }) {
  const found = penOf(canvas);
  if (!found) return;
  const { pen, width, height } = found;
  const { text, soft, line } = inks();
  let [x, y] = [rangeOf(curves.map((curve) => curve.x)), rangeOf(curves.map((curve) => curve.y))];
  if (level !== undefined) y = rangeOf([[...y, level]]);
  if (isFromZero) y = [0, 1.08 * y[1]];
  const [across, up] = [width - LEFT - RIGHT, height - TOP - BOTTOM];
  if (isEqual) {
    const half = 0.55 * Math.max((x[1] - x[0]) / across, (y[1] - y[0]) / up);
    const about = (/** @type {[number, number]} */ [from, to], /** @type {number} */ pixels) =>
      /** @type {[number, number]} */ ([(from + to) / 2 - half * pixels, (from + to) / 2 + half * pixels]);
    [x, y] = [about(x, across), about(y, up)];
  }
  const right = (/** @type {number} */ value) => LEFT + (across * (value - x[0])) / (x[1] - x[0]);
  const down = (/** @type {number} */ value) => TOP + up - (up * (value - y[0])) / (y[1] - y[0]);
  pen.strokeStyle = line;
  pen.strokeRect(LEFT, TOP, across, up);
  drawEnds(pen, { x, y }, { width, height });
  if (level !== undefined) {
    pen.setLineDash([4, 3]);
    pen.strokeStyle = soft;
    strokeAlong(pen, [x[0], x[1]], [level, level], right, down);
    pen.setLineDash([]);
  }
  for (const curve of curves) drawCurve(pen, curve, right, down);
  if (at !== undefined && at >= x[0] && at <= x[1]) {
    pen.strokeStyle = text;
    strokeAlong(pen, [at, at], [y[0], y[1]], right, down);
  }
}

/** Numbers at the ends of the axes. @param {CanvasRenderingContext2D} pen @param {{x: [number, number], y: [number, number]}} ranges @param {{width: number, height: number}} size */
function drawEnds(pen, { x, y }, { width, height }) {
  pen.fillStyle = inks().soft;
  pen.textAlign = "right";
  pen.fillText(number(y[1], 3), LEFT - 4, TOP + 5);
  pen.fillText(number(y[0], 3), LEFT - 4, height - BOTTOM - 5);
  pen.fillText(number(x[1], 3), width - RIGHT, height - BOTTOM / 2);
  pen.textAlign = "left";
  pen.fillText(number(x[0], 3), LEFT, height - BOTTOM / 2);
}

/** @param {CanvasRenderingContext2D} pen @param {Curve} curve @param {(value: number) => number} right @param {(value: number) => number} down */
function drawCurve(pen, { x, y, colour, isDots }, right, down) {
  [pen.strokeStyle, pen.fillStyle] = [colour, colour];
  if (!isDots) return strokeAlong(pen, x, y, right, down);
  x.forEach((value, index) => {
    const height = y[index];
    if (value === null || height === null) return;
    pen.beginPath();
    pen.arc(right(value), down(height), 2.5, 0, 2 * Math.PI);
    pen.fill();
  });
}

/**
 * A line through points, broken at gaps.
 * @param {CanvasRenderingContext2D} pen @param {(number | null)[]} x @param {(number | null)[]} y
 * @param {(value: number) => number} right @param {(value: number) => number} down
 */
function strokeAlong(pen, x, y, right, down) {
  pen.beginPath();
  let isBroken = true;
  x.forEach((value, index) => {
    const height = y[index];
    if (value === null || height === null) {
      isBroken = true;
      return;
    }
    if (isBroken) pen.moveTo(right(value), down(height));
    else pen.lineTo(right(value), down(height));
    isBroken = false;
  });
  pen.stroke();
}

/**
 * Draws the string over depth, with curves next to it, each from zero to its largest value.
 * @param {HTMLCanvasElement} canvas
 * @param {Part[]} parts
 * @param {{depths: number[], curves: {values: number[], colour: string}[], nodes: number[]}} along depths of values and of recorded nodes [m]
 */
export function drawTrack(canvas, parts, along) {
  painted(canvas, () => paintTrack(canvas, parts, along));
}

/** @param {HTMLCanvasElement} canvas @param {Part[]} parts @param {Parameters<typeof drawTrack>[2]} along */
function paintTrack(canvas, parts, { depths, curves, nodes }) {
  const found = penOf(canvas);
  if (!found) return;
  const { pen, width, height } = found;
  const { text, soft, line } = inks();
  const deepest = parts.at(-1)?.to ?? 1;
  const perMetre = (height - 2 * TOP) / deepest;
  const down = (/** @type {number} */ depth) => TOP + perMetre * depth;
  const [middle, names, start] = [LEFT + 16, LEFT + 32, LEFT + 106];
  pen.fillStyle = soft;
  pen.textAlign = "right";
  for (const part of [0, 0.25, 0.5, 0.75, 1])
    pen.fillText(
      number(Number(shown("measured_depth", [part * deepest])[0]), 3),
      LEFT - 4,
      Math.min(height - 6, Math.max(6, down(part * deepest))),
    );
  for (const { kind, from, to } of parts) {
    pen.fillStyle = inkOf(kind);
    pen.fillRect(
      middle - HALF[kind],
      down(from),
      2 * HALF[kind],
      Math.max(LEAST[kind] ?? 1, down(to) - down(from)),
    );
  }
  pen.fillStyle = text;
  pen.textAlign = "left";
  for (const named of namedParts(parts, perMetre)) pen.fillText(named.name, names, TOP + named.down);
  pen.fillStyle = LINES[1];
  for (const depth of nodes) {
    pen.beginPath();
    pen.arc(middle, down(depth), 3, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.strokeStyle = line;
  if (curves.length) pen.strokeRect(start, TOP, width - start - RIGHT, height - 2 * TOP);
  for (const { values, colour } of curves) {
    const most = Math.max(...values.map(Math.abs)) || 1;
    pen.strokeStyle = colour;
    strokeAlong(
      pen,
      values,
      depths,
      (value) => start + ((width - start - RIGHT) * Math.abs(value)) / most,
      down,
    );
  }
}
