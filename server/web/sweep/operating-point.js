// Operating point of a window: a cross on the map and a slider for each parameter, with the nearest computed point next to it.

import { get } from "../data/api.js";
import { nearestRow, partOf, rangesOf, valueAtPart } from "../data/nearest-point.js";
import { label, say, sayParameters, unit } from "../data/units.js";
import { classWord } from "../draw/class-word.js";
import { Overview } from "../draw/overview.js";
import { pictureOf } from "../draw/picture/picture.js";
import { debounced, fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { link } from "../ui/router.js";

/** Rest of the operating point before the nearest point's pictures are requested [ms]. */
const REST_MS = 200;
/** Steps of a slider, and steps of the cross by one key. */
const STEPS = 100,
  STRIDE = 2;
/** Prefix of the parameters' values in the link. */
const IN_LINK = "point.";
/** @type {Record<string, [number, number]>} */
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };

/** @typedef {import("./part.js").Context} Context */
/** @typedef {import("../data/nearest-point.js").Span} Span */
/** Class of a point, and the reason for which it is uncertain. @typedef {{word: string | null, doubt: string}} Judged */

export class OperatingPoint {
  #context;
  #picture;
  #hold;
  /** @type {(ordinal: number) => Judged | undefined} */
  #judged = () => undefined;
  /** @type {Map<string, (number | string | null)[]>} */
  #columns = new Map();
  /** @type {(number | string | null)[]} */
  #ordinals = [];
  /** @type {Span[]} */
  #spans = [];
  /** Values by parameter, in served units. @type {Map<string, number>} */
  #place = new Map();
  /** Number of the point whose pictures are shown. */
  #shown = 0;
  #sliders = h("div", { class: "ranges sliders" });
  #nearest = h("p", { class: "nearest", role: "status" });
  #pictures = h("div", {});
  #cross = h("button", {
    type: "button",
    class: "cross",
    hidden: true,
    "aria-label": "Operating point: arrow keys move it",
    onpointerdown: (/** @type {PointerEvent} */ event) => this.#cross.setPointerCapture(event.pointerId),
    onpointermove: (/** @type {PointerEvent} */ event) =>
      this.#cross.hasPointerCapture(event.pointerId) && this.#drag(event),
    onkeydown: (/** @type {KeyboardEvent} */ event) => this.#press(event),
  });
  #rested;
  element = h(
    "section",
    { class: "panel", "aria-label": "Operating point", hidden: true },
    h("h2", {}, "Operating point"),
    this.#sliders,
    this.#nearest,
    this.#pictures,
  );

  /**
   * @param {Context} context
   * @param {HTMLElement} picture the map
   * @param {() => void} hold draws the map with other values of the held parameters
   */
  constructor(context, picture, hold) {
    this.#context = context;
    this.#picture = picture;
    this.#hold = hold;
    this.#rested = debounced(() => attend(this.#showPictures(), context.signal), REST_MS, context.signal);
    // Zooming and resizing move the place of the point in the picture.
    picture.addEventListener("painted", () => this.#moveCross());
  }

  /**
   * Shows the point among points that have been judged anew.
   * @param {(ordinal: number) => Judged | undefined} judged
   */
  async redraw(judged) {
    this.#judged = judged;
    const { axes, spans, table, query } = this.#context;
    const [ordinals, ...values] = await table.columns("ordinal", ...axes);
    this.#ordinals = ordinals;
    this.#columns = new Map(axes.map((axis, index) => [axis, values[index]]));
    this.#spans = rangesOf(this.#columns, spans);
    for (const span of this.#spans) {
      const asked = Number(query.get(IN_LINK + span.name) ?? NaN);
      const known = this.#place.get(span.name) ?? (Number.isFinite(asked) ? asked : valueAtPart(span, 0.5));
      this.#place.set(span.name, Math.max(span.from, Math.min(span.to, known)));
    }
    this.element.hidden = this.#spans.length === 0;
    if (!this.#sliders.childElementCount)
      fill(
        this.#sliders,
        this.#spans.map((span) => this.#slider(span)),
      );
    this.#show();
  }

  /** Parameters of the map. */
  get #sides() {
    const { axes, query } = this.#context;
    const x = query.get("x") ?? axes[0];
    const y = query.get("y") ?? axes.find((axis) => axis !== x);
    return [x, y].map((name) => this.#spans.find((span) => span.name === name));
  }

  /** @param {Span} span */
  #slider(span) {
    const words = h("output", {}, say(span.name, this.#place.get(span.name)));
    const input = h("input", {
      type: "range",
      min: 0,
      max: STEPS,
      step: "any",
      "data-parameter": span.name,
      "aria-label": label(span.name),
      value: STEPS * partOf(span, this.#place.get(span.name) ?? span.from),
      oninput: () => this.#move(new Map([[span.name, Number(input.value) / STEPS]])),
    });
    return h("label", { class: "field" }, h("span", {}, label(span.name), " ", words), input);
  }

  /** Moves the point. @param {Map<string, number>} parts of the ranges by parameter */
  #move(parts) {
    /** @type {Record<string, string>} */
    const kept = {};
    for (const [name, part] of parts) {
      const span = this.#spans.find((one) => one.name === name);
      if (!span) continue;
      const value = Number(valueAtPart(span, Math.max(0, Math.min(1, part))).toPrecision(6));
      this.#place.set(name, value);
      kept[IN_LINK + name] = String(value);
    }
    this.#context.keep({ ...kept, ...this.#slice() });
    this.#show();
  }

  /** Values of the held parameters that are nearest to the point; draws the map if they are others than before. */
  #slice() {
    const sides = this.#sides.map((span) => span?.name);
    /** @type {Record<string, string>} */
    const changed = {};
    for (const span of this.#spans.filter(({ name }) => !sides.includes(name))) {
      const values = /** @type {number[]} */ (
        this.#columns.get(span.name)?.filter((value) => typeof value === "number")
      );
      const wanted = partOf(span, this.#place.get(span.name) ?? span.from);
      const nearest = values.reduce((best, value) =>
        Math.abs(partOf(span, value) - wanted) < Math.abs(partOf(span, best) - wanted) ? value : best,
      );
      const key = `at.${span.name}`;
      if (this.#context.query.get(key) !== String(nearest)) changed[key] = String(nearest);
    }
    if (Object.keys(changed).length) queueMicrotask(this.#hold);
    return changed;
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    const step = KEYS[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    this.#moveOnMap(
      (span, side) => partOf(span, this.#place.get(span.name) ?? span.from) + (STRIDE / STEPS) * step[side],
    );
  }

  /** @param {PointerEvent} event */
  #drag({ clientX, clientY }) {
    const { left, top } = this.#picture.getBoundingClientRect();
    const pixels = [clientX - left, clientY - top];
    this.#moveOnMap((span, side) => {
      const axis = pictureOf(this.#picture)?.axis(side ? "yaxis" : "xaxis");
      return axis ? partOf(span, axis.toValue(pixels[side]) * unit(span.name).size) : 0;
    });
  }

  /** @param {(span: Span, side: number) => number} part along the range of each side */
  #moveOnMap(part) {
    const moved = this.#sides.flatMap((span, side) =>
      span ? [/** @type {[string, number]} */ ([span.name, part(span, side)])] : [],
    );
    this.#move(new Map(moved));
  }

  /** Puts the cross on the map, once that is drawn. */
  #moveCross() {
    const picture = pictureOf(this.#picture);
    const [across, up] = [picture?.axis("xaxis"), picture?.axis("yaxis")];
    const [x, y] = this.#sides;
    const isDrawn = across && up && x && y;
    this.#cross.hidden = !isDrawn;
    if (!isDrawn) return;
    if (!this.#cross.isConnected) this.#picture.after(this.#cross);
    const at = (/** @type {import("../draw/picture/axis.js").Axis} */ axis, /** @type {Span} */ { name }) =>
      axis.toPixel((this.#place.get(name) ?? 0) / unit(name).size);
    this.#cross.style.left = `${this.#picture.offsetLeft + at(across, x)}px`;
    this.#cross.style.top = `${this.#picture.offsetTop + at(up, y)}px`;
  }

  #row() {
    const isComputed = (/** @type {number} */ row) =>
      Boolean(this.#judged(Number(this.#ordinals[row]))?.word);
    return nearestRow(this.#spans, this.#columns, this.#place, isComputed);
  }

  #show() {
    this.#moveCross();
    for (const input of /** @type {NodeListOf<HTMLInputElement>} */ (
      this.#sliders.querySelectorAll("input")
    )) {
      const span = this.#spans.find(({ name }) => name === input.dataset.parameter);
      if (!span) continue;
      const value = this.#place.get(span.name) ?? span.from;
      if (document.activeElement !== input) input.value = String(STEPS * partOf(span, value));
      fill(/** @type {HTMLElement} */ (input.parentElement?.querySelector("output")), say(span.name, value));
    }
    const row = this.#row();
    if (row < 0) return fill(this.#nearest, "No point has a result yet.");
    const ordinal = Number(this.#ordinals[row]);
    const { word, doubt } = this.#judged(ordinal) ?? { word: null, doubt: "" };
    const parameters = Object.fromEntries(
      [...this.#columns].map(([name, values]) => [name, Number(values[row])]),
    );
    fill(
      this.#nearest,
      "Nearest computed point: ",
      h(
        "a",
        { href: link(["sweeps", this.#context.sweep.id, "points", String(ordinal)]) },
        `point ${ordinal}`,
      ),
      ", ",
      classWord(word ?? ""),
      doubt && ` (${doubt})`,
      `, ${sayParameters(parameters)}`,
    );
    this.#rested();
  }

  async #showPictures() {
    const row = this.#row();
    const ordinal = Number(this.#ordinals[row]);
    if (row < 0 || ordinal === this.#shown) return;
    this.#shown = ordinal;
    const { sweep, signal } = this.#context;
    const path = `/v1/sweeps/${encodeURIComponent(sweep.id)}/points/${ordinal}`;
    const point = await get(path, {}, signal);
    if (this.#shown !== ordinal) return;
    if (!point.summary) return fill(this.#pictures);
    const overview = new Overview(
      {
        point,
        query: new URLSearchParams(),
        diagnosis: () => get(`${path}/diagnosis`, {}, signal),
        table: (table, asks = {}) => get(`${path}/${table}`, { format: "json", ...asks }, signal),
        signal,
      },
      ["sweeps", sweep.id, "points", String(ordinal)],
    );
    fill(this.#pictures, overview.element);
    await overview.draw();
  }
}
