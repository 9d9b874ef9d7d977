// The time left of a sweep, from its pace while its points ran; pauses and waits for a worker do not count.

/** Running time that the newest look at a sweep's speed reaches back [ms]. */
const RECENT_MS = 120_000;
/** Running time that a speed needs, since a point that ends just then would say too much [ms]. */
const LEAST_MS = 3000;

export class Pace {
  /** Stretches of time in which points ran, and by how much the progress grew. @type {{lasted: number, grown: number}[]} */
  #stretches = [];
  /** @type {{at: number, sweep: any} | null} */
  #last = null;
  /** Seconds that a point took which is complete, where that is known. @type {number | null} */
  pointSeconds = null;

  /** @param {any} sweep as it is now */
  note(sweep) {
    const now = { at: Date.now(), sweep };
    const before = this.#last;
    this.#last = now;
    // Points that are added, or tried again, take progress back.
    if (
      !before ||
      !runs(before.sweep) ||
      sweep.progress < before.sweep.progress ||
      sweep.counts.total !== before.sweep.counts.total
    )
      return;
    this.#stretches.push({ lasted: now.at - before.at, grown: sweep.progress - before.sweep.progress });
    while (
      this.#stretches.length > 1 &&
      total(this.#stretches, "lasted") - this.#stretches[0].lasted > RECENT_MS
    )
      this.#stretches.shift();
  }

  /** Seconds left; null where that is not known. @returns {number | null} */
  left() {
    const sweep = this.#last?.sweep;
    if (!sweep || !runs(sweep)) return null;
    const [lasted, grown] = [total(this.#stretches, "lasted"), total(this.#stretches, "grown")];
    if (lasted >= LEAST_MS && grown > 0) return (((1 - sweep.progress) / grown) * lasted) / 1000;
    if (this.pointSeconds === null) return null;
    return ((1 - sweep.progress) * sweep.counts.total * this.pointSeconds) / sweep.counts.running;
  }
}

/** Whether points of a sweep are being computed. @param {any} sweep */
function runs({ state, counts }) {
  return state === "running" && counts.running > 0;
}

/** @template {string} K @param {Record<K, number>[]} entries @param {K} name */
function total(entries, name) {
  return entries.reduce((sum, entry) => sum + entry[name], 0);
}
