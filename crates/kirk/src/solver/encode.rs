//! A planning problem for the solver: what of it are variables, constraints and choice points, and what a solution means.

use std::collections::{BTreeMap, BTreeSet};

use tpn::{ArcId, CausalLink, Choice, DecisionId, LabelId, NodeId, Ordering, VariableId};
use typed_index_collections::{TiSlice, TiVec};

use super::alternatives::Way;
use super::dispatch::Dispatching;
use super::enclosure::Enclosures;
use super::growth::{Growth, LINK, Unencoded};
use super::instants::Instants;
use super::interval::{DueGap, Interval};
use super::lasting::Sides;
use super::literal::{Literal, Side, Variable};
use super::premise::Premise;
use super::resources::Shares;
use super::solution::Solution;
use super::touching::{Touches, Touching};
use super::{ChoicePoint, ChoicePointKind, Solver, interchangeable};
use crate::choices::Choices;
use crate::failure::Member;
use crate::model::UNBOUNDED_BELOW;
use crate::model::{Alternatives, Context, INFINITE, Model, ModelArc, node};
use crate::structure::Relation;
use crate::trace::{Constraint, TreeChoice};

/// What a search is asked for, beside the model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    /// The labels that count; all if `None`. Assertions that do not count still support.
    pub(crate) active_labels: Option<&'a TiSlice<LabelId, bool>>,
    /// The alternatives of decisions, where they are given.
    pub(crate) alternatives: Option<&'a Alternatives>,
    /// The uses of resources that count; all if `None`.
    pub(crate) active_uses: Option<&'a [bool]>,
    /// Whether durations that the environment chooses are chosen like all others.
    pub(crate) ignores_nature: bool,
    /// Whether it is to be known what a refutation rests on.
    pub(crate) wants_core: bool,
    /// Whether plans are listed that differ only in alternatives of which one is as good as the other.
    pub(crate) lists_all: bool,
    /// What is assumed of pairs that touch, where the mission has a gap.
    pub(crate) touching: Touching,
    /// The whole mission, if this is a part of one.
    pub(crate) mission: Option<&'a Model>,
}

impl Default for Part<'_> {
    fn default() -> Self {
        Self {
            active_labels: None,
            alternatives: None,
            active_uses: None,
            ignores_nature: false,
            wants_core: false,
            lists_all: false,
            touching: Touching::Unneeded,
            mission: None,
        }
    }
}

/// How a planning problem is told to the solver.
#[derive(Clone, Debug)]
pub(crate) struct Problem<'m> {
    pub(crate) model: &'m Model,
    pub(super) touches: Touches,
    pub(super) enclosures: Enclosures<'m>,
    /// By label: when it ends at the latest and starts at the earliest, by arcs alone.
    pub(super) windows: TiVec<LabelId, (i64, i64)>,
    pub(crate) intervals: TiVec<LabelId, Interval>,
    /// Labels that count, in textual order.
    pub(crate) labels_by_variable: TiVec<VariableId, Vec<LabelId>>,
    /// Pairs that are choice points, with the literals of both orders.
    pub(crate) orders: BTreeMap<(LabelId, LabelId), [Literal; 2]>,
    pub(crate) known_pairs: BTreeSet<(LabelId, LabelId)>,
    /// Whether the solver has been told which intervals of each variable exclude each other.
    pub(crate) has_exclusion: TiVec<VariableId, bool>,
    pub(super) times: TiVec<NodeId, Variable>,
    /// When what each label asserts begins to hold.
    pub(super) ready: TiVec<LabelId, Variable>,
    pub(super) sides: Sides,
    pub(super) shares: Shares,
    /// By state that is used much: what requires or changes it, of which no two overlap.
    pub(super) turns: Vec<Vec<Interval>>,
    pub(super) instants: Instants,
    /// Times of another plan, by node, in whose order conflicting pairs are tried first.
    pub(crate) preferred_times: Vec<i64>,
    /// While uses start in the order of time.
    pub(super) dispatching: Option<Dispatching>,
    /// By decision and alternative.
    pub(super) alternatives: TiVec<DecisionId, Vec<Literal>>,
    /// Requirements with the assertions that may carry them.
    pub(super) carriers: Vec<(LabelId, Vec<(LabelId, Literal)>)>,
    contexts: TiVec<NodeId, Context>,
    /// Whether solutions have to withstand what the environment chooses.
    pub(super) faces_nature: bool,
}

impl<'m> Problem<'m> {
    /// The problem and a solver that knows it, unless it is stopped before. The model's contexts must be known.
    pub(crate) fn new(
        model: &'m Model,
        part: Part<'m>,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<(Self, Solver), Unencoded> {
        let mut growth = Growth::new(stop);
        let mut reach = reach(model)?;
        if part.wants_core {
            // That nothing precedes the start has its reason.
            reach.0 = -reach.1;
        }
        let mut solver = Solver::new();
        if part.wants_core {
            solver.keep_derivations();
        }
        let rule = if model.gap == 0 { Touching::Always } else { part.touching };
        let touches = Touches::new(&mut solver, rule);
        let alternatives = add_alternatives(model, &mut solver);
        let mut problem = Self {
            model,
            touches,
            enclosures: Enclosures::new(part.mission.unwrap_or(model)),
            windows: TiVec::new(),
            intervals: TiVec::new(),
            labels_by_variable: vec![Vec::new(); model.conditions.variables.len()].into(),
            orders: BTreeMap::new(),
            known_pairs: BTreeSet::new(),
            has_exclusion: vec![false; model.conditions.variables.len()].into(),
            times: TiVec::new(),
            ready: TiVec::new(),
            sides: Sides::default(),
            shares: Shares::default(),
            turns: Vec::new(),
            instants: Instants::new(model),
            preferred_times: Vec::new(),
            dispatching: None,
            alternatives,
            carriers: Vec::new(),
            contexts: node_contexts(model),
            faces_nature: model.has_uncertainty && !part.ignores_nature,
        };
        problem.add_times(&mut solver, reach);
        solver.resize();
        problem.begin_touching(&mut solver);
        problem.add_choices(&mut solver, part);
        problem.add_arcs(&mut solver);
        problem.add_intervals(&mut solver, part);
        problem.sweep(&mut solver);
        solver.propagate_at_root(growth.stop)?;
        if !solver.is_contradictory {
            problem.keep_windows(&solver);
            problem.add_links(&mut solver, part, &mut growth)?;
            problem.add_lasting(&mut solver, part, &mut growth)?;
            problem.add_resources(&mut solver, part);
            problem.limit_work(&mut solver, part);
            if problem.faces_nature {
                // What the least times keep apart the environment's times may not.
                problem.order_all_pairs(&mut solver, &mut growth)?;
            }
        }
        Ok((problem, solver))
    }

    /// Returns what the solver's solution chooses, with the least time of each node.
    pub(crate) fn solution(&self, solver: &Solver) -> Choices {
        let chosen = |options: &Vec<Literal>| {
            let taken = options.iter().position(|&option| solver.trail.holds(option));
            taken.map(|taken| taken as u32)
        };
        let mut carriers: TiVec<LabelId, Option<LabelId>> =
            vec![None; self.model.conditions.labels.len()].into();
        for (ask, options) in &self.carriers {
            if solver.trail.holds(self.intervals[*ask].presence)
                && let Some((tell, _)) = options.iter().find(|(_, option)| solver.trail.holds(*option))
            {
                carriers[*ask] = Some(*tell);
            }
        }
        let times = self.times.iter().map(|&time| solver.trail.least(time)).collect();
        Choices { alternatives: self.alternatives.iter().map(chosen).collect(), carriers, times }
    }

    /// All that the solver's solution says.
    pub(crate) fn complete_solution(&self, solver: &Solver) -> Solution {
        let Choices { alternatives, carriers, times } = self.solution(solver);
        let orders = self.orders.iter().flat_map(|((left, right), [left_first, right_first])| {
            [((*left, *right), *left_first), ((*right, *left), *right_first)]
        });
        Solution {
            alternatives,
            carriers,
            kept: self.kept(solver),
            orders: orders.filter(|&(_, order)| solver.trail.holds(order)).map(|(pair, _)| pair).collect(),
            uses_ordered: self.uses_ordered(solver),
            times: times.into(),
        }
    }

    /// Returns what the literals of choices say in a record. A literal may say several things at once.
    pub(super) fn names(&self) -> Vec<(Literal, TreeChoice)> {
        let mut names = Vec::new();
        for (decision, options) in self.alternatives.iter_enumerated() {
            for (alternative, &option) in (0..).zip(options) {
                names.push((option, TreeChoice::Decision { decision, alternative }));
            }
        }
        for (ask, options) in &self.carriers {
            let link = |tell| TreeChoice::Link(CausalLink { ask: *ask, tell });
            names.extend(options.iter().map(|&(tell, literal)| (literal, link(tell))));
        }
        names.extend(self.names_of_kept());
        for (&(left, right), &[left_first, right_first]) in &self.orders {
            names.push((left_first, TreeChoice::Order(Ordering { first: left, then: right })));
            names.push((right_first, TreeChoice::Order(Ordering { first: right, then: left })));
        }
        names.extend(self.touches.names());
        names.extend(self.shares.names());
        names
    }

    /// Makes all conflicting pairs choice points.
    pub(crate) fn order_all_pairs(
        &mut self,
        solver: &mut Solver,
        growth: &mut Growth<'_>,
    ) -> Result<(), Unencoded> {
        if solver.is_contradictory { Ok(()) } else { solver.add_all_pairs(self, growth) }
    }

    /// Forbids the present solution, and all that differ from it only in the orders of resource uses.
    pub(crate) fn forbid(&self, solver: &mut Solver) {
        let mut literals = self.kept_literals(solver);
        let own = self.alternatives.iter().flatten().chain(self.orders.values().flatten()).copied();
        let links = self.carriers.iter().flat_map(|(_, options)| options.iter().map(|&(_, link)| link));
        literals.extend(own.chain(links).filter(|&literal| solver.trail.holds(literal)));
        solver.retract(0);
        solver.at_least_one(literals.into_iter().map(|literal| !literal));
    }

    /// Forbids all plans that make these choices.
    pub(crate) fn forbid_choices(&self, solver: &mut Solver, choices: &[Choice]) {
        let literals = choices.iter().map(|choice| !self.presence(Some(*choice)));
        solver.at_least_one(literals);
    }

    /// Returns what must lie between two labeled intervals that exclude each other, unless they may touch.
    pub(crate) fn gap_between(&self, _first: LabelId, then: LabelId) -> i64 {
        self.model.gap_before(then, self.model.gap)
    }

    /// Returns what counts as ordered where it follows from the rest.
    pub(crate) fn gap_after(&self, label: LabelId) -> i64 {
        self.model.gap_after[label]
    }

    /// Returns whether two labels conflict and neither nesting nor a choice point orders them yet.
    pub(crate) fn must_be_ordered(&self, pair: (LabelId, LabelId)) -> bool {
        let (left, right) = pair;
        self.model.conditions.conflict(left, right)
            && !self.known_pairs.contains(&pair)
            && !self.is_nested(left, right)
    }

    /// Whether two labels never overlap, and then the gap that is due between them.
    pub(crate) fn exclusion(&mut self, left: LabelId, right: LabelId) -> Option<DueGap> {
        let arc = |label: LabelId| self.model.conditions.labels[label].arc;
        let structure = self.model.structure.as_ref();
        if structure.is_some_and(|structure| structure.relation(arc(left), arc(right)) != Relation::Open) {
            return Some(DueGap::Never);
        }
        if !self.model.conditions.conflict(left, right) || arc(left) == arc(right) {
            return None;
        }
        let is_due = self.gap_between(left, right).min(self.gap_between(right, left)) > 0
            && !self.is_ordered_by_windows((left, right));
        Some(match (is_due, is_due && self.enclosures.never_orders((left, right))) {
            (false, _) => DueGap::Never,
            (true, false) => DueGap::Assumed,
            (true, true) => DueGap::Always,
        })
    }

    /// The order of a pair to try first, where another plan has one.
    pub(super) fn preferred_order(&self, left: LabelId, right: LabelId) -> Option<u32> {
        let room = |first: LabelId, then: LabelId| {
            let (end, start) = (self.model.interval(first).1, self.model.interval(then).0);
            Some(self.preferred_times.get(start.index())? - self.preferred_times.get(end.index())?)
        };
        Some(u32::from(room(right, left)? > room(left, right)?))
    }

    fn keep_windows(&mut self, solver: &Solver) {
        let windows = self
            .intervals
            .iter()
            .map(|interval| (solver.trail.most(interval.end), solver.trail.least(interval.start)));
        self.windows = windows.collect();
    }

    /// Returns whether arcs alone put one before the other whatever is chosen, touching where that counts.
    pub(super) fn is_ordered_by_windows(&self, (left, right): (LabelId, LabelId)) -> bool {
        let before = |first: LabelId, then: LabelId| {
            self.windows[first].0 + self.gap_after(first) <= self.windows[then].1
        };
        before(left, right) || before(right, left)
    }

    fn is_nested(&self, left: LabelId, right: LabelId) -> bool {
        let Some(structure) = &self.model.structure else { return false };
        let arc = |label: LabelId| self.model.conditions.labels[label].arc;
        match structure.relation(arc(left), arc(right)) {
            Relation::Before => self.gap_after(left) == 0,
            Relation::After => self.gap_after(right) == 0,
            Relation::Open => false,
        }
    }

    /// Returns what makes something exist.
    pub(super) fn presence(&self, context: Context) -> Literal {
        context
            .map_or(Literal::TRUE, |choice| self.alternatives[choice.decision][choice.alternative as usize])
    }

    fn add_times(&mut self, solver: &mut Solver, (least, most): (i64, i64)) {
        let model = self.model;
        let mut variables: TiVec<NodeId, Option<Variable>> = vec![None; model.num_nodes].into();
        for &point in &model.order {
            let representative = model.representatives[node(point)];
            if variables[representative].is_none() {
                let presence = self.presence(self.contexts[representative]);
                let is_start = representative == model.representatives[model.start];
                let (least, most) = if is_start { (0, 0) } else { (least, most) };
                variables[representative] = Some(solver.variable(least, most, presence));
            }
        }
        self.times = model
            .representatives
            .iter()
            .map(|&representative| variables[representative].unwrap_or(Variable(0)))
            .collect();
    }

    fn add_choices(&mut self, solver: &mut Solver, part: Part<'_>) {
        for (decision, options) in self.model.decisions.iter().zip(&self.alternatives) {
            let when = self.presence(decision.context);
            let id = solver.choice_points.next_key();
            for &option in options {
                solver.exclusive[option.side.variable()] = Some(id);
                solver.imply(option, when);
            }
            solver.at_least_one(options.iter().copied().chain([!when]));
            let choice_point = ChoicePoint {
                when: vec![when],
                kind: ChoicePointKind::Alternatives,
                options: options.clone(),
                last: None,
            };
            solver.add_choice_point(choice_point, 0.0);
        }
        let Some(given) = part.alternatives else {
            if part.lists_all || self.model.tells_plans_apart() {
                return;
            }
            for decision in self.model.decisions.keys() {
                for alternative in interchangeable::repeated(self.model, decision) {
                    solver.assert(!self.alternatives[decision][alternative as usize]);
                }
            }
            return;
        };
        for (options, &given) in self.alternatives.iter().zip(given) {
            for (alternative, &option) in (0..).zip(options) {
                if given.is_some_and(|given| given != alternative) {
                    solver.assert(!option);
                }
            }
        }
    }

    fn add_arcs(&mut self, solver: &mut Solver) {
        let model = self.model;
        // By common event: how each alternative bounds it.
        let mut ways: BTreeMap<(Side, DecisionId), Vec<(u32, Way)>> = BTreeMap::new();
        for &constraint in &model.constraints {
            self.add_constraint(solver, constraint);
        }
        for (id, arc) in model.arcs.iter_enumerated() {
            if model.is_constraint(id) {
                continue;
            }
            let (from, to) = (self.times[arc.from], self.times[arc.to]);
            if from == to {
                if arc.lower > 0 {
                    solver.tell_from([Member::Bound(Constraint::Lower(id))]);
                    solver.assert(!self.presence(arc.context));
                }
                continue;
            }
            let taken = self.presence(arc.context);
            let when = |node: NodeId| if self.contexts[node] == arc.context { Literal::TRUE } else { taken };
            let (when_from, when_to) = (when(arc.from), when(arc.to));
            let mut bounds =
                |bound: Constraint, (from, to): (Variable, Variable), weight: i64, when: [Literal; 2]| {
                    let premise = Premise::Member(Member::Bound(bound));
                    solver.tell_from_premises([premise]);
                    solver.difference(from, to, weight, when);
                    let sides = [(from.upper(), to.upper()), (to.lower(), from.lower())];
                    for ((from, to), when) in sides.into_iter().zip(when) {
                        if let Some(choice) = arc.context.filter(|_| when != Literal::TRUE) {
                            let ways = ways.entry((to, choice.decision)).or_default();
                            ways.push((choice.alternative, Way { from, weight, when, premise }));
                        }
                    }
                };
            if arc.upper != INFINITE {
                bounds(Constraint::Upper(id), (from, to), arc.upper, [when_to, when_from]);
            }
            if arc.lower != UNBOUNDED_BELOW {
                bounds(Constraint::Lower(id), (to, from), -arc.lower, [when_from, when_to]);
            }
        }
        for ((to, decision), mut ways) in ways {
            ways.sort_by_key(|&(alternative, _)| alternative);
            ways.dedup_by_key(|(alternative, _)| *alternative);
            if ways.len() == self.alternatives[decision].len() {
                let ways = ways.into_iter().map(|(_, way)| way).collect();
                solver.alternatives.add(to, ways);
            }
        }
        let Some(structure) = &model.structure else { return };
        solver.tell_from_premises([Premise::Unknown]);
        for decision in model.decisions.keys() {
            let (from, to, lower, upper) = structure.initial_bounds(decision);
            let (from, to) = (self.times[from], self.times[to]);
            if lower > upper || from == to {
                continue;
            }
            if upper != INFINITE {
                solver.difference(from, to, upper, [Literal::TRUE; 2]);
            }
            solver.difference(to, from, -lower, [Literal::TRUE; 2]);
        }
    }

    /// A bound between threads: each of its events is bounded by the other one where that exists.
    fn add_constraint(&self, solver: &mut Solver, id: ArcId) {
        let model = self.model;
        let arc = &model.arcs[id];
        if !model.are_compatible(arc.context, arc.other_context) {
            return;
        }
        let (from, to) = (self.times[arc.from], self.times[arc.to]);
        let (when_from, when_to) = (self.presence(arc.context), self.presence(arc.other_context));
        if from == to {
            let broken = [(arc.lower > 0, Constraint::Lower(id)), (arc.upper < 0, Constraint::Upper(id))];
            for (_, bound) in broken.into_iter().filter(|&(is_broken, _)| is_broken) {
                solver.tell_from([Member::Bound(bound)]);
                solver.at_least_one([!when_from, !when_to]);
            }
            return;
        }
        let to_has_from = model.is_within(arc.other_context, arc.context);
        let from_has_to = model.is_within(arc.context, arc.other_context);
        let both = match (to_has_from, from_has_to) {
            (true, _) => when_to,
            (_, true) => when_from,
            (false, false) => {
                let both = solver.boolean();
                solver.resize();
                solver.tell_structure();
                solver.imply(both, when_from);
                solver.imply(both, when_to);
                solver.at_least_one([!when_from, !when_to, both]);
                both
            }
        };
        let of_to = if to_has_from { Literal::TRUE } else { both };
        let of_from = if from_has_to { Literal::TRUE } else { both };
        if arc.upper != INFINITE {
            solver.tell_from([Member::Bound(Constraint::Upper(id))]);
            solver.difference(from, to, arc.upper, [of_to, of_from]);
        }
        if arc.lower != UNBOUNDED_BELOW {
            solver.tell_from([Member::Bound(Constraint::Lower(id))]);
            solver.difference(to, from, -arc.lower, [of_from, of_to]);
        }
    }

    /// Returns whether an arc is selected in the present solution.
    pub(super) fn is_present(&self, solver: &Solver, arc: &ModelArc) -> bool {
        let holds = |context| solver.trail.holds(self.presence(context));
        holds(arc.context) && holds(arc.other_context)
    }

    fn add_intervals(&mut self, solver: &mut Solver, part: Part<'_>) {
        let conditions = &self.model.conditions;
        let is_active = |label: LabelId| part.active_labels.is_none_or(|active| active[label]);
        for (id, label) in conditions.labels.iter_enumerated() {
            let arc = &self.model.arcs[label.arc];
            let (start, end) = (self.times[arc.from], self.times[arc.to]);
            self.intervals.push(Interval {
                start,
                end: if label.is_at_start { start } else { end },
                presence: self.presence(arc.context),
                duration: if label.is_at_start { 0 } else { arc.lower.max(0) },
            });
            self.ready.push(if label.is_changing { end } else { start });
            if is_active(id) && !label.is_lasting {
                self.labels_by_variable[label.variable].push(id);
            }
        }
        for &(left, right) in &conditions.self_conflicting {
            if is_active(left) && is_active(right) {
                solver.tell_from([left, right].map(Member::Condition));
                solver.assert(!self.intervals[left].presence);
            }
        }
    }

    /// Carries bounds on along the arcs until none moves any more.
    fn sweep(&self, solver: &mut Solver) {
        solver.tell_structure();
        let mut is_there: TiVec<Variable, bool> = vec![false; solver.trail.num_variables()].into();
        let mut points: Vec<Variable> =
            self.model.order.iter().map(|point| self.times[node(*point)]).collect();
        // Events that are always at one time have one variable.
        points.retain(|&point| !std::mem::replace(&mut is_there[point], true));
        solver.sweeps.set_points(points, solver.trail.num_variables());
        let Solver { sweeps, differences, trail, .. } = &mut *solver;
        if let Err(conflict) = sweeps.sweep_all(differences, trail) {
            solver.refute(&conflict);
        }
    }

    fn add_links(
        &mut self,
        solver: &mut Solver,
        part: Part<'_>,
        growth: &mut Growth<'_>,
    ) -> Result<(), Unencoded> {
        let conditions = &self.model.conditions;
        for ask in conditions.labels.keys() {
            let is_active = part.active_labels.is_none_or(|active| active[ask]);
            let asked = self.intervals[ask];
            if !conditions.labels[ask].is_ask || !is_active || solver.trail.fails(asked.presence) {
                continue;
            }
            solver.tell_from([Member::Condition(ask)]);
            let arc_of = |label: LabelId| conditions.labels[label].arc;
            // It always serves, where plans need not be told apart.
            let tells_apart = part.lists_all || self.model.tells_plans_apart();
            let own = conditions.supporters(ask).find(|&tell| arc_of(tell) == arc_of(ask));
            if let Some(own) = own.filter(|_| !tells_apart) {
                self.carriers.push((ask, vec![(own, asked.presence)]));
                continue;
            }
            let tells: Vec<LabelId> =
                conditions.supporters(ask).filter(|&tell| self.can_carry(solver, ask, tell)).collect();
            growth.add(LINK * tells.len())?;
            let mut options = Vec::with_capacity(tells.len());
            let is_only = tells.len() == 1;
            for tell in tells {
                let link = if is_only { asked.presence } else { solver.boolean() };
                options.push((tell, link));
            }
            solver.resize();
            let first = solver.differences.len();
            for &(tell, link) in &options {
                let teller = self.intervals[tell];
                solver.imply(link, teller.presence);
                solver.imply(link, asked.presence);
                solver.difference(asked.start, teller.start, 0, [link; 2]);
                solver.difference(teller.end, asked.end, 0, [link; 2]);
            }
            let literals: Vec<Literal> = options.iter().map(|&(_, link)| link).collect();
            solver.check_differences(first);
            if !is_only {
                solver.at_least_one(literals.iter().copied().chain([!asked.presence]));
                solver.add_exclusive_choice_point(ChoicePoint {
                    when: vec![asked.presence],
                    kind: ChoicePointKind::Carriers { ask },
                    options: literals,
                    last: None,
                });
            }
            self.carriers.push((ask, options));
            if solver.is_contradictory {
                break;
            }
        }
        self.share_carriers(solver, growth)
    }

    /// Requirements whose intervals exclude each other rest on different assertions where none lasts long enough for two.
    fn share_carriers(&self, solver: &mut Solver, growth: &mut Growth<'_>) -> Result<(), Unencoded> {
        let mut links: BTreeMap<LabelId, Vec<(LabelId, Literal)>> = BTreeMap::new();
        for (ask, options) in &self.carriers {
            for &(tell, link) in options {
                links.entry(tell).or_default().push((*ask, link));
            }
        }
        // Many assertions may have the same requirements and bounds.
        let mut known: BTreeMap<(Vec<LabelId>, i64), Vec<Vec<usize>>> = BTreeMap::new();
        for (tell, links) in links {
            if links.len() < 2 || links.len() > MAX_SHARING || solver.takes_nothing_for_granted() {
                continue;
            }
            let upper = self.model.arcs[self.model.conditions.labels[tell].arc].upper;
            let asks: Vec<LabelId> = links.iter().map(|&(ask, _)| ask).collect();
            growth.look_at(asks.len())?;
            let sets =
                known.entry((asks.clone(), upper)).or_insert_with(|| self.exclusive_sets(&asks, upper));
            for set in sets.iter() {
                solver.add_at_most_one(set.iter().map(|&at| links[at].1).collect());
            }
        }
        Ok(())
    }

    /// Sets of requirements no two of which fit into a time, each with as many members as are found one after the other.
    fn exclusive_sets(&self, asks: &[LabelId], time: i64) -> Vec<Vec<usize>> {
        let excludes = |one: LabelId, other: LabelId| {
            let arc = |label: LabelId| self.model.conditions.labels[label].arc;
            let labels = |label: LabelId| self.model.conditions.labels_of(arc(label));
            self.intervals[one].duration + self.intervals[other].duration > time
                && labels(one).iter().any(|&left| {
                    labels(other).iter().any(|&right| self.model.conditions.conflict(left, right))
                })
        };
        let mut sets: Vec<Vec<usize>> = Vec::new();
        let mut is_covered = vec![false; asks.len()];
        for first in 0..asks.len() {
            if is_covered[first] {
                continue;
            }
            let mut set = vec![first];
            for other in first + 1..asks.len() {
                if set.iter().all(|&member| excludes(asks[member], asks[other])) {
                    set.push(other);
                    is_covered[other] = true;
                }
            }
            if set.len() > 1 {
                sets.push(set);
            }
        }
        sets
    }

    /// Returns whether an assertion could carry a requirement, by their alternatives, durations and windows.
    fn can_carry(&self, solver: &Solver, ask: LabelId, tell: LabelId) -> bool {
        let (asked, teller) = (self.intervals[ask], self.intervals[tell]);
        let arc = |label: LabelId| &self.model.arcs[self.model.conditions.labels[label].arc];
        if solver.takes_nothing_for_granted() {
            return self.can_be_together(ask, tell);
        }
        !solver.trail.fails(teller.presence)
            && self.can_be_together(ask, tell)
            && asked.duration <= arc(tell).upper
            && solver.trail.least(teller.start) <= solver.trail.most(asked.start)
            && solver.trail.least(asked.end) <= solver.trail.most(teller.end)
    }

    /// Returns whether two labels can be in one plan.
    pub(super) fn can_be_together(&self, left: LabelId, right: LabelId) -> bool {
        self.model.can_be_together(left, right)
    }
}

/// Of more requirements that one assertion may carry it is not looked at which exclude each other.
const MAX_SHARING: usize = 1_000;

/// Between which times everything fits: more than all bounds together.
fn reach(model: &Model) -> Result<(i64, i64), Unencoded> {
    let mut total = i128::from(model.gap) * (model.conditions.labels.len() as i128 + 1) + 1;
    let mut can_precede_start = false;
    for (id, arc) in model.arcs.iter_enumerated() {
        can_precede_start |= arc.lower < 0 && !model.is_constraint(id);
        if arc.lower != UNBOUNDED_BELOW {
            total += i128::from(arc.lower).abs();
        }
        if arc.upper != INFINITE {
            total += i128::from(arc.upper).abs();
        }
    }
    let most = i64::try_from(total).map_err(|_| Unencoded::TimesTooLarge)?;
    if most > 1 << 60 {
        return Err(Unencoded::TimesTooLarge);
    }
    Ok((if can_precede_start { -most } else { 0 }, most))
}

fn add_alternatives(model: &Model, solver: &mut Solver) -> TiVec<DecisionId, Vec<Literal>> {
    let alternatives = model
        .decisions
        .iter()
        .map(|decision| decision.alternatives.iter().map(|_| solver.boolean()).collect())
        .collect();
    solver.resize();
    alternatives
}

fn node_contexts(model: &Model) -> TiVec<NodeId, Context> {
    let context_of = |(node, decision): (NodeId, &Option<DecisionId>)| match *decision {
        Some(decision) => model.decisions[decision].context,
        None => model.out_arcs(node).first().and_then(|&arc| model.arcs[arc].context),
    };
    model.decision_of.iter_enumerated().map(context_of).collect()
}
