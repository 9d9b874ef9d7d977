// Colours of values on a scale, for what is not drawn by plotly; the same scale as there.

/** Viridis at equal steps (van der Walt and Smith 2015). */
const STOPS = [
  [68, 1, 84],
  [72, 40, 120],
  [62, 73, 137],
  [49, 104, 142],
  [38, 130, 142],
  [31, 158, 137],
  [53, 183, 121],
  [110, 206, 88],
  [181, 222, 43],
  [253, 231, 37],
];
const STEPS = 128;

/** Colours from the least to the largest value. */
const COLOURS = Array.from({ length: STEPS }, (_, step) => {
  const place = (step / (STEPS - 1)) * (STOPS.length - 1);
  const below = Math.min(Math.floor(place), STOPS.length - 2);
  const mixed = STOPS[below].map((value, part) =>
    Math.round(value + (STOPS[below + 1][part] - value) * (place - below)),
  );
  return `rgb(${mixed.join(",")})`;
});

/**
 * @param {number} value
 * @param {[number, number]} range of the scale; what lies beyond has the colour of its end
 */
export function colourOf(value, [least, largest]) {
  const part = largest > least ? (value - least) / (largest - least) : 0.5;
  return COLOURS[Math.max(0, Math.min(STEPS - 1, Math.round(part * (STEPS - 1))))];
}

/** The scale as a gradient of CSS, from left to right. */
export const GRADIENT = `linear-gradient(to right, ${Array.from({ length: 11 }, (_, step) => COLOURS[Math.round((step / 10) * (STEPS - 1))]).join(", ")})`;
