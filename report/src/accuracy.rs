//! Accuracy: promised, stated by the results, and verified by reference runs.

use drillsweep_api::view::verification::Findings;
use drillsweep_api::view::worst::WorstValue;
use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Quantity, UnitSystem};
use drillsweep_scenario::{Promise, Scenario};
use indexmap::IndexMap;
use maud::{Markup, html};
use serde_json::{Map, Value};

use crate::reading::{amount, percent, said, words};

/// Rows of a table of biases, at most.
const MOST_STATISTICS: usize = 8;

/// Columns of a summary about the accuracy of its result.
static STATED: [&Quantity; 10] = [
    &TIME_ERROR,
    &MESH_ERROR,
    &SAMPLING_ERROR,
    &WHOLE_ERROR,
    &RELATIVE_SPREAD,
    &ENERGY_RESIDUAL_RATIO,
    &MOTION_REGIME,
    &HALVES_DIFFER,
    &RESOLVED_HZ,
    &SIMULATED_TIME,
];

/// Promise of the accuracy that a scenario requests.
pub(crate) fn promised(scenario: &Scenario) -> Markup {
    html! {
        p {
            "Promised: "
            @match scenario.accuracy.promise() {
                Some(Promise { orbit_size, radius_deviation }) => {
                    "error of orbit sizes within " (percent(orbit_size)) ", of standard deviations of the radius within " (percent(radius_deviation)) "."
                }
                None => "nothing, since integrator and step are given.",
            }
        }
    }
}

/// Errors that a result states, and its bias against the reference if it is verified.
pub(crate) fn of_point(
    summary: &Map<String, Value>,
    biases: &IndexMap<String, f64>,
    system: UnitSystem,
) -> Markup {
    let stated = STATED.iter().filter_map(|quantity| {
        let value = summary.get(quantity.name).filter(|value| !value.is_null())?;
        let is_share = quantity.unit() == Some("1");
        Some((
            quantity.label,
            match value.as_f64().filter(|_| is_share) {
                Some(share) => percent(share),
                None => said(quantity.name, value, system),
            },
        ))
    });
    html! {
        table {
            thead { tr { th { "Stated by the result" } th.n { "value" } } }
            tbody { @for (label, value) in stated { tr { td { (label) } td.n { (value) } } } }
        }
        @if biases.is_empty() {
            p { "Verified: no; no reference run of this point has a result." }
        } @else {
            table {
                thead { tr { th { "Verified by a reference run" } th.n { "bias" } } }
                tbody { @for (name, bias) in biases.iter().take(MOST_STATISTICS) {
                    tr { td { (words(name)) } td.n { (bias_of(name, *bias, system)) } }
                } }
            }
        }
    }
}

/// Largest errors that the results of a sweep state, and biases against its reference runs.
pub(crate) fn of_sweep<'w>(
    scenario: &Scenario,
    errors: impl Iterator<Item = &'w WorstValue>,
    Findings { statistics, warnings }: &Findings,
    system: UnitSystem,
) -> Markup {
    html! {
        (promised(scenario))
        table {
            thead { tr { th { "Stated by the results" } th.n { "largest" } th.n { "point" } } }
            tbody { @for WorstValue { quantity, value, ordinal, .. } in errors {
                tr { td { (quantity.label) } td.n { (percent(*value)) } td.n { (ordinal) } }
            } }
        }
        @if statistics.is_empty() {
            p { "Verified: no; no reference run has a result." }
        } @else {
            table {
                thead { tr { th { "Verified by reference runs" } th.n { "points" } th.n { "mean bias" } th.n { "largest bias" } th.n { "point" } th.n { "promised" } } }
                tbody { @for (name, bias) in statistics.iter().take(MOST_STATISTICS) {
                    tr {
                        td { (words(name)) }
                        td.n { (bias.verified) }
                        td.n { (bias_of(name, bias.mean, system)) }
                        td.n { (bias_of(name, bias.largest, system)) }
                        td.n { (bias.largest_at) }
                        td.n { (bias.promised.map_or(String::new(), percent)) }
                    }
                } }
            }
            @for warning in warnings.iter().take(MOST_STATISTICS) { p { (warning) } }
        }
    }
}

/// Bias of a statistic: relative, but for frequencies.
fn bias_of(name: &str, bias: f64, system: UnitSystem) -> String {
    let is_frequency = drillsweep_quantity::of(name) == Some(&LINE_FREQUENCY_HZ);
    if is_frequency { amount(name, bias, system) } else { percent(bias) }
}
