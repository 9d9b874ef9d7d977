// A field of the form for a survey of the well.

import { unitSystem } from "../data/settings.js";
import { NoSurvey, readSurvey } from "../data/survey.js";
import { number, say as sayValue } from "../data/units.js";
import { choice, fill, h } from "../ui/dom.js";

/** @typedef {import("../data/survey.js").Station} Station */

/**
 * A field for a survey.
 * @param {Station[] | undefined} given in a request that the form begins with
 * @param {() => void} changed
 * @returns {{element: HTMLElement, read: () => Station[] | undefined, say: () => void}} `say` sums the survey up again, in the units that now hold
 */
export function surveyField(given, changed) {
  // Stations of a request are in metres.
  let unit = !given && unitSystem() === "field" ? "ft" : "m";
  const summary = h("p", { class: "small soft", "aria-live": "polite" });
  const text = h("textarea", {
    class: "code",
    rows: 6,
    spellcheck: "false",
    "aria-label": "Survey: measured depth, inclination and azimuth of each station",
    placeholder: "0\t0\t0\n500\t12.5\t40",
    value: (given ?? [])
      .map((station) => [station.measured_depth, station.inclination_deg, station.azimuth_deg].join("\t"))
      .join("\n"),
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
  const element = h(
    "details",
    { open: Boolean(given), "data-pointer": "/set/well.survey" },
    h("summary", {}, "Survey from a spreadsheet"),
    h(
      "p",
      { class: "small soft" },
      "Paste the columns measured depth, inclination [°] and azimuth [°]: they take the place of the scenario's survey.",
    ),
    units,
    text,
    summary,
  );
  return { element, read, say };
}
