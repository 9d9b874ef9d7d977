// Choices of the motion of a node, as the link holds them, and the requests behind them.

import {
  chosenWindow,
  keptWindow,
  selectedNode,
  spectrumRange,
  spectrumWeighting,
} from "../data/motion-requests.js";
import { pythonNode } from "../ui/snippets.js";

/** Highest frequency up to which modes are computed [Hz]. */
const HIGHEST_MODE_HZ = 50;

/** A window of time [s]. @typedef {{from: number, to: number}} Window */

export class MotionChoices {
  /** @param {any} point @param {URLSearchParams} query of the link */
  constructor(point, query) {
    this.point = point;
    this.query = query;
    /** Part of the run of which histories are kept. */
    this.kept = keptWindow(point);
  }

  /** Query of the node. */
  get selector() {
    return selectedNode(this.point.scenario, this.query);
  }

  get window() {
    return chosenWindow(this.point, this.query);
  }

  /** Whether the motion fills the picture of the orbit, in place of the hole. */
  get isZoomed() {
    return (this.query.get("zoom") ?? "motion") === "motion";
  }

  get isLog() {
    return this.query.get("amplitude") === "log";
  }

  /** Highest frequency of the spectrum [Hz]. */
  get range() {
    return spectrumRange(this.query, this.point.scenario.recording.rate_hz);
  }

  /** Highest frequency of modes [Hz]. */
  get modesUpTo() {
    return Math.min(this.range, HIGHEST_MODE_HZ);
  }

  get weighting() {
    return spectrumWeighting(this.query);
  }

  /** Requests behind the view. @returns {import("./part.js").PartRequest} */
  request() {
    const { selector, window, weighting, range, modesUpTo } = this;
    const [whole, cut] = [pythonNode(selector), pythonNode(selector, window)];
    const windowed = { ...selector, ...window };
    return {
      asked: [
        { table: "history", query: selector },
        { table: "orbit", query: windowed },
        { table: "spectrum", query: { ...windowed, window: weighting, range_hz: range } },
        { table: "statistics", query: windowed },
        { table: "diagnosis", isDocument: true },
        { table: "modes", query: { to_hz: modesUpTo }, isDocument: true },
      ],
      python: [
        `history = point.history(${whole}).to_pandas()`,
        `orbit = point.orbit(${cut}).to_pandas()`,
        `spectrum = point.spectrum(${cut}, window="${weighting}", range_hz=${range}).to_pandas()`,
        `statistics = point.statistics(${cut}).to_pandas()`,
        `causes = [line["sentence"] for line in point.diagnosis()["lines"]]`,
        `modes = point.modes(to_hz=${modesUpTo})["modes"]`,
        `plot.orbit(point, ${cut})`,
        `plot.spectrum(point, ${cut}, window="${weighting}", range_hz=${range})`,
      ].join("\n"),
    };
  }
}
