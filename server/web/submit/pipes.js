// Pipes of the catalogue in the rows of a tally.

import { get } from "../data/api.js";
import { fill, h } from "../ui/dom.js";
import { attend } from "../ui/notices.js";
import { withoutNulls } from "./members.js";

/** A section without its length. @typedef {{name: string} & Record<string, unknown>} Pipe */

/** @type {Promise<Pipe[]> | undefined} */
let requested;

/** The catalogue, which is requested once. */
function catalogue() {
  requested ??= get("/v1/pipes").then(({ pipes }) => pipes);
  requested.catch(() => (requested = undefined));
  return requested;
}

/** Identifier of the names that all boxes of pipes offer. */
const NAMES = "pipes";

/** Names of pipes, once a box is entered. */
export function namesOfPipes() {
  return h("datalist", { id: NAMES });
}

/**
 * A row of a tally as a pipe of the catalogue: number, length and make-up torque stay.
 * @param {any} row
 * @param {Pipe} pipe
 */
export function withPipe({ count, length, make_up_torque }, pipe) {
  const kept = Object.entries({ count, length, make_up_torque }).filter(([, value]) => value !== undefined);
  return { ...withoutNulls(pipe), ...Object.fromEntries(kept) };
}

/**
 * Column of boxes for the name of a pipe, which fill their row.
 * @param {AbortSignal} signal of the view
 * @returns {import("./table.js").Column}
 */
export function pipeColumn(signal) {
  return {
    name: "pipe",
    text: "Pipe of the catalogue",
    cell: (name, _value, row, _set, replace) => {
      const offer = async () => {
        if (box.list?.childElementCount === 0)
          fill(
            box.list,
            (await catalogue()).map((pipe) => h("option", { value: pipe.name })),
          );
      };
      const take = async () => {
        const wanted = box.value.trim().toLowerCase();
        const found = (await catalogue()).find((pipe) => pipe.name.toLowerCase() === wanted);
        box.setAttribute("aria-invalid", String(wanted !== "" && !found));
        if (found) replace(withPipe(row, found));
      };
      const box = h("input", {
        "aria-label": name,
        list: NAMES,
        placeholder: '5" 19.5# S-135 NC50',
        onfocus: () => attend(offer(), signal),
        onchange: () => attend(take(), signal),
      });
      return box;
    },
  };
}
