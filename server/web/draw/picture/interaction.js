// Work of the mouse and of fingers on a picture: they read it, click on it, and drag across it.

import { h } from "../../ui/dom.js";
import { isEqual } from "./layout.js";

/** Movement below which a press is a click, and extent of a zoom below which one direction alone is zoomed [pixels]. */
const [CLICK, THIN] = [4, 12];

/** @typedef {import("./axis.js").Axis} Axis */
/** @typedef {import("./layout.js").Panel} Panel */
/**
 * Picture as far as the mouse has to do with it.
 * @typedef {object} Surface
 * @property {HTMLElement} place
 * @property {any} layout
 * @property {Map<string, Axis>} axes
 * @property {import("./layout.js").Frame} frame
 * @property {import("./buttons.js").Mode} mode
 * @property {(px: number, py: number) => Panel | undefined} panelAt
 * @property {(axis: Axis) => Panel | undefined} panelOf
 * @property {(panel: Panel) => Axis[]} axesIn
 * @property {(ranges: Map<Axis, [number, number]>) => void} setRanges
 * @property {(px: number, py: number) => unknown} describe
 * @property {(px: number, py: number) => void} click
 * @property {() => void} hush
 * @property {(axes?: Axis[]) => void} reset
 * @property {(name: string, detail?: any) => void} dispatch
 */
/** @typedef {{x: number, y: number}} Place in the picture [pixels] */
/** Ends of a dragged area; null along a direction that it leaves as it is. @typedef {{x: [number, number] | null, y: [number, number] | null}} Box */
/** A drag: its ends, the panel, and the ranges with which it began, of all axes of the panel or of the one that is held. @typedef {{start: Place, now: Place, panel: Panel, isDragged: boolean, isOfAxis: boolean, ranges: Map<Axis, [number, number]>}} Drag */

/**
 * Area that is zoomed to: of a thin one, one direction alone; where both directions have one scale, as wide for its height as the panel.
 * @param {Place} start
 * @param {Place} end
 * @param {Panel} panel
 * @param {boolean} hasOneScale
 * @returns {Box | null} null of a short one
 */
export function zoomBox(start, end, { x, y }, hasOneScale) {
  const within = (/** @type {number} */ pixel, /** @type {Axis} */ { offset, length }) =>
    Math.max(offset, Math.min(offset + length, pixel));
  /** @type {[number, number]} */
  const across = [within(start.x, x), within(end.x, x)];
  /** @type {[number, number]} */
  const up = [within(start.y, y), within(end.y, y)];
  const [wide, high] = [Math.abs(across[1] - across[0]), Math.abs(up[1] - up[0])];
  if (Math.max(wide, high) < THIN) return null;
  if (hasOneScale) {
    const part = Math.max(wide / x.length, high / y.length);
    return { x: about(across, part * x.length), y: about(up, part * y.length) };
  }
  return { x: wide < THIN ? null : across, y: high < THIN ? null : up };
}

/** Ends of a width about the middle of two places. @param {[number, number]} ends @param {number} width @returns {[number, number]} */
function about([from, to], width) {
  const middle = (from + to) / 2;
  return [middle - width / 2, middle + width / 2];
}

/** Listens to the mouse on the panels of a picture. */
export class Interaction {
  #picture;
  #shade = h("div", { class: "shade", hidden: true });
  /** @type {Drag | null} */
  #drag = null;
  /** Newest move of the mouse that is not yet read. @type {Place | null} */
  #moved = null;

  /** @param {Surface} picture @param {HTMLElement} areas where the panels are */
  constructor(picture, areas) {
    this.#picture = picture;
    areas.after(this.#shade);
    areas.addEventListener("pointerdown", (event) => this.#press(event, areas));
    areas.addEventListener("pointermove", (event) => this.#move(event));
    areas.addEventListener("pointerup", (event) => this.#release(event));
    areas.addEventListener("pointercancel", () => this.#cancel());
    areas.addEventListener("pointerleave", () => this.#leave());
    areas.addEventListener("dblclick", (event) => {
      const axis = this.#axisAt(event);
      this.#picture.reset(axis ? [axis] : undefined);
    });
  }

  /** @param {PointerEvent} event @returns {Place} */
  #placeOf({ clientX, clientY }) {
    const { left, top } = this.#picture.place.getBoundingClientRect();
    return { x: clientX - left, y: clientY - top };
  }

  /** @param {PointerEvent} event @param {HTMLElement} areas */
  #press(event, areas) {
    const start = this.#placeOf(event);
    const held = this.#axisAt(event);
    const panel = held ? this.#picture.panelOf(held) : this.#picture.panelAt(start.x, start.y);
    if (event.button !== 0 || !panel) return;
    areas.setPointerCapture(event.pointerId);
    const axes = held ? [held] : this.#picture.axesIn(panel);
    const ranges = new Map(axes.map((axis) => [axis, axis.range]));
    this.#drag = { start, now: start, panel, isDragged: false, isOfAxis: held !== undefined, ranges };
  }

  /** The axis whose numbers the mouse is on. @param {MouseEvent} event @returns {Axis | undefined} */
  #axisAt({ target }) {
    const name = target instanceof HTMLElement ? target.dataset.axis : undefined;
    return name ? this.#picture.axes.get(name) : undefined;
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const isDue = this.#moved !== null;
    this.#moved = this.#placeOf(event);
    if (!isDue) requestAnimationFrame(() => this.#read());
  }

  /** Follows the newest move. */
  #read() {
    const now = this.#moved;
    this.#moved = null;
    if (!now) return;
    if (this.#drag) this.#follow(this.#drag, now);
    else this.#picture.describe(now.x, now.y);
  }

  /** @param {Drag} drag @param {Place} now */
  #follow(drag, now) {
    drag.now = now;
    drag.isDragged ||= Math.hypot(now.x - drag.start.x, now.y - drag.start.y) >= CLICK;
    if (!drag.isDragged) return;
    const picture = this.#picture;
    picture.hush();
    if (picture.mode === "pan" || drag.isOfAxis) return this.#pan(drag);
    this.#shadeOver(drag);
    if (picture.mode === "select") picture.dispatch("choosing", this.#chosen(drag));
  }

  /** @param {Drag} drag */
  #pan({ start, now, ranges }) {
    for (const [axis, range] of ranges) {
      axis.range = range;
      const by = axis.isAcross ? now.x - start.x : now.y - start.y;
      axis.range = axis.between(axis.offset - by, axis.offset + axis.length - by);
    }
    this.#picture.setRanges(new Map([...ranges.keys()].map((axis) => [axis, axis.range])));
  }

  /** @param {Drag} drag */
  #shadeOver(drag) {
    const { frame, mode } = this.#picture;
    const [x, y] = this.#isUpright ? [[drag.start.x, drag.now.x], null] : this.#boxOf(drag, mode);
    const [left, right] = sorted(x ?? [drag.panel.x.offset, drag.panel.x.offset + drag.panel.x.length]);
    const whole = this.#isUpright
      ? [frame.top, frame.bottom]
      : [drag.panel.y.offset, drag.panel.y.offset + drag.panel.y.length];
    const [top, bottom] = sorted(y ?? whole);
    const [least, most] = [drag.panel.x.offset, drag.panel.x.offset + drag.panel.x.length];
    const [from, to] = [Math.max(least, left), Math.min(most, right)];
    this.#shade.hidden = false;
    Object.assign(this.#shade.style, {
      left: `${from}px`,
      top: `${top}px`,
      width: `${Math.max(0, to - from)}px`,
      height: `${bottom - top}px`,
    });
  }

  /** Ends of what is shaded. @param {Drag} drag @param {string} mode @returns {(number[] | null)[]} */
  #boxOf({ start, now, panel }, mode) {
    if (mode !== "zoom")
      return [
        [start.x, now.x],
        [start.y, now.y],
      ];
    const box = zoomBox(start, now, panel, isEqual(panel, this.#picture.axes));
    return box
      ? [box.x, box.y]
      : [
          [start.x, start.x],
          [start.y, start.y],
        ];
  }

  /** Whether what is chosen is a range across, over all panels. */
  get #isUpright() {
    const { mode, layout } = this.#picture;
    return mode === "select" && layout.selectdirection === "h";
  }

  /** Chosen area, in values. @param {Drag} drag */
  #chosen({ start, now, panel: { x, y } }) {
    const ends = (/** @type {Axis} */ axis, /** @type {number[]} */ pixels) =>
      pixels
        .map((pixel) => Math.max(axis.offset, Math.min(axis.offset + axis.length, pixel)))
        .map((pixel) => axis.toValue(pixel))
        .sort((a, b) => a - b);
    return { x: ends(x, [start.x, now.x]), y: this.#isUpright ? null : ends(y, [start.y, now.y]) };
  }

  /** @param {PointerEvent} event */
  #release(event) {
    const drag = this.#drag;
    if (!drag) return;
    const now = this.#placeOf(event);
    // The last move may still wait for its frame.
    this.#moved = null;
    this.#follow(drag, now);
    this.#drag = null;
    this.#shade.hidden = true;
    const picture = this.#picture;
    if (!drag.isDragged) return picture.click(now.x, now.y);
    if (picture.mode === "pan" || drag.isOfAxis) return picture.dispatch("zoomed");
    if (picture.mode === "select") return picture.dispatch("chosen", this.#chosen(drag));
    this.#zoom(drag);
  }

  /** @param {Drag} drag */
  #zoom({ start, now, panel, ranges }) {
    const box = zoomBox(start, now, panel, isEqual(panel, this.#picture.axes));
    if (!box) return;
    /** @type {Map<Axis, [number, number]>} */
    const changed = new Map();
    for (const axis of ranges.keys()) {
      const ends = axis.isAcross ? box.x : box.y;
      if (ends) changed.set(axis, axis.between(...ends));
    }
    this.#picture.setRanges(changed);
    this.#picture.dispatch("zoomed");
  }

  #cancel() {
    const drag = this.#drag;
    this.#drag = null;
    this.#shade.hidden = true;
    if (drag?.isDragged && !drag.isOfAxis && this.#picture.mode === "select")
      this.#picture.dispatch("chosen", null);
  }

  #leave() {
    this.#moved = null;
    if (!this.#drag) this.#picture.hush();
  }
}

/** @param {number[]} ends */
function sorted(ends) {
  return ends.toSorted((a, b) => a - b);
}
