// Choices of a comparison, which the link holds.

import { rangeOf } from "./side-by-side.js";
import { comparedRange, VIEWS } from "./views.js";

/** @typedef {import("./comparison.js").Compared} Compared */

export class Choices {
  /**
   * @param {string} view its name in the link
   * @param {URLSearchParams} query of the link, which changes with the choices
   * @param {Compared[]} points
   * @param {number[]} depths of the recorded nodes [m]
   */
  constructor(view, query, points, depths) {
    this.view = view;
    this.query = query;
    this.points = points;
    this.depths = depths;
  }

  /** Measured depth of the node [m]. */
  get depth() {
    const { query, depths } = this;
    const asked = Number(query.get("depth") ?? depths[Number(query.get("node") ?? 0)] ?? depths[0]);
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

  /** Window of time [s]; the last two thirds of the shortest run unless the link has another one. */
  get window() {
    const last = this.shortest;
    const [from, to] = [
      Number(this.query.get("from") ?? last / 3),
      Math.min(last, Number(this.query.get("to") ?? last)),
    ];
    return from >= 0 && to > from ? { from, to } : { from: last / 3, to: last };
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
