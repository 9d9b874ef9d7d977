// The latest answers of a service, shared by those who ask the same.

/** Answers that are kept. */
const KEPT = 16;

/**
 * Asks as `ask` does, but not again for one of the latest answers. Failures are not kept.
 * @param {(name: string, query?: Record<string, any>) => Promise<any>} ask
 * @returns {(name: string, query?: Record<string, any>) => Promise<any>}
 */
export function latest(ask) {
  /** @type {Map<string, Promise<any>>} */
  const answers = new Map();
  return (name, query = {}) => {
    const key = JSON.stringify([name, query]);
    const known = answers.get(key);
    if (known) return known;
    const answer = ask(name, query);
    answers.set(key, answer);
    answer.catch(() => answers.delete(key));
    const [oldest] = answers.keys();
    if (answers.size > KEPT) answers.delete(oldest);
    return answer;
  };
}
