//! Time that other work on the machine disturbs little.

use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

/// Measures wall time, or the time that this thread had the processor, whichever is less: they are the same on an idle
/// machine, and all that is measured here runs in one thread.
pub(crate) struct Stopwatch {
    wall: Instant,
    thread: ThreadTime,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        let thread = ThreadTime::now();
        Self { wall: Instant::now(), thread }
    }

    /// The time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        let wall = self.wall.elapsed();
        self.thread.elapsed().min(wall)
    }
}
