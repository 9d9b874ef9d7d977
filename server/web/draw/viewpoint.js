// Viewpoints of a string in space: vertical section, plan and free view, and the projection of each.

/** @typedef {import("../data/well-frames.js").Vector} Vector */

/**
 * Angles [rad], size, and shift as a part of the picture's width and height.
 * @typedef {{azimuth: number, elevation: number, size: number, right: number, down: number}} View
 */

const CENTRED = { size: 1, right: 0, down: 0 };
/** Digits of a view in the link. */
const DIGITS = 4;

/**
 * Vertical section: the plane through both ends of a well, seen from its side, with depth downwards.
 * @param {Vector[]} axis of the well
 * @returns {View}
 */
export function sectionView(axis) {
  const [first, last] = [axis[0], axis[axis.length - 1]];
  const [north, east] = [last[0] - first[0], last[1] - first[1]];
  // A vertical well has no plane; east is to the right then.
  return { azimuth: north || east ? Math.atan2(-north, east) : 0, elevation: 0, ...CENTRED };
}

/** Plan: seen from above, north upwards. @returns {View} */
export function planView() {
  return { azimuth: 0, elevation: Math.PI / 2, ...CENTRED };
}

/** View from a side and from above. @returns {View} */
export function freeView() {
  return { azimuth: 0.7, elevation: 0.35, ...CENTRED };
}

/**
 * @param {string} text of the link, as `sayView` makes it
 * @param {View} usual
 * @returns {View}
 */
export function readView(text, usual) {
  const numbers = text.split(":").map(Number);
  if (!text || numbers.length !== 5 || !numbers.every(Number.isFinite) || !(numbers[2] > 0))
    return { ...usual };
  const [azimuth, elevation, size, right, down] = numbers;
  return { azimuth, elevation: Math.max(-Math.PI / 2, Math.min(Math.PI / 2, elevation)), size, right, down };
}

/**
 * A view to the digits of the link, so that a link shows the same picture.
 * @param {View} view
 * @returns {View}
 */
export function roundedView({ azimuth, elevation, size, right, down }) {
  const round = (/** @type {number} */ value) => Number(value.toFixed(DIGITS));
  return {
    azimuth: round(azimuth),
    elevation: round(elevation),
    size: round(size),
    right: round(right),
    down: round(down),
  };
}

/**
 * A view as the link holds it; empty of the usual one.
 * @param {View} view
 * @param {View} usual
 */
export function sayView(view, usual) {
  const text = (/** @type {View} */ one) => Object.values(roundedView(one)).join(":");
  return text(view) === text(usual) ? "" : text(view);
}

/**
 * Directions of a view: to the right and downwards in the picture, without perspective.
 * @param {View} view
 * @returns {(place: Vector) => [number, number]}
 */
export function seenFrom({ azimuth, elevation }) {
  const [cosine, sine] = [Math.cos(azimuth), Math.sin(azimuth)];
  const [up, flat] = [Math.cos(elevation), Math.sin(elevation)];
  return ([north, east, down]) => {
    const [right, away] = [east * cosine - north * sine, east * sine + north * cosine];
    return [right, down * up - away * flat];
  };
}
