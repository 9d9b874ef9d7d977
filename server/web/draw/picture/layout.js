// Places of a picture's parts: axes with room for their words, panels between them, and the bar of colours.

import { Axis } from "./axis.js";

/** Height of a line of text, length of a tick with the gap to its word, and free space beyond words [pixels]. */
export const [LINE, TICK, FREE] = [15, 8, 8];
/** Width of a bar of colours, and its distance from the panels [pixels]. */
export const [BAR, BAR_LEFT] = [14, 16];

/**
 * A plot of two axes; further axes may lie over it.
 * @typedef {{x: Axis, y: Axis, over: Axis[], traces: any[]}} Panel
 */
/** @typedef {{left: number, top: number, right: number, bottom: number, width: number, height: number}} Frame */
/**
 * Room that is needed next to the axes.
 * @typedef {{width: number, height: number, top: number, bar: number, measure: (text: string) => number}} Room
 */

/**
 * The axes of some traces; those that match have one range.
 * @param {any[]} traces
 * @param {any} layout complete
 * @param {any[]} [shown] traces that ranges are of; of an axis without any, all are
 * @returns {Map<string, Axis>} by name
 */
export function axesOf(traces, layout, shown = traces) {
  const names = new Set(traces.flatMap((trace) => [trace.xaxis ?? "x", trace.yaxis ?? "y"]));
  /** @type {Map<string, Axis>} */
  const axes = new Map();
  for (const name of names) {
    const own = layout[`${name[0]}axis${name.slice(1)}`] ?? {};
    const isMine = (/** @type {any} */ trace) => (trace[`${name[0]}axis`] ?? name[0]) === name;
    const seen = shown.filter(isMine);
    axes.set(name, new Axis(name, own, seen.length ? seen : traces.filter(isMine)));
  }
  for (const axis of axes.values()) {
    const group = matching(axis, axes);
    if (group.length < 2 || axis.own.range) continue;
    axis.whole = spanOf(group);
    axis.reset();
  }
  return axes;
}

/** Axes that have one range with another, itself among them. @param {Axis} axis @param {Map<string, Axis>} axes */
export function matching(axis, axes) {
  const base = axis.own.matches ?? axis.name;
  return [...axes.values()].filter((other) => (other.own.matches ?? other.name) === base);
}

/** Range of all of some axes, in the direction of the first. @param {Axis[]} axes @returns {[number, number]} */
function spanOf(axes) {
  const ends = axes.flatMap(({ whole }) => whole);
  const [least, largest] = [Math.min(...ends), Math.max(...ends)];
  return axes[0].whole[0] > axes[0].whole[1] ? [largest, least] : [least, largest];
}

/**
 * Panels of traces, each on its pair of axes; axes that lie over others belong to the panels of these.
 * @param {any[]} traces
 * @param {Map<string, Axis>} axes
 * @returns {Panel[]}
 */
export function panelsOf(traces, axes) {
  /** @type {Map<string, Panel>} */
  const panels = new Map();
  for (const trace of traces) {
    const [x, y] = [trace.xaxis ?? "x", trace.yaxis ?? "y"].map(
      (name) => /** @type {Axis} */ (axes.get(name)),
    );
    const [lowX, lowY] = [x, y].map((axis) => axes.get(axis.own.overlaying) ?? axis);
    const key = `${lowX.name} ${lowY.name}`;
    const panel = panels.get(key) ?? { x: lowX, y: lowY, over: [], traces: [] };
    panels.set(key, panel);
    panel.traces.push(trace);
    for (const axis of [x, y])
      if (axis !== panel.x && axis !== panel.y && !panel.over.includes(axis)) panel.over.push(axis);
  }
  return [...panels.values()];
}

/**
 * Puts axes at their places in a picture.
 * @param {Map<string, Axis>} axes
 * @param {Panel[]} panels
 * @param {any} layout complete
 * @param {Room} room
 * @returns {Frame}
 */
export function arrange(axes, panels, layout, room) {
  const frame = frameOf([...axes.values()], layout, room);
  for (const axis of axes.values()) {
    const [from, to] = (axes.get(axis.own.overlaying) ?? axis).own.domain ?? [0, 1];
    const [start, length] = axis.isAcross
      ? [frame.left, frame.right - frame.left]
      : [frame.top, frame.bottom - frame.top];
    // Domains count from the left and from the bottom.
    axis.offset = start + (axis.isAcross ? from : 1 - to) * length;
    axis.length = Math.max(1, (to - from) * length);
  }
  equalise(axes, panels);
  return frame;
}

/**
 * Frame about all panels, with room for ticks, titles, and what stands above and next to them.
 * @param {Axis[]} axes @param {any} layout @param {Room} room
 * @returns {Frame}
 */
function frameOf(axes, layout, { width, height, top, bar, measure }) {
  const margin = layout.margin;
  const above = Math.max(margin.t, top);
  const shown = axes.filter((axis) => axis.own.visible !== false);
  const partOf = (/** @type {Axis} */ { own: { domain: [from, to] = [0, 1] } }) => to - from;
  const titled = (/** @type {Axis} */ axis, /** @type {number} */ length) => {
    const lines = titleLines(axis, partOf(axis) * length, measure).length;
    return lines ? LINE * lines + FREE : 0;
  };
  const beside = (/** @type {Axis} */ axis) =>
    TICK +
    Math.max(0, ...axis.ticks(height).map(({ text }) => measure(text))) +
    titled(axis, height - above - margin.b) +
    FREE;
  const [across, up] = [shown.filter(({ isAcross }) => isAcross), shown.filter(({ isAcross }) => !isAcross)];
  const isRight = (/** @type {Axis} */ { own }) => own.side === "right";
  const outer = (/** @type {Axis} */ axis) => isOutermost(axis, axes);
  const left = Math.max(margin.l, ...up.filter((axis) => !isRight(axis) && outer(axis)).map(beside));
  const right = Math.max(margin.r, ...up.filter(isRight).map(beside)) + bar;
  const below = (/** @type {Axis} */ axis) => {
    const length = width - left - right;
    return TICK + wordsAcross(axis, partOf(axis) * length, measure).height + titled(axis, length) + 2;
  };
  const bottom = Math.max(margin.b, ...across.filter(outer).map(below));
  return { left, top: above, right: width - right, bottom: height - bottom, width, height };
}

/** Gap between words of an axis [pixels]. */
const GAP = 8;

/**
 * Words below an axis: in lines as wide as their places, or turned where a word is wider.
 * @param {Axis} axis
 * @param {number} length of the axis [pixels]
 * @param {(text: string) => number} measure
 * @returns {{lines: Map<string, string[]>, isTurned: boolean, height: number}} lines of each text
 */
export function wordsAcross(axis, length, measure) {
  const texts = axis.words ?? [];
  const room = length / Math.max(1, texts.length) - GAP;
  const lines = new Map(texts.map((text) => [text, linesWithin(text, room, measure)]));
  const widest = Math.max(0, ...[...lines.values()].flat().map(measure));
  if (widest > room && texts.length)
    return {
      lines: new Map(texts.map((text) => [text, [text]])),
      isTurned: true,
      height: Math.max(...texts.map(measure)),
    };
  const most = Math.max(1, ...[...lines.values()].map((one) => one.length));
  return { lines, isTurned: false, height: LINE * most };
}

/**
 * Lines of the title of an axis, about as long as the axis at most.
 * @param {Axis} axis
 * @param {number} length of the axis [pixels]
 * @param {(text: string) => number} measure
 * @returns {string[]}
 */
export function titleLines({ own }, length, measure) {
  return String(own.title?.text ?? "")
    .split("<br>")
    .filter(Boolean)
    .flatMap((line) => linesWithin(line, length + 2 * FREE, measure));
}

/** Lines of a text, none wider than a width but by a single word. @param {string} text @param {number} width @param {(text: string) => number} measure */
function linesWithin(text, width, measure) {
  /** @type {string[]} */
  const lines = [];
  for (const word of text.split(" ")) {
    const last = lines.at(-1);
    if (last !== undefined && measure(`${last} ${word}`) <= width)
      lines[lines.length - 1] = `${last} ${word}`;
    else lines.push(word);
  }
  return lines;
}

/** Whether an axis stands at the rim of the picture, and not between panels. @param {Axis} axis @param {Axis[]} axes */
function isOutermost({ own, isAcross }, axes) {
  const crossed = axes.find(({ name }) => name === own.anchor);
  return (crossed?.own.domain?.[0] ?? 0) === 0 || crossed?.isAcross === isAcross;
}

/** Gives axes that are tied together one number of pixels for a unit. @param {Map<string, Axis>} axes @param {Panel[]} panels */
function equalise(axes, panels) {
  const tied = panels.filter((panel) => isEqual(panel, axes));
  const group = new Set(tied.flatMap(({ x, y }) => [x, y]));
  const scale = Math.min(...[...group].map((axis) => axis.scale));
  for (const axis of group) {
    const length = (axis.length * scale) / axis.scale;
    axis.offset += (axis.length - length) / 2;
    axis.length = length;
  }
}

/** Whether a panel shows both directions by one scale. @param {Panel} panel @param {Map<string, Axis>} axes */
export function isEqual({ x }, axes) {
  return matching(x, axes).some((axis) => axis.own.scaleanchor);
}

/** The axis that another one stands on, by which it is placed. @param {Axis} axis @param {Panel[]} panels @param {Map<string, Axis>} axes */
export function crossedBy(axis, panels, axes) {
  const named = axes.get(axis.own.anchor);
  if (named) return named;
  const panel = panels.find(({ x, y, over }) => x === axis || y === axis || over.includes(axis));
  return axis.isAcross ? panel?.y : panel?.x;
}

/** Width of the place of an axis' numbers where it is dragged [pixels]. */
const STRIP = 40;

/**
 * Place of the numbers of an axis.
 * @param {Axis} axis
 * @param {Axis | undefined} crossed the axis that it stands on
 */
export function stripOf({ isAcross, own, offset, length }, crossed) {
  const [start, end] = crossed ? [crossed.offset, crossed.offset + crossed.length] : [0, 0];
  if (isAcross) return { left: offset, top: end, width: length, height: TICK + LINE };
  return { left: own.side === "right" ? end : start - STRIP, top: offset, width: STRIP, height: length };
}
