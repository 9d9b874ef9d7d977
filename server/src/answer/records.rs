//! Conversion between records of the store and types of the API.

use drillsweep_api::view::points::PointSummary;
use drillsweep_api::view::verification::VerifiedPoint;
use drillsweep_api::{
    ErrorPlace, Expansion, Failure, FailureClass, PointCounts, PointDetail, PointError, PointLinks, PointRow,
    PointState, ProblemKind, Scenario, Sweep, SweepLinks, SweepPoint, SweepRequest, SweepState,
    SweepVerification, compose, key_text,
};
use drillsweep_store::{
    CachePolicy, FailureRecord, NewPoint, NewSweep, NewVerification, PointRecord, ScenarioText, Stage,
    StateCounts, Store, SweepRecord, TableRecord, VerificationRecord, WorkState,
};
use indexmap::IndexMap;
use jiff::Timestamp;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::answer::error::{Error, Result};

/// Owner of sweeps whose request names none.
const DEFAULT_OWNER: &str = "default";

/// A new sweep for the store, from a request and its expansion.
pub(crate) fn new_sweep(
    request: &SweepRequest,
    expansion: &Expansion,
    cache: CachePolicy,
    idempotency_key: Option<(String, [u8; 32])>,
) -> Result<NewSweep> {
    Ok(NewSweep {
        id: uuid::Uuid::now_v7().to_string(),
        name: request.name.clone(),
        owner: request.owner.clone().unwrap_or_else(|| DEFAULT_OWNER.to_owned()),
        request_json: write(request)?,
        varied_json: write(&request.names().collect::<Vec<_>>())?,
        priority: request.priority.into(),
        tags_json: write(&request.tags)?,
        cache,
        idempotency_key,
        base_json: write(&expansion.base)?,
        physics_version: drillsweep_api::PHYSICS_VERSION.into(),
        points: new_points(expansion)?,
        verification: match &expansion.verification {
            Some(references) => new_verification(references)?,
            None => NewVerification::default(),
        },
    })
}

/// New reference runs for the store.
pub(crate) fn new_verification(references: &Expansion) -> Result<NewVerification> {
    Ok(NewVerification { base_json: write(&references.base)?, runs: new_points(references)? })
}

/// New points for the store.
pub(crate) fn new_points(expansion: &Expansion) -> Result<Vec<NewPoint>> {
    let new_point = |point: &SweepPoint| {
        Ok(NewPoint {
            ordinal: point.ordinal.into(),
            parameters_json: write(&expansion.parameters(point))?,
            work_key: point.key,
            fuller_key: point.fuller_key,
            changes_json: write(&expansion.changes(point))?,
        })
    };
    expansion.points.iter().map(new_point).collect()
}

/// A sweep of the API without its requests.
pub(crate) fn sweep(record: &SweepRecord) -> Result<Sweep> {
    let state = match (record.is_cancelled, record.finished) {
        (true, _) => SweepState::Cancelled,
        (false, Some(_)) => SweepState::Completed,
        (false, None) if record.is_paused => SweepState::Paused,
        (false, None) => SweepState::Running,
    };
    let total = record.counts.total + record.verification.total;
    let progress = match record.finished {
        Some(_) => 1.0,
        None => (record.progress / (total.max(1) as f64)).clamp(0.0, 1.0),
    };
    let verification = (record.verification.total > 0).then(|| SweepVerification {
        counts: counts(&record.verification),
        worst: None,
        warnings: Vec::new(),
    });
    Ok(Sweep {
        id: record.id.clone(),
        name: record.name.clone(),
        owner: record.owner.clone(),
        state,
        counts: counts(&record.counts),
        verification,
        progress,
        waiting_for: None,
        priority: record.priority,
        created: timestamp(record.created)?,
        finished: record.finished.map(timestamp).transpose()?,
        pinned: record.is_pinned,
        expires: record.expires.map(timestamp).transpose()?,
        revision: record.revision.unsigned_abs(),
        warnings: Vec::new(),
        refinement: None,
        request: None,
        tags: read(&record.tags_json)?,
        varied: read(&record.varied_json)?,
        appended: Vec::new(),
        links: SweepLinks::new(&record.id),
    })
}

fn counts(counts: &StateCounts) -> PointCounts {
    PointCounts {
        total: counts.total.unsigned_abs(),
        queued: counts.queued.unsigned_abs(),
        running: counts.running.unsigned_abs(),
        succeeded: counts.done.unsigned_abs(),
        failed: counts.failed.unsigned_abs(),
        cancelled: counts.cancelled.unsigned_abs(),
    }
}

/// A point's row in a list.
pub(crate) fn point_row(sweep: &str, record: &PointRecord) -> Result<PointRow> {
    let state = point_state(record.state);
    Ok(PointRow {
        ordinal: ordinal(record.ordinal)?,
        state,
        parameters: read(&record.parameters_json)?,
        progress: if state == PointState::Succeeded { 1.0 } else { record.progress },
        attempts: record.attempts.unsigned_abs(),
        error: record.error_json.as_deref().map(|text| point_error(record.state, text)),
        links: PointLinks::new(sweep, ordinal(record.ordinal)?),
    })
}

/// A point in the list of failures.
pub(crate) fn failure(record: &FailureRecord) -> Result<Failure> {
    Ok(Failure {
        sweep: record.sweep_id.clone(),
        sweep_name: record.sweep_name.clone(),
        owner: record.owner.clone(),
        at: timestamp(record.at)?,
        point: point_row(&record.sweep_id, &record.point)?,
    })
}

/// A point without its tables.
pub(crate) fn point_detail(sweep: &str, record: &PointRecord, tables: Vec<String>) -> Result<PointDetail> {
    let scenario = scenario(record)?;
    let row = point_row(sweep, record)?;
    let node = row.error.as_ref().and_then(|error| error.node);
    Ok(PointDetail {
        error_place: node.and_then(|node| ErrorPlace::of(&scenario, node)),
        row,
        key: key_text(&record.work_key),
        scenario: Box::new(scenario),
        summary: record.summary_json.as_deref().map(read).transpose()?,
        provenance: record.provenance_json.as_deref().map(read).transpose()?,
        tables,
    })
}

/// Scenario of a point.
pub(crate) fn scenario(record: &PointRecord) -> Result<Scenario> {
    let Some(ScenarioText { base_json, changes_json }) = &record.scenario else {
        return Err(Error::internal("a point was read without its scenario"));
    };
    compose(base_json, changes_json).map_err(|problem| Error::internal(&problem))
}

/// Frequency up to which the steps of a point's run resolve vibrations \[Hz\]; `None` if the result does not state it.
pub(crate) fn resolved_hz(record: &PointRecord) -> Result<Option<f64>> {
    let summary: Option<Value> = record.summary_json.as_deref().map(read).transpose()?;
    Ok(summary.and_then(|summary| summary.get("resolved_hz")?.as_f64()))
}

/// A point with the reference run that verifies it.
pub(crate) fn verified_point(record: &VerificationRecord) -> Result<VerifiedPoint> {
    Ok(VerifiedPoint {
        ordinal: ordinal(record.ordinal)?,
        parameters: read(&record.parameters_json)?,
        statistics: record.summary_json.as_deref().map(read).transpose()?,
        state: point_state(record.state),
        reference: record.reference_json.as_deref().map(read).transpose()?,
        error: record.error_json.as_deref().map(|text| point_error(record.state, text)),
    })
}

/// A point's row in the table of its sweep, without biases; its summary is moved.
pub(crate) fn point_summary(record: &mut TableRecord) -> Result<PointSummary> {
    Ok(PointSummary {
        ordinal: ordinal(record.ordinal)?,
        state: point_state(record.state),
        parameters: read(&record.parameters_json)?,
        summary: record.summary_json.take(),
        biases: IndexMap::new(),
        error: record.error_json.as_deref().map(|text| point_error(record.state, text)),
    })
}

/// The parameters of a point, by axis name.
pub(crate) fn parameters(json: &str) -> Result<IndexMap<String, f64>> {
    read(json)
}

/// State of a point, from that of its work item.
pub(crate) fn point_state(state: WorkState) -> PointState {
    match state.stage() {
        Stage::Queued => PointState::Queued,
        Stage::Running => PointState::Running,
        Stage::Done => PointState::Succeeded,
        Stage::Failed => PointState::Failed,
        Stage::Cancelled => PointState::Cancelled,
    }
}

/// States of work items that are one state of points.
pub(crate) fn work_states(state: PointState) -> Vec<WorkState> {
    WorkState::ALL.into_iter().filter(|work| point_state(*work) == state).collect()
}

/// Error of a failed point; a text of another form than that of workers becomes the reason.
fn point_error(state: WorkState, text: &str) -> PointError {
    serde_json::from_str(text).unwrap_or_else(|_| PointError {
        class: match state {
            WorkState::Dead => FailureClass::Crash,
            _ => FailureClass::Infrastructure,
        },
        reason: text.to_owned(),
        time: None,
        node: None,
        details: Map::new(),
    })
}

/// Problem of a point, or its sweep, that does not exist.
pub(crate) async fn no_such_point(store: &Store, sweep: &str, n: u32) -> Result<Error> {
    Ok(match store.sweep(sweep).await? {
        None => no_such_sweep(sweep),
        Some(record) => {
            let detail =
                format!("sweep {sweep} has no point {n}; its points are 1 to {}", record.counts.total);
            Error::new(ProblemKind::NotFound, detail)
        }
    })
}

/// Problem of a sweep that does not exist.
pub(crate) fn no_such_sweep(id: &str) -> Error {
    Error::new(ProblemKind::NotFound, format!("there is no sweep {id}"))
}

/// A time of the store, in milliseconds since the epoch.
pub(crate) fn timestamp(milliseconds: i64) -> Result<Timestamp> {
    Timestamp::from_millisecond(milliseconds).map_err(|error| Error::internal(&error))
}

fn ordinal(number: i64) -> Result<u32> {
    u32::try_from(number).map_err(|error| Error::internal(&error))
}

pub(crate) fn write(value: &impl serde::Serialize) -> Result<String> {
    serde_json::to_string(value).map_err(|error| Error::internal(&error))
}

pub(crate) fn read<T: DeserializeOwned>(text: &str) -> Result<T> {
    serde_json::from_str(text).map_err(|error| Error::internal(&error))
}
