// Panel with what accuracy costs: error against processor time of a point and of the verified points of its sweep.

import { accuracyOf } from "../data/accuracy.js";
import { get } from "../data/api.js";
import { duration, number } from "../data/units.js";
import { costsOf, decades, MOST_VERIFIED } from "../data/work-precision.js";
import { canvas, draw, inks, LINES } from "../draw/plots.js";
import { fill, h } from "../ui/dom.js";

/** @typedef {import("./part.js").PointContext} PointContext */
/** @typedef {import("../data/work-precision.js").Cost} Cost */

export class AccuracyCost {
  #context;
  #picture = canvas("Error of orbit size against processor time", "cost");
  #caption = h("figcaption", {});
  element = h(
    "section",
    { class: "panel", "aria-label": "What accuracy costs" },
    h("h2", {}, "What accuracy costs"),
    h("figure", {}, this.#picture, this.#caption),
  );

  /** Other verified points, requested once. @type {Promise<{point: any, error: number | null}[]> | undefined} */
  #others;

  /** @param {PointContext} context */
  constructor(context) {
    this.#context = context;
  }

  /** @param {any} [plan] of the point, with its times at each accuracy */
  async draw(plan) {
    const { point, measured = () => null } = this.#context;
    const accuracy = accuracyOf(point.summary, measured(point.ordinal));
    const own = accuracy.measured?.isOwn ? accuracy.measured.value : null;
    const estimated = costsOf([{ point, error: accuracy.estimate }]);
    const itself = costsOf([{ point, error: own }]);
    const others = costsOf(await (this.#others ??= this.#verified()));
    if (!estimated.length && !itself.length && !others.length) {
      this.element.hidden = true;
      return;
    }
    const times = plan?.accuracies.filter((/** @type {any} */ one) => one.cpu_time) ?? [];
    const { promised } = accuracy;
    await this.#plot({ estimated, itself, others, times, promised });
    fill(
      this.#caption,
      `Filled: measured by verification. Open: estimated from this run. `,
      promised === null ? "" : "The dashed line is the promise. ",
      times.length > 0 &&
        `Dotted: predicted times of this point, ${times.map((/** @type {any} */ one) => `${one.name} ${duration(one.cpu_time)}`).join(", ")}.`,
    );
  }

  /** Other points of the sweep that were verified, with their measured errors. @returns {Promise<{point: any, error: number | null}[]>} */
  async #verified() {
    const { point, path, verified = [], measured = () => null, signal } = this.#context;
    const others = verified.filter((ordinal) => ordinal !== point.ordinal).slice(0, MOST_VERIFIED);
    const points = path.slice(0, path.lastIndexOf("/"));
    return Promise.all(
      others.map(async (ordinal) => {
        const found = measured(ordinal);
        return {
          point: await get(`${points}/${ordinal}`, {}, signal),
          error: found?.isOwn ? found.value : null,
        };
      }),
    );
  }

  /** @param {{estimated: Cost[], itself: Cost[], others: Cost[], times: {name: string, cpu_time: number}[], promised: number | null}} shown */
  #plot({ estimated, itself, others, times, promised }) {
    const { soft } = inks();
    const marks = (/** @type {string} */ name, /** @type {Cost[]} */ costs, /** @type {any} */ marker) => ({
      type: "scatter",
      mode: "markers",
      name,
      x: costs.map(({ cpu }) => cpu),
      y: costs.map(({ error }) => 100 * error),
      marker: { size: 9, ...marker },
      showlegend: costs.length > 0,
      tell: (/** @type {{row: number, x: number, y: number}} */ { row, x, y }) =>
        `${costs[row].text}: ${number(x, 3)} s, ${number(y, 3)} %`,
    });
    const all = [...estimated, ...itself, ...others];
    const x = decades([...all.map(({ cpu }) => cpu), ...times.map(({ cpu_time }) => cpu_time)]);
    const y = decades([...all.map(({ error }) => 100 * error), ...(promised ? [100 * promised] : [])]);
    const line = (/** @type {any} */ ends, /** @type {string} */ dash) => ({
      type: "line",
      line: { color: soft, width: 1.2, dash },
      ...ends,
    });
    const shapes = [
      ...times.map(({ cpu_time }) =>
        line({ xref: "x", yref: "paper", x0: cpu_time, x1: cpu_time, y0: 0, y1: 1 }, "dot"),
      ),
      ...(promised
        ? [line({ xref: "paper", yref: "y", x0: 0, x1: 1, y0: 100 * promised, y1: 100 * promised }, "dash")]
        : []),
    ];
    const annotations = times.map(({ name, cpu_time }) => ({
      x: cpu_time,
      y: y[1],
      text: name,
      showarrow: false,
      xanchor: "left",
      yanchor: "top",
      font: { size: 11 },
    }));
    const traces = [
      marks("this point, estimated", estimated, { color: LINES[0], symbol: "circle-open" }),
      marks("this point, measured", itself, { color: LINES[0] }),
      marks("verified points of the sweep", others, { color: LINES[1] }),
    ];
    const layout = {
      showlegend: true,
      shapes,
      annotations,
      xaxis: { title: "processor time [s]", type: "log", range: x },
      yaxis: { title: "error of orbit size [%]", type: "log", range: y },
    };
    return draw(this.#picture, traces, layout, this.#context.signal);
  }
}
