// The session of the reader, and its permissions.

import { connection, getNeeded, send } from "../data/api.js";
import { h } from "./dom.js";

/** @typedef {{tokens_required: boolean, owner?: string, name?: string, scope?: string, expires?: string}} Session */

/** @type {Session} */
let current = { tokens_required: false };

/** @returns {Session} */
export function session() {
  return current;
}

/** Whether sweeps may be submitted and changed; without tokens everybody may. */
export function maySubmit() {
  return !current.tokens_required || current.scope === "submit" || current.scope === "admin";
}

/** Title of a control that is not allowed. */
export const MAY_NOT = "Your token only allows reading";

export async function loadSession() {
  current = await getNeeded("/v1/session").catch(() => current);
}

export async function logOut() {
  await send("DELETE", "/v1/session");
  await loadSession();
}

/**
 * Asks for a token, unless it is being asked for.
 * @param {() => void} done once somebody has logged in
 */
export function logIn(done) {
  if (document.querySelector("dialog[open]")) return;
  const token = h("input", {
    type: "password",
    autocomplete: "current-password",
    required: true,
    name: "token",
  });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const dialog = h("dialog", { "aria-labelledby": "login-title" });
  const submit = async (/** @type {Event} */ event) => {
    event.preventDefault();
    try {
      await send("POST", "/v1/session", { token: token.value.trim() });
    } catch (error) {
      wrong.textContent = error instanceof Error ? error.message : String(error);
      token.setAttribute("aria-invalid", "true");
      return;
    }
    dialog.close();
    await loadSession();
    done();
  };
  dialog.append(
    h(
      "form",
      { onsubmit: submit },
      h("h2", { id: "login-title" }, "Log in"),
      h(
        "p",
        { class: "soft" },
        "This service needs a token. The browser keeps a session until the token ends or you log out.",
      ),
      h("label", { class: "field wide" }, h("span", {}, "Token"), token),
      wrong,
      h("button", { class: "main", type: "submit" }, "Log in"),
    ),
  );
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/** @param {() => void} listener called when the service wants a token */
export function onLoginNeeded(listener) {
  connection.addEventListener("login", listener);
}
