//! Sweeps that a server has: listing, showing, cancelling and retrying them; and how the service itself stands.

use std::fmt::Write as _;

use clap::Args;
use drillsweep_api::units::unit;
use serde_json::{Value, json};

use crate::client::{Client, ServerArguments};
use crate::print;
use crate::text::{Alignment, columns};

#[derive(Args)]
pub(crate) struct ListArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// Only sweeps of this owner.
    #[arg(long)]
    owner: Option<String>,
    /// At most so many, the newest first.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=500))]
    limit: u32,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(crate) struct ShowArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep's identifier.
    sweep: String,
    /// One of its points, from 1.
    point: Option<u32>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(crate) struct ChangeArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep's identifier.
    sweep: String,
    /// Print the sweep as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(crate) struct StatusArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Prints the newest sweeps.
pub(crate) fn list(arguments: &ListArguments) -> anyhow::Result<()> {
    let mut path = format!("/v1/sweeps?limit={}", arguments.limit);
    if let Some(owner) = &arguments.owner {
        write!(path, "&owner={}", percent_encoded(owner))?;
    }
    let page = Client::new(&arguments.server).get(&path)?;
    if arguments.json {
        return print_json(&page);
    }
    let rows: Vec<Vec<String>> = entries(&page["sweeps"])
        .map(|sweep| {
            let counts = &sweep["counts"];
            vec![
                text(&sweep["id"]),
                text(&sweep["state"]),
                text(&counts["total"]),
                text(&counts["succeeded"]),
                text(&counts["failed"]),
                text(&sweep["created"]).chars().take("2026-01-01T00:00:00".len()).collect(),
                text(&sweep["owner"]),
                text(&sweep["name"]),
            ]
        })
        .collect();
    let header = ["sweep", "state", "points", "done", "failed", "created (UTC)", "owner", "name"];
    print(&columns(&header, &rows, numbers_in(&[2, 3, 4])));
    if !page["next"].is_null() {
        print("older ones are left out; --limit shows more");
    }
    Ok(())
}

/// Prints a sweep with a line a point, or one point with its results.
pub(crate) fn show(arguments: &ShowArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server);
    let path = format!("/v1/sweeps/{}", percent_encoded(&arguments.sweep));
    if let Some(number) = arguments.point {
        let point = client.get(&format!("{path}/points/{number}"))?;
        return if arguments.json { print_json(&point) } else { print_point(&point) };
    }
    let mut sweep = client.get(&path)?;
    let points = client.pages(&format!("{path}/points"), "points")?;
    if arguments.json {
        sweep["points"] = Value::Array(points);
        return print_json(&sweep);
    }
    print(&sweep_line(&sweep));
    let names: Vec<&String> = points
        .first()
        .and_then(|point| point["parameters"].as_object())
        .into_iter()
        .flat_map(|p| p.keys())
        .collect();
    let mut header = vec!["point", "state", "progress", "attempts"];
    header.extend(names.iter().map(|name| name.as_str()));
    header.push("error");
    let rows: Vec<Vec<String>> = points
        .iter()
        .map(|point| {
            let progress = format!("{:.0} %", 100.0 * point["progress"].as_f64().unwrap_or(0.0));
            let mut row =
                vec![text(&point["ordinal"]), text(&point["state"]), progress, text(&point["attempts"])];
            row.extend(names.iter().map(|name| text(&point["parameters"][name.as_str()])));
            row.push(text(&point["error"]["reason"]));
            row
        })
        .collect();
    let last = header.len() - 1;
    print(&columns(&header, &rows, move |column| match column {
        1 => Alignment::Left,
        column if column == last => Alignment::Left,
        _ => Alignment::Right,
    }));
    Ok(())
}

/// Cancels a sweep.
pub(crate) fn cancel(arguments: &ChangeArguments) -> anyhow::Result<()> {
    change(arguments, "cancel")
}

/// Queues a sweep's failed and cancelled points again.
pub(crate) fn retry(arguments: &ChangeArguments) -> anyhow::Result<()> {
    change(arguments, "retry")
}

fn change(arguments: &ChangeArguments, verb: &str) -> anyhow::Result<()> {
    let path = format!("/v1/sweeps/{}/{verb}", percent_encoded(&arguments.sweep));
    let sweep = Client::new(&arguments.server).post(&path, &json!({}))?;
    if arguments.json {
        return print_json(&sweep);
    }
    print(&sweep_line(&sweep));
    Ok(())
}

/// Prints the workers and the depth of the queue.
pub(crate) fn status(arguments: &StatusArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server);
    let queue = client.get("/v1/queue")?;
    let workers = client.get("/v1/workers")?["workers"].take();
    if arguments.json {
        return print_json(&json!({ "queue": queue, "workers": workers }));
    }
    print(&format!(
        "queue: {} waiting, {} waiting for a retry, {} running",
        text(&queue["queued"]),
        text(&queue["waiting_for_retry"]),
        text(&queue["running"])
    ));
    let rows: Vec<Vec<String>> = entries(&workers)
        .map(|worker| {
            ["id", "host", "process", "version", "physics_version", "seen"]
                .iter()
                .map(|name| text(&worker[*name]))
                .collect()
        })
        .collect();
    let header = ["worker", "host", "process", "version", "physics", "last seen (UTC)"];
    print(&columns(&header, &rows, numbers_in(&[2, 4])));
    Ok(())
}

/// A sweep in one line.
pub(crate) fn sweep_line(sweep: &Value) -> String {
    let counts = &sweep["counts"];
    let mut line =
        format!("{} {}: {} points", text(&sweep["id"]), text(&sweep["state"]), text(&counts["total"]));
    for state in ["succeeded", "running", "queued", "failed", "cancelled"] {
        if counts[state].as_u64().is_some_and(|number| number > 0) {
            let _ = write!(line, ", {} {state}", counts[state]);
        }
    }
    line
}

fn print_point(point: &Value) -> anyhow::Result<()> {
    print(&format!("point {} {}", text(&point["ordinal"]), text(&point["state"])));
    if let Some(error) = point["error"].as_object() {
        for (name, value) in error {
            print(&format!("  {name}: {}", text(value)));
        }
    }
    let mut rows = Vec::new();
    for group in ["parameters", "summary"] {
        for (name, value) in point[group].as_object().into_iter().flatten() {
            let unit = unit(name).filter(|unit| *unit != "1").unwrap_or_default();
            rows.push(vec![name.clone(), text(value), unit.to_owned()]);
        }
    }
    print(&columns(&["quantity", "value", "unit"], &rows, numbers_in(&[1])));
    let provenance = point["provenance"].as_object().into_iter().flatten();
    let provenance: Vec<Vec<String>> =
        provenance.map(|(name, value)| vec![name.clone(), text(value)]).collect();
    if !provenance.is_empty() {
        print(&columns(&["provenance", ""], &provenance, numbers_in(&[])));
    }
    Ok(())
}

fn print_json(value: &Value) -> anyhow::Result<()> {
    print(&serde_json::to_string_pretty(value)?);
    Ok(())
}

fn entries(list: &Value) -> impl Iterator<Item = &Value> {
    list.as_array().into_iter().flatten()
}

fn numbers_in(right: &'static [usize]) -> impl Fn(usize) -> Alignment {
    |column| if right.contains(&column) { Alignment::Right } else { Alignment::Left }
}

fn text(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}

/// A text as part of a path or query.
pub(crate) fn percent_encoded(text: &str) -> String {
    let mut encoded = String::new();
    for byte in text.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => {
                encoded.push(char::from(byte))
            }
            _ => {
                let _ = write!(encoded, "%{byte:02X}");
            }
        }
    }
    encoded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_cannot_leave_their_place_in_a_path() {
        assert_eq!(percent_encoded("019a-b_c.~"), "019a-b_c.~");
        assert_eq!(percent_encoded("../x?y#z é"), "..%2Fx%3Fy%23z%20%C3%A9");
    }

    #[test]
    fn a_line_names_only_the_states_that_occur() {
        let sweep = json!({
            "id": "a", "state": "running",
            "counts": {"total": 3, "queued": 0, "running": 1, "succeeded": 2, "failed": 0, "cancelled": 0},
        });
        assert_eq!(sweep_line(&sweep), "a running: 3 points, 2 succeeded, 1 running");
    }
}
