//! Parts of a program that do nothing in any run: what is never active, and what waits for what never comes (SPEC 9.3).
//!
//! More runs are looked at than there are: what the program may know is taken apart from where it is. So nothing is said of
//! a part that does something in some run, but not all that do nothing are found.

use std::collections::{BTreeSet, HashSet};
use std::ops::Range;
use std::sync::Arc;

use hca::{
    Automaton, Composite, CompositeKind, Element, LocationId, LocationKind, Standing, StepObserver, Stepper,
    TestId, TransitionId, locks,
};
use plant::{Commands, ComponentId, Formula, Observation, Situation, State, targets};
use rmpl::control::ConstraintKind;
use rmpl::{Diagnostic, Span, diagnostics};

use crate::model_based::closed_loop::{ProgramExecution, command};
use crate::model_based::estimator::Estimator;
use crate::model_based::system::System;

/// Of programs that come to more standings nothing is said.
const MAX_STANDINGS: usize = 20_000;
/// So is of plants that come to more states.
const MAX_STATES: usize = 2000;
/// So is of a step of the plant with more outcomes.
const MAX_OUTCOMES: usize = 64;
/// So is of a step of the program that depends on more conditions whose answers are free.
const MAX_FREE: usize = 6;

/// Warnings of the parts of a program that do nothing in any run with its plant, whatever fails. `None` if `go_on` returned
/// false, or there is more to look at than is followed.
pub fn idle_parts(system: &Arc<System>, go_on: &mut dyn FnMut() -> bool) -> Option<Vec<Diagnostic>> {
    let mut exploration = Exploration::new(&system.automaton);
    let mut plant = PlantSide::new(system)?;
    let mut known = (0, 0);
    while known != (exploration.standings.len(), plant.states.len()) {
        known = (exploration.standings.len(), plant.states.len());
        let mut number = 0;
        while let Some(standing) = exploration.standings.get(number).cloned() {
            for answers in plant.answers(&standing, go_on)? {
                if exploration.asked.insert((number, answers.clone())) {
                    let is_entailed =
                        |test: TestId| answers.iter().any(|(asked, answer)| *asked == test && *answer);
                    exploration.step(&standing, &is_entailed)?;
                }
            }
            number += 1;
        }
        plant.follow(go_on)?;
    }
    Some(Found::new(&system.automaton, &exploration.seen).warnings())
}

/// The same of a program without a plant, where anything may be known in any step.
pub fn idle_parts_alone(
    automaton: &Arc<Automaton>,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<Diagnostic>> {
    let mut exploration = Exploration::new(automaton);
    let mut number = 0;
    while let Some(standing) = exploration.standings.get(number).cloned() {
        exploration.stepper.return_to(&standing);
        let condition = |test: TestId| automaton.guard(test).map(|guard| &guard.constraint);
        // A condition is asked for with a bar and without.
        let mut asked: Vec<String> = Vec::new();
        for constraint in exploration.stepper.asked().into_iter().filter_map(condition) {
            let is_open = !matches!(constraint.kind, ConstraintKind::True | ConstraintKind::False);
            let text = constraint.to_string();
            if is_open && !asked.contains(&text) {
                asked.push(text);
            }
        }
        if asked.len() > MAX_FREE {
            return None;
        }
        for answers in 0..1_u32 << asked.len() {
            if !go_on() {
                return None;
            }
            let is_entailed = |test: TestId| {
                let Some(constraint) = condition(test) else { return false };
                let text = constraint.to_string();
                let place = asked.iter().position(|known| *known == text);
                place.map_or(constraint.kind == ConstraintKind::True, |at| answers >> at & 1 == 1)
            };
            exploration.step(&standing, &is_entailed)?;
        }
        number += 1;
    }
    Some(Found::new(automaton, &exploration.seen).warnings())
}

/// What is active and what is taken in some run.
#[derive(Default)]
struct Seen {
    reached: BTreeSet<LocationId>,
    fired: BTreeSet<TransitionId>,
    /// What stays active from each step in which it is.
    never_left: BTreeSet<LocationId>,
}

impl StepObserver for Seen {
    fn fired(&mut self, transition: TransitionId) {
        self.fired.insert(transition);
    }
}

/// Answers to the conditions that a step asks for.
type Answers = Vec<(TestId, bool)>;

/// Everywhere that a program may stand.
struct Exploration {
    stepper: Stepper,
    seen: Seen,
    standings: Vec<Standing>,
    known: HashSet<Standing>,
    /// Which steps were taken, by the number of the standing and the answers.
    asked: HashSet<(usize, Answers)>,
}

impl Exploration {
    fn new(automaton: &Arc<Automaton>) -> Self {
        let mut exploration = Self {
            stepper: Stepper::undecided(automaton),
            seen: Seen::default(),
            standings: Vec::new(),
            known: HashSet::new(),
            asked: HashSet::new(),
        };
        exploration.settle(None);
        exploration
    }

    /// Takes a step. `None` if the program can continue in too many ways.
    fn step(&mut self, standing: &Standing, is_entailed: &dyn Fn(TestId) -> bool) -> Option<()> {
        self.stepper.return_to(standing);
        if !self.stepper.is_done() {
            self.stepper.step_told(is_entailed, &mut self.seen);
            locks::grant(&mut [&mut self.stepper]);
            self.settle(Some(standing));
        }
        (self.standings.len() <= MAX_STANDINGS).then_some(())
    }

    /// Notes where the program is after each combination of its open choices, coming from another standing.
    fn settle(&mut self, before: Option<&Standing>) {
        if let Some(choice) = self.stepper.open_choice() {
            let children =
                self.stepper.automaton().composite(choice.composite).map_or(0, |data| data.children.len());
            let standing = self.stepper.standing();
            for alternative in 0..children {
                self.stepper.return_to(&standing);
                self.stepper.choose(alternative);
                self.settle(before);
            }
            return;
        }
        locks::set_aside(&mut [&mut self.stepper]);
        let standing = self.stepper.standing().relative(self.stepper.automaton());
        if let Some(before) = before {
            let next = standing.marking();
            self.seen.never_left.retain(|id| !before.marking().contains(*id) || next.contains(*id));
        }
        if self.known.insert(standing.clone()) {
            for id in standing.marking().iter() {
                if self.seen.reached.insert(id) {
                    self.seen.never_left.insert(id);
                }
            }
            self.standings.push(standing);
        }
    }
}

/// Every state that the plant may be in, and everything that may be commanded.
struct PlantSide<'program> {
    system: &'program Arc<System>,
    estimator: Estimator,
    program: ProgramExecution,
    /// The components that the program has to do with.
    components: BTreeSet<ComponentId>,
    states: Vec<State>,
    known: HashSet<State>,
    commands: Vec<Commands>,
    /// For each of the commands, from how many of the states they were followed.
    followed: Vec<usize>,
}

impl<'program> PlantSide<'program> {
    fn new(system: &'program Arc<System>) -> Option<Self> {
        let mut estimator = Estimator::new(system, None);
        let belief = estimator.initial().belief;
        let groups: Vec<usize> = system.groups_used().into_iter().collect();
        let shares = belief.shares_of(&groups, MAX_STATES + 1);
        let states: Vec<State> = shares.into_iter().map(|(state, _)| state).collect();
        let of = groups.iter().filter_map(|at| system.groups.get(*at));
        let plant = Self {
            system,
            estimator,
            program: ProgramExecution::new(system),
            components: of.flat_map(|group| group.components.iter()).copied().collect(),
            known: states.iter().cloned().collect(),
            states,
            commands: Vec::new(),
            followed: Vec::new(),
        };
        (belief.is_exact() && plant.states.len() <= MAX_STATES).then_some(plant)
    }

    /// The answers that some state may give to what the program asks for, and notes what it commands.
    fn answers(&mut self, standing: &Standing, go_on: &mut dyn FnMut() -> bool) -> Option<BTreeSet<Answers>> {
        self.program.stepper.return_to(standing);
        let asked = self.program.asked();
        let model = &self.system.model;
        let opposites: Vec<Formula> =
            asked.iter().map(|(_, condition)| model.opposite(condition.clone())).collect();
        let mut all = BTreeSet::new();
        let mut possible = vec![(false, false); asked.len()];
        for state in &self.states {
            if !go_on() {
                return None;
            }
            let (next, _) = command(&[&mut self.program], &mut self.estimator, state);
            if !self.commands.contains(&next.commands) {
                self.commands.push(next.commands);
                self.followed.push(0);
            }
            let mut situation = Situation::new(model, state, &Observation::default());
            let mut each: Vec<(bool, bool)> = Vec::with_capacity(asked.len());
            for ((_, condition), opposite) in asked.iter().zip(&opposites) {
                // What modes leave open may be observed to be either.
                each.push((!situation.entails(opposite), !situation.entails(condition)));
            }
            for (possible, each) in possible.iter_mut().zip(&each) {
                *possible = (possible.0 | each.0, possible.1 | each.1);
            }
            if self.system.entailment.is_none() {
                all.extend(combinations(&asked, &each)?);
            }
        }
        // Conditions that are known from a probability on need not hold in one state.
        if self.system.entailment.is_some() {
            all.extend(combinations(&asked, &possible)?);
        }
        Some(all)
    }

    /// Adds the states that the commands lead to.
    fn follow(&mut self, go_on: &mut dyn FnMut() -> bool) -> Option<()> {
        for (commands, followed) in self.commands.iter().zip(&mut self.followed) {
            while let Some(state) = self.states.get(*followed).cloned() {
                *followed += 1;
                let mut next = vec![state.clone()];
                for id in &self.components {
                    // A step that fails leads nowhere.
                    let targets = targets(&self.system.model, *id, &state, commands).unwrap_or_default();
                    let entered = |state: &State| {
                        let state = state.clone();
                        targets.iter().map(move |target| {
                            let mut state = state.clone();
                            state.set_mode(*id, target.mode);
                            state
                        })
                    };
                    next = next.iter().flat_map(entered).collect();
                    if next.len() > MAX_OUTCOMES {
                        return None;
                    }
                }
                for state in next {
                    if self.known.insert(state.clone()) {
                        self.states.push(state);
                    }
                }
                if !go_on() || self.states.len() > MAX_STATES {
                    return None;
                }
            }
        }
        Some(())
    }
}

/// All answers where each condition may be entailed, or not, or both; `None` if there are too many.
fn combinations(asked: &[(TestId, Formula)], possible: &[(bool, bool)]) -> Option<Vec<Answers>> {
    if possible.iter().filter(|(yes, no)| *yes && *no).count() > MAX_FREE {
        return None;
    }
    let mut all: Vec<Answers> = vec![Vec::with_capacity(asked.len())];
    for ((test, _), (yes, no)) in asked.iter().zip(possible) {
        let answers = [(*yes, true), (*no, false)];
        let answers: Vec<bool> =
            answers.into_iter().filter(|(can, _)| *can).map(|(_, answer)| answer).collect();
        let with = |before: &Answers| {
            let before = before.clone();
            answers.iter().map(move |answer| before.iter().copied().chain([(*test, *answer)]).collect())
        };
        all = all.iter().flat_map(with).collect();
    }
    Some(all)
}

struct Found<'program> {
    automaton: &'program Automaton,
    seen: &'program Seen,
    /// The locations that are active in some run, and in none are left.
    stuck: BTreeSet<LocationId>,
}

impl<'program> Found<'program> {
    fn new(automaton: &'program Automaton, seen: &'program Seen) -> Self {
        let mut found = Self { automaton, seen, stuck: BTreeSet::new() };
        found.stuck = seen.never_left.iter().copied().filter(|id| found.waits_once(*id)).collect();
        found
    }

    /// Returns whether a location is to be left some time: it waits for something, and nothing around it starts it
    /// again and again.
    fn waits_once(&self, id: LocationId) -> bool {
        let Some(location) = self.automaton.location(id) else { return false };
        let waits = matches!(location.kind, LocationKind::Assert | LocationKind::When | LocationKind::Lock);
        let mut around = Some(location.parent);
        while let Some(composite) = around.and_then(|id| self.automaton.composite(id)) {
            let first = self.automaton.location(LocationId(composite.locations.start));
            let repeats = composite.kind == CompositeKind::Guarded
                && first.is_some_and(|own| {
                    matches!(own.kind, LocationKind::Always | LocationKind::Whenever | LocationKind::Every)
                });
            if repeats {
                return false;
            }
            around = composite.parent;
        }
        waits
    }

    fn warnings(&self) -> Vec<Diagnostic> {
        let never = |location: &hca::Location| diagnostics::liveness::never(&location.label, location.span);
        let stuck = self.stuck.iter().filter_map(|id| self.automaton.location(*id));
        let mut warnings: Vec<Diagnostic> = stuck.map(never).collect();
        for (id, location) in (0..).map(LocationId).zip(&self.automaton.locations) {
            let is_whenever = location.kind == LocationKind::Whenever;
            if is_whenever && self.seen.reached.contains(&id) && !self.starts(id) {
                warnings.push(never(location));
            }
        }
        for composite in &self.automaton.composites {
            if self.is_reached(&composite.locations) {
                warnings.extend(self.unreached(composite).map(diagnostics::unreachable::part));
            }
        }
        warnings.sort_by_key(|warning| (warning.span, warning.code));
        warnings
    }

    /// Returns whether a WHENEVER starts its body in some run.
    fn starts(&self, id: LocationId) -> bool {
        let transitions = self.automaton.location(id).map_or(0..0, |location| location.transitions.clone());
        transitions.into_iter().any(|at| {
            let is_body = |transition: &hca::Transition| transition.target != Element::Location(id);
            self.automaton.transitions.get(at as usize).is_some_and(is_body)
                && self.seen.fired.contains(&TransitionId(at))
        })
    }

    fn is_reached(&self, locations: &Range<u32>) -> bool {
        self.seen.reached.range(LocationId(locations.start)..LocationId(locations.end)).next().is_some()
    }

    /// The first child of a reached composite that is never active, unless something else that is said tells why.
    fn unreached(&self, composite: &Composite) -> Option<Span> {
        let of = |element: &Element| match element {
            Element::Location(id) => (id.0..id.0 + 1, self.automaton.location(*id).map(|it| it.span)),
            Element::Composite(id) => {
                let data = self.automaton.composite(*id);
                (data.map_or(0..0, |it| it.locations.clone()), data.map(|it| it.span))
            }
        };
        let first = composite.children.iter().position(|child| !self.is_reached(&of(child).0))?;
        let is_told = match composite.kind {
            // What comes before never completes.
            CompositeKind::Sequence => composite.children[..first].iter().any(|child| {
                let range = of(child).0;
                self.stuck.iter().any(|id| range.contains(&id.0))
            }),
            CompositeKind::Guarded | CompositeKind::Lock => {
                let own = LocationId(composite.locations.start);
                let is_whenever =
                    self.automaton.location(own).is_some_and(|it| it.kind == LocationKind::Whenever);
                self.stuck.contains(&own) || is_whenever
            }
            _ => false,
        };
        if is_told { None } else { of(composite.children.get(first)?).1 }
    }
}
