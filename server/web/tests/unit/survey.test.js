// Surveys as spreadsheets and reports have them.

import assert from "node:assert/strict";
import { test } from "node:test";
import { NoSurvey, readSurvey, surveyText } from "../../data/survey.js";

/** Stations from rows of depth, inclination and azimuth. */
function stations(...rows) {
  return rows.map(([measured_depth, inclination_deg, azimuth_deg]) => ({
    measured_depth,
    inclination_deg,
    azimuth_deg,
  }));
}

const EXPECTED = stations([0, 60.5, 0], [100, 75, 7], [200.5, 93, 36]);

const TEXTS = {
  "tabs, with a head, a further column and decimal commas":
    "MD\tIncl\tAzi\tTVD\n0\t60,5\t0\t0\n100\t75\t7\t90\n200,5\t93\t36\t100\n",
  "semicolons and decimal commas": "0;60,5;0\n100;75;7\n200,5;93;36",
  "spaces and decimal points": "0 60.5 0\n100 75 7\n200.5 93 36",
  "spaces and decimal commas": "  0   60,5  0\n100 75 7\n200,5 93 36",
  commas: "0,60.5,0\n100,75,7\n200.5,93,36",
  "commas and spaces": "0, 60.5, 0\n100, 75, 7\n200.5, 93, 36",
  "lines of Windows, and empty ones": "0 60.5 0\r\n\r\n100 75 7\r\n200.5 93 36\r\n",
};
for (const [name, text] of Object.entries(TEXTS)) {
  test(`a survey is read: ${name}`, () => assert.deepEqual(readSurvey(text, "m"), EXPECTED));
}

test("feet are international ones, to a tenth of a millimetre", () => {
  const text = "0 0 0\n1000 12.5 40\n328.084 1 2";
  assert.deepEqual(readSurvey(text, "ft"), stations([0, 0, 0], [304.8, 12.5, 40], [100, 1, 2]));
});

test("a line within the stations that is none is named", () => {
  assert.throws(() => readSurvey("0 60 0\n100 nonsense 7\n200 1 2", "m"), {
    constructor: NoSurvey,
    message: "Line 2 does not begin with three numbers: 100 nonsense 7",
  });
  assert.throws(() => readSurvey("0\t60\t0\n100\t\t7", "m"), NoSurvey);
});

test("a text without stations is no survey", () => {
  for (const text of ["", "MD Incl Azi", "1 2"]) assert.throws(() => readSurvey(text, "m"), NoSurvey);
});

test("stations are written as they are read, in either unit", () => {
  for (const unit of ["m", "ft"]) assert.deepEqual(readSurvey(surveyText(EXPECTED, unit), unit), EXPECTED);
  assert.equal(surveyText(stations([304.8, 2.5, 359]), "ft"), "1000\t2.5\t359");
});
