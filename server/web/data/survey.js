// A survey of the well, pasted from a spreadsheet or a report.

/** @typedef {{measured_depth: number, inclination_deg: number, azimuth_deg: number}} Station */

/** Metres of each unit in which surveys give depths; the foot is the international one. @type {Record<string, number>} */
const METRES = { m: 1, ft: 0.3048 };

/** A text that is no survey. */
export class NoSurvey extends Error {}

/**
 * Stations as a text that `readSurvey` reads.
 * @param {Station[]} stations
 * @param {string} unit of the depths
 */
export function surveyText(stations, unit) {
  // To a ten-thousandth of a unit, as below.
  const depth = (/** @type {number} */ metres) => Number((metres / METRES[unit]).toFixed(4));
  return stations
    .map((station) =>
      [depth(station.measured_depth), station.inclination_deg, station.azimuth_deg].join("\t"),
    )
    .join("\n");
}

/**
 * The columns of a line, with points as decimal signs. Where tabs, semicolons or spaces part the columns, a comma within one is a decimal sign.
 * @param {string} line
 */
function columns(line) {
  const parting = ["\t", ";"].find((sign) => line.includes(sign));
  const cells = line
    .trim()
    .split(parting ?? /\s+/)
    .map((cell) => cell.trim());
  const isParted =
    parting || (cells.length >= 3 && !cells.some((cell) => cell.startsWith(",") || cell.endsWith(",")));
  return isParted ? cells.map((cell) => cell.replace(",", ".")) : line.trim().split(/\s*,\s*/);
}

/**
 * Reads stations: measured depth, inclination and azimuth in degrees, one station a line, the columns apart by tabs, semicolons, commas
 * or spaces; further columns and lines above the first station are left out.
 * @param {string} text
 * @param {string} unit of the depths
 * @returns {Station[]} in metres and degrees
 */
export function readSurvey(text, unit) {
  /** @type {Station[]} */
  const stations = [];
  text.split(/\r?\n/).forEach((line, index) => {
    if (!line.trim()) return;
    const [depth, inclination, azimuth] = columns(line).map((cell) => (cell === "" ? NaN : Number(cell)));
    if (![depth, inclination, azimuth].every(Number.isFinite)) {
      if (!stations.length) return;
      throw new NoSurvey(`Line ${index + 1} does not begin with three numbers: ${line.trim().slice(0, 60)}`);
    }
    // To a tenth of a millimetre: what a conversion adds beyond is no measurement.
    stations.push({
      measured_depth: Number((depth * METRES[unit]).toFixed(4)),
      inclination_deg: inclination,
      azimuth_deg: azimuth,
    });
  });
  if (!stations.length) throw new NoSurvey("No line begins with measured depth, inclination and azimuth");
  return stations;
}
