//! Memory and storage of a scenario, without running it.

use drillsweep_scenario::{CostStudy, Outputs, Scenario, TimeWindow};
use serde::Serialize;

use super::mesh_estimate::MOST_ELEMENTS;
use drillsweep_sim::math::signal::sample_range;
use drillsweep_sim::solve::model::{Model, ModelError};
use drillsweep_sim::solve::run::{
    BLOCK_BYTES, CYCLE_BYTES, EnergyRow, LEDGER_RATE_HZ, LOAD_BYTES, SNAPSHOT_BLOCK_BYTES, Series,
    SnapshotSeries, SnapshotTimes, additional_bit, course_samples, kept_window_at_most, orbit_window_at_most,
    recorded_nodes, spectrum_windows_at_most,
};

/// Bytes of a node with its elements: model, equilibrium and run (`tests/allocation.rs` holds them below it).
const PER_NODE: u64 = 40_000;

/// Bytes of a node for the finer meshes by which the error of the mesh is estimated: a model four times as fine with its equations of small motions,
/// factored (`worker/tests/memory.rs` holds them below it).
const PER_NODE_OF_FINER_MESHES: u64 = 70_000;

/// Bytes of a sample of a window while its spectrum is computed: the motion, its transform in and out, the weights, the amplitudes
/// and their frequencies, and their stored copies.
const PER_WINDOW_SAMPLE: u64 = 160;

/// Bytes of the buffer in which a table's rows are gathered before they are written: a row group, and the buffers of its writer.
const LARGEST_ROW_GROUP: u64 = 48 << 20;

/// Bytes of a table's description for each column of each row group.
const PER_COLUMN_CHUNK: u64 = 1_500;

/// Largest number of rows in a row group.
const ROW_GROUP: u64 = 10_000;

/// Columns of a history's table for each node, if torsion is solved for: the series, and the rotation speed from the rate of
/// twist.
const HISTORY_COLUMNS: u64 = Series::ALL.len() as u64 + 1;

/// Columns of the bit if it is recorded with the nodes: rotation speed and torque.
const BIT_COLUMNS: u64 = 2;

/// Largest number of rows of the table `course` a second.
const COURSE_TABLE_HZ: f64 = 20.0;

/// Memory and storage of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, utoipa::ToSchema)]
pub struct Footprint {
    /// Largest memory of the point, about \[bytes\]; in a cost study, for each core that its worker uses. The worker's program
    /// itself takes some 30 MB more.
    pub memory_bytes: u64,
    /// Size of its tables before compression \[bytes\]; stored they usually take half of that, and a string at rest nearly nothing.
    pub table_bytes: u64,
    /// Part of its snapshots, `recording.snapshots` \[bytes\]; stored they usually take two fifths of it.
    pub snapshot_bytes: u64,
}

impl Footprint {
    /// The footprint of a scenario.
    ///
    /// # Errors
    /// The scenario has no model.
    pub fn of(scenario: &Scenario) -> Result<Self, ModelError> {
        Ok(Self::of_model(&Model::new(scenario)?))
    }

    pub(super) fn of_model(model: &Model) -> Self {
        let recorded = Recorded::of(model);
        let study = model.scenario.cost_study.as_ref().map_or(0, |study| recorded.study_bytes(study));
        let snapshots = PlannedSnapshots::of(model);
        let is_refined = model.effects.transient && model.elements.len() <= MOST_ELEMENTS;
        let of_finer_meshes = if is_refined { PER_NODE_OF_FINER_MESHES } else { 0 };
        // As they are and encoded in a checkpoint.
        let of_loads = if model.effects.transient { 2 * LOAD_BYTES } else { 0 };
        let graded =
            model.mesh.elements.iter().filter(|element| element.tube.material.grade.is_some()).count();
        let of_cycles = if model.effects.transient { 2 * CYCLE_BYTES * graded as u64 } else { 0 };
        Self {
            memory_bytes: (PER_NODE + of_finer_meshes + of_loads) * model.node_count() as u64
                + of_cycles
                + recorded.memory().max(snapshots.memory_of_table())
                + snapshots.memory_of_blocks()
                + study,
            table_bytes: table_bytes(model, &recorded) + snapshots.table_bytes(),
            snapshot_bytes: snapshots.table_bytes(),
        }
    }
}

/// Counts of a run that grow with its duration.
struct Recorded {
    nodes: u64,
    /// Series of the bit, if it is recorded in addition to the nodes.
    of_bit: u64,
    samples: u64,
    /// Samples whose histories are kept if no other output is requested.
    kept_samples: u64,
    /// Samples of the motion by which the run is judged.
    course_samples: u64,
    /// Samples of the longest window.
    longest_window: u64,
    /// Samples of all spectrum windows together.
    spectrum_samples: u64,
    ledger_rows: u64,
}

impl Recorded {
    fn of(model: &Model) -> Self {
        let scenario = &model.scenario;
        if !model.effects.transient {
            return Self {
                nodes: 0,
                of_bit: 0,
                samples: 0,
                kept_samples: 0,
                course_samples: 0,
                longest_window: 0,
                spectrum_samples: 0,
                ledger_rows: 0,
            };
        }
        let rate = scenario.recording.rate_hz;
        let samples = (scenario.duration * rate).round();
        let length =
            |window: &TimeWindow| sample_range(window.from, window.to, rate, samples as usize).len() as u64;
        let spectra = spectrum_windows_at_most(scenario);
        let orbit = length(&orbit_window_at_most(scenario));
        Self {
            nodes: recorded_nodes(model).len() as u64,
            of_bit: additional_bit(model).map_or(0, |_| BIT_COLUMNS),
            samples: samples as u64,
            kept_samples: if scenario.settles() {
                length(&kept_window_at_most(scenario))
            } else {
                samples as u64
            },
            course_samples: course_samples(scenario),
            longest_window: spectra.iter().map(length).fold(orbit, u64::max),
            spectrum_samples: spectra.iter().map(length).sum(),
            ledger_rows: (scenario.duration * LEDGER_RATE_HZ) as u64 + 2,
        }
    }

    /// Largest number of bytes of memory.
    fn memory(&self) -> u64 {
        let of_bit = self.of_bit / BIT_COLUMNS * Series::ALL.len() as u64;
        let sample = (self.nodes * Series::ALL.len() as u64 + of_bit) * size_of::<f64>() as u64;
        let block = (BLOCK_BYTES + sample).min(self.samples * sample);
        let row_group = LARGEST_ROW_GROUP.min(self.samples * sample);
        let columns = 1 + self.nodes * HISTORY_COLUMNS + self.of_bit;
        let row_groups = (self.samples / ROW_GROUP).max(self.samples * sample / (2 * LARGEST_ROW_GROUP)) + 1;
        let window = if self.nodes > 0 { PER_WINDOW_SAMPLE * self.longest_window } else { 0 };
        // Rows take memory twice: as they are made and as columns.
        let ledger = 2 * self.ledger_rows * size_of::<EnergyRow>() as u64;
        // Twice, since a suspended run is read back.
        let course = 2 * (2 * self.nodes + 1) * self.course_samples * size_of::<f64>() as u64;
        course + 2 * block + window.max(row_group + columns * row_groups * PER_COLUMN_CHUNK) + ledger
    }

    /// Additional bytes for the runs of a cost study: the current run, and the lateral motion of those that are kept.
    fn study_bytes(&self, study: &CostStudy) -> u64 {
        let double = size_of::<f64>() as u64;
        let whole = self.nodes * self.samples * Series::ALL.len() as u64 * double;
        let kept = self.nodes * self.samples * 2 * double * u64::from(study.members.min(2));
        whole + study.most_lines() as u64 * kept
    }
}

/// The snapshots of a scenario.
struct PlannedSnapshots {
    /// Snapshots times nodes.
    rows: u64,
    series: u64,
}

impl PlannedSnapshots {
    fn of(model: &Model) -> Self {
        let times = SnapshotTimes::of(&model.scenario)
            .filter(|_| model.effects.transient && model.scenario.cost_study.is_none());
        let count = times.map_or(0, |times| times.count());
        Self { rows: count * model.node_count() as u64, series: SnapshotSeries::of(model).len() as u64 }
    }

    /// Bytes of the table: time, node, and the series in single precision.
    fn table_bytes(&self) -> u64 {
        self.rows * (16 + 4 * self.series)
    }

    /// Bytes of memory of the block that a run gathers, and of its encoded bytes.
    fn memory_of_blocks(&self) -> u64 {
        2 * SNAPSHOT_BLOCK_BYTES.min(4 * self.rows * self.series)
    }

    /// Bytes of memory while the table is written.
    fn memory_of_table(&self) -> u64 {
        /// Bytes of a row that is read back and put in a row group.
        const PER_ROW: u64 = 200;
        let columns = (2 + self.series) * PER_COLUMN_CHUNK;
        PER_ROW * ROW_GROUP.min(self.rows) + (self.rows / ROW_GROUP + 1) * columns
    }
}

/// Bytes of all tables that the scenario keeps, but for its snapshots.
fn table_bytes(model: &Model, recorded: &Recorded) -> u64 {
    /// Columns of numbers of the profile, by element; of equilibrium, contacts and loads, by node.
    const OF_ELEMENTS: usize = 25;
    const OF_NODES: usize = 66;
    let double = size_of::<f64>();
    let small = (model.elements.len() * OF_ELEMENTS + model.node_count() * OF_NODES) * double;
    let ledger = recorded.ledger_rows * size_of::<EnergyRow>() as u64;
    let history = |columns: u64, samples: u64| samples * (8 + columns * 4);
    let Recorded { nodes, of_bit, samples, .. } = *recorded;
    let course = if model.scenario.settles() {
        history(2 * nodes + of_bit / BIT_COLUMNS, (model.scenario.duration * COURSE_TABLE_HZ) as u64)
    } else {
        0
    };
    let all = nodes * HISTORY_COLUMNS + of_bit;
    let of_motion = match &model.scenario.recording.outputs {
        Outputs::Summary => return 0,
        // Node, window and frequency, and two amplitudes in single precision.
        Outputs::Spectra => nodes * recorded.spectrum_samples * 40,
        Outputs::Full => history(all, recorded.kept_samples) + course,
        Outputs::Orbits(part) => {
            let kept = part.window.map_or(recorded.kept_samples, |window| {
                let rate = model.scenario.recording.rate_hz;
                sample_range(window.from, window.to, rate, samples as usize).len() as u64
            });
            let columns = part.nodes.as_ref().map_or(all, |nodes| nodes.len() as u64 * HISTORY_COLUMNS);
            history(columns, kept.div_ceil(u64::from(part.decimation))) + course
        }
    };
    small as u64 + ledger + of_motion
}
