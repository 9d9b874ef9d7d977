//! Speed of this machine, measured once a week and kept in the user's cache directory.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use drillsweep_study::plan::MachineSpeed;
use drillsweep_worker::{ComputeError, calibrate};
use etcetera::{BaseStrategy as _, choose_base_strategy};
use jiff::{SignedDuration, Timestamp};
use serde::{Deserialize, Serialize};
use tempfile::NamedTempFile;

#[derive(Args)]
pub(crate) struct SpeedArguments {
    /// Measure the speed of this machine, even if it was measured in the last seven days.
    #[arg(long)]
    measure_speed: bool,
}

/// Age from which a speed is measured again: firmware, cooling and neighbours of a virtual machine change it.
const OLDEST: SignedDuration = SignedDuration::from_hours(7 * 24);

/// Most bytes that a file of a speed may have; it has some 700.
const MOST_BYTES: u64 = 16 * 1024;

/// Longest time of a node's step or equilibrium \[s\] that is believed: some thousand times that of a slow machine.
const LONGEST: f64 = 1.0;

/// A speed with the time of its measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KnownSpeed {
    /// The speed.
    pub(crate) speed: MachineSpeed,
    /// Time at which an earlier command measured it; absent if this one did.
    pub(crate) kept_since: Option<Timestamp>,
}

/// Program and machine for which a measurement is valid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Subject {
    /// Version, size and time of the program's file: another build is as fast as its compiler made it.
    program: String,
    /// Name and signature of the processor.
    processor: String,
    /// Threads that run at the same time.
    threads: usize,
}

/// Content of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct KeptSpeed {
    subject: Subject,
    measured: Timestamp,
    speed: MachineSpeed,
}

/// The speed of this machine, from the cache or measured in a second or two. A cache that cannot be read or written is as an empty one.
///
/// # Errors
/// A run of the measurement fails, which it does on no machine that computes correctly.
pub(crate) fn machine_speed(arguments: &SpeedArguments) -> Result<KnownSpeed, ComputeError> {
    let file = choose_base_strategy()
        .inspect_err(|error| tracing::debug!(%error, "no cache directory"))
        .ok()
        .map(|directories| directories.cache_dir().join("drillsweep"))
        .zip(Subject::this())
        .map(|(directory, subject)| SpeedFile { path: directory.join(subject.file_name()), subject });
    let Some(file) = file else { return Ok(KnownSpeed { speed: calibrate()?, kept_since: None }) };
    let now = Timestamp::now();
    if !arguments.measure_speed
        && let Some(kept) = file.read(now)
    {
        return Ok(KnownSpeed { speed: kept.speed, kept_since: Some(kept.measured) });
    }
    let speed = calibrate()?;
    file.write(now, speed);
    Ok(KnownSpeed { speed, kept_since: None })
}

impl Subject {
    /// This program on this machine; absent if its file cannot be examined.
    fn this() -> Option<Self> {
        let examine = || {
            let metadata = std::env::current_exe()?.metadata()?;
            let changed = metadata.modified()?.duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
            let threads = std::thread::available_parallelism()?.get();
            let program = format!("{} {} {}", env!("CARGO_PKG_VERSION"), metadata.len(), changed.as_nanos());
            Ok(Self { program, processor: processor(), threads })
        };
        let examined: std::io::Result<_> = examine();
        examined.inspect_err(|error| tracing::debug!(%error, "this program cannot be examined")).ok()
    }

    /// One file for each kind of machine that shares the directory, so that builds replace each other's.
    fn file_name(&self) -> String {
        let machine = blake3::hash(format!("{}\n{}", self.processor, self.threads).as_bytes());
        format!("machine-speed-{}.json", &machine.to_hex()[..16])
    }
}

/// Name and signature (family, model, stepping) of the processor.
#[cfg(target_arch = "x86_64")]
fn processor() -> String {
    use std::arch::x86_64::__cpuid;
    // Leaves 0x80000002 to 0x80000004 have the name, 16 bytes each (Intel SDM, volume 2A, CPUID).
    let last = 0x8000_0004;
    let has_name = __cpuid(0x8000_0000).eax >= last;
    let registers = (0x8000_0002..=last).filter(|_| has_name).flat_map(|leaf| {
        let found = __cpuid(leaf);
        [found.eax, found.ebx, found.ecx, found.edx]
    });
    let name: Vec<u8> = registers.flat_map(u32::to_le_bytes).filter(|byte| *byte != 0).collect();
    format!("{} {:x}", String::from_utf8_lossy(&name).trim(), __cpuid(1).eax)
}

/// Architecture of the processor.
#[cfg(not(target_arch = "x86_64"))]
fn processor() -> String {
    std::env::consts::ARCH.to_owned()
}

/// Place of a kept speed.
#[derive(Debug)]
struct SpeedFile {
    path: PathBuf,
    subject: Subject,
}

impl SpeedFile {
    /// The kept speed; none if there is no file, or one of another program or machine, too old, or damaged.
    fn read(&self, now: Timestamp) -> Option<KeptSpeed> {
        let mut text = String::new();
        File::open(&self.path).ok()?.take(MOST_BYTES).read_to_string(&mut text).ok()?;
        let kept: KeptSpeed = serde_json::from_str(&text)
            .inspect_err(|error| tracing::debug!(%error, path = %self.path.display(), "not a speed"))
            .ok()?;
        let age = now.duration_since(kept.measured);
        let is_fresh = age >= SignedDuration::ZERO && age < OLDEST;
        (is_fresh && kept.subject == self.subject && is_plausible(&kept.speed)).then_some(kept)
    }

    /// Replaces the file as a whole: a reader has the old or the new speed, and of two writers the later one stays.
    fn write(&self, now: Timestamp, speed: MachineSpeed) {
        let kept = KeptSpeed { subject: self.subject.clone(), measured: now, speed };
        if let Err(error) = replace(&self.path, &kept) {
            tracing::debug!(%error, path = %self.path.display(), "the speed cannot be kept");
        }
    }
}

fn replace(path: &Path, kept: &KeptSpeed) -> std::io::Result<()> {
    let directory = path.parent().ok_or(std::io::ErrorKind::InvalidFilename)?;
    std::fs::create_dir_all(directory)?;
    let mut file = NamedTempFile::new_in(directory)?;
    file.write_all(&serde_json::to_vec_pretty(kept)?)?;
    file.persist(path)?;
    Ok(())
}

fn is_plausible(speed: &MachineSpeed) -> bool {
    let MachineSpeed { statics_per_node, start_per_node, step_per_node, large_mesh_factor, along_elements } =
        speed;
    let times = [statics_per_node].into_iter().chain(start_per_node).chain(step_per_node.as_flattened());
    let factors = [large_mesh_factor].into_iter().chain(along_elements);
    times.into_iter().all(|time| *time > 0.0 && *time < LONGEST)
        && factors.into_iter().all(|factor| *factor >= 1.0 && factor.is_finite())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const SPEED: MachineSpeed = MachineSpeed {
        statics_per_node: 2e-4,
        start_per_node: [2e-5; 4],
        step_per_node: [[1e-6; 3], [4e-6; 3], [6e-6; 3], [5e-7; 3]],
        large_mesh_factor: 1.2,
        along_elements: [1.1; 4],
    };

    fn file_in(directory: &Path) -> SpeedFile {
        let subject = Subject::this().unwrap();
        SpeedFile { path: directory.join("drillsweep").join(subject.file_name()), subject }
    }

    #[test]
    fn a_speed_is_kept_to_the_bit_for_a_week() {
        let directory = tempfile::tempdir().unwrap();
        let file = file_in(directory.path());
        let now = Timestamp::now();
        assert_eq!(file.read(now), None, "there is no file");
        let third = MachineSpeed { statics_per_node: 1e-4 / 3.0, ..SPEED };
        file.write(now, third);
        let read = |seconds: i64| file.read(now + SignedDuration::from_secs(seconds)).map(|kept| kept.speed);
        let week = 7 * 24 * 3600;
        assert_eq!((read(0), read(week - 1)), (Some(third), Some(third)));
        assert_eq!((read(week), read(-1)), (None, None), "too old, and of a clock that was set back");
        file.write(now, SPEED);
        assert_eq!(read(0), Some(SPEED));
        let files = fs::read_dir(file.path.parent().unwrap()).unwrap();
        assert_eq!(files.count(), 1, "no file of the writing remains");
    }

    #[test]
    fn a_speed_of_another_program_or_machine_is_not_used() {
        let directory = tempfile::tempdir().unwrap();
        let file = file_in(directory.path());
        let now = Timestamp::now();
        file.write(now, SPEED);
        let of = |change: fn(&mut Subject)| {
            let mut other = SpeedFile { path: file.path.clone(), subject: file.subject.clone() };
            change(&mut other.subject);
            (other.read(now), other.subject.file_name() == file.subject.file_name())
        };
        assert_eq!(of(|subject| subject.program.push('1')), (None, true), "a build replaces the file");
        assert_eq!(of(|subject| subject.processor.push('1')), (None, false));
        assert_eq!(of(|subject| subject.threads += 1), (None, false));
        assert!(file.subject.processor.len() > 2, "{:?}", file.subject);
    }

    #[test]
    fn a_damaged_file_is_measured_again_and_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let file = file_in(directory.path());
        let now = Timestamp::now();
        file.write(now, SPEED);
        let whole = fs::read_to_string(&file.path).unwrap();
        let damaged = [
            String::new(),
            whole[..whole.len() / 2].to_owned(),
            format!("{whole}{whole}"),
            whole.replace("0.0002", "-0.0002"),
            whole.replace("0.0002", "1e300"),
            whole.replace("1.2", "0.5"),
            format!("{}{whole}", " ".repeat(MOST_BYTES as usize)),
        ];
        for text in damaged {
            assert_ne!(text, whole);
            fs::write(&file.path, &text).unwrap();
            assert_eq!(file.read(now), None, "{text}");
        }
        fs::write(&file.path, [0xff, 0xfe]).unwrap();
        assert_eq!(file.read(now), None, "not text");
        file.write(now, SPEED);
        assert!(file.read(now).is_some());
    }

    #[test]
    fn a_directory_that_cannot_be_used_is_no_error() {
        let directory = tempfile::tempdir().unwrap();
        let file = file_in(directory.path());
        fs::write(directory.path().join("drillsweep"), "a file").unwrap();
        file.write(Timestamp::now(), SPEED);
        assert_eq!(file.read(Timestamp::now()), None);
        let file = file_in(&directory.path().join("other"));
        fs::create_dir_all(&file.path).unwrap();
        file.write(Timestamp::now(), SPEED);
        assert_eq!(file.read(Timestamp::now()), None, "a directory in place of the file");
    }

    #[test]
    fn writers_at_the_same_time_leave_a_whole_file_to_every_reader() {
        let directory = tempfile::tempdir().unwrap();
        let file = file_in(directory.path());
        let now = Timestamp::now();
        file.write(now, SPEED);
        std::thread::scope(|scope| {
            for writer in 1..=3 {
                let file = &file;
                let speed = MachineSpeed { statics_per_node: f64::from(writer) * 1e-4, ..SPEED };
                scope.spawn(move || (0..50).for_each(|_| file.write(now, speed)));
            }
            for _ in 0..200 {
                assert!(file.read(now).is_some());
            }
        });
    }
}
