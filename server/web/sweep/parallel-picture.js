// The picture of parallel coordinates: lines on a canvas, and axes over it that are brushed, moved and read.

import { number } from "../data/units.js";
import { FONT, inks } from "../draw/picture/inks.js";
import { saveSvg, saveSvgAsPng } from "../draw/picture/save.js";
import { roundValues, tickText } from "../draw/picture/ticks.js";
import { inkedScale } from "../draw/plots.js";
import { h } from "../ui/dom.js";
import { axisNames, LINE_PX } from "./axis-names.js";
import { drawnEnds, endsOf, joined, keptLines, nearestLine, partOf } from "./parallel-lines.js";

const SPACE = "http://www.w3.org/2000/svg";
/** Half of the width across which an axis is brushed, and half of that of a filter [pixels]. */
const [REACH, FILTER] = [14, 5];
/** Distance from the end of a filter within which the end is dragged, and movement below which a drag is a click [pixels]. */
const [END_PX, CLICK_PX] = [6, 4];
/** Distance of ticks, and of a tick from the end of its axis [pixels]. */
const [APART, FROM_END] = [45, 14];
/** Colours of lines. */
const STEPS = 64;
/** Lines beyond which each is thinner. */
const DENSE = 1000;
/** Width of the bar of colours, and its distance from the last axis [pixels]. */
const [BAR, BAR_LEFT] = [14, 60];
/** Name of a saved file. */
const NAME = "parallel-coordinates";

/** @typedef {import("./parallel-lines.js").Dimension} Dimension */
/** @typedef {{x: number, heights: Float64Array, ends: [number, number], dimension: Dimension}} Axis */
/**
 * @typedef {object} Listeners
 * @property {(name: string, ranges: number[][]) => void} filtered called while an axis is brushed
 * @property {() => void} released called once it has been
 * @property {(names: string[]) => void} moved called with the axes in their new order
 * @property {(line: number) => void} read called with the line next to the mouse
 */

export class ParallelPicture {
  #listeners;
  #screen = h("canvas", { class: "lines", "aria-hidden": "true" });
  #axesPart = svg("svg", { class: "axes", "font-family": FONT, "font-size": 12 });
  #mark = svg("polyline", { class: "mark", fill: "none", "stroke-width": 2.5, "pointer-events": "none" });
  /** @type {Dimension[]} */
  #dimensions = [];
  /** The axis whose values colour the lines. */
  #colour = 0;
  /** @type {Axis[]} */
  #axes = [];
  /** @type {number[]} */
  #kept = [];
  #top = 0;
  #bottom = 0;
  #isDue = false;
  /** Width and height for which it was drawn. */
  #size = "";

  /** @param {Listeners} listeners @param {AbortSignal} signal */
  constructor(listeners, signal) {
    this.#listeners = listeners;
    this.element = h(
      "div",
      { class: "plot tall parallel", role: "figure", "aria-label": "Parallel coordinates of the sweep" },
      this.#screen,
      this.#axesPart,
    );
    const observer = new ResizeObserver(() => {
      const { clientWidth, clientHeight } = this.element;
      if (this.#size !== `${clientWidth} ${clientHeight}`) this.#later();
    });
    observer.observe(this.element);
    signal.addEventListener("abort", () => observer.disconnect(), { once: true });
    this.element.addEventListener("pointermove", (event) => this.#point(event));
    this.element.addEventListener("pointerleave", () => this.#mark.remove());
  }

  /** @param {Dimension[]} dimensions from the left @param {number} colour the one whose values colour the lines */
  show(dimensions, colour) {
    this.#dimensions = dimensions;
    this.#colour = colour;
    this.#draw();
  }

  /** Lines that pass all filters. */
  get kept() {
    return this.#kept;
  }

  /** Marks a line. @param {number} line */
  mark(line) {
    this.#mark.setAttribute("points", this.#axes.map(({ x, heights }) => `${x},${heights[line]}`).join(" "));
    this.#mark.setAttribute("stroke", inks().text);
    this.#axesPart.append(this.#mark);
  }

  /** Saves what is shown. @param {"png" | "svg"} format */
  async save(format) {
    const file = /** @type {SVGElement} */ (this.#axesPart.cloneNode(true));
    const { clientWidth: width, clientHeight: height } = this.element;
    const ground = svg("rect", { width, height, fill: inks().panel });
    file.prepend(ground, svg("image", { width, height, href: this.#screen.toDataURL() }));
    const text = new XMLSerializer().serializeToString(file);
    if (format === "svg") saveSvg(NAME, text);
    else await saveSvgAsPng(NAME, text, { width, height });
  }

  /** Draws anew in the next frame. */
  #later() {
    if (this.#isDue) return;
    this.#isDue = true;
    requestAnimationFrame(() => {
      this.#isDue = false;
      this.#draw();
    });
  }

  #draw() {
    const place = this.element;
    const around = place.parentElement?.clientWidth ?? 0;
    if (!this.#dimensions.length || !around) return;
    const named = axisNames(
      this.#dimensions.map(({ title }) => title),
      around,
    );
    place.style.minWidth = `${named.width}px`;
    const { clientWidth: width, clientHeight: height } = place;
    this.#size = `${width} ${height}`;
    this.#top = named.margin.t;
    this.#bottom = height - named.margin.b;
    const apart = (width - named.margin.l - named.margin.r) / Math.max(1, this.#dimensions.length - 1);
    this.#axes = this.#dimensions.map((dimension, order) => {
      const ends = drawnEnds(dimension);
      const heights = Float64Array.from(dimension.values, (value) => this.#heightOf(value, ends));
      return { x: named.margin.l + order * apart, heights, ends, dimension };
    });
    for (const [name, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` }))
      this.#axesPart.setAttribute(name, String(value));
    this.#axesPart.replaceChildren(
      ...this.#axes.map((axis, order) => this.#axisPart(axis, named.lines[order], named.side)),
      this.#barPart(width),
    );
    this.#drawLines();
  }

  /** @param {number} value @param {[number, number]} ends of its axis */
  #heightOf(value, ends) {
    return this.#bottom - partOf(value, ends) * (this.#bottom - this.#top);
  }

  /** @param {number} y @param {[number, number]} ends */
  #valueAt(y, [least, largest]) {
    const part = (this.#bottom - y) / (this.#bottom - this.#top);
    return least + Math.max(0, Math.min(1, part)) * (largest - least);
  }

  #drawLines() {
    const { clientWidth, clientHeight } = this.element;
    const scale = devicePixelRatio || 1;
    Object.assign(this.#screen, {
      width: Math.round(clientWidth * scale),
      height: Math.round(clientHeight * scale),
    });
    const pen = /** @type {CanvasRenderingContext2D} */ (this.#screen.getContext("2d"));
    pen.scale(scale, scale);
    this.#kept = keptLines(this.#dimensions);
    const count = this.#dimensions[0].values.length;
    // A line of a pixel of the screen is drawn several times as fast as a wider one.
    pen.lineWidth = count > DENSE ? 1 / scale : 1.2;
    if (this.#kept.length < count) {
      const isKept = new Uint8Array(count);
      for (const line of this.#kept) isKept[line] = 1;
      pen.strokeStyle = inks().line;
      this.#stroke(
        pen,
        Array.from({ length: count }, (_, line) => line).filter((line) => !isKept[line]),
      );
    }
    const { values } = this.#dimensions[this.#colour];
    const ends = this.#axes[this.#colour].ends;
    const scaleOf = inkedScale();
    /** @type {number[][]} */
    const groups = Array.from({ length: STEPS }, () => []);
    for (const line of this.#kept) groups[Math.round(partOf(values[line], ends) * (STEPS - 1))].push(line);
    groups.forEach((lines, step) => {
      pen.strokeStyle = scaleOf(step / (STEPS - 1));
      this.#stroke(pen, lines);
    });
  }

  /** @param {CanvasRenderingContext2D} pen @param {number[]} lines */
  #stroke(pen, lines) {
    if (!lines.length) return;
    pen.beginPath();
    for (const line of lines) {
      this.#axes.forEach(({ x, heights }, order) => pen[order ? "lineTo" : "moveTo"](x, heights[line]));
    }
    pen.stroke();
  }

  /** @param {Axis} axis @param {string[]} lines of its name @param {"top" | "bottom"} side of the name */
  #axisPart(axis, lines, side) {
    const { x, ends, dimension } = axis;
    const { text, soft } = inks();
    const [top, bottom] = [this.#top, this.#bottom];
    const common = { "text-anchor": "middle", fill: text };
    const group = svg("g", {});
    group.append(
      svg("line", { x1: x, x2: x, y1: top, y2: bottom, stroke: soft }),
      ...this.#tickParts(axis),
      svg("text", { ...common, class: "axis-extent", x, y: top - 8 }, number(endsOf(dimension)[1])),
      svg("text", { ...common, class: "axis-extent", x, y: bottom + 18 }, number(endsOf(dimension)[0])),
    );
    const first = side === "top" ? top - 30 : bottom + 18 + LINE_PX + 4;
    const name = svg("text", { ...common, class: "axis-title", y: first });
    name.append(...lines.map((line, order) => svg("tspan", { x, dy: order ? LINE_PX : 0 }, line)));
    name.addEventListener("pointerdown", (event) => this.#dragAxis(event, axis, group));
    group.append(name);
    for (const range of dimension.ranges) {
      const [low, high] = range.map((end) => this.#heightOf(Math.max(ends[0], Math.min(ends[1], end)), ends));
      const place = { x: x - FILTER, y: high, width: 2 * FILTER, height: Math.max(2, low - high) };
      group.append(svg("rect", { ...place, class: "range", fill: text, "fill-opacity": 0.35, stroke: text }));
    }
    const reach = svg("rect", {
      class: "axis-brush",
      x: x - REACH,
      y: top,
      width: 2 * REACH,
      height: bottom - top,
      fill: "transparent",
    });
    reach.addEventListener("pointerdown", (event) => this.#brush(event, axis));
    group.append(reach);
    return group;
  }

  /** Ticks between the ends of an axis. @param {Axis} axis */
  #tickParts({ x, ends }) {
    const { text, soft, panel } = inks();
    const count = Math.max(2, (this.#bottom - this.#top) / APART);
    return roundValues(...ends, count)
      .map((value) => ({ value, y: this.#heightOf(value, ends) }))
      .filter(({ y }) => y > this.#top + FROM_END && y < this.#bottom - FROM_END)
      .flatMap(({ value, y }) => [
        svg("line", { x1: x - 5, x2: x, y1: y, y2: y, stroke: soft }),
        // With a rim of the ground, so that it is read over lines.
        svg(
          "text",
          {
            x: x - 8,
            y: y + 4,
            "text-anchor": "end",
            fill: text,
            stroke: panel,
            "stroke-width": 3,
            "paint-order": "stroke",
          },
          tickText(value),
        ),
      ]);
  }

  /** The bar of colours. @param {number} width of the picture */
  #barPart(width) {
    const { ends, x, dimension } = this.#axes[this.#colour];
    const { text } = inks();
    const last = this.#axes[this.#axes.length - 1]?.x ?? x;
    const left = Math.min(last + BAR_LEFT, width - BAR - 70);
    const [top, bottom] = [this.#top, this.#bottom];
    const group = svg("g", { class: "bar" });
    const scaleOf = inkedScale();
    const cell = (bottom - top) / STEPS;
    for (let step = 0; step < STEPS; step += 1) {
      const y = bottom - (step + 1) * cell;
      group.append(
        svg("rect", { x: left, y, width: BAR, height: cell + 0.5, fill: scaleOf(step / (STEPS - 1)) }),
      );
    }
    for (const value of roundValues(...ends, Math.max(2, (bottom - top) / APART))) {
      const y = this.#heightOf(value, ends) + 4;
      group.append(svg("text", { x: left + BAR + 5, y, fill: text }, tickText(value)));
    }
    const [across, middle] = [width - 14, (top + bottom) / 2];
    const turned = `rotate(90 ${across} ${middle})`;
    const name = { x: across, y: middle, transform: turned, "text-anchor": "middle", fill: text };
    group.append(svg("text", name, dimension.title));
    return group;
  }

  /** Filters by dragging along an axis; a click on a filter takes it away. @param {PointerEvent} event @param {Axis} axis */
  #brush(event, { ends, dimension }) {
    if (event.button !== 0) return;
    const height = (/** @type {PointerEvent} */ { clientY }) =>
      clientY - this.element.getBoundingClientRect().top;
    const start = height(event);
    const heights = (/** @type {number[]} */ range) =>
      range.map((end) => this.#heightOf(Math.max(ends[0], Math.min(ends[1], end)), ends));
    const held = dimension.ranges.find((range) => {
      const [low, high] = heights(range);
      return start <= low + END_PX && start >= high - END_PX;
    });
    const others = dimension.ranges.filter((range) => range !== held);
    const dragged = held ? draggedRange(heights(held), start) : (/** @type {number} */ y) => [start, y];
    const moved = (/** @type {PointerEvent} */ now) => {
      const range = dragged(height(now))
        .map((y) => this.#valueAt(y, ends))
        .sort((a, b) => a - b);
      this.#filter(dimension, [...others, range]);
    };
    const released = (/** @type {PointerEvent} */ now) => {
      if (Math.abs(height(now) - start) < CLICK_PX) this.#filter(dimension, others);
      this.#listeners.released();
    };
    follow(this.element, event, moved, released);
  }

  /** @param {Dimension} dimension @param {number[][]} ranges */
  #filter(dimension, ranges) {
    dimension.ranges = joined(ranges, endsOf(dimension));
    this.#listeners.filtered(dimension.name, dimension.ranges);
    this.#later();
  }

  /** Moves an axis by its name. @param {PointerEvent} event @param {Axis} axis @param {SVGElement} group */
  #dragAxis(event, axis, group) {
    if (event.button !== 0) return;
    const by = (/** @type {PointerEvent} */ { clientX }) => clientX - event.clientX;
    const moved = (/** @type {PointerEvent} */ now) =>
      group.setAttribute("transform", `translate(${by(now)} 0)`);
    const released = (/** @type {PointerEvent} */ now) => {
      group.removeAttribute("transform");
      const at = axis.x + by(now);
      const others = this.#axes.filter((other) => other !== axis);
      const before = others.filter(({ x }) => x < at).length;
      const names = others.map(({ dimension }) => dimension.name);
      names.splice(before, 0, axis.dimension.name);
      this.#listeners.moved(names);
    };
    follow(this.element, event, moved, released);
  }

  /** Marks and reads the line next to the mouse. @param {PointerEvent} event */
  #point({ clientX, clientY, buttons }) {
    if (buttons) return;
    const { left, top } = this.element.getBoundingClientRect();
    const line = nearestLine(this.#axes, this.#kept, clientX - left, clientY - top);
    if (line === null) return this.#mark.remove();
    this.mark(line);
    this.#listeners.read(line);
  }
}

/**
 * A range that is dragged by one of its ends, or as a whole.
 * @param {number[]} heights of its lower and its upper end [pixels]
 * @param {number} start height at which it is held
 * @returns {(y: number) => number[]}
 */
function draggedRange([low, high], start) {
  // Of a short range the nearer end.
  if (Math.abs(start - low) <= END_PX && start - high >= low - start) return (y) => [y, high];
  if (Math.abs(start - high) <= END_PX) return (y) => [low, y];
  return (y) => [low + y - start, high + y - start];
}

/**
 * Follows the pointer until it lets go.
 * @param {HTMLElement} element that has the pointer meanwhile
 * @param {PointerEvent} event with which it began
 * @param {(now: PointerEvent) => void} moved
 * @param {(now: PointerEvent) => void} released
 */
function follow(element, event, moved, released) {
  event.preventDefault();
  const ended = new AbortController();
  const { signal } = ended;
  element.setPointerCapture(event.pointerId);
  element.addEventListener("pointermove", moved, { signal });
  for (const kind of ["pointerup", "pointercancel"]) {
    element.addEventListener(
      kind,
      (now) => {
        ended.abort();
        released(/** @type {PointerEvent} */ (now));
      },
      { signal },
    );
  }
}

/**
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, string | number>} attributes
 * @param {string} [text]
 * @returns {SVGElementTagNameMap[K]}
 */
function svg(tag, attributes, text) {
  const element = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  if (text !== undefined) element.textContent = text;
  return element;
}
