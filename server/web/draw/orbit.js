// An orbit as seen looking downhole, the low side down, and the full spectrum of one.

import { number, shown, title, unit } from "../data/units.js";
import { inks } from "./picture/inks.js";

/** Lines of a spectrum that are named in its picture. */
const NAMED = 6;

/**
 * Displacements across the hole and from the low side up, in served units.
 * Forward whirl, with the rotation of the string, goes clockwise.
 * @param {number[]} u
 * @param {number[]} v
 * @param {number} lowSide angle of the low side, from u towards v [rad]
 */
export function seenDownhole(u, v, lowSide) {
  const [cosine, sine] = [Math.cos(lowSide), Math.sin(lowSide)];
  return {
    across: u.map((value, index) => -(v[index] * cosine - value * sine)),
    up: u.map((value, index) => -(value * cosine + v[index] * sine)),
  };
}

/**
 * The orbit's trace, in the units in which it is shown.
 * @param {any} table with u and v
 * @param {number} lowSide
 * @param {any} line
 * @param {string} [name]
 */
export function orbitTrace(table, lowSide, line, name) {
  const { across, up } = seenDownhole(table.columns.u, table.columns.v, lowSide);
  return {
    type: "scatter",
    mode: "lines",
    x: shown("radius", across),
    y: shown("radius", up),
    line: { width: 0.9, ...line },
    name,
    showlegend: name !== undefined,
    describe: (/** @type {{x: number, y: number}} */ { x, y }) => `${number(x)}, ${number(y)}`,
  };
}

/**
 * The hole: a node on this circle touches the wall.
 * @param {number} clearance [m]
 * @param {string} [colour]
 */
export function holeTrace(clearance, colour = inks().soft) {
  const radius = Number(shown("radius", [clearance])[0]);
  const angles = Array.from({ length: 361 }, (_, degree) => (degree * Math.PI) / 180);
  return {
    type: "scatter",
    mode: "lines",
    x: angles.map((angle) => radius * Math.cos(angle)),
    y: angles.map((angle) => radius * Math.sin(angle)),
    line: { color: colour, width: 1.6 },
    isSilent: true,
    showlegend: false,
  };
}

/**
 * @param {boolean} isZoomed whether the motion fills the picture, in place of the hole
 * @param {any[]} traces of the orbits
 * @param {number} clearance [m]
 */
export function orbitLayout(isZoomed, traces, clearance) {
  const { symbol } = unit("radius");
  const radius = 1.08 * Number(shown("radius", [clearance])[0]);
  let [x, y] = [
    [-radius, radius],
    [-radius, radius],
  ];
  if (isZoomed) {
    const range = (/** @type {"x" | "y"} */ name) => {
      const values = traces.flatMap((trace) => [
        least(trace[name]),
        -least(trace[name].map((/** @type {number} */ value) => -value)),
      ]);
      return [Math.min(...values), Math.max(...values)];
    };
    const [across, up] = [range("x"), range("y")];
    const half = 0.56 * Math.max(across[1] - across[0], up[1] - up[0], radius * 1e-6);
    x = [(across[0] + across[1]) / 2 - half, (across[0] + across[1]) / 2 + half];
    y = [(up[0] + up[1]) / 2 - half, (up[0] + up[1]) / 2 + half];
  }
  return {
    xaxis: {
      title: `across the hole [${symbol}]`,
      quantity: "radius",
      range: x,
      scaleanchor: "y",
      constrain: "domain",
      zeroline: !isZoomed,
    },
    yaxis: {
      title: `from the low side up [${symbol}]`,
      quantity: "radius",
      range: y,
      constrain: "domain",
      zeroline: !isZoomed,
    },
  };
}

/** @param {number[]} values */
function least(values) {
  return values.reduce((a, b) => Math.min(a, b), Infinity);
}

/**
 * The spectrum's trace without the line at zero, the mean position, which would dwarf the others.
 * @param {any} table
 * @param {any} line
 * @param {string} [name]
 */
export function spectrumTrace(table, line, name) {
  // As wide as the line that any window makes of a mean.
  const mean = 2.5 * table.attributes.resolution;
  const amplitude = shown("amplitude", table.columns.amplitude).map((value, index) =>
    Math.abs(table.columns.frequency[index]) < mean ? null : value,
  );
  return {
    type: "scatter",
    mode: "lines",
    x: table.columns.frequency,
    y: amplitude,
    line: { width: 1, ...line },
    name,
    showlegend: name !== undefined,
    describe: (/** @type {{x: number, y: number}} */ { x, y }) => `${number(x)} Hz: ${number(y)}`,
  };
}

/**
 * The highest lines that the step resolves, without the mean.
 * @param {any} table
 * @returns {{frequency: number, amplitude: number, whirl: string}[]}
 */
export function namedLines(table) {
  return (table.attributes.peaks ?? [])
    .filter((/** @type {any} */ peak) => peak.whirl !== "offset" && peak.is_resolved !== false)
    .slice(0, NAMED);
}

/**
 * Marks at the named lines of a spectrum, at their frequencies and amplitudes interpolated between its samples.
 * @param {any} table
 * @param {any} marker
 */
export function peaksTrace(table, marker) {
  const lines = namedLines(table);
  return {
    type: "scatter",
    mode: "markers",
    x: lines.map(({ frequency }) => frequency),
    y: shown(
      "amplitude",
      lines.map(({ amplitude }) => amplitude),
    ),
    marker: { size: 6, ...marker },
    showlegend: false,
    describe: (/** @type {{x: number, y: number}} */ { x, y }) => `line at ${number(x)} Hz: ${number(y)}`,
  };
}

/**
 * Visibility of the wall in the picture of an orbit.
 * @param {{xaxis: {range: number[]}, yaxis: {range: number[]}}} layout of the orbit, in the units in which it is shown
 * @param {number} clearance [m]
 */
export function isWallSeen({ xaxis, yaxis }, clearance) {
  const radius = Number(shown("radius", [clearance])[0]);
  const nearest = (/** @type {number[]} */ [from, to]) => (from > 0 ? from : to < 0 ? -to : 0);
  const farthest = (/** @type {number[]} */ [from, to]) => Math.max(Math.abs(from), Math.abs(to));
  const [x, y] = [xaxis.range, yaxis.range];
  return Math.hypot(nearest(x), nearest(y)) <= radius && radius <= Math.hypot(farthest(x), farthest(y));
}

/**
 * Layout of full spectra: what the steps of one of them do not resolve is shaded, and the highest lines are named, with that of their
 * spectrum where it has one.
 * @param {{table: any, name?: string}[]} spectra
 * @param {boolean} isLog
 */
export function spectrumLayout(spectra, isLog) {
  const { soft } = inks();
  const resolved = Math.min(...spectra.map(({ table }) => table.attributes.resolved_hz ?? Infinity));
  const last = spectra.reduce(
    (most, { table }) =>
      table.columns.frequency.reduce(
        (/** @type {number} */ far, /** @type {number} */ value) => Math.max(far, Math.abs(value)),
        most,
      ),
    0,
  );
  const beyond =
    resolved < last
      ? [
          [resolved, last],
          [-last, -resolved],
        ]
      : [];
  const lines = spectra
    .flatMap(({ table, name = "" }) =>
      namedLines(table).map((line) => ({ ...line, of: name && `${name}: ` })),
    )
    .sort((a, b) => b.amplitude - a.amplitude);
  return {
    xaxis: { title: "frequency [Hz], backward − and forward + whirl", zerolinecolor: soft },
    yaxis: {
      title: title("amplitude"),
      quantity: "amplitude",
      type: isLog ? "log" : "linear",
      rangemode: isLog ? "normal" : "tozero",
    },
    shapes: beyond.map(([x0, x1]) => ({
      type: "rect",
      xref: "x",
      yref: "paper",
      x0,
      x1,
      y0: 0,
      y1: 1,
      fillcolor: "#e69f00",
      opacity: 0.15,
      line: { width: 0 },
    })),
    annotations: readable(lines, last).map((peak) => {
      const height = Number(shown("amplitude", [peak.amplitude])[0]);
      return {
        x: peak.frequency,
        y: height,
        text: `${peak.of}${peak.frequency > 0 ? "+" : "−"}${Math.abs(peak.frequency).toFixed(2)} Hz`,
        showarrow: false,
        yanchor: "bottom",
        xanchor: peak.frequency < 0 ? "right" : "left",
        font: { size: 11 },
      };
    }),
  };
}

/**
 * The lines whose names do not cover that of a higher one.
 * @template {{frequency: number, amplitude: number}} Line
 * @param {Line[]} peaks from the highest down
 * @param {number} last highest frequency of the picture [Hz]
 */
function readable(peaks, last) {
  /** @type {Line[]} */
  const kept = [];
  for (const peak of peaks) {
    const isCovered = kept.some(
      (other) =>
        Math.sign(other.frequency) === Math.sign(peak.frequency) &&
        Math.abs(other.frequency - peak.frequency) < 0.25 * last &&
        other.amplitude - peak.amplitude < 0.06 * peaks[0].amplitude,
    );
    if (!isCovered) kept.push(peak);
  }
  return kept;
}

/**
 * Names a line as a multiple, such as `2 × rotation`, if it is one to within half the resolution.
 * @param {number} frequency [Hz]
 * @param {number} base [Hz]
 * @param {number} resolution [Hz]
 * @param {string} name of the base
 */
export function multiple(frequency, base, resolution, name) {
  if (base <= 0) return "";
  const order = Math.round(Math.abs(frequency) / base);
  return order >= 1 && order <= 12 && Math.abs(Math.abs(frequency) - order * base) <= resolution / 2
    ? `${order} × ${name}`
    : "";
}

/** Part of a frequency within which a mode counts as that of a line, in addition to half the resolution: contacts that lift off shift lines. */
const NEAR = 0.01;
/** Half of the band about a line in which modes are counted: a part of its frequency, and so many times what is near. */
const [BAND, WIDER] = [0.25, 5];
/** Modes that may be near a line by chance, where one is named. */
const BY_CHANCE = 0.3;

/** @typedef {{frequency_hz: number, whirl: number, kind: string, growth_rate: number, measured_depth: number}} Mode */

/**
 * The mode that is nearest to a line and not of the other sense of whirl; null if none is near, or if modes are so dense that one is near any line by
 * chance.
 * @param {number} frequency [Hz], negative of backward whirl
 * @param {Mode[]} modes
 * @param {number} resolution [Hz]
 * @returns {Mode | null}
 */
export function modeOf(frequency, modes, resolution) {
  const line = Math.abs(frequency);
  const distance = (/** @type {Mode} */ mode) => Math.abs(mode.frequency_hz - line);
  // Motion to and fro has both senses.
  const alike = modes.filter((mode) => mode.whirl * frequency > -0.5 * line);
  const within = resolution / 2 + NEAR * line;
  const half = Math.max(BAND * line, WIDER * within);
  // Beyond the highest mode none were looked for.
  const highest = modes.reduce((most, mode) => Math.max(most, mode.frequency_hz), line);
  const [from, to] = [Math.max(0, line - half), Math.min(highest, line + half)];
  const count = alike.filter((mode) => mode.frequency_hz >= from && mode.frequency_hz <= to).length;
  const near = alike.filter((mode) => distance(mode) <= within);
  if (!near.length || (count * 2 * within) / (to - from) > BY_CHANCE) return null;
  return near.reduce((best, mode) => (distance(best) <= distance(mode) ? best : mode));
}
