//! The tables that workers stored, as they are read back.

use std::collections::BTreeSet;
use std::ops::Range;

use axum::body::Bytes;
use drillsweep_api::view::node::{self, Choice, Recorded};
use drillsweep_api::view::orbit::Motion;
use drillsweep_api::view::spectrum::{FullSpectrum, KeptWindow, Weighting};
use drillsweep_api::{PHYSICS_VERSION, PointState, ProblemDetails, ProblemKind};
use drillsweep_chart::{Hole, Place};
use drillsweep_store::{Artifact, BlobId, Repair, Store, WorkKey};
use drillsweep_table::parquet::{self, StoredTable};
use drillsweep_table::quantity::columns::*;
use drillsweep_table::quantity::{Name, tables};
use drillsweep_table::{Column, Quantity, Table, TableError};

use crate::answer::error::{Error, Result};
use crate::answer::records;

/// One table of a point's result, as Parquet.
pub(crate) async fn load(store: &Store, sweep: &str, n: u32, name: &str) -> Result<Bytes> {
    let key = result_key(store, sweep, n).await?;
    load_of(store, &key, name).await
}

async fn load_of(store: &Store, key: &WorkKey, name: &str) -> Result<Bytes> {
    let artifact = find(store, key, name).await?;
    read(store, key, &artifact, None).await
}

/// The bytes of a table, or a range of them. Where storage has lost it, its point is computed again, and the problem says so.
pub(crate) async fn read(
    store: &Store,
    key: &WorkKey,
    artifact: &Artifact,
    range: Option<Range<u64>>,
) -> Result<Bytes> {
    check_age(artifact)?;
    let blob: BlobId = artifact.blob.parse()?;
    let bytes = match range {
        None => store.blobs().get(blob).await,
        Some(range) => store.blobs().get_range(blob, range).await,
    };
    match bytes {
        Err(error) if error.is_damage() => {
            tracing::error!(%error, table = artifact.name, "a stored table is damaged");
            let repair = store.queue_damaged(key, blob, PHYSICS_VERSION.into()).await?;
            Err(damaged(&artifact.name, repair))
        }
        bytes => Ok(bytes?),
    }
}

/// Refuses a table that has reached its age.
pub(crate) fn check_age(artifact: &Artifact) -> Result<()> {
    let Some(expired) = artifact.expired else { return Ok(()) };
    let detail = format!(
        "the table {} expired at {}; the summary is kept, and a sweep submitted with ?cache=refresh recomputes the point",
        artifact.name,
        records::timestamp(expired)?
    );
    Err(Error::new(ProblemKind::Expired, detail))
}

/// The problem that a table is lost, with what becomes of it.
fn damaged(name: &str, repair: Repair) -> Error {
    let consequence = match repair {
        Repair::Queued | Repair::UnderWay => {
            "the point is being computed again; ask again when it is done".to_owned()
        }
        Repair::TriedBefore => "computing the point again has brought no result, and its `error` says why; \
                                submit it again to have another try"
            .to_owned(),
        Repair::OtherNumbers(version) => format!(
            "it is of physics version {version}, which nobody computes any more: submit the scenario again, for version \
             {PHYSICS_VERSION}"
        ),
        Repair::Replaced => return Error::unavailable("a table was replaced while it was read"),
    };
    let detail = format!(
        "the table {name} is lost or was changed in storage, and nothing of it is served; {consequence}"
    );
    Error::new(ProblemKind::Damaged, detail)
}

/// Where a table of a result is, or was until it expired.
pub(crate) async fn find(store: &Store, key: &WorkKey, name: &str) -> Result<Artifact> {
    let mut artifacts = store.artifacts(key).await?;
    if let Some(index) = artifacts.iter().position(|artifact| artifact.name == name) {
        return Ok(artifacts.swap_remove(index));
    }
    let names: Vec<_> = artifacts.iter().map(|artifact| artifact.name.as_str()).collect();
    let detail = match names.as_slice() {
        [] => format!("the run has no table {name}: its `outputs` keep the summary only"),
        names => format!("the run has no table {name}; it has {}", names.join(", ")),
    };
    Err(Error::new(ProblemKind::NoSuchTable, detail))
}

/// The key of a point that has a result, even while it is being recomputed.
pub(crate) async fn result_key(store: &Store, sweep: &str, n: u32) -> Result<WorkKey> {
    let Some(point) = store.point(sweep, n.into()).await? else {
        return Err(records::no_such_point(store, sweep, n).await?);
    };
    if point.summary_json.is_some() {
        return Ok(point.work_key);
    }
    let state = records::point_state(point.state);
    let detail = match state {
        PointState::Queued | PointState::Running => {
            format!("point {n} is {state}: its result is not there yet")
        }
        _ => format!("point {n} is {state}: it has no result"),
    };
    Err(ProblemDetails { state: Some(state), ..ProblemDetails::new(ProblemKind::NoResult, detail) }.into())
}

/// Columns of a stored table, or all of them, for the wire.
pub(crate) fn decode(bytes: Bytes, columns: Option<&[&str]>) -> Result<Table, TableError> {
    Ok(parquet::read(bytes, columns, None)?.widened())
}

/// The recorded histories of a run, and where their nodes are.
pub(crate) struct Recording {
    history: Bytes,
    statics: Bytes,
}

/// Full spectra that were kept in place of histories, and where their nodes are.
pub(crate) struct KeptSpectra {
    spectra: Bytes,
    statics: Bytes,
}

/// Where the full spectra of a run come from.
pub(crate) enum SpectrumSource {
    /// Histories: any window.
    Recording(Recording),
    /// The spectra themselves.
    Kept(KeptSpectra),
}

/// One full spectrum.
pub(crate) struct NodeSpectrum {
    pub(crate) node: u32,
    measured_depth: f64,
    pub(crate) spectrum: FullSpectrum,
}

/// The lateral motion of one recorded node.
pub(crate) struct NodeMotion {
    pub(crate) node: u32,
    measured_depth: f64,
    time: Vec<f64>,
    u: Vec<f64>,
    v: Vec<f64>,
}

impl SpectrumSource {
    /// What a point that has a result has: its histories, or where it kept none its spectra.
    pub(crate) async fn load(store: &Store, sweep: &str, n: u32) -> Result<Self> {
        let key = result_key(store, sweep, n).await?;
        let artifacts = store.artifacts(&key).await?;
        if !artifacts.iter().any(|artifact| artifact.name == tables::SPECTRA.name) {
            return Ok(SpectrumSource::Recording(Recording::load_of(store, &key).await?));
        }
        let spectra = load_of(store, &key, tables::SPECTRA.name).await?;
        let statics = load_of(store, &key, tables::STATICS.name).await?;
        Ok(SpectrumSource::Kept(KeptSpectra { spectra, statics }))
    }
}

impl KeptSpectra {
    /// The spectrum of one node over one of the windows, for a weighting of the samples.
    pub(crate) fn spectrum_of(
        &self,
        choice: Choice,
        from: Option<f64>,
        to: Option<f64>,
        weighting: Weighting,
    ) -> Result<NodeSpectrum> {
        let amplitude = match weighting {
            Weighting::Rectangular => &AMPLITUDE_RECTANGULAR,
            Weighting::Hann => &AMPLITUDE_HANN,
        };
        let wanted = [&NODE, &FROM, &TO, &FREQUENCY, amplitude].map(|quantity| quantity.name);
        let table = decode(self.spectra.clone(), Some(&wanted))?;
        let Some(Column::Integer(nodes)) = table.columns.get(NODE.name) else {
            return Err(Error::internal("a table of spectra without nodes"));
        };
        let column = |Quantity { name, .. }: &Quantity| match table.columns.get(*name) {
            Some(Column::Number(values)) => Ok(values.as_slice()),
            _ => Err(Error::internal(&format!("a table of spectra without numbers in the column {name}"))),
        };
        let (starts, ends, frequency, amplitude) =
            (column(&FROM)?, column(&TO)?, column(&FREQUENCY)?, column(amplitude)?);
        let recorded: BTreeSet<u32> =
            nodes.iter().flatten().filter_map(|&node| u32::try_from(node).ok()).collect();
        let Recorded { node, measured_depth, .. } = choice.among(&nodes_among(&self.statics, recorded)?)?;
        let mut windows: Vec<KeptWindow> = Vec::new();
        for (&from, &to) in starts.iter().zip(ends) {
            let window = KeptWindow { from, to };
            if !windows.contains(&window) {
                windows.push(window);
            }
        }
        let window = KeptWindow::choose(&windows, from, to)?;
        let rows = |row: &usize| {
            nodes[*row] == Some(node.into()) && starts[*row] == window.from && ends[*row] == window.to
        };
        let rows: Vec<usize> = (0..frequency.len()).filter(rows).collect();
        let take = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<_>>();
        let frequency_hz = take(frequency);
        // Frequencies are the multiples of the lowest above 0.
        let resolution_hz = frequency_hz.iter().copied().find(|frequency| *frequency > 0.0);
        let resolution_hz =
            resolution_hz.ok_or_else(|| Error::internal("a spectrum without positive frequencies"))?;
        let spectrum =
            FullSpectrum { resolution_hz, window: weighting, frequency_hz, amplitude: take(amplitude) };
        Ok(NodeSpectrum { node, measured_depth, spectrum })
    }
}

impl NodeSpectrum {
    /// A view of this spectrum with the node that it is of.
    pub(crate) fn label(&self, table: Table) -> Table {
        of_node(table, self.node, self.measured_depth)
    }
}

impl Recording {
    /// The recording of a point that has a result.
    pub(crate) async fn load(store: &Store, sweep: &str, n: u32) -> Result<Self> {
        Self::load_of(store, &result_key(store, sweep, n).await?).await
    }

    async fn load_of(store: &Store, key: &WorkKey) -> Result<Self> {
        let history = load_of(store, key, tables::HISTORY.name).await?;
        let statics = load_of(store, key, tables::STATICS.name).await?;
        Ok(Recording { history, statics })
    }

    /// The whole recording.
    pub(crate) fn table(&self) -> Result<Table> {
        Ok(decode(self.history.clone(), None)?)
    }

    /// The recording of one node.
    pub(crate) fn table_of(&self, choice: Choice) -> Result<Table> {
        let columns = self.columns()?;
        let Recorded { node, measured_depth, .. } = choice.among(&self.nodes(&columns)?)?;
        let is_wanted = |name: &&str| {
            Name::parse(name).is_some_and(|name| match name.node {
                Some(of) => of == node as usize,
                None => name.quantity == &TIME,
            })
        };
        let wanted: Vec<&str> = columns.iter().map(String::as_str).filter(is_wanted).collect();
        Ok(of_node(decode(self.history.clone(), Some(&wanted))?, node, measured_depth))
    }

    /// The lateral motion of one node.
    pub(crate) fn motion_of(&self, choice: Choice) -> Result<NodeMotion> {
        let columns = self.columns()?;
        let Recorded { node, measured_depth, .. } = choice.among(&self.nodes(&columns)?)?;
        let (u, v) = (U.at_node(node as usize), V.at_node(node as usize));
        let mut table = decode(self.history.clone(), Some(&[TIME.name, &u, &v]))?;
        let mut take = |name: &str| match table.columns.swap_remove(name) {
            Some(Column::Number(values)) => Ok(values),
            _ => Err(Error::internal(&format!("a history without numbers in the column {name}"))),
        };
        Ok(NodeMotion { node, measured_depth, time: take(TIME.name)?, u: take(&u)?, v: take(&v)? })
    }

    /// How the hole stands about a node.
    pub(crate) fn hole_at(&self, node: u32) -> Result<Hole> {
        /// Below this part of a hole's length gained in depth the low side is worth the name: 0.1 degrees.
        const VERTICAL: f64 = 0.999_998_5;
        let wanted = [&NODE, &MEASURED_DEPTH, &TRUE_VERTICAL_DEPTH, &CLEARANCE, &LOW_SIDE_ANGLE];
        let statics = decode(self.statics.clone(), Some(&wanted.map(|quantity| quantity.name)))?;
        let column = |quantity: &Quantity| match statics.columns.get(quantity.name) {
            Some(Column::Number(values)) => values.as_slice(),
            _ => &[],
        };
        let Some(Column::Integer(nodes)) = statics.columns.get(NODE.name) else { return Ok(Hole::default()) };
        let Some(row) = nodes.iter().position(|number| *number == Some(node.into())) else {
            return Ok(Hole::default());
        };
        let value = |quantity: &Quantity, row: usize| column(quantity).get(row).copied();
        let (above, below) = (row.saturating_sub(1), (row + 1).min(nodes.len() - 1));
        let gain = |quantity: &Quantity| Some(value(quantity, below)? - value(quantity, above)?);
        let is_inclined = gain(&TRUE_VERTICAL_DEPTH)
            .zip(gain(&MEASURED_DEPTH))
            .is_some_and(|(depth, length)| depth.abs() < VERTICAL * length);
        Ok(Hole {
            clearance: value(&CLEARANCE, row),
            low_side: value(&LOW_SIDE_ANGLE, row).filter(|_| is_inclined),
        })
    }

    /// Names of the columns of the history.
    fn columns(&self) -> Result<Vec<String>> {
        Ok(StoredTable::open(self.history.clone())?.layout().columns.keys().cloned().collect())
    }

    /// Where the recorded nodes lie.
    pub(crate) fn places(&self) -> Result<Vec<Place>> {
        let place = |recorded: Recorded| {
            let Recorded { node, measured_depth, .. } = recorded;
            Ok(Place { node, measured_depth, low_side: self.hole_at(node)?.low_side })
        };
        self.nodes(&self.columns()?)?.into_iter().map(place).collect()
    }

    /// The recorded nodes.
    fn nodes(&self, columns: &[String]) -> Result<Vec<Recorded>> {
        nodes_among(&self.statics, node::recorded(columns.iter().map(String::as_str)))
    }
}

/// A view with the node that it is of.
fn of_node(table: Table, node: u32, measured_depth: f64) -> Table {
    table.attribute(NODE.name, node).attribute(MEASURED_DEPTH.name, measured_depth)
}

/// The nodes of these numbers, from the table of the statics, which has all of the mesh.
fn nodes_among(statics: &Bytes, recorded: impl IntoIterator<Item = u32>) -> Result<Vec<Recorded>> {
    let statics = decode(statics.clone(), Some(&[NODE.name, MEASURED_DEPTH.name]))?;
    let (Some(Column::Integer(nodes)), Some(Column::Number(depths))) =
        (statics.columns.get(NODE.name), statics.columns.get(MEASURED_DEPTH.name))
    else {
        return Err(Error::internal("a table of statics without nodes and their depths"));
    };
    let of_mesh = |recorded: u32| {
        let row = nodes.iter().position(|node| *node == Some(recorded.into()))?;
        Recorded::of_mesh(recorded, depths, row)
    };
    Ok(recorded.into_iter().filter_map(of_mesh).collect())
}

impl NodeMotion {
    /// The samples.
    pub(crate) fn columns(&self) -> Motion<'_> {
        Motion { time: &self.time, u: &self.u, v: &self.v }
    }

    /// A view of this motion with the node that it is of.
    pub(crate) fn label(&self, table: Table) -> Table {
        of_node(table, self.node, self.measured_depth)
    }
}
