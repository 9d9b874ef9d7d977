// Which of several works on one thing is the newest: an older one, whose answers come later, must not show what it found.

/** @returns {() => () => boolean} begins a work, and gives what says whether none has begun since */
export function works() {
  let newest = 0;
  return () => {
    const mine = ++newest;
    return () => mine === newest;
  };
}
