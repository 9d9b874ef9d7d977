//! Numbers as spreadsheets and reports write them.

/// Reads a number with a decimal point or comma, with or without separators of thousands, or an angle of degrees, minutes and seconds.
pub(crate) fn number(text: &str, has_decimal_comma: bool) -> Option<f64> {
    let text = text.trim();
    if text.contains(['°', '\'', '′', '"', '″']) {
        return sexagesimal(text, has_decimal_comma);
    }
    let plain: String =
        text.chars().filter(|sign| !matches!(sign, ' ' | '\u{a0}' | '\u{202f}' | '’')).collect();
    let (commas, points) = (plain.matches(',').count(), plain.matches('.').count());
    let decimal = match (commas, points) {
        (0, _) if !has_decimal_comma || points <= 1 => plain,
        // With both, the last one is the decimal sign.
        (1.., 1..) if plain.rfind(',') > plain.rfind('.') => plain.replace('.', "").replace(',', "."),
        (1.., 1..) => plain.replace(',', ""),
        (1, 0) if has_decimal_comma || !is_thousands(&plain) => plain.replace(',', "."),
        (1.., 0) if is_thousands(&plain) => plain.replace(',', ""),
        _ => return None,
    };
    // "inf", "nan" and hexadecimal numbers are none.
    let is_number =
        decimal.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b'e' | b'E'));
    decimal.parse().ok().filter(|value: &f64| is_number && value.is_finite())
}

/// True if commas divide groups of three digits.
fn is_thousands(text: &str) -> bool {
    let mut groups = text.trim_start_matches(['-', '+']).split(',');
    let first = groups.next().unwrap_or_default();
    (1..=3).contains(&first.len())
        && groups.all(|group| group.len() == 3 && group.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Reads 12°30'15" as 12.504166...
fn sexagesimal(text: &str, has_decimal_comma: bool) -> Option<f64> {
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let mut total = 0.0;
    let mut rest = text;
    for (size, marks) in [(1.0, &['°'][..]), (60.0, &['\'', '′']), (3600.0, &['"', '″'])] {
        let Some(at) = rest.find(marks) else { continue };
        let part = number(&rest[..at], has_decimal_comma)
            .filter(|part| *part >= 0.0 && (size == 1.0 || *part < 60.0))?;
        total += part / size;
        rest = rest[at..].strip_prefix(marks)?.trim_start();
    }
    rest.is_empty().then_some(sign * total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_signs_thousands_and_minutes_are_read() {
        for (text, comma, value) in [
            ("1081.87", false, Some(1081.87)),
            ("1,081.87", false, Some(1081.87)),
            ("1.081,87", true, Some(1081.87)),
            ("1 081,87", true, Some(1081.87)),
            ("10,5", true, Some(10.5)),
            ("10,5", false, Some(10.5)),
            ("1,081", false, Some(1081.0)),
            ("1,081", true, Some(1.081)),
            ("-3e2", false, Some(-300.0)),
            ("12°30'", false, Some(12.5)),
            ("12° 30' 36\"", false, Some(12.51)),
            ("-0°30'", false, Some(-0.5)),
            ("12°75'", false, None),
            ("nan", false, None),
            ("inf", false, None),
            ("1e999", false, None),
            ("0x10", false, None),
            ("", false, None),
            ("n/a", false, None),
            ("1.2.3", false, None),
        ] {
            let read = number(text, comma);
            assert_eq!(read.is_some(), value.is_some(), "{text}");
            assert!(
                read.zip(value).is_none_or(|(read, value)| (read - value).abs() < 1e-12),
                "{text}: {read:?}"
            );
        }
    }
}
