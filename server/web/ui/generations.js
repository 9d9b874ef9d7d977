// The newest of several drawings of one thing: an older one, whose answers arrive later, must not be shown.

/** @returns {() => () => boolean} begins a drawing, and gives what says whether none has begun since */
export function generations() {
  let newest = 0;
  return () => {
    const mine = ++newest;
    return () => mine === newest;
  };
}
