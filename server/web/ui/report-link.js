// Link to the printable report of a sweep or a point.

import { address } from "../data/api.js";
import { unitSystem } from "../data/settings.js";
import { h } from "./dom.js";
import { route } from "./router.js";

/**
 * A link that opens the report in the reader's units, by the limits that the page's own link has at that time.
 * @param {string} path of the sweep or point
 * @returns {HTMLElement}
 */
export function reportLink(path) {
  const current = () =>
    address(`${path}/report`, { units: unitSystem(), limits: route().query.get("limits") });
  const anchor = h(
    "a",
    {
      class: "button",
      href: current(),
      target: "_blank",
      rel: "noopener",
      onclick: () => anchor.setAttribute("href", current()),
    },
    "Report",
  );
  return anchor;
}
