//! Origin of a report: sweep, point, key, version, and the data.

use drillsweep_api::{PHYSICS_VERSION, PointDetail, Sweep};
use maud::{Markup, html};
use serde_json::Value;

/// Members of a provenance that are listed, and their longest text.
const MEMBERS: [&str; 6] = ["version", "target", "elements", "integrator", "step", "tolerance"];
const LONGEST: usize = 200;

/// Heading of a report with the sweep's name.
pub(crate) fn heading(sweep: &Sweep, point: Option<&PointDetail>) -> Markup {
    html! {
        h1 { (title(sweep, point)) }
        p.soft {
            "Sweep " (sweep.id) " of " (sweep.owner) ", submitted " (moment(sweep.created))
            @if let Some(finished) = sweep.finished { ", finished " (moment(finished)) }
            @if !sweep.tags.is_empty() { "; tags: " (sweep.tags.join(", ")) }
            "."
        }
    }
}

/// Title of a report.
pub(crate) fn title(sweep: &Sweep, point: Option<&PointDetail>) -> String {
    let name = sweep.name.clone().unwrap_or_else(|| format!("Sweep {}", sweep.id));
    match point {
        Some(point) => format!("{name}, point {}", point.row.ordinal),
        None => name,
    }
}

/// Everything that a computation of the same numbers needs, and links to the data.
pub(crate) fn origin(sweep: &Sweep, point: &PointDetail, is_of_point: bool) -> Markup {
    let of_point = &point.row.links.this;
    let links = match is_of_point {
        true => [
            ("Point", of_point.clone()),
            ("Loads", format!("{of_point}/loads?format=csv")),
            ("Sweep", sweep.links.this.clone()),
        ],
        false => [
            ("Sweep", sweep.links.this.clone()),
            ("Table", format!("{}?format=csv", sweep.links.table)),
            ("Archive of all tables", sweep.links.export.clone()),
        ],
    };
    html! {
        table { tbody {
            tr { th { "Physics version" } td { (version(point)) } }
            tr { th { "Key of point " (point.row.ordinal) } td { code { (point.key) } } }
            @for (name, value) in provenance(point) { tr { th { (name) } td { (value) } } }
            @for (name, link) in &links { tr { th { (name) } td { a href=(link) { code { (link) } } } } }
            tr { th { "Scenario of the point" } td { "member " code { "scenario" } " of " a href=(of_point) { code { (of_point) } } "; equal keys have equal results" } }
        } }
    }
}

fn version(point: &PointDetail) -> String {
    let of_result =
        point.provenance.as_ref().and_then(|members| members.get("physics_version")).and_then(Value::as_u64);
    of_result.unwrap_or(PHYSICS_VERSION.into()).to_string()
}

/// Program, mesh and method of the result.
fn provenance(point: &PointDetail) -> Vec<(String, String)> {
    let text = |value: &Value| match value {
        Value::String(text) => Some(text.chars().take(LONGEST).collect()),
        Value::Number(_) | Value::Bool(_) => Some(value.to_string()),
        _ => None,
    };
    let member = |name: &&str| Some(((*name).to_owned(), text(point.provenance.as_ref()?.get(*name)?)?));
    MEMBERS.iter().filter_map(member).collect()
}

/// A moment in UTC, to the minute.
fn moment(time: jiff::Timestamp) -> String {
    time.strftime("%Y-%m-%d %H:%M UTC").to_string()
}
