// Preloads the first view while the page is still being read: its modules, which a browser would otherwise find one after the other, each
// when the one before has arrived and run, and the service's answers. Modules run after the page's first picture at the earliest; this is a
// plain script, which runs at once and which they use as `preload`.

const preload = (() => {
  /** Points up to which the whole table of a sweep is one answer. */
  const WHOLE = 3000;
  /** Sweeps on a page of the list. */
  const PAGE = 100;
  /** Request that the form of a new sweep proposes; `submit/view.js` writes its members in this order. */
  const PROPOSED = {
    preset: "paper-200m-damped",
    axes: {
      flow_rate: { values: [0.01, 0.04, 0.06] },
      mud_density: { from: 1200, to: 2100, count: 4 },
    },
  };
  /** Points that are compared, at most. */
  const MOST = 6;
  /** Time that an answer waits for the view to request it; later it may be out of date. */
  const KEPT_MS = 3000;

  /**
   * Module of each part of a view, by the part's name in the link; the first is the default.
   * @type {Record<string, Record<string, string>>}
   */
  const PARTS = {
    sweep: {
      map: "sweep/map.js",
      window: "sweep/window.js",
      scatter: "sweep/scatter.js",
      parallel: "sweep/parallel.js",
      effects: "sweep/sensitivities.js",
      difference: "sweep/difference.js",
      table: "sweep/table.js",
      failures: "sweep/failures.js",
    },
    point: {
      profiles: "point/profiles.js",
      motion: "point/motion.js",
      spectrogram: "point/spectrogram.js",
      string: "point/string.js",
      well: "point/well.js",
      energy: "point/energy.js",
      hydraulics: "point/hydraulics.js",
      drag: "point/drag.js",
      forced: "point/forced.js",
      about: "point/about.js",
    },
  };

  /** Imports of each module by paths from the page's folder, which the server writes into the page. @type {Record<string, string[]>} */
  const imports = JSON.parse(document.getElementById("imports")?.textContent || "{}");
  const folder = /** @type {HTMLScriptElement} */ (document.currentScript).src;
  /** @type {Set<string>} */
  const preloaded = new Set();
  /** Answers that no view has asked for yet, by address. @type {Map<string, Promise<Response>>} */
  const answers = new Map();
  /** Addresses that a view has asked for while answers are kept. @type {Set<string>} */
  const taken = new Set();
  /** Dry run of a new sweep, which the service computes for a second or more. @type {{url: string, body: string, answer: Promise<Response>, abort: AbortController} | null} */
  let dryRun = null;
  /** Nothing is sent for any more. */
  let isOver = false;

  /** @returns {import("./ui/router.js").Route} what the link asks for */
  function route() {
    const [path, query] = (location.hash.replace(/^#/, "") || "/sweeps").split("?", 2);
    return { path: path.split("/").filter(Boolean).map(decode), query: new URLSearchParams(query ?? "") };
  }

  /** @param {string} segment */
  function decode(segment) {
    try {
      return decodeURIComponent(segment);
    } catch {
      return segment;
    }
  }

  /**
   * @param {string} path
   * @param {Record<string, string | number | boolean | null | undefined>} [query] what is absent or empty is left out
   */
  function address(path, query = {}) {
    const pairs = Object.entries(query).filter(
      ([, value]) => value !== null && value !== undefined && value !== "",
    );
    const text = new URLSearchParams(pairs.map(([name, value]) => [name, String(value)])).toString();
    return text ? `${path}?${text}` : path;
  }

  /**
   * The query of the list's first page.
   * @param {Record<string, string>} filters an empty one is none
   */
  function firstPage({ state, name, owner, tag }) {
    return { state, name: name.trim(), owner: owner.trim(), tag: tag.trim(), limit: PAGE };
  }

  /**
   * The points that a comparison's link names, each once.
   * @param {URLSearchParams} query
   * @returns {string[]} such as `SWEEP:3`
   */
  function comparedIn(query) {
    const keys = (query.get("points") ?? "").split(",").filter((key) => /^[\w-]+:\d+$/.test(key));
    return [...new Set(keys)].slice(0, MOST);
  }

  /**
   * @param {string[]} path of the link
   * @returns {string} the view's folder; empty if the link names no view
   */
  function viewOf(path) {
    if (path[0] === "sweeps" && path.length === 1) return "list";
    if (path[0] === "sweeps" && path.length === 2) return "sweep";
    if (path[0] === "sweeps" && path[2] === "points" && path.length === 4) return "point";
    if (path[0] === "compare" && path.length === 1) return "compare";
    return path[0] === "new" && path.length === 1 ? "submit" : "";
  }

  /** Preloads the modules of the view that a link names. @param {import("./ui/router.js").Route} route */
  function modules({ path, query }) {
    const view = viewOf(path);
    if (!view) return;
    load(`${view}/view.js`);
    const parts = PARTS[view];
    if (parts) load(parts[query.get("view") ?? ""] ?? Object.values(parts)[0]);
  }

  /** Preloads a module with all that it imports. @param {string} name its path from the page's folder */
  function load(name) {
    if (preloaded.has(name)) return;
    preloaded.add(name);
    const link = document.createElement("link");
    Object.assign(link, { rel: "modulepreload", href: new URL(name, folder).href });
    document.head.append(link);
    imports[name]?.forEach(load);
  }

  /**
   * The answer to a request that has been sent already, once.
   * @param {string} url
   * @returns {Promise<Response> | undefined}
   */
  function sent(url) {
    const answer = answers.get(url);
    answers.delete(url);
    if (!isOver) taken.add(url);
    return answer;
  }

  /** @param {string} url */
  function send(url) {
    if (isOver || taken.has(url)) return;
    const answer = fetch(url, { headers: { Accept: "application/json" } });
    // The view that requests it gets the error.
    answer.catch(() => {});
    answers.set(url, answer);
  }

  /** Plans the request that the form of a new sweep begins with. @param {URLSearchParams} query of the link */
  function sendDryRun(query) {
    const isBare = [...query.keys()].length === 0;
    const body = isBare ? JSON.stringify(PROPOSED) : query.get("request");
    if (!body || query.has("from")) return;
    const abort = new AbortController();
    const url = "/v1/sweeps?dry_run=true";
    const headers = { Accept: "application/json", "Content-Type": "application/json" };
    const answer = fetch(url, { method: "POST", headers, body, signal: abort.signal });
    dryRun = { url, body, answer, abort };
    answer.then(
      ({ status }) => {
        // The view sends it again once the reader has logged in.
        if (status === 401 && dryRun?.answer === answer) dryRun = null;
      },
      () => {},
    );
    addEventListener("hashchange", () => (dryRun = null), { once: true });
  }

  /**
   * The answer to a request with a body that has been sent already, once; one for another body is given up.
   * @param {string} url
   * @param {string | undefined} body
   * @returns {Promise<Response> | undefined}
   */
  function posted(url, body) {
    const before = dryRun;
    if (before?.url !== url) return undefined;
    dryRun = null;
    if (before.body === body) return before.answer;
    before.abort.abort();
    return undefined;
  }

  /** Document of a sent request, once it has arrived; `null` if there is none. @param {string} url */
  async function received(url) {
    const answer = await answers.get(url);
    return answer?.ok ? answer.clone().json() : null;
  }

  /** Sends for the table of a sweep that has been sent for, once it is known to be small. @param {string} sweep */
  async function sendTable(sweep) {
    const answer = await received(sweep);
    if (answer?.counts.total <= WHOLE) send(`${sweep}/table?format=json`);
  }

  /** Sends for the diagnosis of a point that has been sent for, once it is known to have a result. @param {string} point */
  async function sendDiagnosis(point) {
    if ((await received(point))?.summary) send(`${point}/diagnosis`);
  }

  /**
   * Sends for what the motion of a node or of the string is shown from, at a point that has been sent for.
   * @param {string} point
   * @param {URLSearchParams} query of the link
   */
  async function sendMotion(point, query) {
    /** @type {[any, typeof import("./data/motion-requests.js")]} */
    const [answer, requests] = await Promise.all([
      received(point),
      import(new URL("data/motion-requests.js", folder).href),
    ]);
    if (!answer?.summary) return;
    const { scenario } = answer;
    const isOfString = query.get("view") === "string";
    if (!isOfString && !scenario.recording.nodes.length) return;
    const tables = isOfString
      ? requests.stringTables(scenario)
      : [
          ...requests.windowTables(scenario, query, requests.chosenWindow(answer, query)),
          ...requests.nodeTables(scenario, query),
        ];
    for (const [name, asks] of tables) send(address(`${point}/${name}`, { format: "json", ...asks }));
  }

  const first = route();
  const [id, ordinal] = [first.path[1], first.path[3]].map(encodeURIComponent);
  const view = viewOf(first.path);
  send("/v1/quantities");
  send("/v1/session");
  if (view === "list") {
    const [state, name, owner, tag] = ["state", "name", "owner", "tag"].map(
      (filter) => first.query.get(filter) ?? "",
    );
    send(address("/v1/sweeps", firstPage({ state, name, owner, tag })));
  }
  if (view === "compare") {
    send(address("/v1/sweeps", { limit: PAGE }));
    for (const key of comparedIn(first.query)) {
      const [sweep, point] = key.split(":");
      send(`/v1/sweeps/${sweep}/points/${point}`);
    }
  }
  if (view === "submit") {
    send("/v1/scenarios");
    sendDryRun(first.query);
  }
  if (view === "point") send(`/v1/sweeps/${id}/points/${ordinal}`);
  if (view === "sweep" || view === "point") send(`/v1/sweeps/${id}`);
  // The view reports failures when it sends the request itself.
  if (view === "sweep") sendTable(`/v1/sweeps/${id}`).catch(() => {});
  if (view === "point") sendDiagnosis(`/v1/sweeps/${id}/points/${ordinal}`).catch(() => {});
  if (view === "point" && ["motion", "string"].includes(first.query.get("view") ?? ""))
    sendMotion(`/v1/sweeps/${id}/points/${ordinal}`, first.query).catch(() => {});
  load("main.js");
  modules(first);
  setTimeout(() => {
    isOver = true;
    answers.clear();
    taken.clear();
  }, KEPT_MS);
  return {
    WHOLE,
    PAGE,
    MOST,
    PROPOSED,
    address,
    comparedIn,
    firstPage,
    route,
    viewOf,
    modules,
    sent,
    posted,
  };
})();
