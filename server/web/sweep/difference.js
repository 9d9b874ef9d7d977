// Two sweeps compared: the difference of a result on the parameters that both have.

import { get, Problem } from "../data/api.js";
import { Biases } from "../data/biases.js";
import { choice, debounced, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { canvas, colourBar, DASHES, draw, LINES } from "../draw/plots.js";
import { go, link } from "../ui/router.js";
import { preferred, undelayed } from "./part.js";
import { distinct, SHORT, SweepTable, sweptBy } from "../data/sweep-table.js";
import { label, number, say, title, unit } from "../data/units.js";

/** Blue below, red above, apart by lightness as well for those who cannot tell them. */
const DIVERGING = "RdBu";
/** Of further parameters that differ, how many are told. */
const DIFFERENCES = 6;
/** What tells scenarios apart, but not what they simulate. */
const NAMES = new Set(["name", "description"]);
/** Coordinates this near to each other, relative to their size, are one. */
const SAME = 1e-9;

/** @typedef {{sweep: any, table: SweepTable, axes: string[], biases: Biases}} Other */

/**
 * @param {import("./part.js").Context} context
 * @returns {import("./part.js").Part}
 */
export function difference(context) {
  const { query, signal } = context;
  const place = canvas("Difference of two sweeps", "difference", "tall");
  const caption = h("figcaption", {});
  const controls = h("div", { class: "controls" });
  const empty = h("p", { class: "empty", hidden: true });
  const figure = h("figure", {}, place, caption);
  const begin = generations();
  const pick = (/** @type {string} */ name, /** @type {string[]} */ options, /** @type {string} */ other) =>
    options.includes(query.get(name) ?? "") ? (query.get(name) ?? "") : other;
  const search = h("input", {
    type: "search",
    size: 16,
    placeholder: "part of a name",
    oninput: debounced(() => attend(find(), signal), 250, signal),
  });
  const searched = h("label", { class: "field" }, h("span", {}, "Search sweeps"), search);
  /** Those that can be chosen. @type {any[] | undefined} */
  let sweeps;
  /** The columns that are shown, of this sweep and of the other one. */
  let fields = { mine: ["ordinal"], theirs: ["ordinal"] };
  /** @type {Other | undefined} */
  let other;
  /** Points whose scenarios were asked for, by address. @type {Map<string, Promise<any>>} */
  const scenarios = new Map();

  const nameOf = (/** @type {any} */ sweep) => sweep.name ?? `Sweep ${sweep.id.slice(-8)}`;
  const set = (/** @type {string} */ name) => (/** @type {string} */ value) => {
    context.keep({ [name]: value || null });
    attend(redraw(), signal);
  };
  /** The search is kept, with what is typed in it, while the choices beside it change. @param {HTMLElement[]} whom @param {(import("../ui/dom.js").Child | import("../ui/dom.js").Child[])[]} chosen */
  const choices = (whom, ...chosen) => {
    const hadFocus = document.activeElement === search;
    fill(controls, whom, ...chosen);
    if (hadFocus) search.focus();
  };
  const say_ = (/** @type {string} */ text) => {
    empty.hidden = text === "";
    figure.hidden = text !== "";
    empty.textContent = text;
  };

  /** @param {string} id @returns {Promise<Other>} */
  async function load(id) {
    const sweep = await get(`/v1/sweeps/${encodeURIComponent(id)}`, {}, signal);
    const [table, biases] = [new SweepTable(sweep, signal), new Biases()];
    await Promise.all([table.load(), biases.load(sweep, signal)]);
    return { sweep, table, biases, axes: sweptBy(sweep, table.names).axes };
  }

  /** Offers the newest sweeps whose name has what is searched. */
  async function find() {
    const name = search.value.trim();
    const answer = await get("/v1/sweeps", { limit: 100, name }, signal);
    if (name !== search.value.trim()) return;
    sweeps = answer.sweeps.filter((/** @type {any} */ sweep) => sweep.id !== context.sweep.id);
    await redraw();
  }

  async function redraw() {
    if (!sweeps) return find();
    const isNewest = begin();
    const id = query.get("with") ?? "";
    let lost = "";
    if (other?.sweep.id !== id) {
      const loaded = id
        ? await load(id).catch((error) => {
            if (!(error instanceof Problem) || error.status !== 404) throw error;
            lost = `The sweep of the link was not found: ${error.message}. `;
          })
        : undefined;
      if (!isNewest()) return;
      other = loaded ?? undefined;
    }
    const offered = other && !sweeps.some((sweep) => sweep.id === id) ? [...sweeps, other.sweep] : sweeps;
    const chooser = choice(
      "Compared with",
      [
        ["", "— choose a sweep"],
        ...offered.map((sweep) => /** @type {[string, string]} */ ([sweep.id, nameOf(sweep)])),
      ],
      other ? id : "",
      set("with"),
    );
    const whom = [searched, chooser];
    if (!other) {
      choices(whom);
      say_(
        `${lost}Choose the sweep whose results are compared with those of this one, at the points that both have.`,
      );
      return;
    }
    const axes = context.axes.filter((axis) => other?.axes.includes(axis));
    const results = context.table
      .results()
      .filter(
        (name) =>
          other?.table.names.includes(name) &&
          !context.axes.includes(name) &&
          !other.axes.includes(name) &&
          !["state", "error_time", "error_node"].includes(name),
      );
    if (!axes.length || !results.length) {
      choices(whom);
      say_(
        axes.length
          ? "The two sweeps have no result in common."
          : "The two sweeps have no parameter in common.",
      );
      return;
    }
    const x = pick("x", axes, axes[0]);
    const others = axes.filter((axis) => axis !== x);
    const y = others.length ? pick("y", others, others[0]) : undefined;
    const colour = pick("colour", results, preferred(results));
    const isRelative = query.get("difference") === "relative";
    const options = (/** @type {string[]} */ names) =>
      names.map((name) => /** @type {[string, string]} */ ([name, label(name)]));

    const mine = await sliced(context.table, context.axes, "at.", x, y, colour);
    if (!isNewest()) return;
    const theirs = await sliced(other.table, other.axes, "with.", x, y, colour, mine.held);
    if (!isNewest()) return;
    choices(
      whom,
      choice("Across", options(axes), x, set("x")),
      y && choice("Up", options(others), y, set("y")),
      choice("Result", options(results), colour, set("colour")),
      choice(
        "Difference",
        [
          ["absolute", "absolute"],
          ["relative", "relative to this sweep"],
        ],
        isRelative ? "relative" : "absolute",
        set("difference"),
      ),
      mine.choices,
      theirs.choices,
    );
    fields = { mine: columnsOf(context.axes, colour), theirs: columnsOf(other.axes, colour) };
    context.drawn();
    const xs = classes([...mine.rows, ...theirs.rows].map((row) => row.x));
    const ys = classes([...mine.rows, ...theirs.rows].map((row) => row.y));
    const cell = (/** @type {{x: number, y: number}} */ row) => `${xs.get(row.x)} ${ys.get(row.y)}`;
    const partners = new Map(theirs.rows.map((row) => [cell(row), row]));
    const pairs = mine.rows
      .flatMap((row) => {
        const partner = partners.get(cell(row));
        return partner
          ? [
              {
                ...row,
                partner,
                change: isRelative
                  ? (100 * (partner.value - row.value)) / Math.abs(row.value)
                  : (partner.value - row.value) / unit(colour).size,
              },
            ]
          : [];
      })
      .filter(({ change }) => Number.isFinite(change));
    if (!pairs.length) {
      say_(
        mine.rows.length && theirs.rows.length
          ? "No point of the one has the parameters of one of the other. Choose other values of what is held."
          : "One of the two has no results yet.",
      );
      return;
    }
    say_("");
    const unitOf = isRelative ? "%" : unit(colour).symbol;
    const name = `difference of ${context.depths.label(colour)}${unitOf ? ` [${unitOf}]` : ""}`;
    const [first, second] = [nameOf(context.sweep), nameOf(other.sweep)];
    const mean = pairs.reduce((sum, { change }) => sum + change, 0) / pairs.length;
    const rms = Math.sqrt(pairs.reduce((sum, { change }) => sum + change ** 2, 0) / pairs.length);
    const further = h("strong", {});
    fill(
      caption,
      `${second} less ${first}, at ${pairs.length} points that both have: mean ${number(mean, 3)} ${unitOf}, root mean square ${number(rms, 3)} ${unitOf}. Select a point to compare both in full.`,
      biasesOf(colour, first, second).map((found) => ` ${found}`),
      further,
    );
    attend(tellApart(further, pairs[0].ordinal, other, pairs[0].partner.ordinal, [x, y]), signal);
    place.setAttribute(
      "aria-label",
      `difference of ${label(colour)} over ${label(x)}${y ? ` and ${label(y)}` : ""}`,
    );
    const at = (/** @type {string} */ axis, /** @type {number} */ value) => value / unit(axis).size;
    const text = pairs.map((pair) =>
      [
        `${label(x)} ${say(x, pair.x)}`,
        y && `${label(y)} ${say(y, pair.y)}`,
        `this: ${say(colour, pair.value)}${context.biases.beside(colour, pair.ordinal)}`,
        `other: ${say(colour, pair.partner.value)}${other?.biases.beside(colour, pair.partner.ordinal) ?? ""}`,
        `difference: ${number(pair.change, 4)} ${unitOf}`,
      ]
        .filter(Boolean)
        .join("<br>"),
    );
    const keys = pairs.map(
      (pair) => `${context.sweep.id}:${pair.ordinal},${other?.sweep.id}:${pair.partner.ordinal}`,
    );
    const axisLayout = (/** @type {string} */ axis) => ({
      title: title(axis),
      quantity: axis,
      type: context.spans[axis]?.scale === "log" ? "log" : "linear",
    });
    /** @type {any[]} */
    let traces;
    /** @type {any} */
    let layout;
    if (y) {
      const across = distinct(pairs.map((pair) => pair.x));
      const up = distinct(pairs.map((pair) => pair.y));
      const placeOf = (/** @type {(number | string)[]} */ values) =>
        new Map(values.map((value, index) => [value, index]));
      const [columns, lines] = [placeOf(across), placeOf(up)];
      const grid = (/** @type {any} */ filler) => up.map(() => Array(across.length).fill(filler));
      const [cells, hover, points] = [grid(null), grid(""), grid(null)];
      pairs.forEach((pair, index) => {
        const [row, column] = [lines.get(pair.y) ?? 0, columns.get(pair.x) ?? 0];
        [cells[row][column], hover[row][column], points[row][column]] = [
          pair.change,
          text[index],
          keys[index],
        ];
      });
      const largest = pairs.reduce((most, { change }) => Math.max(most, Math.abs(change)), 0) || 1;
      traces = [
        {
          type: "heatmap",
          x: across.map((value) => at(x, Number(value))),
          y: up.map((value) => at(y, Number(value))),
          z: cells,
          text: hover,
          customdata: points,
          hoverinfo: "text",
          colorscale: DIVERGING,
          reversescale: false,
          zmin: -largest,
          zmax: largest,
          colorbar: colourBar(name),
          xgap: 1,
          ygap: 1,
        },
      ];
      layout = { xaxis: axisLayout(x), yaxis: axisLayout(y) };
    } else {
      const order = pairs.map((_, index) => index).sort((a, b) => pairs[a].x - pairs[b].x);
      const line = (
        /** @type {string} */ called,
        /** @type {(index: number) => number} */ value,
        /** @type {number} */ number,
        /** @type {any} */ more = {},
      ) => ({
        type: "scatter",
        mode: "lines+markers",
        name: called,
        showlegend: true,
        x: order.map((index) => at(x, pairs[index].x)),
        y: order.map(value),
        text: order.map((index) => text[index]),
        customdata: order.map((index) => keys[index]),
        hoverinfo: "text",
        line: { color: LINES[number], dash: DASHES[number] },
        ...more,
      });
      const { size } = unit(colour);
      traces = [
        line(first, (index) => pairs[index].value / size, 0),
        line(second, (index) => pairs[index].partner.value / size, 1),
        line("difference", (index) => pairs[index].change, 2, { yaxis: "y2" }),
      ];
      layout = {
        xaxis: axisLayout(x),
        yaxis: { title: title(colour), quantity: colour, domain: [0.45, 1] },
        yaxis2: { title: name, ...(isRelative ? {} : { quantity: colour }), domain: [0, 0.36] },
      };
    }
    const shape = await draw(place, traces, layout, signal);
    shape.removeAllListeners?.("plotly_click");
    shape.on?.("plotly_click", (/** @type {any} */ event) => {
      const points = event.points[0]?.customdata;
      if (typeof points === "string") go(link(["compare"], { points, view: "profiles" }));
    });
  }

  /**
   * The rows of a slice that have a value, and a choice for each further parameter, which the link keeps under `prefix`.
   * @param {SweepTable} table
   * @param {string[]} axes
   * @param {string} prefix
   * @param {string} x
   * @param {string | undefined} y
   * @param {string} colour
   * @param {Map<string, number>} [elsewhere] what the other sweep holds, which is taken where there is that value
   */
  async function sliced(table, axes, prefix, x, y, colour, elsewhere = new Map()) {
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
        set(prefix + axis),
      ),
    );
    const rows = ordinals.flatMap((ordinal, row) =>
      typeof values[row] === "number" &&
      further.every((axis, index) => columns[index][row] === held.get(axis))
        ? [{ ordinal: Number(ordinal), x: Number(xs[row]), y: Number(ys[row]), value: Number(values[row]) }]
        : [],
    );
    return { held, choices, rows };
  }

  /**
   * Says what else differs between the points of both than their results: across and up they are the same, and all else of a slice is that
   * of any of its points.
   * @param {HTMLElement} place
   * @param {number} mine a point of this sweep
   * @param {Other} whose the other sweep
   * @param {number} theirs its partner there
   * @param {(string | undefined)[]} shown what is across and up
   */
  async function tellApart(place, mine, whose, theirs, shown) {
    const [here, there] = await Promise.all([
      scenarioOf(context.sweep.id, mine),
      scenarioOf(whose.sweep.id, theirs),
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
      ` ${nameOf(whose.sweep)} also has other parameters than ${nameOf(context.sweep)}: ${words.join(", ")}${further ? `, and ${further} more` : ""}.`,
    );
  }

  /** @param {string} sweep @param {number} ordinal @returns {Promise<any>} */
  async function scenarioOf(sweep, ordinal) {
    const path = `/v1/sweeps/${encodeURIComponent(sweep)}/points/${ordinal}`;
    const point = await (scenarios.get(path) ?? scenarios.set(path, get(path, {}, signal)).get(path));
    return point.scenario;
  }

  /** What was found of the biases of both. @param {string} colour @param {string} first @param {string} second */
  function biasesOf(colour, first, second) {
    return [
      [first, context.biases.say(colour)],
      [second, other?.biases.say(colour)],
    ]
      .filter(([, found]) => found)
      .map(([name, found]) => `${name}: ${found}`);
  }

  return {
    element: h("div", {}, controls, empty, figure),
    draw: undelayed(redraw, context),
    fields: () => fields.mine,
    others: () =>
      other && query.get("with") === other.sweep.id
        ? [{ id: other.sweep.id, path: other.table.path, fields: fields.theirs }]
        : [],
  };
}

/**
 * The fields in which two scenarios differ, each with both values.
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
