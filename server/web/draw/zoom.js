// The part of a picture that the reader has zoomed in to, kept in the link in the service's units: `zoom.map=x:0.01:0.02,y:1200:1500`.

import { unit } from "../data/units.js";
import { keep, rounded, route } from "../ui/router.js";

/** Part of a range by which an end may differ from where it was drawn, and the picture counts as whole. */
const SAME = 1e-6;

/**
 * Zoom of a picture in the link, as ranges of axes in shown units; axes that the layout lacks are left out.
 * @param {string} key of the picture
 * @param {any} layout
 * @returns {Record<string, [number, number]>} by the axes' names in the layout
 */
export function zoomed(key, layout) {
  /** @type {Record<string, [number, number]>} */
  const ranges = {};
  for (const part of (route().query.get(`zoom.${key}`) ?? "").split(",")) {
    const [name, ...texts] = part.split(":");
    const ends = texts.map(Number);
    if (!name || ends.some((end) => !Number.isFinite(end))) continue;
    const axis = `${name[0]}axis${name.slice(1)}`;
    if (!layout[axis] || ends.length !== 2 || ends[0] === ends[1]) continue;
    if (layout[axis].type === "log" && !(Math.min(...ends) > 0)) continue;
    const size = sizeOf(layout[axis]);
    ranges[axis] = [ends[0] / size, ends[1] / size];
  }
  return ranges;
}

/**
 * Keeps in the link how a picture is zoomed.
 * @param {string} key of the picture
 * @param {import("./picture/picture.js").Picture} picture
 */
export function keepZoom(key, { axes }) {
  const zooms = [...axes.values()].filter(({ range, whole }) => !isSame(range, whole));
  const parts = zooms.map(({ name, range, own }) =>
    [name, ...range.map((end) => rounded(end * sizeOf(own)))].join(":"),
  );
  keep({ [`zoom.${key}`]: parts.join(",") });
}

/** @param {number[]} range @param {number[]} whole */
function isSame(range, whole) {
  const width = Math.abs(whole[1] - whole[0]) || 1;
  return range.every((end, order) => Math.abs(end - whole[order]) <= SAME * width);
}

/** Shows a picture as a whole again. @param {string} key */
export function forgetZoom(key) {
  keep({ [`zoom.${key}`]: null });
}

/** Size of an axis' unit in the served unit. @param {any} axis */
function sizeOf(axis) {
  return axis.size ?? (axis.quantity ? unit(axis.quantity).size : 1);
}
