//! Taking steps (SPEC 8.3). No memory is allocated between steps.

use std::sync::Arc;

use crate::automaton::{Automaton, CompositeId, CompositeKind, LocationId, TestId, TransitionId};
use crate::knowledge::Estimate;
use crate::marking::{Marking, bits};

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
}

/// Observes nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl StepObserver for Unobserved {}

/// A composite whose maintenance is checked, or a sequence to move on, with what that needs at hand.
#[derive(Clone, Debug)]
struct Watch {
    composite: CompositeId,
    test: TestId,
    range: std::ops::Range<u32>,
}

#[derive(Clone, Debug)]
struct Chain {
    composite: CompositeId,
    range: std::ops::Range<u32>,
    children: Vec<std::ops::Range<u32>>,
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
    chains: Vec<Chain>,
    /// Per program variable and overlay: what is known with this step's assertions added.
    overlay: Estimate,
    has_program_variables: bool,
}

impl Stepper {
    /// Starts in the automaton's start marking.
    pub fn new(automaton: &Arc<Automaton>) -> Self {
        let range_of = |element: &crate::Element| match element {
            crate::Element::Location(location) => location.0..location.0 + 1,
            crate::Element::Composite(id) => {
                automaton.composite(*id).map_or(0..0, |inner| inner.locations.clone())
            }
        };
        let numbered = || {
            automaton.composites.iter().enumerate().map(|(at, composite)| (CompositeId(at as u32), composite))
        };
        let watches = numbered()
            .filter_map(|(composite, data)| {
                Some(Watch { composite, test: data.maintenance?, range: data.locations.clone() })
            })
            .collect();
        let mut chains: Vec<Chain> = numbered()
            .filter(|(_, data)| data.kind == CompositeKind::Sequence)
            .map(|(composite, data)| Chain {
                composite,
                range: data.locations.clone(),
                children: data.children.iter().map(range_of).collect(),
            })
            .collect();
        chains.reverse();
        let empty = Marking::empty(automaton.locations.len());
        Self {
            marking: automaton.start(),
            alive: empty.clone(),
            next: empty,
            dropped: vec![false; automaton.composites.len()],
            watches,
            chains,
            overlay: Estimate::unknown(automaton.variables.len()),
            has_program_variables: automaton.variables.iter().any(|variable| variable.is_program_variable),
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

    /// Goes to another marking of the same automaton, as when stepping back.
    pub fn set_marking(&mut self, marking: &Marking) {
        if marking.words().len() == self.marking.words().len() {
            self.marking.copy_from(marking);
        }
    }

    /// Whether the program has ended.
    pub fn is_done(&self) -> bool {
        self.marking.is_empty()
    }

    /// Takes one step under the estimate at its end.
    #[inline]
    pub fn step(&mut self, estimate: &Estimate) {
        self.step_observed(std::slice::from_ref(estimate), &mut Unobserved);
    }

    /// Takes one step when the plant is known to be in one of several states: what is true in all of them is known.
    ///
    /// An empty slice knows nothing.
    pub fn step_observed(&mut self, states: &[Estimate], observer: &mut impl StepObserver) {
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
            self.advance(&states, observer);
        }
    }

    /// A program variable that is asserted is known in the same step, and only there.
    fn apply_program_settings(&self, estimate: &mut Estimate) {
        for location in self.marking.iter() {
            let assertion =
                self.automaton.location(location).and_then(|location| location.assertion.as_ref());
            for &(variable, value) in assertion.iter().flat_map(|assertion| &assertion.program_settings) {
                estimate.set(variable, Some(value));
            }
        }
    }

    fn advance(&mut self, states: &[Estimate], observer: &mut impl StepObserver) {
        self.preempt(states, observer);
        self.next.clear();
        for at in 0..self.alive.words().len() {
            let word = self.alive.words().get(at).copied().unwrap_or(0);
            for bit in bits(word) {
                self.leave_or_stay(LocationId(at as u32 * 64 + bit), states, observer);
            }
        }
        for chain in &self.chains {
            if !self.marking.intersects(&chain.range) {
                continue;
            }
            let watched_by =
                self.automaton.watched_by.get(chain.composite.0 as usize).map_or(&[][..], Vec::as_slice);
            if watched_by.iter().any(|outer| self.dropped.get(outer.0 as usize) == Some(&true)) {
                continue;
            }
            // From the last child backwards, so that a child started here is not taken for one that goes on.
            for child in (0..chain.children.len().saturating_sub(1)).rev() {
                let Some(range) = chain.children.get(child) else { continue };
                if self.marking.intersects(range) && !self.next.intersects(range) {
                    let following = self
                        .automaton
                        .composite(chain.composite)
                        .and_then(|sequence| sequence.children.get(child + 1));
                    for &location in following.map_or(&[][..], |following| self.automaton.start_of(following))
                    {
                        self.next.insert(location);
                    }
                    observer.continued(chain.composite, child);
                }
            }
        }
        std::mem::swap(&mut self.marking, &mut self.next);
    }

    fn preempt(&mut self, states: &[Estimate], observer: &mut impl StepObserver) {
        self.alive.copy_from(&self.marking);
        for watch in &self.watches {
            let fails = self.marking.intersects(&watch.range) && !holds(&self.automaton, watch.test, states);
            if let Some(dropped) = self.dropped.get_mut(watch.composite.0 as usize) {
                *dropped = fails;
            }
            if fails {
                self.alive.remove_range(&watch.range);
                observer.preempted(watch.composite);
            }
        }
    }

    fn leave_or_stay(&mut self, id: LocationId, states: &[Estimate], observer: &mut impl StepObserver) {
        let automaton = &*self.automaton;
        let Some(location) = automaton.location(id) else { return };
        if let Some(assertion) = &location.assertion
            && !holds(automaton, assertion.test, states)
        {
            self.next.insert(id);
            return;
        }
        for at in location.transitions.clone() {
            let Some(transition) = automaton.transitions.get(at as usize) else { continue };
            if transition.guard.is_none_or(|guard| holds(automaton, guard, states)) {
                for &location in automaton.start_of(&transition.target) {
                    self.next.insert(location);
                }
                observer.fired(TransitionId(at));
            }
        }
        if !self.next.contains(id) {
            observer.left(id);
        }
    }
}

/// Whether a guard holds: entailed in all states, or for a barred guard not entailed in all of them.
#[inline]
fn holds(automaton: &Automaton, test: TestId, states: &[Estimate]) -> bool {
    let Some(test) = automaton.tests.get(test.0 as usize) else { return true };
    let entailed =
        states.iter().all(|state| test.condition.is_entailed(state.values(), &automaton.variables));
    entailed != test.guard.non_entailed
}
