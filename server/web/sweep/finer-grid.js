// A finer grid over a region of a map: its bounds and counts, what it would take, and the request that adds it to the sweep.

import { Problem, send } from "../data/api.js";
import { debounced, fill, h } from "../ui/dom.js";
import { bodyLines, lines, python } from "../ui/snippets.js";
import { notice } from "../ui/notices.js";
import { MAY_NOT, maySubmit } from "../ui/session.js";
import { duration, label, say, title, unit } from "../data/units.js";

const COUNT = 5;

/**
 * @typedef {object} Side
 * @property {string} name of the parameter
 * @property {number} from as served
 * @property {number} to as served
 * @property {number} count
 */

/** A parameter that is not shown, and its value in the grid: that of the slice that is shown, or one to be chosen. @typedef {{name: string, value: number, isFree: boolean}} Held */

/** What of a sweep's request says how its points are made, or how it is called: not of those that are added. */
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

/**
 * @param {import("./part.js").Context} context
 * @returns {{element: HTMLElement, choose: (sides: Side[], held: Held[]) => void, close: () => void, kept: (names: string[]) => Side[] | null}}
 *   `kept` is the region that the link has of these parameters
 */
export function finer(context) {
  const element = h("section", { class: "panel finer", "aria-label": "Finer grid", hidden: true });
  const planned = h("p", { role: "status" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const add = h("button", { class: "main", type: "submit", disabled: true }, "Add");
  /** @type {Side[]} */
  let sides = [];
  /** @type {Held[]} */
  let held = [];
  let generation = 0;
  let isSent = false;

  /** Keeps the region in the link, in the service's units. */
  const keepRegion = () =>
    context.keep({
      finer: sides.map(({ name, from, to, count }) => [name, from, to, count].join(":")).join(","),
    });

  const path = () => `/v1/sweeps/${encodeURIComponent(context.sweep.id)}/points`;

  function request() {
    const axes = context.axes.map((name) => {
      const side = sides.find((one) => one.name === name);
      const value = held.find((one) => one.name === name)?.value;
      const span = side
        ? side.count > 1
          ? {
              from: side.from,
              to: side.to,
              count: side.count,
              ...(context.spans[name]?.scale === "log" ? { scale: "log" } : {}),
            }
          : { values: [side.from] }
        : { values: [value] };
      return [context.paths[name] ?? name, span];
    });
    return { axes: Object.fromEntries(axes) };
  }

  const rested = debounced(
    async () => {
      const mine = ++generation;
      taken.dispatchEvent(new Event("redraw"));
      try {
        const scene = Object.fromEntries(
          Object.entries(context.sweep.request ?? {}).filter(([name]) => !OF_THE_SWEEP.has(name)),
        );
        const answer = await send(
          "POST",
          "/v1/sweeps?dry_run=true",
          { ...scene, ...request() },
          context.signal,
        );
        if (mine !== generation) return;
        wrong.textContent = "";
        const time =
          answer.known === answer.total
            ? "nothing is left to compute"
            : answer.wall_time
              ? `about ${duration(answer.wall_time)} on the workers there are`
              : answer.cpu_time
                ? `${duration(answer.cpu_time)} of processor time`
                : "how long is not known";
        fill(
          planned,
          `${answer.total} points; ${answer.known} are known and not computed again; ${time}. Points that the sweep has already are skipped.`,
        );
        add.disabled = isSent || !maySubmit();
        add.title = maySubmit() ? "" : MAY_NOT;
        add.textContent = `Add ${answer.total} ${answer.total === 1 ? "point" : "points"}`;
      } catch (error) {
        if (context.signal.aborted || mine !== generation) return;
        fill(planned);
        const details = error instanceof Problem ? error.errors.map(({ detail }) => detail).join(" ") : "";
        wrong.textContent = details || (error instanceof Error ? error.message : String(error));
      }
    },
    300,
    context.signal,
  );

  /** What is added is what was planned: a plan that is under way is of what was there before. */
  function plan() {
    generation += 1;
    add.disabled = true;
    rested();
  }

  const taken = lines(() => {
    const body = request();
    const axis = (/** @type {any} */ span) =>
      span.values
        ? python(span.values)
        : `Range(${span.from}, ${span.to}, ${span.count}${span.scale ? ', scale="log"' : ""})`;
    return {
      ...bodyLines(path(), body),
      python: `from drillsweep import Client, Range\n\nsweep = Client("${location.origin}").sweep("${context.sweep.id}")\nsweep.append({${Object.entries(
        body.axes,
      )
        .map(([name, span]) => `${JSON.stringify(name)}: ${axis(span)}`)
        .join(", ")}})`,
    };
  }, "The same request");

  /** A field for a number. @param {string} text @param {number} value @param {(value: number) => void} set */
  function box(text, value, set) {
    const input = h("input", {
      type: "number",
      step: "any",
      style: "width:8rem",
      value,
      oninput: () => {
        if (input.value === "" || !Number.isFinite(Number(input.value))) return;
        set(Number(input.value));
        plan();
      },
    });
    return h("label", { class: "field" }, h("span", {}, text), input);
  }

  /** @param {Held} one */
  function heldField(one) {
    return box(title(one.name), Number((one.value / unit(one.name).size).toPrecision(6)), (value) => {
      one.value = value * unit(one.name).size;
      context.keep({ [`at.${one.name}`]: String(one.value) });
    });
  }

  /** @param {Side} side */
  function fields(side) {
    const { size, symbol } = unit(side.name);
    const kept = (/** @type {(value: number) => void} */ set) => (/** @type {number} */ value) => {
      set(value);
      keepRegion();
    };
    const shownAs = (/** @type {number} */ value) => Number((value / size).toPrecision(6));
    return h(
      "fieldset",
      { class: "controls" },
      h("legend", {}, label(side.name)),
      box(
        symbol ? `From [${symbol}]` : "From",
        shownAs(side.from),
        kept((value) => (side.from = value * size)),
      ),
      box(
        symbol ? `To [${symbol}]` : "To",
        shownAs(side.to),
        kept((value) => (side.to = value * size)),
      ),
      box(
        "Values",
        side.count,
        kept((value) => (side.count = Math.max(1, Math.round(value)))),
      ),
    );
  }

  async function submit(/** @type {Event} */ event) {
    event.preventDefault();
    add.disabled = true;
    isSent = true;
    try {
      const before = context.sweep.counts.total;
      const changed = await send("POST", path(), request());
      const added = changed.counts.total - before;
      notice(
        added
          ? `${added} ${added === 1 ? "point is" : "points are"} added.`
          : "The sweep has all of these points already.",
      );
      context.changed(changed);
      close();
    } catch (error) {
      wrong.textContent = error instanceof Error ? error.message : String(error);
      add.disabled = false;
    } finally {
      isSent = false;
    }
  }

  function close() {
    element.hidden = true;
    context.keep({ finer: null });
    element.dispatchEvent(new Event("closed"));
  }

  return {
    element,
    close,
    kept: (names) => {
      const given = (context.query.get("finer") ?? "")
        .split(",")
        .map((text) => text.split(":"))
        .map(([name, ...numbers]) => ({ name, numbers: numbers.map(Number) }));
      const isWhole =
        given.length === names.length &&
        given.every(
          ({ name, numbers }) =>
            names.includes(name) && numbers.length === 3 && numbers.every(Number.isFinite),
        );
      return isWhole
        ? given.map(({ name, numbers: [from, to, count] }) => ({
            name,
            from,
            to,
            count: Math.max(1, Math.round(count)),
          }))
        : null;
    },
    choose: (chosen, others) => {
      // To six digits: a pixel's width is less than that.
      sides = chosen.map((side) => ({
        ...side,
        count: side.count || COUNT,
        from: Number(side.from.toPrecision(6)),
        to: Number(side.to.toPrecision(6)),
      }));
      held = others;
      const [free, sliced] = [held.filter((one) => one.isFree), held.filter((one) => !one.isFree)];
      keepRegion();
      element.hidden = false;
      fill(
        element,
        h("h2", {}, "A finer grid"),
        h("p", { class: "small soft" }, "Drag over a region of the map, or give its bounds."),
        h(
          "form",
          { novalidate: true, onsubmit: submit },
          sides.map(fields),
          free.length > 0 &&
            h(
              "fieldset",
              { class: "controls" },
              h("legend", {}, "Held, where the drawn points differ"),
              free.map(heldField),
            ),
          sliced.length > 0 &&
            h(
              "p",
              { class: "small" },
              `Held: ${sliced.map(({ name, value }) => `${label(name)} ${say(name, value)}`).join(", ")}.`,
            ),
          planned,
          wrong,
          h("div", { class: "controls" }, add, h("button", { type: "button", onclick: close }, "Close")),
        ),
        taken,
      );
      plan();
    },
  };
}
