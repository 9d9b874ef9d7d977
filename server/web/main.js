// The frame: which view the link asks for, the session, settings, and what is said when the service is gone.

import { answerAfter, connection, Problem, Unreachable } from "./data/api.js";
import { apply, choose, settings, theme, unitSystem } from "./data/settings.js";
import { loadQuantities } from "./data/units.js";
import { fill, h } from "./ui/dom.js";
import { reported } from "./ui/notices.js";
import { arrive, route } from "./ui/router.js";
import { loadSession, logIn, logOut, onLoginNeeded, session } from "./ui/session.js";

/** The module of each view, by its name. @type {Record<string, () => Promise<{show: import("./ui/router.js").View}>>} */
const VIEWS = {
  list: () => import("./list/view.js"),
  sweep: () => import("./sweep/view.js"),
  point: () => import("./point/view.js"),
  compare: () => import("./compare/view.js"),
  submit: () => import("./submit/view.js"),
};

/** Time that a view may take before the page shows that it is loading. */
const SLOW_MS = 250;

const main = element("main");
const banner = element("banner");
const switches = element("switches");

/** @type {AbortController} */
let shown = new AbortController();

/** @param {string} id */
function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return found;
}

/** Shows what the link asks for, anew. */
async function show() {
  shown.abort();
  const mine = (shown = new AbortController());
  const asked = route();
  const view = preload.viewOf(asked.path);
  const isElsewhere = arrive(asked.path);
  for (const entry of document.querySelectorAll(".bar nav a")) {
    const isHere = entry.getAttribute("href") === `#/${asked.path[0]}`;
    if (isHere) entry.setAttribute("aria-current", "page");
    else entry.removeAttribute("aria-current");
  }
  if (!view) {
    fill(
      main,
      h(
        "div",
        { class: "empty" },
        h("h1", {}, "There is no such page"),
        h("p", {}, h("a", { href: "#/sweeps" }, "To the sweeps")),
      ),
    );
    return;
  }
  // A view that comes at once needs no such word, which would hold it up.
  const waits = setTimeout(
    () => isElsewhere && fill(main, h("p", { class: "empty", role: "status" }, "Loading…")),
    SLOW_MS,
  );
  // A view is built aside and takes its place complete, so that one that is shown anew does not flicker.
  const next = h("div", {});
  preload.modules(asked);
  try {
    const title = await (await VIEWS[view]()).show(next, asked, mine.signal);
    if (mine.signal.aborted) return;
    document.title = `${title} · drillsweep`;
  } catch (error) {
    if (mine.signal.aborted) return;
    fill(next, failure(error));
  } finally {
    clearTimeout(waits);
  }
  fill(main, next);
  next.dispatchEvent(new Event("shown"));
  if (isElsewhere) {
    main.focus({ preventScroll: true });
    scrollTo(0, 0);
  }
}

/** Whether a form is shown that somebody may have typed in; it follows what changes by itself. */
function isTyped() {
  return preload.viewOf(route().path) === "submit" && main.querySelector("form") !== null;
}

/** @param {unknown} error */
function failure(error) {
  if (error instanceof Problem && error.status === 401)
    return h("div", { class: "empty" }, h("h1", {}, "Log in to see this"));
  if (error instanceof Problem && error.status === 404) {
    return h(
      "div",
      { class: "empty" },
      h("h1", {}, "Not found"),
      h("p", {}, error.message),
      h("p", {}, h("a", { href: "#/sweeps" }, "To the sweeps")),
    );
  }
  if (!(error instanceof Problem || error instanceof Unreachable)) console.error(error);
  const text = error instanceof Error ? error.message : String(error);
  const again = h("button", { onclick: () => void show() }, "Try again");
  return h(
    "div",
    { class: "empty", role: "alert" },
    h("h1", {}, "This could not be shown"),
    h("p", {}, text),
    again,
  );
}

function drawSwitches() {
  const isDark = theme() === "dark";
  const units = unitSystem();
  const other = units === "si" ? "field" : "si";
  const { owner, name, scope, tokens_required } = session();
  fill(
    switches,
    h(
      "button",
      {
        onclick: () => choose("units", other),
        title: "Units of all numbers and axes",
        "aria-label": `Units: ${units === "si" ? "SI" : "field"}. Switch`,
      },
      units === "si" ? "SI units" : "Field units",
    ),
    h(
      "button",
      {
        onclick: () => choose("theme", isDark ? "light" : "dark"),
        "aria-label": isDark ? "Light theme" : "Dark theme",
      },
      isDark ? "Light" : "Dark",
    ),
    owner
      ? h(
          "button",
          {
            onclick: leave,
            title: `Logged in as ${owner}${name ? `, by the token ${name}` : ""}; may ${scope}`,
          },
          "Log out",
        )
      : tokens_required && h("button", { onclick: enter }, "Log in"),
  );
}

async function leave() {
  await reported(logOut());
  drawSwitches();
  void show();
}

function enter() {
  logIn(() => {
    drawSwitches();
    void show();
  });
}

onLoginNeeded(enter);
connection.addEventListener("lost", (event) => {
  const { retryAt } = /** @type {CustomEvent} */ (event).detail;
  const seconds = Math.max(1, Math.round((retryAt - Date.now()) / 1000));
  fill(banner, `The server does not answer. What you see is as it was last; trying again in ${seconds} s.`);
  banner.hidden = false;
});
connection.addEventListener("found", () => {
  banner.hidden = true;
  if (!isTyped()) void show();
});
settings.addEventListener("change", () => {
  drawSwitches();
  if (!isTyped()) void show();
});
addEventListener("hashchange", () => void show());

apply();
answerAfter(Promise.all([loadQuantities(), loadSession().then(drawSwitches)]));
await show();
