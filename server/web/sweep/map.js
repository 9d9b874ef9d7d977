// A column of the table over two swept parameters, the others held; over one, a line.

import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { adjust, canvas, colourBar, draw, inks, lineScale, LINES, logTicks, SCALE } from "../draw/plots.js";
import { link } from "../ui/router.js";
import { isUnsettled, SETTLING } from "../data/statistics.js";
import { keyboard } from "../draw/point-cursor.js";
import { finer } from "./finer-grid.js";
import { MANY, preferred, undelayed } from "./part.js";
import { ends, layered } from "../data/grid-layers.js";
import { distinct, isText } from "../data/sweep-table.js";
import { label, say, sayer, title, unit } from "../data/units.js";

/** Designs that draw their points: these have no slices. */
const DRAWN = ["latin_hypercube", "sobol"];
/** Colours of words, such as states. */
const WORDS = ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#f0e442", "#777777"];

/**
 * @param {import("./part.js").Context} context
 * @returns {import("./part.js").Part}
 */
export function map(context) {
  const { axes, table, query } = context;
  const place = canvas("Map of the sweep", "map", "tall");
  const caption = h("figcaption", {});
  const controls = h("div", { class: "controls" });
  const region = finer(context);
  const cursor = keyboard(place, context.open);
  const empty = h("p", { class: "empty", hidden: true });
  const figure = h("figure", {}, place, caption, cursor.element);
  const element = h("div", {}, controls, empty, figure, region.element);
  /** What the button opens is chosen by what is drawn last. @type {(range?: any) => void} */
  let chooseRegion = () => {};
  const finerButton = h(
    "button",
    {
      onclick: () => {
        chooseRegion();
        void adjust(place, { dragmode: "select" });
      },
    },
    "Finer grid",
  );
  const sayRegion = () => finerButton.setAttribute("aria-expanded", String(!region.element.hidden));
  region.element.addEventListener("closed", () => {
    sayRegion();
    void adjust(place, { dragmode: "zoom", selections: [] });
  });
  const begin = generations();
  /** What the slice that was drawn last holds: a finer grid is of the slice that is shown. */
  let sliceBefore = "";
  const get = (/** @type {string} */ name, /** @type {string} */ other) => query.get(name) ?? other;

  function chosen() {
    const x = axes.includes(get("x", "")) ? get("x", "") : axes[0];
    const others = axes.filter((axis) => axis !== x);
    const y = others.includes(get("y", "")) ? get("y", "") : others[0];
    const results = table.results().filter((name) => !axes.includes(name));
    const colour = results.includes(get("colour", "")) ? get("colour", "") : preferred(results);
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

  async function redraw() {
    const isNewest = begin();
    const { x, y, colour, results, held, isLog, style } = chosen();
    if (!x) {
      fill(element, h("p", { class: "empty" }, "This sweep varies nothing: see its table."));
      return;
    }
    const present = SETTLING.filter((name) => table.names.includes(name));
    const [ordinals, states, xs, ys, values, ...others] = await table.columns(
      "ordinal",
      "state",
      x,
      y ?? x,
      colour,
      ...held,
      ...present,
    );
    if (!isNewest()) return;
    const settling = others.slice(held.length);
    const settlingOf = (/** @type {string} */ name, /** @type {number} */ index) =>
      settling[present.indexOf(name)]?.[index];
    const doubts = (/** @type {number} */ index) =>
      isUnsettled(settlingOf("motion_regime", index), settlingOf("growing_mode_hz", index));
    const set = (/** @type {string} */ name) => (/** @type {string} */ value) => {
      context.keep({ [name]: value });
      attend(redraw(), context.signal);
    };
    const named = (/** @type {string[]} */ names) =>
      names.map((name) => /** @type {[string, string]} */ ([name, label(name)]));
    const words = isText(values);
    const heldValues = held.map((axis, index) => {
      const all = distinct(others[index]);
      const asked = Number(get(`at.${axis}`, ""));
      return {
        axis,
        all,
        value: query.has(`at.${axis}`) && all.includes(asked) ? asked : all[0],
        column: others[index],
      };
    });
    const { axes: spans, design = "grid" } = context.sweep.request ?? {};
    const isDrawn = DRAWN.includes(design);
    const isGrid =
      !y ||
      (spans && design === "grid") ||
      (!isDrawn && distinct(xs).length * distinct(ys).length <= 4 * xs.length + 16);
    // A design that draws its points has no slices: all of them are shown.
    const slices = isGrid ? heldValues : [];
    fill(
      controls,
      choice("Across", named(axes), x, set("x")),
      y && choice("Up", named(axes.filter((axis) => axis !== x)), y, set("y")),
      choice(y ? "Colour" : "Result", named(results), colour, set("colour")),
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
      finerButton,
      slices.map(({ axis, all, value }) =>
        choice(
          label(axis),
          all.map((entry) => [String(entry), say(axis, entry)]),
          String(value),
          set(`at.${axis}`),
        ),
      ),
    );
    const sides = y ? [x, y] : [x];
    /** What a finer grid holds: the slice that is shown, or values to be chosen where all points are. */
    const further = () =>
      heldValues.map(({ axis, all, value }) => ({
        name: axis,
        value: isGrid ? Number(value) : chosenOr(axis, middle(all.map(Number), context.spans[axis])),
        isFree: !isGrid,
      }));
    const chosenOr = (/** @type {string} */ axis, /** @type {number} */ other) => {
      const asked = Number(query.get(`at.${axis}`) || NaN);
      return Number.isFinite(asked) ? asked : other;
    };
    // Of a region, as shown; without one of the whole map.
    chooseRegion = (range) => {
      const chosenSides = sides.map((name, order) => {
        const values = distinct(order ? ys : xs).map(Number);
        const shownRange = range?.[order ? "y" : "x"]
          ?.map((/** @type {number} */ end) => end * unit(name).size)
          .sort((/** @type {number} */ a, /** @type {number} */ b) => a - b);
        // Cells reach beyond the values that they stand for.
        const [from, to] =
          shownRange && (order === 0 || y) ? shownRange : [values[0], values.at(-1) ?? values[0]];
        return { name, from: Math.max(from, values[0]), to: Math.min(to, values.at(-1) ?? to), count: 0 };
      });
      region.choose(chosenSides, further());
      sayRegion();
    };
    const kept = region.kept(sides);
    const slice = slices.map(({ value }) => value).join(",");
    if (kept && (region.element.hidden || slice !== sliceBefore)) region.choose(kept, further());
    sliceBefore = slice;
    sayRegion();
    const isAllFailed =
      !query.has("colour") && states.length > 0 && states.every((state) => state === "failed");
    empty.hidden = !isAllFailed;
    figure.hidden = isAllFailed;
    if (isAllFailed) {
      fill(
        empty,
        "All points of this sweep failed: why is told under ",
        h("a", { href: link(["sweeps", context.sweep.id], { view: "failures" }) }, "Failures"),
        ".",
      );
      return;
    }
    const rows = ordinals
      .map((_, index) => index)
      .filter((index) => slices.every(({ column, value }) => column[index] === value));
    const done = rows.filter((index) => values[index] !== null).length;
    const logged = (/** @type {any} */ value) =>
      typeof value === "number" && value > 0 ? Math.log10(value) : null;
    const hidden =
      isLog && !words
        ? rows.filter((index) => typeof values[index] === "number" && Number(values[index]) <= 0).length
        : 0;
    fill(
      caption,
      `${context.depths.label(colour)}: ${done} of ${rows.length} points have a value. Select a point to open it, or go over them by arrow keys and open by Enter. `,
      context.biases.say(colour),
      hidden ? ` ${hidden} are not positive and have no place on a logarithmic scale.` : "",
    );
    place.setAttribute("aria-label", `${label(colour)} over ${label(x)}${y ? ` and ${label(y)}` : ""}`);

    // What a name stands for is looked up once, and not for each of a hundred thousand points.
    const sizes = new Map([...sides, colour].map((name) => [name, unit(name).size]));
    const at = (/** @type {string} */ name, /** @type {any} */ value) =>
      typeof value === "number" ? value / (sizes.get(name) ?? 1) : value;
    const part = (/** @type {string} */ name) => {
      const [called, words] = [context.depths.label(name), sayer(name)];
      return (/** @type {any} */ value) => `${called} ${words(value)}`;
    };
    const [ofX, ofY, ofValue] = [once(part(x)), once(y ? part(y) : () => ""), part(colour)];
    const texts = rows.map(
      (index) =>
        `point ${ordinals[index]}: ${states[index]}${doubts(index) ? ", not settled" : ""}<br>${ofX(xs[index])}<br>${y ? `${ofY(ys[index])}<br>` : ""}${ofValue(values[index])}${typeof values[index] === "number" ? context.biases.beside(colour, Number(ordinals[index])) : ""}`,
    );
    const axisLayout = (/** @type {string} */ name) => ({
      title: title(name),
      quantity: name,
      type: context.spans[name]?.scale === "log" ? "log" : "linear",
    });

    if (!y) {
      const order = rows
        .map((_, position) => position)
        .sort((a, b) => Number(xs[rows[a]]) - Number(xs[rows[b]]));
      const trace = {
        type: "scatter",
        mode: "lines+markers",
        x: order.map((position) => at(x, xs[rows[position]])),
        y: order.map((position) => at(colour, values[rows[position]])),
        text: order.map((position) => texts[position]),
        customdata: order.map((position) => ordinals[rows[position]]),
        hoverinfo: "text",
        marker: {
          size: 8,
          color: LINES[0],
          symbol: order.map((position) => (doubts(rows[position]) ? "x" : "circle")),
        },
        line: { color: LINES[0] },
      };
      cursor.over(
        order
          .map((position, column) => ({
            x: at(x, xs[rows[position]]),
            y: at(colour, values[rows[position]]),
            column,
            row: 0,
            ordinal: Number(ordinals[rows[position]]),
            text: texts[position],
          }))
          .filter((point) => typeof point.y === "number"),
      );
      const shape = await draw(
        place,
        [trace],
        {
          xaxis: axisLayout(x),
          yaxis: { title: context.depths.title(colour), quantity: colour, type: isLog ? "log" : "linear" },
          dragmode: region.element.hidden ? "zoom" : "select",
        },
        context.signal,
      );
      listen(shape, chooseRegion);
      return;
    }

    const vocabulary = words ? distinct(values) : [];
    const coded = (/** @type {number} */ index) =>
      words
        ? values[index] === null
          ? null
          : vocabulary.indexOf(/** @type {string} */ (values[index]))
        : isLog
          ? logged(values[index])
          : at(colour, values[index]);
    const z = rows.map(coded);
    const finite = /** @type {number[]} */ (z.filter((value) => value !== null));
    const offset = isLog ? Math.log10(unit(colour).size) : 0;
    const shownZ = isLog && !words ? z.map((value) => (value === null ? null : Number(value) - offset)) : z;
    const least = finite.reduce((a, b) => Math.min(a, b), Infinity) - (words ? 0 : offset);
    const largest = finite.reduce((a, b) => Math.max(a, b), -Infinity) - (words ? 0 : offset);
    const bar = words
      ? {
          ...colourBar(context.depths.label(colour)),
          tickvals: vocabulary.map((_, index) => index),
          ticktext: vocabulary.map((word) => String(word).replaceAll("_", " ")),
        }
      : {
          ...colourBar(context.depths.title(colour)),
          ...(isLog && finite.length ? logTicks(least, largest) : {}),
        };
    const count = Math.max(vocabulary.length, 1);
    const discrete = Array.from({ length: count }, (_, index) => [
      [index / count, WORDS[index % WORDS.length]],
      [(index + 1) / count, WORDS[index % WORDS.length]],
    ]).flat();
    const scale = words
      ? { colorscale: discrete, zmin: -0.5, zmax: count - 0.5 }
      : { colorscale: SCALE, ...(finite.length ? { zmin: least, zmax: largest } : {}) };

    /** @type {any[]} */
    const traces = [];
    if (isGrid) {
      const requests = [context.sweep.request, ...(context.sweep.appended ?? [])].map((request) => ({
        x: request?.axes?.[context.paths[x] ?? x],
        y: request?.axes?.[context.paths[y] ?? y],
      }));
      const [allX, allY] = [xs, ys].map((column) => distinct(rows.map((index) => column[index])).map(Number));
      layered(
        rows.map((index) => Number(xs[index])),
        rows.map((index) => Number(ys[index])),
        requests,
      ).forEach(({ across, up, at: positions }, order) => {
        const part = (/** @type {(position: number) => any} */ value, /** @type {any} */ none) =>
          positions.map((line) => line.map((position) => (position === undefined ? none : value(position))));
        const gap = words || up.length * across.length > 900 ? 0 : 1;
        const isContour = style === "contour" && !words && across.length > 1 && up.length > 1;
        traces.push({
          type: isContour ? "contour" : "heatmap",
          x: ends(across, allX).map((value) => at(x, value)),
          y: ends(up, allY).map((value) => at(y, value)),
          z: part((position) => shownZ[position], null),
          text: part((position) => texts[position], ""),
          customdata: part((position) => ordinals[rows[position]], null),
          hoverinfo: "text",
          hoverongaps: order === 0,
          colorbar: bar,
          showscale: order === 0,
          ...scale,
          xgap: gap,
          ygap: gap,
          contours: { coloring: "heatmap" },
          line: { color: inks().panel, width: 0.7 },
        });
      });
    } else {
      const kind = rows.length > MANY ? "scattergl" : "scatter";
      traces.push({
        type: kind,
        mode: "markers",
        x: rows.map((index) => at(x, xs[index])),
        y: rows.map((index) => at(y, ys[index])),
        text: texts,
        customdata: rows.map((index) => ordinals[index]),
        hoverinfo: "text",
        marker: {
          size: rows.length > MANY ? 5 : 9,
          color: shownZ,
          colorscale: words ? scale.colorscale : lineScale(),
          cmin: words ? -0.5 : undefined,
          cmax: words ? count - 0.5 : undefined,
          colorbar: bar,
          line: { width: 0 },
        },
      });
    }
    const crosses = (
      /** @type {string} */ name,
      /** @type {number[]} */ marked,
      /** @type {any} */ marker,
    ) => ({
      type: marked.length > MANY ? "scattergl" : "scatter",
      mode: "markers",
      name,
      x: marked.map((index) => at(x, xs[index])),
      y: marked.map((index) => at(y, ys[index])),
      customdata: marked.map((index) => ordinals[index]),
      text: marked.map((index) => `point ${ordinals[index]}: ${name}`),
      hoverinfo: "text",
      marker: { ...marker, size: marked.length > MANY ? 4 : 9, color: "#d55e00" },
      showlegend: true,
    });
    const failed = rows.filter((index) => states[index] === "failed");
    if (failed.length) traces.push(crosses("failed", failed, { symbol: "x" }));
    const doubtful = rows.filter(doubts);
    if (doubtful.length)
      traces.push(
        crosses("not settled", doubtful, {
          symbol: "x-thin-open",
          line: { width: doubtful.length > MANY ? 1 : 2 },
        }),
      );
    const [columnOf, rowOf] = [xs, ys].map(
      (column) => new Map(distinct(rows.map((index) => column[index])).map((value, rank) => [value, rank])),
    );
    cursor.over(
      rows.map((index, position) => ({
        x: at(x, xs[index]),
        y: at(y, ys[index]),
        column: columnOf.get(/** @type {number} */ (xs[index])) ?? 0,
        row: rowOf.get(/** @type {number} */ (ys[index])) ?? 0,
        ordinal: Number(ordinals[index]),
        text: texts[position],
      })),
    );
    const shape = await draw(
      place,
      traces,
      { xaxis: axisLayout(x), yaxis: axisLayout(y), dragmode: region.element.hidden ? "zoom" : "select" },
      context.signal,
    );
    listen(shape, chooseRegion);
  }

  /** @param {any} shape @param {(range: any) => void} chooseRegion */
  function listen(shape, chooseRegion) {
    shape.removeAllListeners?.("plotly_click");
    shape.removeAllListeners?.("plotly_selected");
    shape.on?.("plotly_selected", (/** @type {any} */ event) => {
      if (event?.range) chooseRegion(event.range);
    });
    shape.on?.("plotly_click", (/** @type {any} */ event) => {
      const ordinal = event.points[0]?.customdata;
      if (typeof ordinal === "number") context.open(ordinal);
    });
  }

  return {
    element,
    draw: undelayed(redraw, context),
    fields: () => {
      const { x, y, colour, held } = chosen();
      return ["ordinal", x, y, ...held, colour].filter((name) => name !== undefined);
    },
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
