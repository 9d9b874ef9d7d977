// The points of the comparison that was opened last in this tab, so that another one can be added to them.

import { link } from "./router.js";

/** Points that are compared, at most. */
export const MOST = preload.MOST;

const KEPT = "drillsweep.comparison";

/** @returns {URLSearchParams} the query of the comparison opened last; empty of none */
export function lastComparison() {
  return new URLSearchParams(sessionStorage.getItem(KEPT) ?? "");
}

/** @param {URLSearchParams} query of a comparison that is shown */
export function rememberComparison(query) {
  sessionStorage.setItem(KEPT, query.toString());
}

export const comparedIn = preload.comparedIn;

/**
 * Links from a point to a comparison: a new one, and the one opened last with this point added.
 * @param {string} key of the point
 * @param {Record<string, string>} [carried] node and window of a new comparison
 * @returns {{text: string, href: string}[]}
 */
export function waysToCompare(key, carried = {}) {
  const last = lastComparison();
  const keys = comparedIn(last);
  const fresh = { text: "Compare", href: link(["compare"], { points: key, view: "profiles", ...carried }) };
  if (!keys.length || (keys.length === 1 && keys[0] === key)) return [fresh];
  const isIn = keys.includes(key);
  if (!isIn && keys.length >= MOST) return [{ ...fresh, text: "New comparison" }];
  const added = link(["compare"], {
    ...Object.fromEntries(last),
    points: (isIn ? keys : [...keys, key]).join(","),
  });
  return [
    { text: isIn ? "Back to the comparison" : `Add to the comparison of ${keys.length}`, href: added },
    { ...fresh, text: "New comparison" },
  ];
}
