//! The samples of a run in a temporary file: a worker's memory does not grow with the duration of a point.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::Path;

use drillsweep_sim::transient::{Checkpoint, CheckpointError, Histories, NodeHistory, Series};
use serde::{Deserialize, Serialize};

/// Bytes of a sample.
const SAMPLE: usize = size_of::<f64>();

/// The last bytes of a suspended run's file, after the length of what stands before them.
const MAGIC: &[u8; 8] = b"dsweepS1";

/// Histories of a run's recorded nodes in a file without a name, which vanishes with the process.
///
/// The file holds block after block; a block holds for each node and each series its samples in a row.
#[derive(Debug)]
pub struct Spool {
    file: File,
    index: Index,
}

/// Where the samples are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Index {
    nodes: Vec<usize>,
    /// Samples of each block.
    blocks: Vec<usize>,
}

/// A suspended run: where it goes on, and what it has recorded.
#[derive(Debug)]
pub struct Suspended {
    /// Where it goes on.
    pub checkpoint: Checkpoint,
    /// Its samples so far.
    pub spool: Spool,
}

/// Why a suspended run cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SuspendedError {
    /// The file cannot be read.
    #[error("the file of a suspended run cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// It is not what [`Suspended::to_file`] writes.
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
    /// When no file can be made there.
    pub fn new(directory: &Path) -> std::io::Result<Self> {
        Ok(Self { file: tempfile::tempfile_in(directory)?, index: Index::default() })
    }

    /// Adds the samples that follow.
    ///
    /// # Errors
    /// When the file cannot be written, or the block is of other nodes than the ones before it.
    pub fn append(&mut self, block: &[NodeHistory]) -> std::io::Result<()> {
        let nodes: Vec<usize> = block.iter().map(|history| history.node).collect();
        if self.index.blocks.is_empty() {
            self.index.nodes = nodes;
        } else if self.index.nodes != nodes {
            return Err(std::io::Error::other("a block of samples of other nodes"));
        }
        let samples = block.first().map_or(0, |history| history.u.len());
        let mut bytes = Vec::with_capacity(samples * SAMPLE);
        self.file.seek(SeekFrom::End(0))?;
        for history in block {
            for series in Series::ALL {
                bytes.clear();
                bytes.extend(history.series(series).iter().flat_map(|value| value.to_le_bytes()));
                self.file.write_all(&bytes)?;
            }
        }
        self.index.blocks.push(samples);
        Ok(())
    }
}

impl Index {
    /// Bytes of all blocks.
    fn length(&self) -> u64 {
        self.blocks.iter().map(|&block| self.bytes(block)).sum()
    }

    /// Bytes of a block of so many samples.
    fn bytes(&self, samples: usize) -> u64 {
        (samples * self.nodes.len() * Series::ALL.len() * SAMPLE) as u64
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
        let mut values = Vec::with_capacity(samples.len());
        let mut bytes = Vec::new();
        let (mut first, mut start) = (0, 0);
        for &length in &self.index.blocks {
            let from = samples.start.clamp(first, first + length) - first;
            let to = samples.end.clamp(first, first + length) - first;
            if from < to {
                let row = index * Series::ALL.len() + series as usize;
                bytes.resize((to - from) * SAMPLE, 0);
                self.file.read_exact_at(&mut bytes, start + ((row * length + from) * SAMPLE) as u64)?;
                let (samples, _) = bytes.as_chunks::<SAMPLE>();
                values.extend(samples.iter().copied().map(f64::from_le_bytes));
            }
            first += length;
            start += self.index.bytes(length);
        }
        if values.len() != samples.len() {
            return Err(std::io::Error::other("samples beyond the end of a recording"));
        }
        Ok(Cow::Owned(values))
    }
}

impl Suspended {
    /// The whole as one file: the samples, and behind them the rest.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn to_file(&mut self) -> std::io::Result<&File> {
        let Self { checkpoint, spool: Spool { file, index } } = self;
        let parts = [checkpoint.to_bytes(), serde_json::to_vec(index).map_err(std::io::Error::other)?];
        // What an earlier call wrote behind the samples is overwritten.
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
    /// When the file cannot be read or is not one of a suspended run.
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
    use drillsweep_sim::control::Control;
    use drillsweep_sim::model::Model;
    use drillsweep_sim::scenario::preset;
    use drillsweep_sim::statics::Equilibrium;
    use drillsweep_sim::transient::{Outcome, Transient};

    use super::*;

    /// Two nodes with samples that tell node, series and number apart, from `first` on.
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

    #[test]
    fn what_was_kept_in_blocks_is_read_across_them() {
        let directory = tempfile::tempdir().unwrap();
        let mut spool = Spool::new(directory.path()).unwrap();
        let whole = block(0, 100);
        for (first, samples) in [(0, 33), (33, 1), (34, 66)] {
            spool.append(&block(first, samples)).unwrap();
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
        assert!(spool.append(&block(100, 1)[..1]).is_err(), "a node less");
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
