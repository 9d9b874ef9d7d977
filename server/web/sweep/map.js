// A column of the table over two swept parameters, the others held; over one, a line.

import { ends, layered } from "../data/grid-layers.js";
import { theme } from "../data/settings.js";
import { signRules } from "../data/signs.js";
import { isUnsettled, SETTLING } from "../data/statistics.js";
import { distinct, isText } from "../data/sweep-table.js";
import { label, say, sayer, title, unit } from "../data/units.js";
import { BLACK, inkOn, inkOnClass, WHITE } from "../draw/picture/colours.js";
import { logTicks } from "../draw/picture/ticks.js";
import { adjust, canvas, colourBar, draw, inks, laidOut, lineScale, LINES, MANY } from "../draw/plots.js";
import { keyboard } from "../draw/point-cursor.js";
import { extremes, sampledRange, sampleTraces } from "../draw/samples.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { link } from "../ui/router.js";
import { CLASS, wordColour, wordsOf } from "./categories.js";
import { FinerGrid } from "./finer-grid.js";
import { preferred, undelayed } from "./part.js";

/** Designs that draw their points: these have no slices. */
const DRAWN = ["latin_hypercube", "sobol"];
/** Doubt about a point whose statistics may be those of its start. */
const NOT_SETTLED = "not settled";
/** Colours of words, such as states. */
const WORDS = ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#f0e442", "#777777"];

/** @typedef {import("./part.js").Context} Context */
/** @typedef {import("../data/sweep-table.js").Values} Values */

/**
 * Choices of the link: names of columns, further parameters, and how the picture is drawn.
 * @typedef {{x: string, y: string | undefined, colour: string, results: string[], held: string[], isLog: boolean, style: string}} Chosen
 */

/** A further parameter: its values, and the value of the slice. @typedef {{axis: string, all: (number | string)[], value: number | string, column: Values}} HeldAxis */

/**
 * A slice of the table that is drawn.
 * @typedef {object} Slice
 * @property {Values} ordinals
 * @property {Values} states
 * @property {Values} xs
 * @property {Values} ys
 * @property {Values} values
 * @property {HeldAxis[]} held further parameters
 * @property {boolean} isGrid whether the points form a grid, of which a slice is shown
 * @property {number[]} rows places of the shown points in the columns
 * @property {(index: number) => string} doubts reason for which a point is uncertain; empty if it is not
 */

/**
 * @param {Context} context
 * @returns {import("./part.js").Part}
 */
export function map(context) {
  const shown = new SweepMap(context);
  return {
    element: shown.element,
    draw: undelayed(() => shown.redraw(), context),
    fields: () => {
      const { x, y, colour, held } = chosenIn(context);
      return ["ordinal", x, y, ...held, colour].filter((name) => name !== undefined);
    },
  };
}

/**
 * Column that a map shows and that the table lacks: its name, and its word and the reason for doubt of each point.
 * @typedef {{name: string, wordOf: (ordinal: number) => string | null, doubtOf: (ordinal: number) => string}} Own
 */

export class SweepMap {
  #context;
  #own;
  #place = canvas("Map of the sweep", "map", "tall");
  #caption = h("figcaption", {});
  #controls = h("div", { class: "controls" });
  #empty = h("p", { class: "empty", hidden: true });
  #finerButton = h("button", { onclick: () => this.#openRegion() }, "Finer grid");
  #region;
  #cursor;
  #figure;
  #begin = generations();
  /** Opens the form for a finer grid; each drawing sets it. @type {(range?: any) => void} */
  #chooseRegion = () => {};
  /** Values that the slice drawn last holds: a finer grid belongs to the slice that is shown. */
  #sliceBefore = "";

  /** @param {Context} context @param {Own | null} [own] */
  constructor(context, own = null) {
    this.#context = context;
    this.#own = own;
    this.#region = new FinerGrid(context);
    this.#cursor = keyboard(this.#place, (ordinal) => context.open(ordinal, chosenIn(context, own).colour));
    this.#figure = h("figure", {}, this.#place, this.#caption, this.#cursor.element);
    this.element = h("div", {}, this.#controls, this.#empty, this.#figure, this.#region.element);
    this.#region.element.addEventListener("closed", () => {
      this.#sayRegion();
      adjust(this.#place, { dragmode: "zoom" });
    });
    this.#place.addEventListener("chosen", (event) => {
      const { detail } = /** @type {CustomEvent} */ (event);
      if (detail) this.#chooseRegion(detail);
    });
    this.#place.addEventListener("pointclick", (event) => {
      const ordinal = /** @type {CustomEvent} */ (event).detail.points[0].customdata;
      if (typeof ordinal === "number") context.open(ordinal, chosenIn(context, own).colour);
    });
  }

  #openRegion() {
    this.#chooseRegion();
    adjust(this.#place, { dragmode: "select" });
  }

  #sayRegion() {
    this.#finerButton.setAttribute("aria-expanded", String(this.#region.isOpen));
  }

  async redraw() {
    const isNewest = this.#begin();
    const context = this.#context;
    const chosen = chosenIn(context, this.#own);
    if (!chosen.x) {
      fill(this.element, h("p", { class: "empty" }, "This sweep varies nothing: see its table."));
      return;
    }
    const slice = await readSlice(context, chosen, this.#own);
    if (!isNewest()) return;
    fill(this.#controls, this.#controlsPart(chosen, slice));
    this.#updateRegion(chosen, slice);
    const { states } = slice;
    const isAllFailed =
      !this.#own &&
      !context.query.has("colour") &&
      states.length > 0 &&
      states.every((state) => state === "failed");
    this.#empty.hidden = !isAllFailed;
    this.#figure.hidden = isAllFailed;
    if (isAllFailed) {
      fill(
        this.#empty,
        "All points of this sweep failed. The reasons are under ",
        h("a", { href: link(["sweeps", context.sweep.id], { view: "failures" }) }, "Failures"),
        ".",
      );
      return;
    }
    this.#describe(chosen, slice);
    // The size decides whether values are printed.
    await laidOut(this.#place, context.signal);
    if (!isNewest()) return;
    await (chosen.y === undefined
      ? this.#drawLine(chosen, slice)
      : this.#drawArea({ ...chosen, y: chosen.y }, slice));
  }

  /** @param {Chosen} chosen @param {Slice} slice */
  #controlsPart({ x, y, colour, results, isLog, style }, { values, held, isGrid }) {
    const { axes } = this.#context;
    const set = (/** @type {string} */ name) => (/** @type {string} */ value) => {
      this.#context.keep({ [name]: value });
      attend(this.redraw(), this.#context.signal);
    };
    const named = (/** @type {string[]} */ names) =>
      names.map((name) => /** @type {[string, string]} */ ([name, this.#context.depths.label(name)]));
    const words = isText(values);
    return [
      choice("Across", named(axes), x, set("x")),
      y && choice("Up", named(axes.filter((axis) => axis !== x)), y, set("y")),
      results.length > 1 && choice(y ? "Colour" : "Result", named(results), colour, set("colour")),
      !words &&
        choice(
          "Scale",
          [
            ["linear", "linear"],
            ["log", "logarithmic"],
          ],
          isLog ? "log" : "linear",
          set("scale"),
        ),
      y &&
        isGrid &&
        !words &&
        choice(
          "Drawn as",
          [
            ["cells", "cells"],
            ["contour", "contours"],
          ],
          style,
          set("style"),
        ),
      this.#finerButton,
      ...(isGrid ? held : []).map(({ axis, all, value }) =>
        choice(
          label(axis),
          all.map((entry) => [String(entry), say(axis, entry)]),
          String(value),
          set(`at.${axis}`),
        ),
      ),
    ];
  }

  /** Binds the finer grid to the slice that is shown, and opens it for the region of the link. @param {Chosen} chosen @param {Slice} slice */
  #updateRegion({ x, y }, slice) {
    const sides = y ? [x, y] : [x];
    this.#chooseRegion = (range) => {
      this.#region.choose(regionSides(sides, range, slice), furtherOf(this.#context, slice));
      this.#sayRegion();
    };
    const kept = this.#region.kept(sides);
    const key = (slice.isGrid ? slice.held : []).map(({ value }) => value).join(",");
    if (kept && (!this.#region.isOpen || key !== this.#sliceBefore))
      this.#region.choose(kept, furtherOf(this.#context, slice));
    this.#sliceBefore = key;
    this.#sayRegion();
  }

  /** @param {Chosen} chosen @param {Slice} slice */
  #describe({ x, y, colour, isLog, style }, slice) {
    const { rows, values, isGrid, ordinals } = slice;
    const { depths, biases, sweep } = this.#context;
    const done = rows.filter((index) => values[index] !== null).length;
    const hidden =
      isLog && !isText(values)
        ? rows.filter((index) => typeof values[index] === "number" && Number(values[index]) <= 0).length
        : 0;
    fill(
      this.#caption,
      `${depths.label(colour)}: ${done} of ${rows.length} points have a value. Select a point to open it, or go over them by arrow keys and open by Enter. `,
      y !== undefined &&
        isGrid &&
        (style === "contour" && !isText(values)
          ? "The dots are samples; colours and lines between them are interpolated. "
          : "Each cell has the colour of the sample in it. "),
      y !== undefined && isGrid && ringsPart(sweep.id, colour, { rows, values, ordinals }),
      `${signRules([colour])} `,
      biases.say(colour),
      hidden ? ` ${hidden} are not positive and have no place on a logarithmic scale.` : "",
    );
    this.#place.setAttribute("aria-label", `${label(colour)} over ${label(x)}${y ? ` and ${label(y)}` : ""}`);
  }

  /** @param {string} name of a parameter */
  #axisLayout(name) {
    return {
      title: title(name),
      quantity: name,
      type: this.#context.spans[name]?.scale === "log" ? "log" : "linear",
    };
  }

  /** Draws a result over one parameter. @param {Chosen} chosen @param {Slice} slice */
  async #drawLine({ x, colour, isLog }, slice) {
    const { rows, ordinals, xs, values, doubts } = slice;
    const texts = textsOf(this.#context, { x, y: undefined, colour }, slice);
    const at = scaled([x, colour]);
    const words = isText(values) ? wordsOf(colour, values) : null;
    const order = rows
      .map((_, position) => position)
      .filter((position) => !words || values[rows[position]] !== null)
      .sort((a, b) => Number(xs[rows[a]]) - Number(xs[rows[b]]));
    const points = order.map((position, column) => {
      const value = values[rows[position]];
      return {
        x: at(x, xs[rows[position]]),
        y: typeof value === "string" ? spoken(value) : at(colour, value),
        column,
        row: 0,
        ordinal: Number(ordinals[rows[position]]),
        text: texts[position],
      };
    });
    const ofWord = (/** @type {string} */ word) =>
      wordColour(colour, word, WORDS[(words ?? []).indexOf(word) % WORDS.length]);
    const trace = {
      type: "scatter",
      mode: words ? "markers" : "lines+markers",
      x: points.map((point) => point.x),
      y: points.map((point) => point.y),
      text: points.map(({ text }) => text),
      customdata: order.map((position) => ordinals[rows[position]]),
      marker: {
        size: words ? 12 : 8,
        color: words ? order.map((position) => ofWord(String(values[rows[position]]))) : LINES[0],
        symbol: order.map((position) => (doubts(rows[position]) ? "x" : "circle")),
      },
      line: { color: LINES[0] },
    };
    await this.#draw([trace], {
      ...this.#cursor.over(points.filter(({ y }) => y !== null && y !== undefined)),
      xaxis: this.#axisLayout(x),
      yaxis: {
        title: this.#context.depths.title(colour),
        quantity: colour,
        ...(words ? { categoryarray: words.map(spoken).reverse() } : { type: isLog ? "log" : "linear" }),
      },
    });
  }

  /** Draws a result over two parameters. @param {Chosen & {y: string}} chosen @param {Slice} slice */
  async #drawArea(chosen, slice) {
    const { x, y, colour } = chosen;
    const { rows, ordinals, xs, ys, states, doubts } = slice;
    const texts = textsOf(this.#context, chosen, slice);
    const at = scaled([x, y, colour]);
    const colours = coloursOf(this.#context, chosen, slice, at);
    const [columnOf, rowOf] = [xs, ys].map(
      (column) => new Map(distinct(rows.map((index) => column[index])).map((value, rank) => [value, rank])),
    );
    const places = rows.map((index, position) => ({
      x: at(x, xs[index]),
      y: at(y, ys[index]),
      column: columnOf.get(/** @type {number} */ (xs[index])) ?? 0,
      row: rowOf.get(/** @type {number} */ (ys[index])) ?? 0,
      ordinal: Number(ordinals[index]),
      text: texts[position],
    }));
    const traces = slice.isGrid
      ? [
          ...cellTraces(this.#context, chosen, slice, { texts, colours, at }),
          ...sampleTraces(samplesOf(places, colour, slice, { colours, at }), this.#place),
        ]
      : [markTrace(chosen, slice, { texts, colours, at })];
    // The colour of a class shows failures itself, and lies under crosses of any colour.
    const isClass = colour === CLASS;
    const failed = isClass ? [] : rows.filter((index) => states[index] === "failed");
    if (failed.length) traces.push(crosses("failed", failed, { symbol: "x" }, chosen, slice, at));
    const doubtful = rows.filter((index) => doubts(index));
    if (doubtful.length) {
      const thin = { symbol: "x-thin-open", line: { width: doubtful.length > MANY ? 1 : 2 } };
      const rimmed = { symbol: "x", color: inks().text, line: { width: 1, color: inks().panel } };
      const name = this.#own ? "uncertain" : NOT_SETTLED;
      traces.push(crosses(name, doubtful, isClass ? rimmed : thin, chosen, slice, at));
    }
    const axis = (/** @type {string} */ name, /** @type {Values} */ column) => ({
      ...this.#axisLayout(name),
      ...(slice.isGrid ? { range: rangeOf(this.#context, name, rows, column, at) } : {}),
    });
    await this.#draw(traces, { ...this.#cursor.over(places), xaxis: axis(x, xs), yaxis: axis(y, ys) });
  }

  /** @param {any[]} traces @param {any} layout */
  async #draw(traces, layout) {
    const dragmode = this.#region.isOpen ? "select" : "zoom";
    await draw(this.#place, traces, { ...layout, dragmode }, this.#context.signal);
  }
}

/** @param {Context} context @param {Own | null} [own] @returns {Chosen} */
function chosenIn({ axes, table, query }, own) {
  const get = (/** @type {string} */ name, /** @type {string} */ other) => query.get(name) ?? other;
  const x = axes.includes(get("x", "")) ? get("x", "") : axes[0];
  const others = axes.filter((axis) => axis !== x);
  const y = others.includes(get("y", "")) ? get("y", "") : others[0];
  const results = own ? [own.name] : table.results().filter((name) => !axes.includes(name));
  const asked = get("colour", "");
  const colour = own?.name ?? (results.includes(asked) ? asked : preferred(results));
  return {
    x,
    y,
    colour,
    results,
    held: others.filter((axis) => axis !== y),
    isLog: get("scale", "linear") === "log",
    style: get("style", "cells"),
  };
}

/** @param {string} word of a column */
function spoken(word) {
  return word.replaceAll("_", " ");
}

/** Reads the columns that a map shows. @param {Context} context @param {Chosen} chosen @param {Own | null} own @returns {Promise<Slice>} */
async function readSlice({ sweep, table, query }, { x, y, colour, held: heldNames }, own) {
  const present = SETTLING.filter((name) => table.names.includes(name));
  const [ordinals, states, xs, ys, found, ...others] = await table.columns(
    "ordinal",
    "state",
    x,
    y ?? x,
    own ? "state" : colour,
    ...heldNames,
    ...present,
  );
  const settling = others.slice(heldNames.length);
  const settlingOf = (/** @type {string} */ name, /** @type {number} */ index) =>
    settling[present.indexOf(name)]?.[index];
  const values = own ? ordinals.map((ordinal) => own.wordOf(Number(ordinal))) : found;
  const doubts = (/** @type {number} */ index) => {
    if (own) return own.doubtOf(Number(ordinals[index]));
    const isDoubtful = isUnsettled(settlingOf("motion_regime", index), settlingOf("growing_mode_hz", index));
    return isDoubtful ? NOT_SETTLED : "";
  };
  const held = heldNames.map((axis, index) => {
    const all = distinct(others[index]);
    const asked = Number(query.get(`at.${axis}`) ?? "");
    return {
      axis,
      all,
      value: query.has(`at.${axis}`) && all.includes(asked) ? asked : all[0],
      column: others[index],
    };
  });
  // A request that is too long for the answer lists its points or values.
  const { axes: spans, design = "grid" } = sweep.request ?? { design: "list" };
  const isGrid =
    !y ||
    (spans && design === "grid") ||
    (!DRAWN.includes(design) && distinct(xs).length * distinct(ys).length <= 4 * xs.length + 16);
  // A design that draws its points has no slices: all of them are shown.
  const slices = isGrid ? held : [];
  const rows = ordinals
    .map((_, index) => index)
    .filter((index) => slices.every(({ column, value }) => column[index] === value));
  return { ordinals, states, xs, ys, values, held, isGrid, rows, doubts };
}

/**
 * Sides of the region for a finer grid.
 * @param {string[]} sides names of the parameters across and up
 * @param {any} range of the picture that was dragged over, in the units shown; the whole map if it is absent
 * @param {Slice} slice
 */
function regionSides(sides, range, { xs, ys }) {
  return sides.map((name, order) => {
    const values = distinct(order ? ys : xs).map(Number);
    const shownRange = range?.[order ? "y" : "x"]
      ?.map((/** @type {number} */ end) => end * unit(name).size)
      .sort((/** @type {number} */ a, /** @type {number} */ b) => a - b);
    // Cells reach beyond the values that they stand for.
    const [from, to] = shownRange ?? [values[0], values.at(-1) ?? values[0]];
    return { name, from: Math.max(from, values[0]), to: Math.min(to, values.at(-1) ?? to), count: 0 };
  });
}

/** Parameters that a finer grid holds: at the slice that is shown, or free where all points are shown. @param {Context} context @param {Slice} slice */
function furtherOf({ query, spans }, { held, isGrid }) {
  return held.map(({ axis, all, value }) => {
    if (isGrid) return { name: axis, value: Number(value), isFree: false };
    const asked = Number(query.get(`at.${axis}`) || NaN);
    return {
      name: axis,
      value: Number.isFinite(asked) ? asked : middle(all.map(Number), spans[axis]),
      isFree: true,
    };
  });
}

/**
 * A conversion to the units shown, which looks up each name once and not for each of a hundred thousand points.
 * @param {string[]} names
 */
function scaled(names) {
  const sizes = new Map(names.map((name) => [name, unit(name).size]));
  return (/** @type {string} */ name, /** @type {any} */ value) =>
    typeof value === "number" ? value / (sizes.get(name) ?? 1) : value;
}

/** Texts of the points, in the order of the rows. @param {Context} context @param {{x: string, y: string | undefined, colour: string}} chosen @param {Slice} slice */
function textsOf({ depths, biases }, { x, y, colour }, { rows, ordinals, states, xs, ys, values, doubts }) {
  const part = (/** @type {string} */ name) => {
    const [called, words] = [depths.label(name), sayer(name)];
    return (/** @type {any} */ value) => `${called} ${words(value)}`;
  };
  const [ofX, ofY, ofValue] = [once(part(x)), once(y ? part(y) : () => ""), part(colour)];
  return rows.map((index) => {
    const bias = typeof values[index] === "number" ? biases.beside(colour, Number(ordinals[index])) : "";
    return `point ${ordinals[index]}: ${states[index]}${doubts(index) && `, ${doubts(index)}`}<br>${ofX(xs[index])}<br>${y ? `${ofY(ys[index])}<br>` : ""}${ofValue(values[index])}${bias}`;
  });
}

/** @typedef {(name: string, value: any) => any} Scaled */

/**
 * Values that colour the points, with their scale and the bar next to it.
 * @typedef {{z: (number | null)[], words: boolean, scale: any, bar: any, count: number}} Colours
 */

/** @param {Context} context @param {Chosen} chosen @param {Slice} slice @param {Scaled} at @returns {Colours} */
function coloursOf({ depths }, { colour, isLog }, { rows, values }, at) {
  if (isText(values)) {
    // The bar begins below: the most severe class stands at its top.
    const vocabulary = colour === CLASS ? wordsOf(colour, values).reverse() : wordsOf(colour, values);
    const count = Math.max(vocabulary.length, 1);
    const discrete = Array.from({ length: count }, (_, index) => {
      const ofWord = wordColour(colour, vocabulary[index] ?? "", WORDS[index % WORDS.length]);
      return [
        [index / count, ofWord],
        [(index + 1) / count, ofWord],
      ];
    }).flat();
    return {
      z: rows.map((index) => (values[index] === null ? null : vocabulary.indexOf(String(values[index])))),
      words: true,
      scale: { colorscale: discrete, zmin: -0.5, zmax: count - 0.5 },
      bar: {
        ...colourBar(depths.label(colour)),
        tickvals: vocabulary.map((_, index) => index),
        ticktext: vocabulary.map(spoken),
      },
      count,
    };
  }
  const { size } = unit(colour);
  const logged = (/** @type {any} */ value) =>
    typeof value === "number" && value > 0 ? Math.log10(value) - Math.log10(size) : null;
  const z = rows.map((index) => (isLog ? logged(values[index]) : at(colour, values[index])));
  const finite = /** @type {number[]} */ (z.filter((value) => value !== null));
  const least = finite.reduce((a, b) => Math.min(a, b), Infinity);
  const largest = finite.reduce((a, b) => Math.max(a, b), -Infinity);
  return {
    z,
    words: false,
    scale: { ...(finite.length ? { zmin: least, zmax: largest } : {}) },
    bar: { ...colourBar(depths.title(colour)), ...(isLog && finite.length ? logTicks(least, largest) : {}) },
    count: 1,
  };
}

/** @typedef {{texts: string[], colours: Colours, at: Scaled}} Drawn */

/** The points of grids as cells or contours, a trace for each grid. @param {Context} context @param {Chosen & {y: string}} chosen @param {Slice} slice @param {Drawn} drawn @returns {any[]} */
function cellTraces(
  { sweep, paths, spans },
  { x, y, style },
  { rows, ordinals, xs, ys },
  { texts, colours: { z, words, scale, bar }, at },
) {
  const requests = [sweep.request, ...(sweep.appended ?? [])].map((request) => ({
    x: request?.axes?.[paths[x] ?? x],
    y: request?.axes?.[paths[y] ?? y],
  }));
  const [isLogX, isLogY] = [x, y].map((name) => spans[name]?.scale === "log");
  const [allX, allY] = [xs, ys].map((column) => distinct(rows.map((index) => column[index])).map(Number));
  const layers = layered(
    rows.map((index) => Number(xs[index])),
    rows.map((index) => Number(ys[index])),
    requests,
  );
  return layers.map(({ across, up, at: positions }, order) => {
    const cells = (/** @type {(position: number) => any} */ value, /** @type {any} */ none) =>
      positions.map((line) => line.map((position) => (position === undefined ? none : value(position))));
    const gap = words || up.length * across.length > 900 ? 0 : 1;
    const isContour = style === "contour" && !words && across.length > 1 && up.length > 1;
    return {
      type: isContour ? "contour" : "heatmap",
      x: (isContour ? across : ends(across, allX, isLogX)).map((value) => at(x, value)),
      y: (isContour ? up : ends(up, allY, isLogY)).map((value) => at(y, value)),
      z: cells((position) => z[position], null),
      text: cells((position) => texts[position], ""),
      customdata: cells((position) => ordinals[rows[position]], null),
      hoverongaps: order === 0,
      colorbar: bar,
      showscale: order === 0,
      ...scale,
      xgap: gap,
      ygap: gap,
      line: { color: inks().panel, width: 0.7 },
    };
  });
}

/**
 * Samples of a grid: places with their values and inks.
 * @param {import("../draw/point-cursor.js").Place[]} places in the order of the rows
 * @param {string} colour
 * @param {Slice} slice
 * @param {{colours: Colours, at: Scaled}} drawn
 * @returns {import("../draw/samples.js").Sample[]}
 */
function samplesOf(places, colour, { rows, values }, { colours: { z, words, scale }, at }) {
  const inkOf = (/** @type {any} */ value, /** @type {number | null} */ shade) => {
    if (shade === null) return inks().soft;
    if (colour === CLASS) return inkOnClass(String(value));
    if (words) return theme() === "dark" ? BLACK : WHITE;
    return inkOn(shade, [scale.zmin, scale.zmax]);
  };
  return places.map(({ x, y, column, row, ordinal, text }, position) => {
    const [value, shade] = [values[rows[position]], z[position]];
    return {
      x,
      y,
      column,
      row,
      text,
      key: ordinal,
      value: typeof value === "number" ? at(colour, value) : null,
      ink: inkOf(value, shade),
    };
  });
}

/**
 * Range of an axis about the samples of a grid; undefined of a single value.
 * @param {Context} context @param {string} name @param {number[]} rows @param {Values} column @param {Scaled} at
 */
function rangeOf({ spans }, name, rows, column, at) {
  const values = distinct(rows.map((index) => column[index])).map((value) => at(name, Number(value)));
  return sampledRange(values, spans[name]?.scale === "log");
}

/**
 * The samples that are ringed, with links to them.
 * @param {string} id of the sweep @param {string} colour @param {{rows: number[], values: Values, ordinals: Values}} slice
 */
function ringsPart(id, colour, { rows, values, ordinals }) {
  const found = extremes(
    rows.map((index) => ({
      value: typeof values[index] === "number" ? Number(values[index]) : null,
      ordinal: Number(ordinals[index]),
    })),
  );
  if (!found) return null;
  const [least, largest] = found.map(({ value, ordinal }, order) => [
    `${order ? "largest" : "least"} ${say(colour, value)} at `,
    h("a", { href: link(["sweeps", id, "points", String(ordinal)]) }, `point ${ordinal}`),
  ]);
  return ["Ringed: ", ...least, ", ", ...largest, ". "];
}

/** Points that form no grid as marks. @param {Chosen & {y: string}} chosen @param {Slice} slice @param {Drawn} drawn @returns {any} */
function markTrace(
  { x, y },
  { rows, ordinals, xs, ys },
  { texts, colours: { z, words, scale, bar, count }, at },
) {
  const isMany = rows.length > MANY;
  const marker = {
    size: isMany ? 5 : 9,
    color: z,
    colorscale: words ? scale.colorscale : lineScale(),
    cmin: words ? -0.5 : undefined,
    cmax: words ? count - 0.5 : undefined,
    colorbar: bar,
    line: { width: 0 },
  };
  return {
    type: isMany ? "dots" : "scatter",
    mode: "markers",
    x: rows.map((index) => at(x, xs[index])),
    y: rows.map((index) => at(y, ys[index])),
    text: texts,
    customdata: rows.map((index) => ordinals[index]),
    marker,
  };
}

/**
 * Crosses on some points.
 * @param {string} name
 * @param {number[]} marked
 * @param {any} marker
 * @param {Chosen & {y: string}} chosen
 * @param {Slice} slice
 * @param {Scaled} at
 */
function crosses(name, marked, marker, { x, y }, { ordinals, xs, ys, doubts }, at) {
  const isMany = marked.length > MANY;
  return {
    type: isMany ? "dots" : "scatter",
    mode: "markers",
    name,
    x: marked.map((index) => at(x, xs[index])),
    y: marked.map((index) => at(y, ys[index])),
    customdata: marked.map((index) => ordinals[index]),
    text: marked.map((index) => `point ${ordinals[index]}: ${doubts(index) || name}`),
    marker: { color: "#d55e00", ...marker, size: isMany ? 4 : 9 },
    showlegend: true,
  };
}

/**
 * A function that is called once for each of the few values that it is given.
 * @param {(value: any) => string} of
 */
function once(of) {
  /** @type {Map<any, string>} */
  const known = new Map();
  return (/** @type {any} */ value) => {
    const text = known.get(value) ?? of(value);
    known.set(value, text);
    return text;
  };
}

/**
 * The middle of the values of a parameter, to a few digits.
 * @param {number[]} values in order
 * @param {any} span how the request gives them
 */
function middle(values, span) {
  const [from, to] = [span?.from ?? values[0], span?.to ?? values[values.length - 1]];
  return Number((span?.scale === "log" ? Math.sqrt(from * to) : (from + to) / 2).toPrecision(4));
}
