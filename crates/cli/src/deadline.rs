//! `--time-limit`: until when a command that plans must have its plan.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::output::{E_TIME, Format, LIMIT, print_failure};

/// The option.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct TimeLimit {
    /// Stop after SECONDS (exit status 3).
    #[arg(long = "time-limit", value_name = "SECONDS", value_parser = parse_seconds)]
    seconds: Option<f64>,
}

/// The value of an option that counts seconds.
pub fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds > 0.0);
    seconds.ok_or_else(|| "expected a number of seconds above 0, as in 30 or 0.5".to_owned())
}

/// How long the best plan so far may take to be finished.
const GRACE: Duration = Duration::from_secs(1);

/// The moment; `None` if there is none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deadline(Option<Instant>);

/// A limit that ends the process.
pub struct Enforced(Arc<Mutex<bool>>);

impl Enforced {
    /// Lifts the limit, because there is an answer.
    pub fn answered(self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
    }
}

/// There was no answer in time.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("time limit reached: {}", .0.in_words())]
pub struct TimeIsUp(pub Undecided);

/// What was not done when the time was up.
#[derive(Clone, Copy, Debug)]
pub enum Undecided {
    /// Whether there is a plan.
    Plan,
    /// How the execution of the plan ends.
    Execution,
    /// How many of the executions of the plan succeed.
    Robustness,
    /// What a review says of the plan.
    Review,
    /// Whether every plan keeps the rules.
    Proof,
}

impl Undecided {
    /// Returns what it means, as the end of a sentence.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Plan => "undecided whether there is a plan",
            Self::Execution => "the execution did not end",
            Self::Robustness => "not all runs ended",
            Self::Review => "the plan was not reviewed",
            Self::Proof => "undecided whether every plan keeps the rules",
        }
    }
}

impl TimeLimit {
    /// Returns how long it is; `None` without a limit, or if the limit is longer than a duration can be.
    pub fn duration(self) -> Option<Duration> {
        self.seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
    }

    /// The limit, from now on.
    pub fn start(self) -> Deadline {
        // A limit too long to add to the present moment is none.
        Deadline(self.duration().and_then(|limit| Instant::now().checked_add(limit)))
    }
}

impl Deadline {
    /// Returns whether the time is up.
    pub fn is_over(self) -> bool {
        self.0.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Milliseconds until the time is up; `None` without a limit.
    pub fn remaining_millis(self) -> Option<f64> {
        Some(self.0?.saturating_duration_since(Instant::now()).as_secs_f64() * 1000.0)
    }

    /// Returns whether there was also some time for what the time was up in the middle of.
    pub fn is_long_over(self) -> bool {
        self.0.is_some_and(|deadline| Instant::now() >= deadline + GRACE)
    }

    /// Ends the process when the time is up, until [`Enforced::answered`] is called.
    pub fn enforce(self, undecided: Undecided, answer: (&'static str, Format)) -> Enforced {
        let enforced = Enforced(Arc::new(Mutex::new(false)));
        if let Some(moment) = self.0 {
            let is_answered = Arc::clone(&enforced.0);
            std::thread::spawn(move || {
                std::thread::sleep(moment.saturating_duration_since(Instant::now()));
                // The lock is held until the answer is printed.
                let is_answered = is_answered.lock().unwrap_or_else(PoisonError::into_inner);
                if !*is_answered {
                    print_failure(answer, E_TIME, &TimeIsUp(undecided).to_string());
                    std::process::exit(i32::from(LIMIT));
                }
            });
        }
        enforced
    }

    /// An error if what was planned is not decided because the time is up.
    pub fn check(self, outcome: &kirk::Outcome) -> Result<(), TimeIsUp> {
        if outcome.status == kirk::Status::Limit && self.is_over() {
            Err(TimeIsUp(Undecided::Plan))
        } else {
            Ok(())
        }
    }
}
