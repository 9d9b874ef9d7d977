// Shapes and notes that a layout adds to the traces: lines and areas at values, and words.

import { LINE } from "./layout.js";
import { dashOf } from "./marks.js";

/** Room about the words of a note in a box, and its distance from its point [pixels]. */
const [PAD, AWAY] = [5, 18];
/** Length of the mark of a colour before a note, and the gap after it [pixels]. */
const [MARK, MARK_GAP] = [22, 6];

/** @typedef {import("./svg-pen.js").Pen} Pen */
/** @typedef {import("./axis.js").Axis} Axis */
/** @typedef {import("./layout.js").Frame} Frame */
/** @typedef {import("./inks.js").Inks} Inks */

/**
 * Place of a value in the picture.
 * @param {string} reference name of an axis, or `paper` for parts of the frame from the left and the bottom
 * @param {any} value
 * @param {Map<string, Axis>} axes
 * @param {Frame} frame
 * @param {"x" | "y"} letter
 */
function pixelOf(reference, value, axes, frame, letter) {
  if (reference !== "paper") return axes.get(reference)?.toPixel(value) ?? NaN;
  return letter === "x"
    ? frame.left + value * (frame.right - frame.left)
    : frame.bottom - value * (frame.bottom - frame.top);
}

/** Draws a line or an area. @param {Pen} pen @param {any} shape @param {Map<string, Axis>} axes @param {Frame} frame */
export function drawShape(pen, shape, axes, frame) {
  const { xref = "x", yref = "y", line = {} } = shape;
  const [x0, x1] = [shape.x0, shape.x1].map((value) => pixelOf(xref, value, axes, frame, "x"));
  const [y0, y1] = [shape.y0, shape.y1].map((value) => pixelOf(yref, value, axes, frame, "y"));
  if (![x0, x1, y0, y1].every(Number.isFinite)) return;
  pen.save();
  pen.beginPath();
  pen.rect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
  pen.clip();
  if (shape.type === "rect") {
    pen.globalAlpha = shape.opacity ?? 1;
    pen.fillStyle = shape.fillcolor;
    pen.fillRect(x0, y0, x1 - x0, y1 - y0);
  } else {
    pen.strokeStyle = line.color;
    pen.lineWidth = line.width;
    pen.setLineDash(dashOf(line.dash, line.width));
    pen.beginPath();
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    pen.stroke();
  }
  pen.restore();
}

/**
 * Writes a note: next to its place, or in a box with a line to it.
 * @param {Pen} pen
 * @param {any} note
 * @param {Map<string, Axis>} axes
 * @param {Frame} frame
 * @param {Inks} inks
 * @param {(text: string) => number} measure
 */
export function drawNote(pen, note, axes, frame, inks, measure) {
  const { xref = "x", yref = "y", font = {} } = note;
  const x = pixelOf(xref, note.x, axes, frame, "x");
  const y = pixelOf(yref, note.y, axes, frame, "y");
  if (!Number.isFinite(x) || !Number.isFinite(y)) return;
  const isOutside = xref !== "paper" && (x < frame.left - 1 || x > frame.right + 1);
  if (isOutside || (yref !== "paper" && (y < frame.top - 1 || y > frame.bottom + 1))) return;
  const lines = String(note.text).split("<br>");
  pen.save();
  if (font.size) pen.font = pen.font.replace(/[\d.]+px/, `${font.size}px`);
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  const width = Math.max(...lines.map(measure)) + (note.mark ? MARK + MARK_GAP : 0);
  const size = { width, height: LINE * lines.length };
  const corner = note.showarrow
    ? boxed(pen, { x, y }, size, frame, inks)
    : beside(note, { x, y }, size, frame);
  if (note.mark) {
    pen.fillStyle = note.mark;
    pen.fillRect(corner.left, corner.top + LINE / 2 - 1.5, MARK, 3);
  }
  pen.fillStyle = font.color ?? inks.text;
  const start = corner.left + (note.mark ? MARK + MARK_GAP : 0);
  lines.forEach((words, order) => pen.fillText(words, start, corner.top + LINE * (order + 0.5)));
  pen.restore();
}

/**
 * Left upper corner of a note next to its place, within the picture.
 * @param {any} note @param {{x: number, y: number}} at @param {{width: number, height: number}} size @param {Frame} frame
 */
function beside({ xanchor = "center", yanchor = "middle", yref }, { x, y }, { width, height }, frame) {
  const left = x - (xanchor === "left" ? 0 : xanchor === "right" ? width : width / 2);
  const top = y - (yanchor === "top" ? 0 : yanchor === "bottom" ? height : height / 2);
  // Names of panels stand above these.
  const highest = yref === "paper" ? 0 : frame.top;
  return { left: Math.max(0, Math.min(frame.width - width, left)), top: Math.max(highest, top) };
}

/**
 * Draws the box of a note above its point, or below where there is no room, and the line between them.
 * @param {Pen} pen @param {{x: number, y: number}} at @param {{width: number, height: number}} size @param {Frame} frame @param {Inks} inks
 * @returns {{left: number, top: number}} corner of the words
 */
function boxed(pen, { x, y }, { width, height }, frame, inks) {
  const left = Math.max(PAD, Math.min(frame.width - width - PAD, x - width / 2));
  const isAbove = y - AWAY - height - 2 * PAD > 0;
  const top = isAbove ? y - AWAY - PAD - height : y + AWAY + PAD;
  pen.strokeStyle = inks.text;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x, isAbove ? top + height + PAD : top - PAD);
  pen.stroke();
  pen.beginPath();
  pen.arc(x, y, 4, 0, 2 * Math.PI);
  pen.fillStyle = inks.text;
  pen.fill();
  pen.fillStyle = inks.panel;
  pen.strokeStyle = inks.soft;
  pen.lineWidth = 1;
  pen.beginPath();
  pen.rect(left - PAD, top - PAD, width + 2 * PAD, height + 2 * PAD);
  pen.fill();
  pen.stroke();
  return { left, top };
}
