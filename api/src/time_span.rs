//! Time spans as people write them.

use std::time::Duration;

use jiff::{Span, SpanRelativeTo};

/// A time span in the format of jiff: `90d`, `12h`, `1h 30m`, `500ms`, `0.5s`, or ISO 8601's `PT30S`; a number without a unit is seconds.
/// Days have 24 hours, weeks 7 days.
///
/// # Errors
/// In words, when it is none, or negative.
pub fn parse(text: &str) -> Result<Duration, String> {
    let invalid = || "must be a time span such as 30s, 500ms, 12h, 90d or 30 (seconds)".to_owned();
    if let Ok(seconds) = text.parse::<f64>() {
        return Duration::try_from_secs_f64(seconds).map_err(|_| invalid());
    }
    let span: Span = text.parse().map_err(|_| invalid())?;
    // Months and years have no length of their own, and are refused here.
    let duration = span.to_duration(SpanRelativeTo::days_are_24_hours()).map_err(|_| invalid())?;
    Duration::try_from(duration).map_err(|_| invalid())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_read_with_their_units_and_seconds_without() {
        for (text, seconds) in [
            ("30", 30.0),
            ("0.5", 0.5),
            ("30s", 30.0),
            ("0.5s", 0.5),
            ("500ms", 0.5),
            ("12h", 43_200.0),
            ("1h 30m", 5_400.0),
            ("90d", 90.0 * 86_400.0),
            ("2w", 14.0 * 86_400.0),
            ("PT30S", 30.0),
            ("0", 0.0),
        ] {
            assert_eq!(parse(text).unwrap(), Duration::from_secs_f64(seconds), "{text}");
        }
        for text in ["", "s", "-1s", "-1", "soon", "1e300", "NaN", "1y", "1mo", "30 x"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
