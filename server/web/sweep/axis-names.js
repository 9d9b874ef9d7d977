// Names of parallel axes: on one line above them where there is room, else on several lines below them.

/** Width of a character of a name, about, and margins of the picture at the left and right [pixels]. */
const [CHARACTER, MARGINS] = [6.6, { l: 80, r: 150 }];
/** Longest line of a name, in characters, and the least distance of axes whose names have such lines [pixels]. */
const [LINE, LEAST_APART] = [16, 118];
/** Height of a line below the axes, and of all else below them, such as the value at the end of the axis [pixels]. */
export const LINE_PX = 16;
const BELOW = 44;

/**
 * A name in lines, at its blanks.
 * @param {string} name
 */
export function wrapped(name) {
  /** @type {string[]} */
  const lines = [];
  for (const word of name.split(" ")) {
    const last = lines[lines.length - 1];
    if (last !== undefined && last.length + 1 + word.length <= LINE)
      lines[lines.length - 1] = `${last} ${word}`;
    else lines.push(word);
  }
  return lines;
}

/**
 * Places of the names of axes.
 * @param {string[]} names
 * @param {number} width of the picture's place [pixels]
 * @returns {{lines: string[][], side: "top" | "bottom", width: number, margin: {t: number, b: number, l: number, r: number}}} with the least width of the picture
 */
export function axisNames(names, width) {
  // A name is centred at its axis: neighbours share the room between them, and the outermost have that of the margins.
  const half = (/** @type {string} */ name) => (name.length * CHARACTER) / 2;
  const l = Math.max(MARGINS.l, half(names[0]) + 8);
  const r = Math.max(MARGINS.r, half(names[names.length - 1]) + 8);
  const apart = (width - l - r) / Math.max(1, names.length - 1);
  const fits = names.slice(1).every((name, order) => half(names[order]) + half(name) <= apart);
  if (fits)
    return { lines: names.map((name) => [name]), side: "top", width: 0, margin: { l, r, t: 70, b: 30 } };
  const lines = names.map(wrapped);
  const most = Math.max(...lines.map(({ length }) => length));
  return {
    lines,
    side: "bottom",
    width: (names.length - 1) * LEAST_APART + MARGINS.l + MARGINS.r,
    margin: { ...MARGINS, t: 30, b: BELOW + LINE_PX * (most + 1) },
  };
}
