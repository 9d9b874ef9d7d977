// A finer grid over a region of a map: its bounds and counts, what it would take, and the request that adds it to the sweep.

import { get, Problem, send } from "../data/api.js";
import { duration, label, say, title, unit } from "../data/units.js";
import { debounced, fill, h } from "../ui/dom.js";
import { notice } from "../ui/notices.js";
import { MAY_NOT, maySubmit } from "../ui/session.js";
import { bodyLines, python, snippets } from "../ui/snippets.js";

const COUNT = 5;

/**
 * @typedef {object} Side
 * @property {string} name of the parameter
 * @property {number} from as served
 * @property {number} to as served
 * @property {number} count
 */

/** A parameter that is not shown, and its value in the grid: that of the slice that is shown, or one to be chosen. @typedef {{name: string, value: number, isFree: boolean}} Held */

/** Members of a sweep's request that say how its points are made or what it is called; added points do not take them over. */
const OF_THE_SWEEP = new Set([
  "axes",
  "design",
  "points",
  "samples",
  "seed",
  "skip",
  "name",
  "tags",
  "verify",
  "owner",
  "priority",
]);

/** Side of a region: the members of an axis of a request. @param {Side} side @param {any} given how the sweep's request gives the values */
function spanOf({ from, to, count }, given) {
  if (count <= 1) return { values: [from] };
  return { from, to, count, ...(given?.scale === "log" ? { scale: "log" } : {}) };
}

/** @typedef {import("./part.js").Context} Context */

/** A form for a finer grid; its element has an event `closed`. */
export class FinerGrid {
  #context;
  #planned = h("p", { role: "status" });
  #wrong = h("p", { class: "wrong", role: "alert" });
  #add = h("button", { class: "main", type: "submit", disabled: true }, "Add");
  #snippets = snippets(() => this.#lines(), "The same request");
  #rested;
  /** @type {Side[]} */
  #sides = [];
  /** @type {Held[]} */
  #held = [];
  #generation = 0;
  #isSent = false;
  element = h("section", { class: "panel finer", "aria-label": "Finer grid", hidden: true });

  /** @param {Context} context */
  constructor(context) {
    this.#context = context;
    this.#rested = debounced(() => void this.#dryRun(), 300, context.signal);
  }

  get isOpen() {
    return !this.element.hidden;
  }

  /** The region of these parameters in the link, if it has one. @param {string[]} names @returns {Side[] | null} */
  kept(names) {
    const given = (this.#context.query.get("finer") ?? "")
      .split(",")
      .map((text) => text.split(":"))
      .map(([name, ...numbers]) => ({ name, numbers: numbers.map(Number) }));
    const isWhole =
      given.length === names.length &&
      given.every(
        ({ name, numbers }) => names.includes(name) && numbers.length === 3 && numbers.every(Number.isFinite),
      );
    return isWhole
      ? given.map(({ name, numbers: [from, to, count] }) => ({
          name,
          from,
          to,
          count: Math.max(1, Math.round(count)),
        }))
      : null;
  }

  /** Shows the form for a region, and plans its points. @param {Side[]} sides @param {Held[]} held */
  choose(sides, held) {
    // To six digits: a pixel's width is less than that.
    this.#sides = sides.map((side) => ({
      ...side,
      count: side.count || COUNT,
      from: Number(side.from.toPrecision(6)),
      to: Number(side.to.toPrecision(6)),
    }));
    this.#held = held;
    this.#keepRegion();
    this.element.hidden = false;
    fill(
      this.element,
      h("h2", {}, "A finer grid"),
      h("p", { class: "small soft" }, "Drag over a region of the map, or give its bounds."),
      h(
        "form",
        { novalidate: true, onsubmit: (/** @type {Event} */ event) => this.#submit(event) },
        this.#sides.map((side) => this.#sideFields(side)),
        this.#heldPart(),
        this.#planned,
        this.#wrong,
        h(
          "div",
          { class: "controls" },
          this.#add,
          h("button", { type: "button", onclick: () => this.close() }, "Close"),
        ),
      ),
      this.#snippets,
    );
    this.#plan();
  }

  close() {
    this.element.hidden = true;
    this.#context.keep({ finer: null });
    this.element.dispatchEvent(new Event("closed"));
  }

  /** Keeps the region in the link, in the service's units. */
  #keepRegion() {
    this.#context.keep({
      finer: this.#sides.map(({ name, from, to, count }) => [name, from, to, count].join(":")).join(","),
    });
  }

  get #path() {
    return `/v1/sweeps/${encodeURIComponent(this.#context.sweep.id)}/points`;
  }

  /** The request that adds the points. */
  #request() {
    const { axes, spans, paths } = this.#context;
    const given = axes.map((name) => {
      const side = this.#sides.find((one) => one.name === name);
      const value = this.#held.find((one) => one.name === name)?.value;
      return [paths[name] ?? name, side ? spanOf(side, spans[name]) : { values: [value] }];
    });
    return { axes: Object.fromEntries(given) };
  }

  /** Plans what is entered; only what was planned can be added, so that an older plan is void. */
  #plan() {
    this.#generation += 1;
    this.#add.disabled = true;
    this.#rested();
  }

  async #dryRun() {
    const { sweep, signal } = this.#context;
    const mine = ++this.#generation;
    this.#snippets.dispatchEvent(new Event("redraw"));
    try {
      const scene = Object.fromEntries(
        Object.entries(sweep.request ?? (await get(sweep.links.request, {}, signal))).filter(
          ([name]) => !OF_THE_SWEEP.has(name),
        ),
      );
      const answer = await send("POST", "/v1/sweeps?dry_run=true", { ...scene, ...this.#request() }, signal);
      if (mine !== this.#generation) return;
      this.#wrong.textContent = "";
      fill(
        this.#planned,
        `${answer.total} points; ${answer.known} are known and not computed again; ${sayTime(answer)}. Points that the sweep has already are skipped.`,
      );
      this.#add.disabled = this.#isSent || !maySubmit();
      this.#add.title = maySubmit() ? "" : MAY_NOT;
      this.#add.textContent = `Add ${answer.total} ${answer.total === 1 ? "point" : "points"}`;
    } catch (error) {
      if (signal.aborted || mine !== this.#generation) return;
      fill(this.#planned);
      const details = error instanceof Problem ? error.errors.map(({ detail }) => detail).join(" ") : "";
      this.#wrong.textContent = details || (error instanceof Error ? error.message : String(error));
    }
  }

  #lines() {
    const body = this.#request();
    const axis = (/** @type {any} */ span) =>
      span.values
        ? python(span.values)
        : `Range(${span.from}, ${span.to}, ${span.count}${span.scale ? ', scale="log"' : ""})`;
    const axes = Object.entries(body.axes)
      .map(([name, span]) => `${JSON.stringify(name)}: ${axis(span)}`)
      .join(", ");
    return {
      ...bodyLines(this.#path, body),
      python: `from drillsweep import Client, Range\n\nsweep = Client("${location.origin}").sweep("${this.#context.sweep.id}")\nsweep.append({${axes}})`,
    };
  }

  /** A field for a number. @param {string} text @param {number} value @param {(value: number) => void} set */
  #box(text, value, set) {
    const input = h("input", {
      type: "number",
      step: "any",
      style: "width:8rem",
      value,
      oninput: () => {
        if (input.value === "" || !Number.isFinite(Number(input.value))) return;
        set(Number(input.value));
        this.#plan();
      },
    });
    return h("label", { class: "field" }, h("span", {}, text), input);
  }

  /** Parameters that are not shown: fields for free ones, and the values of the slice. */
  #heldPart() {
    const [free, sliced] = [this.#held.filter((one) => one.isFree), this.#held.filter((one) => !one.isFree)];
    return [
      free.length > 0 &&
        h(
          "fieldset",
          { class: "controls" },
          h("legend", {}, "Held parameters that differ between the drawn points"),
          free.map((one) => this.#heldField(one)),
        ),
      sliced.length > 0 &&
        h(
          "p",
          { class: "small" },
          `Held: ${sliced.map(({ name, value }) => `${label(name)} ${say(name, value)}`).join(", ")}.`,
        ),
    ];
  }

  /** @param {Held} one */
  #heldField(one) {
    const { size } = unit(one.name);
    return this.#box(title(one.name), Number((one.value / size).toPrecision(6)), (value) => {
      this.#held = this.#held.map((other) =>
        other.name === one.name ? { ...other, value: value * size } : other,
      );
      this.#context.keep({ [`at.${one.name}`]: String(value * size) });
    });
  }

  /** @param {Side} side */
  #sideFields({ name, from, to, count }) {
    const { size, symbol } = unit(name);
    const change = (/** @type {Partial<Side>} */ changes) => {
      this.#sides = this.#sides.map((side) => (side.name === name ? { ...side, ...changes } : side));
      this.#keepRegion();
    };
    const shownAs = (/** @type {number} */ value) => Number((value / size).toPrecision(6));
    const titled = (/** @type {string} */ text) => (symbol ? `${text} [${symbol}]` : text);
    return h(
      "fieldset",
      { class: "controls" },
      h("legend", {}, label(name)),
      this.#box(titled("From"), shownAs(from), (value) => change({ from: value * size })),
      this.#box(titled("To"), shownAs(to), (value) => change({ to: value * size })),
      this.#box("Values", count, (value) => change({ count: Math.max(1, Math.round(value)) })),
    );
  }

  /** @param {Event} event */
  async #submit(event) {
    event.preventDefault();
    this.#add.disabled = true;
    this.#isSent = true;
    try {
      const before = this.#context.sweep.counts.total;
      const changed = await send("POST", this.#path, this.#request());
      const added = changed.counts.total - before;
      notice(
        added
          ? `${added} ${added === 1 ? "point is" : "points are"} added.`
          : "The sweep has all of these points already.",
      );
      this.#context.changed(changed);
      this.close();
    } catch (error) {
      this.#wrong.textContent = error instanceof Error ? error.message : String(error);
      this.#add.disabled = false;
    } finally {
      this.#isSent = false;
    }
  }
}

/** Time that the points of a dry run take, in words. @param {any} answer */
function sayTime(answer) {
  if (answer.known === answer.total) return "nothing is left to compute";
  if (answer.wall_time) return `about ${duration(answer.wall_time)} on the workers there are`;
  return answer.cpu_time ? `${duration(answer.cpu_time)} of processor time` : "how long is not known";
}
