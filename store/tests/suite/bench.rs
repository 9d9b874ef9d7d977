//! Trait of an engine in the tests, and functions that they share.

use drillsweep_store::{
    Addition, CachePolicy, Claim, Finished, NewArtifact, NewPoint, NewResult, NewSweep, NewVerification,
    PointRecord, Role, ScenarioText, Store, StoreConfig, SubmitOutcome, SweepRecord, WorkKey, WorkState,
};

use crate::place::Object;

pub(crate) const PHYSICS: i64 = 1;
pub(crate) const LEASE_MS: i64 = 60_000;

/// An engine of the store, as far as the tests must know it: a place for data that is its own and goes with it. All that it
/// says about objects and the database is found out past the store.
pub(crate) trait Engine {
    /// A place with nothing in it.
    fn new() -> Self;

    /// Configuration that opens the store in this place.
    fn config(&self, role: Role, clock_offset_ms: i64) -> StoreConfig;

    /// Everything in the object store, by name.
    fn objects(&self) -> Vec<Object>;

    /// Writes or overwrites an object.
    fn write_object(&self, name: &str, content: &[u8]);

    /// Deletes an object.
    fn delete_object(&self, name: &str);

    /// Leaves what a writer leaves in a directory that is killed before it has written an object of this content: `object_store` writes
    /// beside the object, with a number.
    fn abandon_upload(&self, content: &[u8]) {
        self.write_object("ab/cd/abcd0123#1", content);
    }

    /// From now on no object can be written to a directory whose name begins with `probe/`: a file where the folder should be stops
    /// every user; permissions would not stop root.
    fn refuse_scratch_objects(&self) {
        self.write_object("probe", b"");
    }

    /// True if the database has these bytes anywhere on its disk, whatever column they are in.
    fn database_holds(&self, bytes: &[u8]) -> bool;

    /// The store, as it is now.
    async fn open(&self) -> Store {
        self.after(0).await
    }

    /// The same store some milliseconds later, over connections of its own.
    async fn after(&self, milliseconds: i64) -> Store {
        Store::open(&self.config(Role::Server, milliseconds)).await.unwrap()
    }

    /// Size of everything in the object store.
    fn bytes_of_objects(&self) -> u64 {
        self.objects().iter().map(|object| object.bytes).sum()
    }
}

/// Value of a JSON text: engines write it with and without spaces.
pub(crate) fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

/// A work key that sorts against the order of its number, so that an order by key cannot pass for one by time.
pub(crate) fn key(number: u32) -> WorkKey {
    let mut key = [0x5a; 32];
    key[..4].copy_from_slice(&(u32::MAX - number).to_be_bytes());
    key
}

/// A sweep over the given work items.
pub(crate) fn sweep(id: &str, numbers: impl IntoIterator<Item = u32>) -> NewSweep {
    let point = |(index, number)| NewPoint {
        ordinal: index as i64 + 1,
        parameters_json: format!(r#"{{"flow_rate":{number}}}"#),
        work_key: key(number),
        fuller_key: None,
        changes_json: scenario(id, number).changes_json,
    };
    NewSweep {
        id: id.to_owned(),
        name: Some(format!("sweep {id}")),
        owner: "anne".to_owned(),
        request_json: format!(r#"{{"request":"{id}"}}"#),
        priority: 0,
        varied_json: r#"["flow_rate"]"#.to_owned(),
        tags_json: "[]".to_owned(),
        cache: CachePolicy::Reuse,
        idempotency_key: None,
        base_json: scenario(id, 0).base_json,
        physics_version: PHYSICS,
        points: numbers.into_iter().enumerate().map(point).collect(),
        verification: NewVerification::default(),
    }
}

/// The same with runs that verify some of its points: for each the point's ordinal and the run's work item.
pub(crate) fn verified(sweep: NewSweep, runs: &[(i64, u32)]) -> NewSweep {
    NewSweep { verification: verification(runs), ..sweep }
}

/// Runs that verify points: for each the point's ordinal and the run's work item.
pub(crate) fn verification(runs: &[(i64, u32)]) -> NewVerification {
    let run = |&(ordinal, number): &(i64, u32)| NewPoint {
        ordinal,
        parameters_json: format!(r#"{{"flow_rate":{number}}}"#),
        work_key: key(number),
        fuller_key: None,
        changes_json: scenario("", number).changes_json,
    };
    NewVerification { base_json: scenario("reference", 0).base_json, runs: runs.iter().map(run).collect() }
}

/// Points to add to a sweep, without runs that verify them.
pub(crate) fn addition<'a>(
    base_json: &'a str,
    points: &'a [NewPoint],
    request_json: &'a str,
) -> Addition<'a> {
    static NONE: NewVerification = NewVerification { base_json: String::new(), runs: Vec::new() };
    Addition { base_json, physics_version: PHYSICS, points, verification: &NONE, request_json }
}

/// The scenario of a work item of a sweep.
pub(crate) fn scenario(id: &str, number: u32) -> ScenarioText {
    ScenarioText {
        base_json: format!(r#"{{"scenario":"{id}"}}"#),
        changes_json: format!(r#"{{"number":{number}}}"#),
    }
}

pub(crate) async fn submit(store: &Store, sweep: &NewSweep) {
    assert_eq!(store.submit_sweep(sweep).await.unwrap(), SubmitOutcome::Created);
}

/// The next work item, claimed by `worker`.
pub(crate) async fn claim(store: &Store, worker: &str) -> Claim {
    claim_or_none(store, worker).await.expect("work is ready")
}

pub(crate) async fn claim_or_none(store: &Store, worker: &str) -> Option<Claim> {
    store.claim(worker, PHYSICS, LEASE_MS).await.unwrap()
}

pub(crate) async fn finish(store: &Store, claim: &Claim) -> bool {
    let artifacts = [artifact(store, claim).await];
    let summary = summary(claim);
    store.finish_done(&claim.lease, &result(&summary, &artifacts)).await.unwrap()
}

/// The same, and the next work item for the same worker.
pub(crate) async fn finish_and_claim(store: &Store, claim: &Claim) -> Finished {
    let artifacts = [artifact(store, claim).await];
    let summary = summary(claim);
    let result = result(&summary, &artifacts);
    store.finish_and_claim(&claim.lease, &result, PHYSICS, LEASE_MS).await.unwrap()
}

async fn artifact(store: &Store, claim: &Claim) -> NewArtifact {
    NewArtifact {
        name: "history".to_owned(),
        media_type: "application/vnd.apache.parquet".to_owned(),
        blob: store.put_blob(claim.lease.key.to_vec()).await.unwrap(),
        bytes: 32,
        row_count: 7,
    }
}

fn summary(claim: &Claim) -> String {
    format!(r#"{{"by":"{}"}}"#, claim.lease.worker)
}

pub(crate) fn result<'a>(summary_json: &'a str, artifacts: &'a [NewArtifact]) -> NewResult<'a> {
    NewResult { summary_json, provenance_json: r#"{"version":"test"}"#, artifacts, is_repeatable: true }
}

pub(crate) async fn sweep_record(store: &Store, id: &str) -> SweepRecord {
    store.sweep(id).await.unwrap().expect("the sweep is there")
}

pub(crate) async fn point_record(store: &Store, id: &str, ordinal: i64) -> PointRecord {
    store.point(id, ordinal).await.unwrap().expect("the point is there")
}

pub(crate) async fn states(store: &Store, id: &str) -> Vec<WorkState> {
    store.points(id, &[], 0, 1_000).await.unwrap().into_iter().map(|point| point.state).collect()
}
