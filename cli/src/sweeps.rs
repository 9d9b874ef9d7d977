//! Sweeps that a server has: listing, showing, changing, pausing, cancelling and retrying them; and how the service itself
//! stands.

use std::fmt::Write as _;

use clap::Args;
use drillsweep_api::units::unit;
use jiff::{SignedDuration, Timestamp};
use serde_json::{Map, Value, json};

use crate::client::{Client, ServerArguments};
use crate::print;
use crate::text::{Alignment, columns};
use crate::token::Lifetime;

#[derive(Args)]
pub(crate) struct ListArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// Only sweeps of this owner.
    #[arg(long)]
    owner: Option<String>,
    /// Only sweeps in this state.
    #[arg(long, value_parser = ["running", "paused", "completed", "cancelled"])]
    state: Option<String>,
    /// Only sweeps with this text in their name.
    #[arg(long)]
    name: Option<String>,
    /// Only sweeps with this tag.
    #[arg(long)]
    tag: Option<String>,
    /// At most so many, the newest first.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=500))]
    limit: u32,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(crate) struct FailuresArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// Only points of sweeps of this owner.
    #[arg(long)]
    owner: Option<String>,
    /// Only points that failed in this way.
    #[arg(long, value_parser = ["physical", "infrastructure", "crash", "timeout", "cancelled"])]
    class: Option<String>,
    /// At most so many, the latest first.
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
pub(crate) struct SweepArguments {
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
    let filters = [
        ("owner", &arguments.owner),
        ("state", &arguments.state),
        ("name", &arguments.name),
        ("tag", &arguments.tag),
    ];
    let path = with_filters(format!("/v1/sweeps?limit={}", arguments.limit), &filters);
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
                seconds(&sweep["created"]),
                text(&sweep["owner"]),
                text(&sweep["name"]),
                entries(&sweep["tags"]).map(text).collect::<Vec<_>>().join(" "),
            ]
        })
        .collect();
    let header = ["sweep", "state", "points", "done", "failed", "created (UTC)", "owner", "name", "tags"];
    print(&columns(&header, &rows, numbers_in(&[2, 3, 4])));
    if !page["next"].is_null() {
        print("older ones are left out; --limit shows more");
    }
    Ok(())
}

/// Prints the points of all sweeps that were given up.
pub(crate) fn failures(arguments: &FailuresArguments) -> anyhow::Result<()> {
    let filters = [("owner", &arguments.owner), ("class", &arguments.class)];
    let path = with_filters(format!("/v1/failures?limit={}", arguments.limit), &filters);
    let page = Client::new(&arguments.server).get(&path)?;
    if arguments.json {
        return print_json(&page);
    }
    let rows: Vec<Vec<String>> = entries(&page["failures"])
        .map(|point| {
            vec![
                seconds(&point["at"]),
                text(&point["sweep"]),
                text(&point["ordinal"]),
                text(&point["attempts"]),
                text(&point["error"]["class"]),
                text(&point["error"]["reason"]),
            ]
        })
        .collect();
    let header = ["given up (UTC)", "sweep", "point", "attempts", "class", "error"];
    print(&columns(&header, &rows, numbers_in(&[2, 3])));
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
    warn_of_bias(&sweep);
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
pub(crate) fn cancel(arguments: &SweepArguments) -> anyhow::Result<()> {
    ask(arguments, "cancel")
}

/// Queues a sweep's failed and cancelled points again.
pub(crate) fn retry(arguments: &SweepArguments) -> anyhow::Result<()> {
    ask(arguments, "retry")
}

/// Hands out no more points of a sweep.
pub(crate) fn pause(arguments: &SweepArguments) -> anyhow::Result<()> {
    ask(arguments, "pause")
}

/// Hands out the points of a paused sweep again.
pub(crate) fn resume(arguments: &SweepArguments) -> anyhow::Result<()> {
    ask(arguments, "resume")
}

fn ask(arguments: &SweepArguments, verb: &str) -> anyhow::Result<()> {
    let path = format!("/v1/sweeps/{}/{verb}", percent_encoded(&arguments.sweep));
    let sweep = Client::new(&arguments.server).post(&path, &json!({}))?;
    print_sweep(&sweep, arguments.json)
}

#[derive(Args)]
pub(crate) struct ChangeArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep's identifier.
    sweep: String,
    #[command(flatten)]
    changes: Changes,
    /// Print the sweep as JSON.
    #[arg(long)]
    json: bool,
}

/// At least one of these is given.
#[derive(Args)]
#[group(required = true, multiple = true)]
struct Changes {
    /// Its name; an empty text takes it away.
    #[arg(long)]
    name: Option<String>,
    /// Higher goes first among the sweeps of one owner: -10 to 10.
    #[arg(long, allow_negative_numbers = true)]
    priority: Option<i32>,
    /// A word to find the sweep by, in place of those that it has; may be given again.
    #[arg(long = "tag", value_name = "TAG")]
    tags: Vec<String>,
    /// Take its tags away.
    #[arg(long, conflicts_with = "tags")]
    no_tags: bool,
    /// Keep the sweep and all that belongs to it, whatever its age.
    #[arg(long)]
    pin: bool,
    /// Let it expire like others.
    #[arg(long, conflicts_with = "pin")]
    unpin: bool,
    /// When it is deleted, from now on: days as `90d`, hours as `12h`, or `never`.
    #[arg(long)]
    expires: Option<Lifetime>,
}

/// Changes name, tags, priority, pin or expiry of a sweep.
pub(crate) fn change(arguments: &ChangeArguments) -> anyhow::Result<()> {
    let Changes { name, priority, tags, no_tags, pin, unpin, expires } = &arguments.changes;
    let mut patch = Map::new();
    if let Some(name) = name {
        patch.insert("name".into(), if name.is_empty() { Value::Null } else { json!(name) });
    }
    if let Some(priority) = priority {
        patch.insert("priority".into(), json!(priority));
    }
    if *no_tags || !tags.is_empty() {
        patch.insert("tags".into(), json!(tags));
    }
    if *pin || *unpin {
        patch.insert("pinned".into(), json!(pin));
    }
    if let Some(Lifetime(milliseconds)) = expires {
        let at = |ms| Timestamp::now().checked_add(SignedDuration::from_millis(ms));
        patch.insert("expires".into(), json!(milliseconds.map(at).transpose()?));
    }
    let path = format!("/v1/sweeps/{}", percent_encoded(&arguments.sweep));
    let sweep = Client::new(&arguments.server).patch(&path, &Value::Object(patch))?;
    print_sweep(&sweep, arguments.json)
}

/// Prints a sweep in one line, or as JSON.
pub(crate) fn print_sweep(sweep: &Value, as_json: bool) -> anyhow::Result<()> {
    if as_json {
        return print_json(sweep);
    }
    print(&sweep_line(sweep));
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
        "queue: {} waiting, {} paused, {} waiting for a retry, {} running",
        text(&queue["queued"]),
        text(&queue["paused"]),
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

/// A sweep in one line, and in a second what verifying some of its points has shown.
pub(crate) fn sweep_line(sweep: &Value) -> String {
    let counts = &sweep["counts"];
    let mut line =
        format!("{} {}: {} points", text(&sweep["id"]), text(&sweep["state"]), text(&counts["total"]));
    for state in ["succeeded", "running", "queued", "failed", "cancelled"] {
        if counts[state].as_u64().is_some_and(|number| number > 0) {
            let _ = write!(line, ", {} {state}", counts[state]);
        }
    }
    if let Some(verification) = sweep.get("verification") {
        let _ = write!(line, "\n{}", verification_line(verification));
    }
    line
}

/// How far the points are verified, and the worst bias of orbit size.
pub(crate) fn verification_line(verification: &Value) -> String {
    let (counts, worst) = (&verification["counts"], &verification["worst"]);
    let mut line = format!("verified by the reference: {} of {}", counts["succeeded"], counts["total"]);
    for state in ["running", "queued", "failed", "cancelled"] {
        if counts[state].as_u64().is_some_and(|number| number > 0) {
            let _ = write!(line, ", {} {state}", counts[state]);
        }
    }
    if let Some(bias) = worst["bias"].as_f64() {
        let (statistic, ordinal) = (text(&worst["statistic"]), text(&worst["ordinal"]));
        let _ = write!(line, "; bias of {statistic} up to {:+.2} % (point {ordinal})", 100.0 * bias);
    }
    if let Some(promised) = worst["promised"].as_f64() {
        let _ = write!(line, ", promised {:.1} %", 100.0 * promised);
    }
    line
}

/// Warns where verifying points has shown biases beyond what the accuracy promises.
pub(crate) fn warn_of_bias(sweep: &Value) {
    for warning in entries(&sweep["verification"]["warnings"]) {
        tracing::warn!("{}", text(warning));
    }
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

/// A time to within the second.
fn seconds(time: &Value) -> String {
    text(time).chars().take("2026-01-01T00:00:00".len()).collect()
}

/// A path with the filters of a list that are given.
fn with_filters(mut path: String, filters: &[(&str, &Option<String>)]) -> String {
    for (name, value) in filters {
        if let Some(value) = value {
            let _ = write!(path, "&{name}={}", percent_encoded(value));
        }
    }
    path
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

    #[test]
    fn a_second_line_says_what_verifying_has_shown() {
        let mut sweep = json!({
            "id": "a", "state": "running",
            "counts": {"total": 3, "queued": 0, "running": 0, "succeeded": 3, "failed": 0, "cancelled": 0},
            "verification": {"counts": {"total": 2, "queued": 0, "running": 1, "succeeded": 1, "failed": 0, "cancelled": 0}},
        });
        assert_eq!(
            sweep_line(&sweep),
            "a running: 3 points, 3 succeeded\nverified by the reference: 1 of 2, 1 running"
        );
        sweep["verification"]["worst"] =
            json!({"statistic": "orbit_radius_rms_49", "ordinal": 7, "bias": 0.4, "promised": 0.02});
        let line = sweep_line(&sweep);
        let (_, verified) = line.split_once('\n').unwrap();
        assert_eq!(
            verified,
            "verified by the reference: 1 of 2, 1 running; bias of orbit_radius_rms_49 up to +40.00 % (point 7), promised 2.0 %"
        );
    }
}
