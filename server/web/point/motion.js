// The motion of a recorded node: a window brushed in its history, and orbit, full spectrum and statistics of that window.

import { get, Problem } from "../data/api.js";
import { Brush, dragWindow, orbitStatistics } from "../draw/brush.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { pythonNode } from "../ui/snippets.js";
import {
  chosenWindow,
  keptWindow,
  nodeTables,
  rangesOf,
  rotationTable,
  selectedNode,
  spectrumRange,
  spectrumWeighting,
  windowTables,
} from "../data/motion-requests.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import {
  holeTrace,
  modeOf,
  multiple,
  namedLines,
  orbitLayout,
  orbitTrace,
  seenDownhole,
  spectrumLayout,
  spectrumTrace,
} from "../draw/orbit.js";
import { adjust, canvas, draw, LINES } from "../draw/plots.js";
import { biasOver, FEWEST, recordedAs, spectrumWindow, STATISTICS } from "../data/statistics.js";
import { say, shown, unit } from "../data/units.js";

/** Modes are looked for up to this frequency at most [Hz]. */
const HIGHEST_MODE_HZ = 50;
/** How long a window that is dragged must rest before the service is asked for it. */
const REST_MS = 100;

/**
 * @param {import("./part.js").PointContext} context
 * @returns {import("./part.js").PointPart}
 */
export function motion(context) {
  const { point, query, signal } = context;
  const { recording, operation } = point.scenario;
  const kept = keptWindow(point);
  /** @type {any[]} */
  const nodes = recording.nodes;
  const history = canvas("History of the node", "history", "low");
  const rotation = canvas("Rotation speed and torque of the node", "rotation", "low");
  const orbit = canvas("Orbit of the node", "orbit");
  const spectrum = canvas("Full spectrum of the node", "spectrum");
  const rotationName = h("h2", {}, "Rotation speed and torque");
  const statistics = h("div", {});
  const listed = h("div", {});
  const controls = h("div", { class: "controls" });
  const wrong = h("p", { class: "wrong", role: "alert" });

  /** @type {any} */
  let statics;
  /** @type {any} */
  let whole;
  /** @type {any} */
  let windowed;
  const beginNode = generations();
  const beginWindow = generations();

  const selector = () => selectedNode(point.scenario, query);
  const span = () => chosenWindow(point, query);
  const isZoomed = () => (query.get("zoom") ?? "motion") === "motion";
  const isLog = () => query.get("amplitude") === "log";
  const range = () => spectrumRange(query, recording.rate_hz);
  /** Modes are looked for as far as the spectrum goes, and the service does. */
  const modesUpTo = () => Math.min(range(), HIGHEST_MODE_HZ);
  const weighting = () => spectrumWeighting(query);

  /** @param {string} name @param {string} value */
  const set = (name, value) => context.keep({ [name]: value });

  /** The fields of the window; they stay, so that the keyboard's focus goes on from them. */
  const [fromBox, toBox] = ["From", "To"].map((name) =>
    h("input", {
      type: "number",
      min: kept.from,
      max: kept.to,
      step: "any",
      style: "width:7rem",
      "aria-label": `${name} [s]`,
      onchange: () => choose(Number(fromBox.value), Number(toBox.value)),
    }),
  );

  function fillWindow() {
    const { from, to } = span();
    fromBox.value = String(Number(from.toFixed(3)));
    toBox.value = String(Number(to.toFixed(3)));
  }

  function drawControls() {
    fillWindow();
    const entry = (/** @type {string} */ name, /** @type {HTMLInputElement} */ box) =>
      h("label", { class: "field" }, h("span", {}, `${name} [s]`), box);
    fill(
      controls,
      choice(
        "Node",
        nodes.map((node, index) => [
          String(index),
          node.node !== undefined ? `${node.node}${depthOf(node.node)}` : say("measured_depth", node.depth),
        ]),
        query.get("node") ?? "0",
        (value) => {
          set("node", value);
          attend(redraw(), signal);
        },
      ),
      entry("From", fromBox),
      entry("To", toBox),
      choice(
        "Orbit shows",
        [
          ["motion", "the motion"],
          ["hole", "the whole hole"],
        ],
        isZoomed() ? "motion" : "hole",
        (value) => {
          set("zoom", value);
          void drawOrbit();
        },
      ),
      choice(
        "Frequencies up to",
        rangesOf(recording.rate_hz).map((text) => [text, `${text} Hz`]),
        String(range()),
        (value) => {
          set("range", value);
          attend(drawWindow(), signal);
        },
      ),
      choice(
        "Amplitude",
        [
          ["linear", "linear"],
          ["log", "logarithmic"],
        ],
        isLog() ? "log" : "linear",
        (value) => {
          set("amplitude", value);
          void drawSpectrum();
        },
      ),
      choice(
        "Weighting",
        [
          ["hann", "Hann"],
          ["rectangular", "rectangular"],
        ],
        weighting(),
        (value) => {
          set("window", value);
          attend(drawWindow(), signal);
        },
      ),
      h(
        "button",
        { onclick: () => choose(kept.from, kept.to) },
        point.scenario.recording.orbit_window === "settled" ? "All that is kept" : "Whole run",
      ),
    );
  }

  /** @param {number} node */
  function depthOf(node) {
    const index = statics?.columns.node.indexOf(node) ?? -1;
    return index < 0 ? "" : `, ${say("measured_depth", statics.columns.measured_depth[index])}`;
  }

  /** @param {number} from @param {number} to */
  function choose(from, to) {
    const first = Math.max(kept.from, Math.min(from, to));
    const last = Math.min(kept.to, Math.max(from, to));
    if ((last - first) * recording.rate_hz < FEWEST) return void drawOrbit();
    context.keep({ from: String(Number(first.toFixed(4))), to: String(Number(last.toFixed(4))) });
    fillWindow();
    attend(drawWindow(), signal);
  }

  /** What the statics say of the node that the answer is of. */
  function place() {
    const index = Math.max(0, statics.columns.node.indexOf(whole.attributes.node));
    return {
      lowSide: statics.columns.low_side_angle[index],
      clearance: statics.columns.clearance[index],
      depth: whole.attributes.measured_depth,
      node: whole.attributes.node,
    };
  }

  async function redraw() {
    const isNewest = beginNode();
    // What the window shows of another node is not waited for any more.
    const isWindow = beginWindow();
    const asked = ofWindow(span());
    const [equilibrium, orbit] = nodeTables(point.scenario, query);
    // Where it fails, the window says so once it is drawn.
    asked.catch(() => {});
    let found;
    try {
      found = await Promise.all([statics ?? context.table(...equilibrium), context.table(...orbit)]);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (isNewest()) refuse(error.message);
      return;
    }
    if (!isNewest()) return;
    [statics, whole] = found;
    refuse("");
    await Promise.all([drawHistory(), drawWindow(isWindow() ? asked : undefined), drawRotation()]);
  }

  /** Says why there is nothing to show of a node; an empty text where there is. @param {string} why */
  function refuse(why) {
    refused.textContent = why;
    refused.hidden = why === "";
    pictures.hidden = why !== "";
    drawControls();
  }
  const refused = h("p", { class: "panel empty", role: "alert", hidden: true });

  async function drawHistory() {
    const { lowSide, node, depth } = place();
    const { across, up } = seenDownhole(whole.columns.u, whole.columns.v, lowSide);
    const traces = [
      {
        type: "scatter",
        mode: "lines",
        x: whole.columns.time,
        y: shown("radius", up),
        name: "from the low side up",
        line: { color: LINES[0], width: 1 },
        hovertemplate: "%{x:.3f} s: %{y:.4~g}<extra></extra>",
      },
      {
        type: "scatter",
        mode: "lines",
        x: whole.columns.time,
        y: shown("radius", across),
        name: "across the hole",
        line: { color: LINES[1], width: 1 },
        hovertemplate: "%{x:.3f} s: %{y:.4~g}<extra></extra>",
      },
    ];
    history.setAttribute("aria-label", `History of node ${node} at ${say("measured_depth", depth)}`);
    const shape = await draw(
      history,
      traces,
      {
        showlegend: true,
        dragmode: "select",
        selectdirection: "h",
        xaxis: { title: "time [s]", range: [kept.from, kept.to] },
        yaxis: { title: `displacement [${unit("radius").symbol}]`, quantity: "radius" },
        shapes: [shade()],
      },
      signal,
    );
    if (shape !== history || isDraggable || signal.aborted) return;
    isDraggable = true;
    dragWindow(history, follow, release, signal);
  }
  let isDraggable = false;

  function shade() {
    const { from, to } = span();
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

  async function drawRotation() {
    const { node, depth } = place();
    const table = await context.table(...rotationTable(point.scenario, query, node)).catch((error) => {
      if (!(error instanceof Problem)) throw error;
    });
    // Where torsion is not solved for there is none.
    if (!table || whole.attributes.node !== node) return;
    const { columns } = table;
    rotationName.textContent = `Rotation speed and torque of node ${node} at ${say("measured_depth", depth)}`;
    rotation.setAttribute("aria-label", rotationName.textContent);
    const [speed, torque] = [`rotation_speed_${node}`, `torque_${node}`];
    await draw(
      rotation,
      [
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
      ],
      {
        showlegend: true,
        margin: { l: 64, r: 70, t: 30, b: 50 },
        xaxis: { title: "time [s]", range: [kept.from, kept.to] },
        yaxis: { title: `rotation speed [${unit(speed).symbol}]`, quantity: "rotation_speed" },
        yaxis2: {
          title: `torque [${unit(torque).symbol}]`,
          quantity: "torque",
          overlaying: "y",
          side: "right",
          showgrid: false,
          tickmode: "auto",
        },
      },
      signal,
    );
  }

  /** @param {ReturnType<typeof ofWindow>} [asked] where the service has been asked for the window already */
  async function drawWindow(asked) {
    const isNewest = beginWindow();
    wrong.textContent = "";
    void adjust(history, { shapes: [shade()] });
    try {
      const [cut, lines, statistics] = await (asked ?? ofWindow(span()));
      if (!isNewest()) return;
      windowed = { cut, lines, statistics };
      // What follows the mouse is shown until it is let go.
      if (dragged) return;
      drawStatistics();
      drawLines();
      await Promise.all([drawOrbit(), drawSpectrum()]);
      // The service takes a second for what it has not been asked for before, in which the pictures need not wait.
      if (isNewest()) attend(drawModes(), signal);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      if (isNewest()) wrong.textContent = error.errors[0]?.detail ?? error.message;
    }
  }

  /** What paints the orbit while a window is being dragged. @type {import("../draw/brush.js").Brush | null} */
  let brush = null;
  /** The window that is being dragged. @type {[number, number] | null} */
  let dragged = null;

  /** What is cheap follows a window at each frame, from the samples that the history shows. @param {[number, number]} range */
  function follow(range) {
    if (!brush) {
      const trace = orbitTrace(whole, place().lowSide, { color: LINES[0] });
      brush = new Brush(orbit, trace, whole.columns.time);
      void adjust(orbit, brush.layout());
    }
    brush.paint(range);
    const rough = orbitStatistics(whole.columns, ...brush.rows(range));
    if (rough) showStatistics(range[0], range[1], (name) => `≈ ${say(name, rough[name], 3)}`, "");
    dragged = range;
    rested();
  }

  const rested = debounced(
    () =>
      dragged &&
      void lookAt(dragged).catch((error) => {
        if (!(error instanceof Problem) && !signal.aborted) console.error(error);
      }),
    REST_MS,
    signal,
  );

  /** All samples of a window that rests while it is dragged. @param {[number, number]} range */
  async function lookAt(range) {
    const [from, to] = range;
    if ((to - from) * recording.rate_hz < FEWEST) return;
    const [cut, lines, statistics] = await ofWindow({ from, to });
    if (dragged !== range) return;
    brush?.paintTrace(orbitTrace(cut, place().lowSide, { color: LINES[0] }));
    showStatistics(
      from,
      to,
      (name) => say(name, statistics.columns[name][0]),
      String(statistics.attributes.samples),
    );
    await draw(spectrum, [spectrumTrace(lines, { color: LINES[0] })], spectrumOf(lines), signal);
  }

  /** @param {[number, number] | null} range */
  function release(range) {
    dragged = null;
    brush?.end();
    brush = null;
    if (range && (range[1] - range[0]) * recording.rate_hz >= FEWEST) return choose(range[0], range[1]);
    if (!windowed) return;
    drawStatistics();
    void drawOrbit();
    void drawSpectrum();
  }

  /** @param {{from: number, to: number}} window [s] */
  function ofWindow(window) {
    return Promise.all(windowTables(point.scenario, query, window).map((asked) => context.table(...asked)));
  }

  async function drawOrbit() {
    const { lowSide, clearance, node, depth } = place();
    const table = windowed?.cut;
    if (!table?.columns.u.length) return;
    orbit.setAttribute("aria-label", `Orbit of node ${node} at ${say("measured_depth", depth)}`);
    const trace = orbitTrace(table, lowSide, { color: LINES[0] });
    await draw(
      orbit,
      [holeTrace(clearance), trace],
      { ...orbitLayout(isZoomed(), [trace], clearance), shows: [node, isZoomed()] },
      signal,
    );
  }

  /** A spectrum's layout: shown farther, it is shown as a whole. @param {any} table */
  function spectrumOf(table) {
    return { ...spectrumLayout([{ table }], isLog()), shows: range() };
  }

  async function drawSpectrum() {
    if (!windowed) return;
    const { node, depth } = place();
    spectrum.setAttribute("aria-label", `Full spectrum of node ${node} at ${say("measured_depth", depth)}`);
    await draw(
      spectrum,
      [spectrumTrace(windowed.lines, { color: LINES[0] })],
      spectrumOf(windowed.lines),
      signal,
    );
  }

  function drawStatistics() {
    const { from, to } = span();
    const { columns, attributes } = windowed.statistics;
    const bias = biasOver(point, span(), context.bias);
    const as = recordedAs(point.scenario, columns.node[0], columns.measured_depth[0]);
    showStatistics(
      from,
      to,
      (name) => say(name, columns[name][0]) + bias(`${name}_${as}`),
      String(attributes.samples),
    );
  }

  /**
   * @param {number} from @param {number} to
   * @param {(name: string) => string} value of a statistic, in words
   * @param {string} samples
   */
  function showStatistics(from, to, value, samples) {
    const facts = [
      ["Window", `${say("time", from)} to ${say("time", to)}`],
      ...STATISTICS.map(([name, text]) => [text, value(name)]),
      ["Clearance", say("clearance", place().clearance)],
      ["Samples", samples],
    ];
    fill(
      statistics,
      h("h2", {}, "Statistics of the window"),
      h(
        "dl",
        { class: "facts" },
        facts.flatMap(([name, value]) => [h("dt", {}, name), h("dd", { class: "number" }, value)]),
      ),
    );
  }

  /**
   * What stands beside a line of the spectrum: its bias where it is the highest of a window that the summary has.
   * @param {number} frequency [Hz]
   * @returns {(name: string) => string}
   */
  function biasOf(frequency) {
    const { node, measured_depth } = windowed.lines.attributes;
    const suffix = `_${recordedAs(point.scenario, node, measured_depth)}_w${spectrumWindow(point, span())}`;
    const summarised = point.summary[`line_frequency_hz${suffix}`];
    // The summary weights by Hann's window.
    const isIt =
      weighting() === "hann" &&
      typeof summarised === "number" &&
      Math.abs(frequency - summarised) < windowed.lines.attributes.resolution / 2;
    return (name) => (isIt ? context.bias(name + suffix) : "");
  }

  /**
   * Of what a line of the spectrum is a multiple: of the rotation, or else of the highest line.
   * @param {number} frequency [Hz]
   */
  function kindOf(frequency) {
    const { resolution } = windowed.lines.attributes;
    const turns = multiple(frequency, operation.rotation_speed_rpm / 60, resolution, "rotation");
    const highest = Math.abs(namedLines(windowed.lines)[0].frequency);
    const harmonic =
      Math.abs(frequency) > 1.5 * highest
        ? multiple(frequency, highest, resolution, say("frequency", highest))
        : "";
    return { text: turns || harmonic, isHarmonic: harmonic !== "" };
  }

  /** The modes about the equilibrium up to a frequency, which the service looks for once. @type {Map<number, Promise<any>>} */
  const modes = new Map();

  /** Puts the modes beside the lines, once they are found. */
  async function drawModes() {
    const { lines } = windowed;
    const highest = modesUpTo();
    const asked =
      modes.get(highest) ??
      get(`${context.path}/modes`, { to_hz: highest }, signal).catch((error) => {
        modes.delete(highest);
        return { modes: [], problem: error.message };
      });
    modes.set(highest, asked);
    const found = await asked;
    if (windowed?.lines !== lines) return;
    for (const cell of /** @type {NodeListOf<HTMLElement>} */ (listed.querySelectorAll("[data-frequency]"))) {
      const { mode, among } = modeOf(
        Number(cell.dataset.frequency),
        found.modes,
        lines.attributes.resolution,
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
      about,
      found.problem ??
        `Beside a line stands the mode about the equilibrium that is nearest to it, within half the resolution and 1 % of the frequency; where modes lie so close that one would be as near by chance, only how many there are. ${found.modes.length} modes were found up to ${say("frequency", found.complete_to_hz)}. Torque on bit is constant: stick-slip at the bit is not judged.`,
    );
  }
  const about = h("p", { class: "small soft", role: "status" });

  function drawLines() {
    const { lines } = windowed;
    const named = namedLines(lines);
    const rows = named.map((line) => {
      const is = kindOf(line.frequency);
      const bias = biasOf(line.frequency);
      return h(
        "tr",
        {},
        h("td", { class: "number" }, say("frequency", line.frequency) + bias("line_frequency_hz")),
        h("td", {}, line.whirl),
        h("td", { class: "number" }, say("amplitude", line.amplitude) + bias("line_amplitude")),
        h("td", {}, is.text),
        h("td", is.isHarmonic ? {} : { "data-frequency": line.frequency }, is.isHarmonic ? "" : "…"),
      );
    });
    const resolved = lines.attributes.resolved_hz ?? point.summary.resolved_hz;
    fill(
      listed,
      h("h2", {}, "Lines of the spectrum"),
      h(
        "div",
        { class: "scroll", tabindex: "0", role: "region", "aria-label": "Lines, scrollable" },
        h(
          "table",
          {},
          h(
            "thead",
            {},
            h(
              "tr",
              {},
              h("th", { class: "number" }, "Frequency"),
              h("th", {}, "Whirl"),
              h("th", { class: "number" }, "Amplitude"),
              h("th", {}, "Is"),
              h("th", {}, "Mode"),
            ),
          ),
          h("tbody", {}, rows),
        ),
      ),
      about,
      h(
        "p",
        { class: "small soft" },
        `Resolution ${say("frequency", lines.attributes.resolution)}.`,
        resolved ? ` The steps resolve up to ${say("frequency", resolved)}.` : "",
        " The line at zero, the mean position, is left out.",
      ),
    );
  }

  const pictures = h(
    "div",
    {},
    h(
      "div",
      { class: "panel" },
      h("h2", {}, "Displacement"),
      h(
        "figure",
        {},
        history,
        h(
          "figcaption",
          {},
          "Drag across the history to choose a window; orbit, spectrum and statistics follow.",
        ),
      ),
    ),
    h("div", { style: "height:1rem" }),
    h(
      "div",
      { class: "half" },
      h(
        "div",
        { class: "panel" },
        h("h2", {}, "Orbit, looking downhole"),
        h(
          "figure",
          {},
          orbit,
          h(
            "figcaption",
            {},
            "The low side is down; forward whirl goes clockwise. On the grey circle the node touches the wall.",
          ),
        ),
      ),
      h(
        "div",
        { class: "panel" },
        h("h2", {}, "Full spectrum"),
        h("figure", {}, spectrum, h("figcaption", {}, "Shaded: beyond what the time steps resolve.")),
      ),
      h("div", { class: "panel" }, statistics),
      h("div", { class: "panel" }, listed),
    ),
    h("div", { style: "height:1rem" }),
    h("div", { class: "panel" }, rotationName, h("figure", {}, rotation)),
  );
  return {
    element: nodes.length
      ? h("div", {}, controls, wrong, refused, pictures)
      : h("p", { class: "panel empty" }, "This point recorded no node."),
    draw: nodes.length ? redraw : async () => {},
    request: () => {
      if (!nodes.length) return null;
      const window = span();
      const [whole, cut] = [pythonNode(selector()), pythonNode(selector(), window)];
      const ofWindow = { ...selector(), ...window };
      return {
        asked: [
          { table: "history", query: selector() },
          { table: "orbit", query: ofWindow },
          { table: "spectrum", query: { ...ofWindow, window: weighting(), range_hz: range() } },
          { table: "statistics", query: ofWindow },
          { table: "modes", query: { to_hz: modesUpTo() }, isDocument: true },
        ],
        python: `history = point.history(${whole}).to_pandas()\norbit = point.orbit(${cut}).to_pandas()\nspectrum = point.spectrum(${cut}, window="${weighting()}", range_hz=${range()}).to_pandas()\nstatistics = point.statistics(${cut}).to_pandas()\nmodes = point.modes(to_hz=${modesUpTo()})["modes"]\nplot.orbit(point, ${cut})\nplot.spectrum(point, ${cut}, window="${weighting()}", range_hz=${range()})`,
      };
    },
  };
}
