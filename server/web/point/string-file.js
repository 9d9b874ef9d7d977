// Strings in their holes as a file: all that is shown, one string below the other, with the scale, and the time of strings in motion.

import { colourOf } from "../draw/picture/colours.js";
import { inks } from "../draw/picture/inks.js";
import { saveDrawing } from "../draw/picture/save.js";

/** Height of the scale below the picture, and cells of its colours. */
const [SCALE_HEIGHT, CELLS] = [44, 120];

/** @typedef {{scene: import("../draw/string-scene.js").StringScene, heading: string}} Actor */
/** Time, empty at rest, name of the scale, and the values at its ends. @typedef {{time: string, text: string, least: string, largest: string}} Words */

/**
 * Saves strings as a file.
 * @param {string} name of the file, without its ending
 * @param {"png" | "svg"} format
 * @param {Actor[]} actors
 * @param {Words | null} words none of strings whose colours stand for no values
 */
export function saveStrings(name, format, actors, words) {
  const width = Math.max(...actors.map(({ scene }) => scene.element.clientWidth));
  const height = actors.reduce(
    (sum, { scene }) => sum + scene.element.clientHeight,
    words ? SCALE_HEIGHT : 0,
  );
  saveDrawing(name, format, { width, height }, (pen) => drawFile(pen, actors, words, width, height));
}

/** @param {import("../draw/picture/svg-pen.js").Pen} pen @param {Actor[]} actors @param {Words | null} words @param {number} width @param {number} height */
function drawFile(pen, actors, words, width, height) {
  const { panel, text } = inks();
  pen.fillStyle = panel;
  pen.fillRect(0, 0, width, height);
  for (const { scene, heading } of actors) {
    scene.drawWith(pen);
    pen.fillStyle = text;
    pen.font = "14px system-ui, sans-serif";
    pen.textAlign = "left";
    pen.fillText(heading, 12, 20);
    pen.translate(0, scene.element.clientHeight);
  }
  if (words) drawScale(pen, words, width);
}

/** @param {import("../draw/picture/svg-pen.js").Pen} pen @param {Words} words @param {number} width */
function drawScale(pen, words, width) {
  pen.font = "13px system-ui, sans-serif";
  pen.textBaseline = "middle";
  pen.fillStyle = inks().text;
  pen.textAlign = "left";
  const middle = SCALE_HEIGHT / 2;
  pen.fillText(words.time ? `${words.time}   ${words.text}` : words.text, 12, middle);
  const [left, right] = [width * 0.45, width * 0.85];
  pen.textAlign = "right";
  pen.fillText(words.least, left - 8, middle);
  pen.textAlign = "left";
  pen.fillText(words.largest, right + 8, middle);
  for (let cell = 0; cell < CELLS; cell += 1) {
    pen.fillStyle = colourOf(cell, [0, CELLS - 1]);
    pen.fillRect(left + ((right - left) * cell) / CELLS, middle - 6, (right - left) / CELLS + 0.5, 12);
  }
}
