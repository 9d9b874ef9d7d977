//! Addition of points to a sweep.

use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use drillsweep_api::{
    AppendRequest, LIMITS, PHYSICS_VERSION, ProblemKind, RefinedSamples, RefinementState, Sweep,
    SweepRequest, expand_added, sample,
};
use drillsweep_store::{Addition, AppendOutcome, NewVerification, Store};
use tokio::runtime::Handle;

use crate::answer::error::{Error, Result};
use crate::answer::extract::{self, Path};
use crate::answer::json::Json;
use crate::answer::records;
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::guard::quota;
use crate::openapi::answers::Problems;
use crate::route::sweeps::expand::{expand_body, make_room};
use crate::route::sweeps::{load, state};
use crate::route::verification::Verified;

/// Most text of the requests that added points to a sweep: an export has all of them \[bytes\].
const APPENDED_BYTES: u64 = 16 << 20;

/// Add points to a sweep
///
/// Points of the sweep's scenario with other values of its parameters, in any design, numbered after its last point. Points that the sweep
/// has already are skipped, so that a finer grid can be requested as a whole, and repeating a request changes nothing. Added points are
/// verified until the whole sweep has its share `verify`.
///
/// `refine` takes the place of a design: it divides edges between neighbouring points whose classes, or values of a column, differ, once in
/// their middle. Repeat it when the new points have results, until `refinement.open_edges` is 0; `drillsweep refine` and `Sweep.refine` do so.
#[utoipa::path(
    post,
    path = "/v1/sweeps/{id}/points",
    tag = "sweeps",
    operation_id = "append_points",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    request_body = AppendRequest,
    responses((status = 200, description = "The sweep with the new points", body = Sweep), Problems)
)]
pub(crate) async fn append(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    body: extract::Body,
) -> Result<Json<Sweep>> {
    let sweep = state(&app, &id).await?;
    let original = app.store.request_json(&id).await?.ok_or_else(|| records::no_such_sweep(&id))?;
    let samples = SweepPoints {
        store: app.store.clone(),
        runtime: Handle::current(),
        id: id.clone(),
        count: sweep.counts.total as usize,
    };
    let config = app.config.clone();
    let expanded = expand_body(&app, &caller, &body, move |added: AppendRequest, work, memory| {
        let mut added = added.in_model_signs();
        let original: SweepRequest = records::read(&original)?;
        let mut refinement = None;
        if let Some(refine) = added.refinement()? {
            let refined = RefinedSamples::new(refine.clone(), &original, &config.operating_limits)?;
            if let Err(needed) = samples.make_room(work, memory) {
                return Ok(Err(needed));
            }
            let (points, state) = samples.refine(refined, work)?;
            refinement = Some(state);
            if points.points.is_empty() {
                return Ok(Ok((refinement, None)));
            }
            added = points;
        }
        let request_json = records::write(&added)?;
        let request = added.of(&original)?;
        if let Err(needed) = make_room(work, memory, &request) {
            return Ok(Err(needed));
        }
        let expansion = expand_added(&request, &original, &|| work.check())?;
        let points = records::new_points(&expansion)?;
        Ok(Ok((refinement, Some((request_json, expansion, points, original.verify)))))
    });
    let ((refinement, added), _memory) = expanded.await?;
    let Some((request_json, expansion, points, verify)) = added else {
        return Ok(Json(Sweep { refinement, ..load(&app, &id).await? }));
    };
    let (expansion, verification) = match verify {
        None => (expansion, NewVerification::default()),
        Some(verify) => {
            let lacking = app.store.lacking_points(&id, &points).await?;
            let verified = sweep.verification.as_ref().map_or(0, |verification| verification.counts.total);
            let total = sweep.counts.total as usize + lacking.len();
            let place = app.expansions.enter(caller.budget(), 0).await?;
            let verify = move |work: &mut Work| {
                let sample = sample(verify, total, verified as usize, lacking.len());
                // Ordinals of the expansion count from 1.
                let sample: Vec<usize> =
                    sample.into_iter().map(|index| lacking[index] as usize - 1).collect();
                let references = expansion.references(&sample, &|| work.check())?;
                let verification = records::new_verification(&references)?;
                Ok((expansion, verification))
            };
            place.run(verify).await?.0
        }
    };
    let appended = app.store.appended_bytes(&id).await?.unsigned_abs() + request_json.len() as u64;
    if appended > APPENDED_BYTES {
        let detail = format!(
            "the requests that added points to sweep {id} would have {appended} bytes; at most {APPENDED_BYTES} are kept with a \
             sweep; submit a new one"
        );
        return Err(Error::new(ProblemKind::Conflict, detail));
    }
    quota::check_open_points(&app, &sweep.owner, points.len() + verification.runs.len()).await?;
    let base_json = records::write(&expansion.base)?;
    let addition = Addition {
        base_json: &base_json,
        physics_version: PHYSICS_VERSION.into(),
        points: &points,
        verification: &verification,
        request_json: &request_json,
    };
    let most = LIMITS.points_per_sweep as u64;
    match app.store.append_points(&id, &addition, most).await? {
        AppendOutcome::Added(_) => {}
        AppendOutcome::NoSuchSweep => return Err(records::no_such_sweep(&id)),
        AppendOutcome::Cancelled => {
            return Err(Error::new(
                ProblemKind::Conflict,
                format!("sweep {id} is cancelled; retry it first"),
            ));
        }
        AppendOutcome::OtherNumbers(version) => {
            let detail = format!(
                "the points of sweep {id} are of physics version {version}, and this service computes version \
                 {PHYSICS_VERSION}: points of both in one sweep would not be comparable; submit a new one"
            );
            return Err(Error::new(ProblemKind::Conflict, detail));
        }
        AppendOutcome::TooMany(total) => {
            let detail = format!("the sweep would have {total} points; a sweep has at most {most}");
            return Err(Error::new(ProblemKind::Conflict, detail));
        }
    }
    Ok(Json(Sweep { warnings: expansion.warnings, refinement, ..load(&app, &id).await? }))
}

/// Points of a sweep that a refinement reads.
#[derive(Clone)]
struct SweepPoints {
    store: Store,
    runtime: Handle,
    id: String,
    count: usize,
}

impl SweepPoints {
    /// Memory of a point as a sample \[bytes\].
    const MEMORY: usize = 200;

    /// Processor time of reading a point's row.
    const TIME: Duration = Duration::from_micros(300);

    /// Takes memory and processor time for the samples.
    ///
    /// # Errors
    /// The needed memory \[bytes\], if it is not free.
    fn make_room(&self, work: &mut Work, of_reading: usize) -> std::result::Result<(), usize> {
        let needed = of_reading + self.count * Self::MEMORY;
        if !work.grow(needed) {
            return Err(needed);
        }
        work.allow(Self::TIME * self.count as u32);
        Ok(())
    }

    /// Request for the points of a refinement, with its state. Blocks.
    fn refine(&self, mut samples: RefinedSamples, work: &Work) -> Result<(AppendRequest, RefinementState)> {
        Verified::default().each_point(&self.store, &self.id, &self.runtime, |point| samples.push(&point))?;
        work.check()?;
        Ok(samples.finish()?)
    }
}
