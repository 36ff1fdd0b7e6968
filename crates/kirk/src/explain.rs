//! Why there is no plan: one minimal conflict per group of choices (SPEC 5.4, 5.6).
//!
//! A search that records what each failure rests on gives a sufficient set of bounds and conditions; leaving out one
//! after the other while what remains is still contradictory makes it minimal. Where there are too many failures to
//! list, the mission as a whole gets one reason.

use rmpl::Span;
use tpn::{Choice, DecisionId, LabelId, Network, OccurrenceKind};
use typed_index_collections::TiVec;

use crate::failure::{Failure, Member, Reason};
use crate::model::{INFINITE, Model};
use crate::options::{Stats, Termination, Unlimited};
use crate::record::RecordedFailure;
use crate::search::{Choices, Engine, Gaps, Halt, Setup, UNBOUNDED_BELOW};
use crate::solver::{self, Answer, Problem};
use crate::trace::{Constraint, CycleMember};
use crate::unplannable::Unplannable;
use crate::{demanding, whole, wording};

/// Explaining stops adding reasons after this many.
const MAX_REASONS: u64 = 64;

/// After going back so often, the solver takes over.
pub(crate) const MAX_BACKTRACKS: u64 = 200;
/// Conflicts that the solver may meet in all searches of one explanation: a second or two.
const MAX_CONFLICTS: u64 = 30_000;

/// How much work explanations may be, in searches of a whole network of a certain size.
pub(crate) struct Effort<'t> {
    /// Searches left.
    pub(crate) searches: usize,
    /// Alternatives that one search may try.
    expansions: u64,
    /// Conflicts that the solver may still meet.
    conflicts: u64,
    termination: &'t mut dyn Termination,
}

impl<'t> Effort<'t> {
    pub(crate) fn for_size(num_nodes: usize, termination: &'t mut dyn Termination) -> Self {
        let size = num_nodes.max(1);
        Self {
            searches: (1_000_000 / size).clamp(60, 5_000),
            expansions: (2_000_000 / size as u64).clamp(200, 10_000),
            conflicts: MAX_CONFLICTS,
            termination,
        }
    }

    /// Whether there is nothing left to spend.
    pub(crate) const fn is_exhausted(&self) -> bool {
        self.searches == 0 || self.conflicts == 0
    }

    pub(crate) fn spend(&mut self) -> bool {
        self.searches = self.searches.saturating_sub(1);
        self.searches > 0
    }

    /// Whether one search has done enough. Nothing more is searched once the termination condition says so.
    pub(crate) fn is_spent(&mut self, stats: &Stats) -> bool {
        if self.termination.should_stop(stats) {
            self.searches = 0;
        }
        self.searches == 0 || stats.expanded >= self.expansions
    }

    /// What the solver says of a part of a problem, unless that takes too long; with what a refutation rests on, if that
    /// is wanted and known.
    pub(crate) fn solve(
        &mut self,
        model: &Model,
        gaps: Gaps,
        part: solver::Part<'_>,
    ) -> Option<(Answer, Option<Vec<Member>>)> {
        let mut is_stopped = false;
        let mut is_spent = |stats: &Stats| {
            is_stopped |= self.termination.should_stop(stats);
            is_stopped || stats.conflicts >= self.conflicts
        };
        let told = Problem::new(model, gaps, part, &mut || is_spent(&Stats::default()));
        let (mut problem, mut solver) = told.ok()?;
        let answer = solver.solve(&mut problem, &mut is_spent);
        self.conflicts = self.conflicts.saturating_sub(solver.stats.conflicts);
        if is_stopped {
            self.searches = 0;
        }
        (answer != Answer::Stopped).then(|| (answer, problem.core(&solver)))
    }
}

/// What the solver makes of a part.
pub(crate) enum Refuted {
    /// It has a plan.
    No,
    /// With what that rests on, if it is known.
    By(Option<Vec<Member>>),
}

/// Whether `members` alone make every completion of `choices` fail: the definition of a conflict. Bounds that are not
/// members do not count; conditions that are not members need no assertion and threaten nothing, but assertions still
/// carry requirements. `None` if that takes too long to find out or times do not fit.
pub fn is_conflict(network: &Network, choices: &[Choice], members: &[Member]) -> Option<bool> {
    let model = Model::new(network, None).ok()?;
    let mut unlimited = Unlimited;
    let mut effort = Effort::for_size(model.num_nodes, &mut unlimited);
    let mut part = Part::new(&model, choices);
    for &member in members {
        part.set(&model, member, true);
    }
    part.fails(&mut effort).ok()?
}

/// Why no plan makes `choices`, where none does: reasons that rest on these choices and on any others, and on nothing
/// that `choices` leave out. Empty if that takes too long to find out, times do not fit, or there is a plan.
pub fn explain_choices(
    network: &Network,
    choices: &[Choice],
    termination: &mut dyn Termination,
) -> Vec<Reason> {
    let Ok(model) = Model::new(network, None) else { return Vec::new() };
    explain(network, &model, choices, termination).map_or_else(|_| Vec::new(), |failure| failure.reasons)
}

/// Explains why there is no plan that makes the choices given.
pub(crate) fn explain(
    network: &Network,
    model: &Model,
    given: &[Choice],
    termination: &mut dyn Termination,
) -> Result<Failure, Unplannable> {
    let mut effort = Effort::for_size(model.num_nodes, termination);
    if demanding::has_demands(model) {
        let reasons: Vec<Reason> = whole::reason(network, model, given, &mut effort).into_iter().collect();
        return Ok(Failure {
            is_complete: !reasons.is_empty(),
            reasons,
            relaxations: Vec::new(),
            is_of_gap: false,
        });
    }
    let assumed = (!given.is_empty()).then(|| assumed(model, given));
    let setup = Setup { jumps: true, records_failures: true, assumed, ..Setup::default() };
    let mut engine = Engine::new(model, setup);
    let mut enough = |stats: &Stats| effort.is_spent(stats) || stats.backtracks > MAX_REASONS;
    let is_complete = engine.run(&mut enough)? == Halt::Exhausted;
    let mut failures = engine.failures.found;
    failures.sort_by(|left, right| left.choices.cmp(&right.choices));
    let mut reasons: Vec<Reason> = Vec::new();
    for failure in &failures {
        let reason = reason(network, model, failure, &mut effort)?;
        if !reasons.iter().any(|known| known.choices == reason.choices && known.conflict == reason.conflict) {
            reasons.push(reason);
        }
    }
    if !is_complete && let Some(reason) = whole::reason(network, model, given, &mut effort) {
        reasons.insert(0, reason);
        return Ok(Failure { reasons, is_complete: true, relaxations: Vec::new(), is_of_gap: false });
    }
    Ok(Failure { reasons, is_complete, relaxations: Vec::new(), is_of_gap: false })
}

fn reason(
    network: &Network,
    model: &Model,
    failure: &RecordedFailure,
    effort: &mut Effort<'_>,
) -> Result<Reason, Unplannable> {
    let mut part = Part::new(model, &failure.choices);
    let mut members = failure.members.clone();
    for &member in &members {
        part.set(model, member, true);
    }
    let mut is_minimal = part.fails(effort)? == Some(true);
    if is_minimal {
        // The last members first: what comes late in the text is told only if it matters.
        for &member in failure.members.iter().rev() {
            part.set(model, member, false);
            match part.fails(effort)? {
                Some(true) => members.retain(|&kept| kept != member),
                Some(false) => part.set(model, member, true),
                None => {
                    part.set(model, member, true);
                    is_minimal = false;
                }
            }
        }
    }
    let cycle = if is_minimal { part.first_cycle(effort)? } else { failure.cycle.clone() };
    let choices = failure.choices.clone();
    let told =
        wording::Told { network, kind: failure.kind, choices: &choices, conflict: &members, cycle: &cycle };
    let message = told.message();
    let spans = spans(network, &members, &cycle);
    let kind = failure.kind;
    Ok(Reason { message, spans, choices, kind, conflict: members, cycle, is_minimal, failing_run: None })
}

/// The places of a conflict: its conditions, then the bounds that take time; without a cycle those that it needs, what
/// nature chooses last.
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

/// Choices of alternatives as a search takes them; those that the network has not are left out.
fn assumed(model: &Model, choices: &[Choice]) -> Choices {
    let mut alternatives: TiVec<DecisionId, Option<u32>> = vec![None; model.decisions.len()].into();
    for choice in choices {
        if let Some(taken) = alternatives.get_mut(choice.decision) {
            *taken = Some(choice.alternative);
        }
    }
    Choices { alternatives, ..Choices::default() }
}

/// The planning problem that has only some of the bounds and conditions of another.
pub(crate) struct Part {
    model: Model,
    active_labels: TiVec<LabelId, bool>,
    active_uses: Vec<bool>,
    assumed: TiVec<DecisionId, Option<u32>>,
    /// Whether durations that nature chooses are chosen like all others.
    pub(crate) ignores_nature: bool,
}

impl Part {
    pub(crate) fn new(whole: &Model, choices: &[Choice]) -> Self {
        let mut model = whole.clone();
        // Without their bounds, arcs may be over before they begin.
        (model.structure, model.nesting) = (None, None);
        for arc in &mut model.arcs {
            (arc.lower, arc.upper) = (UNBOUNDED_BELOW, INFINITE);
        }
        Self {
            active_labels: vec![false; model.conditions.labels.len()].into(),
            active_uses: vec![false; model.demands.num_uses()],
            assumed: assumed(whole, choices).alternatives,
            model,
            ignores_nature: false,
        }
    }

    pub(crate) fn set(&mut self, whole: &Model, member: Member, is_in: bool) {
        match member {
            Member::Condition(label) => self.active_labels[label] = is_in,
            Member::Use(used) => self.active_uses[used.index()] = is_in,
            Member::Bound(Constraint::Lower(arc)) => {
                self.model.arcs[arc].lower = if is_in { whole.arcs[arc].lower } else { UNBOUNDED_BELOW };
            }
            Member::Bound(Constraint::Upper(arc)) => {
                self.model.arcs[arc].upper = if is_in { whole.arcs[arc].upper } else { INFINITE };
            }
            Member::Bound(
                Constraint::Link(_)
                | Constraint::Order(_)
                | Constraint::UseOrder(_)
                | Constraint::Departure(_),
            ) => {}
        }
    }

    /// Leaves the alternative of a decision open, or gives it.
    pub(crate) fn assume(&mut self, decision: DecisionId, alternative: Option<u32>) {
        self.assumed[decision] = alternative;
    }

    /// Whether the part has no plan; `None` if that takes too long to find out.
    fn fails(&self, effort: &mut Effort<'_>) -> Result<Option<bool>, Unplannable> {
        if !effort.spend() {
            return Ok(None);
        }
        if !self.model.constraints.is_empty() {
            return Ok(self.is_refuted(effort));
        }
        let mut engine = Engine::new(&self.model, self.setup(false));
        let mut enough = |stats: &Stats| effort.is_spent(stats) || stats.backtracks > MAX_BACKTRACKS;
        match engine.run(&mut enough)? {
            Halt::Solution => return Ok(Some(false)),
            Halt::Exhausted => return Ok(Some(true)),
            Halt::Stopped => {}
        }
        if let Some(fails) = self.is_refuted(effort) {
            return Ok(Some(fails));
        }
        Ok(match engine.run(&mut |stats: &Stats| effort.is_spent(stats))? {
            Halt::Solution => Some(false),
            Halt::Exhausted => Some(true),
            Halt::Stopped => None,
        })
    }

    /// Whether the solver proves that the part has no plan, or finds one; `None` if that takes too long, or if gaps
    /// alone decide.
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
        };
        match effort.solve(&self.model, Gaps::Trusted, part)? {
            (Answer::Solved, _) => return Some(Refuted::No),
            (Answer::Unsolvable, core) if self.model.gap == 0 => return Some(Refuted::By(core)),
            _ => {}
        }
        let (answer, core) = effort.solve(&self.model, Gaps::Ignored, part)?;
        (answer == Answer::Unsolvable).then_some(Refuted::By(core))
    }

    /// A contradiction among the bounds of the part, if there is one to show.
    fn first_cycle(&self, effort: &mut Effort<'_>) -> Result<Vec<CycleMember>, Unplannable> {
        let mut engine = Engine::new(&self.model, self.setup(true));
        engine.run(&mut |stats: &Stats| effort.is_spent(stats))?;
        Ok(engine
            .failures
            .found
            .into_iter()
            .map(|failure| failure.cycle)
            .find(|cycle| !cycle.is_empty())
            .unwrap_or_default())
    }

    fn setup(&self, records_failures: bool) -> Setup {
        Setup {
            jumps: true,
            records_failures,
            active_labels: Some(self.active_labels.clone()),
            assumed: Some(Choices { alternatives: self.assumed.clone(), ..Choices::default() }),
            ..Setup::default()
        }
    }
}
