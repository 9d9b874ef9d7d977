// The points of a sweep as rows: sorted, filtered, with a choice of columns. Only the rows in sight are in the page.

import { choice, debounced, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { link } from "../ui/router.js";
import { isUnsettled, SETTLING } from "../data/statistics.js";
import { preferred } from "./part.js";
import { label, meaning, number, title, unit } from "../data/units.js";

const ROW_PX = 30;
const SPARE_ROWS = 12;

/**
 * @param {import("./part.js").Context} context
 * @returns {import("./part.js").Part}
 */
export function table(context) {
  const { table: data, axes, query, signal } = context;
  const body = h("tbody", {});
  const header = h("tr", {});
  const grid = h("table", { "aria-label": "Points" }, h("thead", {}, header), body);
  const scroller = h(
    "div",
    { class: "rows", tabindex: "0", role: "region", "aria-label": "Points, scrollable" },
    grid,
  );
  const status = h("p", { class: "soft small", role: "status" });
  const filter = h("input", {
    type: "search",
    value: query.get("filter") ?? "",
    placeholder: "e.g. flow_rate>0.02 state=failed",
    size: 34,
    oninput: debounced(
      () => {
        context.keep({ filter: filter.value || null });
        attend(redraw(), context.signal);
      },
      250,
      signal,
    ),
  });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const columnsPart = h("details", {});

  const standard = () => {
    const results = data.results().filter((name) => !axes.includes(name) && name !== "state");
    const usual = [
      preferred(results),
      ...results.filter((name) =>
        /^(orbit_radius_rms|friction_coefficient_max|largest_normal_force|whole_error|time_error|resolved_hz|tension_top|torque_top)/.test(
          name,
        ),
      ),
    ];
    return ["ordinal", "state", ...axes, ...new Set(usual.filter((name) => results.includes(name)))];
  };
  const shownNames = () => {
    const asked = (query.get("columns") ?? "").split(",").filter((name) => data.names.includes(name));
    return asked.length ? asked : standard();
  };
  const sorting = () => ({ by: query.get("sort") ?? "ordinal", isDown: query.get("order") === "down" });

  /** @type {number[]} */
  let rows = [];
  /** @type {import("../data/sweep-table.js").Values[]} */
  let columns = [];
  /** @type {string[]} */
  let names = [];
  /** @type {(index: number) => boolean} */
  let doubts = () => false;
  const begin = generations();

  async function redraw() {
    const isNewest = begin();
    const asked = shownNames();
    const { by, isDown } = sorting();
    const { tests, problem } = conditions(filter.value, data.names);
    wrong.textContent = problem;
    const present = SETTLING.filter((name) => data.names.includes(name));
    const needed = [...asked, by, ...tests.map((test) => test.name), ...present];
    const found = await data.columns(...needed);
    if (!isNewest()) return;
    names = asked;
    columns = found.slice(0, names.length);
    const key = found[names.length];
    const settling = found.slice(found.length - present.length);
    const settlingOf = (/** @type {string} */ name, /** @type {number} */ index) =>
      settling[present.indexOf(name)]?.[index];
    doubts = (index) => isUnsettled(settlingOf("motion_regime", index), settlingOf("growing_mode_hz", index));
    rows = Array.from({ length: data.rows }, (_, index) => index).filter((index) =>
      tests.every((test, order) => test.holds(found[names.length + 1 + order][index])),
    );
    // Gaps stand at the end, whatever the order.
    rows.sort((a, b) => {
      const [left, right] = [key[a], key[b]];
      if (left === null || right === null) return (left === null ? 1 : 0) - (right === null ? 1 : 0);
      const sign = left < right ? -1 : left > right ? 1 : a - b;
      return isDown ? -sign : sign;
    });
    fill(status, `${rows.length === data.rows ? "" : `${rows.length} of `}${data.rows} points`);
    fill(
      header,
      names.map((name) => {
        const isSorted = name === by;
        return h(
          "th",
          {
            class: typeof firstOf(name) === "number" ? "number" : "",
            scope: "col",
            style: `width:${name === "ordinal" ? 5 : name === "state" ? 8 : 10}rem;white-space:normal`,
            "aria-sort": isSorted && (isDown ? "descending" : "ascending"),
            title: meaning(name),
          },
          h(
            "button",
            {
              onclick: () => {
                context.keep({ sort: name, order: isSorted && !isDown ? "down" : null });
                attend(redraw(), context.signal);
              },
            },
            name === "ordinal" ? "Point" : title(name),
            isSorted ? (isDown ? " ▼" : " ▲") : "",
          ),
          context.biases.brief(name) &&
            h("div", { title: context.biases.say(name) }, context.biases.brief(name)),
        );
      }),
    );
    drawColumns();
    drawRows();
  }

  /** @param {string} name */
  function firstOf(name) {
    return columns[names.indexOf(name)]?.find((value) => value !== null);
  }

  function drawRows() {
    const first = Math.max(0, Math.floor(scroller.scrollTop / ROW_PX) - SPARE_ROWS);
    const last = Math.min(
      rows.length,
      Math.ceil((scroller.scrollTop + (scroller.clientHeight || 800)) / ROW_PX) + SPARE_ROWS,
    );
    const gap = (/** @type {number} */ count) =>
      count > 0 &&
      h(
        "tr",
        { class: "gap", "aria-hidden": "true" },
        h("td", { colspan: names.length, style: `height:${count * ROW_PX}px` }),
      );
    fill(body, gap(first), rows.slice(first, last).map(row), gap(rows.length - last));
  }

  /** @param {number} index */
  function row(index) {
    const ordinal = columns[names.indexOf("ordinal")]?.[index] ?? index + 1;
    return h(
      "tr",
      { onclick: () => context.open(Number(ordinal)) },
      names.map((name, order) => {
        const value = columns[order][index];
        if (name === "ordinal")
          return h(
            "td",
            { class: "number" },
            h("a", { href: link(["sweeps", context.sweep.id, "points", String(ordinal)]) }, ordinal),
          );
        if (name === "state")
          return h(
            "td",
            {},
            h("span", { class: `state ${value}` }, value),
            doubts(index) && h("span", { class: "wrong small" }, " not settled"),
          );
        if (typeof value === "number")
          return h(
            "td",
            { class: "number" },
            number(value / unit(name).size, 5),
            context.biases.at(name, Number(ordinal)) &&
              h("span", { class: "soft small" }, ` ${context.biases.at(name, Number(ordinal))}`),
          );
        return h("td", { title: value ?? "" }, value === null ? "" : String(value).replaceAll("_", " "));
      }),
    );
  }

  function drawColumns() {
    const chosen = new Set(names);
    const ticks = data.names.map((name) => {
      const box = h("input", {
        type: "checkbox",
        checked: chosen.has(name),
        onchange: () => {
          box.checked ? chosen.add(name) : chosen.delete(name);
          const kept = data.names.filter((entry) => chosen.has(entry));
          context.keep({ columns: kept.join(",") || null });
          attend(redraw(), context.signal);
        },
      });
      return h(
        "label",
        { class: "tick small", style: "width:17rem" },
        box,
        name === "ordinal" ? "point" : label(name),
      );
    });
    fill(
      columnsPart,
      h("summary", {}, `Columns (${names.length} of ${data.names.length})`),
      h("div", { class: "controls" }, ticks),
    );
  }

  let isDue = false;
  scroller.addEventListener("scroll", () => {
    if (isDue) return;
    isDue = true;
    requestAnimationFrame(() => {
      isDue = false;
      if (!signal.aborted) drawRows();
    });
  });

  const presets = choice(
    "Show",
    [
      ["", "all points"],
      ["state=succeeded", "succeeded"],
      ["state=failed", "failed"],
      ["state=running", "running"],
      ["state=queued", "queued"],
    ],
    "",
    (value) => {
      filter.value = value;
      context.keep({ filter: value || null });
      attend(redraw(), context.signal);
    },
  );
  return {
    element: h(
      "div",
      {},
      h(
        "div",
        { class: "controls" },
        h("label", { class: "field" }, h("span", {}, "Filter, in units as shown"), filter),
        presets,
      ),
      wrong,
      columnsPart,
      status,
      scroller,
    ),
    draw: redraw,
    fields: () => names,
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
    const limit = Number(wanted);
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
