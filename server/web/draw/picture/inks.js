// Inks of pictures, by the theme.

import { theme } from "../../data/settings.js";

/** @typedef {{text: string, soft: string, line: string, panel: string}} Inks */

/** @returns {Inks} colours of the theme */
export function inks() {
  return theme() === "dark"
    ? { text: "#e4e9ee", soft: "#9ca9b6", line: "#323c47", panel: "#1a2129" }
    : { text: "#1b232c", soft: "#56626f", line: "#d8dde3", panel: "#ffffff" };
}

/** Letters of pictures. */
export const FONT = 'system-ui, "Segoe UI", "Noto Sans", sans-serif';
