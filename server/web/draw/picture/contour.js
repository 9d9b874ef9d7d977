// Lines of equal values between the samples of a grid (marching squares), and values between them.

/** Lines about, of a picture of contours. */
export const LINES_ABOUT = 15;

/** @typedef {(number | null)[][]} Grid values by rows upwards and columns */

/** Whether a grid has a value at a place. @param {any} value @returns {value is number} */
function has(value) {
  return value !== null && value !== undefined;
}

/**
 * Pieces of the lines at a level, each from one side of a cell to another; cells with a gap have none.
 * @param {ArrayLike<number>} xs places of the columns
 * @param {ArrayLike<number>} ys places of the rows
 * @param {Grid} z
 * @param {number} level
 * @returns {[x0: number, y0: number, x1: number, y1: number][]}
 */
export function contourLines(xs, ys, z, level) {
  /** @type {[number, number, number, number][]} */
  const pieces = [];
  for (let row = 0; row + 1 < ys.length; row += 1) {
    for (let column = 0; column + 1 < xs.length; column += 1) {
      // Around the cell, from its first corner.
      const corners = [
        { x: xs[column], y: ys[row], value: z[row][column] },
        { x: xs[column + 1], y: ys[row], value: z[row][column + 1] },
        { x: xs[column + 1], y: ys[row + 1], value: z[row + 1][column + 1] },
        { x: xs[column], y: ys[row + 1], value: z[row + 1][column] },
      ];
      if (corners.every(({ value }) => has(value)))
        pieces.push(...cellLines(/** @type {Corner[]} */ (corners), level));
    }
  }
  return pieces;
}

/** @typedef {{x: number, y: number, value: number}} Corner */

/** Pieces of lines within a cell. @param {Corner[]} corners around it @param {number} level @returns {[number, number, number, number][]} */
function cellLines(corners, level) {
  const isAbove = corners.map(({ value }) => value >= level);
  const crossed = [0, 1, 2, 3].filter((side) => isAbove[side] !== isAbove[(side + 1) % 4]);
  const at = (/** @type {number} */ side) => crossing(corners[side], corners[(side + 1) % 4], level);
  const piece = (/** @type {number} */ one, /** @type {number} */ other) =>
    /** @type {[number, number, number, number]} */ ([...at(one), ...at(other)]);
  if (crossed.length === 2) return [piece(crossed[0], crossed[1])];
  if (crossed.length < 4) return [];
  // A saddle: its middle is connected to the corners on the same side of the level.
  const middle = corners.reduce((sum, { value }) => sum + value, 0) / 4;
  return middle >= level === isAbove[0] ? [piece(0, 1), piece(2, 3)] : [piece(3, 0), piece(1, 2)];
}

/** Place of a level between two corners. @param {Corner} one @param {Corner} other @param {number} level @returns {[number, number]} */
function crossing(one, other, level) {
  const part = (level - one.value) / (other.value - one.value);
  return [one.x + part * (other.x - one.x), one.y + part * (other.y - one.y)];
}

/**
 * Value between the four samples of a cell; `null` next to a gap.
 * @param {Grid} z
 * @param {number} row of the cell's first corner
 * @param {number} column
 * @param {number} up part of the way to the next row
 * @param {number} across part of the way to the next column
 */
export function between(z, row, column, up, across) {
  const [below, above] = [z[row], z[row + 1]];
  const [a, b, c, d] = [below[column], below[column + 1], above[column], above[column + 1]];
  if (!has(a) || !has(b) || !has(c) || !has(d)) return null;
  return (a * (1 - across) + b * across) * (1 - up) + (c * (1 - across) + d * across) * up;
}
