// The motion of a recorded node: a window brushed in its history, and orbit, full spectrum and statistics of that window.

import { Problem } from "../data/api.js";
import { valueAtTime } from "../data/at-time.js";
import { nodeTables, rotationTable, windowTables } from "../data/motion-requests.js";
import { biasOver, FEWEST, orbitStatistics, recordedAs, STATISTICS } from "../data/statistics.js";
import { number, say, shown, unit } from "../data/units.js";
import { componentAt } from "../data/string-parts.js";
import { Brush, dragWindow } from "../draw/brush.js";
import {
  holeTrace,
  isWallSeen,
  orbitLayout,
  orbitTrace,
  peaksTrace,
  seenDownhole,
  spectrumLayout,
  spectrumTrace,
} from "../draw/orbit.js";
import { adjust, canvas, draw, LINES } from "../draw/plots.js";
import { timeDots, TimeLine } from "../draw/time-line.js";
import { debounced, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { MotionChoices } from "./motion-choices.js";
import { MotionControls } from "./motion-controls.js";
import { sayUnrecorded } from "./part.js";
import { SpectralLines } from "./spectral-lines.js";

/** Rest of a dragged window before its samples are requested. */
const REST_MS = 100;

/** @typedef {import("./part.js").PointContext} PointContext */
/** @typedef {import("./motion-choices.js").Window} Window */
/** Tables of a window: orbit, spectrum and statistics. @typedef {{cut: any, lines: any, statistics: any}} Windowed */

/**
 * @param {PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function motion(context) {
  if (!context.point.scenario.recording.nodes.length) {
    return {
      element: h("p", { class: "panel empty" }, "This point recorded no node."),
      draw: async () => {},
      request: () => null,
    };
  }
  const node = new NodeMotion(context);
  return { element: node.element, draw: () => node.redraw(), request: () => node.choices.request() };
}

class NodeMotion {
  #context;
  #controls;
  #lines;
  #pictures;
  #history = canvas("History of the node", "history", "low");
  #rotation = canvas("Rotation speed and torque of the node", "rotation", "low");
  #orbit = canvas("Orbit of the node", "orbit");
  #spectrum = canvas("Full spectrum of the node", "spectrum");
  #historyLine;
  #rotationLine;
  #rotationName = h("h2", {}, "Rotation speed and torque");
  #wall = h("span", {});
  #shaded = h("span", { hidden: true }, " Shaded: frequencies that the time steps do not resolve.");
  #statistics = h("div", {});
  #wrong = h("p", { class: "wrong", role: "alert" });
  #refused = h("p", { class: "panel empty", role: "alert", hidden: true });
  #beginNode = generations();
  #beginWindow = generations();
  /** Table of the equilibrium. @type {any} */
  #statics;
  /** Table of the node's orbit over the whole run. @type {any} */
  #whole;
  /** @type {Windowed | undefined} */
  #windowed;
  /** Parts of the orbit while a window is dragged. @type {Brush | null} */
  #brush = null;
  /** The window that is being dragged. @type {[number, number] | null} */
  #dragged = null;
  #rested;

  /** @param {PointContext} context */
  constructor(context) {
    const { point, query, signal } = context;
    this.#context = context;
    this.choices = new MotionChoices(point, query);
    this.#controls = new MotionControls(
      this.choices,
      (name, value) => this.#set(name, value),
      (from, to) => this.#choose(from, to),
    );
    this.#lines = new SpectralLines(context, this.choices);
    this.#historyLine = new TimeLine(this.#history, context.time, signal);
    this.#rotationLine = new TimeLine(this.#rotation, context.time, signal);
    timeDots(this.#orbit, context.time, (time) => this.#dotsAt(time), signal);
    this.#pictures = this.#picturesPart();
    this.#rested = debounced(() => this.#lookAtDragged(), REST_MS, signal);
    dragWindow(
      this.#history,
      (range) => this.#follow(range),
      (range) => this.#release(range),
      signal,
    );
    this.element = h("div", {}, this.#controls.element, this.#wrong, this.#refused, this.#pictures);
  }

  #picturesPart() {
    const panel = (
      /** @type {string} */ name,
      /** @type {HTMLElement} */ picture,
      /** @type {(string | HTMLElement)[]} */ ...caption
    ) =>
      h("div", { class: "panel" }, h("h2", {}, name), h("figure", {}, picture, h("figcaption", {}, caption)));
    return h(
      "div",
      {},
      panel(
        "Displacement",
        this.#history,
        "Drag across the history to choose a window; orbit, spectrum and statistics follow. Select a place, or drag the knob on the axis, for the time at which all views are read: a dot shows it on the orbit.",
        this.#historyLine.reading,
      ),
      h("div", { style: "height:1rem" }),
      h(
        "div",
        { class: "half" },
        panel(
          "Orbit, looking downhole",
          this.#orbit,
          "The low side is down, the axis of the hole at zero; forward whirl goes clockwise. ",
          this.#wall,
        ),
        panel(
          "Full spectrum",
          this.#spectrum,
          "Dots: the highest lines, interpolated between the frequencies of the spectrum.",
          this.#shaded,
        ),
        h("div", { class: "panel" }, this.#statistics),
        h("div", { class: "panel" }, this.#lines.element),
      ),
      h("div", { style: "height:1rem" }),
      h(
        "div",
        { class: "panel" },
        this.#rotationName,
        h("figure", {}, this.#rotation, this.#rotationLine.reading),
      ),
    );
  }

  /** Place of the node in its orbit at a time: from the samples of the window, or else from those of the whole history. @param {number} time */
  #dotsAt(time) {
    const tables = this.#dragged ? [] : [this.#windowed?.cut, this.#whole];
    for (const table of tables) {
      if (!table) continue;
      const { columns } = table;
      const [u, v] = [columns.u, columns.v].map((values) => valueAtTime(columns.time, values, time));
      if (u === null || v === null) continue;
      const { across, up } = seenDownhole([u], [v], this.#place().lowSide);
      return [{ x: Number(shown("radius", across)[0]), y: Number(shown("radius", up)[0]) }];
    }
    return [];
  }

  /** Keeps a choice in the link and draws by it. @param {string} name @param {string} value */
  #set(name, value) {
    this.#context.keep({ [name]: value });
    if (name === "zoom") void this.#drawOrbit();
    else if (name === "amplitude") void this.#drawSpectrum();
    else attend(name === "node" ? this.redraw() : this.#drawWindow(), this.#context.signal);
  }

  /** Whether a window has samples enough for a spectrum. @param {number} from @param {number} to */
  #isEnough(from, to) {
    return (to - from) * this.#context.point.scenario.recording.rate_hz >= FEWEST;
  }

  /** Chooses a window. @param {number} from @param {number} to */
  #choose(from, to) {
    const { kept } = this.choices;
    const first = Math.max(kept.from, Math.min(from, to));
    const last = Math.min(kept.to, Math.max(from, to));
    if (!this.#isEnough(first, last)) return void this.#drawOrbit();
    this.#context.keep({ from: String(Number(first.toFixed(4))), to: String(Number(last.toFixed(4))) });
    this.#controls.fillWindow();
    return attend(this.#drawWindow(), this.#context.signal);
  }

  /** @param {number} node @returns {string} its depth in words, if it is known */
  #depthOf(node) {
    const index = this.#statics?.columns.node.indexOf(node) ?? -1;
    if (index < 0) return "";
    const depth = this.#statics.columns.measured_depth[index];
    const component = this.#componentAt(depth);
    return `, ${say("measured_depth", depth)}${component && `, ${component}`}`;
  }

  /** @param {number} depth [m] */
  #componentAt(depth) {
    return componentAt(this.#context.point.scenario.string, depth);
  }

  /** Equilibrium of the node whose tables are shown. */
  #place() {
    const { columns } = this.#statics;
    const { node, measured_depth } = this.#whole.attributes;
    const index = Math.max(0, columns.node.indexOf(node));
    const component = this.#componentAt(measured_depth);
    const words = `${component && `${component}, `}node ${node} at ${say("measured_depth", measured_depth)}`;
    return { lowSide: columns.low_side_angle[index], clearance: columns.clearance[index], node, words };
  }

  async redraw() {
    const { point, query, table } = this.#context;
    const isNewest = this.#beginNode();
    const refusal = sayUnrecorded(point.scenario, query);
    if (refusal) return this.#refuse(refusal);
    // The window of another node is not waited for any more.
    const isWindow = this.#beginWindow();
    const asked = this.#tablesOf(this.choices.window);
    const [equilibrium, orbit] = nodeTables(point.scenario, query);
    // If it fails, the window reports that once it is drawn.
    asked.catch(() => {});
    let found;
    try {
      found = await Promise.all([this.#statics ?? table(...equilibrium), table(...orbit)]);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (isNewest()) this.#refuse(error.message);
      return;
    }
    if (!isNewest()) return;
    [this.#statics, this.#whole] = found;
    this.#refuse("");
    await Promise.all([
      this.#drawHistory(),
      this.#drawWindow(isWindow() ? asked : undefined),
      this.#drawRotation(),
    ]);
  }

  /** Shows why a node has no pictures; an empty text shows the pictures. @param {string} why */
  #refuse(why) {
    this.#refused.textContent = why;
    this.#refused.hidden = why === "";
    this.#pictures.hidden = why !== "";
    this.#controls.draw((node) => this.#depthOf(node));
  }

  async #drawHistory() {
    const { lowSide, words } = this.#place();
    const { kept } = this.choices;
    const { columns } = this.#whole;
    const { across, up } = seenDownhole(columns.u, columns.v, lowSide);
    const line = (
      /** @type {string} */ name,
      /** @type {number[]} */ values,
      /** @type {number} */ colour,
    ) => ({
      type: "scatter",
      mode: "lines",
      x: columns.time,
      y: shown("radius", values),
      name,
      line: { color: LINES[colour], width: 1 },
      describe: (/** @type {{x: number, y: number}} */ { x, y }) => `${number(x, 6)} s: ${number(y)}`,
    });
    this.#history.setAttribute("aria-label", `History of ${words}`);
    const layout = {
      showlegend: true,
      dragmode: "select",
      selectdirection: "h",
      xaxis: { title: "time [s]", range: [kept.from, kept.to] },
      yaxis: { title: `displacement [${unit("radius").symbol}]`, quantity: "radius" },
      shapes: [this.#shade()],
    };
    const traces = [line("from the low side up", up, 0), line("across the hole", across, 1)];
    await draw(this.#history, traces, layout, this.#context.signal);
  }

  /** The window as a shape of the history. */
  #shade() {
    const { from, to } = this.choices.window;
    return {
      type: "rect",
      xref: "x",
      yref: "paper",
      x0: from,
      x1: to,
      y0: 0,
      y1: 1,
      fillcolor: LINES[5],
      opacity: 0.18,
      line: { width: 0 },
      layer: "below",
    };
  }

  async #drawRotation() {
    const { node, words } = this.#place();
    const { point, query, signal } = this.#context;
    const table = await this.#context.table(...rotationTable(point.scenario, query, node)).catch((error) => {
      if (!(error instanceof Problem)) throw error;
    });
    // A run without torsion has no such table.
    if (!table || this.#whole.attributes.node !== node) return;
    const { columns } = table;
    const { kept } = this.choices;
    this.#rotationName.textContent = `Rotation speed and torque of ${words}`;
    this.#rotation.setAttribute("aria-label", this.#rotationName.textContent);
    const [speed, torque] = [`rotation_speed_${node}`, `torque_${node}`];
    const traces = [
      {
        type: "scatter",
        mode: "lines",
        x: columns.time,
        y: shown(speed, columns[speed]),
        name: "rotation speed",
        line: { color: LINES[0], width: 1 },
      },
      {
        type: "scatter",
        mode: "lines",
        x: columns.time,
        y: shown(torque, columns[torque]),
        name: "torque",
        yaxis: "y2",
        line: { color: LINES[1], width: 1, dash: "dot" },
      },
    ];
    const yaxis = { title: `rotation speed [${unit(speed).symbol}]`, quantity: "rotation_speed" };
    const yaxis2 = {
      title: `torque [${unit(torque).symbol}]`,
      quantity: "torque",
      overlaying: "y",
      side: "right",
      showgrid: false,
    };
    await draw(
      this.#rotation,
      traces,
      {
        showlegend: true,
        margin: { l: 64, r: 70, t: 30, b: 50 },
        xaxis: { title: "time [s]", range: [kept.from, kept.to] },
        yaxis,
        yaxis2,
      },
      signal,
    );
  }

  /** @param {Window} window @returns {Promise<any[]>} its orbit, spectrum and statistics */
  #tablesOf(window) {
    const { point, query, table } = this.#context;
    return Promise.all(windowTables(point.scenario, query, window).map((asked) => table(...asked)));
  }

  /** @param {Promise<any[]>} [asked] tables of the window, if they are requested already */
  async #drawWindow(asked) {
    const isNewest = this.#beginWindow();
    this.#wrong.textContent = "";
    adjust(this.#history, { shapes: [this.#shade()] });
    try {
      const [cut, lines, statistics] = await (asked ?? this.#tablesOf(this.choices.window));
      if (!isNewest()) return;
      this.#windowed = { cut, lines, statistics };
      // The window that follows the mouse is shown until it is let go.
      if (this.#dragged) return;
      this.#drawStatistics();
      this.#lines.draw(lines);
      await Promise.all([this.#drawOrbit(), this.#drawSpectrum()]);
      // The service takes a second for a diagnosis that is new to it, for which the pictures need not wait.
      if (isNewest()) attend(this.#lines.drawCauses(), this.#context.signal);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (isNewest()) this.#wrong.textContent = error.errors[0]?.detail ?? error.message;
    }
  }

  /** Follows a dragged window at each frame, as far as that is cheap, from the samples that the history shows. @param {[number, number]} range */
  #follow(range) {
    const { columns } = this.#whole;
    if (!this.#brush) {
      this.#brush = new Brush(
        orbitTrace(this.#whole, this.#place().lowSide, { color: LINES[0] }),
        columns.time,
      );
      adjust(this.#orbit, { ranges: this.#brush.ranges() });
    }
    this.#showOrbit(this.#brush.part(range));
    const rough = orbitStatistics(columns, ...this.#brush.rows(range));
    if (rough)
      this.#showStatistics({ from: range[0], to: range[1] }, (name) => `≈ ${say(name, rough[name], 3)}`, "");
    this.#dragged = range;
    this.#rested();
  }

  /** Shows the orbit of a window that is being dragged. @param {any} trace */
  #showOrbit(trace) {
    adjust(this.#orbit, { traces: [holeTrace(this.#place().clearance), trace] });
  }

  #lookAtDragged() {
    if (!this.#dragged) return;
    this.#lookAt(this.#dragged).catch((error) => {
      if (!(error instanceof Problem) && !this.#context.signal.aborted) console.error(error);
    });
  }

  /** Shows all samples of a window that rests while it is dragged. @param {[number, number]} range */
  async #lookAt(range) {
    const [from, to] = range;
    if (!this.#isEnough(from, to)) return;
    const [cut, lines, statistics] = await this.#tablesOf({ from, to });
    if (this.#dragged !== range) return;
    this.#showOrbit(orbitTrace(cut, this.#place().lowSide, { color: LINES[0] }));
    this.#showStatistics(
      { from, to },
      (name) => say(name, statistics.columns[name][0]),
      String(statistics.attributes.samples),
    );
    await this.#plotSpectrum(lines);
  }

  /** Ends a drag. @param {[number, number] | null} range */
  #release(range) {
    this.#dragged = null;
    this.#brush = null;
    if (range && this.#isEnough(...range)) {
      this.#choose(...range);
    } else if (this.#windowed) {
      this.#drawStatistics();
      void this.#drawOrbit();
      void this.#drawSpectrum();
    }
  }

  async #drawOrbit() {
    const { lowSide, clearance, node, words } = this.#place();
    const { isZoomed } = this.choices;
    const table = this.#windowed?.cut;
    if (!table?.columns.u.length) return;
    this.#orbit.setAttribute("aria-label", `Orbit of ${words}`);
    const trace = orbitTrace(table, lowSide, { color: LINES[0] });
    const layout = orbitLayout(isZoomed, [trace], clearance);
    const largest = this.#windowed?.statistics.columns.orbit_largest_radius[0];
    this.#wall.textContent = isWallSeen(layout, clearance)
      ? "On the grey circle the node touches the wall."
      : largest < clearance
        ? `The wall is outside the picture, at least ${say("clearance", clearance - largest, 3)} from the orbit.`
        : "The node lies against the wall, which is outside the picture.";
    await draw(
      this.#orbit,
      [holeTrace(clearance), trace],
      { ...layout, shows: [node, isZoomed] },
      this.#context.signal,
    );
  }

  async #drawSpectrum() {
    if (!this.#windowed) return;
    this.#spectrum.setAttribute("aria-label", `Full spectrum of ${this.#place().words}`);
    await this.#plotSpectrum(this.#windowed.lines);
  }

  /** @param {any} table of a spectrum */
  #plotSpectrum(table) {
    // With another range the picture is shown as a whole.
    const layout = { ...spectrumLayout([{ table }], this.choices.isLog), shows: this.choices.range };
    this.#shaded.hidden = layout.shapes.length === 0;
    const traces = [spectrumTrace(table, { color: LINES[0] }), peaksTrace(table, { color: LINES[1] })];
    return draw(this.#spectrum, traces, layout, this.#context.signal);
  }

  #drawStatistics() {
    if (!this.#windowed) return;
    const { point, bias } = this.#context;
    const { window } = this.choices;
    const { columns, attributes } = this.#windowed.statistics;
    const biased = biasOver(point, window, bias);
    const as = recordedAs(point.scenario, columns.node[0], columns.measured_depth[0]);
    this.#showStatistics(
      window,
      (name) => say(name, columns[name][0]) + biased(`${name}_${as}`),
      String(attributes.samples),
    );
  }

  /**
   * @param {Window} window
   * @param {(name: string) => string} value of a statistic, in words
   * @param {string} samples
   */
  #showStatistics({ from, to }, value, samples) {
    const facts = [
      ["Window", `${say("time", from)} to ${say("time", to)}`],
      ...STATISTICS.map(([name, text]) => [text, value(name)]),
      ["Clearance", say("clearance", this.#place().clearance)],
      ["Samples", samples],
    ];
    fill(
      this.#statistics,
      h("h2", {}, "Statistics of the window"),
      h(
        "dl",
        { class: "facts" },
        facts.flatMap(([name, text]) => [h("dt", {}, name), h("dd", { class: "number" }, text)]),
      ),
      h("p", { class: "small soft" }, sayAxes(this.#place().lowSide)),
    );
  }
}

/** Angle below which an axis points to the low side [degrees]. */
const ALONG_DEG = 0.5;

/** Directions of u and v in words. @param {number} lowSide angle of the low side, from u towards v [rad] */
function sayAxes(lowSide) {
  const angle = (lowSide * 180) / Math.PI;
  const v = "v is a right angle clockwise of it";
  if (Math.abs(angle) < ALONG_DEG) return `u points to the low side; looking downhole, ${v}.`;
  return `Looking downhole, u points ${number(Math.abs(angle), 3)}° ${angle > 0 ? "counterclockwise" : "clockwise"} of the low side; ${v}.`;
}
