// Cells and contours: values over a grid as colours.

import { edgesOf } from "./axis.js";
import { colourScale, pixelTable, tabled } from "./colours.js";
import { between, contourLines, LINES_ABOUT } from "./contour.js";
import { roundValues } from "./ticks.js";

/** Cells that are drawn one by one; more are painted by pixels. */
const FEW = 4000;

/** @typedef {import("./svg-pen.js").Pen} Pen */
/** @typedef {import("./axis.js").Axis} Axis */
/** Values at the ends of a scale of colours. @typedef {[least: number, largest: number]} Ends */

/** Draws the values of a trace over its grid. @param {Pen} pen @param {any} trace @param {Axis} x @param {Axis} y @param {Ends} ends */
export function drawGrid(pen, trace, x, y, ends) {
  if (trace.type === "contour") drawContours(pen, trace, x, y, ends);
  else drawCells(pen, trace, x, y, ends);
}

/**
 * Ends of the cells of a trace in the picture [pixels].
 * @param {any} trace
 * @param {Axis} x
 * @param {Axis} y
 * @returns {{across: Float64Array, up: Float64Array}}
 */
export function cellEdges(trace, x, y) {
  return {
    across: x.toPixels(edgesOf([...trace.x], trace.z[0]?.length ?? 0, x.isLog)),
    up: y.toPixels(edgesOf([...trace.y], trace.z.length, y.isLog)),
  };
}

/** @param {Pen} pen @param {any} trace @param {Axis} x @param {Axis} y @param {Ends} ends */
function drawCells(pen, trace, x, y, [least, largest]) {
  const { across, up } = cellEdges(trace, x, y);
  if (trace.z.length * (trace.z[0]?.length ?? 0) > FEW)
    return paint(pen, trace, x, y, [least, largest], ({ width, height, scale }) => {
      const columns = spansOf(across, x.offset, width, scale);
      const rows = spansOf(up, y.offset, height, scale);
      return (column, row) => largestIn(trace.z, columns, rows, column, row);
    });
  const colour = colourScale(trace.colorscale, least, largest);
  const gap = trace.xgap ?? 0;
  const whole = (/** @type {number} */ pixel) => Math.round(pixel * devicePixelRatio) / devicePixelRatio;
  trace.z.forEach((/** @type {(number | null)[]} */ line, /** @type {number} */ row) => {
    const [bottom, top] = [up[row], up[row + 1]].map(whole).sort((a, b) => b - a);
    line.forEach((value, column) => {
      if (value === null || value === undefined) return;
      const [left, right] = [across[column], across[column + 1]].map(whole).sort((a, b) => a - b);
      pen.fillStyle = colour(value);
      pen.fillRect(left + gap / 2, top + gap / 2, right - left - gap, bottom - top - gap);
    });
  });
}

/** @param {Pen} pen @param {any} trace @param {Axis} x @param {Axis} y @param {Ends} ends */
function drawContours(pen, trace, x, y, ends) {
  const [xs, ys] = [x.toPixels(trace.x), y.toPixels(trace.y)];
  const [columns, rows] = [cellAt(xs), cellAt(ys)];
  paint(pen, trace, x, y, ends, ({ scale }) => (across, down) => {
    const [px, py] = [x.offset + (across + 0.5) / scale, y.offset + (down + 0.5) / scale];
    const [column, row] = [columns(px), rows(py)];
    if (column < 0 || row < 0) return null;
    const up = (py - ys[row]) / (ys[row + 1] - ys[row]);
    return between(trace.z, row, column, up, (px - xs[column]) / (xs[column + 1] - xs[column]));
  });
  pen.strokeStyle = trace.line.color;
  pen.lineWidth = trace.line.width;
  pen.beginPath();
  for (const level of roundValues(...ends, LINES_ABOUT)) {
    for (const [x0, y0, x1, y1] of contourLines(xs, ys, trace.z, level)) {
      pen.moveTo(x0, y0);
      pen.lineTo(x1, y1);
    }
  }
  pen.stroke();
}

/** Size of what is painted, in pixels of the screen, and how many of these a pixel of the picture has. @typedef {{width: number, height: number, scale: number}} Screen */

/**
 * Paints values pixel by pixel, as far as the axes show them.
 * @param {Pen} pen
 * @param {any} trace
 * @param {Axis} x
 * @param {Axis} y
 * @param {Ends} ends
 * @param {(screen: Screen) => (column: number, row: number) => number | null} valuesOn what gives the value of each pixel
 */
function paint(pen, trace, x, y, [least, largest], valuesOn) {
  const scale = devicePixelRatio;
  const [width, height] = [Math.ceil(x.length * scale), Math.ceil(y.length * scale)];
  const valueAt = valuesOn({ width, height, scale });
  const screen = document.createElement("canvas");
  Object.assign(screen, { width, height });
  const ground = /** @type {CanvasRenderingContext2D} */ (screen.getContext("2d"));
  const image = ground.createImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  const table = pixelTable(trace.colorscale);
  for (let row = 0, at = 0; row < height; row += 1) {
    for (let column = 0; column < width; column += 1, at += 1) {
      const value = valueAt(column, row);
      if (value !== null && value !== undefined) pixels[at] = table[tabled(value, least, largest)];
    }
  }
  ground.putImageData(image, 0, 0);
  pen.drawImage(screen, x.offset, y.offset, width / scale, height / scale);
}

/** The first and the last cell in each pixel; -1 where there is none. @typedef {{first: Int32Array, last: Int32Array}} Spans */

/**
 * Cells in each of some pixels: the one in its middle, and those that are narrower than a pixel.
 * @param {ArrayLike<number>} edges of the cells [pixels of the picture]
 * @param {number} offset of the first pixel
 * @param {number} count of pixels
 * @param {number} scale pixels of the screen in one of the picture
 * @returns {Spans}
 */
export function spansOf(edges, offset, count, scale) {
  const first = new Int32Array(count).fill(-1);
  const last = new Int32Array(count).fill(-1);
  for (let cell = 0; cell + 1 < edges.length; cell += 1) {
    const [one, other] = [(edges[cell] - offset) * scale, (edges[cell + 1] - offset) * scale];
    const [low, high] = [Math.min(one, other), Math.max(one, other)];
    const isThin = high - low < 1;
    const from = isThin ? Math.floor((low + high) / 2) : Math.round(low);
    const end = isThin ? from + 1 : Math.round(high);
    for (let pixel = Math.max(0, from); pixel < Math.min(count, end); pixel += 1) {
      if (first[pixel] < 0) first[pixel] = cell;
      last[pixel] = cell;
    }
  }
  return { first, last };
}

/** The largest value of the cells in a pixel, so that no narrow peak is lost. @param {(number | null)[][]} z @param {Spans} columns @param {Spans} rows @param {number} column @param {number} row */
function largestIn(z, columns, rows, column, row) {
  const [left, low] = [columns.first[column], rows.first[row]];
  if (left < 0 || low < 0) return null;
  if (left === columns.last[column] && low === rows.last[row]) return z[low][left];
  /** @type {number | null} */
  let largest = null;
  for (let up = low; up <= rows.last[row]; up += 1) {
    for (let across = left; across <= columns.last[column]; across += 1) {
      const value = z[up][across];
      if (value !== null && value !== undefined && (largest === null || value > largest)) largest = value;
    }
  }
  return largest;
}

/**
 * Number of the cell at a place, remembered from one place to the next.
 * @param {ArrayLike<number>} edges rising or falling
 * @returns {(pixel: number) => number} -1 outside
 */
export function cellAt(edges) {
  const last = edges.length - 2;
  const isRising = edges[edges.length - 1] >= edges[0];
  let cell = 0;
  const isBefore = (/** @type {number} */ pixel, /** @type {number} */ edge) =>
    isRising ? pixel < edges[edge] : pixel > edges[edge];
  return (pixel) => {
    if (last < 0 || isBefore(pixel, 0) || !isBefore(pixel, last + 1)) return -1;
    while (isBefore(pixel, cell)) cell -= 1;
    while (!isBefore(pixel, cell + 1)) cell += 1;
    return cell;
  };
}
