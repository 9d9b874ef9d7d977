// A field of the form for a survey of the well.

import { unitSystem } from "../data/settings.js";
import { NoSurvey, readSurvey, surveyText } from "../data/survey.js";
import { number, say as sayValue } from "../data/units.js";
import { choice, fill, h } from "../ui/dom.js";
import { importFile } from "./import-file.js";

/** @typedef {import("../data/survey.js").Station} Station */

/**
 * A field for a survey.
 * @param {Station[] | undefined} given in a request that the form begins with
 * @param {() => void} changed
 * @param {AbortSignal} signal of the view
 * @returns {{element: HTMLElement, read: () => Station[] | undefined, say: () => void}} `say` sums the survey up again, in the units that now hold
 */
export function surveyField(given, changed, signal) {
  // Stations of a request are in metres.
  let unit = !given && unitSystem() === "field" ? "ft" : "m";
  const summary = h("p", { class: "small soft", "aria-live": "polite" });
  const text = h("textarea", {
    class: "code",
    rows: 6,
    spellcheck: "false",
    "aria-label": "Survey: measured depth, inclination and azimuth of each station",
    placeholder: "0\t0\t0\n500\t12.5\t40",
    value: surveyText(given ?? [], unit),
    oninput: () => {
      say();
      changed();
    },
  });
  const read = () => (text.value.trim() ? readSurvey(text.value, unit) : undefined);
  function say() {
    try {
      const stations = read();
      const last = stations?.at(-1);
      fill(
        summary,
        last
          ? `${stations?.length} stations down to ${sayValue("measured_depth", last.measured_depth)}, inclination up to ${number(Math.max(...(stations ?? []).map((station) => station.inclination_deg)))}°.`
          : "Nothing pasted: the well is the scenario's.",
      );
    } catch (error) {
      if (!(error instanceof NoSurvey)) throw error;
      // The form says what is wrong with it.
      fill(summary);
    }
  }
  say();
  const units = choice(
    "Depths in",
    [
      ["m", "m"],
      ["ft", "ft"],
    ],
    unit,
    (value) => {
      unit = value;
      say();
      changed();
    },
  );
  const taken = (/** @type {{stations: Station[]}} */ { stations }) => {
    text.value = surveyText(stations, unit);
    say();
    changed();
  };
  const file = importFile("survey", {}, () => ({ depth_unit: unit }), taken, signal);
  const element = h(
    "details",
    { open: Boolean(given), "data-pointer": "/set/well.survey" },
    h("summary", {}, "Survey from a spreadsheet"),
    h(
      "p",
      { class: "small soft" },
      "Paste the columns measured depth, inclination [°] and azimuth [°], or choose a file: they take the place of the scenario's survey.",
    ),
    units,
    text,
    summary,
    file,
  );
  return { element, read, say };
}
