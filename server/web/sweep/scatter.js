// Clouds of points: any two columns against each other.

import { signRules } from "../data/signs.js";
import { isText } from "../data/sweep-table.js";
import { label, say, shown } from "../data/units.js";
import { adjust, canvas, colourBar, draw, lineScale, LINES, MANY } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { CLASS, wordColour, wordsOf } from "./categories.js";
import { preferred, undelayed } from "./part.js";
import { comparePart, tickedIn } from "./ticked.js";

/** @typedef {import("./part.js").Context} Context */
/** @typedef {{names: string[], x: string, y: string, colour: string, isLogX: boolean, isLogY: boolean}} Chosen */
/** @typedef {import("../data/sweep-table.js").Values} Values */

/** @type {[string, string][]} */
const SCALES = [
  ["linear", "linear"],
  ["log", "logarithmic"],
];

/**
 * @param {Context} context
 * @returns {import("./part.js").Part}
 */
export function scatter(context) {
  const place = canvas("Scatter of the points", "scatter", "tall");
  const caption = h("figcaption", {});
  const controls = h("div", { class: "controls" });
  const chosenPart = h("div", { class: "controls" });
  const choosing = h(
    "button",
    {
      title: "Drag over points of the picture to compare them",
      onclick: () => adjust(place, { dragmode: "select" }),
    },
    "Choose points",
  );
  /** Ordinals of the points in an area of the picture; each drawing sets it. @type {(area: {x: number[], y: number[]}) => number[]} */
  let within = () => [];
  const begin = generations();
  const set = (/** @type {string} */ key) => (/** @type {string} */ value) => {
    context.keep({ [key]: value });
    attend(redraw(), context.signal);
  };

  async function redraw() {
    const isNewest = begin();
    const chosen = chosenIn(context);
    const { x, y, colour } = chosen;
    fill(controls, controlsPart(chosen, context.depths, set));
    const [ordinals, xs, ys, colours] = await context.table.columns("ordinal", x, y, colour);
    if (!isNewest()) return;
    const both = ordinals.filter((_, index) => xs[index] !== null && ys[index] !== null).length;
    within = (area) => pointsWithin(area, ordinals, [shownAt(x, xs), shownAt(y, ys)]);
    fill(
      caption,
      `${both} of ${ordinals.length} points have both values. Select a point to open it. ${signRules([x, y, colour])} `,
      [...new Set([x, y, colour])].map(
        (name) => context.biases.say(name) && `${context.depths.label(name)}: ${context.biases.say(name)} `,
      ),
    );
    place.setAttribute("aria-label", `${label(y)} against ${label(x)}`);
    const axis = (
      /** @type {string} */ name,
      /** @type {Values} */ values,
      /** @type {boolean} */ isLog,
    ) => ({
      title: context.depths.title(name),
      quantity: name,
      type: isLog && !isText(values) ? "log" : "linear",
      ...(name === CLASS ? { categoryarray: wordsOf(name, values) } : {}),
    });
    const layout = { xaxis: axis(x, xs, chosen.isLogX), yaxis: axis(y, ys, chosen.isLogY) };
    const traces = tracesOf(context, chosen, { ordinals, xs, ys, colours });
    await draw(place, traces, layout, context.signal);
  }

  /** Says which points are chosen, and links their comparison. @param {number | null} found number of points within the dragged area */
  function sayChosen(found) {
    const ticked = tickedIn(context.query.get("ticked") ?? "");
    const words = found === null ? "" : `${found} ${found === 1 ? "point is" : "points are"} within. `;
    fill(
      chosenPart,
      choosing,
      ticked.length > 0 && comparePart(context.sweep.id, ticked, chosenIn(context).y),
      h("span", { class: "small soft", role: "status" }, words),
    );
  }
  place.addEventListener("chosen", (event) => {
    const { detail } = /** @type {CustomEvent} */ (event);
    if (!detail) return;
    const found = within(detail);
    context.keep({ ticked: tickedIn(found.join(",")).join(",") || null });
    sayChosen(found.length);
  });
  sayChosen(null);
  place.addEventListener("pointclick", (event) =>
    context.open(/** @type {CustomEvent} */ (event).detail.points[0].customdata),
  );

  return {
    element: h("div", {}, controls, chosenPart, h("figure", {}, place, caption)),
    draw: undelayed(redraw, context),
    fields: () => {
      const { x, y, colour } = chosenIn(context);
      return [...new Set(["ordinal", x, y, colour])];
    },
  };
}

/** Values as they are shown along an axis. @param {string} name @param {any[]} values @returns {any[]} */
function shownAt(name, values) {
  return isText(values) ? values : shown(name, values);
}

/**
 * Ordinals of the points in an area; values that are words are within along their axis.
 * @param {{x: number[], y: number[]}} area ends in the units shown
 * @param {Values} ordinals
 * @param {[any[], any[]]} places in the units shown
 */
export function pointsWithin({ x, y }, ordinals, [xs, ys]) {
  const isIn = (/** @type {any} */ value, /** @type {number[]} */ [from, to]) =>
    typeof value === "string" || (typeof value === "number" && value >= from && value <= to);
  return ordinals.filter((_, index) => isIn(xs[index], x) && isIn(ys[index], y)).map(Number);
}

/** Choices of the link, or the usual ones. @param {Context} context @returns {Chosen} */
function chosenIn({ table, query, axes }) {
  const names = table.results();
  const pick = (/** @type {string} */ key, /** @type {string | undefined} */ other) =>
    names.includes(query.get(key) ?? "") ? (query.get(key) ?? "") : (other ?? names[0]);
  return {
    names,
    x: pick("x", axes[0]),
    y: pick("y", preferred(names)),
    colour: pick("colour", axes[1] ?? axes[0]),
    isLogX: query.get("xscale") === "log",
    isLogY: query.get("yscale") === "log",
  };
}

/** @param {Chosen} chosen @param {import("../data/depths.js").Depths} depths @param {(key: string) => (value: string) => void} set */
function controlsPart({ names, x, y, colour, isLogX, isLogY }, depths, set) {
  const options = names.map((name) => /** @type {[string, string]} */ ([name, depths.label(name)]));
  return [
    choice("Across", options, x, set("x")),
    choice("Scale across", SCALES, isLogX ? "log" : "linear", set("xscale")),
    choice("Up", options, y, set("y")),
    choice("Scale up", SCALES, isLogY ? "log" : "linear", set("yscale")),
    choice("Colour", options, colour, set("colour")),
  ];
}

/**
 * One trace coloured by numbers, or one for each word.
 * @param {Context} context
 * @param {Chosen} chosen
 * @param {{ordinals: Values, xs: Values, ys: Values, colours: Values}} columns
 */
function tracesOf({ biases, depths }, { x, y, colour }, { ordinals, xs, ys, colours }) {
  const isMany = ordinals.length > MANY;
  const [atX, atY] = [shownAt(x, xs), shownAt(y, ys)];
  const part = (/** @type {string} */ name, /** @type {Values} */ values, /** @type {number} */ index) =>
    `${depths.label(name)} ${say(name, values[index])}${biases.beside(name, Number(ordinals[index]))}`;
  const describe = (/** @type {number} */ index) =>
    [`point ${ordinals[index]}`, part(x, xs, index), part(y, ys, index), part(colour, colours, index)].join(
      "<br>",
    );
  // Of many points, only the one next to the mouse is put into words.
  const text = isMany ? undefined : ordinals.map((_, index) => describe(index));
  const base = { type: isMany ? "dots" : "scatter", mode: "markers" };
  const size = isMany ? 4 : 8;
  if (!isText(colours)) {
    const color = shown(colour, /** @type {(number | null)[]} */ (colours));
    return [
      {
        ...base,
        x: atX,
        y: atY,
        text,
        describe: isMany ? (/** @type {{row: number}} */ { row }) => describe(row) : undefined,
        customdata: ordinals,
        marker: { size, color, colorscale: lineScale(), colorbar: colourBar(depths.title(colour)) },
      },
    ];
  }
  return wordsOf(colour, colours).map((word, order) => {
    const rows = ordinals.map((_, index) => index).filter((index) => colours[index] === word);
    return {
      ...base,
      name: word.replaceAll("_", " "),
      x: rows.map((index) => atX[index]),
      y: rows.map((index) => atY[index]),
      text: text && rows.map((index) => text[index]),
      describe: isMany ? (/** @type {{row: number}} */ { row }) => describe(rows[row]) : undefined,
      customdata: rows.map((index) => ordinals[index]),
      marker: {
        size,
        color: wordColour(colour, word, LINES[order % LINES.length]),
        symbol: isMany ? "square" : order,
      },
      showlegend: true,
    };
  });
}
