//! Sweeps of a server: listing, showing, changing, pausing, cancelling and retrying them; and the state of the service
//! itself.

use std::fmt::Write as _;

use clap::Args;
use drillsweep_api::{
    AxisName, FailureList, PointCounts, PointDetail, PointRow, Queue, Sweep, SweepDeletion, SweepList,
    SweepPatch, SweepVerification, Worker, WorkerList,
};
use drillsweep_quantity::{UnitChoice, unit};
use jiff::{SignedDuration, Timestamp};
use serde::Serialize;
use serde_json::{Value, json};

use crate::client::{Client, ServerArguments, path_segment};
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
    /// Largest number of sweeps, the newest first.
    #[arg(long, value_name = "NUMBER", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=500))]
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
    /// Largest number of points, the latest first.
    #[arg(long, value_name = "NUMBER", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=500))]
    limit: u32,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(crate) struct ShowArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
    sweep: String,
    /// One of its points, from 1.
    point: Option<u32>,
    /// Units of the texts: `si`, `field`, and `COLUMN:UNIT` for single columns, separated by commas; JSON keeps its units.
    #[arg(long, value_parser = UnitChoice::parse)]
    units: Option<UnitChoice>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(crate) struct SweepArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
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
    let page: SweepList = Client::new(&arguments.server)?.get(&path)?;
    if arguments.json {
        return print_json(&page);
    }
    print(&list_text(&page));
    Ok(())
}

fn list_text(page: &SweepList) -> String {
    let row = |sweep: &Sweep| {
        vec![
            sweep.id.clone(),
            sweep.state.as_str().to_owned(),
            sweep.counts.total.to_string(),
            sweep.counts.succeeded.to_string(),
            sweep.counts.failed.to_string(),
            seconds(sweep.created),
            sweep.owner.clone(),
            sweep.varied.iter().map(AxisName::as_str).collect::<Vec<_>>().join(" "),
            sweep.name.clone().unwrap_or_default(),
            sweep.tags.join(" "),
        ]
    };
    let rows: Vec<Vec<String>> = page.sweeps.iter().map(row).collect();
    let header =
        ["sweep", "state", "points", "done", "failed", "created (UTC)", "owner", "varied", "name", "tags"];
    with_remainder(columns(&header, &rows, numbers_in(&[2, 3, 4])), page.next.is_some())
}

/// A page's table, with a note if the service has older rows.
fn with_remainder(table: String, has_older: bool) -> String {
    if has_older { table + "\nolder ones are omitted; --limit shows more" } else { table }
}

/// Prints the failed points of all sweeps.
pub(crate) fn failures(arguments: &FailuresArguments) -> anyhow::Result<()> {
    let filters = [("owner", &arguments.owner), ("class", &arguments.class)];
    let path = with_filters(format!("/v1/failures?limit={}", arguments.limit), &filters);
    let page: FailureList = Client::new(&arguments.server)?.get(&path)?;
    if arguments.json {
        return print_json(&page);
    }
    print(&failures_text(&page));
    Ok(())
}

fn failures_text(page: &FailureList) -> String {
    let rows: Vec<Vec<String>> = page
        .failures
        .iter()
        .map(|failure| {
            let error = failure.point.error.as_ref();
            vec![
                seconds(failure.at),
                failure.sweep.clone(),
                failure.point.ordinal.to_string(),
                failure.point.attempts.to_string(),
                error.map_or_else(String::new, |error| error.class.as_str().to_owned()),
                error.map_or_else(String::new, |error| error.reason.clone()),
            ]
        })
        .collect();
    let header = ["failed (UTC)", "sweep", "point", "attempts", "class", "error"];
    with_remainder(columns(&header, &rows, numbers_in(&[2, 3])), page.next.is_some())
}

/// Prints a sweep with a line a point, or one point with its results.
pub(crate) fn show(arguments: &ShowArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let id = client.sweep_id(&arguments.sweep)?;
    let path = format!("/v1/sweeps/{}", path_segment(&id));
    if let Some(number) = arguments.point {
        let point: PointDetail = client.get(&format!("{path}/points/{number}"))?;
        if arguments.json {
            return print_json(&point);
        }
        print(&point_text(&point, arguments.units.as_ref()));
        return Ok(());
    }
    let sweep: Sweep = client.get(&path)?;
    let points = client.points(&id)?;
    if arguments.json {
        let mut sweep = json!(sweep);
        sweep["points"] = json!(points);
        return print_json(&sweep);
    }
    print(&sweep_line(&sweep));
    warn_of_bias(&sweep);
    warn_of_doubts(&client, &sweep);
    print(&points_text(&points, arguments.units.as_ref()));
    Ok(())
}

fn points_text(points: &[PointRow], units: Option<&UnitChoice>) -> String {
    let names: Vec<&String> = points.first().into_iter().flat_map(|point| point.parameters.keys()).collect();
    let mut header = vec!["point", "state", "progress", "attempts"];
    let named = |name: &&String| match units.and_then(|units| units.shown(name)) {
        Some(unit) => format!("{name} [{}]", unit.symbol),
        None => (*name).clone(),
    };
    let titles: Vec<String> = names.iter().map(named).collect();
    header.extend(titles.iter().map(String::as_str));
    header.push("error");
    let rows: Vec<Vec<String>> = points
        .iter()
        .map(|point| {
            let mut row = vec![
                point.ordinal.to_string(),
                point.state.to_string(),
                format!("{:.0} %", 100.0 * point.progress),
                point.attempts.to_string(),
            ];
            let value = |name: &&String| {
                let value = point.parameters.get(*name).copied();
                cell(&json!(value.map(|value| in_units(name, value, units))))
            };
            row.extend(names.iter().map(value));
            row.push(point.error.as_ref().map_or_else(String::new, |error| error.reason.clone()));
            row
        })
        .collect();
    let last = header.len() - 1;
    columns(&header, &rows, move |column| match column {
        1 => Alignment::Left,
        column if column == last => Alignment::Left,
        _ => Alignment::Right,
    })
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
    let client = Client::new(&arguments.server)?;
    let id = client.sweep_id(&arguments.sweep)?;
    let sweep: Sweep = client.post(&format!("/v1/sweeps/{}/{verb}", path_segment(&id)), &json!({}))?;
    print_sweep(&sweep, arguments.json)
}

#[derive(Args)]
pub(crate) struct DeleteArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
    sweep: String,
    /// Report what would be deleted, and delete nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Deletes a sweep whose points are final, unless it is pinned.
pub(crate) fn delete(arguments: &DeleteArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let id = client.sweep_id(&arguments.sweep)?;
    let path = format!("/v1/sweeps/{}?dry_run={}", path_segment(&id), arguments.dry_run);
    let deletion: SweepDeletion = client.delete(&path)?;
    if arguments.json {
        return print_json(&deletion);
    }
    print(&deletion_text(&id, &deletion));
    Ok(())
}

fn deletion_text(id: &str, deletion: &SweepDeletion) -> String {
    let verb = if deletion.dry_run { "would be deleted" } else { "deleted" };
    format!(
        "{verb}: {id} with {} points; {} results of {:.1} MB belong to no other sweep and are deleted by the next \
         garbage collection",
        deletion.points,
        deletion.results,
        deletion.bytes as f64 * 1e-6
    )
}

#[derive(Args)]
pub(crate) struct ChangeArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
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
    /// Name; an empty text removes it.
    #[arg(long)]
    name: Option<String>,
    /// Priority among the sweeps of one owner, higher first: -10 to 10.
    #[arg(long, allow_negative_numbers = true)]
    priority: Option<i32>,
    /// Tag of the sweep, in place of its present ones; may be given again.
    #[arg(long = "tag", value_name = "TAG")]
    tags: Vec<String>,
    /// Remove all tags.
    #[arg(long, conflicts_with = "tags")]
    no_tags: bool,
    /// Keep the sweep and its data regardless of age.
    #[arg(long)]
    pin: bool,
    /// Remove the pin: the sweep expires like others.
    #[arg(long, conflicts_with = "pin")]
    unpin: bool,
    /// Time until it is deleted: days as `90d`, hours as `12h`, or `never`.
    #[arg(long)]
    expires: Option<Lifetime>,
}

/// Changes name, tags, priority, pin or expiry of a sweep.
pub(crate) fn change(arguments: &ChangeArguments) -> anyhow::Result<()> {
    let Changes { name, priority, tags, no_tags, pin, unpin, expires } = &arguments.changes;
    let at = |ms| Timestamp::now().checked_add(SignedDuration::from_millis(ms));
    let expires = match expires {
        Some(Lifetime(milliseconds)) => Some(milliseconds.map(at).transpose()?),
        None => None,
    };
    let patch = SweepPatch {
        name: name.clone().map(|name| Some(name).filter(|name| !name.is_empty())),
        priority: *priority,
        tags: (*no_tags || !tags.is_empty()).then(|| tags.iter().cloned().collect()),
        pinned: (*pin || *unpin).then_some(*pin),
        expires,
    };
    let client = Client::new(&arguments.server)?;
    let id = client.sweep_id(&arguments.sweep)?;
    let sweep: Sweep = client.patch(&format!("/v1/sweeps/{}", path_segment(&id)), &patch)?;
    print_sweep(&sweep, arguments.json)
}

/// Prints a sweep in one line, or as JSON.
pub(crate) fn print_sweep(sweep: &Sweep, as_json: bool) -> anyhow::Result<()> {
    if as_json {
        return print_json(sweep);
    }
    print(&sweep_line(sweep));
    Ok(())
}

/// Prints the workers and the depth of the queue.
pub(crate) fn status(arguments: &StatusArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let queue: Queue = client.get("/v1/queue")?;
    let WorkerList { workers } = client.get("/v1/workers")?;
    if arguments.json {
        return print_json(&json!({ "queue": queue, "workers": workers }));
    }
    print(&status_text(&queue, workers));
    Ok(())
}

fn status_text(queue: &Queue, workers: Vec<Worker>) -> String {
    let rows: Vec<Vec<String>> = workers
        .into_iter()
        .map(|worker| {
            let (process, physics) = (worker.process.to_string(), worker.physics_version.to_string());
            vec![worker.id, worker.host, process, worker.version, physics, worker.seen.to_string()]
        })
        .collect();
    let header = ["worker", "host", "process", "version", "physics", "last seen (UTC)"];
    format!(
        "queue: {} waiting, {} paused, {} waiting for a retry, {} running\n{}",
        queue.queued,
        queue.paused,
        queue.waiting_for_retry,
        queue.running,
        columns(&header, &rows, numbers_in(&[2, 4]))
    )
}

/// A sweep in one line, with further ones for the verification of its points and for the reason why queued points wait.
pub(crate) fn sweep_line(sweep: &Sweep) -> String {
    let counts = &sweep.counts;
    let mut line = format!("{} {}: {} points", sweep.id, sweep.state.as_str(), counts.total);
    write_counts(&mut line, &[(counts.succeeded, "succeeded")]);
    write_counts(&mut line, &unfinished(counts));
    if let Some(verification) = &sweep.verification {
        let _ = write!(line, "\n{}", verification_line(verification));
    }
    if let Some(waiting) = &sweep.waiting_for {
        let _ = write!(line, "\n{}", waiting.reason);
    }
    line
}

/// Number of verified points, and the worst bias of orbit size.
pub(crate) fn verification_line(verification: &SweepVerification) -> String {
    let counts = &verification.counts;
    let mut line = format!("verified by the reference: {} of {}", counts.succeeded, counts.total);
    write_counts(&mut line, &unfinished(counts));
    if let Some(worst) = &verification.worst {
        let (statistic, percent) = (&worst.statistic, 100.0 * worst.bias);
        let _ = write!(line, "; bias of {statistic} up to {percent:+.2} % (point {})", worst.ordinal);
        if let Some(promised) = worst.promised {
            let _ = write!(line, ", promised {:.1} %", 100.0 * promised);
        }
    }
    line
}

/// The points that have no result, by state.
fn unfinished(counts: &PointCounts) -> [(u64, &'static str); 4] {
    [
        (counts.running, "running"),
        (counts.queued, "queued"),
        (counts.failed, "failed"),
        (counts.cancelled, "cancelled"),
    ]
}

/// The states that occur.
fn write_counts(line: &mut String, counts: &[(u64, &str)]) {
    for (number, state) in counts.iter().filter(|(number, _)| *number > 0) {
        let _ = write!(line, ", {number} {state}");
    }
}

/// Warns of biases beyond the accuracy's promise, if points were verified.
pub(crate) fn warn_of_bias(sweep: &Sweep) {
    for warning in sweep.verification.iter().flat_map(|verification| &verification.warnings) {
        tracing::warn!("{warning}");
    }
}

/// Warns of points whose statistics have not settled, and of those that state a larger error than their accuracy promises. A sweep without runs in time
/// has neither.
pub(crate) fn warn_of_doubts(client: &Client, sweep: &Sweep) {
    let fields = "ordinal,motion_regime,growing_mode_hz,whole_error,promised_error";
    let path = format!("/v1/sweeps/{}/table?format=json&fields={fields}", path_segment(&sweep.id));
    // Without runs in time the table lacks these columns, and the service refuses them.
    let Ok(table) = client.get::<Value>(&path) else { return };
    for doubt in doubts(&table["columns"]) {
        tracing::warn!("{doubt}");
    }
}

/// Warnings about the points of a table with these columns: those not settled, and those that state more than promised.
fn doubts(columns: &Value) -> Vec<String> {
    let points = columns["ordinal"].as_array().map_or(0, Vec::len);
    let number = |name: &str, row: usize| columns[name][row].as_f64();
    let unsettled = |row: &usize| {
        columns["motion_regime"][*row] == "not_settled" || number("growing_mode_hz", *row).is_some()
    };
    let exceeds = |row: &usize| {
        number("whole_error", *row)
            .zip(number("promised_error", *row))
            .is_some_and(|(stated, promised)| stated > promised)
    };
    let found = |is_it: &dyn Fn(&usize) -> bool, words: &str| {
        const NAMED: usize = 10;
        let rows: Vec<usize> = (0..points).filter(is_it).collect();
        let named: Vec<String> = rows.iter().take(NAMED).map(|&row| cell(&columns["ordinal"][row])).collect();
        let more = if rows.len() > NAMED { ", ..." } else { "" };
        (!rows.is_empty())
            .then(|| format!("{} of {points} points {words}: {}{more}", rows.len(), named.join(", ")))
    };
    [
        found(&unsettled, "have not settled, or a mode still grows"),
        found(&exceeds, "state a larger error than their accuracy promises"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn point_text(point: &PointDetail, units: Option<&UnitChoice>) -> String {
    let mut text = format!("point {} {}\n", point.row.ordinal, point.row.state);
    if let Some(error) = json!(point.row.error).as_object() {
        for (name, value) in error {
            let _ = writeln!(text, "  {name}: {}", cell(value));
        }
    }
    let parameters = point.row.parameters.iter().map(|(name, value)| (name, json!(value)));
    let summary = point.summary.iter().flatten().map(|(name, value)| (name, value.clone()));
    let row = |(name, value): (&String, Value)| {
        let unit = units.map_or_else(|| unit(name), |units| units.unit(name).map(|unit| unit.symbol));
        let unit = unit.filter(|unit| *unit != "1").unwrap_or_default();
        let value = match value.as_f64() {
            Some(number) if units.is_some() && !unit.is_empty() => json!(in_units(name, number, units)),
            _ => value,
        };
        vec![name.clone(), cell(&value), unit.to_owned()]
    };
    let rows: Vec<Vec<String>> = parameters.chain(summary).map(row).collect();
    text.push_str(&columns(&["quantity", "value", "unit"], &rows, numbers_in(&[1])));
    let provenance = point.provenance.iter().flatten();
    let provenance: Vec<Vec<String>> =
        provenance.map(|(name, value)| vec![name.clone(), cell(value)]).collect();
    if !provenance.is_empty() {
        let _ = write!(text, "\n{}", columns(&["provenance", ""], &provenance, numbers_in(&[])));
    }
    text
}

/// A value of a column in the chosen units.
fn in_units(name: &str, value: f64, units: Option<&UnitChoice>) -> f64 {
    units.and_then(|units| units.unit(name)).map_or(value, |unit| unit.written(value))
}

fn print_json(value: &impl Serialize) -> anyhow::Result<()> {
    print(&serde_json::to_string_pretty(value)?);
    Ok(())
}

fn numbers_in(right: &'static [usize]) -> impl Fn(usize) -> Alignment {
    |column| if right.contains(&column) { Alignment::Right } else { Alignment::Left }
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) => match number.as_f64() {
            Some(value) if number.is_f64() => crate::text::number(value),
            _ => number.to_string(),
        },
        value => value.to_string(),
    }
}

/// A time to within the second.
fn seconds(time: Timestamp) -> String {
    time.strftime("%Y-%m-%dT%H:%M:%S").to_string()
}

/// A path with the filters of a list that are given.
pub(crate) fn with_filters(mut path: String, filters: &[(&str, &Option<String>)]) -> String {
    for (name, value) in filters {
        if let Some(value) = value {
            let _ = write!(path, "&{name}={}", path_segment(value));
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use drillsweep_api::view::verification::WorstBias;
    use drillsweep_api::{PointLinks, SweepLinks, WaitingFor};
    use drillsweep_scenario::preset;

    use super::*;

    fn sweep(counts: PointCounts) -> Sweep {
        serde_json::from_value(json!({
            "id": "a", "owner": "default", "state": "running", "counts": counts, "progress": 0.5, "priority": 0,
            "created": "2026-01-01T00:00:00Z", "links": SweepLinks::new("a"),
        }))
        .unwrap()
    }

    #[test]
    fn points_that_are_no_values_yet_are_named() {
        let columns = json!({
            "ordinal": [1, 2, 3, 4],
            "motion_regime": ["regular", "not_settled", "fixed", null],
            "growing_mode_hz": [null, null, 2.16, null],
            "whole_error": [0.024, null, null, null],
            "promised_error": [0.02, 0.02, 0.02, null],
        });
        assert_eq!(
            doubts(&columns),
            [
                "2 of 4 points have not settled, or a mode still grows: 2, 3",
                "1 of 4 points state a larger error than their accuracy promises: 1",
            ]
        );
        assert!(doubts(&json!({ "ordinal": [1], "motion_regime": ["regular"] })).is_empty());
        let many: Vec<_> = (1..=12).collect();
        let columns = json!({ "ordinal": many, "motion_regime": vec!["not_settled"; 12] });
        assert!(doubts(&columns)[0].ends_with("1, 2, 3, 4, 5, 6, 7, 8, 9, 10, ..."));
    }

    #[test]
    fn a_line_names_only_the_states_that_occur() {
        let counts = PointCounts { total: 3, running: 1, succeeded: 2, ..PointCounts::default() };
        assert_eq!(sweep_line(&sweep(counts)), "a running: 3 points, 2 succeeded, 1 running");
    }

    fn point(ordinal: u32, state: &str, more: &Value) -> Value {
        let mut point = json!({
            "ordinal": ordinal, "state": state, "parameters": {"flow_rate": 0.01 * f64::from(ordinal), "mud_density": 1200.0},
            "progress": 1.0, "attempts": 1, "links": PointLinks::new("a", ordinal), "key": "k",
            "scenario": preset("paper-200m"),
        });
        point.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        point
    }

    fn failure() -> Value {
        json!({"error": {"class": "physical", "reason": "no equilibrium: Newton's method does not converge"}})
    }

    fn read<T: serde::de::DeserializeOwned>(value: Value) -> T {
        serde_json::from_value(value).unwrap()
    }

    #[test]
    fn sweeps_are_listed_in_columns() {
        let mut tagged = sweep(PointCounts { total: 120, succeeded: 7, failed: 1, ..PointCounts::default() });
        tagged.name = Some("flow and density".to_owned());
        tagged.varied = read(json!(["flow_rate", "mud_density"]));
        tagged.tags = read(json!(["campaign-7", "draft"]));
        let sweeps = vec![tagged, sweep(PointCounts { total: 1, ..PointCounts::default() })];
        insta::assert_snapshot!(list_text(&SweepList { sweeps, next: Some("cursor".to_owned()) }));
    }

    #[test]
    fn failed_points_are_listed_in_columns() {
        let mut failed = point(2, "failed", &failure());
        for (name, value) in [("sweep", "a"), ("owner", "anne"), ("at", "2026-01-01T00:00:00.5Z")] {
            failed[name] = value.into();
        }
        insta::assert_snapshot!(failures_text(&read(json!({ "failures": [failed] }))));
    }

    #[test]
    fn points_are_listed_in_columns() {
        let running = point(1, "running", &json!({"progress": 0.426}));
        let points = [running, point(2, "failed", &failure()), point(11, "succeeded", &json!({}))];
        insta::assert_snapshot!(points_text(&points.map(read), None));
    }

    #[test]
    fn a_point_is_shown_with_units_and_provenance() {
        let summary = json!({"contact_count": 31, "tension_top": 123456.789, "motion_regime": "regular", "settled_at": null});
        let provenance = json!({"version": "0.1.0", "transient_cpu_time": 12.3456789});
        let more = json!({"summary": summary, "provenance": provenance});
        let succeeded = point_text(&read(point(1, "succeeded", &more)), None);
        let failed = point_text(&read(point(2, "failed", &failure())), None);
        insta::assert_snapshot!(format!("{succeeded}\n\n{failed}"));
    }

    #[test]
    fn queue_and_workers_are_shown() {
        let queue = read(json!({"queued": 5, "paused": 4, "waiting_for_retry": 3, "running": 2}));
        let worker = json!({
            "id": "w-1", "host": "node7", "process": 4711, "version": "0.1.0", "physics_version": 11, "started": "2026-01-01T00:00:00Z",
            "seen": "2026-01-01T01:00:00Z",
        });
        insta::assert_snapshot!(status_text(&queue, vec![read(worker)]));
    }

    #[test]
    fn a_deletion_reports_freed_results() {
        let deletion =
            |dry_run: bool| read(json!({"dry_run": dry_run, "points": 12, "results": 7, "bytes": 1_234_567}));
        let texts = [true, false].map(|dry_run| deletion_text("a", &deletion(dry_run)));
        insta::assert_snapshot!(texts.join("\n"));
    }

    #[test]
    fn a_further_line_says_that_no_worker_is_there() {
        let counts = PointCounts { total: 2, queued: 2, ..PointCounts::default() };
        let waiting = |workers: &[i64]| {
            let waiting_for = Some(WaitingFor::new(11, workers.to_vec()));
            sweep_line(&Sweep { waiting_for, ..sweep(counts) })
        };
        assert_eq!(
            waiting(&[9, 10]),
            "a running: 2 points, 2 queued\n\
             queued points wait for a worker of physics version 11: workers with a heartbeat in the last 100 s compute versions 9, 10"
        );
        assert!(
            waiting(&[]).ends_with("of physics version 11: no worker has sent a heartbeat in the last 100 s")
        );
    }

    #[test]
    fn a_second_line_shows_the_verification() {
        let counts = PointCounts { total: 2, running: 1, succeeded: 1, ..PointCounts::default() };
        let verification = SweepVerification { counts, worst: None, warnings: Vec::new() };
        assert_eq!(verification_line(&verification), "verified by the reference: 1 of 2, 1 running");
        let worst = WorstBias {
            statistic: "orbit_radius_rms_49".to_owned(),
            ordinal: 7,
            bias: 0.4,
            promised: Some(0.02),
        };
        let verification = SweepVerification { worst: Some(worst), ..verification };
        let done = PointCounts { total: 3, succeeded: 3, ..PointCounts::default() };
        assert_eq!(
            sweep_line(&Sweep { verification: Some(verification), ..sweep(done) }),
            "a running: 3 points, 3 succeeded\n\
             verified by the reference: 1 of 2, 1 running; bias of orbit_radius_rms_49 up to +40.00 % (point 7), promised 2.0 %"
        );
    }
}
