// Short messages about what was done or went wrong, read out by screen readers.

import { Problem, Unreachable } from "../data/api.js";
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

/**
 * Does something that nobody waits for, and says what went wrong, unless its view is gone or the page asks for a token.
 * @param {Promise<unknown>} work
 * @param {AbortSignal} signal of the view
 */
export function attend(work, signal) {
  work.catch((error) => {
    if (signal.aborted || (error instanceof Problem && error.status === 401)) return;
    // The banner above the view reports a service that is down, and asks again.
    if (error instanceof Unreachable) return;
    if (!(error instanceof Problem)) console.error(error);
    notice(error instanceof Error ? error.message : String(error));
  });
}
