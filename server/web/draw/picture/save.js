// Files of pictures: PNG from a canvas, and SVG by the same drawing.

import { download } from "../../ui/dom.js";
import { FONT } from "./inks.js";
import { SvgPen } from "./svg-pen.js";

/** Pixels of a PNG for each on the screen. */
const SHARP = 2;

/** @typedef {import("./svg-pen.js").Pen} Pen */
/** @typedef {"png" | "svg"} Format */

/**
 * Saves a drawing.
 * @param {string} name of the file, without its ending
 * @param {Format} format
 * @param {{width: number, height: number}} size [pixels]
 * @param {(pen: Pen) => void} draw
 */
export function saveDrawing(name, format, { width, height }, draw) {
  if (format === "svg") return saveSvg(name, svgOf({ width, height }, draw));
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: SHARP * width, height: SHARP * height });
  const pen = canvas.getContext("2d");
  if (!pen) return undefined;
  pen.scale(SHARP, SHARP);
  pen.font = `12px ${FONT}`;
  draw(pen);
  return savePng(name, canvas);
}

/** Text of the SVG of a drawing. @param {{width: number, height: number}} size @param {(pen: Pen) => void} draw */
export function svgOf({ width, height }, draw) {
  const pen = new SvgPen(width, height);
  pen.font = `12px ${FONT}`;
  draw(pen);
  return String(pen);
}

/** @param {string} name @param {string} text */
export function saveSvg(name, text) {
  download(new Blob([text], { type: "image/svg+xml" }), `${name}.svg`);
}

/** @param {string} name @param {HTMLCanvasElement} canvas */
export function savePng(name, canvas) {
  canvas.toBlob((blob) => blob && download(blob, `${name}.png`), "image/png");
}

/** Saves an SVG as a PNG. @param {string} name @param {string} text @param {{width: number, height: number}} size */
export async function saveSvgAsPng(name, text, { width, height }) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: SHARP * width, height: SHARP * height });
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  savePng(name, canvas);
}
