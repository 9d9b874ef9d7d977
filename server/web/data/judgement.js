// Classes of points by their loads, and the numbers that a point is judged by.

import { say, wordsOfColumn } from "./units.js";

/** Classes of points with their colours, the most severe first. */
export function classes() {
  return wordsOfColumn("class");
}

/** Finding of a diagnosis. @typedef {{class: string, sentence: string, evidence: Record<string, any>}} Finding */

/** Spectral line of a diagnosis. @typedef {{node: number, window: [number, number], frequency_hz: number, sentence: string, cause?: any}} LineCause */

/** Rank of a class, 0 the most severe; an unknown class comes last. @param {string} name */
export function rankOf(name) {
  const rank = classes().findIndex(({ word }) => word === name);
  return rank < 0 ? classes().length : rank;
}

/** Name of a class in words. @param {string} name */
export function classWords(name) {
  return name.replaceAll("_", " ");
}

/** Numbers of a point's headline: columns of its summary with short labels. @type {[string, string][]} */
const HEADLINE = [
  ["bit_stick_slip_severity", "Stick-slip severity of the bit"],
  ["largest_lateral_acceleration_rms", "Largest lateral acceleration, rms"],
  ["largest_equivalent_stress", "Largest equivalent stress"],
  ["largest_side_force", "Largest side force"],
  ["largest_orbit_size", "Largest orbit size"],
];

/**
 * Numbers of a point's headline in the reader's units, without those that its result lacks.
 * @param {Record<string, any>} summary
 * @returns {{column: string, text: string, value: string, place: string}[]} the place is empty if the number belongs to no depth
 */
export function headlineNumbers(summary) {
  return HEADLINE.filter(([column]) => typeof summary[column] === "number").map(([column, text]) => {
    const depth = summary[`${column}_depth`];
    return {
      column,
      text,
      value: say(column, summary[column], 3),
      place: typeof depth === "number" ? `at ${say("measured_depth", depth)}` : "",
    };
  });
}

/**
 * The line of a diagnosis that a line of a node's spectrum is: of the same sense of whirl, within half the resolution of the coarser window, and of a
 * window that overlaps the spectrum's, most of all.
 * @param {LineCause[]} lines
 * @param {{node: number, frequency: number, resolution: number, window: {from: number, to: number}}} line [Hz], [s]
 * @returns {LineCause | null}
 */
export function causeOf(lines, { node, frequency, resolution, window }) {
  const overlap = (/** @type {LineCause} */ { window: [from, to] }) =>
    Math.min(to, window.to) - Math.max(from, window.from);
  const distance = (/** @type {LineCause} */ line) => Math.abs(line.frequency_hz - frequency);
  const isIt = (/** @type {LineCause} */ line) =>
    line.node === node &&
    line.frequency_hz * frequency > 0 &&
    overlap(line) > 0 &&
    distance(line) <= Math.max(resolution, 1 / (line.window[1] - line.window[0])) / 2;
  const found = lines.filter(isIt).sort((a, b) => overlap(b) - overlap(a) || distance(a) - distance(b));
  return found[0] ?? null;
}

/** The cause of a line in words, without its frequency. @param {LineCause} line */
export function causeWords({ sentence }) {
  return sentence.replace(/^[+-][\d.]+ Hz: /, "");
}
