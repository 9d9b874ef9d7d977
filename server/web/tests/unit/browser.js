// What modules of the page find in a browser, as far as computing needs it; to be imported before them.

import { readFileSync } from "node:fs";

/** The service's vocabulary, as the Python client has it. */
export const QUANTITIES = JSON.parse(
  readFileSync(new URL("../../../../api/python/src/drillsweep/quantities.json", import.meta.url), "utf8"),
);

const stored = new Map();

Object.assign(globalThis, {
  addEventListener: () => {},
  ResizeObserver: class {},
  document: { documentElement: { dataset: {} } },
  fetch: async () => new Response(JSON.stringify(QUANTITIES)),
  localStorage: {
    getItem: (name) => stored.get(name) ?? null,
    setItem: (name, value) => stored.set(name, value),
  },
  matchMedia: () => ({ matches: false, addEventListener: () => {} }),
  preload: {
    MOST: 6,
    PAGE: 100,
    address: (path) => path,
    route: () => ({ path: [], query: new URLSearchParams() }),
    sent: () => undefined,
    posted: () => undefined,
  },
});

/** Asserts numbers to be near each other, relative to the larger one. */
export function near(actual, expected, tolerance = 1e-12) {
  const size = Math.max(Math.abs(actual), Math.abs(expected));
  if (!(Math.abs(actual - expected) <= tolerance * size)) throw new Error(`${actual} is not ${expected}`);
}

/** Equal numbers every time, from 0 to 1 (a linear congruential generator of 32 bits). */
export function randoms(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}
