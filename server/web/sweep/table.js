// The points of a sweep as rows: sorted, filtered, with a choice of columns. Only the rows in sight are in the page.

import { csvOf } from "../data/csv.js";
import { signRules } from "../data/signs.js";
import { isUnsettled, SETTLING } from "../data/statistics.js";
import { aligner, placeIn, rangeOf } from "../data/columns.js";
import { meaning, MINUS, nodeOfColumn, unit } from "../data/units.js";
import { classWord } from "../draw/class-word.js";
import { choice, debounced, download, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { MOST } from "../ui/last-comparison.js";
import { attend } from "../ui/notices.js";
import { link } from "../ui/router.js";
import { CLASS, sortable } from "./categories.js";
import { preferred } from "./part.js";
import { comparePart, tickedIn } from "./ticked.js";

/** Significant digits of the largest number of a column. */
const DIGITS = 5;
const ROW_PX = 30;
const SPARE_ROWS = 12;

/** Results that are shown next to the preferred one, unless columns are chosen. */
const USUAL =
  /^(orbit_radius_rms|friction_coefficient_max|largest_normal_force|whole_error|time_error|resolved_hz|tension_top|torque_top)/;

/** Choices of points by their state. @type {[string, string][]} */
const STATES = [
  ["", "all points"],
  ["state=succeeded", "succeeded"],
  ["state=failed", "failed"],
  ["state=running", "running"],
  ["state=queued", "queued"],
];

/** @typedef {import("./part.js").Context} Context */

/**
 * @param {Context} context
 * @returns {import("./part.js").Part}
 */
export function table(context) {
  const points = new PointTable(context);
  return { element: points.element, draw: () => points.redraw(), fields: () => points.names };
}

/** Points as rows of a table, of which the page has only the rows in sight. */
class PointTable {
  #context;
  #body = h("tbody", {});
  #header = h("tr", {});
  #status = h("p", { class: "soft small", role: "status" });
  #wrong = h("p", { class: "wrong", role: "alert" });
  #columnsPart = h("details", {});
  #filter;
  #scroller;
  #begin = generations();
  /** Places of the shown points in the columns, in the order of the rows. @type {number[]} */
  #rows = [];
  /** @type {import("../data/sweep-table.js").Values[]} */
  #columns = [];
  /** Of each shown column, how its numbers are written and the range of its values. @type {{write: (value: number) => string, range: [number, number] | null}[]} */
  #scales = [];
  /** Names of the shown columns. @type {string[]} */
  names = [];
  /** @type {(index: number) => boolean} */
  #doubts = () => false;
  #isScrolled = false;
  #signs = h("p", { class: "small soft" });
  #compare = h("span", { style: "display:contents" });

  /** @param {Context} context */
  constructor(context) {
    this.#context = context;
    const filtered = debounced(() => attend(this.redraw(), context.signal), 250, context.signal);
    this.#filter = h("input", {
      type: "search",
      value: context.query.get("filter") ?? "",
      placeholder: "e.g. flow_rate>0.02 state=failed",
      size: 34,
      // Anything may draw the view again while the typing rests: the link has the filter before that.
      oninput: () => {
        context.keep({ filter: this.#filter.value || null });
        filtered();
      },
    });
    const grid = h("table", { "aria-label": "Points" }, h("thead", {}, this.#header), this.#body);
    this.#scroller = h(
      "div",
      {
        class: "rows",
        tabindex: "0",
        role: "region",
        "aria-label": "Points, scrollable",
        onscroll: () => this.#scroll(),
      },
      grid,
    );
    const states = choice("Show", STATES, "", (value) => {
      this.#filter.value = value;
      this.#keep({ filter: value || null });
    });
    const controls = h(
      "div",
      { class: "controls" },
      h("label", { class: "field" }, h("span", {}, "Filter, in units as shown"), this.#filter),
      states,
      this.#compare,
      h(
        "button",
        { onclick: () => this.#save(), title: "The rows and columns shown, in SI units" },
        "Save as CSV",
      ),
    );
    this.element = h(
      "div",
      {},
      controls,
      this.#wrong,
      this.#columnsPart,
      this.#status,
      this.#scroller,
      this.#signs,
    );
  }

  /** Keeps choices in the link and shows the points by them. @param {Record<string, string | null>} choices */
  #keep(choices) {
    this.#context.keep(choices);
    attend(this.redraw(), this.#context.signal);
  }

  async redraw() {
    const isNewest = this.#begin();
    const { table: data, query } = this.#context;
    const asked = this.#askedNames();
    const by = query.get("sort") ?? "ordinal";
    const isDown = query.get("order") === "down";
    const { tests, problem } = conditions(this.#filter.value, data.names);
    this.#wrong.textContent = problem;
    const present = SETTLING.filter((name) => data.names.includes(name));
    const found = await data.columns(...asked, by, ...tests.map((test) => test.name), ...present);
    if (!isNewest()) return;
    this.names = asked;
    this.#columns = found.slice(0, asked.length);
    const settling = found.slice(found.length - present.length);
    const settlingOf = (/** @type {string} */ name, /** @type {number} */ index) =>
      settling[present.indexOf(name)]?.[index];
    this.#doubts = (index) =>
      isUnsettled(settlingOf("motion_regime", index), settlingOf("growing_mode_hz", index));
    const all = Array.from({ length: data.rows }, (_, index) => index);
    const kept = all.filter((index) =>
      tests.every((test, order) => test.holds(found[asked.length + 1 + order][index])),
    );
    this.#rows = kept.sort(ordering(sortable(by, found[asked.length]), isDown));
    this.#scales = asked.map((name, order) => this.#scaleOf(name, found[order]));
    fill(
      this.#status,
      `${this.#rows.length === data.rows ? "" : `${this.#rows.length} of `}${data.rows} points`,
    );
    this.#signs.textContent = signRules(asked);
    this.#drawCompare();
    fill(
      this.#header,
      h("th", { scope: "col", style: "width:2rem" }, h("span", { class: "visually-hidden" }, "Compared")),
      asked.map((name) => this.#head(name, name === by, isDown)),
    );
    this.#drawColumns();
    this.#drawRows();
  }

  /** Decimals and range of a column's numbers in the rows. @param {string} name @param {import("../data/sweep-table.js").Values} column */
  #scaleOf(name, column) {
    const { size } = unit(name);
    const values = this.#rows.flatMap((index) => {
      const value = column[index];
      return typeof value === "number" ? [value / size] : [];
    });
    return { write: aligner(values, DIGITS), range: name === "ordinal" ? null : rangeOf(values) };
  }

  /** Columns of the link, or the usual ones. */
  #askedNames() {
    const { table: data, axes, query } = this.#context;
    const asked = (query.get("columns") ?? "").split(",").filter((name) => data.names.includes(name));
    if (asked.length) return asked;
    const results = data.results().filter((name) => !axes.includes(name) && name !== "state");
    const usual = [preferred(results), ...results.filter((name) => USUAL.test(name))];
    const judged = results.filter((name) => name === CLASS);
    return [
      "ordinal",
      "state",
      ...judged,
      ...axes,
      ...new Set(usual.filter((name) => results.includes(name))),
    ];
  }

  /** @param {string} name of a column @param {boolean} isSorted whether rows are sorted by it @param {boolean} isDown */
  #head(name, isSorted, isDown) {
    const { biases } = this.#context;
    const first = this.#columns[this.names.indexOf(name)]?.find((value) => value !== null);
    const width = name === "ordinal" ? 5 : name === "state" ? 8 : 10;
    const sort = h(
      "button",
      { onclick: () => this.#keep({ sort: name, order: isSorted && !isDown ? "down" : null }) },
      name === "ordinal" ? "Point" : this.#context.depths.title(name),
      isSorted ? (isDown ? " ▼" : " ▲") : "",
    );
    const attributes = {
      class: typeof first === "number" ? "number" : "",
      scope: "col",
      style: `width:${width}rem;white-space:normal`,
      "aria-sort": isSorted && (isDown ? "descending" : "ascending"),
      title: meaning(name),
    };
    return h(
      "th",
      attributes,
      sort,
      biases.brief(name) && h("div", { title: biases.say(name) }, biases.brief(name)),
    );
  }

  #drawRows() {
    const { scrollTop, clientHeight } = this.#scroller;
    const first = Math.max(0, Math.floor(scrollTop / ROW_PX) - SPARE_ROWS);
    const last = Math.min(
      this.#rows.length,
      Math.ceil((scrollTop + (clientHeight || 800)) / ROW_PX) + SPARE_ROWS,
    );
    const gap = (/** @type {number} */ count) =>
      count > 0 &&
      h(
        "tr",
        { class: "gap", "aria-hidden": "true" },
        h("td", { colspan: this.names.length + 1, style: `height:${count * ROW_PX}px` }),
      );
    fill(
      this.#body,
      gap(first),
      this.#rows.slice(first, last).map((index) => this.#row(index)),
      gap(this.#rows.length - last),
    );
  }

  /** @param {number} index */
  #row(index) {
    const ordinal = Number(this.#columns[this.names.indexOf("ordinal")]?.[index] ?? index + 1);
    return h(
      "tr",
      { onclick: () => this.#context.open(ordinal, this.#sorted) },
      this.#tick(ordinal),
      this.names.map((name) => this.#cell(name, index, ordinal)),
    );
  }

  /** Saves the rows and columns that are shown. */
  #save() {
    const { sweep } = this.#context;
    const name = (sweep.name ?? sweep.id).replace(/[^\p{L}\p{N}]+/gu, "-").toLowerCase();
    const text = csvOf(this.names, this.#columns, this.#rows);
    download(new Blob([text], { type: "text/csv" }), `${name}.csv`);
  }

  /** Column by which rows are sorted; its node is opened and compared. */
  get #sorted() {
    return this.#context.query.get("sort") ?? "";
  }

  /** Ordinals of the points that are ticked, in the order of the ticks. */
  get #ticked() {
    return tickedIn(this.#context.query.get("ticked") ?? "");
  }

  /** Cell with the tick of a point. @param {number} ordinal */
  #tick(ordinal) {
    const ticked = this.#ticked;
    const isTicked = ticked.includes(ordinal);
    const box = h("input", {
      type: "checkbox",
      "aria-label": `Compare point ${ordinal}`,
      checked: isTicked,
      disabled: !isTicked && ticked.length >= MOST,
      onchange: () => {
        const others = this.#ticked.filter((other) => other !== ordinal);
        this.#context.keep({ ticked: (box.checked ? [...others, ordinal] : others).join(",") || null });
        this.#drawCompare();
        this.#drawRows();
      },
    });
    return h("td", { onclick: (/** @type {Event} */ event) => event.stopPropagation() }, box);
  }

  /** Draws the link to the comparison of the ticked points. */
  #drawCompare() {
    fill(this.#compare, comparePart(this.#context.sweep.id, this.#ticked, this.#sorted));
  }

  /** @param {string} name @param {number} index @param {number} ordinal */
  #cell(name, index, ordinal) {
    const { sweep, biases } = this.#context;
    const value = this.#columns[this.names.indexOf(name)][index];
    if (name === "ordinal")
      return h(
        "td",
        { class: "number" },
        h(
          "a",
          {
            href: link(["sweeps", sweep.id, "points", String(ordinal)], { node: nodeOfColumn(this.#sorted) }),
          },
          ordinal,
        ),
      );
    if (name === "state")
      return h(
        "td",
        {},
        h("span", { class: `state ${value}` }, value),
        this.#doubts(index) && h("span", { class: "wrong small" }, " not settled"),
      );
    if (name === CLASS) return h("td", {}, value !== null && classWord(String(value)));
    if (typeof value !== "number")
      return h("td", { title: value ?? "" }, value === null ? "" : String(value).replaceAll("_", " "));
    const bias = biases.at(name, ordinal);
    const { write, range } = this.#scales[this.names.indexOf(name)];
    const shown = value / unit(name).size;
    const place = range && placeIn(range, shown);
    return h(
      "td",
      place === null ? { class: "number" } : { class: "number placed", style: `--place:${place.toFixed(3)}` },
      write(shown),
      bias && h("span", { class: "soft small" }, ` ${bias}`),
    );
  }

  /** Draws the ticks by which columns are chosen. */
  #drawColumns() {
    const known = this.#context.table.names;
    const chosen = new Set(this.names);
    const ticks = known.map((name) => {
      const box = h("input", {
        type: "checkbox",
        checked: chosen.has(name),
        onchange: () => {
          if (box.checked) chosen.add(name);
          else chosen.delete(name);
          this.#keep({ columns: known.filter((entry) => chosen.has(entry)).join(",") || null });
        },
      });
      return h(
        "label",
        { class: "tick small", style: "width:17rem" },
        box,
        name === "ordinal" ? "point" : this.#context.depths.label(name),
      );
    });
    fill(
      this.#columnsPart,
      h("summary", {}, `Columns (${this.names.length} of ${known.length})`),
      h("div", { class: "controls" }, ticks),
    );
  }

  /** Draws the rows in sight, at most once a frame. */
  #scroll() {
    if (this.#isScrolled) return;
    this.#isScrolled = true;
    requestAnimationFrame(() => {
      this.#isScrolled = false;
      if (!this.#context.signal.aborted) this.#drawRows();
    });
  }
}

/**
 * Order of points by their values in a column; gaps stand at the end in either direction.
 * @param {import("../data/sweep-table.js").Values} key
 * @param {boolean} isDown
 * @returns {(a: number, b: number) => number}
 */
function ordering(key, isDown) {
  return (a, b) => {
    const [left, right] = [key[a], key[b]];
    if (left === null || right === null) return (left === null ? 1 : 0) - (right === null ? 1 : 0);
    const sign = left < right ? -1 : left > right ? 1 : a - b;
    return isDown ? -sign : sign;
  };
}

/**
 * Conditions such as `flow_rate>0.02 state=failed`, all of which have to hold.
 * @param {string} text
 * @param {string[]} known
 */
export function conditions(text, known) {
  /** @type {{name: string, holds: (value: number | string | null) => boolean}[]} */
  const tests = [];
  let problem = "";
  for (const word of text.trim().split(/\s+/).filter(Boolean)) {
    const parts = /^([\w.[\]]+)(<=|>=|!=|=|<|>)(.+)$/.exec(word);
    if (!parts || !known.includes(parts[1])) {
      problem = parts
        ? `There is no column ${parts[1]}.`
        : `A condition is written like flow_rate>0.02: ${word} is not.`;
      continue;
    }
    const [, name, sign, wanted] = parts;
    // A number that is copied from the page has its minus sign.
    const limit = Number(wanted.replace(MINUS, "-"));
    const { size } = unit(name);
    tests.push({
      name,
      holds: (value) => {
        if (typeof value !== "number" || Number.isNaN(limit))
          return sign === "!=" ? String(value) !== wanted : sign === "=" && String(value) === wanted;
        const shown = value / size;
        const isSame = Math.abs(shown - limit) <= 1e-9 * Math.max(Math.abs(limit), Math.abs(shown));
        if (sign === "=") return isSame;
        if (sign === "!=") return !isSame;
        return sign.startsWith("<")
          ? shown < limit || (sign === "<=" && isSame)
          : shown > limit || (sign === ">=" && isSame);
      },
    });
  }
  return { tests, problem };
}
