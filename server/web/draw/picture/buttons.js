// The bar of a picture's buttons: how the mouse works on it, its axes, and its files.

import { h } from "../../ui/dom.js";

const SPACE = "http://www.w3.org/2000/svg";

/** Icons as lines in a square of 24. @type {Record<string, string>} */
const ICONS = {
  zoom: "M10 4a6 6 0 1 0 0 12a6 6 0 1 0 0-12M14.500 14.500L20 20",
  pan: "M12 3v18M3 12h18M9 6l3-3 3 3M9 18l3 3 3-3M6 9l-3 3 3 3M18 9l3 3-3 3",
  select: "M4 8V4h4M16 4h4v4M20 16v4h-4M8 20H4v-4M12 8v8M8 12h8",
  in: "M5 12h14M12 5v14",
  out: "M5 12h14",
  reset: "M4 11l8-7 8 7M6.500 9.500V20h11V9.500",
};

/** Keys that move the focus along the bar. @type {Record<string, number>} */
const STEPS = { ArrowLeft: -1, ArrowRight: 1 };

/** Way in which a dragged mouse works. @typedef {"zoom" | "pan" | "select"} Mode */
/** @typedef {{mode: (mode: Mode) => void, zoom: (factor: number) => void, reset: () => void, save: (format: "png" | "svg") => void}} Actions */

/** Bar of buttons; arrow keys move within it, so that it takes one stop of the Tab key. */
export class ButtonBar {
  /** @type {Record<string, HTMLButtonElement>} */
  #modes;

  /** @param {Actions} actions */
  constructor(actions) {
    this.#modes = {
      zoom: button("Zoom by dragging", ICONS.zoom, () => actions.mode("zoom")),
      pan: button("Move by dragging", ICONS.pan, () => actions.mode("pan")),
      select: button("Choose by dragging", ICONS.select, () => actions.mode("select")),
    };
    const buttons = [
      ...Object.values(this.#modes),
      button("Zoom in", ICONS.in, () => actions.zoom(0.5)),
      button("Zoom out", ICONS.out, () => actions.zoom(2)),
      button("Reset axes", ICONS.reset, () => actions.reset()),
      button("Save as PNG", "PNG", () => actions.save("png")),
      button("Save as SVG", "SVG", () => actions.save("svg")),
    ];
    for (const one of buttons.slice(1)) one.tabIndex = -1;
    this.element = h(
      "div",
      { class: "picture-bar", role: "toolbar", "aria-label": "Picture", onkeydown: this.#move },
      buttons,
    );
  }

  /** @param {Mode} mode @param {boolean} canSelect whether something is chosen by dragging */
  show(mode, canSelect) {
    this.#modes.select.hidden = !canSelect;
    for (const [name, one] of Object.entries(this.#modes))
      one.setAttribute("aria-pressed", String(name === mode));
  }

  /**
   * Puts the bar at its place: where nothing hovers it is always seen, and stands below the legend; else below the picture.
   * @param {number} top height of the legend [pixels]
   * @returns {number} height that it takes there
   */
  place(top) {
    const isAlways = matchMedia("(hover: none)").matches;
    this.element.style.top = isAlways ? `${top}px` : "";
    return isAlways ? this.element.offsetHeight : 0;
  }

  #move = (/** @type {KeyboardEvent} */ event) => {
    const step = STEPS[event.key];
    if (!step) return;
    event.preventDefault();
    const shown = [...this.element.querySelectorAll("button")].filter((one) => !one.hidden);
    const now = shown.findIndex((one) => one === document.activeElement);
    const next = shown[(now + step + shown.length) % shown.length];
    for (const one of shown) one.tabIndex = one === next ? 0 : -1;
    next.focus();
  };
}

/** @param {string} name @param {string} sign path of an icon, or a short word @param {() => void} onclick */
function button(name, sign, onclick) {
  const isWord = /^[A-Z]{3}$/.test(sign);
  return h(
    "button",
    { type: "button", "aria-label": name, title: name, onclick },
    isWord ? sign : iconOf(sign),
  );
}

/** @param {string} path */
function iconOf(path) {
  const icon = document.createElementNS(SPACE, "svg");
  const line = document.createElementNS(SPACE, "path");
  for (const [name, value] of Object.entries({ viewBox: "0 0 24 24", "aria-hidden": "true" }))
    icon.setAttribute(name, value);
  line.setAttribute("d", path);
  icon.append(line);
  return icon;
}
