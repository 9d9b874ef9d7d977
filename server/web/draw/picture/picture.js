// A picture of traces on axes: drawn on a canvas, with a legend and buttons above it, read by the mouse, and saved by the same drawing.

import { h } from "../../ui/dom.js";
import { barsOf, drawBars } from "./bars.js";
import { ButtonBar } from "./buttons.js";
import { cellEdges, drawGrid } from "./cells.js";
import { FONT, inks } from "./inks.js";
import { Interaction } from "./interaction.js";
import { Labels } from "./labels.js";
import { arrange, axesOf, crossedBy, LINE, matching, panelsOf, stripOf } from "./layout.js";
import { drawLegend, entriesOf, isolated, Legend, legendRows, shownTraces, toggled } from "./legend.js";
import { colourEnds, drawDots, drawErrors, drawLine, drawSymbols, drawWords } from "./marks.js";
import { alongside, closest } from "./nearest.js";
import { saveDrawing, svgOf } from "./save.js";
import { colourBarOf, drawAxis, drawColourBar, drawGridLines } from "./scales.js";
import { drawNote, drawShape } from "./shapes.js";

/** @typedef {import("./axis.js").Axis} Axis */
/** @typedef {import("./axis.js").Range} Range */
/** @typedef {import("./layout.js").Frame} Frame */
/** @typedef {import("./layout.js").Panel} Panel */
/** @typedef {import("./nearest.js").Drawn} Drawn */
/** @typedef {import("./nearest.js").Reading} Reading */
/** @typedef {import("./svg-pen.js").Pen} Pen */

/**
 * A picture in a place, which gets its events: `pointhover` and `pointclick` with the points that are read, `placeclick` with the values at
 * the mouse, `choosing` and `chosen` with the area that is dragged over (`null` where the drag was broken off), `zoomed` when the reader has changed its ranges, and `painted`.
 */
export class Picture {
  /** @type {any[]} */
  traces = [];
  /** @type {any} */
  layout = {};
  /** Axes by the names that traces have for them. @type {Map<string, Axis>} */
  axes = new Map();
  /** @type {Frame} */
  frame = { left: 0, top: 0, right: 0, bottom: 0, width: 0, height: 0 };
  /** How a dragged mouse works. @type {import("./buttons.js").Mode} */
  mode = "zoom";
  /** Names that the reader has hidden. @type {ReadonlySet<string>} */
  hidden = new Set();
  /** @type {Panel[]} */
  #panels = [];
  /** @type {Drawn[]} */
  #drawn = [];
  #canvas = h("canvas", { class: "picture", "aria-hidden": "true" });
  #pen = /** @type {CanvasRenderingContext2D} */ (this.#canvas.getContext("2d"));
  #areas = h("div", { class: "areas" });
  #labels = new Labels();
  #legend = new Legend({
    toggle: (name) => this.#hide(toggled(this.hidden, name)),
    isolate: (name) => this.#hide(isolated(this.hidden, name, this.#names)),
  });
  #bar = new ButtonBar({
    mode: (mode) => this.#setMode(mode),
    zoom: (factor) => this.zoomBy(factor),
    reset: () => this.reset(),
    save: (format) => this.save(format),
  });

  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
    place.append(this.#canvas, this.#areas, this.#labels.element, this.#legend.element, this.#bar.element);
    new Interaction(this, this.#areas);
    /** @type {any} */ (place).picture = this;
  }

  /**
   * Draws.
   * @param {any[]} traces
   * @param {any} layout complete
   * @param {Record<string, Range>} [ranges] of axes by their names in the layout, where they are not to be shown as a whole
   */
  show(traces, layout, ranges = {}) {
    if (layout.dragmode !== this.layout.dragmode) this.mode = layout.dragmode ?? "zoom";
    [this.traces, this.layout] = [traces, layout];
    const names = new Set(this.#names);
    this.hidden = new Set([...this.hidden].filter((name) => names.has(name)));
    this.#findAxes(ranges);
    this.redraw();
  }

  /**
   * Changes parts of the layout, ranges of axes by their names in it, or traces.
   * @param {{ranges?: Record<string, Range>, traces?: any[], dragmode?: import("./buttons.js").Mode, shapes?: any[], annotations?: any[]}} changes
   */
  change({ ranges = {}, traces = this.traces, ...layout }) {
    if (layout.dragmode) this.mode = layout.dragmode;
    this.layout = { ...this.layout, ...layout };
    const isSame = traces === this.traces;
    this.traces = traces;
    if (!isSame) this.#findAxes(this.#ranges());
    this.#setByKey(ranges);
    this.redraw();
  }

  /** The axis of a name in the layout. @param {string} key @returns {Axis | undefined} */
  axis(key) {
    return this.axes.get(key.replace("axis", ""));
  }

  /** @param {number} px @param {number} py @returns {Panel | undefined} */
  panelAt(px, py) {
    return this.#panels.find(
      ({ x, y }) =>
        px >= x.offset && px <= x.offset + x.length && py >= y.offset && py <= y.offset + y.length,
    );
  }

  /** A panel of an axis. @param {Axis} axis */
  panelOf(axis) {
    return this.#panels.find((panel) => this.axesIn(panel).includes(axis));
  }

  /** Axes of a panel that the reader may move. @param {Panel} panel */
  axesIn({ x, y, over }) {
    return [x, y, ...over].filter(({ own }) => !own.isFixed);
  }

  /** Sets ranges, of axes that match these too. @param {Map<Axis, Range>} ranges */
  setRanges(ranges) {
    for (const [axis, range] of ranges)
      for (const other of matching(axis, this.axes)) other.range = [range[0], range[1]];
    this.redraw();
  }

  /** Shows all of some axes. @param {Axis[]} [axes] otherwise of every axis */
  reset(axes = [...this.axes.values()]) {
    for (const axis of axes.flatMap((one) => matching(one, this.axes))) axis.reset();
    this.redraw();
    this.dispatch("zoomed");
  }

  /** Zooms about the middle. @param {number} factor by which more is shown */
  zoomBy(factor) {
    const changed = [...this.axes.values()].filter(({ words, own }) => !words && !own.isFixed);
    this.setRanges(new Map(changed.map((axis) => [axis, axis.widened(factor)])));
    this.dispatch("zoomed");
  }

  /** @param {string} name of the event @param {any} [detail] */
  dispatch(name, detail) {
    this.place.dispatchEvent(new CustomEvent(name, { detail }));
  }

  /** Draws for the size and the theme as they are. */
  redraw() {
    const { width, height } = this.#size;
    if (!width || !height) return;
    const scale = devicePixelRatio;
    Object.assign(this.#canvas, { width: Math.round(width * scale), height: Math.round(height * scale) });
    this.#pen.scale(scale, scale);
    this.#pen.font = `12px ${FONT}`;
    this.#legend.show(this.#entries, this.hidden, inks());
    this.#bar.show(this.mode, this.layout.dragmode === "select");
    const { offsetHeight: top } = this.#legend.element;
    this.#arrange(top + this.#bar.place(top));
    this.#fitAreas();
    this.#paint(this.#pen);
    this.hush();
    this.dispatch("painted");
  }

  /** Text of the picture as an SVG. */
  svg() {
    const text = svgOf(this.#size, (pen) => this.#paintFile(pen));
    this.redraw();
    return text;
  }

  /** @param {import("./save.js").Format} format */
  save(format) {
    const name = (this.place.getAttribute("aria-label") ?? "picture")
      .replace(/[^\p{L}\p{N}]+/gu, "-")
      .toLowerCase();
    saveDrawing(name, format, this.#size, (pen) => this.#paintFile(pen));
    this.redraw();
  }

  /** Describes what is at a place. @param {number} px @param {number} py @returns {Reading[]} */
  describe(px, py) {
    const reading = this.#reading(px, py);
    const { hovermode } = this.layout;
    if (!reading.length) this.hush();
    else if (hovermode === "closest") this.#labels.show([reading]);
    else {
      const pixel = hovermode === "x" ? px : py;
      this.#labels.show(this.#byPanel(reading, hovermode, pixel));
      this.#labels.cross(hovermode, pixel, reading[0][/** @type {"x" | "y"} */ (hovermode)], this.frame);
    }
    if (reading.length) this.dispatch("pointhover", { points: reading });
    return reading;
  }

  /** Takes the labels away. */
  hush() {
    this.#labels.hide();
  }

  /** @param {number} px @param {number} py */
  click(px, py) {
    const points = this.describe(px, py);
    if (points.length) this.dispatch("pointclick", { points });
    const panel = this.panelAt(px, py);
    if (panel) this.dispatch("placeclick", { x: panel.x.toValue(px), y: panel.y.toValue(py) });
  }

  get #size() {
    return { width: this.place.clientWidth, height: this.place.clientHeight };
  }

  get #entries() {
    return entriesOf(this.traces, this.layout);
  }

  get #names() {
    return this.#entries.map(({ name }) => name);
  }

  /** @param {import("./buttons.js").Mode} mode */
  #setMode(mode) {
    this.mode = mode;
    this.redraw();
  }

  /** @param {Set<string>} hidden names */
  #hide(hidden) {
    this.hidden = hidden;
    this.#findAxes(this.#ranges());
    this.redraw();
  }

  /** Ranges that differ from the whole, by the axes' names in the layout. @returns {Record<string, Range>} */
  #ranges() {
    const zoomed = [...this.axes.values()].filter(({ range, whole }) => String(range) !== String(whole));
    return Object.fromEntries(zoomed.map((axis) => [axis.key, axis.range]));
  }

  /** @param {Record<string, Range>} ranges by the axes' names in the layout */
  #findAxes(ranges) {
    const shown = shownTraces(this.traces, this.#entries, this.hidden);
    this.axes = axesOf(this.traces, this.layout, shown);
    this.#panels = panelsOf(this.traces, this.axes);
    this.#setByKey(ranges);
  }

  /** @param {Record<string, Range>} ranges */
  #setByKey(ranges) {
    for (const [key, range] of Object.entries(ranges)) {
      const axis = this.axis(key);
      if (axis) for (const other of matching(axis, this.axes)) other.range = [range[0], range[1]];
    }
  }

  #measure = (/** @type {string} */ text) => this.#pen.measureText(text).width;

  /** Puts everything at its place. @param {number} top height of what stands above the axes [pixels] */
  #arrange(top) {
    const { width, height } = this.#size;
    const bar = colourBarOf(this.traces, this.#measure)?.width ?? 0;
    const room = { width, height, top, bar, measure: this.#measure };
    this.frame = arrange(this.axes, this.#panels, this.layout, room);
    const shown = new Set(shownTraces(this.traces, this.#entries, this.hidden));
    const bars = this.traces.filter((trace) => trace.type === "bar" && shown.has(trace));
    this.#drawn = this.#panels.flatMap((panel) =>
      panel.traces.filter((trace) => shown.has(trace)).map((trace) => this.#placed(trace, panel, bars)),
    );
  }

  /** @param {any} trace @param {Panel} panel @param {any[]} bars all traces of bars @returns {Drawn} */
  #placed(trace, panel, bars) {
    const [x, y] = [trace.xaxis ?? "x", trace.yaxis ?? "y"].map(
      (name) => /** @type {Axis} */ (this.axes.get(name)),
    );
    if (trace.z) return { trace, panel, x, y, ...cellEdges(trace, x, y) };
    const places = { x: x.toPixels(trace.x), y: y.toPixels(trace.y) };
    if (trace.type !== "bar") return { trace, panel, x, y, places };
    return { trace, panel, x, y, bars: barsOf(trace, bars, x, y) };
  }

  /** Puts an area over each panel, and one over the numbers of each axis, where the mouse works. */
  #fitAreas() {
    const axes = [...this.axes.values()].filter(({ own }) => own.visible !== false);
    const boxes = [
      ...this.#panels.map(({ x, y }) => ({
        kind: "area",
        axis: "",
        box: { left: x.offset, top: y.offset, width: x.length, height: y.length },
      })),
      ...axes.map((axis) => ({
        kind: "strip",
        axis: axis.name,
        box: stripOf(axis, crossedBy(axis, this.#panels, this.axes)),
      })),
    ];
    while (this.#areas.childElementCount > boxes.length) this.#areas.lastElementChild?.remove();
    while (this.#areas.childElementCount < boxes.length) this.#areas.append(h("div"));
    this.#areas.dataset.mode = this.mode;
    boxes.forEach(({ kind, axis, box }, order) => {
      const element = /** @type {HTMLElement} */ (this.#areas.children[order]);
      element.className = kind;
      element.dataset.axis = axis;
      for (const [side, pixels] of Object.entries(box)) element.style.setProperty(side, `${pixels}px`);
    });
  }

  /** Draws a file, which has the legend in the picture. @param {Pen} pen */
  #paintFile(pen) {
    const { width, height } = this.#size;
    const entries = this.#entries.filter(({ name }) => !this.hidden.has(name));
    const wide = width - 2 * LINE;
    this.#arrange(legendRows(entries, wide, this.#measure).height);
    pen.fillStyle = inks().panel;
    pen.fillRect(0, 0, width, height);
    pen.save();
    pen.translate(LINE, 0);
    drawLegend(pen, entries, wide, this.#measure, inks());
    pen.restore();
    this.#paint(pen);
  }

  /** @param {Pen} pen */
  #paint(pen) {
    const ink = inks();
    const { shapes = [], annotations = [] } = this.layout;
    for (const panel of this.#panels) drawGridLines(pen, panel, ink);
    const [below, above] = [true, false].map((isBelow) =>
      shapes.filter((/** @type {any} */ { layer }) => (layer === "below") === isBelow),
    );
    for (const shape of below) drawShape(pen, shape, this.axes, this.frame);
    for (const drawn of this.#drawn) this.#paintTrace(pen, drawn);
    for (const shape of above) drawShape(pen, shape, this.axes, this.frame);
    for (const axis of this.axes.values()) drawAxis(pen, axis, this.#panels, this.axes, ink, this.#measure);
    const bar = colourBarOf(this.traces, this.#measure);
    if (bar) drawColourBar(pen, bar, this.frame, ink);
    for (const note of annotations) drawNote(pen, note, this.axes, this.frame, ink, this.#measure);
  }

  /** @param {Pen} pen @param {Drawn} drawn */
  #paintTrace(pen, { trace, x, y, places, bars }) {
    pen.save();
    if (trace.cliponaxis !== false) {
      pen.beginPath();
      pen.rect(x.offset, y.offset, x.length, y.length);
      pen.clip();
    }
    const ends = trace.z && colourEnds(trace);
    if (ends) drawGrid(pen, trace, x, y, ends);
    if (bars) drawBars(pen, trace, bars);
    if (trace.error_x || trace.error_y)
      drawErrors(pen, trace, places ?? { x: x.toPixels(trace.x), y: y.toPixels(trace.y) }, x, y);
    if (places) this.#paintPoints(pen, trace, places, x, y);
    pen.restore();
  }

  /** @param {Pen} pen @param {any} trace @param {import("./marks.js").Places} places @param {Axis} x @param {Axis} y */
  #paintPoints(pen, trace, places, x, y) {
    if (trace.type === "dots") return drawDots(pen, trace, places, x, y, inks());
    if (trace.mode.includes("lines")) drawLine(pen, trace.line, places);
    if (trace.mode.includes("markers")) drawSymbols(pen, trace, places, inks());
    if (trace.mode.includes("text")) drawWords(pen, trace, places, LINE);
    return undefined;
  }

  /** Points that are read at a place. @param {number} px @param {number} py @returns {Reading[]} */
  #reading(px, py) {
    const panel = this.panelAt(px, py);
    if (!panel) return [];
    const { hovermode } = this.layout;
    if (hovermode === "closest") {
      const found = closest(
        this.#drawn.filter((one) => one.panel === panel),
        px,
        py,
      );
      return found ? [found] : [];
    }
    const axis = hovermode === "x" ? panel.x : panel.y;
    const along = this.#drawn.filter((one) => one.panel[hovermode === "x" ? "x" : "y"] === axis);
    return alongside(along, hovermode, hovermode === "x" ? px : py);
  }

  /** Points of each panel, at the line of the cursor. @param {Reading[]} reading @param {"x" | "y"} direction @param {number} pixel */
  #byPanel(reading, direction, pixel) {
    const panelOf = new Map(this.#drawn.map(({ trace, panel }) => [trace, panel]));
    const groups = this.#panels.map((panel) => reading.filter(({ trace }) => panelOf.get(trace) === panel));
    return groups
      .filter((group) => group.length)
      .map(([first, ...others]) => {
        const { x, y } = first.at;
        return [{ ...first, at: direction === "x" ? { x: pixel, y } : { x, y: pixel } }, ...others];
      });
  }
}

/** The picture in a place, once it is drawn. @param {HTMLElement} place @returns {Picture | undefined} */
export function pictureOf(place) {
  return /** @type {any} */ (place).picture;
}
