// Choices of a comparison, which the link holds.

import { verifiedWindow } from "../data/motion-requests.js";
import { comparedWindow } from "../data/statistics.js";
import { number } from "../data/units.js";
import { rangeOf } from "./side-by-side.js";
import { comparedRange, VIEWS } from "./views.js";

/** @typedef {import("./comparison.js").Compared} Compared */

export class Choices {
  /**
   * @param {string} view its name in the link
   * @param {URLSearchParams} query of the link, which changes with the choices
   * @param {Compared[]} points
   * @param {import("./points.js").RecordedDepths} recorded
   */
  constructor(view, query, points, { depths, byNode }) {
    this.view = view;
    this.query = query;
    this.points = points;
    this.depths = depths;
    this.byNode = byNode;
  }

  /** Measured depth of the node [m]. */
  get depth() {
    const { query, depths, byNode } = this;
    // A view of a point names its node.
    const asked = Number(query.get("depth") ?? byNode.get(query.get("node") ?? "") ?? depths[0]);
    return Number.isFinite(asked) ? asked : depths[0];
  }

  /** Query of each point's recorded node that is nearest to the depth. */
  get node() {
    return { depth: this.depth, nearest: true };
  }

  /** End of the shortest run [s]. */
  get shortest() {
    return Math.min(...this.points.map((point) => point.detail.scenario.duration));
  }

  /** Window of time [s]; the one of the points' statistics unless the link has another one. */
  get window() {
    const usual = comparedWindow(this.points.map(({ detail }) => detail));
    const [from, to] = [
      Number(this.query.get("from") ?? usual.from),
      Math.min(this.shortest, Number(this.query.get("to") ?? usual.to)),
    ];
    return from >= 0 && to > from ? { from, to } : { from: usual.from, to: usual.to };
  }

  /** Sentence about a window that is not the one of each point's statistics; empty if it is, or if the link chooses it. */
  get windowNote() {
    const { points, query } = this;
    const { from, to, isShared, isOverlap } = comparedWindow(points.map(({ detail }) => detail));
    if (isShared || query.has("from") || query.has("to")) return "";
    const own = points
      .filter(({ detail }) => detail.summary)
      .map((point) => `point ${point.number} ${sayWindow(verifiedWindow(point.detail))}`);
    return `The statistics in the tables are of different windows: ${own.join(", ")}. Compared here: ${sayWindow({ from, to })}, ${isOverlap ? "which all of them include" : "the last third of the shortest run"}.`;
  }

  /** Whether the view is drawn up to a chosen frequency. */
  get hasRange() {
    return this.view === "spectrum" || this.view === "spectrogram";
  }

  /** Highest frequency of the view [Hz]. */
  get range() {
    return this.view === "spectrum" ? comparedRange(this) : rangeOf(this);
  }

  get isWindowed() {
    return VIEWS[this.view].isWindowed ?? false;
  }

  get isOfNode() {
    return VIEWS[this.view].isOfNode ?? false;
  }

  /** Whether the view can be drawn: a view of a node needs a recorded one. */
  get isRecorded() {
    return !this.isOfNode || this.depths.length > 0;
  }
}

/** @param {{from: number, to: number}} window [s] */
function sayWindow({ from, to }) {
  return `${number(from)} to ${number(to)} s`;
}
