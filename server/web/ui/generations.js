// Of several drawings of one thing the newest: an older one, whose answers come later, must not show what it found.

/** @returns {() => () => boolean} begins a drawing, and gives what says whether none has begun since */
export function generations() {
  let newest = 0;
  return () => {
    const mine = ++newest;
    return () => mine === newest;
  };
}
