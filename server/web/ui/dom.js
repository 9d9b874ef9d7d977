// Elements made from values. Text from the service only ever becomes text: nothing here parses markup.

/** @typedef {Node | string | number | null | undefined | false} Child */

/**
 * An element with attributes and children. A function is a listener (`onclick`), `true` an attribute without a value, and
 * `null`, `undefined` or `false` leaves the attribute or the child out.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, any>} [attributes]
 * @param {(Child | Child[])[]} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (name === "value") /** @type {any} */ (element).value = value;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

/**
 * @param {Element} parent
 * @param {(Child | Child[])[]} children
 */
export function append(parent, children) {
  for (const child of children.flat(Infinity)) {
    if (child === null || child === undefined || child === false) continue;
    parent.append(child instanceof Node ? child : String(child));
  }
}

/** Link or button that the mouse holds down. @type {Element | null} */
let held = null;
/** True if `held` was put into the page after it was pressed, in the place of the pressed one or anew. */
let isReplaced = false;

addEventListener(
  "mousedown",
  ({ button, target }) => {
    held = button === 0 && target instanceof Element ? target.closest("a, button") : null;
    isReplaced = false;
  },
  true,
);
addEventListener(
  "mouseup",
  (event) => {
    const pressed = isReplaced ? held : null;
    held = null;
    isReplaced = false;
    // A browser sends no click if the pressed element has left the page, even if it has come back.
    if (event.target instanceof Node && pressed?.contains(event.target))
      pressed.dispatchEvent(new MouseEvent("click", event));
  },
  true,
);

/**
 * Puts children in the place of those that an element has. If one of these had the keyboard's focus, its equivalent has it after; a link or a
 * button that the mouse holds down is clicked as its equivalent.
 * @param {Element} parent
 * @param {(Child | Child[])[]} children
 */
export function fill(parent, ...children) {
  const [focusedAfter, heldAfter] = [document.activeElement, held].map((element) =>
    follower(parent, element),
  );
  parent.replaceChildren();
  append(parent, children);
  const focused = focusedAfter();
  if (focused instanceof HTMLElement) focused.focus({ preventScroll: true });
  const pressed = heldAfter();
  if (!pressed) return;
  held = pressed;
  isReplaced = true;
}

/**
 * Finds the equivalent of an element after its parent has been filled anew: the element itself, the one of the same tag and name, or else the
 * one at the same place among those of its tag if as many are there.
 * @param {Element} parent before it is filled
 * @param {Element | null} element
 * @returns {() => Element | undefined} undefined if the parent did not contain the element
 */
function follower(parent, element) {
  if (!element || element === parent || !parent.contains(element)) return () => undefined;
  const name = nameOf(element);
  const before = [...parent.querySelectorAll(element.localName)];
  return () => {
    if (parent.contains(element)) return element;
    const after = [...parent.querySelectorAll(element.localName)];
    const sameName = after.filter((other) => nameOf(other) === name);
    const samePlace = after.length === before.length ? after[before.indexOf(element)] : undefined;
    return sameName.length === 1 ? sameName[0] : (samePlace ?? sameName[0]);
  };
}

/**
 * Accessible name of a control.
 * @param {Element} element
 */
function nameOf(element) {
  const labels = /** @type {HTMLInputElement} */ (element).labels;
  return element.getAttribute("aria-label") ?? labels?.[0]?.textContent ?? element.textContent;
}

/**
 * A select with a label before it.
 * @param {string} label
 * @param {[value: string, text: string][]} options
 * @param {string} chosen
 * @param {(value: string) => void} onChange
 */
export function choice(label, options, chosen, onChange) {
  const select = h("select", { "aria-label": label, onchange: () => onChange(select.value) });
  for (const [value, text] of options)
    select.append(h("option", { value, selected: value === chosen }, text));
  select.value = chosen;
  return h("label", { class: "field" }, h("span", {}, label), select);
}

/**
 * Runs `call` once things have been quiet for `delay` milliseconds, and not after `signal` is aborted.
 * @param {() => void} call
 * @param {number} delay
 * @param {AbortSignal} signal of the view that it belongs to
 */
export function debounced(call, delay, signal) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  signal.addEventListener("abort", () => clearTimeout(timer));
  return () => {
    clearTimeout(timer);
    if (!signal.aborted) timer = setTimeout(call, delay);
  };
}

/** Time after which a file has been taken [ms]. */
const TAKEN_MS = 10_000;

/**
 * Saves a file.
 * @param {Blob} blob
 * @param {string} name
 */
export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), TAKEN_MS);
}
