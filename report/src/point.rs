//! Report of one point.

use drillsweep_api::analysis::Diagnosis;
use drillsweep_api::view::worst::WorstValues;
use drillsweep_api::{PointDetail, Sweep};
use drillsweep_chart::{self as chart, Drawing, Hole};
use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Quantity, UnitChoice, UnitSystem};
use drillsweep_table::Table;
use indexmap::IndexMap;
use maud::{Markup, PreEscaped, html};

use crate::page::page;
use crate::reading::{amount, words};
use crate::{accuracy, inputs, source, verdict};

/// Data of one point.
#[derive(Debug, Clone)]
pub struct PointData {
    /// The point.
    pub point: PointDetail,
    /// Its diagnosis by the limits in use; absent without a result.
    pub diagnosis: Option<Diagnosis>,
    /// Biases of its statistics against its reference run; empty if it is not verified.
    pub biases: IndexMap<String, f64>,
    /// Path of the recorded node nearest to the largest orbit, with its hole.
    pub orbit: Option<(Table, Hole)>,
    /// Rotation of the bit over time, with the name of the column of its speed.
    pub rotation: Option<(Table, String)>,
    /// Loads of all nodes.
    pub loads: Option<Table>,
}

/// Loads that a profile shows, each in a picture of its own.
static PROFILES: [&Quantity; 2] = [&LATERAL_ACCELERATION_RMS, &EQUIVALENT_STRESS_PEAK];

/// The report of a point of a sweep, as HTML.
pub fn point(sweep: &Sweep, data: &PointData, units: UnitSystem) -> String {
    let point = &data.point;
    let body = html! {
        (source::heading(sweep, Some(point)))
        (parameters(point, units))
        h2 { "Judgement" }
        (judgement(data, units))
        h2 { "Simulated" }
        (inputs::inputs(&point.scenario, &[], units))
        @if point.summary.is_some() {
            h2 { "Worst places" }
            (worst(data, units))
        }
        (pictures(data, units))
        h2 { "Accuracy" }
        (accuracy::promised(&point.scenario))
        (accuracy_of(data, units))
        h2 { "Origin" }
        (source::origin(sweep, point, true))
    };
    page(&source::title(sweep, Some(point)), &body)
}

fn parameters(point: &PointDetail, units: UnitSystem) -> Markup {
    let values = point.row.parameters.iter();
    let text: Vec<String> =
        values.map(|(name, value)| format!("{} {}", words(name), amount(name, *value, units))).collect();
    html! { @if !text.is_empty() { p { (text.join(", ")) } } }
}

pub(crate) fn judgement(data: &PointData, units: UnitSystem) -> Markup {
    html! {
        @match &data.diagnosis {
            Some(found) => (verdict::diagnosis(found, units)),
            None => p { "The point is " (data.point.row.state.as_str()) ": it has no result." },
        }
        @if let Some(error) = data.point.row.error.as_ref().filter(|_| data.diagnosis.is_some()) {
            p { "Failure (" (error.class.as_str()) "): " (error.reason) }
        }
    }
}

pub(crate) fn worst(data: &PointData, units: UnitSystem) -> Markup {
    let mut values = WorstValues::default();
    if let (Some(summary), Some(found)) = (&data.point.summary, &data.diagnosis) {
        values.push(data.point.row.ordinal, summary, found.judgement.class);
    }
    verdict::worst(values.loads(), data.loads.as_ref(), false, units)
}

pub(crate) fn accuracy_of(data: &PointData, units: UnitSystem) -> Markup {
    let summary = data.point.summary.clone().unwrap_or_default();
    accuracy::of_point(&summary, &data.biases, units)
}

/// Orbit, bit speed and profiles, as far as the result has them.
pub(crate) fn pictures(data: &PointData, units: UnitSystem) -> Markup {
    let units = &UnitChoice::from(units);
    let orbit =
        data.orbit.as_ref().and_then(|(table, hole)| chart::orbit(table, hole, "Orbit", None, units).ok());
    let rotation = data
        .rotation
        .as_ref()
        .and_then(|(table, column)| chart::rotation(table, column, "Rotation of the bit").ok());
    let profiles = data.loads.iter().flat_map(|loads| {
        PROFILES.iter().filter_map(move |quantity| {
            let fields = [quantity.name.to_owned()];
            chart::profile(loads, Some(&fields), "", units).ok()
        })
    });
    let profiles: Vec<Drawing> = profiles.collect();
    html! {
        @if orbit.is_some() || rotation.is_some() {
            h2 { "Motion of point " (data.point.row.ordinal) }
            div.pair { @for drawing in orbit.iter().chain(&rotation) { (figure(drawing)) } }
        }
        @if !profiles.is_empty() {
            h3 { "Loads along the string" }
            div.pair { @for drawing in &profiles { (figure(drawing)) } }
        }
    }
}

pub(crate) fn figure(drawing: &Drawing) -> Markup {
    html! { figure { (PreEscaped(drawing.svg_element())) } }
}
