// Common to the views of a point.

/**
 * Data and callbacks for a view of a point.
 * @typedef {object} PointContext
 * @property {any} point
 * @property {string} path of the point, from `/v1`
 * @property {URLSearchParams} query
 * @property {(changes: Record<string, string | null>) => void} keep keeps a choice in the link
 * @property {(name: string) => string} bias text to show next to a number of the summary, if verifying the sweep found its bias
 * @property {(name: string, query?: Record<string, any>) => Promise<any>} table a table of the point's result
 * @property {() => void} drawn says that what is shown is of other requests than before
 * @property {AbortSignal} signal
 */

/**
 * A view of a point, and the requests behind what it shows; none where it shows nothing of the service's.
 * @typedef {{element: HTMLElement, draw: () => Promise<void>, request: () => PartRequest | null}} PointPart
 *
 * A table is a path from that of the point; that of the point itself is empty.
 * @typedef {{asked: {table: string, query?: Record<string, any>, isDocument?: boolean, name?: string}[], python: string}} PartRequest
 */

/**
 * The requests of a part with their paths from `/v1`.
 * @param {string} path of the point
 * @param {PartRequest} request
 */
export function askedOf(path, { asked }) {
  return asked.map(({ table, name, ...rest }) => ({
    ...rest,
    path: table ? `${path}/${table}` : path,
    name: name ?? (table || "point"),
  }));
}
