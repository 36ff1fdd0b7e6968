//! Why there is no plan, as data (SPEC 5.4, failure report).

use controllability::FailingRun;
use exact::{Bound, Time};
use rmpl::{Fix, Span};
use serde::{Deserialize, Serialize};
use tpn::{ArcId, Choice, LabelId, Network, UseId};

use crate::trace::{Constraint, CycleMember};
use crate::wording;

/// Why a mission has no plan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// One reason per group of complete choices, in the order of the choices. Together they cover all choices, unless
    /// `is_complete` is false.
    pub reasons: Vec<Reason>,
    /// Whether every complete choice has its reason; false if there were too many to list.
    pub is_complete: bool,
    /// Changes of one bound each that make the mission plannable, the smallest relative change first.
    /// Every one has been planned.
    pub relaxations: Vec<Relaxation>,
    /// Whether the mission has a plan if conflicting intervals may touch, without the gap of SPEC 5.3; found by planning.
    #[serde(default)]
    pub is_of_gap: bool,
}

/// What kind of contradiction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailureKind {
    /// Bounds contradict each other.
    Temporal,
    /// A requirement cannot be carried by any assertion.
    OpenCondition,
    /// Conflicting conditions cannot be kept apart.
    Threat,
    /// Activities need more of a resource than there is.
    Resource,
    /// The environment can choose durations after which no times are left (SPEC 13.1).
    Controllability,
}

impl FailureKind {
    /// The name used in all output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Temporal => "temporal",
            Self::OpenCondition => "open-condition",
            Self::Threat => "threat",
            Self::Resource => "resource",
            Self::Controllability => "controllability",
        }
    }
}

/// Why all complete choices that contain `choices` fail.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// The choices that led there, in textual order; empty if no choice has to do with it.
    pub choices: Vec<Choice>,
    /// What kind of contradiction it is.
    pub kind: FailureKind,
    /// A minimal conflict: with any one of these left out, what remains is consistent.
    pub conflict: Vec<Member>,
    /// One contradiction among the bounds, where there is one to show.
    pub cycle: Vec<CycleMember>,
    /// Whether `conflict` has been made minimal; false if that took too long.
    pub is_minimal: bool,
    /// The reason in the author's terms.
    pub message: String,
    /// The places in the text that the reason is about, the most telling first.
    pub spans: Vec<Span>,
    /// The run in which the environment breaks the plan that there would be if the executive chose all durations.
    pub failing_run: Option<FailingRun>,
}

impl Reason {
    /// The run in which the environment makes the mission fail, a line for each thing that happens; none without one.
    pub fn failing_run_in_words(&self, network: &Network) -> Vec<String> {
        self.failing_run.as_ref().map_or_else(Vec::new, |run| wording::failing_run(network, run))
    }
}

/// A part of a conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Member {
    /// One bound of an arc.
    Bound(Constraint),
    /// A condition that is required, or that conflicts with another.
    Condition(LabelId),
    /// A use of a resource.
    Use(UseId),
}

/// A change of one bound that makes the mission plannable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Relaxation {
    /// An arc that has the bound; all arcs made from the same text change with it.
    pub arc: ArcId,
    /// Whether the least duration changes; otherwise the greatest one. What the environment chooses becomes narrower by
    /// it, all else wider.
    pub is_lower: bool,
    pub old: Bound,
    /// The bound that gives a plan: the closest one in whole units of the mission's common denominator.
    pub new: Time,
    /// The bounds in the text, where they are written.
    pub span: Option<Span>,
    /// The new bounds, `[lower, upper]`.
    pub bounds_text: String,
    /// The change in the author's terms, as an imperative.
    pub label: String,
}

/// What the lines of a failing run say of an end that the environment chooses.
pub const NATURE_ENDS: &str = "the environment ends";

/// What [`Failure::is_of_gap`] offers, as an imperative.
pub const GAP_LABEL: &str = "allow conflicting conditions to touch: option threat_gap = 0;";

impl Failure {
    /// The option that takes the gap away, as an edit of the text, if that gives a plan.
    pub fn gap_fix(&self, source: &str) -> Option<Fix> {
        let edit = || rmpl::editor::set_option(&rmpl::parse(source), "threat_gap", "0");
        self.is_of_gap.then(|| Fix { label: GAP_LABEL.to_owned(), edits: vec![edit()] })
    }

    /// The kinds of all reasons, without repeats.
    pub fn kinds(&self) -> Vec<FailureKind> {
        let mut kinds: Vec<FailureKind> = self.reasons.iter().map(|reason| reason.kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }
}

impl Relaxation {
    /// The change as an edit of `source`: of the one number, if the span is that of bounds written `[…, …]`.
    pub fn fix(&self, source: &str) -> Option<Fix> {
        let span = self.span?;
        let text = source.get(span.range())?;
        let open = text.find('[').filter(|&open| matches!(text[..open].trim_end(), "" | "contingent"))?;
        let inside = text[open + 1..].strip_suffix(']')?;
        let comma = top_level_comma(inside)?;
        let (lower, upper) = (&inside[..comma], &inside[comma + 1..]);
        let (side, offset) = if self.is_lower { (lower, 0) } else { (upper, comma + 1) };
        let start = span.start as usize + open + 1 + offset + (side.len() - side.trim_start().len());
        let end = start + side.trim().len();
        let edit = rmpl::Edit { span: Span::new(start as u32, end as u32), text: self.new.decimal()? };
        Some(Fix { label: self.label.clone(), edits: vec![edit] })
    }
}

fn top_level_comma(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    text.char_indices().find_map(|(at, character)| {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => return Some(at),
            _ => {}
        }
        None
    })
}
