// Problems of a request, shown at the fields that their JSON Pointers name.

import { h } from "../ui/dom.js";

/** @typedef {{pointer?: string, detail: string}} Found */

/**
 * A labelled field at which problems are shown.
 * @param {string} text
 * @param {HTMLElement} element
 * @param {string} pointer of the request's member
 */
export function field(text, element, pointer) {
  return h("label", { class: "field", "data-pointer": pointer }, h("span", {}, text), element);
}

/**
 * Shows problems at their fields, in place of earlier ones.
 * @param {HTMLElement} form
 * @param {Found[]} problems
 * @returns {string} problems that no field has
 */
export function mark(form, problems) {
  for (const old of form.querySelectorAll(".wrong[data-problem]")) old.remove();
  for (const old of form.querySelectorAll("[aria-invalid]")) old.removeAttribute("aria-invalid");
  const places = /** @type {HTMLElement[]} */ ([...form.querySelectorAll("[data-pointer]")]);
  const rest = [];
  for (const { pointer = "", detail } of problems) {
    const place = placeOf(pointer, places);
    if (!place) {
      rest.push(pointer ? `${pointer}: ${detail}` : detail);
      continue;
    }
    const own = place.dataset.pointer ?? "";
    const folded = place.closest("details");
    if (folded) folded.open = true;
    place.querySelector("input, select, textarea")?.setAttribute("aria-invalid", "true");
    place.append(
      h(
        "span",
        { class: "wrong", "data-problem": true },
        pointer === own ? detail : `${pointer.slice(own.length + 1)}: ${detail}`,
      ),
    );
  }
  return rest.join(" ");
}

/** The place whose pointer is the longest beginning of another. @param {string} pointer @param {HTMLElement[]} places */
function placeOf(pointer, places) {
  const fitting = places.filter(
    ({ dataset }) => pointer === dataset.pointer || pointer.startsWith(`${dataset.pointer}/`),
  );
  return fitting.sort((a, b) => (b.dataset.pointer?.length ?? 0) - (a.dataset.pointer?.length ?? 0))[0];
}
