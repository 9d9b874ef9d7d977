//! Whole sweeps as zip archives, written while they are sent.

use std::io::{self, Write};

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use drillsweep_api::judgement::OperatingLimits;
use drillsweep_api::{ExportManifest, MissingFile};
use drillsweep_store::{Artifact, Store, WorkKey};
use drillsweep_table::csv;
use serde::Deserialize;
use tokio::runtime::Handle;
use tokio::sync::mpsc;
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

use crate::answer::blocking::beside;
use crate::answer::body::{Sink, WAITING_CHUNKS};
use crate::answer::chunk;
use crate::answer::error::{Error, Result};
use crate::answer::extract::{Path, Query, memory_of_reading, value};
use crate::answer::stored::Stored;
use crate::app::App;
use crate::app::lane::Place;
use crate::openapi::answers::Problems;
use crate::route::sweeps::{load_whole, state};
use crate::route::verification::{Verified, memory_of_points};

/// Number of points whose files are looked up at once.
const PAGE: i64 = 200;

/// Query of an archive.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExportQuery {
    /// Names of the files of each point, separated by commas; absent means all, empty means none.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>, example = "profile,statics")]
    artifacts: Option<Vec<String>>,
}

/// A whole sweep as one archive
///
/// A zip file with `sweep.json` (request and state), `table.csv` (a row a point), `verification.csv` (a row a verified point, if there are
/// any), the files of all points with results, such as `points/1/history.parquet`, and last `manifest.json` with missing files and reasons
/// (`ExportManifest`). It is written while it is sent: its size is not known in advance, and an archive that breaks off has no directory at
/// its end, so that programs refuse it.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/export",
    tag = "sweeps",
    operation_id = "export_sweep",
    params(("id" = String, Path, description = "Identifier of the sweep"), ExportQuery),
    responses((status = 200, description = "The archive", body = Vec<u8>, content_type = "application/zip"), Problems)
)]
pub(crate) async fn export(
    State(app): State<App>,
    Path(id): Path<String>,
    Query(query): Query<ExportQuery>,
) -> Result<Response> {
    let total = state(&app, &id).await?.counts.total;
    let requests = app.store.request_bytes(&id).await?.unwrap_or(0) + app.store.appended_bytes(&id).await?;
    let of_requests = memory_of_reading(requests.unsigned_abs() as usize) as u64;
    // Taken before the answer begins, which could only break off without memory for the table.
    let memory = app.view(of_requests + memory_of_points(&app, &id, total).await?).await?;
    let sweep = load_whole(&app, &id).await?;
    let sweep = serde_json::to_vec_pretty(&sweep).map_err(|error| Error::internal(&error))?;
    let (held, allowance) = app.file().await?;
    let (sender, receiver) = mpsc::channel(WAITING_CHUNKS);
    let archive = Archive {
        store: app.store,
        id: id.clone(),
        points: total,
        wanted: query.artifacts,
        limits: app.config.operating_limits.clone(),
        handle: Handle::current(),
    };
    beside(move || {
        let _held = held;
        let mut sink = Sink::new(sender, archive.handle.clone(), None, allowance);
        match archive.write(&mut sink, &sweep, memory) {
            Ok(()) => sink.finish(),
            // A client that has gone away is not logged.
            Err(_) if sink.is_abandoned() => {}
            Err(error) => sink.fail(Error::internal(&error)),
        }
    })?;
    let body = chunk::body(None, receiver);
    let name = format!("attachment; filename=\"sweep-{id}.zip\"");
    let headers = [(header::CONTENT_TYPE, "application/zip".to_owned()), (header::CONTENT_DISPOSITION, name)];
    Ok((headers, body).into_response())
}

type Zip<'s> = ZipWriter<StreamWriter<&'s mut Sink>>;

/// An archive, written by a blocking thread.
struct Archive {
    store: Store,
    id: String,
    points: u64,
    wanted: Option<Vec<String>>,
    limits: OperatingLimits,
    handle: Handle,
}

impl Archive {
    /// Writes the archive; the memory of the table is given back once that is written.
    fn write(&self, sink: &mut Sink, sweep: &[u8], memory: Place) -> io::Result<()> {
        let mut zip = ZipWriter::new_stream(&mut *sink);
        let text = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        zip.start_file("sweep.json", text)?;
        zip.write_all(sweep)?;
        let verified = self.handle.block_on(Verified::load(&self.store, &self.id)).map_err(failed)?;
        zip.start_file("table.csv", text.large_file(true))?;
        self.write_table(&verified, &mut zip)?;
        drop(memory);
        if !verified.points.is_empty() {
            zip.start_file("verification.csv", text)?;
            csv::write_to(&verified.table(), &mut zip).map_err(io::Error::other)?;
        }
        let mut manifest = ExportManifest::default();
        if self.wanted.as_ref().is_none_or(|wanted| !wanted.is_empty()) {
            self.write_points(&mut zip, &mut manifest)?;
        }
        zip.start_file("manifest.json", text)?;
        serde_json::to_writer_pretty(&mut zip, &manifest)?;
        zip.finish()?;
        Ok(())
    }

    fn write_table(&self, verified: &Verified, zip: &mut Zip<'_>) -> io::Result<()> {
        let points = verified.points(&self.store, &self.id, self.points, &self.handle).map_err(failed)?;
        let classes = points.classes(&self.limits);
        csv::write_to(&points.finish(Some(classes)), zip).map_err(io::Error::other)
    }

    fn write_points(&self, zip: &mut Zip<'_>, manifest: &mut ExportManifest) -> io::Result<()> {
        let mut after = 0;
        loop {
            let page = self.store.point_artifacts(&self.id, after, PAGE);
            let page = self.handle.block_on(page).map_err(io::Error::other)?;
            let Some((last, ..)) = page.last() else { return Ok(()) };
            after = *last;
            for (ordinal, key, artifacts) in &page {
                for artifact in artifacts {
                    if !self.wanted.as_ref().is_none_or(|wanted| wanted.contains(&artifact.name)) {
                        continue;
                    }
                    // One unreadable file must not prevent the others.
                    match self.verified(key, artifact) {
                        Ok(stored) => {
                            self.write_artifact(zip, *ordinal, artifact, &stored)?;
                            manifest.files += 1;
                        }
                        Err(error) => manifest.missing.push(MissingFile {
                            point: u32::try_from(*ordinal).unwrap_or(u32::MAX),
                            table: artifact.name.clone(),
                            reason: error.into_problem().detail,
                        }),
                    }
                }
            }
        }
    }

    /// Verifies a file in advance: once begun in the archive it can no longer be left out.
    fn verified(&self, key: &WorkKey, artifact: &Artifact) -> Result<Stored> {
        let _runtime = self.handle.enter();
        let stored = Stored::new(&self.store, key, artifact.clone())?;
        self.handle.block_on(stored.verify())?;
        Ok(stored)
    }

    fn write_artifact(
        &self,
        zip: &mut Zip<'_>,
        ordinal: i64,
        artifact: &Artifact,
        stored: &Stored,
    ) -> io::Result<()> {
        let extension = if artifact.media_type == "application/json" { "json" } else { "parquet" };
        // Parquet is already compressed.
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        zip.start_file(
            format!("points/{ordinal}/{}.{extension}", artifact.name),
            options.large_file(stored.length() > 1 << 31),
        )?;
        for part in Stored::parts(0..stored.length()) {
            zip.write_all(&self.handle.block_on(stored.range(part)).map_err(failed)?)?;
        }
        Ok(())
    }
}

fn failed(error: Error) -> io::Error {
    io::Error::other(error.into_problem().detail)
}
