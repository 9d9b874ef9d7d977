// Panel with what accuracy costs: error against processor time of a point, of the verified points of its sweep, and of a cost study.

import { accuracyOf } from "../data/accuracy.js";
import { get, Problem } from "../data/api.js";
import { duration, number } from "../data/units.js";
import { costsOf, decades, MOST_VERIFIED, studyCosts } from "../data/work-precision.js";
import { canvas, draw, inks, LINES } from "../draw/plots.js";
import { fill, h } from "../ui/dom.js";
import { studyLink } from "./cost-study-link.js";
import { studyParts } from "./cost-study.js";

/** @typedef {import("./part.js").PointContext} PointContext */
/** @typedef {import("../data/work-precision.js").Cost} Cost */

export class AccuracyCost {
  #context;
  #picture = canvas("Error of orbit size against processor time", "cost");
  #caption = h("figcaption", {});
  #words = h("div", {});
  #study = h("p", { class: "small" });
  element = h(
    "section",
    { class: "panel", "aria-label": "What accuracy costs" },
    h("h2", {}, "What accuracy costs"),
    // Above what grows with late answers, so that it stays where it is clicked.
    this.#study,
    h("figure", {}, this.#picture, this.#caption),
    this.#words,
  );

  /** Cost study in place of the point's run, requested once. @type {Promise<any> | undefined} */
  #report;
  /** Link to a cost study, requested once. @type {Promise<HTMLElement | null> | undefined} */
  #link;
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
    const report = point.scenario.cost_study ? await (this.#report ??= this.#studied()) : null;
    const link = point.scenario.cost_study
      ? null
      : await (this.#link ??= studyLink(point, this.#context.signal));
    fill(this.#study, link);
    const study = report && studyCosts(report);
    fill(this.#words, report ? studyParts(report) : null);
    const isEmpty = ![estimated, itself, others, study?.accuracies ?? [], study?.others ?? []].flat().length;
    this.element.hidden = isEmpty && !report && !link;
    /** @type {HTMLElement} */ (this.#picture.parentElement).hidden = isEmpty;
    if (isEmpty) return;
    const times = plan?.accuracies.filter((/** @type {any} */ one) => one.cpu_time) ?? [];
    const { promised } = accuracy;
    await this.#plot({ estimated, itself, others, study, times, promised });
    fill(
      this.#caption,
      study
        ? `Measured by the cost study of this point, relative to the reference on which two methods agree. `
        : `Filled: measured by verification. Open: estimated from this run. `,
      promised === null ? "" : "The dashed line is the promise. ",
      times.length > 0 &&
        `Dotted: predicted times of this point, ${times.map((/** @type {any} */ one) => `${one.name} ${duration(one.cpu_time)}`).join(", ")}.`,
    );
  }

  /** The study; null if its table has expired. @returns {Promise<any>} */
  async #studied() {
    const { path, signal } = this.#context;
    try {
      return await get(`${path}/cost`, {}, signal);
    } catch (error) {
      if (error instanceof Problem && [404, 410].includes(error.status)) return null;
      throw error;
    }
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

  /** @param {{estimated: Cost[], itself: Cost[], others: Cost[], study: ReturnType<typeof studyCosts> | null, times: {name: string, cpu_time: number}[], promised: number | null}} shown */
  #plot({ estimated, itself, others, study, times, promised }) {
    const { soft } = inks();
    const marks = (/** @type {string} */ name, /** @type {Cost[]} */ costs, /** @type {any} */ marker) => ({
      type: "scatter",
      mode: "markers",
      name,
      x: costs.map(({ cpu }) => cpu),
      y: costs.map(({ error }) => 100 * error),
      marker: { size: 9, ...marker },
      showlegend: costs.length > 0,
      describe: (/** @type {{row: number, x: number, y: number}} */ { row, x, y }) =>
        `${costs[row].text}: ${number(x, 3)} s, ${number(y, 3)} %`,
    });
    const [accuracies, rows] = [study?.accuracies ?? [], study?.others ?? []];
    const all = [...estimated, ...itself, ...others, ...accuracies, ...rows];
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
      marks("accuracies, by the study", accuracies, { color: LINES[2], symbol: "diamond" }),
      marks("other methods, by the study", rows, { color: soft, size: 7 }),
    ];
    const layout = {
      showlegend: true,
      shapes,
      annotations,
      xaxis: { title: "processor time [s]", type: "log", range: x },
      yaxis: { title: `${study?.measure ?? "error of orbit size"} [%]`, type: "log", range: y },
    };
    return draw(this.#picture, traces, layout, this.#context.signal);
  }
}
