//! Time that a thread takes.

use std::time::Instant;

/// Wall and processor time of the calling thread.
pub(crate) struct Stopwatch {
    wall: Instant,
    cpu: f64,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self { wall: Instant::now(), cpu: thread_cpu_time() }
    }

    /// Wall and processor time since the start \[s\].
    pub(crate) fn elapsed(&self) -> (f64, f64) {
        (self.wall.elapsed().as_secs_f64(), thread_cpu_time() - self.cpu)
    }
}

fn thread_cpu_time() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
