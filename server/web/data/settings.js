// Settings of a reader in this browser: theme and units. The link does not hold them.

/** `change` when a setting has changed. */
export const settings = new EventTarget();

/** @returns {"light" | "dark"} */
export function theme() {
  const chosen = read("theme");
  if (chosen === "light" || chosen === "dark") return chosen;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

/** @returns {"si" | "field"} */
export function unitSystem() {
  return read("units") === "field" ? "field" : "si";
}

/** @param {"theme" | "units"} name @param {string} value */
export function choose(name, value) {
  try {
    localStorage.setItem(`drillsweep.${name}`, value);
  } catch {
    // A browser that stores nothing forgets the choice with the page.
    unstored.set(name, value);
  }
  apply();
  settings.dispatchEvent(new Event("change"));
}

/** Shows the page in the theme that holds. */
export function apply() {
  document.documentElement.dataset.theme = theme();
}

/** @type {Map<string, string>} */
const unstored = new Map();

/** @param {string} name */
function read(name) {
  try {
    return unstored.get(name) ?? localStorage.getItem(`drillsweep.${name}`);
  } catch {
    return unstored.get(name) ?? null;
  }
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  apply();
  settings.dispatchEvent(new Event("change"));
});
