// Short messages about what was done or went wrong, read out by screen readers.

import { h } from "./dom.js";

const SHOWN_MS = 6000;

/** @param {string} text */
export function notice(text) {
  const line = h("div", { class: "notice" }, text);
  document.getElementById("notices")?.append(line);
  setTimeout(() => line.remove(), SHOWN_MS);
}

/**
 * Does something and says what went wrong, if anything.
 * @template T
 * @param {Promise<T>} work
 * @returns {Promise<T | undefined>}
 */
export async function reported(work) {
  try {
    return await work;
  } catch (error) {
    notice(error instanceof Error ? error.message : String(error));
    return undefined;
  }
}
