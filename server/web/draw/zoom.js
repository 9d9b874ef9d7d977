// The part of a picture that the reader has zoomed in to, kept in the link in the service's units: `zoom.map=x:0.01:0.02,y:1200:1500`,
// or `zoom.well=camera:...` of a picture in space: its eye, its centre and, where its horizon is not level, what is upwards.

import { unit } from "../data/units.js";
import { keep, rounded, route } from "../ui/router.js";

/** Part of a range by which an end may differ from where it was drawn, and the picture counts as whole. */
const SAME = 1e-6;
/** By how much a horizon may be off the level [rad], and counts as level. */
const LEVEL = 1e-5;
/** Upward direction with a level horizon. */
const UPRIGHT = [0, 0, 1];

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
    if (name === "camera" && (ends.length === 6 || ends.length === 9) && layout.scene) {
      const [eye, center, up] = [0, 3, 6].map((first) => ({
        x: ends[first],
        y: ends[first + 1],
        z: ends[first + 2],
      }));
      Object.assign(changes, { "scene.camera.eye": eye, "scene.camera.center": center });
      // A picture that is turned about its vertical would put that upright again.
      if (ends.length === 9) Object.assign(changes, { "scene.camera.up": up, "scene.dragmode": "orbit" });
    }
    const axis = `${name[0]}axis${name.slice(1)}`;
    if (!layout[axis] || ends.length !== 2 || ends[0] === ends[1]) continue;
    const range = ends.map((end) => end / sizeOf(layout[axis]));
    if (layout[axis].type !== "log") changes[`${axis}.range`] = range;
    else if (Math.min(...range) > 0) changes[`${axis}.range`] = range.map(Math.log10);
  }
  return changes;
}

/**
 * Ranges and camera of a picture before it is zoomed.
 * @param {any} place that plotly draws in
 * @param {any} layout
 * @returns {Record<string, any>}
 */
export function wholeOf(place, layout) {
  const full = place._fullLayout;
  const axes = Object.keys(layout).filter((name) => /^[xy]axis\d*$/.test(name) && full[name]?.range);
  return {
    ...Object.fromEntries(axes.map((name) => [name, [...full[name].range]])),
    ...(full.scene?._scene ? { camera: cameraOf(place) } : {}),
  };
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
    const served =
      name === "camera"
        ? now.slice(6).join() === UPRIGHT.join()
          ? now.slice(0, 6)
          : now
        : now.map(
            (/** @type {number} */ end) =>
              sizeOf(layout[name]) * (layout[name].type === "log" ? 10 ** end : end),
          );
    return [[name.replace("axis", ""), ...served.map(rounded)].join(":")];
  });
  keep({ [`zoom.${key}`]: parts.join(",") });
}

/** Shows a picture as a whole again. @param {string} key */
export function forgetZoom(key) {
  keep({ [`zoom.${key}`]: null });
}

/**
 * Waits until a picture in space has come to rest: after the mouse has let go it turns on for a moment, of whose end plotly does not tell.
 * @param {any} place that plotly draws in
 * @returns {Promise<void>}
 */
export async function rested(place) {
  const view = viewOf(place);
  const released = view?.lastT();
  // The next state of the view, which has no speed any more, is the last.
  while (view && place.isConnected && viewOf(place) === view && view.lastT() <= released)
    await new Promise(requestAnimationFrame);
}

/** View of a picture in space, as plotly moves it; undefined for a flat one. @param {any} place that plotly draws in */
function viewOf(place) {
  return place._fullLayout.scene?._scene?.camera?.view;
}

/** @param {any} place that plotly draws in */
function cameraOf(place) {
  // The layouts have the camera as it was when the mouse let go, or before that.
  const { eye, center, up } = place._fullLayout.scene._scene.getCamera();
  const [across, along] = [eye.x - center.x, eye.y - center.y];
  // Turned about any axis, a picture has for up what is at right angles to the view, even where its horizon is level.
  const isLevel = up.z > 0 && Math.abs(up.x * along - up.y * across) <= LEVEL * Math.hypot(across, along);
  return [eye.x, eye.y, eye.z, center.x, center.y, center.z, ...(isLevel ? UPRIGHT : [up.x, up.y, up.z])];
}

/** Size of an axis' unit in the served unit. @param {any} axis */
function sizeOf(axis) {
  return axis.size ?? (axis.quantity ? unit(axis.quantity).size : 1);
}
