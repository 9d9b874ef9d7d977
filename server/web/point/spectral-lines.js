// The highest lines of a spectrum with their causes.

import { get } from "../data/api.js";
import { causeOf, causeWords } from "../data/judgement.js";
import { recordedAs, spectrumWindow } from "../data/statistics.js";
import { say } from "../data/units.js";
import { modeOf, multiple, namedLines } from "../draw/orbit.js";
import { fill, h } from "../ui/dom.js";

/** @typedef {import("./part.js").PointContext} PointContext */
/** @typedef {import("./motion-choices.js").MotionChoices} MotionChoices */

export class SpectralLines {
  #context;
  #choices;
  #about = h("p", { class: "small soft", role: "status" });
  /** Table of the spectrum whose lines are shown. @type {any} */
  #spectrum;
  /** Modes of the equilibrium by the highest frequency, each requested once. @type {Map<number, Promise<any>>} */
  #modes = new Map();
  element = h("div", {});

  /** @param {PointContext} context @param {MotionChoices} choices */
  constructor(context, choices) {
    this.#context = context;
    this.#choices = choices;
  }

  /** @param {any} spectrum table with its peaks */
  draw(spectrum) {
    this.#spectrum = spectrum;
    const rows = namedLines(spectrum).map((line) => this.#row(line));
    const { resolution } = spectrum.attributes;
    const resolved = spectrum.attributes.resolved_hz ?? this.#context.point.summary.resolved_hz;
    const heads = [
      h("th", { class: "number" }, "Frequency"),
      h("th", {}, "Whirl"),
      h("th", { class: "number" }, "Amplitude"),
      h("th", {}, "Cause"),
    ];
    fill(
      this.element,
      h("h2", {}, "Lines of the spectrum"),
      h(
        "div",
        { class: "scroll", tabindex: "0", role: "region", "aria-label": "Lines, scrollable" },
        h("table", {}, h("thead", {}, h("tr", {}, heads)), h("tbody", {}, rows)),
      ),
      this.#about,
      h(
        "p",
        { class: "small soft" },
        `Resolution ${say("frequency", resolution)}.`,
        resolved ? ` The steps resolve up to ${say("frequency", resolved)}.` : "",
        " The line at zero, the mean position, is left out.",
      ),
    );
  }

  /** @param {{frequency: number, amplitude: number, whirl: string}} line */
  #row({ frequency, amplitude, whirl }) {
    const bias = this.#biasOf(frequency);
    return h(
      "tr",
      {},
      h("td", { class: "number" }, say("frequency", frequency) + bias("line_frequency_hz")),
      h("td", {}, whirl),
      h("td", { class: "number" }, say("amplitude", amplitude) + bias("line_amplitude")),
      h("td", { "data-frequency": frequency }, "…"),
    );
  }

  /**
   * The base of which a line is a multiple, the rotation or else the highest line; empty if it is none.
   * @param {number} frequency [Hz]
   */
  #multipleOf(frequency) {
    const { resolution } = this.#spectrum.attributes;
    const { operation } = this.#context.point.scenario;
    const turns = multiple(frequency, operation.rotation_speed_rpm / 60, resolution, "rotation");
    const highest = Math.abs(namedLines(this.#spectrum)[0].frequency);
    if (turns || Math.abs(frequency) <= 1.5 * highest) return turns;
    return multiple(frequency, highest, resolution, say("frequency", highest));
  }

  /**
   * Text next to a line: its bias, if it is the highest line of a window that the summary has.
   * @param {number} frequency [Hz]
   * @returns {(name: string) => string}
   */
  #biasOf(frequency) {
    const { point, bias } = this.#context;
    const { node, measured_depth, resolution } = this.#spectrum.attributes;
    const suffix = `_${recordedAs(point.scenario, node, measured_depth)}_w${spectrumWindow(point, this.#choices.window)}`;
    const summarised = point.summary[`line_frequency_hz${suffix}`];
    // The summary weights by Hann's window.
    const isIt =
      this.#choices.weighting === "hann" &&
      typeof summarised === "number" &&
      Math.abs(frequency - summarised) < resolution / 2;
    return (name) => (isIt ? bias(name + suffix) : "");
  }

  /** Shows the causes of the lines, once they are found. Modes are looked for only if a line has no cause in the diagnosis. */
  async drawCauses() {
    const spectrum = this.#spectrum;
    const diagnosis = await this.#context
      .diagnosis()
      .catch((error) => ({ lines: [], problem: error.message }));
    if (this.#spectrum !== spectrum) return;
    const left = this.#cells.filter((cell) => {
      const frequency = Number(cell.dataset.frequency);
      const line = this.#causeOf(frequency, diagnosis.lines);
      const text = line ? causeWords(line) : this.#multipleOf(frequency);
      if (text) cell.textContent = text;
      if (line) cell.title = `Found from ${say("time", line.window[0])} to ${say("time", line.window[1])}`;
      return !line;
    });
    const found = left.length ? await this.#modesUpTo(this.#choices.modesUpTo) : null;
    if (this.#spectrum !== spectrum) return;
    for (const cell of left) {
      const frequency = Number(cell.dataset.frequency);
      if (this.#multipleOf(frequency)) continue;
      const mode = modeOf(frequency, found.modes, spectrum.attributes.resolution);
      const words = mode
        ? `next to a mode: ${mode.kind}, ${say("frequency", mode.frequency_hz)}, ${mode.growth_rate > 0 ? "growing" : "decaying"}, most at ${say("measured_depth", mode.measured_depth)}`
        : "no cause found";
      fill(cell, h("span", { class: "soft" }, words));
    }
    fill(this.#about, diagnosis.problem, diagnosis.problem && " ", found?.problem ?? this.#aboutModes(found));
  }

  /** @param {any} found modes; null if none were looked for */
  #aboutModes(found) {
    const causes = "Causes are those of the point's diagnosis, over the scenario's windows of spectra.";
    if (!found) return causes;
    return `${causes} Next to other lines stands the nearest mode about the equilibrium, within half the resolution and 1 % of the frequency, unless modes are so dense that one would be as near by chance. ${found.modes.length} modes were found up to ${say("frequency", found.complete_to_hz)}.`;
  }

  /** Cells of the causes. @returns {HTMLElement[]} */
  get #cells() {
    return [.../** @type {NodeListOf<HTMLElement>} */ (this.element.querySelectorAll("[data-frequency]"))];
  }

  /**
   * Cause of a line by the diagnosis; null without one.
   * @param {number} frequency [Hz]
   * @param {import("../data/judgement.js").LineCause[]} lines of the diagnosis
   */
  #causeOf(frequency, lines) {
    const { node, resolution } = this.#spectrum.attributes;
    const line = causeOf(lines, { node, frequency, resolution, window: this.#choices.window });
    return line?.cause ? line : null;
  }

  /** @param {number} highest [Hz] @returns {Promise<any>} */
  #modesUpTo(highest) {
    const { path, signal } = this.#context;
    const known = this.#modes.get(highest);
    if (known) return known;
    const asked = get(`${path}/modes`, { to_hz: highest }, signal).catch((error) => {
      this.#modes.delete(highest);
      return { modes: [], problem: error.message };
    });
    this.#modes.set(highest, asked);
    return asked;
  }
}
