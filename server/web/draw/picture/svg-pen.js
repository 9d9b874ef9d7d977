// Pens that draw lines, areas, words and pictures: a canvas, or an SVG file by the same calls.

/**
 * Members that both pens have.
 * @typedef {Pick<CanvasRenderingContext2D, "lineWidth" | "strokeStyle" | "fillStyle" | "globalAlpha" | "lineCap" | "lineJoin" | "font" | "textAlign" | "textBaseline" | "beginPath" | "moveTo" | "lineTo" | "closePath" | "arc" | "rect" | "clip" | "stroke" | "fill" | "fillRect" | "fillText" | "setLineDash" | "translate" | "rotate" | "save" | "restore"> & {drawImage: (image: HTMLCanvasElement, x: number, y: number, width: number, height: number) => void}} Pen
 */

const SPACE = "http://www.w3.org/2000/svg";
/** Digits after the point of a place in the picture. */
const DIGITS = 2;
/** @type {Record<string, string>} */
const ANCHORS = { left: "start", start: "start", center: "middle", right: "end", end: "end" };
/** @type {Record<string, string>} */
const BASELINES = { middle: "central", top: "text-before-edge", bottom: "text-after-edge" };
/** Settings that are saved and restored. */
const SETTINGS = /** @type {const} */ ([
  "strokeStyle",
  "fillStyle",
  "lineWidth",
  "globalAlpha",
  "font",
  "lineCap",
  "lineJoin",
  "textAlign",
  "textBaseline",
]);

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
  /** @type {CanvasLineJoin} */
  lineJoin = "miter";
  /** @type {CanvasTextAlign} */
  textAlign = "left";
  /** @type {CanvasTextBaseline} */
  textBaseline = "alphabetic";
  #root = document.createElementNS(SPACE, "svg");
  /** Element that what is drawn is added to. @type {Element} */
  #group = this.#root;
  #origin = [0, 0];
  #dashes = "";
  #path = "";
  /** @type {{group: Element, origin: number[], dashes: string, settings: any[]}[]} */
  #saved = [];
  #clips = 0;

  /** @param {number} width @param {number} height */
  constructor(width, height) {
    for (const [name, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` }))
      this.#root.setAttribute(name, String(value));
  }

  save() {
    const settings = SETTINGS.map((name) => this[name]);
    this.#saved.push({ group: this.#group, origin: this.#origin, dashes: this.#dashes, settings });
  }

  restore() {
    const last = this.#saved.pop();
    if (!last) return;
    [this.#group, this.#origin, this.#dashes] = [last.group, last.origin, last.dashes];
    SETTINGS.forEach((name, order) => Object.assign(this, { [name]: last.settings[order] }));
  }

  /** @param {number} x @param {number} y */
  translate(x, y) {
    this.#origin = [this.#origin[0] + x, this.#origin[1] + y];
  }

  /** @param {number} angle [rad] */
  rotate(angle) {
    const degrees = (angle * 180) / Math.PI;
    this.#group = this.#add("g", { transform: `translate(${this.#origin.join(" ")}) rotate(${degrees})` });
    this.#origin = [0, 0];
  }

  /** Leaves out what lies outside of the path. */
  clip() {
    this.#clips += 1;
    const id = `clip${this.#clips}`;
    const clip = this.#add("clipPath", { id });
    this.#group = clip;
    this.#add("path", { d: this.#path });
    this.#group = /** @type {Element} */ (clip.parentNode);
    this.#group = this.#add("g", { "clip-path": `url(#${id})` });
  }

  /** @param {Iterable<number>} lengths */
  setLineDash(lengths) {
    this.#dashes = [...lengths].join(" ");
  }

  beginPath() {
    this.#path = "";
  }

  closePath() {
    this.#path += "Z";
  }

  /** @param {number} x @param {number} y */
  moveTo(x, y) {
    this.#path += `M${this.#place(x, y)}`;
  }

  /** @param {number} x @param {number} y */
  lineTo(x, y) {
    this.#path += `${this.#path ? "L" : "M"}${this.#place(x, y)}`;
  }

  /** @param {number} x @param {number} y @param {number} width @param {number} height */
  rect(x, y, width, height) {
    this.#path += `M${this.#place(x, y)}h${width}v${height}h${-width}Z`;
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
      x: round(Math.min(x, x + width) + this.#origin[0]),
      y: round(Math.min(y, y + height) + this.#origin[1]),
      width: round(Math.abs(width)),
      height: round(Math.abs(height)),
      fill: this.fillStyle,
      opacity: this.globalAlpha === 1 ? "" : this.globalAlpha,
    });
  }

  /** @param {string} text @param {number} x @param {number} y */
  fillText(text, x, y) {
    const size = /([\d.]+)px (.+)$/.exec(this.font);
    this.#add("text", {
      x: round(x + this.#origin[0]),
      y: round(y + this.#origin[1]),
      fill: this.fillStyle,
      "font-size": size?.[1] ?? 12,
      "font-family": size?.[2] ?? "sans-serif",
      "text-anchor": ANCHORS[this.textAlign],
      "dominant-baseline": BASELINES[this.textBaseline] ?? "alphabetic",
    }).textContent = text;
  }

  /** @param {HTMLCanvasElement} image @param {number} x @param {number} y @param {number} width @param {number} height */
  drawImage(image, x, y, width, height) {
    const place = { x: round(x + this.#origin[0]), y: round(y + this.#origin[1]), width, height };
    this.#add("image", { ...place, href: image.toDataURL(), preserveAspectRatio: "none" });
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
    this.#group.append(element);
    return element;
  }
}

/** @param {number} value */
function round(value) {
  return Number(value.toFixed(DIGITS));
}
