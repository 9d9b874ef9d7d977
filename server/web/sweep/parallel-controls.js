// Parallel coordinates without a mouse: fields for the ranges to which points are filtered, and buttons that move
// an axis.

import { number } from "../data/units.js";
import { fill, h } from "../ui/dom.js";
import { rounded } from "../ui/router.js";

const SIDES = ["from", "to"];
/** Directions in which an axis is moved, with the places. @type {[string, number][]} */
const MOVES = [
  ["left", -1],
  ["right", 1],
];

/**
 * An axis in the unit in which it is shown: the ends of its values, and its filters, whose ends may be infinite.
 * @typedef {{name: string, title: string, ends: number[], ranges: number[][]}} Axis
 */

/**
 * The controls of all axes, a group for each.
 * @param {(name: string, ranges: number[][]) => void} onChange of an axis' filters
 * @param {(name: string, places: number) => void} onMove of an axis, to the right or, where negative, to the left
 * @returns {{element: HTMLElement, show: (axes: Axis[]) => void}} `show` fills them with what holds
 */
export function axisControls(onChange, onMove) {
  const body = h("div", {});
  /** Axes that the fields were made for. */
  let made = "";
  /** Two for each filter of an axis. @type {Map<string, HTMLInputElement[][]>} */
  const inputs = new Map();

  /** Takes what the fields of an axis say. @param {string} name */
  function take(name) {
    const ranges = (inputs.get(name) ?? []).map(([from, to]) =>
      [from.value ? from.valueAsNumber : -Infinity, to.value ? to.valueAsNumber : Infinity].sort(
        (a, b) => a - b,
      ),
    );
    onChange(
      name,
      ranges.filter((range) => range.some(Number.isFinite)),
    );
  }

  /** @param {Axis[]} axes */
  function show(axes) {
    const wanted = JSON.stringify(axes.map((axis) => [axis.title, axis.ends, rangesOf(axis).length]));
    const isNew = wanted !== made;
    if (isNew) make(axes);
    made = wanted;
    for (const axis of axes) {
      rangesOf(axis).forEach((range, order) => {
        range.forEach((end, side) => {
          const input = inputs.get(axis.name)?.[order][side];
          // A field that is being typed in stays.
          if (input && (isNew || input !== document.activeElement))
            input.value = Number.isFinite(end) ? String(rounded(end)) : "";
        });
      });
    }
  }

  /** @param {Axis[]} axes */
  function make(axes) {
    inputs.clear();
    const parts = axes.map((axis, place) => {
      const name = axis.title;
      const pairs = rangesOf(axis).map((_, order) =>
        SIDES.map((side, index) =>
          h("input", {
            type: "number",
            step: "any",
            placeholder: number(axis.ends[index]),
            "aria-label": `${name}, ${side}${order ? `, range ${order + 1}` : ""}`,
            onchange: () => take(axis.name),
          }),
        ),
      );
      inputs.set(axis.name, pairs);
      const fields = pairs.flatMap((pair) =>
        pair.map((input, index) => h("label", { class: "field" }, h("span", {}, SIDES[index]), input)),
      );
      const moves = MOVES.map(([where, by]) =>
        moveButton(`Move ${name} ${where}`, where, axes[place + by] ? () => onMove(axis.name, by) : null),
      );
      return h("fieldset", {}, h("legend", {}, name), h("div", { class: "controls" }, fields, moves));
    });
    fill(
      body,
      h("p", { class: "small soft" }, "An empty end means the end of the axis."),
      h("div", { class: "ranges" }, parts),
    );
  }

  /**
   * A button that goes with its axis. At the end of the row it stays, without an effect, so that the keyboard's focus has a place.
   * @param {string} name @param {string} where @param {(() => void) | null} move
   */
  function moveButton(name, where, move) {
    return h(
      "button",
      { type: "button", "aria-label": name, "aria-disabled": move ? null : "true", onclick: move },
      `Move ${where}`,
    );
  }

  return { element: h("details", {}, h("summary", {}, "Keep points by numbers, move axes"), body), show };
}

/** Filters of an axis; an empty one to be filled in if it has none. @param {Axis} axis */
function rangesOf({ ranges }) {
  return ranges.length ? ranges : [[-Infinity, Infinity]];
}
