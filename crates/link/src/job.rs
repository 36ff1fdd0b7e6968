//! Everything that is computed is a job: a request with an id, of a kind that says which earlier jobs it makes pointless
//! and what the core keeps for the next one.
//!
//! A new kind of request is a variant of [`Request`], a line of [`RULES`], and a handler in `core`.

use std::fmt;
use std::hash::{DefaultHasher, Hasher as _};

use serde::{Deserialize, Serialize};

use crate::{Request, Source};

/// Names a job among those of one [`Link`](crate::Link).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct JobId(pub u64);

/// Names what is asked for: equal requests have equal keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobKey(u64);

/// A request on its way.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    pub id: JobId,
    /// Names what it asks for.
    pub key: JobKey,
    /// What it asks for.
    pub request: Request,
}

/// The kinds of job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Compile and plan a text.
    Update,
    /// Review the plan of a text.
    Review,
    /// Look for counterexamples of what has passed in a review.
    Contradict,
    /// Find out whether a flight rule holds in every plan.
    ProveRule,
    /// Plan another text, to compare with.
    Evaluate,
    /// Search a network both ways.
    CompareSearches,
    /// Execute a plan.
    Execute,
    /// Execute a plan many times, with chance.
    Sample,
    /// Run a control program.
    RunControl,
    /// Run a control program many times, with chance.
    SampleProgram,
    /// Find out what holds in all runs of a control program.
    ProveProgram,
    /// Grow the search tree of a path.
    GrowPath,
    /// Read a map file.
    ImportMap,
}

/// What holds for a kind of job.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    pub kind: Kind,
    /// The kinds of earlier jobs that are pointless once one of this kind is asked for.
    pub supersedes: &'static [Kind],
    /// What tells one request of the kind from another.
    pub key: &'static str,
    /// What the core keeps of it for later requests.
    pub kept: &'static str,
}

/// The rules of all kinds, in the order of [`Kind`].
pub const RULES: [Rule; 13] = {
    use Kind::{
        CompareSearches, Contradict, Evaluate, Execute, GrowPath, ImportMap, ProveProgram, ProveRule, Review,
        RunControl, Sample, SampleProgram, Update,
    };
    [
        Rule {
            kind: Update,
            // A newer text ends what was asked of the older one; a text to compare with represents itself.
            supersedes: &[
                Update,
                Review,
                Contradict,
                ProveRule,
                CompareSearches,
                Execute,
                Sample,
                RunControl,
                SampleProgram,
                ProveProgram,
                GrowPath,
            ],
            key: "revision, text, goal, search, seed, whether the search is recorded",
            kept: "the parse, the program, the network, control programs, the plan, paths, configuration spaces",
        },
        Rule {
            kind: Review,
            supersedes: &[Review],
            key: "as of Update, and the rules of the mission",
            kept: "as of Update",
        },
        Rule {
            kind: Contradict,
            supersedes: &[Contradict],
            key: "as of Update, the review, the line, how much is tried, the first step",
            kept: "as of Update, and how far the lines were tried",
        },
        Rule {
            kind: ProveRule,
            supersedes: &[ProveRule],
            key: "as of Update, the rule, how many alternatives are tried",
            kept: "as of Update, and paths",
        },
        Rule { kind: Evaluate, supersedes: &[Evaluate], key: "token, as of Update", kept: "paths" },
        Rule {
            kind: CompareSearches,
            supersedes: &[CompareSearches],
            key: "as of Update",
            kept: "as of Update",
        },
        Rule {
            kind: Execute,
            supersedes: &[Execute],
            key: "as of Update, and the script",
            kept: "as of Update, and the last runs of the plan",
        },
        Rule {
            kind: Sample,
            supersedes: &[Sample],
            key: "as of Update, the settings, the first run",
            kept: "as of Update, and the plan made ready for runs",
        },
        Rule {
            kind: RunControl,
            supersedes: &[RunControl],
            key: "revision, text, plant, seed, inputs of the steps, what the asker holds",
            kept: "the compiled program and plant, the run and its steps, estimates and commands found",
        },
        Rule {
            kind: SampleProgram,
            supersedes: &[SampleProgram],
            key: "revision, text, settings, the first run",
            kept: "the compiled program and plant",
        },
        Rule {
            kind: ProveProgram,
            supersedes: &[ProveProgram],
            key: "revision, text, question, how many states were found before",
            kept: "the compiled program and plant, and the states that were found",
        },
        Rule {
            kind: GrowPath,
            supersedes: &[GrowPath],
            key: "as of Update, the leg, the planner, what the asker holds",
            kept: "the search with its trees",
        },
        // Only one of the same name: see `Request::supersedes`.
        Rule { kind: ImportMap, supersedes: &[ImportMap], key: "name and content", kept: "the map" },
    ]
};

impl Kind {
    /// Returns what holds for the kind.
    pub fn rule(self) -> &'static Rule {
        &RULES[self as usize]
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

impl Request {
    /// The kind of request that the job makes.
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Update(_) => Kind::Update,
            Self::Review { .. } => Kind::Review,
            Self::Contradict { .. } => Kind::Contradict,
            Self::ProveRule { .. } => Kind::ProveRule,
            Self::Evaluate { .. } => Kind::Evaluate,
            Self::CompareSearches(_) => Kind::CompareSearches,
            Self::Execute { .. } => Kind::Execute,
            Self::Sample { .. } => Kind::Sample,
            Self::RunControl(_) => Kind::RunControl,
            Self::SampleProgram { .. } => Kind::SampleProgram,
            Self::ProveProgram { .. } => Kind::ProveProgram,
            Self::GrowPath(_) => Kind::GrowPath,
            Self::ImportMap { .. } => Kind::ImportMap,
        }
    }

    /// The revision of the text that it is about, if that is the open one.
    pub const fn revision(&self) -> Option<u64> {
        match self {
            Self::Update(update)
            | Self::Review { update, .. }
            | Self::Contradict { update, .. }
            | Self::ProveRule { update, .. }
            | Self::CompareSearches(update)
            | Self::Execute { update, .. }
            | Self::Sample { update, .. } => Some(update.revision),
            Self::SampleProgram { revision, .. } | Self::ProveProgram { revision, .. } => Some(*revision),
            Self::RunControl(wanted) => Some(wanted.revision),
            Self::GrowPath(wanted) => Some(wanted.update.revision),
            Self::ImportMap { .. } | Self::Evaluate { .. } => None,
        }
    }

    /// The text that it is about.
    pub const fn source(&self) -> Option<&Source> {
        match self {
            Self::Update(update)
            | Self::Review { update, .. }
            | Self::Contradict { update, .. }
            | Self::ProveRule { update, .. }
            | Self::CompareSearches(update)
            | Self::Execute { update, .. }
            | Self::Sample { update, .. }
            | Self::Evaluate { update, .. } => Some(&update.source),
            Self::SampleProgram { source, .. } | Self::ProveProgram { source, .. } => Some(source),
            Self::RunControl(wanted) => Some(&wanted.source),
            Self::GrowPath(wanted) => Some(&wanted.update.source),
            Self::ImportMap { .. } => None,
        }
    }

    /// The same, to be changed.
    pub const fn source_mut(&mut self) -> Option<&mut Source> {
        match self {
            Self::Update(update)
            | Self::Review { update, .. }
            | Self::Contradict { update, .. }
            | Self::ProveRule { update, .. }
            | Self::CompareSearches(update)
            | Self::Execute { update, .. }
            | Self::Sample { update, .. }
            | Self::Evaluate { update, .. } => Some(&mut update.source),
            Self::SampleProgram { source, .. } | Self::ProveProgram { source, .. } => Some(source),
            Self::RunControl(wanted) => Some(&mut wanted.source),
            Self::GrowPath(wanted) => Some(&mut wanted.update.source),
            Self::ImportMap { .. } => None,
        }
    }

    /// Names what is asked for.
    pub fn key(&self) -> JobKey {
        let mut hasher = DefaultHasher::new();
        hasher.write(&crate::wire::bytes_of_request(self));
        JobKey(hasher.finish())
    }

    /// Returns whether answering `earlier` is pointless once this is asked for.
    pub fn supersedes(&self, earlier: &Self) -> bool {
        match (self, earlier) {
            (Self::ImportMap { name: newer, .. }, Self::ImportMap { name: earlier, .. }) => newer == earlier,
            _ => self.kind().rule().supersedes.contains(&earlier.kind()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_its_rule() {
        for (at, rule) in RULES.iter().enumerate() {
            assert_eq!(rule.kind as usize, at, "{}", rule.kind);
        }
    }

    #[test]
    fn the_architecture_lists_every_job() {
        let page = include_str!("../../../ARCHITECTURE.md");
        for Rule { kind, supersedes, key, kept } in &RULES {
            let supersedes: Vec<String> = supersedes.iter().map(ToString::to_string).collect();
            let row = format!("| {kind} | {} | {key} | {kept} |", supersedes.join(", "));
            assert!(page.contains(&row), "{row}");
        }
    }
}
