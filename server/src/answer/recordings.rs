//! Stored tables of results: recordings and their parts that views read.

use std::collections::BTreeSet;
use std::ops::Range;

use drillsweep_api::view::node::{self, Choice, Recorded};
use drillsweep_api::view::orbit::Motion;
use drillsweep_api::view::spectrum::{FullSpectrum, KeptWindow, Weighting};
use drillsweep_api::view::window;
use drillsweep_api::{DrillString, PointState, ProblemDetails, ProblemKind};
use drillsweep_chart::{Hole, Place};
use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Name, Quantity};
use drillsweep_store::{Artifact, BlobId, PointRecord, Store, WorkKey};
use drillsweep_table::parquet::StoredTable;
use drillsweep_table::{Column, Table, tables};

use crate::answer::error::{Error, Result};
use crate::answer::records;
use crate::answer::stored::{Stored, StoredFile};

/// One table of a point's result.
pub(crate) async fn stored(store: &Store, sweep: &str, n: u32, name: &str) -> Result<Stored> {
    let key = result_key(store, sweep, n).await?;
    stored_of(store, &key, name).await
}

async fn stored_of(store: &Store, key: &WorkKey, name: &str) -> Result<Stored> {
    Stored::new(store, key, find(store, key, name).await?)
}

/// One table of a point's result, if the result has it.
pub(crate) async fn stored_if_any(store: &Store, sweep: &str, n: u32, name: &str) -> Result<Option<Stored>> {
    let key = result_key(store, sweep, n).await?;
    let artifact = store.artifacts(&key).await?.into_iter().find(|artifact| artifact.name == name);
    artifact.map(|artifact| Stored::new(store, &key, artifact)).transpose()
}

/// Finds a table of a result, expired or not.
pub(crate) async fn find(store: &Store, key: &WorkKey, name: &str) -> Result<Artifact> {
    let mut artifacts = store.artifacts(key).await?;
    if let Some(index) = artifacts.iter().position(|artifact| artifact.name == name) {
        return Ok(artifacts.swap_remove(index));
    }
    let names: Vec<_> = artifacts.iter().map(|artifact| artifact.name.as_str()).collect();
    let detail = match names.as_slice() {
        [] => format!("the run has no table {name}: its `outputs` keep the summary only"),
        names if name == tables::SNAPSHOTS.name => format!(
            "the run has no table {name}: its scenario requests none (`recording.snapshots`); it has {}",
            names.join(", ")
        ),
        names => format!("the run has no table {name}; it has {}", names.join(", ")),
    };
    Err(Error::new(ProblemKind::NoSuchTable, detail))
}

/// Key of a point that has a result, even while it is being recomputed.
pub(crate) async fn result_key(store: &Store, sweep: &str, n: u32) -> Result<WorkKey> {
    Ok(with_result(store, sweep, n).await?.work_key)
}

async fn with_result(store: &Store, sweep: &str, n: u32) -> Result<PointRecord> {
    let Some(point) = store.point(sweep, n.into()).await? else {
        return Err(records::no_such_point(store, sweep, n).await?);
    };
    if point.summary_json.is_some() {
        return Ok(point);
    }
    let state = records::point_state(point.state);
    let detail = match state {
        PointState::Queued | PointState::Running => {
            format!("point {n} is {state}: it has no result yet")
        }
        _ => format!("point {n} is {state}: it has no result"),
    };
    Err(ProblemDetails { state: Some(state), ..ProblemDetails::new(ProblemKind::NoResult, detail) }.into())
}

/// Recorded histories of a run, with the depths of their nodes.
pub(crate) struct Recording {
    pub(crate) history: Stored,
    pub(crate) statics: Stored,
    /// The string, for the names of its components.
    pub(crate) string: DrillString,
}

/// Full spectra that were kept in place of histories, with the depths of their nodes.
pub(crate) struct KeptSpectra {
    spectra: Stored,
    statics: Stored,
    string: DrillString,
}

/// Source of the full spectra of a run.
pub(crate) enum SpectrumSource {
    /// Histories, for any window.
    Recording(Recording),
    /// Stored spectra.
    Kept(KeptSpectra),
}

/// One full spectrum.
pub(crate) struct NodeSpectrum {
    pub(crate) node: u32,
    measured_depth: f64,
    component: String,
    pub(crate) spectrum: FullSpectrum,
}

/// Samples of a window of the history.
pub(crate) struct Samples {
    /// Their rows.
    pub(crate) rows: Range<usize>,
    /// End of the history \[s\], if the requested window ends later.
    pub(crate) cut_at: Option<f64>,
}

/// The lateral motion of one recorded node.
pub(crate) struct NodeMotion {
    pub(crate) node: u32,
    pub(crate) measured_depth: f64,
    /// Name of its component; empty if its section has none.
    component: String,
    /// End of the history \[s\], if the requested window ends later.
    pub(crate) cut_at: Option<f64>,
    time: Vec<f64>,
    u: Vec<f64>,
    v: Vec<f64>,
}

impl SpectrumSource {
    /// Source of a point with a result: its histories, or its spectra if it kept none.
    pub(crate) async fn load(store: &Store, sweep: &str, n: u32) -> Result<Self> {
        let point = with_result(store, sweep, n).await?;
        let key = &point.work_key;
        let artifacts = store.artifacts(key).await?;
        if !artifacts.iter().any(|artifact| artifact.name == tables::SPECTRA.name) {
            return Ok(SpectrumSource::Recording(Recording::load_of(store, &point).await?));
        }
        let spectra = stored_of(store, key, tables::SPECTRA.name).await?;
        let statics = stored_of(store, key, tables::STATICS.name).await?;
        let string = records::scenario(&point)?.string;
        Ok(SpectrumSource::Kept(KeptSpectra { spectra, statics, string }))
    }

    /// Names of all blobs that a spectrum depends on.
    pub(crate) fn blobs(&self) -> [BlobId; 2] {
        match self {
            SpectrumSource::Recording(recording) => recording.blobs(),
            SpectrumSource::Kept(KeptSpectra { spectra, statics, .. }) => [spectra.blob(), statics.blob()],
        }
    }

    /// Memory of a spectrum \[bytes\].
    pub(crate) async fn memory(&self) -> Result<u64> {
        /// Bytes of a sample: time, u and v, bins, frequencies and amplitudes, twice for the part that is shown.
        const OF_SAMPLE: u64 = 136;
        /// Bytes of a spectral line: node, window, frequency and amplitude.
        const OF_LINE: u64 = 64;
        Ok(match self {
            SpectrumSource::Recording(Recording { history, .. }) => {
                history.memory_of(OF_MOTION).await? + history.rows() * OF_SAMPLE
            }
            SpectrumSource::Kept(KeptSpectra { spectra, .. }) => {
                spectra.memory().await? + spectra.rows() * OF_LINE
            }
        })
    }
}

impl KeptSpectra {
    /// Spectrum of a node over a window, with a weighting of the samples.
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
        let table = self.spectra.read(Some(&wanted))?;
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
        let component = self.string.component_at(measured_depth).to_owned();
        Ok(NodeSpectrum { node, measured_depth, component, spectrum })
    }
}

impl NodeSpectrum {
    /// Adds the node of this spectrum to a view.
    pub(crate) fn label(&self, table: Table) -> Table {
        of_node(table, self.node, self.measured_depth, &self.component)
    }
}

/// Columns of a node's motion: time, u and v.
const OF_MOTION: u64 = 3;

impl Recording {
    /// The recording of a point that has a result.
    pub(crate) async fn load(store: &Store, sweep: &str, n: u32) -> Result<Self> {
        Self::load_of(store, &with_result(store, sweep, n).await?).await
    }

    async fn load_of(store: &Store, point: &PointRecord) -> Result<Self> {
        let history = stored_of(store, &point.work_key, tables::HISTORY.name).await?;
        let statics = stored_of(store, &point.work_key, tables::STATICS.name).await?;
        Ok(Recording { history, statics, string: records::scenario(point)?.string })
    }

    /// Names of all blobs that an orbit depends on.
    pub(crate) fn blobs(&self) -> [BlobId; 2] {
        [self.history.blob(), self.statics.blob()]
    }

    /// Memory of an orbit \[bytes\].
    pub(crate) async fn memory_of_orbit(&self) -> Result<u64> {
        /// Bytes of a sample: time, u and v as read, and again with the radius as served.
        const OF_SAMPLE: u64 = 64;
        Ok(self.history.memory_of(OF_MOTION).await? + self.history.rows() * OF_SAMPLE)
    }

    /// Columns of one node in the `layout` of the history, with the node.
    pub(crate) fn layout_of(&self, choice: Choice, mut layout: Table) -> Result<Table> {
        let nodes = match choice {
            // `nearest` refers to the nodes with a motion.
            Choice::Nearest(_) => self.nodes(&layout)?,
            Choice::Node(_) | Choice::At(_) => self.nodes_with_columns(&layout)?,
        };
        let Recorded { node, measured_depth, .. } = choice.among(&nodes)?;
        let is_wanted = |name: &str| {
            Name::parse(name).is_some_and(|name| match name.place {
                Some(of) => of.node() == Some(node as usize),
                None => name.quantity == &TIME,
            })
        };
        layout.columns.retain(|name, _| is_wanted(name));
        layout.units.retain(|name, _| is_wanted(name));
        Ok(of_node(layout, node, measured_depth, self.string.component_at(measured_depth)))
    }

    /// Samples of a half-open window \[from, to) \[s\] of the history; an absent end is open. A window that begins before the history, or
    /// lies outside it, is refused.
    pub(crate) fn samples(
        &self,
        history: &StoredTable<StoredFile>,
        from: Option<f64>,
        to: Option<f64>,
    ) -> Result<Samples> {
        if from.is_none() && to.is_none() {
            return Ok(Samples { rows: 0..history.rows(), cut_at: None });
        }
        let mut times = self.read(history, &[TIME.name], 0..history.rows())?;
        let times = take(&mut times, TIME.name)?;
        let rows = window::samples(&times, from, to);
        let [first, .., last] = times[..] else { return Ok(Samples { rows, cut_at: None }) };
        // Users round the ends of windows, to a millisecond at most.
        const ROUNDED: f64 = 1e-3;
        let outside =
            [from.filter(|from| *from < first - ROUNDED || *from > last), to.filter(|to| *to <= first)];
        for (name, end) in ["from", "to"].into_iter().zip(outside) {
            if let Some(end) = end {
                let valid = format!("the history begins at {first} s and ends at {last} s");
                return Err(Error::parameter(name, Some(&end.to_string()), valid));
            }
        }
        let interval = (last - first) / (times.len() - 1) as f64;
        if rows.is_empty() {
            let valid = format!("the window has no sample of the history; they are {interval} s apart");
            return Err(Error::parameter("to", to.map(|to| to.to_string()).as_deref(), valid));
        }
        let cut_at = to.filter(|to| *to > last + interval + ROUNDED).map(|_| last);
        Ok(Samples { rows, cut_at })
    }

    /// The lateral motion of one node in such a window.
    pub(crate) fn motion_of(&self, choice: Choice, from: Option<f64>, to: Option<f64>) -> Result<NodeMotion> {
        let history = self.history.open()?;
        let Recorded { node, measured_depth, .. } = choice.among(&self.nodes(history.layout())?)?;
        let (u, v) = (U.at_node(node as usize), V.at_node(node as usize));
        let Samples { rows, cut_at } = self.samples(&history, from, to)?;
        let mut table = self.read(&history, &[TIME.name, &u, &v], rows)?;
        Ok(NodeMotion {
            node,
            measured_depth,
            component: self.string.component_at(measured_depth).to_owned(),
            cut_at,
            time: take(&mut table, TIME.name)?,
            u: take(&mut table, &u)?,
            v: take(&mut table, &v)?,
        })
    }

    fn read(&self, history: &StoredTable<StoredFile>, columns: &[&str], rows: Range<usize>) -> Result<Table> {
        Ok(history.read(columns, rows).map_err(|error| self.history.problem(error))?.widened())
    }

    /// Geometry of the hole around a node.
    pub(crate) fn hole_at(&self, node: u32) -> Result<Hole> {
        /// Cosine of the inclination from which the hole has a low side: 0.1 degrees.
        const VERTICAL: f64 = 0.999_998_5;
        let wanted = [&NODE, &MEASURED_DEPTH, &TRUE_VERTICAL_DEPTH, &CLEARANCE, &LOW_SIDE_ANGLE];
        let statics = self.statics.read(Some(&wanted.map(|quantity| quantity.name)))?;
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

    /// Recorded nodes, from the columns of the history.
    pub(crate) fn nodes(&self, layout: &Table) -> Result<Vec<Recorded>> {
        nodes_among(&self.statics, node::recorded(layout.columns.keys().map(String::as_str)))
    }

    /// Number and measured depth \[m\] of the lowest node of the string.
    pub(crate) fn lowest_node(&self) -> Result<Option<(u32, f64)>> {
        let statics = self.statics.read(Some(&[NODE.name, MEASURED_DEPTH.name]))?;
        let (Some(Column::Integer(nodes)), Some(Column::Number(depths))) =
            (statics.columns.get(NODE.name), statics.columns.get(MEASURED_DEPTH.name))
        else {
            return Err(Error::internal("a table of statics without nodes and their depths"));
        };
        let node = nodes.last().copied().flatten().and_then(|node| u32::try_from(node).ok());
        Ok(node.zip(depths.last().copied()))
    }

    /// Nodes with columns in the history.
    fn nodes_with_columns(&self, layout: &Table) -> Result<Vec<Recorded>> {
        nodes_among(&self.statics, node::with_columns(layout.columns.keys().map(String::as_str)))
    }

    /// Places of the nodes with columns in the history.
    pub(crate) fn places(&self, layout: &Table) -> Result<Vec<Place>> {
        let place = |recorded: Recorded| {
            let Recorded { node, measured_depth, .. } = recorded;
            Ok(Place {
                name: node.to_string(),
                measured_depth,
                low_side: self.hole_at(node)?.low_side,
                component: self.string.component_at(measured_depth).to_owned(),
            })
        };
        self.nodes_with_columns(layout)?.into_iter().map(place).collect()
    }
}

/// Places of columns on the string of a point, from its equilibrium. Blocks.
pub(crate) fn places_of_columns(
    statics: &Stored,
    string: &DrillString,
    columns: &[String],
) -> Result<Vec<Place>> {
    let named: Vec<_> = columns.iter().filter_map(|column| Name::parse(column)?.place).collect();
    let numbers = named.iter().filter_map(|place| u32::try_from(place.node()?).ok());
    let nodes = nodes_among(statics, numbers)?;
    let of_number = |number: usize| {
        nodes.iter().find(|found| found.node as usize == number).map(|found| found.measured_depth)
    };
    let place = |named: &drillsweep_quantity::Place<'_>| {
        let below_top = named.height().map(|height| string.depth_of_bit() - height);
        let measured_depth = named.depth().or(below_top).or_else(|| of_number(named.node()?))?;
        let component = string.component_at(measured_depth).to_owned();
        Some(Place { name: named.in_names(), measured_depth, low_side: None, component })
    };
    Ok(named.iter().filter_map(place).collect())
}

/// The numbers of a column of a history.
fn take(table: &mut Table, name: &str) -> Result<Vec<f64>> {
    match table.columns.swap_remove(name) {
        Some(Column::Number(values)) => Ok(values),
        _ => Err(Error::internal(&format!("a history without numbers in the column {name}"))),
    }
}

/// Adds a node to a view, with its component if that has a name.
fn of_node(table: Table, node: u32, measured_depth: f64, component: &str) -> Table {
    let table = table.attribute(NODE.name, node).attribute(MEASURED_DEPTH.name, measured_depth);
    if component.is_empty() { table } else { table.attribute(COMPONENT.name, component) }
}

/// Nodes by their numbers, from the table of the equilibrium, which has all nodes of the mesh.
fn nodes_among(statics: &Stored, recorded: impl IntoIterator<Item = u32>) -> Result<Vec<Recorded>> {
    let statics = statics.read(Some(&[NODE.name, MEASURED_DEPTH.name]))?;
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

    /// Adds to a view the node of this motion, and the end of the history if the window is cut there.
    pub(crate) fn label(&self, table: Table) -> Table {
        mark_cut(of_node(table, self.node, self.measured_depth, &self.component), self.cut_at)
    }
}

/// Adds to a view the end of the history \[s\] at which its window is cut.
pub(crate) fn mark_cut(table: Table, cut_at: Option<f64>) -> Table {
    match cut_at {
        Some(end) => table.attribute("window_cut_at", end),
        None => table,
    }
}

/// Title of a picture, with the end of the history \[s\] at which its window is cut.
pub(crate) fn title_of_cut(title: &str, cut_at: Option<f64>) -> String {
    match cut_at {
        Some(end) => format!("{title}; to the end of the history at {end} s"),
        None => title.to_owned(),
    }
}
