//! The picture of a sweep's table: lines over one parameter, or a map over two.

use drillsweep_api::view::verification::{Findings, is_bias_column};
use drillsweep_quantity::columns::*;
use drillsweep_quantity::{CLASSES, Class, UnitChoice};
use drillsweep_table::{Column, Table};
use indexmap::{IndexMap, IndexSet};

use crate::error::ChartError;
use crate::picture::{Drawing, Line, LinePlot, MapPoint, Spacing, SweepMap, Word};
use crate::place::{Place, at_place};
use crate::shown::{Shown, amount, axis, numbers, with_unit};
use crate::words::words;

/// The motion regime of a run that has not settled.
const NOT_SETTLED: &str = "not_settled";

/// Part of a sweep that is shown, and how.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepView {
    /// Spacing of the values of parameters on a map.
    pub spacing: Spacing,
    /// Parameters that are held, with their values in the units of the table.
    pub slice: Vec<(String, f64)>,
    /// Positions of the nodes of the columns, if they are the same in the whole sweep.
    pub places: Vec<Place>,
    /// Units of axes and values.
    pub units: UnitChoice,
}

/// The table of a sweep: the first of the `fields` over the sweep's parameters. Over one parameter lines, one a field;
/// over two a map. Over more, a map over the first two that the view's slice does not hold; further ones are held at the first value that
/// they have, and the picture says so. Those of a design that is no grid cannot be held: all points are shown, which it says as
/// well. Classes have their colours, the most severe first; other texts have a colour each, the most frequent eight or, with others, seven. Points that are verified are marked on a map, and
/// the notes stand below the title; points that have not settled have crosses.
///
/// # Errors
/// A problem that names the columns there are, if a field is none of them, or none is given; or the values that there are, if
/// the slice is at none of them.
pub fn sweep(
    table: &Table,
    parameters: &IndexSet<String>,
    fields: Option<&[String]>,
    findings: &Findings,
    title: &str,
    view: &SweepView,
) -> Result<Drawing, ChartError> {
    let fields = fields.unwrap_or_default();
    let Some(first) = fields.first() else {
        let columns = numeric(table).filter(|name| !parameters.contains(*name)).map(str::to_owned);
        return Err(ChartError::NoField { columns: columns.collect() });
    };
    let Slice { rows, axes, notes, .. } = Slice::of(table, parameters, view)?;
    let x = axes.first().copied().unwrap_or(ORDINAL.name);
    let pick = |values: Vec<f64>| -> Vec<f64> { rows.iter().map(|row| values[*row]).collect() };
    let xs = pick(axis(table, x, &view.units)?);
    let texts = match table.columns.get(first) {
        Some(Column::Text(texts)) => Some(texts),
        _ => None,
    };
    let verified = findings.caption(first);
    let is_doubtful = unsettled_rows(table);
    let count = rows.iter().filter(|row| is_doubtful[**row]).count();
    let unsettled = (count > 0).then(|| format!("crosses: {count} of {} points NOT SETTLED", rows.len()));
    if axes.len() < 2 && texts.is_none() {
        let names: Vec<&str> = fields.iter().map(String::as_str).collect();
        let shown = Shown::of(table, &names, &view.units)?;
        let y_label = shown.label(&view.places, &view.units);
        let line = |(name, values): (&str, Vec<f64>)| {
            let mut points: Vec<[f64; 2]> =
                xs.iter().zip(pick(values)).map(|(x, value)| [*x, value]).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            Line { name: at_place(name, &view.places, &view.units), points, is_marked: true }
        };
        let lines: Vec<Line> = shown.columns.into_iter().map(line).collect();
        let doubtful: Vec<f64> =
            xs.iter().zip(&rows).filter(|(_, row)| is_doubtful[**row]).map(|(x, _)| *x).collect();
        let is_at = |point: &&[f64; 2]| doubtful.contains(&point[0]);
        let plot = LinePlot {
            title: title.to_owned(),
            subtitle: notes.into_iter().chain(verified).chain(unsettled).collect::<Vec<_>>().join("; "),
            x_label: with_unit(x, &view.units),
            y_label,
            crosses: lines.iter().flat_map(|line| &line.points).filter(is_at).copied().collect(),
            lines,
            ..LinePlot::default()
        };
        return Ok(plot.drawing());
    }
    let ys = match axes.get(1) {
        Some(y) => pick(axis(table, y, &view.units)?),
        None => vec![0.0; rows.len()],
    };
    let (kinds, values, value_label) = match texts {
        Some(texts) => {
            let texts: Vec<Option<&str>> = rows.iter().map(|row| texts[*row].as_deref()).collect();
            let (kinds, values) = if first == CLASS.name { classes(&texts) } else { kinds(&texts) };
            (kinds, values, at_place(first, &view.places, &view.units))
        }
        None => {
            let mut shown = Shown::of(table, &[first.as_str()], &view.units)?;
            let value_label = shown.label(&view.places, &view.units);
            let (_, values) = shown.columns.swap_remove(0);
            (Vec::new(), pick(values), value_label)
        }
    };
    let is_marked = verified_rows(table);
    let points = xs.iter().zip(ys).zip(values).zip(&rows);
    let points = points.map(|(((x, y), value), row)| MapPoint {
        x: *x,
        y,
        value,
        is_marked: is_marked[*row],
        is_doubtful: is_doubtful[*row],
    });
    let verified = verified.map(|verified| format!("diamonds: {verified}"));
    let plot = SweepMap {
        title: title.to_owned(),
        subtitle: notes.into_iter().chain(verified).chain(unsettled).collect::<Vec<_>>().join("; "),
        x_label: with_unit(x, &view.units),
        y_label: axes.get(1).map(|y| with_unit(y, &view.units)).unwrap_or_default(),
        value_label,
        points: points.collect(),
        words: kinds,
        spacing: view.spacing,
    };
    Ok(plot.drawing())
}

/// Part of a sweep's table that one picture shows.
struct Slice<'t> {
    /// Rows of the table, in order.
    rows: Vec<usize>,
    /// The parameters that it is over: two, or fewer if fewer vary.
    axes: Vec<&'t str>,
    /// Its position in words.
    notes: Vec<String>,
    /// Units of the words.
    units: &'t UnitChoice,
}

impl<'t> Slice<'t> {
    fn of(
        table: &Table,
        parameters: &'t IndexSet<String>,
        SweepView { slice: held, units, .. }: &'t SweepView,
    ) -> Result<Self, ChartError> {
        let mut slice =
            Slice { rows: (0..table.rows()).collect(), axes: Vec::new(), notes: Vec::new(), units };
        for (name, value) in held {
            if !parameters.contains(name) {
                let parameters = parameters.iter().cloned().collect();
                return Err(ChartError::NoSuchParameter { name: name.clone(), parameters });
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
                let range =
                    format!("{} to {}", amount(name, low, slice.units), amount(name, high, slice.units));
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
    fn hold(&mut self, name: &str, column: &[f64], value: f64) -> Result<(), ChartError> {
        /// The most values that a refusal names.
        const NAMED_VALUES: usize = 20;
        let values = self.values(column);
        // As texts of a value differ: in the last digits.
        let is_it = |other: f64| (other - value).abs() <= 1e-9 * value.abs();
        if !values.iter().any(|other| is_it(*other)) {
            let mut nearest = values;
            nearest.sort_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()));
            nearest.truncate(NAMED_VALUES);
            return Err(ChartError::NoSuchValue { parameter: name.to_owned(), value, nearest });
        }
        self.notes.push(format!(
            "slice at {} {} (one of {})",
            words(name),
            amount(name, value, self.units),
            values.len()
        ));
        self.rows.retain(|row| is_it(column[*row]));
        Ok(())
    }
}

/// The classes that occur, the most severe first, and for each row the index of its own.
fn classes(texts: &[Option<&str>]) -> (Vec<Word>, Vec<f64>) {
    let occurring: Vec<&Class> = CLASSES.iter().filter(|class| texts.contains(&Some(class.name))).collect();
    let index = |text: &Option<&str>| {
        let index = occurring.iter().position(|class| Some(class.name) == *text);
        index.map_or(f64::NAN, |index| index as f64)
    };
    let values = texts.iter().map(index).collect();
    let word = |class: &Class| Word { text: class.words(), colour: class.colour };
    (occurring.into_iter().map(word).collect(), values)
}

/// The texts in order of the alphabet, and for each row the index of its own; rare ones are others if a map has not enough colours.
fn kinds(texts: &[Option<&str>]) -> (Vec<Word>, Vec<f64>) {
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
    let words = counts.keys().map(|text| (*text).to_owned()).chain(other).enumerate();
    (words.map(|(number, text)| Word::numbered(number, text)).collect(), values)
}

/// Marks rows of verified points in a sweep's table: those with the bias of any statistic.
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

/// The rows whose motion has not settled, or still grows, so that their statistics may be those of the start alone.
fn unsettled_rows(table: &Table) -> Vec<bool> {
    let mut is_unsettled = vec![false; table.rows()];
    if let Some(Column::Text(regimes)) = table.columns.get(MOTION_REGIME.name) {
        for (is_unsettled, regime) in is_unsettled.iter_mut().zip(regimes) {
            *is_unsettled |= regime.as_deref() == Some(NOT_SETTLED);
        }
    }
    let growing = table.columns.get(GROWING_MODE_HZ.name).and_then(Column::numbers);
    for (is_unsettled, growing) in is_unsettled.iter_mut().zip(growing.unwrap_or_default()) {
        *is_unsettled |= growing.is_finite();
    }
    is_unsettled
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

    use super::*;

    fn column(values: &[f64]) -> Column {
        Column::Number(values.to_vec())
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
        assert!(map.contains(r#"class="map""#) && map.contains("lateral vibration, node 49 [mm]"));
        assert!(map.contains("flow rate [m3/s]") && map.contains("mud density [kg/m3]"));
        let lines = sweep(&table(&[1200.0; 4]), &parameters, Some(&fields), &none, "", &SweepView::default())
            .unwrap()
            .svg();
        assert!(lines.contains(r#"class="series""#) && !lines.contains("mud density"));
        let error =
            sweep(&table(&[1200.0; 4]), &parameters, None, &none, "", &SweepView::default()).unwrap_err();
        assert!(error.to_string().contains("orbit_radius_rms_49"), "{error}");
    }

    #[test]
    fn points_that_have_not_settled_have_crosses_in_lines_and_maps() {
        let parameters: IndexSet<String> = ["flow_rate".to_owned(), "mud_density".to_owned()].into();
        let picture = |density: [f64; 4], regimes: [&str; 4], growing: [f64; 4]| {
            let table = Table::default()
                .with("ordinal", Column::Integer((1..=4).map(Some).collect()))
                .with("flow_rate", column(&[0.01, 0.02, 0.03, 0.04]))
                .with("mud_density", column(&density))
                .with("orbit_offset_49", column(&[0.001, 0.002, 0.003, 0.004]))
                .with("motion_regime", Column::Text(regimes.map(|regime| Some(regime.to_owned())).to_vec()))
                .with("growing_mode_hz", column(&growing));
            let fields = ["orbit_offset_49".to_owned()];
            let (none, view) = (Findings::default(), SweepView::default());
            sweep(&table, &parameters, Some(&fields), &none, "", &view).unwrap().svg()
        };
        let (regimes, growing) =
            (["regular", "not_settled", "irregular", "fixed"], [f64::NAN, f64::NAN, f64::NAN, 2.1]);
        for density in [[1200.0; 4], [1200.0, 1500.0, 1200.0, 1500.0]] {
            assert!(picture(density, regimes, growing).contains("2 of 4 points NOT SETTLED"));
            let settled = picture(density, ["regular"; 4], [f64::NAN; 4]);
            assert!(!settled.contains("SETTLED") && !settled.contains(r#"class="doubtful""#));
        }
        assert!(picture([1200.0; 4], regimes, growing).contains(r#"class="doubtful""#));
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

    fn drawn(field: &str, slice: &[(&str, f64)]) -> Result<String, ChartError> {
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
            let error = drawn("orbit_radius_rms_49", &[slice]).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
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
    fn classes_are_in_the_order_and_colours_of_the_vocabulary() {
        let parameters: IndexSet<String> = ["flow_rate".to_owned()].into();
        let texts = ["quiet", "stick_slip", "failed", "quiet"].map(|text| Some(text.to_owned()));
        let table = Table::default()
            .with("flow_rate", column(&[0.01, 0.02, 0.03, 0.04]))
            .with("class", Column::Text(texts.to_vec()));
        let (fields, view) = (["class".to_owned()], SweepView::default());
        let svg = sweep(&table, &parameters, Some(&fields), &Findings::default(), "", &view).unwrap().svg();
        let legend = ["failed", "stick slip", "quiet"].map(|class| svg.find(&format!(">class: {class}<")));
        assert!(legend.is_sorted() && legend[0].is_some(), "{svg}");
        let cells =
            |class: &str| svg.matches(&format!(r#"fill="{}""#, Class::named(class).unwrap().css())).count();
        // A cell for each point, and one in the legend.
        assert_eq!(["failed", "stick_slip", "quiet", "buckled"].map(cells), [2, 2, 3, 0]);
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
            (words.len(), words[0].text.as_str(), words[6].text.as_str(), words[7].text.as_str()),
            (8, "kind 00", "kind 11", "other")
        );
        assert!(values[12].is_nan() && values[13] == 6.0 && values[8] == 7.0, "{values:?}");
    }
}
