// Overview of a point above its views: string over depth, orbit, spectrum with causes, and rotation speed of the bit.

import { Problem } from "../data/api.js";
import { valueAtTime } from "../data/at-time.js";
import { causeOf, causeWords } from "../data/judgement.js";
import { chosenWindow, nodeInLink, nodeTables, windowTables } from "../data/motion-requests.js";
import { recordedAs } from "../data/statistics.js";
import { partsOf } from "../data/string-parts.js";
import { say, shown, unit } from "../data/units.js";
import { namedLines, seenDownhole, spectrumTrace } from "./orbit.js";
import { inks, LINES } from "./plots.js";
import { fill, h } from "../ui/dom.js";
import { link } from "../ui/router.js";
import { drawCurves, drawTrack, smallCanvas } from "./small-pictures.js";
import { partsInWords, recordedAt } from "./string-track.js";

/**
 * Data of a point that an overview shows.
 * @typedef {object} Shown
 * @property {any} point with a result
 * @property {URLSearchParams} query of the link
 * @property {() => Promise<any>} diagnosis with causes of spectral lines
 * @property {(name: string, query?: Record<string, any>) => Promise<any>} table a table of the point's result
 * @property {import("./time-cursor.js").TimeCursor} [time] at which histories are read; absent where no view below has it
 * @property {AbortSignal} signal
 */

/** Samples of a small picture. */
const SAMPLES = 1000;
/** Lines of the spectrum whose causes are named. */
const CAUSES = 3;
/** Width from which the overview is open [pixels]. */
const WIDE = 700;

/**
 * Recorded node with the largest orbit size, unless the link names one.
 * @param {any} point
 * @param {URLSearchParams} query of the link
 * @returns {string} as links name it; empty if no node was recorded
 */
export function overviewNode({ scenario, summary }, query) {
  const { nodes } = scenario.recording;
  const names = nodes.map(nodeInLink);
  const asked = query.get("node") ?? "";
  if (names.includes(asked)) return asked;
  const sizes = names.map((/** @type {string} */ name) =>
    Number(summary[`orbit_radius_rms_${name.replace(".", "_")}`] ?? 0),
  );
  return names[sizes.indexOf(Math.max(...sizes))] ?? "";
}

export class Overview {
  #context;
  #node;
  #window;
  #tiles;
  #place;
  /** Paints the pictures that have the time cursor anew. @type {Map<string, () => void>} */
  #timed = new Map();
  element;

  /** @param {Shown} context @param {string[]} place of the point in links */
  constructor(context, place) {
    const { point, query } = context;
    this.#context = context;
    this.#place = place;
    this.#node = overviewNode(point, query);
    this.#window = chosenWindow(point, query);
    const tile = (/** @type {string} */ name, /** @type {string} */ view, size = "") => {
      const [picture, caption] = [smallCanvas(name, size), h("span", { class: "small soft" })];
      const element = h(
        "a",
        { class: `tile ${size}`, href: this.#to(view), "data-view": view, hidden: true },
        h("strong", {}, name),
        picture,
        caption,
      );
      return { element, picture, caption };
    };
    this.#tiles = {
      track: tile("String over depth", "profiles", "tall"),
      orbit: tile("Orbit", "motion"),
      spectrum: tile("Full spectrum", "motion"),
      bit: tile("Rotation speed of the bit", "motion"),
    };
    this.element = h(
      "details",
      { class: "panel overview", open: innerWidth >= WIDE, ontoggle: () => void this.draw() },
      h("summary", {}, "Overview"),
      h(
        "div",
        { class: "tiles" },
        Object.values(this.#tiles).map(({ element }) => element),
      ),
    );
  }

  /** @param {string} view @param {Record<string, string>} [choices] of the link @returns {string} link to a view of the node that is shown */
  #to(view, choices = {}) {
    return link(this.#place, { ...choices, view, ...(this.#node ? { node: this.#node } : {}) });
  }

  /** Takes choices of the link over into the links of the pictures. @param {Record<string, string>} choices */
  follow(choices) {
    for (const { element } of Object.values(this.#tiles))
      element.setAttribute("href", this.#to(element.dataset.view ?? "", choices));
  }

  /** Paints a picture, and again when the time cursor moves, once a frame. @param {string} name @param {(time: number | null) => void} paint */
  #paintTimed(name, paint) {
    const { time, signal } = this.#context;
    paint(time?.time ?? null);
    if (!time) return;
    const isNew = !this.#timed.size;
    this.#timed.set(name, () => paint(time.time));
    let isDue = false;
    if (!isNew) return;
    time.follow(() => {
      if (isDue) return;
      isDue = true;
      requestAnimationFrame(() => {
        isDue = false;
        for (const again of this.#timed.values()) again();
      });
    }, signal);
  }

  /** Draws what the result has; a table that it lacks leaves its picture out. */
  async draw() {
    if (!this.element.open) return;
    const parts = [this.#drawTrack(), this.#drawMotion(), this.#drawBit()];
    await Promise.all(parts.map((part) => part.catch((error) => this.#leaveOut(error))));
  }

  /** @param {unknown} error */
  #leaveOut(error) {
    if (!(error instanceof Problem) && !this.#context.signal.aborted) throw error;
  }

  /** Shows a tile, which has its size from then on. @param {"track" | "orbit" | "spectrum" | "bit"} name @param {string} words */
  #show(name, words) {
    const { element, picture, caption } = this.#tiles[name];
    element.hidden = false;
    caption.textContent = words;
    return picture;
  }

  async #drawTrack() {
    const { point, table } = this.#context;
    if (!point.tables.includes("loads")) return;
    const { columns } = await table("loads", { fields: "node,measured_depth,side_force,orbit_radius_rms" });
    const parts = partsOf(point.scenario.string);
    const most = (/** @type {string} */ name) => say(name, Math.max(...columns[name].map(Math.abs)), 3);
    const nodes = recordedAt(point.scenario, columns);
    const words = `Depth in ${unit("measured_depth").symbol}. Blue: orbit size up to ${most("orbit_radius_rms")}; orange: side force up to ${most("side_force")}. Dots: recorded nodes.`;
    const picture = this.#show("track", words);
    picture.setAttribute("aria-label", `String over depth: ${partsInWords(parts)}`);
    drawTrack(picture, parts, {
      depths: columns.measured_depth,
      curves: [
        { values: columns.orbit_radius_rms, colour: LINES[0] },
        { values: columns.side_force, colour: LINES[1] },
      ],
      nodes,
    });
  }

  async #drawMotion() {
    const { point, table, query } = this.#context;
    if (!this.#node || !point.tables.includes("history")) return;
    const named = new URLSearchParams(query);
    named.set("node", this.#node);
    const [equilibrium] = nodeTables(point.scenario, named);
    const [cut, lines] = windowTables(point.scenario, named, this.#window);
    // The view of the motion sends for the same orbit; for a small picture alone a part of its samples is enough.
    if (query.get("view") !== "motion") cut[1].max_points = SAMPLES;
    const [statics, orbit, spectrum] = await Promise.all([
      table(...equilibrium),
      table(...cut),
      table(...lines),
    ]);
    this.#drawOrbit(statics.columns, orbit);
    await this.#drawSpectrum(spectrum);
  }

  /** @param {any} statics columns @param {any} orbit table */
  #drawOrbit(statics, { columns, attributes: { node, measured_depth } }) {
    const { point } = this.#context;
    const lowSide = statics.low_side_angle[statics.node.indexOf(node)];
    const { across, up } = seenDownhole(columns.u, columns.v, lowSide);
    const size = point.summary[`orbit_radius_rms_${recordedAs(point.scenario, node, measured_depth)}`];
    const words = `At ${say("measured_depth", measured_depth)}, looking downhole, in ${unit("radius").symbol}${size ? `; ${say("radius", size, 3)} rms` : ""}.`;
    const [x, y] = [shown("radius", across), shown("radius", up)];
    const picture = this.#show("orbit", words);
    const orbit = { x, y, colour: LINES[0] };
    this.#paintTimed("orbit", (time) => {
      const place = time === null ? [null, null] : [x, y].map((one) => valueAtTime(columns.time, one, time));
      const dot = { x: [place[0]], y: [place[1]], colour: inks().text, isDots: true };
      drawCurves(picture, place.includes(null) ? [orbit] : [orbit, dot], { isEqual: true });
    });
  }

  /** @param {any} spectrum table */
  async #drawSpectrum(spectrum) {
    const lines = namedLines(spectrum).slice(0, CAUSES);
    const trace = spectrumTrace(spectrum, {});
    const symbol = unit("amplitude").symbol;
    const marks = {
      x: lines.map(({ frequency }) => frequency),
      y: shown(
        "amplitude",
        lines.map(({ amplitude }) => amplitude),
      ),
    };
    const picture = this.#show("spectrum", `Frequencies in Hz, amplitudes in ${symbol}.`);
    const curves = [
      { x: trace.x, y: trace.y, colour: LINES[0] },
      { ...marks, colour: LINES[1], isDots: true },
    ];
    drawCurves(picture, curves, { isFromZero: true });
    const diagnosis = await this.#context.diagnosis().catch(() => ({ lines: [] }));
    const { node, resolution } = spectrum.attributes;
    const causes = lines.map(({ frequency }) => {
      const line = causeOf(diagnosis.lines, { node, frequency, resolution, window: this.#window });
      return `${say("frequency", frequency, 3)}${line?.cause ? `: ${causeWords(line)}` : ""}`;
    });
    fill(
      this.#tiles.spectrum.caption,
      causes.map((text) => h("span", { class: "cause" }, text)),
    );
  }

  async #drawBit() {
    const { point, table, query } = this.#context;
    // The service would refuse, which the browser writes of.
    if (!point.tables.includes("history")) return;
    const [statics, sample] = await Promise.all([
      table(...nodeTables(point.scenario, query)[0]),
      table("history", { max_points: 1 }),
    ]);
    const node = statics.columns.node.at(-1);
    const speed = `rotation_speed_${node}`;
    if (!(speed in sample.columns)) return;
    const fields = `time,${speed}`;
    const { columns } = await table("history", {
      node,
      ...this.#window,
      fields,
      max_points: SAMPLES,
      decimation: "minmax",
    });
    const { rotation_speed_rpm } = point.scenario.operation;
    const imposed = (rotation_speed_rpm * Math.PI) / 30;
    const values = columns[speed].filter((/** @type {number | null} */ value) => value !== null);
    const [least, largest] = [Math.min(...values), Math.max(...values)];
    const words = `${say("rotation_speed", least, 3)} to ${say("rotation_speed", largest, 3)} over time in s; dashed: imposed, ${say("rotation_speed", imposed, 3)}.`;
    const curve = { x: columns.time, y: shown("rotation_speed", columns[speed]), colour: LINES[0] };
    const level = Number(shown("rotation_speed", [imposed])[0]);
    const picture = this.#show("bit", words);
    this.#paintTimed("bit", (time) => drawCurves(picture, [curve], { level, at: time ?? undefined }));
  }
}
