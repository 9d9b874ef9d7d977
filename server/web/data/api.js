// Requests to the service, and whether it can be reached.

/** A problem that the service reports (RFC 9457). */
export class Problem extends Error {
  /** @param {number} status @param {any} document */
  constructor(status, document) {
    super(document.detail || document.title || `the server answered ${status}`);
    this.status = status;
    /** @type {string} */
    this.title = document.title ?? `Error ${status}`;
    /** @type {{pointer?: string, parameter?: string, detail: string}[]} */
    this.errors = document.errors ?? [];
  }
}

/** The service could not be reached. */
export class Unreachable extends Error {
  constructor() {
    super("the server cannot be reached");
  }
}

/** `lost` when the service does not answer, `found` when it does again, `login` when it wants a token. */
export const connection = new EventTarget();

const FIRST_RETRY_MS = 1000;
const LONGEST_RETRY_MS = 30_000;
/** Pause before a refused stream is requested again. */
const REFUSED_MS = 5000;
let isLost = false;

export const address = preload.address;

/** Work that every answer waits for. @type {Promise<unknown>} */
let needed = Promise.resolve();

/**
 * Lets requests go out at once, and holds their answers back until what every view needs is there.
 * @param {Promise<unknown>} work
 */
export function answerAfter(work) {
  needed = work;
}

/**
 * @param {string} path
 * @param {Record<string, any>} [query]
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>}
 */
export async function get(path, query, signal) {
  const [answer] = await Promise.all([ask("GET", address(path, query), undefined, signal), needed]);
  return answer;
}

/**
 * As `get`, for what every view needs.
 * @param {string} path
 * @returns {Promise<any>}
 */
export function getNeeded(path) {
  return ask("GET", path, undefined);
}

/**
 * The same for an answer that is no JSON.
 * @param {string} path
 * @param {Record<string, any>} [query]
 * @param {AbortSignal} [signal]
 * @returns {Promise<ArrayBuffer>}
 */
export function getBytes(path, query, signal) {
  return ask("GET", address(path, query), undefined, signal, (answer) => answer.arrayBuffer());
}

/**
 * A request with side effects, or one with a body.
 * @param {"POST" | "PATCH" | "DELETE"} method
 * @param {string} path
 * @param {any} [body]
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>}
 */
export function send(method, path, body, signal) {
  return ask(method, path, body, signal);
}

/**
 * Sends a file for an answer in JSON.
 * @param {string} path
 * @param {Record<string, any>} query
 * @param {File} file
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>}
 */
export function sendFile(path, query, file, signal) {
  return ask("POST", address(path, query), file, signal);
}

/**
 * @param {string} method
 * @param {string} url
 * @param {any} body a file, or anything as JSON
 * @param {AbortSignal} [signal]
 * @param {(answer: Response) => Promise<any>} [read] the answer that is no problem
 */
async function ask(method, url, body, signal, read = (answer) => answer.json()) {
  /** @type {Record<string, string>} */
  const headers = { Accept: "application/json" };
  const isFile = body instanceof Blob;
  if (body !== undefined) headers["Content-Type"] = isFile ? "application/octet-stream" : "application/json";
  let answer;
  try {
    const sent = body === undefined || isFile ? body : JSON.stringify(body);
    const early = method === "GET" ? preload.sent(url) : isFile ? null : preload.posted(url, sent);
    answer = await (early ?? fetch(url, { method, headers, body: sent, signal }));
  } catch (error) {
    if (signal?.aborted) throw error;
    lose();
    throw new Unreachable();
  }
  if (answer.status === 502 || answer.status === 504) {
    lose();
    throw new Unreachable();
  }
  if (answer.status === 204) return null;
  if (answer.ok) return read(answer);
  const document = await answer.json().catch((error) => {
    if (signal?.aborted) throw error;
    return {};
  });
  if (answer.status === 401) connection.dispatchEvent(new Event("login"));
  throw new Problem(answer.status, document);
}

/** Says that the service is gone, and asks for it at growing intervals until it answers. */
export function lose() {
  if (isLost) return;
  isLost = true;
  probe(FIRST_RETRY_MS);
}

/** @param {number} delay */
function probe(delay) {
  connection.dispatchEvent(new CustomEvent("lost", { detail: { retryAt: Date.now() + delay } }));
  setTimeout(async () => {
    const answer = await fetch("/livez", { cache: "no-store" }).catch(() => null);
    if (answer?.ok) {
      isLost = false;
      connection.dispatchEvent(new Event("found"));
    } else {
      probe(Math.min(2 * delay, LONGEST_RETRY_MS));
    }
  }, delay);
}

/**
 * Follows a sweep until its end or the signal. The browser reconnects by itself and says which event it saw last.
 * @param {string} id
 * @param {{sweep?: (sweep: any) => void, point?: (event: any) => void}} listeners
 * @param {AbortSignal} signal
 */
export function follow(id, listeners, signal) {
  if (signal.aborted) return;
  const source = new EventSource(`/v1/sweeps/${encodeURIComponent(id)}/events`);
  source.addEventListener("sweep", (event) => {
    const sweep = JSON.parse(event.data);
    if (isFinal(sweep)) source.close();
    listeners.sweep?.(sweep);
  });
  source.addEventListener("point", (event) => listeners.point?.(JSON.parse(event.data)));
  source.addEventListener("error", () => {
    // A stream that ends and a server that is gone look the same from here.
    if (source.readyState !== EventSource.CLOSED) return void get("/livez", {}, signal).catch(() => {});
    setTimeout(async () => {
      // A stream is refused without a reason; the sweep itself says whether it has ended, or that a token is needed.
      const sweep = await get(`/v1/sweeps/${encodeURIComponent(id)}`, {}, signal).catch(() => null);
      if (sweep) listeners.sweep?.(sweep);
      if (!sweep || !isFinal(sweep)) follow(id, listeners, signal);
    }, REFUSED_MS);
  });
  signal.addEventListener("abort", () => source.close(), { once: true });
}

/** @param {any} sweep */
export function isFinal(sweep) {
  return sweep.state === "completed" || sweep.state === "cancelled";
}
