//! Judgement, limits and worst places.

use drillsweep_api::analysis::Diagnosis;
use drillsweep_api::judgement::{Judgement, OperatingLimits};
use drillsweep_api::view::worst::WorstValue;
use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Class, Quantity, UnitSystem};
use drillsweep_table::{Column, Table};
use maud::{Markup, html};

use crate::reading::{NONE, amount, said, words};

/// Spectral lines that a report lists, at most.
const MOST_LINES: usize = 5;

/// The word of a class next to its colour.
pub(crate) fn class(name: &str) -> Markup {
    let known = Class::named(name);
    html! {
        @if let Some(class) = known {
            svg.chip viewBox="0 0 10 10" aria-hidden="true" { rect width="10" height="10" fill=(class.css()) {} }
        }
        (known.map_or_else(|| name.replace('_', " "), Class::words))
    }
}

/// Class of a point with its sentence, further findings, evidence and causes of spectral lines.
pub(crate) fn diagnosis(Diagnosis { judgement, lines }: &Diagnosis, system: UnitSystem) -> Markup {
    html! {
        (verdict(judgement, system))
        @if !lines.is_empty() {
            h3 { "Spectral lines and their causes" }
            ul { @for line in lines.iter().take(MOST_LINES) {
                li { "node " (line.node) " at " (amount(MEASURED_DEPTH.name, line.measured_depth, system)) ": " (line.sentence) }
            } }
        }
    }
}

pub(crate) fn verdict(judgement: &Judgement, system: UnitSystem) -> Markup {
    let further = judgement.findings.iter().skip(1);
    let evidence = judgement.findings.iter().flat_map(|finding| &finding.evidence);
    html! {
        p.verdict { strong { (class(judgement.class.name())) } ". " (judgement.sentence) }
        @for finding in further { p { (class(finding.class.name())) ". " (finding.sentence) } }
        table {
            thead { tr { th { "Evidence" } th.n { "value" } th.n { "limit" } } }
            tbody { @for (name, value) in evidence {
                tr {
                    td { (words(name)) }
                    td.n { (said(name, value, system)) }
                    td.n { (limit_of(&judgement.limits, name, system)) }
                }
            } }
        }
    }
}

fn limit_of(limits: &OperatingLimits, name: &str, system: UnitSystem) -> String {
    let limit = limits.iter().find(|(column, _)| *column == name);
    limit.map_or(String::new(), |(_, limit)| amount(name, limit, system))
}

/// The limits in use.
pub(crate) fn limits(limits: &OperatingLimits, system: UnitSystem) -> Markup {
    html! {
        table {
            thead { tr { th { "Limits in use" } th.n { "value" } } }
            tbody { @for (name, limit) in limits.iter() {
                tr { td { (words(name)) } td.n { (amount(name, limit, system)) } }
            } }
        }
    }
}

/// Largest loads with their depths, and their points or, if the loads of the nodes are there, their times.
pub(crate) fn worst<'w>(
    values: impl Iterator<Item = &'w WorstValue>,
    loads: Option<&Table>,
    has_points: bool,
    system: UnitSystem,
) -> Markup {
    html! {
        table {
            thead { tr {
                th { "Worst place" } th.n { "value" } th.n { "depth" }
                th.n { @if has_points { "point" } @else { "time" } }
            } }
            tbody { @for WorstValue { quantity, value, depth, ordinal } in values {
                tr {
                    td { (quantity.label) }
                    td.n { (amount(quantity.name, *value, system)) }
                    td.n { (depth.map_or(NONE.to_owned(), |depth| amount(MEASURED_DEPTH.name, depth, system))) }
                    td.n {
                        @if has_points { (ordinal) }
                        @else { (loads.and_then(|loads| time_of(quantity, loads)).map_or(NONE.to_owned(), |time| amount(TIME.name, time, system))) }
                    }
                }
            } }
        }
    }
}

/// Largest values of a summary, with their columns in the loads of the nodes and the times of these.
static TIMES: [(&Quantity, &Quantity, &Quantity); 5] = [
    (&LARGEST_LATERAL_ACCELERATION, &LATERAL_ACCELERATION_PEAK, &LATERAL_ACCELERATION_PEAK_TIME),
    (&LARGEST_AXIAL_ACCELERATION, &AXIAL_ACCELERATION_PEAK, &AXIAL_ACCELERATION_PEAK_TIME),
    (&LARGEST_TANGENTIAL_ACCELERATION, &TANGENTIAL_ACCELERATION_PEAK, &TANGENTIAL_ACCELERATION_PEAK_TIME),
    // The stress of an element is largest with its moment.
    (&LARGEST_BENDING_STRESS, &BENDING_STRESS_PEAK, &BENDING_MOMENT_PEAK_TIME),
    (&LARGEST_EQUIVALENT_STRESS, &EQUIVALENT_STRESS_PEAK, &EQUIVALENT_STRESS_PEAK_TIME),
];

fn time_of(quantity: &Quantity, loads: &Table) -> Option<f64> {
    let (_, peak, time) = TIMES.iter().find(|(largest, ..)| *largest == quantity)?;
    let column = |quantity: &Quantity| loads.columns.get(quantity.name).and_then(Column::numbers);
    let (peaks, times) = (column(peak)?, column(time)?);
    let largest = peaks
        .iter()
        .enumerate()
        .filter(|(_, value)| value.is_finite())
        .max_by(|(_, one), (_, other)| one.abs().total_cmp(&other.abs()))?;
    times.get(largest.0).copied()
}
