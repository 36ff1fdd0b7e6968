//! The check of state that lasts (SPEC 10.2): what is required holds throughout, and changes exclude each other.

use std::collections::BTreeMap;

use tpn::LabelId;

use super::Checker;
use super::orders::{Side, Stated};
use crate::departure;
use crate::entailment::{Precedence, Span};
use crate::state::{self, Producer, State, owner_name};
use crate::{Rule, Violation};

impl Checker<'_> {
    /// Movements start where they can be driven from. How long they take from there is a constraint of the plan.
    pub(super) fn check_departures(&self, violations: &mut Vec<Violation>) {
        for movement in departure::of_plan(self.network, self.plan) {
            if movement.least.is_none() {
                let names =
                    vec![self.network.label_name(movement.arrival), self.network.label_name(movement.before)];
                let message = format!("{} cannot be driven from where {} ends", names[0], names[1]);
                violations.push(Violation::new(Rule::State, message).with_intervals(names));
            }
        }
    }

    /// Rules 1 and 2 in every schedule, the sides of rule 2 without circles, and everything as the plan states it.
    pub(super) fn check_states(&self, stated: &mut Stated, violations: &mut Vec<Violation>) {
        let supporters: BTreeMap<LabelId, LabelId> =
            self.plan.causal_links.iter().map(|link| (link.ask, link.tell)).collect();
        for state in state::selected(self.network, self.plan) {
            let producers = state.producers.iter().map(|it| Span { start: it.start, end: it.end });
            let requirements = state.requirements.iter().map(|it| Span { start: it.start, end: it.end });
            let spans: Vec<Span> = producers.chain(requirements).collect();
            if let Some(span) = spans.iter().find(|span| !self.is_forward(**span)) {
                violations.push(self.backward(*span));
                continue;
            }
            let checked =
                StateCheck { checker: self, order: Precedence::new(&self.entailment, &spans), state: &state };
            let sides = checked.check_producers(stated, violations);
            checked.check_requirements(&supporters, &sides, stated, violations);
        }
    }
}

struct StateCheck<'check> {
    checker: &'check Checker<'check>,
    state: &'check State,
    /// Of the producers, then the requirements.
    order: Precedence,
}

/// Which producers rule 2 puts before which, by position: row by row whether each other one is later.
struct Sides {
    count: usize,
    is_before: Vec<bool>,
}

impl Sides {
    fn contains(&self, first: usize, then: usize) -> bool {
        self.is_before[first * self.count + then]
    }
}

impl StateCheck<'_> {
    fn violation(&self, message: String, labels: &[LabelId]) -> Violation {
        let names = labels.iter().map(|&label| self.checker.network.label_name(label)).collect();
        Violation::new(Rule::State, message).with_intervals(names)
    }

    fn variable(&self) -> &str {
        &self.checker.network.variables[self.state.variable.index()].name
    }

    /// What a producer does, for people: `Deploy#1 changes ARM`, `Tell(ARM=OUT)#1 says ARM=OUT`.
    fn deed(&self, producer: &Producer) -> String {
        let network = self.checker.network;
        let text = &network.labels[producer.label.index()].text;
        match (producer.is_initial, producer.is_changing) {
            (true, _) => format!("{text} at first"),
            (false, true) => format!("{} changes {}", owner_name(network, producer.label), self.variable()),
            (false, false) => format!("{} keeps {text}", owner_name(network, producer.label)),
        }
    }

    /// Rule 2.
    fn check_producers(&self, stated: &mut Stated, violations: &mut Vec<Violation>) -> Sides {
        let network = self.checker.network;
        let producers = &self.state.producers;
        let count = producers.len();
        let mut sides = Sides { count, is_before: vec![false; count * count] };
        for (one, producer) in producers.iter().enumerate() {
            for (other, another) in producers.iter().enumerate().skip(one + 1) {
                if !producer.excludes(another, network) {
                    continue;
                }
                let (first, then) = match stated.side(network, producer.label, another.label) {
                    Ok(Side::InOrder) => (one, other),
                    Ok(Side::Reversed) => (other, one),
                    Err(problem) => {
                        violations.push(self.violation(problem, &[producer.label, another.label]));
                        continue;
                    }
                };
                sides.is_before[first * count + then] = true;
                let (earlier, later) = (&producers[first], &producers[then]);
                let labels = [earlier.label, later.label];
                if later.is_initial {
                    let message = format!(
                        "{} is put before the start, where {} has its first value",
                        network.label_name(earlier.label),
                        self.variable()
                    );
                    violations.push(self.violation(message, &labels));
                } else if !self.order.is_before(first, then) {
                    let message = format!(
                        "{} may overlap {}, which it is said to precede: {} while {}",
                        network.label_name(earlier.label),
                        network.label_name(later.label),
                        self.deed(earlier),
                        self.deed(later)
                    );
                    violations.push(self.violation(message, &labels));
                }
            }
        }
        self.check_circles(&sides, violations);
        sides
    }

    /// The sides of rule 2 are an order: those that nothing unplaced precedes can always be placed next.
    fn check_circles(&self, sides: &Sides, violations: &mut Vec<Violation>) {
        let count = self.state.producers.len();
        let mut waits_for = vec![0_u32; count];
        for first in 0..count {
            for then in (0..count).filter(|&then| sides.contains(first, then)) {
                waits_for[then] += 1;
            }
        }
        let mut ready: Vec<usize> = (0..count).filter(|&index| waits_for[index] == 0).collect();
        let mut is_placed = vec![false; count];
        while let Some(index) = ready.pop() {
            is_placed[index] = true;
            for follower in (0..count).filter(|&then| sides.contains(index, then)) {
                waits_for[follower] -= 1;
                if waits_for[follower] == 0 {
                    ready.push(follower);
                }
            }
        }
        let left: Vec<LabelId> = (self.state.producers.iter().zip(is_placed))
            .filter_map(|(producer, is_placed)| (!is_placed).then_some(producer.label))
            .collect();
        if !left.is_empty() {
            let names: Vec<String> =
                left.iter().map(|&label| self.checker.network.label_name(label)).collect();
            let message = format!(
                "the order of the changes of {} goes round in a circle: {}",
                self.variable(),
                names.join(", ")
            );
            violations.push(self.violation(message, &left));
        }
    }

    /// Rule 1. That the supporter is ready in time is a constraint of the plan, which holds in every schedule.
    fn check_requirements(
        &self,
        supporters: &BTreeMap<LabelId, LabelId>,
        sides: &Sides,
        stated: &mut Stated,
        violations: &mut Vec<Violation>,
    ) {
        let network = self.checker.network;
        let producers = &self.state.producers;
        for (index, requirement) in self.state.requirements.iter().enumerate() {
            let own = supporters.get(&requirement.label);
            let Some(own) = producers.iter().position(|producer| own == Some(&producer.label)) else {
                continue;
            };
            for (other, producer) in producers.iter().enumerate() {
                if other == own || !producer.threatens(requirement, network) {
                    continue;
                }
                let labels = [requirement.label, producer.label];
                let side = match stated.side(network, requirement.label, producer.label) {
                    Ok(side) => side,
                    Err(problem) => {
                        violations.push(self.violation(problem, &labels));
                        continue;
                    }
                };
                // A producer with another value, or a changing one, and the supporter are a pair of rule 2: what
                // precedes the supporter ends before it is ready, what follows it must wait for the requirement's end.
                let expected = if sides.contains(other, own) {
                    Side::Reversed
                } else if sides.contains(own, other) {
                    Side::InOrder
                } else {
                    continue;
                };
                if side != expected {
                    let message = format!(
                        "{} is not on the side of {} on which {} is, which makes it hold",
                        network.label_name(requirement.label),
                        network.label_name(producer.label),
                        network.label_name(producers[own].label)
                    );
                    violations.push(self.violation(message, &labels));
                } else if side == Side::InOrder && !self.order.is_before(producers.len() + index, other) {
                    let message = format!(
                        "{} may overlap {}, which it is said to precede: {} while {} requires {}",
                        network.label_name(requirement.label),
                        network.label_name(producer.label),
                        self.deed(producer),
                        owner_name(network, requirement.label),
                        network.labels[requirement.label.index()].text
                    );
                    violations.push(self.violation(message, &labels));
                }
            }
        }
    }
}
