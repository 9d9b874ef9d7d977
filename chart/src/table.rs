//! Pictures of tables: which columns are shown, in which units, under which names.
//!
//! Each function takes the very table that is served as JSON or CSV and gives a [`Drawing`] of it.

use drillsweep_api::problem::ProblemDetails;
use drillsweep_api::view::verification::{Findings, is_bias_column};
use drillsweep_table::quantity::columns::*;
use drillsweep_table::quantity::{self, Name, Quantity, Unit, Variant, units};
use drillsweep_table::{Column, Table};
use indexmap::{IndexMap, IndexSet};
use serde_json::Value;

use crate::picture::axis::three_digits;
use crate::picture::{
    Drawing, Label, Line, LinePlot, MapPoint, OrbitPlot, Shade, Spacing, SweepMap, VerticalAxis,
};

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
    let value = |(name, value): (&String, &f64)| format!(", {} {}", words(name), amount(name, *value));
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

/// The columns of a history that its picture shows, out of its `layout`: the time, and u and v, and rotation speed and torque of the lowest
/// node, or the `fields` that are given.
///
/// # Errors
/// A problem that names the columns there are, where a field is none of them.
pub fn shown_of_history(layout: &Table, fields: Option<&[String]>) -> Result<Table, Box<ProblemDetails>> {
    let rotation =
        ROTATION.iter().filter(|_| fields.is_none()).filter_map(|quantity| lowest(layout, quantity));
    let lines = lines_of_history(layout, fields).into_iter().chain(rotation);
    let mut names: Vec<String> = lines.map(str::to_owned).collect();
    names.push(TIME.name.to_owned());
    layout.select(&names).map_err(|missing| Box::new(ProblemDetails::no_such_column(layout, &missing)))
}

/// Where a recorded node lies, for the legend of its history.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Place {
    /// Number of the node, 1 at the top.
    pub node: u32,
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Where the low side lies, as an angle from u towards v \[rad\]; none where the hole is vertical.
    pub low_side: Option<f64>,
}

/// Columns of a history over time: u and v, or the `fields` that are given. Where nothing is asked for and the string twists, the
/// rotation speed and the torque of the lowest node stand below. The legend says of each line where its node lies and which way the motion goes, for
/// nodes that are among the `places`.
///
/// # Errors
/// A problem that names the columns there are, where a field is none of them.
pub fn history(
    table: &Table,
    fields: Option<&[String]>,
    places: &[Place],
    title: &str,
) -> Result<Drawing, Box<ProblemDetails>> {
    let names = lines_of_history(table, fields);
    let shown = Shown::of(table, &names)?;
    let y_label = shown.label();
    let mut drawing = over_time(table, shown, &y_label, places, [title, &node_of(table)])?;
    if fields.is_some() {
        return Ok(drawing);
    }
    for quantity in ROTATION {
        let Some(name) = lowest(table, quantity).filter(|name| varies(table, name)) else { continue };
        // Drillers read rotation speeds in rpm.
        let unit = match quantity.units {
            Some(units) if *units == units::ANGULAR_SPEED => Some(units.field),
            _ => shown_in(name),
        };
        let shown = Shown::within(table, &[name], unit)?;
        let y_label = match unit {
            Some(unit) => format!("{} [{}]", quantity.label, unit.symbol),
            None => quantity.label.to_owned(),
        };
        drawing = drawing.above(over_time(table, shown, &y_label, places, ["", ""])?);
    }
    Ok(drawing)
}

/// What stands below the lateral motion of a string that twists.
const ROTATION: [&Quantity; 2] = [&ROTATION_SPEED, &TORQUE];

fn over_time(
    table: &Table,
    shown: Shown,
    y_label: &str,
    places: &[Place],
    [title, subtitle]: [&str; 2],
) -> Result<Drawing, Box<ProblemDetails>> {
    let time = numbers(table, TIME.name)?;
    let line = |(name, values): (&str, Vec<f64>)| Line {
        name: at_place(name, places),
        points: time.iter().zip(values).map(|(time, value)| [*time, value]).collect(),
        is_marked: false,
    };
    let plot = LinePlot {
        title: title.to_owned(),
        subtitle: subtitle.to_owned(),
        x_label: with_unit(TIME.name),
        y_label: y_label.to_owned(),
        lines: shown.columns.into_iter().map(line).collect(),
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

/// The column of a quantity of the lowest node that has one.
fn lowest<'t>(table: &'t Table, quantity: &Quantity) -> Option<&'t str> {
    let columns = table.columns.keys().filter_map(|name| {
        let parsed = Name::parse(name)?;
        (parsed.quantity == quantity && parsed.variant == Variant::Value).then_some((parsed.node?, name))
    });
    columns.max_by_key(|(node, _)| *node).map(|(_, name)| name.as_str())
}

/// Whether the numbers of a column are not all the same.
fn varies(table: &Table, name: &str) -> bool {
    let values = table.columns.get(name).and_then(Column::numbers);
    values.is_some_and(|values| values.iter().any(|value| *value != values[0]))
}

/// What a column of a node is, where the node lies, and which way it moves.
fn at_place(name: &str, places: &[Place]) -> String {
    let Some(parsed) = Name::parse(name) else { return words(name) };
    let Some(place) = places.iter().find(|place| Some(place.node as usize) == parsed.node) else {
        return words(name);
    };
    let what = parsed.quantity.label;
    let direction = direction(parsed.quantity, place.low_side);
    format!("{what} at {} m MD{direction}", grouped(place.measured_depth))
}

/// Which way a lateral displacement or speed counts, seen down the hole: u points to e1 and v to e2 (docs/model/well.md), and with
/// e1 on the low side e2 is on the left.
fn direction(quantity: &Quantity, low_side: Option<f64>) -> String {
    /// Directions this near to one that has a name bear it \[deg\].
    const NEAR: f64 = 1.0;
    let own = match quantity {
        quantity if quantity == &U || quantity == &U_RATE => 0.0,
        quantity if quantity == &V || quantity == &V_RATE => 90.0,
        quantity if quantity == &W || quantity == &W_RATE => return ", axial, downhole".to_owned(),
        _ => return String::new(),
    };
    let Some(low_side) = low_side else {
        return format!(", lateral, along {}", if own == 0.0 { "e1" } else { "e2" });
    };
    // From the low side to the left, within half a turn either way.
    let angle = (own - low_side.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
    let towards = match angle.abs() {
        off if off < NEAR => "to the low side".to_owned(),
        off if off > 180.0 - NEAR => "to the high side".to_owned(),
        off => {
            let side = if angle > 0.0 { "left" } else { "right" };
            if (off - 90.0).abs() < NEAR {
                format!("to the {side}")
            } else {
                format!("{off:.0}° {side} of the low side")
            }
        }
    };
    format!(", lateral, {towards}")
}

/// A depth in metres to the decimetre, whole ones from 1000 m on with their thousands apart.
fn grouped(depth: f64) -> String {
    let whole = depth.round() as i64;
    if whole >= 1000 { format!("{} {:03}", whole / 1000, whole % 1000) } else { format!("{depth:.1}") }
}

fn lines_of_history<'t>(table: &'t Table, fields: Option<&'t [String]>) -> Vec<&'t str> {
    let is_lateral =
        |name: &&str| Name::parse(name).is_some_and(|name| name.quantity == &U || name.quantity == &V);
    match fields {
        Some(fields) => fields.iter().map(String::as_str).collect(),
        None => table.columns.keys().map(String::as_str).filter(is_lateral).collect(),
    }
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

/// What of a sweep is shown, and how.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepView {
    /// How the values of parameters are placed on a map.
    pub spacing: Spacing,
    /// Parameters that are held, with their values in the units of the table.
    pub slice: Vec<(String, f64)>,
}

/// The table of a sweep: the first of the `fields` over the sweep's parameters. Over one parameter lines, one a field;
/// over two a map. Over more, a map over the first two that the view's slice does not hold; further ones are held at the first value that
/// they have, and the picture says so. Those of a design that is no grid cannot be held: all points are shown, which it says as
/// well. Texts have a colour each, the most frequent eight or, with others, seven. Points that are verified are marked on a map, and
/// what that shows stands below the title.
///
/// # Errors
/// A problem that names the columns there are, where a field is none of them, or none is given; or the values that there are, where
/// the slice is at none of them.
pub fn sweep(
    table: &Table,
    parameters: &IndexSet<String>,
    fields: Option<&[String]>,
    findings: &Findings,
    title: &str,
    view: &SweepView,
) -> Result<Drawing, Box<ProblemDetails>> {
    let fields = fields.unwrap_or_default();
    let Some(first) = fields.first() else {
        let detail = format!(
            "a picture needs the column that it shows; there are {}",
            numeric(table).filter(|name| !parameters.contains(*name)).collect::<Vec<_>>().join(", ")
        );
        return Err(ProblemDetails::invalid_parameter("fields", None, detail).into());
    };
    let Slice { rows, axes, notes } = Slice::of(table, parameters, &view.slice)?;
    let x = axes.first().copied().unwrap_or(ORDINAL.name);
    let pick = |values: Vec<f64>| -> Vec<f64> { rows.iter().map(|row| values[*row]).collect() };
    let xs = pick(axis(table, x)?);
    let texts = match table.columns.get(first) {
        Some(Column::Text(texts)) => Some(texts),
        _ => None,
    };
    let verified = findings.caption(first);
    if axes.len() < 2 && texts.is_none() {
        let names: Vec<&str> = fields.iter().map(String::as_str).collect();
        let shown = Shown::of(table, &names)?;
        let y_label = shown.label();
        let line = |(name, values): (&str, Vec<f64>)| {
            let mut points: Vec<[f64; 2]> =
                xs.iter().zip(pick(values)).map(|(x, value)| [*x, value]).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            Line { name: words(name), points, is_marked: true }
        };
        let plot = LinePlot {
            title: title.to_owned(),
            subtitle: notes.into_iter().chain(verified).collect::<Vec<_>>().join("; "),
            x_label: with_unit(x),
            y_label,
            lines: shown.columns.into_iter().map(line).collect(),
            ..LinePlot::default()
        };
        return Ok(plot.drawing());
    }
    let ys = match axes.get(1) {
        Some(y) => pick(axis(table, y)?),
        None => vec![0.0; rows.len()],
    };
    let (kinds, values, value_label) = match texts {
        Some(texts) => {
            let texts: Vec<Option<&str>> = rows.iter().map(|row| texts[*row].as_deref()).collect();
            let (kinds, values) = kinds(&texts);
            (kinds, values, words(first))
        }
        None => {
            let mut shown = Shown::of(table, &[first.as_str()])?;
            let value_label = shown.label();
            let (_, values) = shown.columns.swap_remove(0);
            (Vec::new(), pick(values), value_label)
        }
    };
    let is_marked = verified_rows(table);
    let points = xs.iter().zip(ys).zip(values).zip(&rows);
    let points =
        points.map(|(((x, y), value), row)| MapPoint { x: *x, y, value, is_marked: is_marked[*row] });
    let verified = verified.map(|verified| format!("diamonds: {verified}"));
    let plot = SweepMap {
        title: title.to_owned(),
        subtitle: notes.into_iter().chain(verified).collect::<Vec<_>>().join("; "),
        x_label: with_unit(x),
        y_label: axes.get(1).map(|y| with_unit(y)).unwrap_or_default(),
        value_label,
        points: points.collect(),
        words: kinds,
        spacing: view.spacing,
    };
    Ok(plot.drawing())
}

/// What of a sweep's table one picture shows.
struct Slice<'t> {
    /// Rows of the table, in order.
    rows: Vec<usize>,
    /// The parameters that it is over: two, or fewer where fewer vary.
    axes: Vec<&'t str>,
    /// Where it is, in words.
    notes: Vec<String>,
}

impl<'t> Slice<'t> {
    fn of(
        table: &Table,
        parameters: &'t IndexSet<String>,
        held: &[(String, f64)],
    ) -> Result<Self, Box<ProblemDetails>> {
        let mut slice = Slice { rows: (0..table.rows()).collect(), axes: Vec::new(), notes: Vec::new() };
        for (name, value) in held {
            if !parameters.contains(name) {
                let names: Vec<&str> = parameters.iter().map(String::as_str).collect();
                let detail = format!("the sweep has no such parameter; it has {}", names.join(", "));
                return Err(ProblemDetails::invalid_parameter("slice", Some(name), detail).into());
            }
            slice.hold(name, &numbers(table, name)?, *value)?;
        }
        let is_held = |name: &&String| held.iter().any(|(held, _)| held == *name);
        let free: Vec<&String> = parameters.iter().filter(|name| !is_held(name)).collect();
        for name in free {
            let values = numbers(table, name)?;
            let differing = slice.values(&values);
            if differing.len() < 2 {
                continue;
            }
            if slice.axes.len() < 2 {
                slice.axes.push(name);
            } else if 2 * differing.len() <= slice.rows.len() {
                slice.hold(name, &values, values[slice.rows[0]])?;
            } else {
                let (low, high) = (differing[0], differing[differing.len() - 1]);
                let range = format!("{} to {}", amount(name, low), amount(name, high));
                slice.notes.push(format!("points at any {}, {range}", words(name)));
            }
        }
        Ok(slice)
    }

    /// The values that occur in the rows, in order.
    fn values(&self, column: &[f64]) -> Vec<f64> {
        let mut values: Vec<f64> =
            self.rows.iter().map(|row| column[*row]).filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }

    /// Leaves the rows in which a parameter has this value.
    fn hold(&mut self, name: &str, column: &[f64], value: f64) -> Result<(), Box<ProblemDetails>> {
        /// The most values that a refusal names.
        const NAMED_VALUES: usize = 20;
        let values = self.values(column);
        // As texts of a value differ: in the last digits.
        let is_it = |other: f64| (other - value).abs() <= 1e-9 * value.abs();
        if !values.iter().any(|other| is_it(*other)) {
            let mut nearest = values;
            nearest.sort_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()));
            nearest.truncate(NAMED_VALUES);
            let nearest: Vec<String> = nearest.iter().map(f64::to_string).collect();
            let detail = format!("no point has this value of {name}; the nearest are {}", nearest.join(", "));
            return Err(ProblemDetails::invalid_parameter("slice", Some(&value.to_string()), detail).into());
        }
        self.notes.push(format!(
            "slice at {} {} (one of {})",
            words(name),
            amount(name, value),
            values.len()
        ));
        self.rows.retain(|row| is_it(column[*row]));
        Ok(())
    }
}

/// The texts in order of the alphabet, and for each row the index of its own; rare ones are others where a map has not enough colours.
fn kinds(texts: &[Option<&str>]) -> (Vec<String>, Vec<f64>) {
    const OTHER: &str = "other";
    let mut counts: IndexMap<&str, usize> = IndexMap::new();
    texts.iter().flatten().for_each(|text| *counts.entry(text).or_default() += 1);
    counts.sort_by(|a, a_count, b, b_count| b_count.cmp(a_count).then(a.cmp(b)));
    let has_others = counts.len() > SweepMap::MOST_WORDS;
    if has_others {
        counts.truncate(SweepMap::MOST_WORDS - 1);
    }
    counts.sort_keys();
    let index = |text: &Option<&str>| match text {
        None => f64::NAN,
        Some(text) => counts.get_index_of(text).unwrap_or(counts.len()) as f64,
    };
    let values = texts.iter().map(index).collect();
    let other = has_others.then(|| OTHER.to_owned());
    (counts.keys().map(|text| (*text).to_owned()).chain(other).collect(), values)
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
        Self::within(table, names, names.first().and_then(|name| shown_in(name)))
    }

    /// The same in a unit of one's own.
    fn within(table: &'t Table, names: &[&str], unit: Option<Unit>) -> Result<Self, Box<ProblemDetails>> {
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
            several => common_words(several.iter().map(|(name, _)| *name)),
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

/// A value of a column in the unit in which it is shown.
fn amount(name: &str, value: f64) -> String {
    match shown_in(name) {
        Some(unit) => format!("{} {}", three_digits(unit.of(value)), unit.symbol),
        None => three_digits(value),
    }
}

/// What columns have in common: their quantity, or else its dimension.
fn common_words<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let quantities: Vec<&Quantity> = names.filter_map(quantity::of).collect();
    match quantities.as_slice() {
        [] => String::new(),
        [first, rest @ ..] if rest.iter().all(|other| other == first) => first.label.to_owned(),
        [first, ..] if first.units == Some(&units::WIDTH) => "displacement".to_owned(),
        [first, ..] => first.units.map_or("value", |units| units.dimension).to_owned(),
    }
}

/// A length across the hole in the unit in which it is shown.
fn shown(width: f64) -> f64 {
    units::WIDTH.shown.of(width)
}

/// A column's name in words; of a part of a list with which part it is.
fn words(name: &str) -> String {
    let label = Name::parse(name).map_or_else(|| name.replace('_', " "), |name| name.to_string());
    match name.rfind(']') {
        Some(end) => format!("{label} of {}", &name[..=end]),
        None => label,
    }
}

fn with_unit(name: &str) -> String {
    match shown_in(name) {
        Some(unit) => format!("{} [{}]", words(name), unit.symbol),
        None => words(name),
    }
}

/// The values of an axis, in the unit in which it is shown.
fn axis(table: &Table, name: &str) -> Result<Vec<f64>, Box<ProblemDetails>> {
    let values = numbers(table, name)?;
    let unit = shown_in(name);
    Ok(values.into_iter().map(|value| unit.map_or(value, |unit| unit.of(value))).collect())
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
        let map = sweep(
            &table(&[1200.0, 1500.0, 1200.0, 1500.0]),
            &parameters,
            Some(&fields),
            &none,
            "",
            &SweepView::default(),
        )
        .unwrap()
        .svg();
        assert!(map.contains(r#"class="map""#) && map.contains("orbit radius rms 49 [mm]"));
        assert!(map.contains("flow rate [m3/s]") && map.contains("mud density [kg/m3]"));
        let lines = sweep(&table(&[1200.0; 4]), &parameters, Some(&fields), &none, "", &SweepView::default())
            .unwrap()
            .svg();
        assert!(lines.contains(r#"class="series""#) && !lines.contains("mud density"));
        let problem =
            sweep(&table(&[1200.0; 4]), &parameters, None, &none, "", &SweepView::default()).unwrap_err();
        assert!(problem.detail.contains("orbit_radius_rms_49"), "{}", problem.detail);
    }

    /// A sweep over 3 by 3 by 2 values with a number and a text each.
    fn cube() -> (Table, IndexSet<String>) {
        let names = ["mud.flow_rate", "operation.weight_on_bit", "string.sections[1].length"];
        let index = |stride: usize, count: usize| (0..18).map(move |row| (row / stride % count) as f64);
        let values =
            |stride, count, of: fn(f64) -> f64| column(&index(stride, count).map(of).collect::<Vec<_>>());
        let verdict = (0..18).map(|row| Some(if row % 4 == 0 { "false" } else { "true" }.to_owned()));
        let table = Table::default()
            .with("ordinal", Column::Integer((1..=18).map(Some).collect()))
            .with(names[0], values(6, 3, |index| 0.01 * (index + 1.0)))
            .with(names[1], values(2, 3, |index| -50e3 * (index + 1.0)))
            .with(names[2], values(1, 2, |index| 30.0 + 10.0 * index))
            .with(
                "orbit_radius_rms_49",
                column(&(1..=18).map(|row| 1e-3 * f64::from(row)).collect::<Vec<_>>()),
            )
            .with("stable", Column::Text(verdict.collect()));
        (table, names.map(str::to_owned).into())
    }

    fn drawn(field: &str, slice: &[(&str, f64)]) -> Result<String, Box<ProblemDetails>> {
        let (table, parameters) = cube();
        let slice = slice.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        let view = SweepView { slice, ..SweepView::default() };
        sweep(&table, &parameters, Some(&[field.to_owned()]), &Findings::default(), "", &view)
            .map(|drawing| drawing.svg())
    }

    #[test]
    fn a_map_of_three_parameters_is_a_slice_and_says_which() {
        let first = drawn("orbit_radius_rms_49", &[]).unwrap();
        assert!(first.contains("slice at section length of string.sections[1] 30 m (one of 2)"), "{first}");
        // Rows 1, 3, ... of the table are at 30 m, rows 2, 4, ... at 40 m.
        assert!(first.contains(">17<") && !first.contains(">18<"), "{first}");
        let second = drawn("orbit_radius_rms_49", &[("string.sections[1].length", 40.0)]).unwrap();
        assert!(second.contains("40 m (one of 2)") && second.contains(">18<") && !second.contains(">17<"));
        let across = drawn("orbit_radius_rms_49", &[("mud.flow_rate", 0.02)]).unwrap();
        assert!(across.contains(">weight on bit [kN]<") && across.contains(">−150<"), "{across}");
        assert!(across.contains("section length of string.sections[1] [m]"));
        for (slice, words) in [
            (("mud.flow_rate", 0.5), "0.03, 0.02, 0.01"),
            (("mud.density", 1200.0), "operation.weight_on_bit"),
        ] {
            let problem = drawn("orbit_radius_rms_49", &[slice]).unwrap_err();
            assert_eq!(problem.errors[0].parameter.as_deref(), Some("slice"));
            assert!(problem.detail.contains(words), "{}", problem.detail);
        }
    }

    #[test]
    fn a_design_without_a_grid_is_shown_whole_and_says_so() {
        let parameters: IndexSet<String> = ["flow_rate", "mud_density", "hidden"].map(str::to_owned).into();
        let drawn_at = |stride: u32| (0..20).map(|k| f64::from(k * stride % 20)).collect::<Vec<_>>();
        let table = Table::default()
            .with("flow_rate", column(&drawn_at(1)))
            .with("mud_density", column(&drawn_at(3)))
            .with("hidden", column(&drawn_at(7)))
            .with("contact_count", column(&drawn_at(9)));
        let fields = ["contact_count".to_owned()];
        let view = SweepView::default();
        let map = sweep(&table, &parameters, Some(&fields), &Findings::default(), "", &view).unwrap().svg();
        assert!(map.contains("points at any hidden, 0 to 19"), "{map}");
        assert_eq!(map.matches(r#"class="marker""#).count(), 20);
    }

    #[test]
    fn words_are_mapped_over_two_parameters_and_over_one() {
        let two = drawn("stable", &[]).unwrap();
        assert!(two.contains(">stable: false<") && two.contains(">stable: true<"), "{two}");
        let one = drawn("stable", &[("mud.flow_rate", 0.01), ("string.sections[1].length", 40.0)]).unwrap();
        assert!(
            one.contains(">weight on bit [kN]<") && one.contains("slice at flow rate 0.01 m3/s"),
            "{one}"
        );
        let texts: Vec<String> = (0..12).map(|k| format!("kind {k:02}")).collect();
        let texts: Vec<Option<&str>> =
            texts.iter().map(|text| Some(text.as_str())).chain([None, Some("kind 11")]).collect();
        let (words, values) = kinds(&texts);
        assert_eq!(
            (words.len(), words[0].as_str(), words[6].as_str(), words[7].as_str()),
            (8, "kind 00", "kind 11", "other")
        );
        assert!(values[12].is_nan() && values[13] == 6.0 && values[8] == 7.0, "{values:?}");
    }

    #[test]
    fn legends_say_where_a_node_is_and_which_way_it_moves() {
        let place = |low_side: Option<f64>| [Place { node: 10, measured_depth: 3412.3, low_side }];
        let label = |name, low_side: Option<f64>| at_place(name, &place(low_side.map(f64::to_radians)));
        // Seen down the hole with the low side down, a turn from u to v is clockwise: from down to the left.
        for (name, low_side, words) in [
            ("u_10", Some(0.0), "u at 3 412 m MD, lateral, to the low side"),
            ("u_10", Some(180.0), "u at 3 412 m MD, lateral, to the high side"),
            ("v_10", Some(0.0), "v at 3 412 m MD, lateral, to the left"),
            ("v_10", Some(90.0), "v at 3 412 m MD, lateral, to the low side"),
            ("u_10", Some(90.0), "u at 3 412 m MD, lateral, to the right"),
            ("v_10", Some(-120.0), "v at 3 412 m MD, lateral, 150° right of the low side"),
            ("u_10", None, "u at 3 412 m MD, lateral, along e1"),
            ("w_10", Some(0.0), "w at 3 412 m MD, axial, downhole"),
            ("u_11", Some(0.0), "u 11"),
        ] {
            assert_eq!(label(name, low_side), words);
        }
        assert_eq!([57.73, 999.97, 12_003.0].map(grouped), ["57.7", "1 000", "12 003"]);
    }

    #[test]
    fn a_history_of_a_string_that_twists_shows_rotation_speed_and_torque_of_its_lowest_node() {
        let table = |speed: f64, torque: f64| {
            Table::default()
                .with("time", column(&[0.0, 1.0]))
                .with("u_10", column(&[0.0, 1e-3]))
                .with("rotation_speed_10", column(&[12.0, 12.0]))
                .with("torque_10", column(&[5.0, 6.0]))
                .with("rotation_speed_49", column(&[0.0, speed]))
                .with("torque_49", column(&[-1e3, torque]))
        };
        let places = [Place { node: 49, measured_depth: 200.0, low_side: None }];
        let picture = |table: &Table| history(table, None, &places, "").unwrap();
        let still = picture(&table(0.0, -1e3));
        let torque_alone = picture(&table(0.0, -4e3));
        let twisting = picture(&table(60.0 * std::f64::consts::TAU / 60.0, -4e3));
        assert!(!still.svg().contains("torque") && !still.svg().contains("speed"));
        assert!(torque_alone.svg().contains(">torque [kN m]<") && !torque_alone.svg().contains("speed"));
        assert!(torque_alone.height() > 1.8 * still.height() && twisting.height() > 2.7 * still.height());
        let svg = twisting.svg();
        assert!(
            svg.contains("rotation speed at 200.0 m MD") && svg.contains(">rotation speed [rpm]<"),
            "{svg}"
        );
        // Once around a second is 60 rpm.
        assert!(svg.contains(">60<") && svg.contains(">−4<") && twisting.png(400).is_ok(), "{svg}");
        let layout = table(1.0, 1.0);
        let shown = shown_of_history(&layout, None).unwrap();
        let names: Vec<_> = shown.columns.keys().map(String::as_str).collect();
        assert_eq!(names, ["u_10", "rotation_speed_49", "torque_49", "time"]);
        let chosen = history(&layout, Some(&["u_10".to_owned()]), &places, "").unwrap();
        assert!(!chosen.svg().contains("torque"));
    }
}
