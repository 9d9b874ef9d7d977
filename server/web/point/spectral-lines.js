// The highest lines of a spectrum, with the modes of the equilibrium next to them.

import { get } from "../data/api.js";
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
      h("th", {}, "Is"),
      h("th", {}, "Mode"),
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
    const { text, isHarmonic } = this.#kindOf(frequency);
    const bias = this.#biasOf(frequency);
    return h(
      "tr",
      {},
      h("td", { class: "number" }, say("frequency", frequency) + bias("line_frequency_hz")),
      h("td", {}, whirl),
      h("td", { class: "number" }, say("amplitude", amplitude) + bias("line_amplitude")),
      h("td", {}, text),
      h("td", isHarmonic ? {} : { "data-frequency": frequency }, isHarmonic ? "" : "…"),
    );
  }

  /**
   * The base of which a line is a multiple: the rotation, or else the highest line.
   * @param {number} frequency [Hz]
   */
  #kindOf(frequency) {
    const { resolution } = this.#spectrum.attributes;
    const { operation } = this.#context.point.scenario;
    const turns = multiple(frequency, operation.rotation_speed_rpm / 60, resolution, "rotation");
    const highest = Math.abs(namedLines(this.#spectrum)[0].frequency);
    const harmonic =
      Math.abs(frequency) > 1.5 * highest
        ? multiple(frequency, highest, resolution, say("frequency", highest))
        : "";
    return { text: turns || harmonic, isHarmonic: harmonic !== "" };
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

  /** Shows modes next to the lines, once they are found. */
  async drawModes() {
    const spectrum = this.#spectrum;
    const found = await this.#modesUpTo(this.#choices.modesUpTo);
    if (this.#spectrum !== spectrum) return;
    for (const cell of /** @type {NodeListOf<HTMLElement>} */ (
      this.element.querySelectorAll("[data-frequency]")
    )) {
      const { mode, among } = modeOf(
        Number(cell.dataset.frequency),
        found.modes,
        spectrum.attributes.resolution,
      );
      if (among)
        fill(
          cell,
          h(
            "span",
            { class: "soft" },
            `among ${among.count} modes from ${say("frequency", among.from, 3)} to ${say("frequency", among.to, 3)}`,
          ),
        );
      else
        fill(
          cell,
          mode &&
            `${mode.kind}, ${say("frequency", mode.frequency_hz)}, ${mode.growth_rate > 0 ? "growing" : "decaying"}, most at ${say("measured_depth", mode.measured_depth)}`,
        );
    }
    fill(
      this.#about,
      found.problem ??
        `Next to a line stands the nearest mode about the equilibrium, within half the resolution and 1 % of the frequency. If modes are so dense that one would be as near by chance, only their number is shown. ${found.modes.length} modes were found up to ${say("frequency", found.complete_to_hz)}. Torque on bit is constant: stick-slip at the bit is not judged.`,
    );
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
