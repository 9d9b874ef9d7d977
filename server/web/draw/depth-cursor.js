// One depth at which a picture of profiles is read: where the mouse is, or where the keyboard moves a cursor.

import { fill, h } from "../ui/dom.js";
import { adjust, inks } from "./plots.js";
import { rounded } from "../ui/router.js";
import { say, unit } from "../data/units.js";

/** Keys that move the cursor, and by how many nodes; what is deeper is below, as in the picture. @type {Record<string, number>} */
const STEPS = {
  ArrowUp: -1,
  ArrowLeft: -1,
  ArrowDown: 1,
  ArrowRight: 1,
  PageUp: -10,
  PageDown: 10,
  Home: -Infinity,
  End: Infinity,
};

/**
 * @param {HTMLElement} place the picture
 * @param {{query: URLSearchParams, keep: (changes: Record<string, string | null>) => void}} link which holds where the cursor was moved to
 * @param {(depth: number, told: any[]) => import("../ui/dom.js").Child | import("../ui/dom.js").Child[]} read what is at a depth in the unit in which
 *   it is shown, with the points of the picture that the mouse is at
 * @returns {{element: HTMLElement, follow: (shape: any, depths: number[]) => void}} `follow` goes with the picture that has just been
 *   drawn, and moves by its nodes' depths
 */
export function depthCursor(place, link, read) {
  const reading = h(
    "div",
    { class: "small soft", role: "status" },
    "Point at a depth, or move the cursor, to read all profiles there.",
  );
  const slider = h("input", {
    type: "range",
    min: 0,
    max: 0,
    step: 1,
    value: "0",
    disabled: true,
    "aria-label": "Depth cursor",
    onkeydown: stepped,
    oninput: () => move(slider.valueAsNumber),
  });
  const cursor = h(
    "label",
    { class: "field wide" },
    h(
      "span",
      {},
      "Depth cursor: arrow keys move it by a node, Page Up and Page Down by ten, Home and End to the ends",
    ),
    slider,
  );
  /** @type {number[]} */
  let depths = [];
  /** Whether the picture has a line where the cursor was moved to. */
  let isMarked = false;

  /** @param {any} shape @param {number[]} ofNodes */
  function follow(shape, ofNodes) {
    shape.removeAllListeners?.("plotly_hover");
    shape.on?.("plotly_hover", (/** @type {any} */ event) => {
      const { y } = event.points[0];
      slideTo(nearest(depths, y));
      // The mouse has a line of its own.
      if (isMarked) mark(null);
      tell(y, event.points);
    });
    depths = ofNodes;
    Object.assign(slider, { max: String(Math.max(0, depths.length - 1)), disabled: !depths.length });
    const asked = link.query.has("cursor") ? Number(link.query.get("cursor")) : NaN;
    const isAsked = Number.isFinite(asked) && depths.length > 0;
    slideTo(isAsked ? nearest(depths, asked / unit("measured_depth").size) : 0);
    if (isAsked) show(slider.valueAsNumber);
  }

  /** @param {KeyboardEvent} event */
  function stepped(event) {
    const step = STEPS[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    move(Math.max(0, Math.min(depths.length - 1, slider.valueAsNumber + step)));
  }

  /** Moves the cursor to a node. @param {number} index */
  function move(index) {
    slideTo(index);
    link.keep({ cursor: String(rounded(depths[index] * unit("measured_depth").size)) });
    show(index);
  }

  /** @param {number} index of a node */
  function slideTo(index) {
    slider.value = String(index);
    slider.setAttribute("aria-valuetext", depthOf(depths[index] ?? 0));
  }

  /** Shows and reads what is at a node. @param {number} index */
  function show(index) {
    mark(depths[index]);
    tell(depths[index], []);
  }

  /** Draws a line at a depth, or none. @param {number | null} depth */
  function mark(depth) {
    isMarked = depth !== null;
    void adjust(place, {
      shapes: isMarked
        ? [
            {
              type: "line",
              xref: "paper",
              x0: 0,
              x1: 1,
              y0: depth,
              y1: depth,
              line: { color: inks().text, width: 1 },
            },
          ]
        : [],
    });
  }

  /** @param {number} depth in the unit in which it is shown @param {any[]} told */
  function tell(depth, told) {
    fill(reading, `At ${depthOf(depth)}: `, read(depth, told));
  }

  return { element: h("div", {}, cursor, reading), follow };
}

/** @param {number} depth in the unit in which it is shown */
function depthOf(depth) {
  return say("measured_depth", depth * unit("measured_depth").size);
}

/** Where in a list the depth is that is nearest to another; the first of equals. @param {(number | null)[]} depths @param {number} depth */
export function nearest(depths, depth) {
  return depths.reduce(
    (/** @type {number} */ best, entry, index) =>
      Math.abs(Number(entry) - depth) < Math.abs(Number(depths[best]) - depth) ? index : best,
    0,
  );
}
