//! Monte Carlo runs of a review history, made again: anyone can write any figures into a file, and sign them.

use std::path::Path;

use mission::Manner;
use review::Record;
use review::record::Runs;
use serde_json::{Value, json};
use snapshot::{Goal, Robustness, Snapshot, Tally};

use crate::deadline::{Deadline, TimeIsUp, Undecided};
use crate::opened::Opened;

/// Runs that were made again.
pub struct Repeated {
    kept: Runs,
    pub robustness: Robustness,
}

impl Repeated {
    /// Returns whether they came to what the history says.
    pub fn is_same(&self) -> bool {
        self.kept.tally == self.robustness.tally
    }

    /// Returns what they came to: `20 runs repeated, with the same result`.
    pub fn sentence(&self) -> String {
        let runs = exact::counted(self.kept.tally.runs, "run");
        if self.is_same() {
            return format!("{runs} repeated, with the same result");
        }
        format!(
            "{runs} repeated, with another result: {} reached the end, but the history says {}",
            self.robustness.tally.succeeded, self.kept.tally.succeeded
        )
    }

    pub fn json(&self) -> Value {
        let of = |tally: &Tally| json!({ "runs": tally.runs, "succeeded": tally.succeeded });
        json!({ "repeated": of(&self.robustness.tally), "kept": of(&self.kept.tally), "is_same": self.is_same() })
    }
}

/// Makes the runs that a history has of a content again, from the text of its snapshot; `None` if the history has none. `file` is
/// where the text was read. Fails when the time is up.
pub fn repeat(
    record: &Record,
    (file, snapshot, goal, content_hash): (&Path, &Snapshot, &Goal, &str),
    seed: u64,
    deadline: Deadline,
) -> anyhow::Result<Option<Repeated>> {
    let Some(kept) = record.runs_of(content_hash) else { return Ok(None) };
    let mut mission = Opened::new(file, snapshot.source.to_string(), goal.clone());
    let compiled = mission.compile()?;
    let is_possible = compiled.network().is_some_and(|network| kept.uncertainty.problem(network).is_none());
    if !is_possible {
        return Ok(None);
    }
    let ground = mission.ground(&compiled)?;
    let evaluated = mission.plan(compiled, ground, Manner { seed, ..Manner::default() }, deadline)?;
    let Some(sampler) = evaluated.sampler(&kept.uncertainty) else { return Ok(None) };
    let sampler = sampler?;
    let settings = kept.robustness().settings;
    let mut tally = Tally::default();
    for number in 0..kept.tally.runs {
        anyhow::ensure!(!deadline.is_over(), TimeIsUp(Undecided::Robustness));
        mission.core.sample_run((&evaluated, &sampler), &settings, number, &mut tally)?;
    }
    Ok(Some(Repeated { kept: kept.clone(), robustness: Robustness { settings, tally } }))
}
