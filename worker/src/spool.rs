//! The samples and snapshots of a run in a temporary file: a worker's memory does not grow with the duration of a point.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::Path;

use drillsweep_sim::solve::run::{
    Block, Checkpoint, CheckpointError, Histories, Series, SnapshotBlock, SnapshotSeries,
};
use serde::{Deserialize, Serialize};

/// Bytes of a sample.
const SAMPLE: usize = size_of::<f64>();

/// Series of the bit that are kept with those of the nodes.
const OF_BIT: [Series; 2] = [Series::ThetaZRate, Series::Torque];

/// Bytes of a value of a snapshot.
const VALUE: usize = size_of::<f32>();

/// The last bytes of a suspended run's file, after the length of the part before them.
const MAGIC: &[u8; 8] = b"dsweepS1";

/// Histories of a run's recorded nodes and snapshots of its string in a file without a name, which vanishes with the process.
///
/// The file holds block after block; a block holds for each node and each series its samples in a row, behind them those of the bit if
/// it is recorded with the nodes, and for each series of the snapshots their values in a row, in single precision.
#[derive(Debug)]
pub struct Spool {
    file: File,
    index: Index,
}

/// Positions of the samples.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Index {
    nodes: Vec<usize>,
    /// The bit, if its rotation and torque are recorded with the nodes.
    #[serde(default)]
    bit: Option<usize>,
    /// Samples of each block.
    blocks: Vec<usize>,
    /// Absent if there are no snapshots.
    #[serde(default)]
    snapshots: SnapshotIndex,
}

/// Positions of the snapshots.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct SnapshotIndex {
    series: Vec<SnapshotSeries>,
    /// Nodes of each.
    nodes: usize,
    /// Snapshots of each block.
    blocks: Vec<usize>,
}

/// Position of a block in the file.
struct Place {
    /// Its samples, by number.
    samples: Range<usize>,
    /// Its snapshots, by number.
    snapshots: Range<usize>,
    /// The first byte of its samples.
    start: u64,
    /// The first byte of its snapshots.
    start_of_snapshots: u64,
    /// The first byte behind it.
    end: u64,
}

/// A suspended run: its checkpoint and its records.
#[derive(Debug)]
pub struct Suspended {
    /// State from which it continues.
    pub checkpoint: Checkpoint,
    /// Its samples and snapshots so far.
    pub spool: Spool,
}

/// Errors of reading a suspended run.
#[derive(Debug, thiserror::Error)]
pub enum SuspendedError {
    /// The file cannot be read.
    #[error("the file of a suspended run cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// It is no file of [`Suspended::to_file`].
    #[error("not a suspended run: {0}")]
    Malformed(String),
    /// Its checkpoint is not one.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

impl Spool {
    /// An empty one, in a directory.
    ///
    /// # Errors
    /// No file can be made there.
    pub fn new(directory: &Path) -> std::io::Result<Self> {
        Ok(Self { file: tempfile::tempfile_in(directory)?, index: Index::default() })
    }

    /// Adds the samples and snapshots that follow.
    ///
    /// # Errors
    /// The file cannot be written, or the block is of other nodes or series than the ones before it.
    pub fn append(&mut self, Block { histories, bit, snapshots }: Block<'_>) -> std::io::Result<()> {
        let nodes: Vec<usize> = histories.iter().map(|history| history.node).collect();
        if self.index.blocks.is_empty() {
            self.index.nodes = nodes;
            self.index.bit = bit.map(|bit| bit.node);
            self.index.snapshots.series = snapshots.map_or(Vec::new(), |block| block.series.clone());
        } else if self.index.nodes != nodes {
            return Err(std::io::Error::other("a block of samples of other nodes"));
        }
        self.index.snapshots.begin(snapshots)?;
        let samples = histories.first().map_or(0, |history| history.u.len());
        let mut bytes = Vec::with_capacity(samples * SAMPLE);
        self.file.seek(SeekFrom::End(0))?;
        for history in histories {
            for series in Series::ALL {
                bytes.clear();
                bytes.extend(history.series(series).iter().flat_map(|value| value.to_le_bytes()));
                self.file.write_all(&bytes)?;
            }
        }
        // A run that was suspended by a program that did not record the bit goes on without it.
        if let Some(bit) = bit.filter(|bit| self.index.bit == Some(bit.node)) {
            for series in OF_BIT {
                bytes.clear();
                bytes.extend(bit.series(series).iter().flat_map(|value| value.to_le_bytes()));
                self.file.write_all(&bytes)?;
            }
        }
        for values in snapshots.iter().flat_map(|block| &block.values) {
            bytes.clear();
            bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            self.file.write_all(&bytes)?;
        }
        self.index.blocks.push(samples);
        self.index.snapshots.blocks.push(snapshots.map_or(0, |block| block.count));
        Ok(())
    }

    /// The bit, from 0 at the top, if its rotation and torque are recorded with the nodes.
    pub fn bit(&self) -> Option<usize> {
        self.index.bit
    }

    /// Some samples of the rate of twist \[rad/s\] or of the torque \[N m\] of the [bit](Self::bit).
    ///
    /// # Errors
    /// The file cannot be read, or another series is requested or there is none of the bit.
    pub fn read_bit(&self, series: Series, samples: Range<usize>) -> std::io::Result<Vec<f64>> {
        let row = OF_BIT.iter().position(|of_bit| *of_bit == series).filter(|_| self.index.bit.is_some());
        let row = row.ok_or_else(|| std::io::Error::other("a series of the bit that is not recorded"))?;
        self.read_row(self.index.nodes.len() * Series::ALL.len() + row, samples)
    }

    /// Some samples of one of the rows of samples that each block has.
    fn read_row(&self, row: usize, samples: Range<usize>) -> std::io::Result<Vec<f64>> {
        let mut values = Vec::with_capacity(samples.len());
        let mut bytes = Vec::new();
        for place in self.index.places() {
            let within = overlap(&samples, &place.samples);
            if !within.is_empty() {
                bytes.resize(within.len() * SAMPLE, 0);
                let offset = (row * place.samples.len() + within.start) * SAMPLE;
                self.file.read_exact_at(&mut bytes, place.start + offset as u64)?;
                let (samples, _) = bytes.as_chunks::<SAMPLE>();
                values.extend(samples.iter().copied().map(f64::from_le_bytes));
            }
        }
        if values.len() != samples.len() {
            return Err(std::io::Error::other("samples beyond the end of a recording"));
        }
        Ok(values)
    }

    /// The number of snapshots.
    pub fn snapshot_count(&self) -> usize {
        self.index.snapshots.blocks.iter().sum()
    }

    /// Some of the snapshots, by number from 0.
    ///
    /// # Errors
    /// The file cannot be read or there are no such snapshots.
    pub fn snapshots(&self, snapshots: Range<usize>) -> std::io::Result<SnapshotBlock> {
        let SnapshotIndex { series, nodes, .. } = &self.index.snapshots;
        let mut read = SnapshotBlock::new(series.clone());
        let mut bytes = Vec::new();
        for place in self.index.places() {
            let within = overlap(&snapshots, &place.snapshots);
            if !within.is_empty() {
                bytes.resize(within.len() * nodes * VALUE, 0);
                for (row, values) in read.values.iter_mut().enumerate() {
                    let offset = (row * place.snapshots.len() + within.start) * nodes * VALUE;
                    self.file.read_exact_at(&mut bytes, place.start_of_snapshots + offset as u64)?;
                    let (own, _) = bytes.as_chunks::<VALUE>();
                    values.extend(own.iter().copied().map(f32::from_le_bytes));
                }
                read.count += within.len();
            }
        }
        if read.count != snapshots.len() {
            return Err(std::io::Error::other("snapshots beyond the end of a recording"));
        }
        Ok(read)
    }
}

/// Part of a range that lies in a block, counted from the block's beginning.
fn overlap(range: &Range<usize>, block: &Range<usize>) -> Range<usize> {
    let within = |end: usize| end.clamp(block.start, block.end) - block.start;
    within(range.start)..within(range.end)
}

impl SnapshotIndex {
    /// Notes the contents of the next block, which must be those of the blocks before it.
    fn begin(&mut self, block: Option<&SnapshotBlock>) -> std::io::Result<()> {
        let series = block.map_or([].as_slice(), |block| &block.series);
        let per_snapshot = |block: &SnapshotBlock| Some(block.values.first()?.len() / block.count.max(1));
        let nodes = block.filter(|block| block.count > 0).and_then(per_snapshot);
        if self.nodes == 0 {
            self.nodes = nodes.unwrap_or(0);
        }
        if self.series != series || nodes.is_some_and(|nodes| nodes != self.nodes) {
            return Err(std::io::Error::other("a block of other snapshots"));
        }
        Ok(())
    }
}

impl Index {
    /// Bytes of all blocks.
    fn length(&self) -> u64 {
        self.places().last().map_or(0, |place| place.end)
    }

    /// Positions of the blocks.
    fn places(&self) -> impl Iterator<Item = Place> {
        let SnapshotIndex { series, nodes, blocks } = &self.snapshots;
        // A run that was suspended by a program without snapshots has none.
        let snapshots = blocks.iter().copied().chain(std::iter::repeat(0));
        let rows = self.nodes.len() * Series::ALL.len() + self.bit.map_or(0, |_| OF_BIT.len());
        let (mut end, mut samples_before, mut snapshots_before) = (0, 0, 0);
        self.blocks.iter().zip(snapshots).map(move |(&samples, snapshots)| {
            let start = end;
            let start_of_snapshots = start + (samples * rows * SAMPLE) as u64;
            end = start_of_snapshots + (snapshots * series.len() * nodes * VALUE) as u64;
            let place = Place {
                samples: samples_before..samples_before + samples,
                snapshots: snapshots_before..snapshots_before + snapshots,
                start,
                start_of_snapshots,
                end,
            };
            (samples_before, snapshots_before) = (place.samples.end, place.snapshots.end);
            place
        })
    }
}

impl Histories for Spool {
    type Error = std::io::Error;

    fn nodes(&self) -> Vec<usize> {
        self.index.nodes.clone()
    }

    fn samples(&self) -> usize {
        self.index.blocks.iter().sum()
    }

    fn read(&self, index: usize, series: Series, samples: Range<usize>) -> std::io::Result<Cow<'_, [f64]>> {
        self.read_row(index * Series::ALL.len() + series as usize, samples).map(Cow::Owned)
    }
}

impl Suspended {
    /// The whole as one file: the samples, and behind them the rest.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn to_file(&mut self) -> std::io::Result<&File> {
        let Self { checkpoint, spool: Spool { file, index } } = self;
        let parts = [checkpoint.to_bytes(), serde_json::to_vec(index).map_err(std::io::Error::other)?];
        // Bytes of an earlier call behind the samples are overwritten.
        file.set_len(index.length())?;
        file.seek(SeekFrom::End(0))?;
        for part in &parts {
            file.write_all(part)?;
        }
        for part in &parts {
            file.write_all(&(part.len() as u64).to_le_bytes())?;
        }
        file.write_all(MAGIC)?;
        Ok(file)
    }

    /// The suspended run of a file.
    ///
    /// # Errors
    /// The file cannot be read or is not one of a suspended run.
    pub fn from_file(file: File) -> Result<Self, SuspendedError> {
        let malformed = |what: &str| SuspendedError::Malformed(what.to_owned());
        let mut end = file.metadata()?.len();
        let mut before = |length: u64| {
            end = end.checked_sub(length).ok_or_else(|| malformed("a part is missing"))?;
            let mut bytes = vec![0; usize::try_from(length).map_err(|_| malformed("a part is too long"))?];
            file.read_exact_at(&mut bytes, end)?;
            Ok::<_, SuspendedError>(bytes)
        };
        if before(MAGIC.len() as u64)? != MAGIC {
            return Err(malformed("another end"));
        }
        let mut length = || {
            let bytes = before(size_of::<u64>() as u64)?;
            Ok::<_, SuspendedError>(bytes.iter().rev().fold(0, |sum, &byte| sum << 8 | u64::from(byte)))
        };
        let (of_index, of_checkpoint) = (length()?, length()?);
        let index = before(of_index)?;
        let checkpoint = Checkpoint::from_bytes(&before(of_checkpoint)?)?;
        let index: Index =
            serde_json::from_slice(&index).map_err(|error| SuspendedError::Malformed(error.to_string()))?;
        if index.length() != end {
            return Err(malformed("samples are missing"));
        }
        file.set_len(end)?;
        Ok(Self { checkpoint, spool: Spool { file, index } })
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;
    use drillsweep_sim::control::Control;
    use drillsweep_sim::solve::model::Model;
    use drillsweep_sim::solve::run::{NodeHistory, Outcome, Transient};
    use drillsweep_sim::solve::statics::Equilibrium;

    use super::*;

    /// Two nodes with samples that differ by node, series and number, from `first` on.
    fn block(first: usize, samples: usize) -> Vec<NodeHistory> {
        let values = |node: usize, series: Series| {
            (first..first + samples)
                .map(move |k| (1000 * node + series as usize) as f64 + k as f64 * 1e-4)
                .collect()
        };
        let history = |node| NodeHistory {
            node,
            u: values(node, Series::U),
            v: values(node, Series::V),
            w: values(node, Series::W),
            theta_z: values(node, Series::ThetaZ),
            u_rate: values(node, Series::URate),
            v_rate: values(node, Series::VRate),
            w_rate: values(node, Series::WRate),
            theta_z_rate: values(node, Series::ThetaZRate),
            torque: values(node, Series::Torque),
        };
        vec![history(4), history(7)]
    }

    fn of(histories: &[NodeHistory]) -> Block<'_> {
        Block { histories, bit: None, snapshots: None }
    }

    /// Snapshots of three nodes with values that differ by series, number and node, from `first` on.
    fn snapshots(first: usize, count: usize) -> SnapshotBlock {
        let series = vec![SnapshotSeries::U, SnapshotSeries::NormalForce];
        let values = |series: usize| {
            (first * 3..(first + count) * 3).map(|value| (1000 * series + value) as f32).collect()
        };
        SnapshotBlock { values: (0..series.len()).map(values).collect(), series, count }
    }

    #[test]
    fn snapshots_lie_between_the_samples_and_are_read_across_blocks() {
        let directory = tempfile::tempdir().unwrap();
        let mut spool = Spool::new(directory.path()).unwrap();
        // Blocks of both, of either alone, and of none.
        let parts = [(0..33, 0..2), (33..34, 2..2), (34..34, 2..9), (34..34, 9..9), (34..60, 9..10)];
        for (samples, taken) in parts {
            let taken = snapshots(taken.start, taken.len());
            let histories = block(samples.start, samples.len());
            spool
                .append(Block { histories: &histories, bit: Some(&histories[0]), snapshots: Some(&taken) })
                .unwrap();
        }
        assert_eq!((spool.samples(), spool.snapshot_count()), (60, 10));
        for range in [0..10, 0..0, 1..3, 2..9, 9..10] {
            let expected = snapshots(range.start, range.len());
            assert_eq!(spool.snapshots(range.clone()).unwrap(), expected, "{range:?}");
        }
        assert!(spool.snapshots(8..11).is_err());
        assert_eq!(*spool.read(1, Series::V, 30..50).unwrap(), block(0, 60)[1].v[30..50]);
        assert_eq!(spool.read_bit(Series::ThetaZRate, 30..50).unwrap(), block(0, 60)[0].theta_z_rate[30..50]);
        assert_eq!(spool.read_bit(Series::Torque, 0..60).unwrap(), block(0, 60)[0].torque);
        assert!(spool.read_bit(Series::U, 0..1).is_err() && spool.read_bit(Series::Torque, 0..61).is_err());
        let other = SnapshotBlock::new(vec![SnapshotSeries::U]);
        let histories = block(60, 1);
        assert!(spool.append(Block { histories: &histories, bit: None, snapshots: Some(&other) }).is_err());
        assert!(spool.append(of(&histories)).is_err());
    }

    #[test]
    fn spooled_samples_are_read_across_blocks() {
        let directory = tempfile::tempdir().unwrap();
        let mut spool = Spool::new(directory.path()).unwrap();
        let whole = block(0, 100);
        for (first, samples) in [(0, 33), (33, 1), (34, 66)] {
            spool.append(of(&block(first, samples))).unwrap();
        }
        assert_eq!((spool.nodes(), spool.samples()), (vec![4, 7], 100));
        for (index, history) in whole.iter().enumerate() {
            for series in Series::ALL {
                for samples in [0..100, 0..0, 32..35, 34..100, 99..100] {
                    let read = spool.read(index, series, samples.clone()).unwrap();
                    assert_eq!(*read, history.series(series)[samples]);
                }
            }
        }
        assert!(spool.read(0, Series::U, 90..101).is_err());
        assert!(spool.append(of(&block(100, 1)[..1])).is_err(), "a node less");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0, "nothing is left behind");
    }

    #[test]
    fn a_suspended_run_comes_back_from_its_file_and_no_other_does() {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.duration = 0.3;
        scenario.recording.spectrum_windows = Some(Vec::new());
        scenario.recording.orbit_window = None;
        let model = Model::new(&scenario).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        let control = Control::observed_by(|control, time| {
            if time >= 0.1 {
                control.suspend();
            }
        });
        let directory = tempfile::tempdir().unwrap();
        let mut spool = Spool::new(directory.path()).unwrap();
        let run = Transient::new(&model, &equilibrium).unwrap();
        let outcome =
            run.run_into(&control, &mut |block| spool.append(block).map_err(|error| error.to_string()));
        let Ok(Outcome::Suspended(checkpoint, ())) = outcome else { panic!("{outcome:?}") };
        let (kept, samples) = (spool.read(0, Series::V, 0..101).unwrap().into_owned(), spool.samples());
        assert_eq!(samples, 101);

        let mut suspended = Suspended { checkpoint: *checkpoint.clone(), spool };
        let mut bytes_of = || {
            let file = suspended.to_file().unwrap();
            let mut bytes = vec![0; file.metadata().unwrap().len() as usize];
            file.read_exact_at(&mut bytes, 0).unwrap();
            bytes
        };
        let bytes = bytes_of();
        assert!(bytes_of() == bytes, "written twice, the same");
        let of_bytes = |bytes: &[u8]| {
            let mut file = tempfile::tempfile_in(directory.path()).unwrap();
            file.write_all(bytes).unwrap();
            Suspended::from_file(file)
        };
        let read_back = of_bytes(&bytes).unwrap();
        assert_eq!(read_back.checkpoint, *checkpoint);
        assert_eq!(*read_back.spool.read(0, Series::V, 0..101).unwrap(), kept);
        assert!(of_bytes(&bytes[1..]).is_err());
        assert!(of_bytes(&bytes[..bytes.len() - 1]).is_err());
        assert!(of_bytes(b"").is_err());
    }
}
