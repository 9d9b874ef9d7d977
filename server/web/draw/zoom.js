// The part of a picture that the reader has zoomed in to, kept in the link in the service's units: `zoom.map=x:0.01:0.02,y:1200:1500`.

import { unit } from "../data/units.js";
import { keep, rounded, route } from "../ui/router.js";

/** Part of a range by which an end may differ from where it was drawn, and the picture counts as whole. */
const SAME = 1e-6;

/**
 * Zoom of a picture in the link, as changes of its layout; axes that the layout lacks are left out.
 * @param {string} key of the picture
 * @param {any} layout
 * @returns {Record<string, any>}
 */
export function zoomed(key, layout) {
  /** @type {Record<string, any>} */
  const changes = {};
  for (const part of (route().query.get(`zoom.${key}`) ?? "").split(",")) {
    const [name, ...texts] = part.split(":");
    const ends = texts.map(Number);
    if (!name || ends.some((end) => !Number.isFinite(end))) continue;
    const axis = `${name[0]}axis${name.slice(1)}`;
    if (!layout[axis] || ends.length !== 2 || ends[0] === ends[1]) continue;
    const range = ends.map((end) => end / sizeOf(layout[axis]));
    if (layout[axis].type !== "log") changes[`${axis}.range`] = range;
    else if (Math.min(...range) > 0) changes[`${axis}.range`] = range.map(Math.log10);
  }
  return changes;
}

/**
 * Ranges of a picture before it is zoomed.
 * @param {any} place that plotly draws in
 * @param {any} layout
 * @returns {Record<string, any>}
 */
export function wholeOf(place, layout) {
  const full = place._fullLayout;
  const axes = Object.keys(layout).filter((name) => /^[xy]axis\d*$/.test(name) && full[name]?.range);
  return Object.fromEntries(axes.map((name) => [name, [...full[name].range]]));
}

/**
 * Keeps in the link how a picture is zoomed.
 * @param {string} key of the picture
 * @param {any} place that plotly draws in
 * @param {any} layout
 * @param {Record<string, any>} whole
 */
export function keepZoom(key, place, layout, whole) {
  const parts = Object.entries(wholeOf(place, layout)).flatMap(([name, now]) => {
    const drawn = whole[name];
    const width = Math.abs(drawn[1] - drawn[0]) || 1;
    if (
      now.every(
        (/** @type {number} */ end, /** @type {number} */ index) =>
          Math.abs(end - drawn[index]) <= SAME * width,
      )
    )
      return [];
    const served = now.map(
      (/** @type {number} */ end) => sizeOf(layout[name]) * (layout[name].type === "log" ? 10 ** end : end),
    );
    return [[name.replace("axis", ""), ...served.map(rounded)].join(":")];
  });
  keep({ [`zoom.${key}`]: parts.join(",") });
}

/** Shows a picture as a whole again. @param {string} key */
export function forgetZoom(key) {
  keep({ [`zoom.${key}`]: null });
}

/** Size of an axis' unit in the served unit. @param {any} axis */
function sizeOf(axis) {
  return axis.size ?? (axis.quantity ? unit(axis.quantity).size : 1);
}
