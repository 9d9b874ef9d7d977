// Columns of the equilibrium that place the nodes of a string in its hole.

import { ALONG, IN_SPACE } from "./motion-requests.js";

/**
 * Columns for pictures of a string in space, in two requests, so that the first one is shared.
 * @param {(name: string, query: Record<string, any>) => Promise<any>} table a table of the point's result
 * @returns {Promise<Record<string, any>>}
 */
export async function equilibrium(table) {
  const [along, inSpace] = await Promise.all([ALONG, IN_SPACE].map((fields) => table("statics", { fields })));
  return { ...along.columns, ...inSpace.columns };
}
