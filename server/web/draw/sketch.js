// A flat picture on a canvas: what is seen until the drawing library has been compiled, drawn from what the library is given. It has axes,
// values, colours and names, and does not answer to the mouse.

import { colourScale } from "./colours.js";
import { roundValues, tickText } from "./ticks.js";

const KINDS = new Set(["scatter", "dots", "bar", "heatmap", "contour"]);
/** Pixels between two ticks, about. */
const APART = { x: 90, y: 45 };
/** Part of a range that stays free beyond its values. */
const SPARE = 0.05;
/** Part of a category's place that its bars fill. */
const FILLED = 0.8;
/** Height of a line of text [pixels]. */
const LINE = 15;
/** Width of a bar of colours, with what stands beside it [pixels]. */
const BAR = 14,
  BESIDE = 70;

/**
 * An axis: the values at its ends (of a logarithmic one, their decimal logarithms), the pixels there, and its words where it has them.
 * @typedef {{own: any, isAcross: boolean, isLog: boolean, words: string[] | null, range: number[], pixels: number[]}} Axis
 */

/**
 * @param {HTMLElement} place
 * @param {any[]} traces
 * @param {any} layout complete
 * @param {{text: string, soft: string, line: string, panel: string}} inks
 * @returns {HTMLElement | null} the canvas, to be taken away; none where a picture is of another kind
 */
export function sketch(place, traces, layout, inks) {
  if (!traces.length || traces.some((trace) => !KINDS.has(trace.type))) return null;
  const canvas = document.createElement("canvas");
  canvas.className = "sketch";
  canvas.setAttribute("aria-hidden", "true");
  const [width, height, scale] = [place.clientWidth, place.clientHeight, devicePixelRatio];
  [canvas.width, canvas.height] = [width * scale, height * scale];
  const pen = canvas.getContext("2d");
  if (!pen) return null;
  pen.scale(scale, scale);
  pen.font = `${layout.font.size}px ${layout.font.family}`;

  /** @type {Map<string, Axis>} */
  const axes = new Map();
  for (const trace of traces) {
    for (const name of [trace.xaxis ?? "x", trace.yaxis ?? "y"]) {
      if (!axes.has(name)) axes.set(name, axisOf(name, layout, traces));
    }
  }
  const bar = traces
    .map((trace) => ({
      trace,
      bar: trace.marker?.colorbar ?? (trace.showscale === false ? undefined : trace.colorbar),
    }))
    .find((entry) => entry.bar);
  const names = layout.showlegend === false ? [] : traces.filter((trace) => trace.showlegend);
  const frame = frameOf(pen, [...axes.values()], layout, width, height, {
    hasBar: bar !== undefined,
    hasNames: names.length > 0,
  });
  for (const axis of axes.values()) axis.pixels = pixelsOf(axis, layout, frame);
  for (const axis of axes.values()) anchor(axis, axes.get(axis.own.scaleanchor));
  for (const axis of axes.values()) drawAxis(pen, axis, crossing(axis, axes), frame, inks);
  const bars = traces.filter((trace) => trace.type === "bar");
  for (const trace of traces)
    drawTrace(
      pen,
      trace,
      /** @type {Axis} */ (axes.get(trace.xaxis ?? "x")),
      /** @type {Axis} */ (axes.get(trace.yaxis ?? "y")),
      bars,
    );
  if (bar) drawBar(pen, bar.trace, bar.bar, frame, inks);
  drawNames(pen, names, frame, inks);
  place.append(canvas);
  return canvas;
}

/** @param {string} name such as `x2` @param {any} layout @param {any[]} traces @returns {Axis} */
function axisOf(name, layout, traces) {
  const own = layout[`${name[0]}axis${name.slice(1)}`] ?? {};
  const [isAcross, isLog] = [name[0] === "x", own.type === "log"];
  const mine = traces.filter((trace) => (trace[`${name[0]}axis`] ?? name[0]) === name);
  const all = mine.map((trace) => [...trace[name[0]]]);
  const words = all.flat().some((value) => typeof value === "string")
    ? [...new Set([...(own.categoryarray ?? []), ...all.flat()])].map(String)
    : null;
  const placed = (/** @type {any} */ value) =>
    words ? words.indexOf(String(value)) : isLog ? Math.log10(value) : value;
  let [least, largest] = [Infinity, -Infinity];
  const reach = (/** @type {number} */ value) => {
    if (!Number.isFinite(value)) return;
    [least, largest] = [Math.min(least, value), Math.max(largest, value)];
  };
  let isSpared = !isAcross;
  mine.forEach((trace, order) => {
    const isCells = trace.type === "heatmap" || trace.type === "contour";
    const isLength = trace.type === "bar" && isAcross === (trace.orientation === "h");
    if (isLength) reach(0);
    if (isCells) isSpared = false;
    if (trace.mode?.includes("markers") || isLength) isSpared = true;
    // A contour ends at its values.
    const cells = trace.type === "contour" ? NaN : isAcross ? trace.z?.[0]?.length : trace.z?.length;
    const places = all[order].filter((value) => value !== null).map(placed);
    for (const value of isCells ? edges(places, cells) : places) reach(value);
  });
  if (own.rangemode === "tozero" && !isLog) reach(0);
  if (!(least <= largest)) [least, largest] = [0, 1];
  const spare =
    (largest - least || Math.abs(least) || 1) * (isSpared ? SPARE : 0) + (largest === least ? 0.5 : 0);
  const range = own.range ?? (words ? [-0.5, words.length - 0.5] : [least - spare, largest + spare]);
  return {
    own,
    isAcross,
    isLog,
    words,
    range: own.autorange === "reversed" ? [...range].reverse() : range,
    pixels: [0, 1],
  };
}

/**
 * Ends of cells about their middles, where these are not ends themselves.
 * @param {number[]} values
 * @param {number} cells how many
 * @returns {number[]}
 */
function edges(values, cells) {
  if (values.length !== cells) return values;
  if (cells === 1) return [values[0] - 0.5, values[0] + 0.5];
  const between = values.slice(1).map((value, index) => (value + values[index]) / 2);
  return [2 * values[0] - between[0], ...between, 2 * values[cells - 1] - between[cells - 2]];
}

/**
 * Frame of the axes, with room for ticks, titles and the bar next to them.
 * @param {CanvasRenderingContext2D} pen @param {Axis[]} axes @param {any} layout
 * @param {number} width @param {number} height @param {{hasBar: boolean, hasNames: boolean}} beside
 */
function frameOf(pen, axes, layout, width, height, { hasBar, hasNames }) {
  const { l, r, t, b } = layout.margin;
  const side = (/** @type {Axis} */ axis) =>
    14 +
    Math.max(0, ...ticksOf(axis, height).map(({ text }) => pen.measureText(text).width)) +
    (linesOf(axis).length && LINE + 6);
  const of = (/** @type {(axis: Axis) => boolean} */ holds) => axes.filter(holds);
  const left = Math.max(l, ...of((axis) => !axis.isAcross && axis.own.side !== "right").map(side));
  const right =
    Math.max(r, ...of((axis) => axis.own.side === "right").map(side)) + (hasBar ? BAR + BESIDE : 0);
  const bottom = Math.max(b, ...of((axis) => axis.isAcross).map((axis) => 28 + LINE * linesOf(axis).length));
  return {
    left,
    top: hasNames ? Math.max(t, 2 * LINE) : t,
    right: width - right,
    bottom: height - bottom,
    width,
  };
}

/** @typedef {ReturnType<typeof frameOf>} Frame */

/** @param {Axis} axis @param {any} layout @param {Frame} frame */
function pixelsOf(axis, layout, frame) {
  const base = axis.own.overlaying
    ? (layout[axis.own.overlaying.replace(/^([xy])/, "$1axis")] ?? {})
    : axis.own;
  const [from, to] = base.domain ?? [0, 1];
  const [start, length] = axis.isAcross
    ? [frame.left, frame.right - frame.left]
    : [frame.bottom, frame.top - frame.bottom];
  return [start + from * length, start + to * length];
}

/** Gives two axes one scale, where one is anchored to the other. @param {Axis} axis @param {Axis | undefined} other */
function anchor(axis, other) {
  if (!other) return;
  const per = (/** @type {Axis} */ { pixels, range }) =>
    Math.abs((pixels[1] - pixels[0]) / (range[1] - range[0]));
  const least = Math.min(per(axis), per(other));
  for (const one of [axis, other]) {
    const middle = (one.pixels[0] + one.pixels[1]) / 2;
    const half = ((one.pixels[1] - one.pixels[0]) / 2) * (least / per(one));
    one.pixels = [middle - half, middle + half];
  }
}

/** Pixels of the axis that another one crosses. @param {Axis} axis @param {Map<string, Axis>} axes */
function crossing(axis, axes) {
  const crossed =
    axes.get(axis.own.anchor) ?? [...axes.values()].find((other) => other.isAcross !== axis.isAcross);
  return crossed ? crossed.pixels : [0, 0];
}

/** @param {Axis} axis @param {any} value */
function at({ words, isLog, range, pixels }, value) {
  const along = words ? words.indexOf(String(value)) : isLog ? Math.log10(value) : value;
  return pixels[0] + ((along - range[0]) / (range[1] - range[0])) * (pixels[1] - pixels[0]);
}

/** @param {Axis} axis @param {number} [length] in pixels */
function ticksOf(axis, length = Math.abs(axis.pixels[1] - axis.pixels[0])) {
  if (axis.words) return axis.words.map((text) => ({ value: /** @type {any} */ (text), text }));
  const [low, high] = [Math.min(...axis.range), Math.max(...axis.range)];
  if (axis.isLog) {
    const powers = Array.from(
      { length: Math.ceil(high) - Math.floor(low) + 1 },
      (_, index) => Math.floor(low) + index,
    );
    const values = powers.flatMap((power) =>
      (high - low > 2.5 ? [1] : [1, 2, 5]).map((digit) => digit * 10 ** power),
    );
    return values
      .filter((value) => Math.log10(value) >= low && Math.log10(value) <= high)
      .map((value) => ({ value, text: tickText(value) }));
  }
  return roundValues(
    low,
    high,
    axis.own.nticks ?? Math.max(2, length / APART[axis.isAcross ? "x" : "y"]),
  ).map((value) => ({ value, text: tickText(value) }));
}

/** The lines of a title. @param {Axis} axis @returns {string[]} */
function linesOf({ own }) {
  return String(own.title?.text ?? "")
    .split("<br>")
    .filter(Boolean);
}

/** @param {CanvasRenderingContext2D} pen @param {Axis} axis @param {number[]} crossed @param {Frame} frame @param {{text: string, line: string}} inks */
function drawAxis(pen, axis, crossed, frame, { text: ink, line }) {
  const { isAcross, own, pixels } = axis;
  const isRight = own.side === "right";
  const [start, end] = crossed;
  pen.lineWidth = 1;
  pen.strokeStyle = line;
  pen.fillStyle = ink;
  pen.textAlign = isAcross ? "center" : isRight ? "left" : "right";
  pen.textBaseline = isAcross ? "top" : "middle";
  let [widest, last] = [0, -Infinity];
  for (const { value, text } of ticksOf(axis)) {
    const place = at(axis, value);
    const { width } = pen.measureText(text);
    widest = Math.max(widest, width);
    pen.beginPath();
    pen.moveTo(...point(isAcross, place, start));
    pen.lineTo(...point(isAcross, place, own.showgrid === false ? start : end));
    pen.stroke();
    // A long word gives way to the one before.
    if (isAcross && place - width / 2 < last) continue;
    last = place + width / 2;
    pen.fillText(
      text,
      ...point(isAcross, place, isAcross ? start + 8 : isRight ? frame.right + 8 : start - 8),
    );
  }
  pen.textAlign = "center";
  const middle = (pixels[0] + pixels[1]) / 2;
  linesOf(axis).forEach((words, order) => {
    if (isAcross) return pen.fillText(words, middle, start + 14 + LINE * (order + 1));
    pen.save();
    pen.translate(isRight ? frame.right + widest + 24 : start - widest - 24, middle);
    pen.rotate(-Math.PI / 2);
    pen.fillText(words, 0, 0);
    pen.restore();
  });
}

/** @param {boolean} isAcross @param {number} along @param {number} aside @returns {[number, number]} */
function point(isAcross, along, aside) {
  return isAcross ? [along, aside] : [aside, along];
}

/** @param {CanvasRenderingContext2D} pen @param {any} trace @param {Axis} x @param {Axis} y @param {any[]} bars all traces of bars */
function drawTrace(pen, trace, x, y, bars) {
  pen.save();
  pen.beginPath();
  pen.rect(
    Math.min(...x.pixels),
    Math.min(...y.pixels),
    Math.abs(x.pixels[1] - x.pixels[0]),
    Math.abs(y.pixels[1] - y.pixels[0]),
  );
  pen.clip();
  if (trace.z) drawCells(pen, trace, x, y);
  else if (trace.type === "bar") drawBars(pen, trace, x, y, bars);
  else drawLine(pen, trace, x, y);
  pen.restore();
}

/** @param {CanvasRenderingContext2D} pen @param {any} trace @param {Axis} x @param {Axis} y */
function drawCells(pen, trace, x, y) {
  const colour = colourScale(trace.colorscale, trace.zmin, trace.zmax);
  const ends = (/** @type {Axis} */ axis, /** @type {any[]} */ values, /** @type {number} */ cells) =>
    edges(
      [...values].map((value) => at(axis, value)),
      cells,
    );
  const [across, up] = [ends(x, trace.x, trace.z[0]?.length ?? 0), ends(y, trace.y, trace.z.length)];
  const gap = trace.xgap ?? 0;
  trace.z.forEach((/** @type {(number | null)[]} */ row, /** @type {number} */ index) => {
    row.forEach((value, column) => {
      if (value === null || value === undefined) return;
      pen.fillStyle = colour(value);
      pen.fillRect(
        across[column] + gap / 2,
        up[index] - gap / 2,
        across[column + 1] - across[column] - gap,
        up[index + 1] - up[index] + gap,
      );
    });
  });
}

/** @param {CanvasRenderingContext2D} pen @param {any} trace @param {Axis} x @param {Axis} y @param {any[]} bars */
function drawBars(pen, trace, x, y, bars) {
  const isLying = trace.orientation === "h";
  const [words, lengths] = isLying ? [y, x] : [x, y];
  const [named, measured] = isLying ? ["y", "x"] : ["x", "y"];
  const step =
    (Math.abs(words.pixels[1] - words.pixels[0]) / Math.abs(words.range[1] - words.range[0])) * FILLED;
  pen.fillStyle = trace.marker.color;
  trace[named].forEach((/** @type {any} */ word, /** @type {number} */ index) => {
    const value = trace[measured][index];
    if (value === null) return;
    // Bars of one word stand beside each other.
    const group = bars.filter((other) => other[named].includes(word));
    const thick = step / group.length;
    const middle =
      at(words, word) + (isLying ? -1 : 1) * (group.indexOf(trace) - (group.length - 1) / 2) * thick;
    const [zero, end] = [at(lengths, 0), at(lengths, value)];
    if (isLying) pen.fillRect(zero, middle - thick / 2, end - zero, thick);
    else pen.fillRect(middle - thick / 2, zero, thick, end - zero);
  });
}

/** @param {CanvasRenderingContext2D} pen @param {any} trace @param {Axis} x @param {Axis} y */
function drawLine(pen, trace, x, y) {
  const count = Math.min(trace.x.length, trace.y.length);
  const has = (/** @type {number} */ index) => trace.x[index] !== null && trace.y[index] !== null;
  if (trace.mode.includes("lines")) {
    pen.strokeStyle = trace.line.color;
    pen.lineWidth = trace.line.width ?? 2;
    pen.setLineDash(dashes(trace.line.dash));
    pen.beginPath();
    for (let index = 0, isDown = false; index < count; index += 1) {
      // After a gap the line begins anew.
      if (has(index)) pen[isDown ? "lineTo" : "moveTo"](at(x, trace.x[index]), at(y, trace.y[index]));
      isDown = has(index);
    }
    pen.stroke();
    pen.setLineDash([]);
  }
  if (!trace.mode.includes("markers")) return;
  const { color, size = 6, symbol, colorscale, cmin, cmax } = trace.marker ?? {};
  const values = Array.isArray(color) ? color : null;
  const finite = values?.filter((value) => typeof value === "number") ?? [];
  const ends = (/** @type {(a: number, b: number) => number} */ of) =>
    finite.reduce((a, b) => of(a, b), finite[0]);
  const colour = colourScale(colorscale, cmin ?? ends(Math.min), cmax ?? ends(Math.max));
  for (let index = 0; index < count; index += 1) {
    if (!has(index) || (values && values[index] === null)) continue;
    const own = values && (typeof values[index] === "number" ? colour(values[index]) : values[index]);
    pen.fillStyle = pen.strokeStyle = own ?? color ?? trace.line?.color;
    if (trace.type === "dots") {
      pen.fillRect(at(x, trace.x[index]) - size / 2, at(y, trace.y[index]) - size / 2, size, size);
      continue;
    }
    pen.beginPath();
    pen.arc(at(x, trace.x[index]), at(y, trace.y[index]), size / 2, 0, 2 * Math.PI);
    if (symbol === "circle-open") pen.stroke();
    else pen.fill();
  }
}

/** @param {string | undefined} dash @returns {number[]} */
function dashes(dash) {
  return (
    { dash: [9, 9], dot: [3, 3], dashdot: [9, 3, 3, 3], longdash: [15, 15], longdashdot: [15, 3, 3, 3] }[
      dash ?? ""
    ] ?? []
  );
}

/** @param {CanvasRenderingContext2D} pen @param {any} trace @param {any} bar @param {Frame} frame @param {{text: string}} inks */
function drawBar(pen, trace, bar, frame, { text: ink }) {
  const values = trace.z ? trace.z.flat() : trace.marker.color;
  const finite = values.filter((/** @type {any} */ value) => typeof value === "number");
  const least =
    trace.zmin ??
    trace.marker?.cmin ??
    finite.reduce((/** @type {number} */ a, /** @type {number} */ b) => Math.min(a, b), Infinity);
  const largest =
    trace.zmax ??
    trace.marker?.cmax ??
    finite.reduce((/** @type {number} */ a, /** @type {number} */ b) => Math.max(a, b), -Infinity);
  if (!(least <= largest)) return;
  const colour = colourScale(trace.colorscale ?? trace.marker?.colorscale, least, largest);
  const left = frame.right + 16;
  const height = frame.bottom - frame.top;
  const up = (/** @type {number} */ value) =>
    frame.bottom - ((value - least) / (largest - least || 1)) * height;
  for (let row = 0; row < height; row += 1) {
    pen.fillStyle = colour(least + ((row + 0.5) / height) * (largest - least));
    pen.fillRect(left, frame.bottom - row - 1, BAR, 1.5);
  }
  pen.fillStyle = ink;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  const ticks = bar.tickvals ?? roundValues(least, largest, Math.max(2, height / APART.y));
  const texts = bar.ticktext ?? ticks.map(tickText);
  ticks.forEach((/** @type {number} */ value, /** @type {number} */ index) =>
    pen.fillText(texts[index], left + BAR + 5, up(value)),
  );
  pen.save();
  pen.translate(frame.width - 10, (frame.top + frame.bottom) / 2);
  pen.rotate(Math.PI / 2);
  pen.textAlign = "center";
  pen.fillText(bar.title?.text ?? "", 0, 0);
  pen.restore();
}

/** Draws the names of lines. @param {CanvasRenderingContext2D} pen @param {any[]} traces @param {Frame} frame @param {{text: string}} inks */
function drawNames(pen, traces, frame, { text: ink }) {
  let left = frame.left;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  for (const trace of traces) {
    const width = 40 + pen.measureText(trace.name).width;
    if (left + width > frame.width) return;
    pen.fillStyle = trace.line?.color ?? trace.marker?.color ?? ink;
    pen.fillRect(left, frame.top - 15, 22, 3);
    pen.fillStyle = ink;
    pen.fillText(trace.name, left + 28, frame.top - 13);
    left += width + 14;
  }
}
