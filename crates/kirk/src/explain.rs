//! Why there is no plan: one minimal conflict per group of choices (SPEC 5.4, 5.6).
//!
//! A search that records what each failure rests on gives a sufficient set of bounds and conditions; leaving out one
//! after the other while what remains is still contradictory makes it minimal. Where there are too many failures to
//! list, the mission as a whole gets one reason.

use std::collections::BTreeSet;

use rmpl::Span;
use tpn::{Choice, DecisionId, LabelId, Network, OccurrenceKind};
use typed_index_collections::TiVec;

use crate::choices::Choices;
use crate::failure::{Failure, Member, Reason};
use crate::model::{INFINITE, Model, UNBOUNDED_BELOW};
use crate::options::{Stats, Termination, Unlimited};
use crate::solver::{self, Answer, Problem, Touching};
use crate::trace::{Constraint, CycleMember};
use crate::{rotation, single_reason, solver_search, wording};

/// Explaining stops adding reasons after this many.
const MAX_REASONS: usize = 64;

/// Conflicts that the solver may meet in all searches of one explanation: a second or two.
const MAX_CONFLICTS: u64 = 30_000;

/// How much work explanations may be, in searches of a whole network of a certain size.
pub(crate) struct Effort<'t> {
    /// Searches left.
    pub(crate) searches: usize,
    /// Conflicts that the solver may still meet.
    conflicts: u64,
    termination: &'t mut dyn Termination,
}

impl<'t> Effort<'t> {
    pub(crate) fn for_size(num_nodes: usize, termination: &'t mut dyn Termination) -> Self {
        let size = num_nodes.max(1);
        Self { searches: (1_000_000 / size).clamp(60, 5_000), conflicts: MAX_CONFLICTS, termination }
    }

    /// Returns whether there is nothing left to spend.
    pub(crate) const fn is_exhausted(&self) -> bool {
        self.searches == 0 || self.conflicts == 0
    }

    pub(crate) fn spend(&mut self) -> bool {
        self.searches = self.searches.saturating_sub(1);
        self.searches > 0
    }

    /// Returns what the solver says of a part of a problem, unless that takes too long.
    pub(crate) fn solve(&mut self, model: &Model, part: solver::Part<'_>) -> Option<Refuted> {
        let mut is_stopped = false;
        let mut is_spent = |stats: &Stats| {
            is_stopped |= self.termination.should_stop(stats);
            is_stopped || stats.conflicts >= self.conflicts
        };
        let told = Problem::new(model, part, &mut || is_spent(&Stats::default()));
        let (mut problem, mut solver) = told.ok()?;
        let answer = solver.solve(&mut problem, &mut is_spent);
        self.conflicts = self.conflicts.saturating_sub(solver.stats.conflicts);
        if is_stopped {
            self.searches = 0;
        }
        match answer {
            Answer::Solved => Some(Refuted::No(problem.solution(&solver))),
            Answer::Unsolvable => Some(Refuted::By(problem.core(&solver))),
            Answer::Stopped => None,
        }
    }
}

/// What the solver makes of a part.
pub(crate) enum Refuted {
    /// It has a solution.
    No(Choices),
    /// With what that rests on, if it is wanted and known.
    By(Option<Vec<Member>>),
}

/// Returns whether `members` alone make every completion of `choices` fail: the definition of a conflict. Bounds that
/// are not members do not count; conditions that are not members need no assertion and threaten nothing, but assertions
/// still carry requirements. `None` if that takes too long to find out or times do not fit.
pub fn is_conflict(network: &Network, choices: &[Choice], members: &[Member]) -> Option<bool> {
    let model = Model::new(network, None).ok()?;
    let mut unlimited = Unlimited;
    let mut effort = Effort::for_size(model.num_nodes, &mut unlimited);
    let mut part = Part::new(&model, choices);
    for &member in members {
        part.set(member, true);
    }
    part.is_refuted(&mut effort)
}

/// Returns why no plan makes `choices`, where none does: reasons that rest on these choices and on any others, and on
/// nothing that `choices` leave out. Empty if that takes too long to find out, times do not fit, or there is a plan.
pub fn explain_choices(
    network: &Network,
    choices: &[Choice],
    termination: &mut dyn Termination,
) -> Vec<Reason> {
    let Ok(model) = Model::new(network, None) else { return Vec::new() };
    explain(network, &model, choices, termination).reasons
}

/// Explains why there is no plan that makes the choices given: one reason for each part of the choices that fails, the
/// first complete choice in textual order first.
pub(crate) fn explain(
    network: &Network,
    model: &Model,
    given: &[Choice],
    termination: &mut dyn Termination,
) -> Failure {
    let mut effort = Effort::for_size(model.num_nodes, termination);
    let mut reasons: Vec<Reason> = Vec::new();
    let mut is_complete = false;
    let is_by_choices = !solver_search::has_demands(model) && model.has_contexts;
    while is_by_choices && reasons.len() < MAX_REASONS && !effort.is_exhausted() {
        let excluded = reasons.iter().map(|reason| reason.choices.as_slice()).collect::<Vec<_>>();
        let choices = match first_completion(model, given, &excluded) {
            Completion::Found(choices) => choices,
            Completion::None => {
                is_complete = !reasons.is_empty();
                break;
            }
            Completion::Unknown => break,
        };
        let Some(mut reason) = single_reason::reason(network, model, &choices, &mut effort) else { break };
        add_outer_choices(model, &mut reason.choices);
        reasons.push(reason);
    }
    if !is_complete && let Some(reason) = single_reason::reason(network, model, given, &mut effort) {
        reasons.insert(0, reason);
        is_complete = true;
    }
    Failure { is_complete, reasons, relaxations: Vec::new(), is_of_gap: false }
}

/// The first complete choice that is none of those excluded.
enum Completion {
    Found(Vec<Choice>),
    None,
    /// Looking for it takes too long.
    Unknown,
}

/// Looking for a complete choice may take so many steps.
const MAX_STEPS: usize = 100_000;

/// The first complete choice in textual order that makes the choices given and contains none of `excluded`.
fn first_completion(model: &Model, given: &[Choice], excluded: &[&[Choice]]) -> Completion {
    let taken = assumed(model, given);
    let mut chosen: TiVec<DecisionId, Option<u32>> = vec![None; model.decisions.len()].into();
    // Each decision on the way with the alternative to try next.
    let mut path: Vec<(DecisionId, u32)> = Vec::new();
    for _ in 0..MAX_STEPS {
        let is_excluded = excluded
            .iter()
            .any(|choices| choices.iter().all(|choice| chosen[choice.decision] == Some(choice.alternative)));
        let first = path.last().map_or(0, |(last, _)| last.index() + 1);
        let is_open = |&decision: &DecisionId| {
            let context = model.decisions[decision].context;
            context.is_none_or(|outer| chosen[outer.decision] == Some(outer.alternative))
        };
        let next = (first..model.decisions.len()).map(DecisionId::from_index).find(is_open);
        match next.filter(|_| !is_excluded) {
            Some(decision) => path.push((decision, taken[decision].unwrap_or(0))),
            None if !is_excluded => {
                let choices = chosen.iter_enumerated();
                let choices = choices.filter_map(|(decision, &alternative)| {
                    Some(Choice { decision, alternative: alternative? })
                });
                return Completion::Found(choices.collect());
            }
            None => {
                // The last decision with an alternative left takes that.
                loop {
                    let Some((decision, alternative)) = path.last_mut() else { return Completion::None };
                    chosen[*decision] = None;
                    let count = model.decisions[*decision].alternatives.len() as u32;
                    if taken[*decision].is_none() && *alternative + 1 < count {
                        *alternative += 1;
                        break;
                    }
                    path.pop();
                }
            }
        }
        if let Some(&(decision, alternative)) = path.last() {
            chosen[decision] = Some(alternative);
        }
    }
    Completion::Unknown
}

/// Adds the choices that lead to those that are there.
fn add_outer_choices(model: &Model, choices: &mut Vec<Choice>) {
    let mut next = 0;
    while let Some(&choice) = choices.get(next) {
        let outer = model.decisions[choice.decision].context;
        choices.extend(outer.filter(|outer| !choices.contains(outer)));
        next += 1;
    }
    choices.sort_unstable();
}

/// The places of a conflict: its conditions, then the bounds that take time; without a cycle those that it needs, what
/// the environment chooses last.
pub(crate) fn spans(network: &Network, members: &[Member], cycle: &[CycleMember]) -> Vec<Span> {
    let conditions = members.iter().filter_map(|member| match member {
        Member::Condition(label) => {
            let label = &network.labels[label.index()];
            let owner = label.owner.map(|owner| &network.occurrences[owner.index()]);
            // What a clause says of an activity is told where that is called.
            let call = owner.filter(|owner| owner.kind == OccurrenceKind::Primitive);
            let is_clause = call.is_some_and(|call| {
                call.span
                    .zip(label.span)
                    .is_none_or(|(call, own)| own.start < call.start || own.start > call.end)
            });
            if is_clause { call.and_then(|call| call.span).or(label.span) } else { label.span }
        }
        Member::Use(used) => {
            let used = &network.uses[used.index()];
            used.owner.and_then(|owner| network.occurrences[owner.index()].span).or(used.span)
        }
        Member::Bound(_) => None,
    });
    let bounds = cycle.iter().filter_map(|member| match member.constraint {
        Constraint::Lower(arc) | Constraint::Upper(arc) if wording::is_telling(network, member) => {
            network.arcs[arc.index()].span
        }
        _ => None,
    });
    let needed = |is_natures: bool| {
        members.iter().filter_map(move |member| match member {
            Member::Bound(Constraint::Lower(arc) | Constraint::Upper(arc)) if cycle.is_empty() => {
                let described = &network.arcs[arc.index()];
                let is_told = !wording::is_structural(described.kind);
                described.span.filter(|_| is_told && network.is_uncertain(*arc) == is_natures)
            }
            _ => None,
        })
    };
    let mut spans: Vec<Span> = Vec::new();
    for span in conditions.chain(bounds).chain(needed(false)).chain(needed(true)) {
        if !spans.contains(&span) {
            spans.push(span);
        }
    }
    spans
}

/// The alternative of each decision that is chosen; those that the network has not are left out.
fn assumed(model: &Model, choices: &[Choice]) -> TiVec<DecisionId, Option<u32>> {
    let mut alternatives: TiVec<DecisionId, Option<u32>> = vec![None; model.decisions.len()].into();
    for choice in choices {
        if let Some(taken) = alternatives.get_mut(choice.decision) {
            *taken = Some(choice.alternative);
        }
    }
    alternatives
}

/// The planning problem that has only some of the bounds and conditions of another.
pub(crate) struct Part<'m> {
    mission: &'m Model,
    model: Model,
    active_labels: TiVec<LabelId, bool>,
    active_uses: Vec<bool>,
    assumed: TiVec<DecisionId, Option<u32>>,
    /// Whether durations that the environment chooses are chosen like all others.
    pub(crate) ignores_nature: bool,
}

impl<'m> Part<'m> {
    pub(crate) fn new(mission: &'m Model, choices: &[Choice]) -> Self {
        let mut model = mission.clone();
        // Without their bounds, arcs may be over before they begin.
        (model.structure, model.nesting) = (None, None);
        for arc in &mut model.arcs {
            (arc.lower, arc.upper) = (UNBOUNDED_BELOW, INFINITE);
        }
        Self {
            active_labels: vec![false; model.conditions.labels.len()].into(),
            active_uses: vec![false; model.demands.num_uses()],
            assumed: assumed(mission, choices),
            mission,
            model,
            ignores_nature: false,
        }
    }

    pub(crate) fn set(&mut self, member: Member, is_in: bool) {
        match member {
            Member::Condition(label) => self.active_labels[label] = is_in,
            Member::Use(used) => self.active_uses[used.index()] = is_in,
            Member::Bound(Constraint::Lower(arc)) => {
                self.model.arcs[arc].lower =
                    if is_in { self.mission.arcs[arc].lower } else { UNBOUNDED_BELOW };
            }
            Member::Bound(Constraint::Upper(arc)) => {
                self.model.arcs[arc].upper = if is_in { self.mission.arcs[arc].upper } else { INFINITE };
            }
            Member::Bound(
                Constraint::Link(_)
                | Constraint::Order(_)
                | Constraint::UseOrder(_)
                | Constraint::Departure(_),
            ) => {}
        }
    }

    /// Members that are needed, by a solution of `members` without `dropped`.
    pub(crate) fn needed(
        &self,
        members: &[Member],
        dropped: &[Member],
        solution: &Choices,
    ) -> BTreeSet<Member> {
        // What withstands the environment is more than a solution.
        if self.mission.has_uncertainty && !self.ignores_nature {
            return BTreeSet::new();
        }
        rotation::needed(self.mission, members, dropped, solution)
    }

    /// Leaves the alternative of a decision open, or gives it.
    pub(crate) fn assume(&mut self, decision: DecisionId, alternative: Option<u32>) {
        self.assumed[decision] = alternative;
    }

    /// Returns whether the solver proves that the part has no plan, or finds one; `None` if that takes too long, or if
    /// gaps alone decide.
    pub(crate) fn is_refuted(&self, effort: &mut Effort<'_>) -> Option<bool> {
        Some(matches!(self.refute(effort, false)?, Refuted::By(_)))
    }

    /// The same, with what the proof rests on if that is wanted.
    pub(crate) fn refute(&self, effort: &mut Effort<'_>, wants_core: bool) -> Option<Refuted> {
        if !self.model.has_contexts || !effort.spend() {
            return None;
        }
        let part = solver::Part {
            active_labels: Some(&self.active_labels),
            alternatives: Some(&self.assumed),
            active_uses: Some(&self.active_uses),
            ignores_nature: self.ignores_nature,
            wants_core,
            lists_all: false,
            touching: Touching::Unneeded,
            mission: Some(self.mission),
        };
        effort.solve(&self.model, part)
    }
}
