// Progress of a sweep, and moments in time, as elements.

import { isFinal } from "../data/api.js";
import { hasNotBegun } from "../data/queue.js";
import { duration, moment, number } from "../data/units.js";
import { h } from "./dom.js";

/** @typedef {import("../data/pace.js").Pace} Pace */

/**
 * State, bar and counts of a sweep.
 * @param {any} sweep
 * @param {Pace} pace
 * @param {number} [before] sweeps before one that has not begun, if that is known
 */
export function progressPart(sweep, pace, before = 0) {
  const { counts } = sweep;
  const left = pace.left();
  const words = [`${number(counts.succeeded)} of ${number(counts.total)} succeeded`];
  if (counts.running) words.push(`${number(counts.running)} running`);
  const isMarked = sweep.state === "completed" && counts.failed > 0;
  if (counts.failed && !isMarked) words.push(`${number(counts.failed)} failed`);
  if (counts.cancelled) words.push(`${number(counts.cancelled)} cancelled`);
  const isHeld = hasNotBegun(sweep);
  if (isHeld && before) words.push(`behind ${before} ${before === 1 ? "sweep" : "sweeps"}`);
  if (sweep.state === "running")
    words.push(left === null ? "time left unknown" : `about ${duration(left)} left`);
  const percent = Math.floor(100 * sweep.progress);
  const [shown, text] = isMarked
    ? [counts.failed === counts.total ? "failed" : "partial", `${sweep.state}, ${counts.failed} failed`]
    : isHeld
      ? ["queued", "waiting"]
      : [sweep.state, sweep.state];
  return h(
    "div",
    {},
    h("span", { class: `state ${shown}` }, text),
    !isFinal(sweep) && [
      h("span", { class: "soft small" }, ` ${percent} %`),
      h("progress", { value: sweep.progress, max: 1, "aria-label": `Progress: ${percent} %` }),
    ],
    h("div", { class: "small soft" }, words.join(", ")),
  );
}

/** @param {string} time RFC 3339 */
export function when(time) {
  return h("time", { datetime: time, title: moment(time, "second") }, moment(time));
}
