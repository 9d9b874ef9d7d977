// Members of a field that is given in whole, by their paths within it.

/** Names and places of a path, such as `sections`, `0` and `length` of `sections[0].length`. @param {string} path */
function steps(path) {
  return path.match(/[^.[\]]+/g) ?? [];
}

/** Member of a value; undefined if there is none. @param {any} value @param {string} path */
export function memberOf(value, path) {
  return steps(path).reduce((inner, step) => inner?.[step], value);
}

/**
 * Copy of a value with one member changed; undefined removes it, and with it an inner object that has no other member.
 * @param {any} value
 * @param {string} path such as `[0].tool_joint.length`
 * @param {unknown} member
 * @returns {any}
 */
export function withMember(value, path, member) {
  return changed(value, steps(path), member) ?? {};
}

/** @param {any} value @param {string[]} path @param {unknown} member @returns {any} */
function changed(value, [step, ...rest], member) {
  if (step === undefined) return member;
  const inner = changed(value?.[step], rest, member);
  if (Array.isArray(value)) return value.map((one, at) => (String(at) === step ? inner : one));
  const { [step]: _, ...others } = value ?? {};
  if (inner !== undefined) return { ...value, [step]: inner };
  return Object.keys(others).length ? others : undefined;
}

/**
 * A field with the changes of a request, in whole or of its members.
 * @param {import("./rows.js").Rows} changes
 * @param {string} path of the field
 * @param {any} given in the scenario
 */
export function changedField(changes, path, given) {
  const whole = changes.get(path);
  return changes
    .within(path)
    .reduce(
      (value, name) => withMember(value, name.slice(path.length), changes.get(name)),
      whole === undefined ? given : whole,
    );
}

/** A document without members that are null. @param {any} value @returns {any} */
export function withoutNulls(value) {
  if (value === null || typeof value !== "object") return value;
  const members = Object.entries(value).filter(([, member]) => member !== null);
  return Object.fromEntries(members.map(([name, member]) => [name, withoutNulls(member)]));
}
