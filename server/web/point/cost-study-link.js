// Cost study of a point's scenario: a sweep of its own, which is found by its tag.

import { get, Problem } from "../data/api.js";
import { h } from "../ui/dom.js";
import { link } from "../ui/router.js";

/** Characters of a point's key in the tag of its study. */
const KEY = 16;

/** Tag of the cost study of a point. @param {{key: string}} point */
export function tagOf(point) {
  return `cost-study-${point.key.slice(0, KEY)}`;
}

/**
 * Request of the cost study of a point: its scenario with a study, marked by the tag.
 * @param {{key: string, scenario: any}} point
 */
export function studyOf(point) {
  const { name, ...scenario } = point.scenario;
  return {
    name: `cost study${name ? ` of ${name}` : ""}`,
    tags: [tagOf(point)],
    scenario: { ...scenario, cost_study: {} },
  };
}

/**
 * Link to the cost study of a point, or to the form with its request; null without an answer of the service.
 * @param {{key: string, scenario: any}} point
 * @param {AbortSignal} signal
 * @returns {Promise<HTMLElement | null>}
 */
export async function studyLink(point, signal) {
  try {
    const { sweeps } = await get("/v1/sweeps", { tag: tagOf(point), limit: 1 }, signal);
    return sweeps.length
      ? h("a", { href: link(["sweeps", sweeps[0].id, "points", "1"]) }, "Cost study of this scenario")
      : h(
          "a",
          { href: link(["new"], { request: JSON.stringify(studyOf(point)) }) },
          "Request a cost study of this scenario",
        );
  } catch (error) {
    if (error instanceof Problem) return null;
    throw error;
  }
}
