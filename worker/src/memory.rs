//! Memory of this process, and its limit.

use std::fs::read_to_string;

/// Part of the memory that may be had beyond which a worker says so.
const NEARLY_FULL: f64 = 0.8;

/// Memory of this process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Memory {
    /// Resident memory \[bytes\].
    pub(crate) resident: u64,
    /// Its limit \[bytes\]: memory of the machine, or the limit of its control group if that is lower.
    pub(crate) limit: u64,
}

impl Memory {
    /// The present memory; `None` on systems that do not report it as Linux does.
    pub(crate) fn now() -> Option<Self> {
        let resident = kilobytes(&read_to_string("/proc/self/status").ok()?, "VmRSS:")?;
        let machine = kilobytes(&read_to_string("/proc/meminfo").ok()?, "MemTotal:")?;
        // The group that a container shows as its own; without a limit it says "max".
        let group = read_to_string("/sys/fs/cgroup/memory.max").ok();
        let group = group.and_then(|text| text.trim().parse().ok()).unwrap_or(u64::MAX);
        Some(Self { resident, limit: machine.min(group) })
    }

    /// Text that follows "the last worker" should this one be heard of no more; none if there is room.
    pub(crate) fn note(self) -> Option<String> {
        let Self { resident, limit } = self;
        (resident as f64 > NEARLY_FULL * limit as f64).then(|| {
            let gigabytes = |bytes: u64| bytes as f64 / 1e9;
            format!(
                "used {:.1} GB of its memory limit of {:.1} GB, and was probably killed for lack of memory",
                gigabytes(resident),
                gigabytes(limit)
            )
        })
    }
}

/// The value of a line such as `MemTotal: 16 kB` \[bytes\].
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_equals_that_of_the_system() {
        let held = vec![1_u8; 64 << 20];
        let memory = Memory::now().unwrap();
        assert!(std::hint::black_box(&held).iter().all(|&byte| byte == 1));
        assert!((64 << 20..memory.limit).contains(&memory.resident), "{memory:?}");
        assert_eq!(kilobytes("VmPeak:\t 5 kB\nVmRSS:\t     1234 kB\n", "VmRSS:"), Some(1234 * 1024));
        assert_eq!(kilobytes("VmPeak:\t 5 kB", "VmRSS:"), None);
    }

    #[test]
    fn a_worker_that_is_nearly_full_says_so() {
        let memory = |resident| Memory { resident, limit: 16_000_000_000 };
        assert_eq!(memory(12_000_000_000).note(), None);
        assert!(
            memory(15_000_000_000).note().unwrap().starts_with("used 15.0 GB of its memory limit of 16.0 GB")
        );
    }
}
