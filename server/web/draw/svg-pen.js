// Pens that draw lines, dots and words: a canvas, or an SVG file by the same calls.

/**
 * Members that both pens have.
 * @typedef {Pick<CanvasRenderingContext2D, "lineWidth" | "strokeStyle" | "fillStyle" | "globalAlpha" | "lineCap" | "font" | "textAlign" | "textBaseline" | "beginPath" | "moveTo" | "lineTo" | "arc" | "stroke" | "fill" | "fillRect" | "fillText" | "setLineDash" | "translate">} Pen
 */

const SPACE = "http://www.w3.org/2000/svg";
/** Digits after the point of a place in the picture. */
const DIGITS = 2;
/** @type {Record<string, string>} */
const ANCHORS = { left: "start", start: "start", center: "middle", right: "end", end: "end" };

/** A pen whose strokes are elements of an SVG. */
export class SvgPen {
  /** @type {string | CanvasGradient | CanvasPattern} */
  strokeStyle = "#000";
  /** @type {string | CanvasGradient | CanvasPattern} */
  fillStyle = "#000";
  lineWidth = 1;
  globalAlpha = 1;
  font = "12px sans-serif";
  /** @type {CanvasLineCap} */
  lineCap = "butt";
  /** @type {CanvasTextAlign} */
  textAlign = "left";
  /** @type {CanvasTextBaseline} */
  textBaseline = "alphabetic";
  #root = document.createElementNS(SPACE, "svg");
  #origin = [0, 0];
  #dashes = "";
  #path = "";

  /** @param {number} width @param {number} height */
  constructor(width, height) {
    for (const [name, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` }))
      this.#root.setAttribute(name, String(value));
  }

  /** @param {number} x @param {number} y */
  translate(x, y) {
    this.#origin = [this.#origin[0] + x, this.#origin[1] + y];
  }

  /** @param {Iterable<number>} lengths */
  setLineDash(lengths) {
    this.#dashes = [...lengths].join(" ");
  }

  beginPath() {
    this.#path = "";
  }

  /** @param {number} x @param {number} y */
  moveTo(x, y) {
    this.#path += `M${this.#place(x, y)}`;
  }

  /** @param {number} x @param {number} y */
  lineTo(x, y) {
    this.#path += `L${this.#place(x, y)}`;
  }

  /** A whole circle, whatever the angles. @param {number} x @param {number} y @param {number} radius */
  arc(x, y, radius) {
    this.#path += `M${this.#place(x - radius, y)}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0`;
  }

  stroke() {
    this.#add("path", {
      d: this.#path,
      fill: "none",
      stroke: this.strokeStyle,
      "stroke-width": this.lineWidth,
      "stroke-linecap": this.lineCap,
      "stroke-linejoin": "round",
      "stroke-dasharray": this.#dashes,
      opacity: this.globalAlpha,
    });
  }

  fill() {
    this.#add("path", { d: this.#path, fill: this.fillStyle, opacity: this.globalAlpha });
  }

  /** @param {number} x @param {number} y @param {number} width @param {number} height */
  fillRect(x, y, width, height) {
    this.#add("rect", {
      x: x + this.#origin[0],
      y: y + this.#origin[1],
      width,
      height,
      fill: this.fillStyle,
    });
  }

  /** @param {string} text @param {number} x @param {number} y */
  fillText(text, x, y) {
    const size = /([\d.]+)px (.+)$/.exec(this.font);
    const middle = this.textBaseline === "middle" ? "central" : "alphabetic";
    this.#add("text", {
      x: x + this.#origin[0],
      y: y + this.#origin[1],
      fill: this.fillStyle,
      "font-size": size?.[1] ?? 12,
      "font-family": size?.[2] ?? "sans-serif",
      "text-anchor": ANCHORS[this.textAlign],
      "dominant-baseline": middle,
    }).textContent = text;
  }

  /** The file. */
  toString() {
    return new XMLSerializer().serializeToString(this.#root);
  }

  /** @param {number} x @param {number} y */
  #place(x, y) {
    return `${(x + this.#origin[0]).toFixed(DIGITS)} ${(y + this.#origin[1]).toFixed(DIGITS)}`;
  }

  /** @param {string} tag @param {Record<string, any>} attributes those that are empty are left out */
  #add(tag, attributes) {
    const element = document.createElementNS(SPACE, tag);
    for (const [name, value] of Object.entries(attributes))
      if (value !== "") element.setAttribute(name, String(value));
    this.#root.append(element);
    return element;
  }
}
