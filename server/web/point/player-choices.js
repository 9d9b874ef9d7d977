// Choices of strings in motion, as the link holds them.

import { MAGNIFICATIONS } from "../data/mean-motion.js";
import { label } from "../data/units.js";

/** Factors by which the string's distance from the axis of the hole is multiplied. */
export const EXAGGERATIONS = ["1", "20", "50", "100", "300", "1000"];
/** Simulated seconds in a second. */
export const SPEEDS = ["2", "1", "0.5", "0.25", "0.1", "0.02"];
/** Quantities that colour the string: a name of the vocabulary, and the source of its values. @type {[string, "snapshots" | "motion" | "profile"][]} */
const COLOURS = [
  ["normal_force", "snapshots"],
  ["orbit_radius_rms", "motion"],
  ["radius", "motion"],
  ["friction_coefficient", "profile"],
  ["effective_tension", "profile"],
  ["rotation_speed", "snapshots"],
  ["torque", "snapshots"],
];
/** Names that differ from the vocabulary's. @type {Record<string, string>} */
const CALLED = {
  normal_force: "contact force",
  orbit_radius_rms: "whirl amplitude",
  radius: "distance from the axis",
};

/** @typedef {NonNullable<Awaited<ReturnType<typeof import("../data/snapshots.js").snapshotsOf>>>} There */

/**
 * Strings of one clock: `heading` is empty if there is one, `statics` has the columns of the table.
 * @typedef {{context: import("./part.js").PointContext, heading: string, there: There, statics: any}[]} Strings
 */

/** @param {string} name of a quantity that colours the string */
export function colourName(name) {
  return CALLED[name] ?? label(name);
}

export class PlayerChoices {
  #strings;

  /** @param {Strings} strings of one clock and one link */
  constructor(strings) {
    this.#strings = strings;
    this.query = strings[0].context.query;
  }

  /** Whether the snapshots of all strings have a quantity. @param {string} name */
  has(name) {
    return this.#strings.every(({ there }) => there.names.includes(name));
  }

  /** Colours that can be chosen. */
  get offered() {
    return COLOURS.filter(([name, source]) => source !== "snapshots" || this.has(name));
  }

  get colour() {
    return this.offered.find(([name]) => name === this.query.get("colour")) ?? this.offered[0];
  }

  /** Factor by which the distance from the axis is multiplied. */
  get factor() {
    const asked = this.query.get("exaggerate") ?? "";
    return EXAGGERATIONS.includes(asked) ? Number(asked) : 100;
  }

  /** Factor by which the motion about the mean is multiplied on top of it; null for the one that suits the motion. */
  get magnification() {
    const asked = Number(this.query.get("motion"));
    return MAGNIFICATIONS.includes(asked) ? asked : null;
  }

  /** Whether a stripe shows the rotation. */
  get isStriped() {
    return this.has("theta_z") && this.query.get("stripe") !== "no";
  }

  get speed() {
    const asked = this.query.get("speed") ?? "";
    return SPEEDS.includes(asked) ? Number(asked) : 1;
  }

  /** Window of time [s]. */
  get span() {
    const windows = this.#strings.map(
      ({ context: { point } }) =>
        point.scenario.recording.snapshots.window ?? { from: 0, to: point.scenario.duration },
    );
    return this.#ordered(
      "from",
      "to",
      Math.min(...windows.map(({ from }) => from)),
      Math.max(...windows.map(({ to }) => to)),
    );
  }

  /** Depths that are shown [m]. */
  get depths() {
    return this.#ordered(
      "top",
      "bottom",
      0,
      Math.max(...this.#strings.map(({ statics }) => statics.measured_depth.at(-1))),
    );
  }

  /** Two numbers of the link in their order, or the whole. @param {string} lower @param {string} upper @param {number} least @param {number} largest */
  #ordered(lower, upper, least, largest) {
    const read = (/** @type {string} */ name, /** @type {number} */ usual) =>
      this.query.has(name) && Number.isFinite(Number(this.query.get(name)))
        ? Number(this.query.get(name))
        : usual;
    const [from, to] = [Math.max(least, read(lower, least)), Math.min(largest, read(upper, largest))];
    return from < to ? { from, to } : { from: least, to: largest };
  }
}
