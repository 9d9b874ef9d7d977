// Two sweeps compared: the difference of a result on the parameters that both have.

import { get, Problem } from "../data/api.js";
import { Biases } from "../data/biases.js";
import { ends } from "../data/grid-layers.js";
import { distinct, SHORT, SweepTable, sweptBy } from "../data/sweep-table.js";
import { label, number, say, title, unit } from "../data/units.js";
import { BLACK, DIVERGING, WHITE } from "../draw/picture/colours.js";
import { canvas, colourBar, DASHES, draw, laidOut, LINES } from "../draw/plots.js";
import { sampledRange, sampleTraces } from "../draw/samples.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { go, link } from "../ui/router.js";
import { preferred, undelayed } from "./part.js";

/** Further parameters that are named, at most, if they differ. */
const DIFFERENCES = 6;
/** Fields of a scenario that do not change what is simulated. */
const NAMES = new Set(["name", "description"]);
/** Coordinates this near to each other, relative to their size, are one. */
const SAME = 1e-9;

/** Columns that are no results. */
const OF_POINTS = ["state", "error_time", "error_node"];

/** @typedef {import("./part.js").Context} Context */
/** @typedef {{sweep: any, table: SweepTable, axes: string[], biases: Biases}} Other */
/** Names of columns: across, up if there are two parameters, and the result. @typedef {{x: string, y: string | undefined, colour: string}} Shown */
/** A point of one sweep. @typedef {{ordinal: number, x: number, y: number, value: number}} Row */
/** A point of this sweep with its partner in the other one, and their difference as it is shown. @typedef {Row & {partner: Row, change: number}} Pair */

/**
 * @param {Context} context
 * @returns {import("./part.js").Part}
 */
export function difference(context) {
  const shown = new Difference(context);
  return {
    element: shown.element,
    draw: undelayed(() => shown.redraw(), context),
    fields: () => shown.fields.mine,
    others: () => shown.others(),
  };
}

class Difference {
  #context;
  #place = canvas("Difference of two sweeps", "difference", "tall");
  #caption = h("figcaption", {});
  #controls = h("div", { class: "controls" });
  #empty = h("p", { class: "empty", hidden: true });
  #figure = h("figure", {}, this.#place, this.#caption);
  #search;
  #searched;
  #begin = generations();
  /** Sweeps that can be chosen. @type {any[] | undefined} */
  #sweeps;
  /** @type {Other | undefined} */
  #other;
  /** Points whose scenarios were requested, by address. @type {Map<string, Promise<any>>} */
  #points = new Map();
  /** Columns that are shown, of this sweep and of the other one. */
  fields = { mine: ["ordinal"], theirs: ["ordinal"] };

  /** @param {Context} context */
  constructor(context) {
    this.#context = context;
    this.#search = h("input", {
      type: "search",
      size: 16,
      placeholder: "part of a name",
      oninput: debounced(() => attend(this.#find(), context.signal), 250, context.signal),
    });
    this.#searched = h("label", { class: "field" }, h("span", {}, "Search sweeps"), this.#search);
    this.element = h("div", {}, this.#controls, this.#empty, this.#figure);
    this.#place.addEventListener("pointclick", (event) => {
      const points = /** @type {CustomEvent} */ (event).detail.points[0].customdata;
      if (typeof points === "string") go(link(["compare"], { points, view: "profiles" }));
    });
  }

  /** The other sweep with its columns that are shown. */
  others() {
    const other = this.#other;
    if (!other || this.#context.query.get("with") !== other.sweep.id) return [];
    return [{ id: other.sweep.id, path: other.table.path, fields: other.table.served(this.fields.theirs) }];
  }

  /** @param {string} name of a choice in the link */
  #set(name) {
    return (/** @type {string} */ value) => {
      this.#context.keep({ [name]: value || null });
      attend(this.redraw(), this.#context.signal);
    };
  }

  /** @param {string} name of a choice in the link @param {string[]} options @param {string} other the usual one */
  #pick(name, options, other) {
    const asked = this.#context.query.get(name);
    return asked !== null && options.includes(asked) ? asked : other;
  }

  /** Offers the newest sweeps whose names have the text of the search. */
  async #find() {
    const name = this.#search.value.trim();
    const answer = await get("/v1/sweeps", { limit: 100, name }, this.#context.signal);
    if (name !== this.#search.value.trim()) return;
    this.#sweeps = answer.sweeps.filter((/** @type {any} */ sweep) => sweep.id !== this.#context.sweep.id);
    await this.redraw();
  }

  async redraw() {
    if (!this.#sweeps) return this.#find();
    const isNewest = this.#begin();
    const lost = await this.#load(isNewest);
    if (lost === null) return undefined;
    const other = this.#other;
    const whom = [this.#searched, this.#chooser()];
    if (!other)
      return this.#refuse(
        whom,
        `${lost}Choose the sweep whose results are compared with those of this one, at the points that both have.`,
      );
    const context = this.#context;
    const { axes, results } = inCommon(context, other);
    if (!axes.length) return this.#refuse(whom, "The two sweeps have no parameter in common.");
    if (!results.length) return this.#refuse(whom, "The two sweeps have no result in common.");
    const x = this.#pick("x", axes, axes[0]);
    const others = axes.filter((axis) => axis !== x);
    const shown = {
      x,
      y: others.length ? this.#pick("y", others, others[0]) : undefined,
      colour: this.#pick("colour", results, preferred(results)),
    };
    const mine = await this.#slice(context.table, context.axes, "at.", shown);
    if (!isNewest()) return undefined;
    const theirs = await this.#slice(other.table, other.axes, "with.", shown, mine.held);
    if (!isNewest()) return undefined;
    this.#fillControls([whom, this.#columnChoices(shown, axes, results), mine.choices, theirs.choices]);
    this.fields = {
      mine: columnsOf(context.axes, shown.colour),
      theirs: columnsOf(other.axes, shown.colour),
    };
    context.drawn();
    const pairs = pairsOf(mine.rows, theirs.rows, this.#isRelative ? null : unit(shown.colour).size);
    if (!pairs.length) {
      this.#say(
        mine.rows.length && theirs.rows.length
          ? "The sweeps have no point with the same parameters. Choose other values of the held parameters."
          : "One of the two has no results yet.",
      );
      return undefined;
    }
    this.#say("");
    return this.#draw(pairs, shown, other);
  }

  get #isRelative() {
    return this.#context.query.get("difference") === "relative";
  }

  /**
   * Loads the other sweep of the link, unless it is loaded.
   * @param {() => boolean} isNewest
   * @returns {Promise<string | null>} why it could not be found, empty if it was; `null` if another drawing has begun since
   */
  async #load(isNewest) {
    const { query, signal } = this.#context;
    const id = query.get("with") ?? "";
    if (this.#other?.sweep.id === id) return "";
    let lost = "";
    const loaded = id
      ? await loadOther(id, signal).catch((error) => {
          if (!(error instanceof Problem) || error.status !== 404) throw error;
          lost = `The sweep of the link was not found: ${error.message}. `;
        })
      : undefined;
    if (!isNewest()) return null;
    this.#other = loaded ?? undefined;
    return lost;
  }

  /** The choice of the other sweep. */
  #chooser() {
    const [sweeps, other] = [this.#sweeps ?? [], this.#other];
    const offered =
      other && !sweeps.some((sweep) => sweep.id === other.sweep.id) ? [...sweeps, other.sweep] : sweeps;
    const options = offered.map((sweep) => /** @type {[string, string]} */ ([sweep.id, nameOf(sweep)]));
    return choice(
      "Compared with",
      [["", "— choose a sweep"], ...options],
      other?.sweep.id ?? "",
      this.#set("with"),
    );
  }

  /** @param {Shown} shown @param {string[]} axes @param {string[]} results */
  #columnChoices({ x, y, colour }, axes, results) {
    const options = (/** @type {string[]} */ names) =>
      names.map((name) => /** @type {[string, string]} */ ([name, this.#context.depths.label(name)]));
    return [
      choice("Across", options(axes), x, this.#set("x")),
      y && choice("Up", options(axes.filter((axis) => axis !== x)), y, this.#set("y")),
      choice("Result", options(results), colour, this.#set("colour")),
      choice(
        "Difference",
        [
          ["absolute", "absolute"],
          ["relative", "relative to this sweep"],
        ],
        this.#isRelative ? "relative" : "absolute",
        this.#set("difference"),
      ),
    ];
  }

  /** Fills the controls; the search keeps the focus. @param {any[]} controls */
  #fillControls(controls) {
    const hadFocus = document.activeElement === this.#search;
    fill(this.#controls, controls);
    if (hadFocus) this.#search.focus();
  }

  /** Shows a sentence in place of the picture. @param {HTMLElement[]} whom the choice of the other sweep @param {string} text */
  #refuse(whom, text) {
    this.#fillControls(whom);
    this.#say(text);
  }

  /** Shows a sentence in place of the picture; the picture if it is empty. @param {string} text */
  #say(text) {
    this.#empty.hidden = text === "";
    this.#figure.hidden = text !== "";
    this.#empty.textContent = text;
  }

  /**
   * Rows of a slice that have a value, and a choice for each further parameter, which the link keeps under `prefix`.
   * @param {SweepTable} table
   * @param {string[]} axes
   * @param {string} prefix
   * @param {Shown} shown
   * @param {Map<string, number>} [elsewhere] values that the other sweep holds, taken if they exist here
   */
  async #slice(table, axes, prefix, { x, y, colour }, elsewhere = new Map()) {
    const { query } = this.#context;
    const further = axes.filter((axis) => axis !== x && axis !== y);
    const [ordinals, xs, ys, values, ...columns] = await table.columns(
      "ordinal",
      x,
      y ?? x,
      colour,
      ...further,
    );
    const held = new Map(
      further.map((axis, index) => {
        const all = distinct(columns[index]).map(Number);
        const asked = query.has(prefix + axis) ? Number(query.get(prefix + axis)) : elsewhere.get(axis);
        return [axis, all.find((value) => asked !== undefined && isSame(value, asked)) ?? all[0]];
      }),
    );
    const choices = further.map((axis, index) =>
      choice(
        prefix === "at." ? label(axis) : `${label(axis)}, other sweep`,
        distinct(columns[index]).map((value) => [String(value), say(axis, value)]),
        String(held.get(axis)),
        this.#set(prefix + axis),
      ),
    );
    const isHeld = (/** @type {number} */ row) =>
      typeof values[row] === "number" &&
      further.every((axis, index) => columns[index][row] === held.get(axis));
    const rows = ordinals.flatMap((ordinal, row) =>
      isHeld(row)
        ? [{ ordinal: Number(ordinal), x: Number(xs[row]), y: Number(ys[row]), value: Number(values[row]) }]
        : [],
    );
    return { held, choices, rows };
  }

  /** @param {Pair[]} pairs @param {Shown} shown @param {Other} other */
  async #draw(pairs, shown, other) {
    const { x, y, colour } = shown;
    const context = this.#context;
    const symbol = this.#isRelative ? "%" : unit(colour).symbol;
    // The size decides whether values are printed.
    await laidOut(this.#place, context.signal);
    this.#describe(pairs, shown, other, symbol);
    this.#place.setAttribute(
      "aria-label",
      `difference of ${label(colour)} over ${label(x)}${y ? ` and ${label(y)}` : ""}`,
    );
    const name = `difference of ${context.depths.label(colour)}${symbol ? ` [${symbol}]` : ""}`;
    const points = {
      text: pairs.map((pair) => hoverText(pair, shown, symbol, context.biases, other.biases)),
      keys: pairs.map(
        (pair) => `${context.sweep.id}:${pair.ordinal},${other.sweep.id}:${pair.partner.ordinal}`,
      ),
    };
    const axis = (/** @type {string} */ of) => ({
      title: title(of),
      quantity: of,
      type: context.spans[of]?.scale === "log" ? "log" : "linear",
    });
    const traces = y
      ? [
          cellTrace(pairs, { x, y, spans: context.spans }, name, points),
          ...sampleTraces(samplesOf(pairs, x, y, points), this.#place),
        ]
      : lineTraces(pairs, x, colour, [nameOf(context.sweep), nameOf(other.sweep)], points);
    const about = (/** @type {string} */ of, /** @type {number[]} */ values) => ({
      ...axis(of),
      range: sampledRange(
        values.map((value) => value / unit(of).size),
        context.spans[of]?.scale === "log",
      ),
    });
    const layout = y
      ? {
          xaxis: about(
            x,
            pairs.map((pair) => pair.x),
          ),
          yaxis: about(
            y,
            pairs.map((pair) => pair.y),
          ),
        }
      : {
          xaxis: axis(x),
          yaxis: { title: context.depths.title(colour), quantity: colour, domain: [0.45, 1] },
          yaxis2: { title: name, ...(this.#isRelative ? {} : { quantity: colour }), domain: [0, 0.36] },
        };
    await draw(this.#place, traces, layout, context.signal);
  }

  /** Writes the caption. @param {Pair[]} pairs @param {Shown} shown @param {Other} other @param {string} symbol of the difference */
  #describe(pairs, { x, y, colour }, other, symbol) {
    const context = this.#context;
    const [first, second] = [nameOf(context.sweep), nameOf(other.sweep)];
    const mean = pairs.reduce((sum, { change }) => sum + change, 0) / pairs.length;
    const rms = Math.sqrt(pairs.reduce((sum, { change }) => sum + change ** 2, 0) / pairs.length);
    const biases = [
      [first, context.biases.say(colour)],
      [second, other.biases.say(colour)],
    ].filter(([, found]) => found);
    const further = h("strong", {});
    fill(
      this.#caption,
      `${second} less ${first}, at ${pairs.length} points that both have: mean ${number(mean, 3)} ${symbol}, root mean square ${number(rms, 3)} ${symbol}. Select a point to compare both in full.`,
      biases.map(([name, found]) => ` ${name}: ${found}`),
      further,
    );
    attend(this.#tellApart(further, pairs[0], other, [x, y]), context.signal);
  }

  /**
   * Names the parameters that differ in addition to the results: across and up they are the same, and all others of a slice are the same at any
   * of its points.
   * @param {HTMLElement} place
   * @param {Pair} pair any of the pairs
   * @param {Other} whose the other sweep
   * @param {(string | undefined)[]} shown the parameters across and up
   */
  async #tellApart(place, pair, whose, shown) {
    const { sweep } = this.#context;
    const [here, there] = await Promise.all([
      this.#scenarioOf(sweep.id, pair.ordinal),
      this.#scenarioOf(whose.sweep.id, pair.partner.ordinal),
    ]);
    const differing = apart(here, there).filter(
      ([path]) => !shown.some((axis) => axis === path || (axis && axis === SHORT[path])),
    );
    if (!differing.length) return;
    const words = differing
      .slice(0, DIFFERENCES)
      .map(([path, one, another]) => `${label(path)} ${say(path, another)} instead of ${say(path, one)}`);
    const further = differing.length - words.length;
    fill(
      place,
      ` ${nameOf(whose.sweep)} also has other parameters than ${nameOf(sweep)}: ${words.join(", ")}${further ? `, and ${further} more` : ""}.`,
    );
  }

  /** @param {string} sweep @param {number} ordinal @returns {Promise<any>} */
  async #scenarioOf(sweep, ordinal) {
    const path = `/v1/sweeps/${encodeURIComponent(sweep)}/points/${ordinal}`;
    const known = this.#points.get(path) ?? get(path, {}, this.#context.signal);
    this.#points.set(path, known);
    return (await known).scenario;
  }
}

/** @param {any} sweep @returns {string} */
function nameOf(sweep) {
  return sweep.name ?? `Sweep ${sweep.id.slice(-8)}`;
}

/** @param {string} id @param {AbortSignal} signal @returns {Promise<Other>} */
async function loadOther(id, signal) {
  const sweep = await get(`/v1/sweeps/${encodeURIComponent(id)}`, {}, signal);
  const [table, biases] = [new SweepTable(sweep, signal), new Biases()];
  await Promise.all([table.load(), biases.load(sweep, signal)]);
  return { sweep, table, biases, axes: sweptBy(sweep, table.names).axes };
}

/** Parameters and results that both sweeps have. @param {Context} context @param {Other} other */
function inCommon(context, other) {
  const isResult = (/** @type {string} */ name) =>
    other.table.names.includes(name) &&
    !context.axes.includes(name) &&
    !other.axes.includes(name) &&
    !OF_POINTS.includes(name);
  return {
    axes: context.axes.filter((axis) => other.axes.includes(axis)),
    results: context.table.results().filter(isResult),
  };
}

/**
 * The points of both sweeps at the same parameters.
 * @param {Row[]} mine
 * @param {Row[]} theirs
 * @param {number | null} size served units in one of the shown unit; `null` for differences in per cent
 * @returns {Pair[]}
 */
function pairsOf(mine, theirs, size) {
  const xs = classes([...mine, ...theirs].map((row) => row.x));
  const ys = classes([...mine, ...theirs].map((row) => row.y));
  const cell = (/** @type {Row} */ row) => `${xs.get(row.x)} ${ys.get(row.y)}`;
  const partners = new Map(theirs.map((row) => [cell(row), row]));
  const change = (/** @type {number} */ from, /** @type {number} */ to) =>
    size === null ? (100 * (to - from)) / Math.abs(from) : (to - from) / size;
  const pairs = mine.flatMap((row) => {
    const partner = partners.get(cell(row));
    return partner ? [{ ...row, partner, change: change(row.value, partner.value) }] : [];
  });
  return pairs.filter((pair) => Number.isFinite(pair.change));
}

/** @param {Pair} pair @param {Shown} shown @param {string} symbol of the difference @param {Biases} mine @param {Biases} theirs */
function hoverText(pair, { x, y, colour }, symbol, mine, theirs) {
  return [
    `${label(x)} ${say(x, pair.x)}`,
    y && `${label(y)} ${say(y, pair.y)}`,
    `this: ${say(colour, pair.value)}${mine.beside(colour, pair.ordinal)}`,
    `other: ${say(colour, pair.partner.value)}${theirs.beside(colour, pair.partner.ordinal)}`,
    `difference: ${number(pair.change, 4)} ${symbol}`,
  ]
    .filter(Boolean)
    .join("<br>");
}

/**
 * Differences over two parameters as cells.
 * @param {Pair[]} pairs @param {{x: string, y: string, spans: Record<string, any>}} axes @param {string} name of the difference
 * @param {{text: string[], keys: string[]}} points
 */
function cellTrace(pairs, { x, y, spans }, name, { text, keys }) {
  const across = distinct(pairs.map((pair) => pair.x)).map(Number);
  const up = distinct(pairs.map((pair) => pair.y)).map(Number);
  const [columns, lines] = [ranksOf(across), ranksOf(up)];
  const grid = (/** @type {any} */ filler) => up.map(() => Array(across.length).fill(filler));
  const [cells, hover, points] = [grid(null), grid(""), grid(null)];
  pairs.forEach((pair, index) => {
    const [row, column] = [lines.get(pair.y) ?? 0, columns.get(pair.x) ?? 0];
    [cells[row][column], hover[row][column], points[row][column]] = [pair.change, text[index], keys[index]];
  });
  const largest = largestOf(pairs);
  const at = (/** @type {string} */ axis, /** @type {number[]} */ values) =>
    ends(values, values, spans[axis]?.scale === "log").map((value) => value / unit(axis).size);
  return {
    type: "heatmap",
    x: at(x, across),
    y: at(y, up),
    z: cells,
    text: hover,
    customdata: points,
    colorscale: DIVERGING,
    zmin: -largest,
    zmax: largest,
    colorbar: colourBar(name),
    xgap: 1,
    ygap: 1,
  };
}

/** @param {number[]} values in order @returns {Map<number, number>} the place of each among them */
function ranksOf(values) {
  return new Map(values.map((value, index) => [value, index]));
}

/** Largest difference, which has the darkest colour. @param {Pair[]} pairs */
function largestOf(pairs) {
  return pairs.reduce((most, { change }) => Math.max(most, Math.abs(change)), 0) || 1;
}

/** Part of the largest difference beyond which white is seen better on its colour. */
const DARK = 0.6;

/** @param {Pair[]} pairs @param {string} x @param {string} y @param {{text: string[], keys: string[]}} points @returns {import("../draw/samples.js").Sample[]} */
function samplesOf(pairs, x, y, { text, keys }) {
  const [columns, rows] = [
    ranksOf(distinct(pairs.map((pair) => pair.x)).map(Number)),
    ranksOf(distinct(pairs.map((pair) => pair.y)).map(Number)),
  ];
  const largest = largestOf(pairs);
  return pairs.map((pair, index) => ({
    x: pair.x / unit(x).size,
    y: pair.y / unit(y).size,
    column: columns.get(pair.x) ?? 0,
    row: rows.get(pair.y) ?? 0,
    value: pair.change,
    ink: Math.abs(pair.change) > DARK * largest ? WHITE : BLACK,
    text: text[index],
    key: keys[index],
  }));
}

/**
 * Both results over one parameter, and their difference below.
 * @param {Pair[]} pairs @param {string} x @param {string} colour @param {string[]} names of the sweeps
 * @param {{text: string[], keys: string[]}} points
 */
function lineTraces(pairs, x, colour, [first, second], { text, keys }) {
  const order = pairs.map((_, index) => index).sort((a, b) => pairs[a].x - pairs[b].x);
  const { size } = unit(colour);
  const line = (
    /** @type {string} */ name,
    /** @type {(pair: Pair) => number} */ value,
    /** @type {number} */ place,
    /** @type {any} */ more = {},
  ) => ({
    type: "scatter",
    mode: "lines+markers",
    name,
    showlegend: true,
    x: order.map((index) => pairs[index].x / unit(x).size),
    y: order.map((index) => value(pairs[index])),
    text: order.map((index) => text[index]),
    customdata: order.map((index) => keys[index]),
    line: { color: LINES[place], dash: DASHES[place] },
    ...more,
  });
  return [
    line(first, (pair) => pair.value / size, 0),
    line(second, (pair) => pair.partner.value / size, 1),
    line("difference", (pair) => pair.change, 2, { yaxis: "y2" }),
  ];
}

/**
 * Fields in which two scenarios differ, each with both values.
 * @param {any} one
 * @param {any} another
 * @param {string} [path] where both stand
 * @returns {[path: string, one: unknown, another: unknown][]}
 */
function apart(one, another, path = "") {
  const isBoth = [one, another].every((value) => typeof value === "object" && value !== null);
  if (isBoth && Array.isArray(one) === Array.isArray(another)) {
    const names = [...new Set([...Object.keys(one), ...Object.keys(another)])].filter(
      (name) => path || !NAMES.has(name),
    );
    return names.flatMap((name) =>
      apart(
        one[name],
        another[name],
        Array.isArray(one) ? `${path}[${name}]` : path ? `${path}.${name}` : name,
      ),
    );
  }
  const isSameNumber = typeof one === "number" && typeof another === "number" && isSame(one, another);
  const inWords = (/** @type {unknown} */ value) =>
    value === null || value === undefined ? "none" : typeof value === "object" ? "another" : value;
  return one === another || isSameNumber ? [] : [[path, inWords(one), inWords(another)]];
}

/** @param {string[]} axes @param {string} colour */
function columnsOf(axes, colour) {
  return [...new Set(["ordinal", ...axes, colour])];
}

/**
 * A number for each value: the same one for values that are the same.
 * @param {number[]} values
 */
function classes(values) {
  /** @type {Map<number, number>} */
  const found = new Map();
  let last = NaN;
  for (const value of distinct(values).map(Number)) {
    found.set(value, (isSame(value, last) ? found.get(last) : undefined) ?? found.size);
    last = value;
  }
  return found;
}

/** @param {number} a @param {number} b */
function isSame(a, b) {
  return Math.abs(a - b) <= SAME * Math.max(Math.abs(a), Math.abs(b));
}
