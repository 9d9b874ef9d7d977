// Samples of a map: dots at their places, their values while cells are large, and rings about the least and the largest.

import { number } from "../data/units.js";
import { BLACK, WHITE } from "./picture/colours.js";

/** Samples that have a dot, at most. */
const DOTTED = 900;
/** Cells at the rim, half as large, that have room for a printed value [pixels]. */
const ROOM = { across: 46, up: 24 };
/** Room next to and below the cells, for axes and the bar of colours [pixels]. */
const BESIDE = { across: 190, up: 80 };
/** Free part of a range beyond the samples, so that dots at the rim are seen whole. */
const SPARE = 0.03;
/** Samples that a least and a largest value stand out of. */
const FEWEST = 3;
const RING_PX = 22;

/**
 * A sample: its place in shown units, ranks of its values across and up, its value as it is printed, the ink that is seen on its cell, the
 * text under the mouse, and the key that a click finds.
 * @typedef {{x: number, y: number, column: number, row: number, value: number | null, ink: string, text: string, key: any}} Sample
 */

/**
 * Range of an axis that ends shortly beyond the samples; undefined for a single value.
 * @param {number[]} values in shown units
 * @param {boolean} isLog
 * @returns {[number, number] | undefined}
 */
export function sampledRange(values, isLog) {
  const [least, largest] = [Math.min(...values), Math.max(...values)];
  if (!(least < largest) || (isLog && least <= 0)) return undefined;
  const [from, to] = isLog ? [Math.log10(least), Math.log10(largest)] : [least, largest];
  const spare = (to - from) * SPARE;
  return isLog ? [10 ** (from - spare), 10 ** (to + spare)] : [from - spare, to + spare];
}

/**
 * Whether half cells at the rim have room for a value.
 * @param {HTMLElement} place of the picture, or a place that will have its size
 * @param {number} columns
 * @param {number} rows
 */
export function hasRoom({ clientWidth, clientHeight }, columns, rows) {
  const [width, height] = [clientWidth - BESIDE.across, clientHeight - BESIDE.up];
  return (
    width / (2 * Math.max(1, columns - 1)) >= ROOM.across && height / (2 * Math.max(1, rows - 1)) >= ROOM.up
  );
}

/**
 * The samples with the least and with the largest value; none of few samples, or of equal values.
 * @template {{value: number | null}} T
 * @param {T[]} samples
 * @returns {[T, T] | null}
 */
export function extremes(samples) {
  const found = samples.filter(({ value }) => value !== null);
  if (found.length < FEWEST) return null;
  const by = (/** @type {1 | -1} */ sign) =>
    found.reduce((best, one) => (sign * (Number(one.value) - Number(best.value)) < 0 ? one : best));
  const [least, largest] = [by(1), by(-1)];
  return least.value === largest.value ? null : [least, largest];
}

/**
 * Traces of dots and rings.
 * @param {Sample[]} samples
 * @param {HTMLElement} place of the picture
 * @returns {any[]}
 */
export function sampleTraces(samples, place) {
  const found = extremes(samples);
  return [
    ...(samples.length > DOTTED ? [] : [dots(samples, found ?? [], place)]),
    // About a ring one of the other ink: on the rim it lies on the cell and on the ground.
    ...(found ? [rings(found, haloOf, 5), rings(found, ({ ink }) => ink, 2.5)] : []),
  ];
}

/** The ink that is seen next to that of a sample. @param {Sample} sample */
function haloOf({ ink }) {
  return ink === WHITE ? BLACK : WHITE;
}

/** @param {Sample[]} samples @param {Sample[]} ringed @param {HTMLElement} place */
function dots(samples, ringed, place) {
  const [columns, rows] = [samples.map(({ column }) => column), samples.map(({ row }) => row)].map(
    (ranks) => Math.max(...ranks, 0) + 1,
  );
  const isPrinted = hasRoom(place, columns, rows);
  return {
    type: "scatter",
    mode: isPrinted ? "markers+text" : "markers",
    name: "samples",
    x: samples.map(({ x }) => x),
    y: samples.map(({ y }) => y),
    // Within the cell, which ends at the sample on the rim.
    text: isPrinted
      ? samples.map((sample) => printed(sample, sample.row === rows - 1, ringed.includes(sample)))
      : undefined,
    textposition: samples.map(
      ({ column, row }) =>
        `${row === rows - 1 ? "bottom" : "top"} ${column === 0 ? "right" : column === columns - 1 ? "left" : "center"}`,
    ),
    textfont: { color: samples.map(({ ink }) => ink), size: 12 },
    hovertext: samples.map(({ text }) => text),
    customdata: samples.map(({ key }) => key),
    marker: {
      size: 6,
      color: samples.map(({ ink }) => ink),
      line: { width: 1, color: samples.map(haloOf) },
    },
    showlegend: false,
  };
}

/**
 * Value of a sample, a line away from its ring.
 * @param {Sample} sample @param {boolean} isBelow whether it is printed below the dot @param {boolean} isRinged
 */
function printed({ value }, isBelow, isRinged) {
  const text = value === null ? "" : number(value, 3);
  if (!isRinged) return text;
  return isBelow ? `<br>${text}` : `${text}<br> `;
}

/** @param {Sample[]} samples @param {(sample: Sample) => string} inkOf @param {number} width of the line [pixels] */
function rings(samples, inkOf, width) {
  return {
    type: "scatter",
    mode: "markers",
    name: "least and largest",
    x: samples.map(({ x }) => x),
    y: samples.map(({ y }) => y),
    isSilent: true,
    customdata: samples.map(({ key }) => key),
    marker: {
      size: RING_PX,
      symbol: "circle-open",
      color: samples.map(inkOf),
      line: { width, color: samples.map(inkOf) },
    },
    showlegend: false,
    cliponaxis: false,
  };
}
