// Modules ahead of the imports that name them: a browser would find them one after the other, each when the one before has come.

/** What each module imports, as the server says in the page. @type {Record<string, string[]>} */
const IMPORTS = JSON.parse(document.getElementById("imports")?.textContent || "{}");
/** @type {Set<string>} */
const asked = new Set();

/** Has a module come with all that it imports. @param {string} name its file */
export function preload(name) {
  if (asked.has(name)) return;
  asked.add(name);
  const link = document.createElement("link");
  Object.assign(link, { rel: "modulepreload", href: new URL(name, import.meta.url).href });
  document.head.append(link);
  IMPORTS[name]?.forEach(preload);
}
