// Clouds of points: any two columns against each other.

import { isText } from "../data/sweep-table.js";
import { label, say, shown } from "../data/units.js";
import { canvas, colourBar, draw, lineScale, LINES, MANY } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { CLASS, wordColour, wordsOf } from "./categories.js";
import { preferred, undelayed } from "./part.js";

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
    fill(
      caption,
      `${both} of ${ordinals.length} points have both values. Select a point to open it. `,
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
    await draw(place, tracesOf(context, chosen, { ordinals, xs, ys, colours }), layout, context.signal);
  }
  place.addEventListener("pointclick", (event) =>
    context.open(/** @type {CustomEvent} */ (event).detail.points[0].customdata),
  );

  return {
    element: h("div", {}, controls, h("figure", {}, place, caption)),
    draw: undelayed(redraw, context),
    fields: () => {
      const { x, y, colour } = chosenIn(context);
      return [...new Set(["ordinal", x, y, colour])];
    },
  };
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
  const at = (/** @type {string} */ name, /** @type {any[]} */ values) =>
    isText(values) ? values : shown(name, values);
  const [atX, atY] = [at(x, xs), at(y, ys)];
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
