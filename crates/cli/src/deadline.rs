//! `--time-limit`: until when a command that plans must have its plan.

use std::time::{Duration, Instant};

/// The option.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct TimeLimit {
    /// Stops after so many seconds, with exit status 3.
    #[arg(long = "time-limit", value_name = "SECONDS")]
    seconds: Option<f64>,
}

/// The moment; `None` if there is none.
#[derive(Clone, Copy, Debug)]
pub struct Deadline(Option<Instant>);

/// There was no answer in time.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("the time limit was reached before there was an answer")]
pub struct TimeIsUp;

impl TimeLimit {
    /// The limit, from now on.
    pub fn start(self) -> Deadline {
        // A limit too long to add to the present moment is none.
        let limit = self.seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds.max(0.0)).ok());
        Deadline(limit.and_then(|limit| Instant::now().checked_add(limit)))
    }
}

impl Deadline {
    /// Whether the time is up.
    pub fn is_over(self) -> bool {
        self.0.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// An error if what was planned is not decided because the time is up.
    pub fn check(self, outcome: &kirk::Outcome) -> Result<(), TimeIsUp> {
        if outcome.status == kirk::Status::Limit && self.is_over() { Err(TimeIsUp) } else { Ok(()) }
    }
}
