//! Taking steps (SPEC 8.3). No memory is allocated between steps.

use std::sync::Arc;

use exact::Rational;
use smol_str::SmolStr;

use crate::automaton::{
    Automaton, Choice, Composite, CompositeId, CompositeKind, Element, Location, LocationId, LocationKind,
    Start, Test, TestId, TransitionId,
};
use crate::clock::{ClockId, ClockKind, Times};
use crate::knowledge::Estimate;
use crate::locks::{self, LockId, LockState};
use crate::marking::{Marking, bits};
use crate::vocabulary::VariableId;

/// Is told what happens in a step; [`Unobserved`] costs nothing.
pub trait StepObserver {
    /// The maintenance of a composite failed: everything below it was dropped.
    fn preempted(&mut self, _composite: CompositeId) {}
    /// A location's assertion holds, or its wait is over, and it was left without staying marked itself.
    fn left(&mut self, _location: LocationId) {}
    /// A transition fired.
    fn fired(&mut self, _transition: TransitionId) {}
    /// In a sequence the child at this place has ended, and the next has started.
    fn continued(&mut self, _sequence: CompositeId, _child: usize) {}
    /// A clock was up and did what it is for.
    fn elapsed(&mut self, _clock: ClockId) {}
    /// An alternative of a choice by rewards completed, for which this counts.
    fn earned(&mut self, _reward: Rational) {}
}

/// Observes nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl StepObserver for Unobserved {}

/// How a step finds out whether the condition of a test is entailed.
trait Knowledge: Copy {
    fn entails(self, automaton: &Automaton, id: TestId, test: &Test) -> bool;
}

/// A condition is entailed if it is true in all of these states.
impl Knowledge for &[Estimate] {
    #[inline]
    fn entails(self, automaton: &Automaton, _id: TestId, test: &Test) -> bool {
        self.iter().all(|state| test.condition.is_entailed(state.values(), &automaton.variables))
    }
}

/// The caller knows which conditions are entailed.
impl Knowledge for &dyn Fn(TestId) -> bool {
    fn entails(self, _automaton: &Automaton, id: TestId, _test: &Test) -> bool {
        self(id)
    }
}

/// A composite whose maintenance is checked.
#[derive(Clone, Debug)]
struct Watch {
    composite: CompositeId,
    test: TestId,
    range: std::ops::Range<u32>,
}

/// A composite of which a step finds out whether it completes, or in which it starts what comes next.
#[derive(Clone, Debug)]
struct Stage {
    composite: CompositeId,
    kind: CompositeKind,
    range: std::ops::Range<u32>,
}

/// Where a run is between two steps, to come back to: what is marked, and the time of its clocks.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Standing {
    marking: Marking,
    aside: Marking,
    times: Times,
}

impl Standing {
    /// Returns what is marked.
    pub const fn marking(&self) -> &Marking {
        &self.marking
    }

    /// The same with times that count from now: two standings that continue alike are then equal, in whichever step they are
    /// reached.
    #[must_use]
    pub fn relative(mut self, automaton: &Automaton) -> Self {
        self.times.count_from_now(automaton);
        self
    }
}

/// The position of a run, without the number of its step: two runs in equal positions continue alike.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    marking: Marking,
    /// For each running clock, in how many steps it is up; for an `AT` clock, also if nothing waits for it.
    clocks: Vec<Vec<(u64, u64)>>,
    /// For how many steps each `HELD` condition has lasted, at most the number that it needs.
    lasted: Vec<u64>,
}

/// A marking of an automaton and the room to compute the next one.
#[derive(Clone, Debug)]
pub struct Stepper {
    automaton: Arc<Automaton>,
    marking: Marking,
    alive: Marking,
    next: Marking,
    dropped: Vec<bool>,
    watches: Vec<Watch>,
    /// Innermost first.
    stages: Vec<Stage>,
    /// Whether a join or a clock is among them: then what a transition starts is started after what is inside its target
    /// has been looked at.
    starts_late: bool,
    /// Transitions that have fired and whose targets are still to be started, outermost first.
    fired: Vec<TransitionId>,
    /// Which locations and composites complete in this step.
    completed: Marking,
    is_completed: Vec<bool>,
    /// Per program variable and overlay: what is known with this step's assertions added.
    overlay: Estimate,
    has_program_variables: bool,
    times: Times,
    /// For each condition that has to have lasted, whether it has.
    is_held: Vec<bool>,
    /// The marked locations whose goals contradict what is locked: they are not commanded, and do not complete.
    aside: Marking,
    /// Whether the program has locks or choices.
    acts_after_step: bool,
}

// Functions that only forms in time need are marked cold, so that the compiler inlines the guards of plain programs.
impl Stepper {
    /// Starts in the automaton's start marking; choices are made by what is likeliest, or has the largest reward.
    pub fn new(automaton: &Arc<Automaton>) -> Self {
        let mut stepper = Self::undecided(automaton);
        stepper.choose_first_best();
        stepper
    }

    /// Starts in the automaton's start marking, with its choices [open](Self::open_choice).
    pub fn undecided(automaton: &Arc<Automaton>) -> Self {
        let numbered = || {
            automaton.composites.iter().enumerate().map(|(at, composite)| (CompositeId(at as u32), composite))
        };
        let watches = numbered()
            .filter_map(|(composite, data)| {
                Some(Watch { composite, test: data.maintenance?, range: data.locations.clone() })
            })
            .collect();
        let matters = matters_to_others(automaton);
        let mut stages: Vec<Stage> = numbered()
            .filter(|(id, data)| {
                let acts = matches!(data.kind, CompositeKind::Sequence | CompositeKind::Timeout);
                acts || is_rewarded(automaton, *id) || matters[id.0 as usize]
            })
            .map(|(composite, data)| Stage { composite, kind: data.kind, range: data.locations.clone() })
            .collect();
        stages.reverse();
        let is_timed = is_timed(automaton);
        let empty = Marking::empty(automaton.locations.len());
        let mut times = Times::new(automaton);
        let mut marking = empty.clone();
        start(automaton, Element::Composite(Automaton::ROOT), &mut marking, &mut times);
        Self {
            marking,
            alive: empty.clone(),
            aside: empty.clone(),
            completed: empty.clone(),
            next: empty,
            is_completed: vec![false; automaton.composites.len()],
            starts_late: is_timed || stages.iter().any(|stage| stage.kind == CompositeKind::Parallel),
            fired: Vec::with_capacity(automaton.transitions.len()),
            dropped: vec![false; automaton.composites.len()],
            watches,
            stages,
            overlay: Estimate::unknown(automaton.variables.len()),
            has_program_variables: automaton.variables.iter().any(|variable| variable.is_program_variable),
            times,
            is_held: vec![false; automaton.held.len()],
            acts_after_step: !automaton.locks.is_empty() || !automaton.choices.is_empty(),
            automaton: Arc::clone(automaton),
        }
    }

    /// The automaton that is stepped.
    pub const fn automaton(&self) -> &Arc<Automaton> {
        &self.automaton
    }

    /// The current marking.
    pub const fn marking(&self) -> &Marking {
        &self.marking
    }

    /// Returns where it is, to come back to.
    pub fn standing(&self) -> Standing {
        let (marking, aside) = (self.marking.clone(), self.aside.clone());
        Standing { marking, aside, times: self.times.clone() }
    }

    /// The position of a program without locks and without open choices.
    pub fn position(&self) -> Position {
        let numbered = (0..).map(ClockId).zip(&self.automaton.clocks);
        let clocks = numbered.map(|(id, clock)| match clock.kind {
            ClockKind::At => vec![(clock.steps.saturating_sub(self.times.step), 0)],
            _ if !self.is_running(clock.owner) => Vec::new(),
            _ => self.times.ends.get(id.0 as usize).map_or_else(Vec::new, |ends| ends.left(self.times.step)),
        });
        let held = self.automaton.held.iter().zip(&self.times.unsatisfied);
        let lasted = held.map(|(held, unsatisfied)| (self.times.step - unsatisfied).min(held.steps));
        Position { marking: self.marking.clone(), clocks: clocks.collect(), lasted: lasted.collect() }
    }

    /// Returns whether the clock of an element runs: the element is marked, or the first part of a composite is.
    fn is_running(&self, owner: Element) -> bool {
        let first = match owner {
            Element::Location(_) => Some(owner),
            Element::Composite(composite) => {
                self.automaton.composite(composite).and_then(|composite| composite.children.first().copied())
            }
        };
        first.is_some_and(|first| self.marking.intersects(&self.automaton.locations_of(first)))
    }

    /// Goes to where the same automaton stood before, as when stepping back.
    pub fn return_to(&mut self, standing: &Standing) {
        self.marking.copy_from(&standing.marking);
        self.times.step = standing.times.step;
        self.times.ends.clone_from(&standing.times.ends);
        self.times.unsatisfied.clone_from(&standing.times.unsatisfied);
        self.times.locks.clone_from(&standing.times.locks);
        self.times.open.clone_from(&standing.times.open);
        self.aside.copy_from(&standing.aside);
    }

    /// The first choice that has been started and not been made.
    pub fn open_choice(&self) -> Option<&Choice> {
        self.automaton.choice(*self.times.open.first()?)
    }

    /// Makes the first open choice.
    pub fn choose(&mut self, alternative: usize) {
        if self.times.open.is_empty() {
            return;
        }
        let choice = self.times.open.remove(0);
        let automaton = Arc::clone(&self.automaton);
        let chosen = automaton.composite(choice).and_then(|choice| choice.children.get(alternative));
        if let Some(&chosen) = chosen {
            start(&automaton, chosen, &mut self.marking, &mut self.times);
        }
    }

    fn choose_first_best(&mut self) {
        while let Some(choice) = self.open_choice() {
            let alternative = choice.first_best();
            self.choose(alternative);
        }
    }

    /// The marked locations whose goals contradict what is locked: they are not commanded, and do not complete.
    pub const fn aside(&self) -> &Marking {
        &self.aside
    }

    /// Returns what is asserted and not set aside, each goal once, in alphabetical order.
    pub fn goals(&self) -> Vec<SmolStr> {
        if self.aside.is_empty() {
            return self.automaton.goals(&self.marking);
        }
        self.automaton.goals(&self.marking.without(&self.aside))
    }

    pub(crate) fn set_locations_aside(&mut self, locations: &[LocationId]) {
        self.aside.clear();
        for &location in locations {
            self.aside.insert(location);
        }
    }

    pub(crate) fn lock_states(&self) -> &[LockState] {
        &self.times.locks
    }

    /// For how many steps a lock has been waited for; `None` if it is not.
    pub(crate) fn waited(&self, lock: LockId) -> Option<u64> {
        Some(self.times.step - self.times.locks.get(lock.0 as usize)?.waiting_since()?)
    }

    /// Starts what is done under a lock that is waited for.
    pub(crate) fn grant(&mut self, id: LockId) {
        let automaton = Arc::clone(&self.automaton);
        let Some(lock) = automaton.locks.get(id.0 as usize) else { return };
        if let Some(state) = self.times.locks.get_mut(id.0 as usize) {
            *state = LockState::Held { was_entailed: false };
        }
        self.marking.remove_range(&automaton.locations_of(Element::Location(lock.waiting)));
        self.marking.insert(lock.assertion);
        start(&automaton, lock.body, &mut self.marking, &mut self.times);
    }

    /// The names of the locks that are held.
    pub fn held_locks(&self) -> Vec<SmolStr> {
        let states = self.automaton.locks.iter().zip(&self.times.locks);
        let held = states.filter(|(_, state)| matches!(state, LockState::Held { .. }));
        held.map(|(lock, _)| lock.label.clone()).collect()
    }

    /// After a step of a program that runs alone: grants locks, and makes choices without chance and plant.
    fn settle(&mut self) {
        if !self.times.locks.is_empty() {
            locks::grant(&mut [&mut *self]);
        }
        self.choose_first_best();
        if !self.times.locks.is_empty() {
            locks::set_aside(&mut [&mut *self]);
        }
    }

    /// The running clocks, in textual order, each with the number of steps after which it is up; with 1, at the end of
    /// the next step.
    pub fn running_clocks(&self) -> Vec<(ClockId, u64)> {
        let numbered = (0..).map(ClockId).zip(&self.automaton.clocks);
        let left = numbered.filter_map(|(id, clock)| {
            let is_running = self.is_running(clock.owner);
            let end = match clock.kind {
                ClockKind::At => clock.steps,
                _ => self.times.ends.get(id.0 as usize)?.first()?,
            };
            is_running.then_some((id, end.saturating_sub(self.times.step)))
        });
        left.collect()
    }

    /// Returns whether time alone may change what happens next: a clock runs, or a condition may come to have lasted.
    pub fn depends_on_time(&self) -> bool {
        !self.running_clocks().is_empty()
            || self.automaton.held.iter().zip(&self.times.unsatisfied).any(|(held, unsatisfied)| {
                let lasted = self.times.step - unsatisfied;
                (1..held.steps).contains(&lasted)
            })
    }

    /// Returns whether the program has ended.
    pub fn is_done(&self) -> bool {
        self.marking.is_empty()
    }

    /// Takes one step under the estimate at its end.
    #[inline]
    pub fn step(&mut self, estimate: &Estimate) {
        self.step_observed(std::slice::from_ref(estimate), &mut Unobserved);
    }

    /// The conditions that the next step may ask for, in order: what is asserted and waited for, and what is watched.
    pub fn asked(&self) -> Vec<TestId> {
        let watches = self.watches.iter().filter(|watch| self.marking.intersects(&watch.range));
        let mut asked: Vec<TestId> = watches.map(|watch| watch.test).collect();
        asked.extend(self.automaton.held.iter().map(|held| held.test));
        let locks = self.automaton.locks.iter().zip(&self.times.locks);
        let held = locks.filter(|(_, state)| matches!(state, LockState::Held { .. }));
        asked.extend(held.map(|(lock, _)| lock.test));
        for location in self.marking.iter().filter_map(|location| self.automaton.location(location)) {
            asked.extend(location.assertion.as_ref().map(|assertion| assertion.test));
            let transitions = location.transitions.clone();
            let transitions = transitions.filter_map(|at| self.automaton.transitions.get(at as usize));
            asked.extend(transitions.filter_map(|transition| transition.guard));
        }
        // What has to have lasted is asked for itself, in each step.
        let lasts =
            |test: &TestId| self.automaton.tests.get(test.0 as usize).is_some_and(|it| it.held.is_some());
        asked.retain(|test| !lasts(test));
        asked.sort_unstable();
        asked.dedup();
        asked
    }

    /// Returns what the marked locations set of the program's own variables, as variable and value number.
    pub fn settings(&self) -> impl Iterator<Item = (VariableId, u32)> + '_ {
        let marked = self.marking.iter().filter(|location| !self.aside.contains(*location));
        let marked = marked.filter_map(|location| self.automaton.location(location));
        marked
            .filter_map(|location| location.assertion.as_ref())
            .flat_map(|assertion| assertion.program_settings.iter().copied())
    }

    /// Takes one step where the caller says which of the [asked](Self::asked) conditions are entailed, whatever bar is over
    /// them. Granting [locks] and making [choices](Self::open_choice) is left to the caller.
    pub fn step_told(&mut self, is_entailed: &dyn Fn(TestId) -> bool, observer: &mut impl StepObserver) {
        self.advance(is_entailed, observer);
    }

    /// Takes one step when the plant is known to be in one of several states: what is true in all of them is known.
    ///
    /// An empty slice knows nothing. Locks are granted as to a program that runs alone, and choices are made by what is
    /// likeliest, or has the largest reward.
    pub fn step_observed(&mut self, states: &[Estimate], observer: &mut impl StepObserver) {
        self.step_known(states, observer);
        if self.acts_after_step {
            self.settle();
        }
    }

    fn step_known(&mut self, states: &[Estimate], observer: &mut impl StepObserver) {
        if let [only] = states {
            if self.has_program_variables {
                let mut overlay = std::mem::replace(&mut self.overlay, Estimate::unknown(0));
                overlay.copy_from(only);
                self.apply_program_settings(&mut overlay);
                self.advance(std::slice::from_ref(&overlay), observer);
                self.overlay = overlay;
            } else {
                self.advance(states, observer);
            }
        } else {
            let mut states = states.to_vec();
            if states.is_empty() {
                states.push(Estimate::unknown(self.automaton.variables.len()));
            }
            for state in &mut states {
                self.apply_program_settings(state);
            }
            self.advance(states.as_slice(), observer);
        }
    }

    /// A program variable that is asserted is known in the same step, and only there.
    fn apply_program_settings(&self, estimate: &mut Estimate) {
        for (variable, value) in self.settings() {
            estimate.set(variable, Some(value));
        }
    }

    fn advance(&mut self, known: impl Knowledge, observer: &mut impl StepObserver) {
        self.times.step += 1;
        for at in 0..self.is_held.len() {
            self.look_at_held(at, known);
        }
        self.preempt(known, observer);
        if !self.times.locks.is_empty() {
            self.drop_under_locks(known, observer);
        }
        self.next.clear();
        let has_stages = !self.stages.is_empty();
        if has_stages {
            self.completed.clear();
        }
        for at in 0..self.alive.words().len() {
            let word = self.alive.words().get(at).copied().unwrap_or(0);
            for bit in bits(word) {
                self.leave_or_stay(LocationId(at as u32 * 64 + bit), known, observer);
            }
        }
        if has_stages {
            for at in 0..self.stages.len() {
                self.complete(at, observer);
            }
        }
        if self.starts_late {
            self.start_fired_down_to(Automaton::ROOT);
        }
        if !self.times.locks.is_empty() {
            self.release_locks();
        }
        std::mem::swap(&mut self.marking, &mut self.next);
    }

    /// Drops what is done under locks whose constraints were entailed and are not any more.
    #[cold]
    fn drop_under_locks(&mut self, known: impl Knowledge, observer: &mut impl StepObserver) {
        for (lock, state) in self.automaton.locks.iter().zip(&mut self.times.locks) {
            let is_entailed = holds(&self.automaton, lock.test, known, &self.is_held);
            let drops = matches!(state, LockState::Held { was_entailed: true }) && !is_entailed;
            if let LockState::Held { was_entailed } = state {
                *was_entailed |= is_entailed;
            }
            if let Some(dropped) = self.dropped.get_mut(lock.composite.0 as usize) {
                *dropped = drops;
            }
            if drops {
                self.alive.remove_range(&self.automaton.locations_of(lock.body));
                observer.preempted(lock.composite);
            }
        }
        for lock in &self.automaton.locks {
            if self.dropped.get(lock.composite.0 as usize) == Some(&true) {
                forget_waits(&self.automaton, &self.automaton.locations_of(lock.body), &mut self.times);
            }
        }
    }

    /// Releases the locks under which nothing is left, and forgets those that are not waited for any more.
    #[cold]
    fn release_locks(&mut self) {
        let automaton = Arc::clone(&self.automaton);
        for (at, lock) in automaton.locks.iter().enumerate() {
            let is_waiting = self.next.contains(lock.waiting);
            let is_left = self.is_left(&automaton.locations_of(lock.body));
            let Some(state) = self.times.locks.get_mut(at) else { continue };
            let ends = match state {
                LockState::Free => false,
                LockState::Waiting(_) => !is_waiting,
                LockState::Held { .. } => !is_left,
            };
            if ends {
                *state = LockState::Free;
            }
        }
    }

    /// Returns whether anything in a range of locations will be marked.
    fn is_left(&self, range: &std::ops::Range<u32>) -> bool {
        self.next.intersects(range)
            || self.times.open.iter().any(|&choice| is_inside(&self.automaton, choice, range))
    }

    /// Whether a condition has been satisfied for long enough, this step included.
    #[cold]
    fn look_at_held(&mut self, at: usize, known: impl Knowledge) {
        let (Some(held), Some(unsatisfied)) =
            (self.automaton.held.get(at), self.times.unsatisfied.get_mut(at))
        else {
            return;
        };
        if holds(&self.automaton, held.test, known, &[]) == held.non_entailed {
            *unsatisfied = self.times.step;
        }
        if let Some(is_held) = self.is_held.get_mut(at) {
            *is_held = self.times.step - *unsatisfied >= held.steps;
        }
    }

    fn preempt(&mut self, known: impl Knowledge, observer: &mut impl StepObserver) {
        self.alive.copy_from(&self.marking);
        for watch in &self.watches {
            let fails = self.marking.intersects(&watch.range)
                && !holds(&self.automaton, watch.test, known, &self.is_held);
            if let Some(dropped) = self.dropped.get_mut(watch.composite.0 as usize) {
                *dropped = fails;
            }
            if fails {
                self.alive.remove_range(&watch.range);
                forget_waits(&self.automaton, &watch.range, &mut self.times);
                observer.preempted(watch.composite);
            }
        }
    }

    fn leave_or_stay(&mut self, id: LocationId, known: impl Knowledge, observer: &mut impl StepObserver) {
        let automaton = &*self.automaton;
        let Some(location) = automaton.location(id) else { return };
        if let Some(assertion) = &location.assertion
            && (!holds(automaton, assertion.test, known, &self.is_held)
                || self.acts_after_step && self.aside.contains(id))
        {
            self.next.insert(id);
            return;
        }
        if location.kind == LocationKind::Lock {
            self.next.insert(id);
            return;
        }
        if let Some(clock) = location.clock {
            self.wait(id, clock, observer);
            return;
        }
        let (mut stays, mut completes) = (false, true);
        for at in location.transitions.clone() {
            let Some(transition) = automaton.transitions.get(at as usize) else { continue };
            if transition.guard.is_none_or(|guard| holds(automaton, guard, known, &self.is_held)) {
                completes = false;
                stays |= transition.target == Element::Location(id);
                if self.starts_late {
                    self.fired.push(TransitionId(at));
                } else {
                    start(automaton, transition.target, &mut self.next, &mut self.times);
                }
                observer.fired(TransitionId(at));
            }
        }
        if completes && !self.stages.is_empty() {
            self.completed.insert(id);
        }
        if !stays {
            observer.left(id);
        }
    }

    /// A location that waits for a time: what it starts and whether it stays.
    #[cold]
    fn wait(&mut self, id: LocationId, clock: ClockId, observer: &mut impl StepObserver) {
        let automaton = &*self.automaton;
        let (Some(location), Some(data)) = (automaton.location(id), automaton.clock(clock)) else { return };
        let now = self.times.step;
        let (is_up, stays) = match data.kind {
            ClockKind::At => (now >= data.steps, now < data.steps),
            ClockKind::Every => (self.times.is_up(clock), true),
            ClockKind::Wait | ClockKind::Timeout => {
                let ends = self.times.ends_mut(clock);
                ends.map_or((true, false), |ends| (ends.take(now), !ends.is_empty()))
            }
        };
        if stays {
            self.next.insert(id);
        } else {
            observer.left(id);
        }
        if !is_up {
            return;
        }
        observer.elapsed(clock);
        match data.kind {
            ClockKind::Every => self.times.start(clock, data),
            ClockKind::Wait => self.completed.insert(id),
            ClockKind::At | ClockKind::Timeout => {}
        }
        for at in location.transitions.clone() {
            let target = automaton.transitions.get(at as usize).map(|transition| transition.target);
            if target != Some(Element::Location(id)) {
                self.fired.push(TransitionId(at));
                observer.fired(TransitionId(at));
            }
        }
    }

    /// Starts what has been fired in a composite or inside it, the innermost first. Locations are numbered with the
    /// composites that hold them, so that what is inside comes later.
    fn start_fired_down_to(&mut self, composite: CompositeId) {
        let automaton = &*self.automaton;
        while let Some(transition) =
            self.fired.last().and_then(|last| automaton.transitions.get(last.0 as usize))
        {
            let parent = automaton.location(transition.source).map(|source| source.parent);
            if parent.is_some_and(|parent| parent < composite) {
                return;
            }
            start(automaton, transition.target, &mut self.next, &mut self.times);
            self.fired.pop();
        }
    }

    /// Finds out whether a composite completes in this step, when that is known of all inside it (SPEC 8.3), and starts
    /// what comes next in a sequence.
    fn complete(&mut self, stage: usize, observer: &mut impl StepObserver) {
        let Some(Stage { composite: id, kind, range }) = self.stages.get(stage).cloned() else { return };
        let is_active = self.marking.intersects(&range) && !self.is_dropped_from_outside(id);
        let completes = is_active && {
            self.start_fired_down_to(CompositeId(id.0 + 1));
            match kind {
                CompositeKind::Sequence => self.continue_sequence(id, observer),
                // A start from outside in this step does not hold a join back: it comes later.
                CompositeKind::Parallel => !self.is_left(&range),
                CompositeKind::DoWatching => {
                    self.dropped.get(id.0 as usize) == Some(&true) || self.some_child_completes(id)
                }
                CompositeKind::Lock => {
                    self.dropped.get(id.0 as usize) == Some(&true) || self.body_completes(id)
                }
                CompositeKind::Timeout => self.time_out(id, observer),
                CompositeKind::Choice => {
                    self.earn(id, observer);
                    self.some_child_completes(id)
                }
                CompositeKind::Guarded | CompositeKind::Program => self.some_child_completes(id),
            }
        };
        if let Some(is_completed) = self.is_completed.get_mut(id.0 as usize) {
            *is_completed = completes;
        }
    }

    /// Drops what is left of the first child of a composite whose time is up; returns whether the composite completes.
    #[cold]
    fn time_out(&mut self, id: CompositeId, observer: &mut impl StepObserver) -> bool {
        let automaton = Arc::clone(&self.automaton);
        let Some(composite) = automaton.composite(id) else { return false };
        let (Some(clock), [first, rest @ ..]) = (composite.clock, composite.children.as_slice()) else {
            return false;
        };
        let completes = self.some_child_completes(id);
        let range = automaton.locations_of(*first);
        if !self.times.is_up(clock) || !self.is_left(&range) {
            return completes;
        }
        self.next.remove_range(&range);
        self.times.open.retain(|&choice| !is_inside(&automaton, choice, &range));
        forget_waits(&automaton, &range, &mut self.times);
        observer.elapsed(clock);
        if self.completes(*first) {
            return true;
        }
        match rest.first() {
            Some(&otherwise) => {
                start(&automaton, otherwise, &mut self.next, &mut self.times);
                completes
            }
            None => true,
        }
    }

    /// Counts the rewards of the alternatives that complete.
    #[cold]
    fn earn(&self, id: CompositeId, observer: &mut impl StepObserver) {
        let rewards = self.automaton.choice(id).and_then(Choice::rewards);
        let children = self.automaton.composite(id).map_or(&[][..], |data| data.children.as_slice());
        for (&child, &reward) in children.iter().zip(rewards.unwrap_or_default()) {
            if self.completes(child) {
                observer.earned(reward);
            }
        }
    }

    fn is_dropped_from_outside(&self, composite: CompositeId) -> bool {
        let watched_by = self.automaton.watched_by.get(composite.0 as usize).map_or(&[][..], Vec::as_slice);
        watched_by.iter().any(|outer| self.dropped.get(outer.0 as usize) == Some(&true))
    }

    fn completes(&self, element: Element) -> bool {
        match element {
            Element::Location(location) => self.completed.contains(location),
            Element::Composite(composite) => self.is_completed.get(composite.0 as usize) == Some(&true),
        }
    }

    fn some_child_completes(&self, composite: CompositeId) -> bool {
        let data = self.automaton.composite(composite);
        data.is_some_and(|data| data.children.iter().any(|&child| self.completes(child)))
    }

    /// Returns whether what is done under a lock completes; that what is locked comes true completes nothing.
    fn body_completes(&self, lock: CompositeId) -> bool {
        let body = self.automaton.composite(lock).and_then(|lock| lock.children.last());
        body.is_some_and(|&body| self.completes(body))
    }

    /// Starts the next part after each that completes; returns whether the last one does.
    fn continue_sequence(&mut self, id: CompositeId, observer: &mut impl StepObserver) -> bool {
        let automaton = &*self.automaton;
        let Some(sequence) = automaton.composite(id) else { return false };
        for (child, pair) in sequence.children.windows(2).enumerate() {
            if self.completes(pair[0]) {
                start(automaton, pair[1], &mut self.next, &mut self.times);
                observer.continued(id, child);
            }
        }
        sequence.children.last().is_some_and(|&last| self.completes(last))
    }
}

/// Marks the locations in which an element starts, and starts its clocks.
#[inline]
fn start(automaton: &Automaton, element: Element, next: &mut Marking, times: &mut Times) {
    match element {
        Element::Location(location) => {
            next.insert(location);
            if times.ends.is_empty() {
                return;
            }
            if let Some(id) = automaton.location(location).and_then(|location| location.clock)
                && let Some(clock) = automaton.clock(id)
            {
                times.start(id, clock);
            }
        }
        Element::Composite(composite) => {
            let Some(begun) = automaton.starts.get(composite.0 as usize) else { return };
            for &location in &begun.locations {
                next.insert(location);
            }
            if begun.is_timed() {
                start_timed(automaton, begun, next, times);
            }
        }
    }
}

#[cold]
fn start_timed(automaton: &Automaton, begun: &Start, next: &mut Marking, times: &mut Times) {
    for &choice in &begun.choices {
        times.leave_open(choice);
    }
    for &id in &begun.locks {
        start_lock(automaton, id, next, times);
    }
    for &id in &begun.clocks {
        if let Some(clock) = automaton.clock(id) {
            times.start(id, clock);
        }
    }
    for &id in &begun.timed {
        let Some([Element::Location(own), body]) = automaton.composite(id).map(|it| it.children.as_slice())
        else {
            continue;
        };
        let clock = automaton.location(*own).and_then(|own| automaton.clock(own.clock?));
        if clock.is_some_and(|clock| times.step < clock.steps) {
            next.insert(*own);
        } else {
            start(automaton, *body, next, times);
        }
    }
}

/// Returns whether a composite is in a range of locations.
fn is_inside(automaton: &Automaton, composite: CompositeId, range: &std::ops::Range<u32>) -> bool {
    automaton.composite(composite).is_some_and(|it| range.contains(&it.locations.start))
}

/// Restarts the body of a lock that is held; otherwise the program waits for the lock.
fn start_lock(automaton: &Automaton, id: LockId, next: &mut Marking, times: &mut Times) {
    let Some(lock) = automaton.locks.get(id.0 as usize) else { return };
    let range = automaton.locations_of(lock.body);
    let is_left =
        next.intersects(&range) || times.open.iter().any(|&choice| is_inside(automaton, choice, &range));
    let step = times.step;
    let Some(state) = times.locks.get_mut(id.0 as usize) else { return };
    if matches!(state, LockState::Held { .. }) && is_left {
        start(automaton, lock.body, next, times);
        return;
    }
    if !matches!(state, LockState::Waiting(_)) || !next.contains(lock.waiting) {
        *state = LockState::Waiting(step);
    }
    next.insert(lock.waiting);
}

/// Returns whether what a program does depends on time, locks or choices.
const fn is_timed(automaton: &Automaton) -> bool {
    !(automaton.clocks.is_empty() && automaton.locks.is_empty() && automaton.choices.is_empty())
}

/// Forgets the starts of what waits in a range of locations that is dropped.
#[cold]
fn forget_waits(automaton: &Automaton, range: &std::ops::Range<u32>, times: &mut Times) {
    for (clock, ends) in automaton.clocks.iter().zip(&mut times.ends) {
        if clock.kind == ClockKind::Wait
            && matches!(clock.owner, Element::Location(location) if range.contains(&location.0))
        {
            ends.clear();
        }
    }
}

/// Of each composite, whether something around it depends on its completion: the parts of a sequence but for the last,
/// alternatives whose completion counts, and what completes with something that matters. ALWAYS, WHENEVER, and the whole program never complete, and a join
/// looks at the marks inside it.
fn matters_to_others(automaton: &Automaton) -> Vec<bool> {
    let Automaton { composites, locations, .. } = automaton;
    let mut matters = vec![false; composites.len()];
    for (at, composite) in composites.iter().enumerate() {
        let own_matters = matters[at];
        let of_children = |place: usize| match composite.kind {
            CompositeKind::Sequence => own_matters || place + 1 < composite.children.len(),
            CompositeKind::DoWatching | CompositeKind::Guarded | CompositeKind::Lock => own_matters,
            CompositeKind::Choice => own_matters || is_rewarded(automaton, CompositeId(at as u32)),
            // What is dropped when the time is up may complete in that step.
            CompositeKind::Timeout => own_matters || place == 0,
            CompositeKind::Parallel | CompositeKind::Program => false,
        };
        for (place, child) in composite.children.iter().enumerate() {
            if let Element::Composite(child) = child {
                let repeats = composites.get(child.0 as usize).is_some_and(|it| repeats(it, locations));
                matters[child.0 as usize] = of_children(place) && !repeats;
            }
        }
    }
    matters
}

/// Returns whether something counts when a child of a composite completes.
fn is_rewarded(automaton: &Automaton, composite: CompositeId) -> bool {
    automaton.choice(composite).is_some_and(|choice| choice.rewards().is_some())
}

/// Returns whether a composite starts its body again and again.
fn repeats(composite: &Composite, locations: &[Location]) -> bool {
    let first = locations.get(composite.locations.start as usize);
    composite.kind == CompositeKind::Guarded
        && first.is_some_and(|own| {
            matches!(own.kind, LocationKind::Always | LocationKind::Whenever | LocationKind::Every)
        })
}

/// Returns whether a guard holds: its constraint is entailed, or for a barred guard it is not; with HELD, whether it
/// has lasted.
#[inline]
fn holds(automaton: &Automaton, id: TestId, known: impl Knowledge, is_held: &[bool]) -> bool {
    let Some(test) = automaton.tests.get(id.0 as usize) else { return true };
    let holds = match test.held {
        None => known.entails(automaton, id, test),
        Some(held) => is_held.get(held as usize) == Some(&true),
    };
    holds != test.guard.non_entailed
}
