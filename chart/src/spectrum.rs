//! The picture of a full spectrum.

use drillsweep_quantity::columns::*;
use drillsweep_quantity::{UnitChoice, units};
use drillsweep_table::Table;
use serde_json::Value;

use crate::error::ChartError;
use crate::picture::axis::three_digits;
use crate::picture::{Drawing, Label, Line, LinePlot, Shade, VerticalAxis};
use crate::shown::{node_of, numbers, with_unit};
use crate::words::words;

/// Lines of a spectrum that are named in its picture.
const NAMED_LINES: usize = 6;

/// Lines nearer to zero frequency than this many bins belong to the mean, whatever the window.
const MEAN_BINS: f64 = 2.5;

/// The full spectrum of a node, with its highest lines named. The mean position is left out: it would dwarf the rest. What lies beyond
/// the frequency that the run's steps resolve is shaded, and no line there is named.
///
/// # Errors
/// The table is not a spectrum.
pub fn spectrum(table: &Table, title: &str, choice: &UnitChoice) -> Result<Drawing, ChartError> {
    let unit = choice.shown(AMPLITUDE.name).unwrap_or(units::WIDTH.shown);
    let width = |value: f64| unit.of(value);
    let (frequency, amplitude) = (numbers(table, FREQUENCY.name)?, numbers(table, AMPLITUDE.name)?);
    let attribute = |name: &str| table.attributes.get(name).and_then(Value::as_f64);
    let mean_width = MEAN_BINS * attribute("resolution").unwrap_or(0.0);
    let is_motion = |frequency: f64| frequency.abs() > mean_width;
    let points = frequency.iter().zip(&amplitude).map(|(frequency, amplitude)| {
        [*frequency, if is_motion(*frequency) { width(*amplitude) } else { f64::NAN }]
    });
    let peaks = table.attributes.get("peaks").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    // A line between two bins is higher than the curve; its name stands on the curve all the same.
    let bin = attribute("resolution").unwrap_or(0.0);
    let curve_at = |line: f64| {
        let near =
            frequency.iter().zip(&amplitude).filter(|(frequency, _)| (**frequency - line).abs() <= bin);
        width(near.fold(0.0, |most: f64, (_, amplitude)| most.max(*amplitude)))
    };
    let resolved = attribute("resolved_hz");
    let is_resolved = |frequency: f64| resolved.is_none_or(|resolved| frequency.abs() <= resolved);
    let reaches_beyond = frequency.iter().any(|frequency| !is_resolved(*frequency));
    let shade = resolved.filter(|_| reaches_beyond).map(|beyond| Shade {
        beyond,
        name: format!("not resolved by the step (±{} Hz)", three_digits(beyond)),
    });
    let label = |peak: &Value| {
        let (frequency, amplitude) = (peak["frequency"].as_f64()?, width(peak["amplitude"].as_f64()?));
        // Hundredths of a millimetre, three digits of other units.
        let size = match unit == units::WIDTH.shown {
            true => format!("{amplitude:.2}"),
            false => three_digits(amplitude),
        };
        let text = format!("{frequency:+.2} Hz, {size} {}", unit.symbol).replace('-', "−");
        (is_motion(frequency) && is_resolved(frequency))
            .then(|| Label { at: [frequency, curve_at(frequency)], text })
    };
    let window = table.attributes.get("window").and_then(Value::as_str).unwrap_or_default();
    let plot = LinePlot {
        title: title.to_owned(),
        subtitle: format!(
            "{}, {} samples, {window} window, without the mean; + forward, − backward whirl",
            node_of(table, choice),
            attribute("samples").unwrap_or(0.0)
        ),
        x_label: with_unit(FREQUENCY.name, &UnitChoice::default()),
        y_label: format!("{} [{}]", words(AMPLITUDE.name), unit.symbol),
        lines: vec![Line { points: points.collect(), ..Line::default() }],
        vertical: VerticalAxis::FromZero,
        labels: peaks.iter().filter_map(label).take(NAMED_LINES).collect(),
        shade,
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

#[cfg(test)]
mod tests {
    use drillsweep_table::Column;
    use serde_json::json;

    use super::*;

    fn column(values: &[f64]) -> Column {
        Column::Number(values.to_vec())
    }

    #[test]
    fn the_mean_of_a_spectrum_is_left_out_and_lines_are_named() {
        let frequency: Vec<f64> = (-100..=100).map(|k| f64::from(k) * 0.1).collect();
        let amplitude: Vec<f64> = frequency
            .iter()
            .map(|f| {
                if f.abs() < 0.05 {
                    0.037
                } else if (f - 2.0).abs() < 0.05 {
                    0.003
                } else {
                    1e-5
                }
            })
            .collect();
        let table = Table::default()
            .with("frequency", column(&frequency))
            .with("amplitude", column(&amplitude))
            .attribute("resolution", 0.1)
            .attribute("samples", 1000)
            .attribute("window", "hann")
            .attribute("node", 49)
            .attribute("measured_depth", 57.73)
            .attribute(
                "peaks",
                json!([{"frequency": 0.0, "amplitude": 0.037}, {"frequency": 2.04, "amplitude": 0.0035}]),
            );
        let svg = spectrum(&table, "spectrum", &UnitChoice::default()).unwrap().svg();
        assert!(svg.contains("+2.04 Hz, 3.50 mm") && svg.contains("node 49 at 57.73 m"), "{svg}");
        let field = spectrum(&table, "", &UnitChoice::parse("field").unwrap()).unwrap().svg();
        assert!(field.contains("+2.04 Hz, 0.138 in") && field.contains("node 49 at 189.40 ft"), "{field}");
        assert!(!svg.contains("37.00 mm") && !svg.contains(">30<"), "the mean does not stretch the axis");
    }

    #[test]
    fn frequencies_that_the_step_does_not_resolve_are_shaded_and_no_line_there_is_named() {
        let frequency: Vec<f64> = (-100..=100).map(|k| f64::from(k) * 0.1).collect();
        let peaks = [(-2.0, 3e-3), (6.0, 2e-3)].map(|(f, a)| json!({"frequency": f, "amplitude": a}));
        let table = Table::default()
            .with("amplitude", column(&vec![1e-3; frequency.len()]))
            .with("frequency", column(&frequency))
            .attribute("resolution", 0.1)
            .attribute("peaks", peaks.to_vec());
        let words = "not resolved by the step";
        let unmarked = spectrum(&table, "", &UnitChoice::default()).unwrap().svg();
        assert!(unmarked.contains("+6.00 Hz") && !unmarked.contains(words));
        let all = spectrum(&table.clone().attribute("resolved_hz", 20.0), "", &UnitChoice::default())
            .unwrap()
            .svg();
        assert!(!all.contains(words), "all that is shown is resolved");
        let drawing = spectrum(&table.attribute("resolved_hz", 5.0), "", &UnitChoice::default()).unwrap();
        let svg = drawing.svg();
        assert!(svg.contains(words) && svg.contains("(±5") && svg.contains(r#"class="shade""#), "{svg}");
        assert!(svg.contains("−2.00 Hz") && !svg.contains("+6.00 Hz"), "{svg}");
        assert!(drawing.png(400).is_ok());
    }
}
