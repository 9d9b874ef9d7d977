// Clouds of points: any two columns against each other.

import { choice, fill, h } from "../ui/dom.js";
import { generations } from "../ui/generations.js";
import { attend } from "../ui/notices.js";
import { canvas, colourBar, draw, lineScale, LINES } from "../draw/plots.js";
import { MANY, preferred, undelayed } from "./part.js";
import { isText } from "../data/sweep-table.js";
import { label, say, shown, title, unit } from "../data/units.js";

/**
 * @param {import("./part.js").Context} context
 * @returns {import("./part.js").Part}
 */
export function scatter(context) {
  const { table, query } = context;
  const place = canvas(
    "Scatter of the points",
    "scatter",
    "tall",
    context.sweep.counts.total > MANY ? "whole" : "flat",
  );
  const caption = h("figcaption", {});
  const controls = h("div", { class: "controls" });
  const begin = generations();

  function chosen() {
    const names = table.results();
    const pick = (/** @type {string} */ key, /** @type {string | undefined} */ other) =>
      names.includes(query.get(key) ?? "") ? (query.get(key) ?? "") : (other ?? names[0]);
    return {
      names,
      x: pick("x", context.axes[0]),
      y: pick("y", preferred(names)),
      colour: pick("colour", context.axes[1] ?? context.axes[0]),
      isLogX: query.get("xscale") === "log",
      isLogY: query.get("yscale") === "log",
    };
  }

  async function redraw() {
    const isNewest = begin();
    const { names, x, y, colour, isLogX, isLogY } = chosen();
    const set = (/** @type {string} */ key) => (/** @type {string} */ value) => {
      context.keep({ [key]: value });
      attend(redraw(), context.signal);
    };
    const options = names.map((name) => /** @type {[string, string]} */ ([name, label(name)]));
    /** @type {[string, string][]} */
    const scales = [
      ["linear", "linear"],
      ["log", "logarithmic"],
    ];
    fill(
      controls,
      choice("Across", options, x, set("x")),
      choice("Scale across", scales, isLogX ? "log" : "linear", set("xscale")),
      choice("Up", options, y, set("y")),
      choice("Scale up", scales, isLogY ? "log" : "linear", set("yscale")),
      choice("Colour", options, colour, set("colour")),
    );
    const [ordinals, xs, ys, colours] = await table.columns("ordinal", x, y, colour);
    if (!isNewest()) return;
    const words = isText(colours) ? [...new Set(colours)].filter((word) => word !== null) : null;
    const at = (/** @type {string} */ name, /** @type {any[]} */ values) =>
      isText(values) ? values : shown(name, values);
    const [atX, atY] = [at(x, xs), at(y, ys)];
    const text =
      ordinals.length > MANY
        ? undefined
        : ordinals.map(
            (ordinal, index) =>
              `point ${ordinal}<br>${label(x)} ${say(x, xs[index])}${context.biases.beside(x, Number(ordinal))}<br>${label(y)} ${say(y, ys[index])}${context.biases.beside(y, Number(ordinal))}<br>${label(colour)} ${say(colour, colours[index])}${context.biases.beside(colour, Number(ordinal))}`,
          );
    const base = {
      type: ordinals.length > MANY ? "scattergl" : "scatter",
      mode: "markers",
      hoverinfo: text ? "text" : "x+y",
    };
    const size = ordinals.length > MANY ? 4 : 8;
    const traces = words
      ? words.map((word, order) => {
          const rows = ordinals.map((_, index) => index).filter((index) => colours[index] === word);
          return {
            ...base,
            name: String(word),
            x: rows.map((index) => atX[index]),
            y: rows.map((index) => atY[index]),
            text: text && rows.map((index) => text[index]),
            customdata: rows.map((index) => ordinals[index]),
            marker: { size, color: LINES[order % LINES.length], symbol: order },
            showlegend: true,
          };
        })
      : [
          {
            ...base,
            x: atX,
            y: atY,
            text,
            customdata: ordinals,
            marker: {
              size,
              color: shown(colour, /** @type {(number | null)[]} */ (colours)),
              colorscale: lineScale(),
              colorbar: colourBar(title(colour)),
            },
          },
        ];
    const both = ordinals.filter((_, index) => xs[index] !== null && ys[index] !== null).length;
    fill(
      caption,
      `${both} of ${ordinals.length} points have both values. Select a point to open it. `,
      [...new Set([x, y, colour])].map(
        (name) => context.biases.say(name) && `${label(name)}: ${context.biases.say(name)} `,
      ),
    );
    place.setAttribute("aria-label", `${label(y)} against ${label(x)}`);
    const shape = await draw(
      place,
      traces,
      {
        xaxis: { title: title(x), quantity: x, type: isText(xs) ? "category" : isLogX ? "log" : "linear" },
        yaxis: { title: title(y), quantity: y, type: isText(ys) ? "category" : isLogY ? "log" : "linear" },
      },
      context.signal,
    );
    shape.removeAllListeners?.("plotly_click");
    shape.on?.("plotly_click", (/** @type {any} */ event) => context.open(event.points[0].customdata));
  }

  return {
    element: h("div", {}, controls, h("figure", {}, place, caption)),
    draw: undelayed(redraw, context),
    fields: () => {
      const { x, y, colour } = chosen();
      return [...new Set(["ordinal", x, y, colour])];
    },
  };
}
