//! Numbers and steps as texts.

/// A step in the unit that reads best, to three digits: `1 ms`, `0.25 ms`, `58.8 µs`.
pub fn step_text(step: f64) -> String {
    let (value, unit) = match step {
        step if step >= 1.0 => (step, "s"),
        step if step >= 9.995e-5 => (step * 1e3, "ms"),
        step => (step * 1e6, "µs"),
    };
    format!("{} {unit}", three_digits(value))
}

/// A number to three digits, without zeros at the end.
pub fn three_digits(value: f64) -> String {
    let text = digits(value, 3);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A number to `count` digits.
pub(super) fn digits(value: f64, count: i32) -> String {
    let whole_digits = value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32 + 1;
    let decimals = usize::try_from(count - whole_digits).unwrap_or(0).min(12);
    format!("{value:.decimals$}")
}
