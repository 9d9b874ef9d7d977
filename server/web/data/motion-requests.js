// Requests for the motion of a recorded node. This module imports nothing, so that `preload.js` can use it before the other modules have run.

/** Samples in a picture: two for each pixel of a screen of usual width. */
const SHOWN = 2500;

/** Columns of the equilibrium that place a node along the hole and across it. */
export const ALONG = "node,measured_depth,low_side_angle,clearance";
/** The further columns for a picture in space. */
export const IN_SPACE = "north,east,true_vertical_depth,u,v";
/** Names and times of snapshots: one of a single node, so that its interval is that of all. */
export const TIMES = { node: 1, max_frames: 1 };

/** Frequencies up to which full spectra are shown [Hz]. */
const RANGES = ["5", "20", "50", "100"];

/**
 * A table of a point, and what is asked of it.
 * @typedef {[name: string, query: Record<string, any>]} Asked
 */

/**
 * Equilibrium and the whole orbit of a node.
 * @param {any} scenario
 * @param {URLSearchParams} query of the link
 * @returns {Asked[]}
 */
export function nodeTables(scenario, query) {
  return [
    ["statics", { fields: ALONG }],
    ["orbit", { ...selectedNode(scenario, query), max_points: SHOWN }],
  ];
}

/**
 * Tables that a string in motion needs before its snapshots; none if it has no snapshots.
 * @param {any} scenario
 * @returns {Asked[]}
 */
export function stringTables({ recording }) {
  if (!recording.snapshots) return [];
  return [
    ["snapshots", TIMES],
    ["statics", { fields: ALONG }],
    ["statics", { fields: IN_SPACE }],
  ];
}

/**
 * Orbit, full spectrum and statistics of a window.
 * @param {any} scenario
 * @param {URLSearchParams} query of the link
 * @param {{from: number, to: number}} window [s]
 * @returns {Asked[]}
 */
export function windowTables(scenario, query, { from, to }) {
  const node = selectedNode(scenario, query);
  return [
    ["orbit", { ...node, from, to, max_points: SHOWN }],
    [
      "spectrum",
      {
        ...node,
        from,
        to,
        window: spectrumWeighting(query),
        range_hz: spectrumRange(query, scenario.recording.rate_hz),
        peaks: 10,
      },
    ],
    ["statistics", { ...node, from, to }],
  ];
}

/**
 * The history of rotation speed and torque of a node.
 * @param {any} scenario
 * @param {URLSearchParams} query of the link
 * @param {number} node as the service numbers it
 * @returns {Asked}
 */
export function rotationTable(scenario, query, node) {
  return [
    "history",
    {
      ...selectedNode(scenario, query),
      fields: `time,rotation_speed_${node},torque_${node}`,
      max_points: SHOWN,
      decimation: "minmax",
    },
  ];
}

/** A recorded node, by number, measured depth or distance above the bit [m]. @typedef {{node?: number, depth?: number, above_bit?: number}} RecordedNode */

/**
 * Name of a recorded node in links: its number, or the depth or distance above the bit for which it is recorded.
 * @param {RecordedNode} recorded
 * @returns {string} such as `49`, `57.7m` or `12.5m_above_bit`
 */
export function nodeInLink({ node, depth, above_bit }) {
  if (node !== undefined) return String(node);
  return above_bit !== undefined ? `${above_bit}m_above_bit` : `${depth}m`;
}

/**
 * Measured depth for which a node is recorded [m]; undefined for one by number.
 * @param {RecordedNode} recorded
 * @param {{bit_depth?: number | null, sections: {count?: number, length: number}[]}} string
 */
export function depthOfRecorded({ depth, above_bit }, string) {
  if (above_bit === undefined) return depth;
  const whole = string.sections.reduce((sum, { count = 1, length }) => sum + count * length, 0);
  return (string.bit_depth ?? whole) - above_bit;
}

/**
 * The node of a link that was not recorded; empty if it was, or if the link names none.
 * @param {any} scenario
 * @param {URLSearchParams} query of the link
 */
export function unrecordedNode({ recording: { nodes } }, query) {
  const asked = query.get("node") ?? "";
  return nodes.some((/** @type {any} */ one) => nodeInLink(one) === asked) ? "" : asked;
}

/**
 * The recorded node that a link names, or the first, as it is requested from the service.
 * @param {any} scenario
 * @param {URLSearchParams} query of the link
 * @returns {{node: number} | {depth: number, nearest: true}}
 */
export function selectedNode({ recording: { nodes }, string }, query) {
  const named = nodes.find((/** @type {any} */ one) => nodeInLink(one) === query.get("node"));
  const asked = named ?? nodes[0];
  return asked?.node !== undefined
    ? { node: asked.node }
    : { depth: asked && depthOfRecorded(asked, string), nearest: true };
}

/**
 * The window that a link names, or the one of the point's statistics.
 * @param {any} point
 * @param {URLSearchParams} query of the link
 * @returns {{from: number, to: number}} [s]
 */
export function chosenWindow(point, query) {
  const { scenario } = point;
  const usual = verifiedWindow(point);
  const from = Number(query.get("from") ?? usual.from);
  const to = Number(query.get("to") ?? usual.to);
  return from >= 0 && to > from
    ? { from, to: Math.min(to, scenario.duration) }
    : { from: usual.from, to: usual.to };
}

/** The longest window of which the histories of a run that settles are kept [s]. */
const LONGEST_KEPT = 80;

/**
 * The window of a point's statistics, which verifying looks at: what its result reports, the scenario's own, or the last third of the run.
 * @param {any} point
 * @returns {{from: number, to: number}} [s]
 */
export function verifiedWindow({ scenario: { recording, duration }, summary }) {
  if (recording.orbit_window === "settled" && summary?.statistics_to !== undefined)
    return {
      from: Math.max(summary.statistics_from, summary.statistics_to - LONGEST_KEPT),
      to: summary.statistics_to,
    };
  return recording.orbit_window?.to !== undefined
    ? recording.orbit_window
    : { from: (duration * 2) / 3, to: duration };
}

/**
 * The part of a run of which histories are kept: all of it, or of a run that settles the window of its statistics.
 * @param {any} point
 * @returns {{from: number, to: number}} [s]
 */
export function keptWindow(point) {
  return point.scenario.recording.orbit_window === "settled"
    ? verifiedWindow(point)
    : { from: 0, to: point.scenario.duration };
}

/** Weighting of a spectrum's samples, from the link. @param {URLSearchParams} query */
export function spectrumWeighting(query) {
  return query.get("window") === "rectangular" ? "rectangular" : "hann";
}

/**
 * The frequencies up to which a spectrum can be shown: as far as samples at a rate have any.
 * @param {number} rate [Hz]
 */
export function rangesOf(rate) {
  return RANGES.filter((text) => Number(text) <= rate / 2);
}

/**
 * Highest frequency of a spectrum, from the link [Hz].
 * @param {URLSearchParams} query
 * @param {number} rate of the samples [Hz]
 */
export function spectrumRange(query, rate) {
  const offered = rangesOf(rate);
  return Number(
    offered.find((text) => text === query.get("range")) ??
      (offered.includes("20") ? "20" : (offered.at(-1) ?? rate / 2)),
  );
}
