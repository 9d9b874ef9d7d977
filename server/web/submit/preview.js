// A picture of the points that a request would become, over two of their parameters.

import { label, number, shown, title } from "../data/units.js";
import { canvas, draw, LINES, MANY } from "../draw/plots.js";
import { choice, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";

export class Preview {
  #signal;
  #controls = h("div", { class: "controls" });
  #picture = canvas("Preview of the points", "preview");
  /** Parameters that the reader has chosen. */
  #over = { x: "", y: "" };
  element = h(
    "section",
    { class: "panel", "aria-label": "Preview", hidden: true },
    h("h2", {}, "Points"),
    this.#controls,
    h("figure", {}, this.#picture),
  );

  /** @param {AbortSignal} signal */
  constructor(signal) {
    this.#signal = signal;
  }

  hide() {
    this.element.hidden = true;
  }

  /** @param {any[]} points */
  async draw(points) {
    const names = Object.keys(points[0]?.parameters ?? {});
    this.element.hidden = names.length === 0;
    const x = names.includes(this.#over.x) ? this.#over.x : names[0];
    const others = names.filter((entry) => entry !== x);
    const y = others.includes(this.#over.y) ? this.#over.y : others[0];
    const pick = (/** @type {"x" | "y"} */ side, /** @type {string} */ text, /** @type {string[]} */ from) =>
      choice(
        text,
        from.map((entry) => [entry, label(entry)]),
        side === "x" ? x : y,
        (value) => {
          this.#over[side] = value;
          attend(this.draw(points), this.#signal);
        },
      );
    fill(this.#controls, names.length > 2 && [pick("x", "Across", names), pick("y", "Up", others)]);
    if (!names.length) return;
    const values = (/** @type {string} */ name) =>
      shown(
        name,
        points.map((point) => point.parameters[name]),
      );
    const trace = {
      type: points.length > MANY ? "dots" : "scatter",
      mode: "markers",
      x: values(x),
      y: y ? values(y) : points.map(() => 0),
      marker: { color: LINES[0], size: points.length > 500 ? 4 : 8 },
      describe: (/** @type {{x: number, y: number}} */ { x: across, y: up }) =>
        y ? `${number(across)}, ${number(up)}` : number(across),
    };
    await draw(
      this.#picture,
      [trace],
      {
        xaxis: { title: title(x), quantity: x },
        yaxis: y ? { title: title(y), quantity: y } : { visible: false },
      },
      this.#signal,
    );
  }
}
