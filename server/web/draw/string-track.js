// The string over depth as a narrow picture: pipe, tool joints, collars, stabilizers and the bit, some by name.

import { depthOfRecorded } from "../data/motion-requests.js";
import { say, shown } from "../data/units.js";
import { inks, LINES } from "./plots.js";

/** @typedef {import("../data/string-parts.js").Part} Part */

/** Least distance between two names [pixels]. */
const LINE = 13;
/** Names of parts, and their rank if there is no room for all; tool joints have none. @type {Record<string, [string, number]>} */
const NAMES = {
  bit: ["bit", 0],
  stabilizer: ["stabilizer", 1],
  collar: ["collar", 2],
  drillpipe: ["drill pipe", 3],
};
/** Half widths of parts [pixels]. @type {Record<string, number>} */
export const HALF = { drillpipe: 3, tool_joint: 5, collar: 5, stabilizer: 9, bit: 8 };
/** Least lengths of parts that are always to be seen [pixels]. @type {Record<string, number>} */
export const LEAST = { stabilizer: 3, bit: 4 };
/** Width of a track with names, the middle of the string in it, and the size of its words [pixels]. */
export const TRACK = 96;
const [MIDDLE, WORDS] = [14, 11];
/** Axis of a track in a picture: an axis of pixels, which is not drawn. The axis of depth stands on it. */
export const AXIS = "x0";

/** Colour of a part in a theme. @param {Part["kind"]} kind */
export function inkOf(kind) {
  const { text, soft } = inks();
  return kind === "bit" || kind === "stabilizer" ? text : soft;
}

/**
 * Parts of the string that have a name, where there is room for it.
 * @param {Part[]} parts
 * @param {number} perMetre pixels
 * @returns {{name: string, part: Part, down: number}[]} place of the name below the top [pixels]
 */
export function namedParts(parts, perMetre) {
  /** @type {{name: string, part: Part, down: number}[]} */
  const kept = [];
  const joined = parts.filter(({ kind }) => kind in NAMES);
  // Of joints of pipe one name is enough.
  const single = joined.filter(
    (part, at) => part.kind !== "drillpipe" || joined.findIndex(({ kind }) => kind === "drillpipe") === at,
  );
  for (const part of single.sort((a, b) => NAMES[a.kind][1] - NAMES[b.kind][1])) {
    const down = ((part.from + part.to) / 2) * perMetre;
    if (kept.every((other) => Math.abs(other.down - down) >= LINE))
      kept.push({ name: NAMES[part.kind][0], part, down });
  }
  return kept.sort((a, b) => a.down - b.down);
}

/** Parts of a string in words. @param {Part[]} parts */
export function partsInWords(parts) {
  const deep = parts.filter(({ kind }) => kind !== "drillpipe" && kind !== "tool_joint");
  const pipe = parts.find(({ kind }) => kind === "drillpipe");
  const words = deep.map(({ kind, to }) => `${NAMES[kind][0]} to ${say("measured_depth", to)}`);
  return [pipe && "drill pipe", ...words].filter(Boolean).join(", ");
}

/**
 * The string as traces of a panel of a picture, on its axis `y` of depth: each kind of part as lines of its width.
 * @param {Part[]} parts
 * @param {number[]} nodes depths of recorded nodes [m]
 * @param {number} perMetre pixels, while the whole depth is shown
 * @returns {any[]}
 */
export function trackTraces(parts, nodes, perMetre) {
  const common = { type: "scatter", xaxis: AXIS, yaxis: "y", isSilent: true, showlegend: false };
  const depthsOf = (/** @type {number[]} */ depths) => shown("measured_depth", depths).map(Number);
  const kinds = /** @type {Part["kind"][]} */ (Object.keys(HALF));
  const lines = kinds.flatMap((kind) => {
    const least = (LEAST[kind] ?? 1) / perMetre;
    const pieces = parts.filter((part) => part.kind === kind);
    if (!pieces.length) return [];
    // A gap ends each piece.
    const y = pieces.flatMap(({ from, to }) => [...depthsOf([from, Math.max(to, from + least)]), null]);
    const x = y.map((depth) => (depth === null ? null : MIDDLE));
    return [
      { ...common, mode: "lines", name: kind, x, y, line: { color: inkOf(kind), width: 2 * HALF[kind] } },
    ];
  });
  const named = namedParts(parts, perMetre);
  const words = {
    ...common,
    mode: "text",
    name: "names",
    x: named.map(() => MIDDLE + HALF.stabilizer),
    y: depthsOf(named.map(({ part }) => (part.from + part.to) / 2)),
    text: named.map(({ name }) => name),
    textposition: named.map(() => "middle right"),
    textfont: { color: inks().text, size: WORDS },
  };
  return [...lines, words, ...(nodes.length ? [dotsAt(depthsOf(nodes), common)] : [])];
}

/** @param {number[]} y @param {any} common */
function dotsAt(y, common) {
  const marker = { size: 7, color: LINES[1], line: { width: 1, color: inks().panel } };
  return { ...common, mode: "markers", name: "recorded nodes", x: y.map(() => MIDDLE), y, marker };
}

/** The axis of a track at the left of a picture. @param {number} part of its width */
export function trackAxis(part) {
  return {
    [`${AXIS[0]}axis${AXIS.slice(1)}`]: {
      visible: false,
      isFixed: true,
      domain: [0, part],
      range: [0, TRACK],
      anchor: "y",
    },
  };
}

/** Depths of recorded nodes [m]. @param {any} scenario @param {any} statics columns of the equilibrium */
export function recordedAt({ recording, string }, statics) {
  return recording.nodes.flatMap((/** @type {import("../data/motion-requests.js").RecordedNode} */ one) => {
    const found = depthOfRecorded(one, string) ?? statics?.measured_depth[statics.node.indexOf(one.node)];
    return found === undefined ? [] : [found];
  });
}

/** Sentence about a track. @param {Part[]} parts */
export function sayTrack(parts) {
  return `At the left the string: ${partsInWords(parts)}.`;
}
