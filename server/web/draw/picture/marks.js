// Marks of traces: lines, symbols with their words, error bars, and dots of many points.

import { errorEnds } from "./axis.js";
import { colourScale, mixedOf, pixelOf, pixelTable, tabled } from "./colours.js";

/** Usual sizes of symbols and of their words, and the width of a line [pixels]. */
const [SYMBOL, WORD, WIDTH] = [6, 12, 2];
/** Half of the cap of an error bar, and the distance of a word from its mark [pixels]. */
const [CAP, APART] = [3, 2];
/** Symbols by their numbers, so that traces differ by more than colour. */
const SYMBOLS = ["circle", "square", "diamond", "cross", "x", "triangle-up", "triangle-down"];
/** Length of the parts of dashes, in widths of a line of three pixels at least. @type {Record<string, number[]>} */
const DASHES = {
  dash: [3, 3],
  dot: [1, 1],
  dashdot: [3, 1, 1, 1],
  longdash: [5, 5],
  longdashdot: [5, 2, 1, 2],
};
const LEAST_DASH = 3;

/** @typedef {import("./svg-pen.js").Pen} Pen */
/** @typedef {import("./axis.js").Axis} Axis */
/** @typedef {import("./inks.js").Inks} Inks */
/** Places of the points of a trace in the picture [pixels]. @typedef {{x: Float64Array, y: Float64Array}} Places */

/** Parts of a dash [pixels]. @param {string | undefined} dash @param {number} width of the line */
export function dashOf(dash, width) {
  return (DASHES[dash ?? ""] ?? []).map((part) => part * Math.max(LEAST_DASH, width));
}

/**
 * Draws the line through the points of a trace; after a gap it begins anew.
 * @param {Pen} pen
 * @param {any} line its colour, width and dash
 * @param {Places} places
 */
export function drawLine(pen, line, places) {
  const { x, y } = thinned(places);
  pen.strokeStyle = line.color;
  pen.lineWidth = line.width ?? WIDTH;
  pen.lineJoin = "round";
  pen.setLineDash(dashOf(line.dash, pen.lineWidth));
  pen.beginPath();
  for (let row = 0, isDown = false; row < x.length; row += 1) {
    const isThere = !Number.isNaN(x[row] + y[row]);
    if (isThere) pen[isDown ? "lineTo" : "moveTo"](x[row], y[row]);
    isDown = isThere;
  }
  pen.stroke();
  pen.setLineDash([]);
}

/** Points up to which a line is drawn through each of them. */
const ALL = 4000;
/** Width of a column within which points follow each other closely [pixels]. */
const COLUMN = 0.5;

/**
 * Points that show where a line passes: of those that follow each other within half a pixel across, the first, the last, the highest and the lowest.
 * @param {Places} places
 * @returns {{x: ArrayLike<number>, y: ArrayLike<number>}}
 */
export function thinned({ x, y }) {
  if (x.length <= ALL) return { x, y };
  /** @type {number[]} */
  const kept = [];
  for (let start = 0; start < x.length;) {
    const column = Math.floor(x[start] / COLUMN);
    let [lowest, highest, end] = [start, start, start];
    while (end + 1 < x.length && Math.floor(x[end + 1] / COLUMN) === column && !Number.isNaN(y[end + 1])) {
      end += 1;
      if (y[end] < y[lowest]) lowest = end;
      if (y[end] > y[highest]) highest = end;
    }
    const rows = [start, Math.min(lowest, highest), Math.max(lowest, highest), end];
    rows.forEach((row, order) => {
      if (order === 0 || row !== rows[order - 1]) kept.push(row);
    });
    start = end + 1;
  }
  return { x: kept.map((row) => x[row]), y: kept.map((row) => y[row]) };
}

/**
 * Ends of the colours of a trace: as given, or the least and the largest of its numbers.
 * @param {any} trace with cells or marks
 * @returns {[number, number] | null} null without a number
 */
export function colourEnds(trace) {
  const { zmin, zmax, marker } = trace;
  let [least, largest] = [Infinity, -Infinity];
  const reach = (/** @type {any} */ value) => {
    if (typeof value !== "number") return;
    if (value < least) least = value;
    if (value > largest) largest = value;
  };
  if (trace.z) for (const line of trace.z) line.forEach(reach);
  else if (Array.isArray(marker?.color)) marker.color.forEach(reach);
  const ends = [zmin ?? marker?.cmin ?? least, zmax ?? marker?.cmax ?? largest];
  return ends[0] <= ends[1] ? [ends[0], ends[1]] : null;
}

/**
 * Colours of the points of a trace.
 * @param {any} trace
 * @param {string} without colour of a point without a value
 * @returns {(row: number) => string}
 */
export function coloursOf(trace, without) {
  const { color, colorscale } = trace.marker ?? {};
  if (!Array.isArray(color)) return () => color ?? trace.line?.color ?? without;
  const colour = colourScale(colorscale, ...(colourEnds(trace) ?? [0, 1]));
  return (row) => {
    const own = color[row];
    if (typeof own === "string") return own;
    return typeof own === "number" ? colour(own) : without;
  };
}

/** Draws the symbols of a trace. @param {Pen} pen @param {any} trace @param {Places} places @param {Inks} inks */
export function drawSymbols(pen, trace, { x, y }, inks) {
  const { size = SYMBOL, symbol, line } = trace.marker ?? {};
  const colour = coloursOf(trace, inks.soft);
  for (let row = 0; row < x.length; row += 1) {
    if (Number.isNaN(x[row] + y[row])) continue;
    const named = Array.isArray(symbol) ? symbol[row] : symbol;
    const rim = Array.isArray(line?.color) ? line.color[row] : line?.color;
    drawSymbol(pen, named, x[row], y[row], size / 2, { colour: colour(row), rim, width: line?.width });
  }
}

/**
 * @param {Pen} pen
 * @param {string | number | undefined} symbol by name or number; open ones have a rim alone
 * @param {number} x @param {number} y @param {number} radius
 * @param {{colour: string, rim?: string, width?: number}} ink
 */
function drawSymbol(pen, symbol, x, y, radius, { colour, rim, width }) {
  const name = typeof symbol === "number" ? SYMBOLS[symbol % SYMBOLS.length] : (symbol ?? "circle");
  const isOpen = name.endsWith("-open");
  pen.beginPath();
  trail(pen, name.replace("-open", ""), x, y, radius);
  if (!isOpen) {
    pen.fillStyle = colour;
    pen.fill();
  }
  const isRimmed = isOpen || (rim !== undefined && width);
  if (!isRimmed) return;
  pen.strokeStyle = rim ?? colour;
  pen.lineWidth = width ?? 1;
  pen.stroke();
}

/** Path of a symbol. @param {Pen} pen @param {string} name @param {number} x @param {number} y @param {number} radius */
function trail(pen, name, x, y, radius) {
  if (name === "x-thin") {
    for (const [from, to] of [
      [-1, 1],
      [1, -1],
    ]) {
      pen.moveTo(x + from * radius, y - radius);
      pen.lineTo(x + to * radius, y + radius);
    }
    return;
  }
  const corners = CORNERS[name];
  if (!corners) return pen.arc(x, y, radius, 0, 2 * Math.PI);
  corners.forEach(([across, down], order) =>
    pen[order ? "lineTo" : "moveTo"](x + across * radius, y + down * radius),
  );
  pen.closePath();
}

const THIRD = 1 / 3;
/** Outline of a cross of radius one. @type {[number, number][]} */
const CROSS = [
  [-THIRD, -1],
  [THIRD, -1],
  [THIRD, -THIRD],
  [1, -THIRD],
  [1, THIRD],
  [THIRD, THIRD],
  [THIRD, 1],
  [-THIRD, 1],
  [-THIRD, THIRD],
  [-1, THIRD],
  [-1, -THIRD],
  [-THIRD, -THIRD],
];
/** Corners of symbols of radius one. @type {Record<string, [number, number][]>} */
const CORNERS = {
  square: [
    [-0.9, -0.9],
    [0.9, -0.9],
    [0.9, 0.9],
    [-0.9, 0.9],
  ],
  diamond: [
    [0, -1.3],
    [1.3, 0],
    [0, 1.3],
    [-1.3, 0],
  ],
  "triangle-up": [
    [0, -1.1],
    [1.1, 0.8],
    [-1.1, 0.8],
  ],
  "triangle-down": [
    [0, 1.1],
    [1.1, -0.8],
    [-1.1, -0.8],
  ],
  cross: CROSS,
  x: CROSS.map(([across, down]) => [(across - down) * 0.9, (across + down) * 0.9]),
};

/** Writes the words of a trace's points next to them. @param {Pen} pen @param {any} trace @param {Places} places @param {number} line height [pixels] */
export function drawWords(pen, trace, { x, y }, line) {
  const { color, size = WORD } = trace.textfont ?? {};
  const radius = (trace.marker?.size ?? SYMBOL) / 2 + APART;
  const font = pen.font;
  pen.font = font.replace(/[\d.]+px/, `${size}px`);
  for (let row = 0; row < x.length; row += 1) {
    const [side = "top", place = "center"] = String(trace.textposition?.[row] ?? "").split(" ");
    pen.fillStyle = Array.isArray(color) ? color[row] : color;
    pen.textAlign = place === "left" ? "right" : place === "right" ? "left" : "center";
    pen.textBaseline = "middle";
    const across = x[row] + (place === "left" ? -radius : place === "right" ? radius : 0);
    String(trace.text[row])
      .split("<br>")
      .forEach((words, order, all) => {
        const above = { bottom: 0, middle: all.length / 2 }[side] ?? all.length;
        const away = { bottom: radius, middle: 0 }[side] ?? -radius;
        const down = away + (order + 0.5 - above) * line;
        if (words.trim()) pen.fillText(words, across, y[row] + down);
      });
  }
  pen.font = font;
}

/** Draws the error bars of a trace. @param {Pen} pen @param {any} trace @param {Places} places @param {Axis} x @param {Axis} y */
export function drawErrors(pen, trace, places, x, y) {
  for (const [error, axis] of /** @type {[any, Axis][]} */ ([
    [trace.error_x, x],
    [trace.error_y, y],
  ])) {
    if (!error) continue;
    pen.strokeStyle = error.color ?? trace.line?.color;
    pen.lineWidth = error.thickness;
    pen.beginPath();
    for (let row = 0; row < places.x.length; row += 1) {
      const ends = errorEnds(error, row).map((end) =>
        axis.toPixel(trace[axis.isAcross ? "x" : "y"][row] + end),
      );
      const aside = (axis.isAcross ? places.y : places.x)[row];
      stroke(pen, axis.isAcross, ends, aside);
      for (const end of ends) stroke(pen, !axis.isAcross, [aside - CAP, aside + CAP], end);
    }
    pen.stroke();
  }
}

/** @param {Pen} pen @param {boolean} isAcross @param {number[]} ends @param {number} aside */
function stroke(pen, isAcross, [from, to], aside) {
  pen.moveTo(...placed(isAcross, from, aside));
  pen.lineTo(...placed(isAcross, to, aside));
}

/** Place by the distances along a direction and aside of it. @param {boolean} isAcross @param {number} along @param {number} aside @returns {[number, number]} */
export function placed(isAcross, along, aside) {
  return isAcross ? [along, aside] : [aside, along];
}

/**
 * Draws many points as small squares on whole pixels, which need no shades at their rims.
 * @param {Pen} pen
 * @param {any} trace
 * @param {Places} places
 * @param {Axis} x
 * @param {Axis} y
 * @param {Inks} inks
 */
export function drawDots(pen, trace, places, x, y, inks) {
  const scale = devicePixelRatio;
  const screen = document.createElement("canvas");
  Object.assign(screen, { width: Math.ceil(x.length * scale), height: Math.ceil(y.length * scale) });
  const ground = /** @type {CanvasRenderingContext2D} */ (screen.getContext("2d"));
  const image = ground.createImageData(screen.width, screen.height);
  const pixels = new Uint32Array(image.data.buffer);
  const ink = pixelsOf(trace, inks.soft);
  const size = Math.max(1, Math.round(trace.marker.size * scale));
  for (let row = 0; row < places.x.length; row += 1) {
    if (Number.isNaN(places.x[row] + places.y[row])) continue;
    const left = Math.round((places.x[row] - x.offset) * scale - size / 2);
    const top = Math.round((places.y[row] - y.offset) * scale - size / 2);
    const [from, end] = [Math.max(0, left), Math.min(screen.width, left + size)];
    if (from >= end) continue;
    const pixel = ink(row);
    for (let line = Math.max(0, top); line < Math.min(screen.height, top + size); line += 1)
      pixels.fill(pixel, line * screen.width + from, line * screen.width + end);
  }
  ground.putImageData(image, 0, 0);
  pen.drawImage(screen, x.offset, y.offset, screen.width / scale, screen.height / scale);
}

/** Colours of the points of a trace as pixels of an image. @param {any} trace @param {string} without colour of a point without a value @returns {(row: number) => number} */
function pixelsOf(trace, without) {
  const { color, colorscale } = trace.marker;
  const other = pixelOf(mixedOf(Array.isArray(color) ? without : color));
  if (!Array.isArray(color)) return () => other;
  const table = pixelTable(colorscale);
  const [least, largest] = colourEnds(trace) ?? [0, 1];
  return (row) => (typeof color[row] === "number" ? table[tabled(color[row], least, largest)] : other);
}
