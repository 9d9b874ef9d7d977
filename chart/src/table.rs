//! Pictures of tables: which columns are shown, in which units, under which names.
//!
//! Each function takes the very table that is served as JSON or CSV and gives a [`Drawing`] of it.

use drillsweep_api::problem::ProblemDetails;
use drillsweep_api::view::verification::{Findings, is_bias_column};
use drillsweep_table::quantity::columns::*;
use drillsweep_table::quantity::{self, Name, Unit, units};
use drillsweep_table::{Column, Table};
use indexmap::{IndexMap, IndexSet};
use serde_json::Value;

use crate::picture::axis::three_digits;
use crate::picture::{Drawing, Label, Line, LinePlot, MapPoint, OrbitPlot, Shade, SweepMap, VerticalAxis};

/// Lines of a spectrum that are named in its picture.
const NAMED_LINES: usize = 6;

/// Lines nearer to zero frequency than so many bins belong to the mean, whatever the window.
const MEAN_BINS: f64 = 2.5;

/// Where and how the hole stands about a node, for the picture of its orbit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hole {
    /// The radius at which the string touches the wall \[m\].
    pub clearance: Option<f64>,
    /// Where the low side lies, as an angle from u towards v \[rad\]; none where the hole is vertical.
    pub low_side: Option<f64>,
}

/// The title of a picture: what it shows, and at which parameters.
pub fn caption(what: &str, parameters: &IndexMap<String, f64>) -> String {
    let value = |(name, value): (&String, &f64)| {
        let unit = kept_in(name).map_or_else(String::new, |unit| format!(" {unit}"));
        format!(", {} {}{unit}", words(name), three_digits(*value))
    };
    let values: String = parameters.iter().map(value).collect();
    format!("{what}{values}")
}

/// Values along the string, depth downwards: C_f, or the first of the `fields` that are given.
///
/// # Errors
/// A problem that names the columns there are, where a field is none of them.
pub fn profile(
    table: &Table,
    fields: Option<&[String]>,
    title: &str,
) -> Result<Drawing, Box<ProblemDetails>> {
    let fallback = if table.columns.contains_key(FRICTION_COEFFICIENT.name) {
        FRICTION_COEFFICIENT.name
    } else {
        ECCENTRICITY.name
    };
    let names: Vec<&str> = match fields {
        Some(fields) => fields.iter().map(String::as_str).collect(),
        None => vec![fallback],
    };
    let (top, bottom) =
        (numbers(table, MEASURED_DEPTH_TOP.name)?, numbers(table, MEASURED_DEPTH_BOTTOM.name)?);
    let shown = Shown::of(table, &names)?;
    let line = |(name, values): (&str, Vec<f64>)| Line {
        name: words(name),
        // A value holds for its whole element.
        points: values
            .iter()
            .enumerate()
            .flat_map(|(e, value)| [[*value, top[e]], [*value, bottom[e]]])
            .collect(),
        is_marked: false,
    };
    let plot = LinePlot {
        title: title.to_owned(),
        x_label: shown.label(),
        y_label: with_unit(MEASURED_DEPTH.name),
        lines: shown.columns.into_iter().map(line).collect(),
        vertical: VerticalAxis::Depth,
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

/// Columns of a history over time: u and v, or the `fields` that are given.
///
/// # Errors
/// A problem that names the columns there are, where a field is none of them.
pub fn history(
    table: &Table,
    fields: Option<&[String]>,
    title: &str,
) -> Result<Drawing, Box<ProblemDetails>> {
    let is_lateral =
        |name: &&str| Name::parse(name).is_some_and(|name| name.quantity == &U || name.quantity == &V);
    let names: Vec<&str> = match fields {
        Some(fields) => fields.iter().map(String::as_str).collect(),
        None => table.columns.keys().map(String::as_str).filter(is_lateral).collect(),
    };
    let time = numbers(table, TIME.name)?;
    let shown = Shown::of(table, &names)?;
    let y_label = shown.label();
    let line = |(name, values): (&str, Vec<f64>)| Line {
        name: words(name),
        points: time.iter().zip(values).map(|(time, value)| [*time, value]).collect(),
        is_marked: false,
    };
    let plot = LinePlot {
        title: title.to_owned(),
        subtitle: node_of(table),
        x_label: with_unit(TIME.name),
        y_label,
        lines: shown.columns.into_iter().map(line).collect(),
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

/// The path of a node across its hole: the whole hole, or with `zoom` the motion alone with the hole as an inset; unless that is said,
/// the motion alone where it is below a tenth of the hole.
///
/// # Errors
/// When the table is not an orbit.
pub fn orbit(
    table: &Table,
    hole: &Hole,
    title: &str,
    zoom: Option<bool>,
) -> Result<Drawing, Box<ProblemDetails>> {
    let (time, u, v) = (numbers(table, TIME.name)?, numbers(table, U.name)?, numbers(table, V.name)?);
    let window = match (time.first(), time.last()) {
        (Some(first), Some(last)) => format!(", {first:.2} to {last:.2} s"),
        _ => String::new(),
    };
    let plot = OrbitPlot {
        title: title.to_owned(),
        subtitle: format!("{}{window}; the mark is the end", node_of(table)),
        path: u.iter().zip(v).map(|(u, v)| [shown(*u), shown(v)]).collect(),
        wall: hole.clearance.map(shown),
        low_side: hole.low_side,
        unit: units::WIDTH.shown.symbol.to_owned(),
        zoom,
    };
    Ok(plot.drawing())
}

/// The full spectrum of a node, with its highest lines named. The mean position is left out: it would dwarf the rest. What lies beyond
/// the frequency that the run's steps resolve is shaded, and no line there is named.
///
/// # Errors
/// When the table is not a spectrum.
pub fn spectrum(table: &Table, title: &str) -> Result<Drawing, Box<ProblemDetails>> {
    let (frequency, amplitude) = (numbers(table, FREQUENCY.name)?, numbers(table, AMPLITUDE.name)?);
    let attribute = |name: &str| table.attributes.get(name).and_then(Value::as_f64);
    let mean_width = MEAN_BINS * attribute("resolution").unwrap_or(0.0);
    let is_motion = |frequency: f64| frequency.abs() > mean_width;
    let points = frequency.iter().zip(&amplitude).map(|(frequency, amplitude)| {
        [*frequency, if is_motion(*frequency) { shown(*amplitude) } else { f64::NAN }]
    });
    let peaks = table.attributes.get("peaks").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    // A line between two bins is higher than the curve; its name stands on the curve all the same.
    let bin = attribute("resolution").unwrap_or(0.0);
    let curve_at = |line: f64| {
        let near =
            frequency.iter().zip(&amplitude).filter(|(frequency, _)| (**frequency - line).abs() <= bin);
        shown(near.fold(0.0, |most: f64, (_, amplitude)| most.max(*amplitude)))
    };
    let resolved = attribute("resolved_hz");
    let is_resolved = |frequency: f64| resolved.is_none_or(|resolved| frequency.abs() <= resolved);
    let reaches_beyond = frequency.iter().any(|frequency| !is_resolved(*frequency));
    let shade = resolved.filter(|_| reaches_beyond).map(|beyond| Shade {
        beyond,
        name: format!("beyond what the step resolves (±{} Hz)", three_digits(beyond)),
    });
    let label = |peak: &Value| {
        let (frequency, amplitude) = (peak["frequency"].as_f64()?, shown(peak["amplitude"].as_f64()?));
        let text = format!("{frequency:+.2} Hz, {amplitude:.2} mm").replace('-', "−");
        (is_motion(frequency) && is_resolved(frequency))
            .then(|| Label { at: [frequency, curve_at(frequency)], text })
    };
    let window = table.attributes.get("window").and_then(Value::as_str).unwrap_or_default();
    let plot = LinePlot {
        title: title.to_owned(),
        subtitle: format!(
            "{}, {} samples, {window} window, without the mean; + forward, − backward whirl",
            node_of(table),
            attribute("samples").unwrap_or(0.0)
        ),
        x_label: with_unit(FREQUENCY.name),
        y_label: format!("{} [{}]", words(AMPLITUDE.name), units::WIDTH.shown.symbol),
        lines: vec![Line { points: points.collect(), ..Line::default() }],
        vertical: VerticalAxis::FromZero,
        labels: peaks.iter().filter_map(label).take(NAMED_LINES).collect(),
        shade,
    };
    Ok(plot.drawing())
}

/// The table of a sweep: the first of the `fields` over the sweep's parameters. Over one parameter lines, one a field;
/// over two a map; over more a map over the first two, for which each place shows its last point. Points that are verified
/// are marked on a map, and what that shows stands below the title.
///
/// # Errors
/// A problem that names the columns there are, where a field is none of them, or none is given.
pub fn sweep(
    table: &Table,
    parameters: &IndexSet<String>,
    fields: Option<&[String]>,
    findings: &Findings,
    title: &str,
) -> Result<Drawing, Box<ProblemDetails>> {
    let fields = fields.unwrap_or_default();
    let Some(first) = fields.first() else {
        let detail = format!(
            "a picture needs the column that it shows; there are {}",
            numeric(table).filter(|name| !parameters.contains(*name)).collect::<Vec<_>>().join(", ")
        );
        return Err(ProblemDetails::invalid_parameter("fields", None, detail).into());
    };
    let varied: Vec<&str> =
        parameters.iter().map(String::as_str).filter(|name| is_varied(table, name)).collect();
    let (x, y) = match varied.as_slice() {
        [] => (ORDINAL.name, None),
        [only] => (*only, None),
        [first, second, ..] => (*first, Some(*second)),
    };
    let xs = numbers(table, x)?;
    let verified = findings.caption(first);
    let Some(y) = y else {
        let names: Vec<&str> = fields.iter().map(String::as_str).collect();
        let shown = Shown::of(table, &names)?;
        let y_label = shown.label();
        let line = |(name, values): (&str, Vec<f64>)| {
            let mut points: Vec<[f64; 2]> = xs.iter().zip(values).map(|(x, value)| [*x, value]).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            Line { name: words(name), points, is_marked: true }
        };
        let plot = LinePlot {
            title: title.to_owned(),
            subtitle: verified.unwrap_or_default(),
            x_label: with_unit(x),
            y_label,
            lines: shown.columns.into_iter().map(line).collect(),
            ..LinePlot::default()
        };
        return Ok(plot.drawing());
    };
    let ys = numbers(table, y)?;
    let mut shown = Shown::of(table, &[first.as_str()])?;
    let value_label = shown.label();
    let (_, values) = shown.columns.swap_remove(0);
    let is_marked = verified_rows(table);
    let points = xs.iter().zip(ys).zip(values).zip(is_marked);
    let points = points.map(|(((x, y), value), is_marked)| MapPoint { x: *x, y, value, is_marked });
    let more = match varied.len() {
        2 => None,
        more => Some(format!("{} more parameters vary; each place shows one of its points", more - 2)),
    };
    let verified = verified.map(|verified| format!("diamonds: {verified}"));
    let subtitle = verified.into_iter().chain(more).collect::<Vec<_>>().join("; ");
    let plot = SweepMap {
        title: title.to_owned(),
        subtitle,
        x_label: with_unit(x),
        y_label: with_unit(y),
        value_label,
        points: points.collect(),
    };
    Ok(plot.drawing())
}

/// Which rows of a sweep's table are of points that are verified: those with the bias of any statistic.
fn verified_rows(table: &Table) -> Vec<bool> {
    let mut is_verified = vec![false; table.rows()];
    for (_, column) in table.columns.iter().filter(|(name, _)| is_bias_column(name)) {
        if let Column::Number(biases) = column {
            is_verified
                .iter_mut()
                .zip(biases)
                .for_each(|(is_verified, bias)| *is_verified |= bias.is_finite());
        }
    }
    is_verified
}

/// Columns that are shown on one axis, in its unit.
struct Shown<'t> {
    columns: Vec<(&'t str, Vec<f64>)>,
    unit: Option<Unit>,
}

impl<'t> Shown<'t> {
    /// The numeric columns of these names; they must have one unit.
    fn of(table: &'t Table, names: &[&str]) -> Result<Self, Box<ProblemDetails>> {
        let mut columns = Vec::new();
        for name in names {
            let Some((name, _)) = table.columns.get_key_value(*name) else {
                return Err(ProblemDetails::no_such_column(table, name).into());
            };
            if names.first().is_some_and(|first| quantity::unit(first) != quantity::unit(name)) {
                let detail =
                    format!("the columns of a picture must have one unit; {name} has another than the first");
                return Err(ProblemDetails::invalid_parameter("fields", Some(name), detail).into());
            }
            columns.push((name.as_str(), numbers(table, name)?));
        }
        let unit = names.first().and_then(|name| shown_in(name));
        if let Some(unit) = unit {
            for value in columns.iter_mut().flat_map(|(_, values)| values) {
                *value = unit.of(*value);
            }
        }
        Ok(Shown { columns, unit })
    }

    /// What stands at the axis.
    fn label(&self) -> String {
        let name = match self.columns.as_slice() {
            [(only, _)] => words(only),
            [] => String::new(),
            _ if self.unit == Some(units::WIDTH.shown) => "displacement".to_owned(),
            _ => "value".to_owned(),
        };
        match self.unit {
            Some(unit) => format!("{name} [{}]", unit.symbol),
            None => name,
        }
    }
}

/// The unit in which engineers read a column; none of ratios and numbers of things.
fn shown_in(name: &str) -> Option<Unit> {
    Name::parse(name)?.units().filter(|units| *units != &units::RATIO).map(|units| units.shown)
}

/// The unit in which a column is kept; none of ratios and numbers of things.
fn kept_in(name: &str) -> Option<&'static str> {
    Name::parse(name)?.unit().filter(|unit| *unit != units::RATIO.kept)
}

/// A length across the hole in the unit in which it is shown.
fn shown(width: f64) -> f64 {
    units::WIDTH.shown.of(width)
}

/// A column's name in words.
fn words(name: &str) -> String {
    Name::parse(name).map_or_else(|| name.replace('_', " "), |name| name.to_string())
}

fn with_unit(name: &str) -> String {
    match kept_in(name) {
        Some(unit) => format!("{} [{unit}]", words(name)),
        None => words(name),
    }
}

/// The node that a table is of.
fn node_of(table: &Table) -> String {
    let attribute = |name: &str| table.attributes.get(name).and_then(Value::as_f64);
    match (attribute(NODE.name), attribute(MEASURED_DEPTH.name)) {
        (Some(node), Some(depth)) => format!("node {node} at {depth:.2} m"),
        _ => String::new(),
    }
}

/// The values of a numeric column; missing ones are not finite.
fn numbers(table: &Table, name: &str) -> Result<Vec<f64>, Box<ProblemDetails>> {
    match table.columns.get(name) {
        Some(column) => column.numbers().ok_or_else(|| {
            let detail = "is a column of texts, which a picture cannot show";
            ProblemDetails::invalid_parameter("fields", Some(name), detail).into()
        }),
        None => Err(ProblemDetails::no_such_column(table, name).into()),
    }
}

fn numeric(table: &Table) -> impl Iterator<Item = &str> {
    table
        .columns
        .iter()
        .filter(|(_, column)| !matches!(column, Column::Text(_)))
        .map(|(name, _)| name.as_str())
}

fn is_varied(table: &Table, name: &str) -> bool {
    numbers(table, name).is_ok_and(|values| values.windows(2).any(|pair| pair[0] != pair[1]))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn column(values: &[f64]) -> Column {
        Column::Number(values.to_vec())
    }

    #[test]
    fn columns_of_one_picture_have_one_unit_and_exist() {
        let table = Table::default()
            .with("measured_depth_top", column(&[0.0, 10.0]))
            .with("measured_depth_bottom", column(&[10.0, 20.0]))
            .with("friction_coefficient", column(&[0.01, 0.02]))
            .with("torque", column(&[9940.0, 5219.0]))
            .with("regime", Column::Text(vec![None, None]));
        let svg = profile(&table, None, "C_f").unwrap().svg();
        assert!(svg.contains("friction coefficient C_f") && svg.contains("measured depth [m]"));
        assert!(profile(&table, Some(&["torque".to_owned()]), "").unwrap().svg().contains("torque [kN m]"));
        for fields in [&["torque", "friction_coefficient"][..], &["nothing"], &["regime"]] {
            let fields: Vec<String> = fields.iter().map(|field| (*field).to_owned()).collect();
            let problem = profile(&table, Some(&fields), "").unwrap_err();
            assert_eq!((problem.status, problem.errors[0].parameter.as_deref()), (400, Some("fields")));
        }
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
        let svg = spectrum(&table, "spectrum").unwrap().svg();
        assert!(svg.contains("+2.04 Hz, 3.50 mm") && svg.contains("node 49 at 57.73 m"), "{svg}");
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
        let words = "beyond what the step resolves";
        let unmarked = spectrum(&table, "").unwrap().svg();
        assert!(unmarked.contains("+6.00 Hz") && !unmarked.contains(words));
        let all = spectrum(&table.clone().attribute("resolved_hz", 20.0), "").unwrap().svg();
        assert!(!all.contains(words), "all that is shown is resolved");
        let drawing = spectrum(&table.attribute("resolved_hz", 5.0), "").unwrap();
        let svg = drawing.svg();
        assert!(svg.contains(words) && svg.contains("(±5") && svg.contains(r#"class="shade""#), "{svg}");
        assert!(svg.contains("−2.00 Hz") && !svg.contains("+6.00 Hz"), "{svg}");
        assert!(drawing.png(400).is_ok());
    }

    #[test]
    fn a_sweep_is_lines_over_one_parameter_and_a_map_over_two() {
        let parameters: IndexSet<String> = ["flow_rate".to_owned(), "mud_density".to_owned()].into();
        let table = |density: &[f64]| {
            Table::default()
                .with("ordinal", Column::Integer((1..=4).map(Some).collect()))
                .with("flow_rate", column(&[0.01, 0.01, 0.04, 0.04]))
                .with("mud_density", column(density))
                .with("orbit_radius_rms_49", column(&[0.001, 0.002, 0.003, f64::NAN]))
        };
        let none = Findings::default();
        let fields = ["orbit_radius_rms_49".to_owned()];
        let map = sweep(&table(&[1200.0, 1500.0, 1200.0, 1500.0]), &parameters, Some(&fields), &none, "")
            .unwrap()
            .svg();
        assert!(map.contains(r#"class="map""#) && map.contains("orbit radius rms 49 [mm]"));
        assert!(map.contains("flow rate [m3/s]") && map.contains("mud density [kg/m3]"));
        let lines = sweep(&table(&[1200.0; 4]), &parameters, Some(&fields), &none, "").unwrap().svg();
        assert!(lines.contains(r#"class="series""#) && !lines.contains("mud density"));
        let problem = sweep(&table(&[1200.0; 4]), &parameters, None, &none, "").unwrap_err();
        assert!(problem.detail.contains("orbit_radius_rms_49"), "{}", problem.detail);
    }
}
