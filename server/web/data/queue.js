// Place of a sweep that has not begun among those before it.

/**
 * Whether no point of a sweep has begun yet, although it may.
 * @param {any} sweep
 */
export function hasNotBegun({ state, progress, counts }) {
  return (
    state === "running" &&
    !progress &&
    !counts.running &&
    !counts.succeeded &&
    !counts.failed &&
    counts.queued > 0
  );
}

/**
 * Number of sweeps of the same owner whose points are taken before those of a sweep: of higher priority, or submitted earlier. Owners take turns, so that
 * sweeps of others have no place before it.
 * @param {any} sweep
 * @param {any[]} running all sweeps that may run
 */
export function sweepsBefore({ id, owner, priority }, running) {
  return running.filter(
    (other) =>
      other.id !== id &&
      other.owner === owner &&
      other.state === "running" &&
      other.counts.queued + other.counts.running > 0 &&
      // Identifiers grow with time.
      (other.priority > priority || (other.priority === priority && other.id < id)),
  ).length;
}
