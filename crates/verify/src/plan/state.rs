//! The check of state that lasts (SPEC 10.2): what is required holds throughout, and changes exclude each other.
//!
//! A plan lists what gives each variable its values in order. What excludes its neighbor in that list must be over before it
//! in every schedule; for what lies further apart this follows, since no interval ends before it starts.

use std::collections::{BTreeMap, BTreeSet};

use tpn::{LabelId, Ordering, StateOrder, VariableId};

use super::Checker;
use crate::departure;
use crate::entailment::Span;
use crate::labels;
use crate::state::{self, Producer, Requirement, State, owner_name};
use crate::{Rule, Violation};

impl Checker<'_> {
    /// Movements start where they can be driven from. How long they take from there is a constraint of the plan.
    pub(super) fn check_departures(&self, violations: &mut Vec<Violation>) {
        for movement in departure::of_plan(self.network, self.plan) {
            if movement.least.is_none() {
                let names =
                    vec![self.network.label_name(movement.arrival), self.network.label_name(movement.before)];
                let message = format!("{} cannot be driven from the end of {}", names[0], names[1]);
                violations.push(Violation::new(Rule::State, message).with_intervals(names));
            }
        }
    }

    /// Rules 1 and 2 in every schedule.
    pub(super) fn check_states(&self, violations: &mut Vec<Violation>) {
        let network = self.network;
        let supporters: BTreeMap<LabelId, LabelId> =
            self.plan.causal_links.iter().map(|link| (link.ask, link.tell)).collect();
        let mut lists: BTreeMap<VariableId, &[LabelId]> = BTreeMap::new();
        for StateOrder { variable, producers } in &self.plan.state_order {
            if lists.insert(*variable, producers).is_some() {
                let name = &network.variables[variable.index()].name;
                violations.push(Violation::new(Rule::State, format!("{name} has two orders")));
            }
        }
        let mut places: BTreeMap<LabelId, usize> = BTreeMap::new();
        for state in state::selected(network, self.plan) {
            let producers = state.producers.iter().map(|it| Span { start: it.start, end: it.end });
            let requirements = state.requirements.iter().map(|it| Span { start: it.start, end: it.end });
            let listed = lists.remove(&state.variable).unwrap_or_default();
            if let Some(span) = producers.chain(requirements).find(|span| !self.is_forward(*span)) {
                violations.push(self.backward(span));
                continue;
            }
            let Some(order) = self.listed(&state, listed, violations) else { continue };
            let checked = StateCheck { checker: self, state: &state, order };
            checked.check_producers(violations);
            checked.check_requirements(&supporters, violations);
            // Between two producers there is room for what rests on the first one.
            places.extend(checked.order.iter().zip(0..).map(|(producer, place)| (producer.label, 2 * place)));
        }
        for variable in lists.into_iter().filter(|(_, list)| !list.is_empty()).map(|(variable, _)| variable) {
            let name = &network.variables[variable.index()].name;
            let message = format!("the plan orders changes of {name}, but selects none");
            violations.push(Violation::new(Rule::State, message));
        }
        let rests = supporters.iter().filter_map(|(ask, tell)| Some((*ask, places.get(tell)? + 1)));
        let rests: Vec<(LabelId, usize)> = rests.collect();
        places.extend(rests);
        self.check_added(&places, &supporters, violations);
    }

    /// The selected producers in the plan's order: all of them, each once, the initial value first. Where only that one
    /// gives a variable its value, the plan need not list it.
    fn listed(
        &self,
        state: &State,
        listed: &[LabelId],
        violations: &mut Vec<Violation>,
    ) -> Option<Vec<Producer>> {
        let network = self.network;
        let variable = &network.variables[state.variable.index()].name;
        let by_label: BTreeMap<LabelId, &Producer> =
            state.producers.iter().map(|producer| (producer.label, producer)).collect();
        let mut order: Vec<Producer> = state.producers.iter().filter(|it| it.is_initial).copied().collect();
        let is_shown = |label: &LabelId| by_label.get(label).is_some_and(|it| it.is_initial);
        let mut seen: BTreeSet<LabelId> = BTreeSet::new();
        let before = violations.len();
        let mut complain = |message: String, label: LabelId| {
            let names = vec![network.label_name(label)];
            violations.push(Violation::new(Rule::State, message).with_intervals(names));
        };
        for (position, &label) in listed.iter().enumerate() {
            let name = network.label_name(label);
            if !seen.insert(label) {
                complain(format!("{name} appears twice in the order of {variable}"), label);
            } else if is_shown(&label) {
                if position > 0 {
                    let earlier = network.label_name(listed[0]);
                    let message = format!(
                        "the plan orders {earlier} before the start, where {variable} has its first value"
                    );
                    complain(message, label);
                }
            } else if let Some(&producer) = by_label.get(&label) {
                order.push(*producer);
            } else {
                let message =
                    format!("{name} is in the order of {variable}, but is not selected or changes nothing");
                complain(message, label);
            }
        }
        for producer in state.producers.iter().filter(|it| !it.is_initial && !seen.contains(&it.label)) {
            let name = network.label_name(producer.label);
            complain(
                format!("the plan does not say where {name} is in the order of {variable}"),
                producer.label,
            );
        }
        (violations.len() == before).then_some(order)
    }

    /// What planning added agrees with the orders of the variables.
    fn check_added(
        &self,
        places: &BTreeMap<LabelId, usize>,
        supporters: &BTreeMap<LabelId, LabelId>,
        violations: &mut Vec<Violation>,
    ) {
        let network = self.network;
        for &Ordering { first, then } in &self.plan.orderings_added {
            if !labels::is_lasting(network, first) {
                continue;
            }
            let of = |label: LabelId| network.labels[label.index()].literal.variable;
            let is_in_order =
                matches!((places.get(&first), places.get(&then)), (Some(one), Some(other)) if one < other);
            let is_asked = network.conflict(first, then) && supporters.get(&then) != Some(&first);
            if !is_in_order || of(first) != of(then) || !is_asked {
                let names = vec![network.label_name(first), network.label_name(then)];
                let message = format!(
                    "{} comes before {}, but the plan's order of changes lacks this pair",
                    names[0], names[1]
                );
                violations.push(Violation::new(Rule::State, message).with_intervals(names));
            }
        }
    }
}

struct StateCheck<'check> {
    checker: &'check Checker<'check>,
    state: &'check State,
    /// The producers in the plan's order.
    order: Vec<Producer>,
}

impl StateCheck<'_> {
    fn violation(&self, message: String, labels: &[LabelId]) -> Violation {
        let names = labels.iter().map(|&label| self.checker.network.label_name(label)).collect();
        Violation::new(Rule::State, message).with_intervals(names)
    }

    fn variable(&self) -> &str {
        &self.checker.network.variables[self.state.variable.index()].name
    }

    /// Returns what a producer does, for people: `Deploy#1 changes ARM`, `Tell(ARM=OUT)#1 says ARM=OUT`.
    fn deed(&self, producer: &Producer) -> String {
        let network = self.checker.network;
        let text = &network.labels[producer.label.index()].text;
        match (producer.is_initial, producer.is_changing) {
            (true, _) => format!("{text} at first"),
            (false, true) => format!("{} changes {}", owner_name(network, producer.label), self.variable()),
            (false, false) => format!("{} keeps {text}", owner_name(network, producer.label)),
        }
    }

    /// Rule 2: neighbors that may overlap give one value; each of them excludes all of the next ones.
    fn check_producers(&self, violations: &mut Vec<Violation>) {
        let network = self.checker.network;
        let runs: Vec<&[Producer]> =
            self.order.chunk_by(|one, other| !one.excludes(other, network)).collect();
        for next in runs.windows(2) {
            let pairs = next[0].iter().flat_map(|earlier| next[1].iter().map(move |later| (earlier, later)));
            for (earlier, later) in pairs {
                if !self.checker.entailment.happens_before(earlier.end, later.start) {
                    let message = format!(
                        "{} must come before {}, but may overlap it: {} while {}",
                        network.label_name(earlier.label),
                        network.label_name(later.label),
                        self.deed(earlier),
                        self.deed(later)
                    );
                    violations.push(self.violation(message, &[earlier.label, later.label]));
                }
            }
        }
    }

    /// Rule 1. That the supporter is ready in time is a constraint of the plan, which holds in every schedule. The last
    /// producer before it that would break the requirement must be over when it is ready, and the first one after it must
    /// wait for the requirement's end; each with those that may overlap it.
    fn check_requirements(&self, supporters: &BTreeMap<LabelId, LabelId>, violations: &mut Vec<Violation>) {
        let network = self.checker.network;
        let places: BTreeMap<LabelId, usize> =
            self.order.iter().zip(0..).map(|(producer, place)| (producer.label, place)).collect();
        for requirement in &self.state.requirements {
            let own = supporters.get(&requirement.label).and_then(|tell| places.get(tell));
            let Some(&own) = own else { continue };
            let entailment = &self.checker.entailment;
            let ready = self.order[own].ready;
            for producer in self.nearest_threats(requirement, self.order[..own].iter().rev()) {
                if !entailment.happens_before(producer.end, ready) {
                    let message = format!(
                        "{} must come before {}, but may overlap it when {} needs it",
                        network.label_name(producer.label),
                        network.label_name(self.order[own].label),
                        owner_name(network, requirement.label)
                    );
                    violations.push(self.violation(message, &[producer.label, requirement.label]));
                }
            }
            for producer in self.nearest_threats(requirement, self.order[own + 1..].iter()) {
                if !entailment.happens_before(requirement.end, producer.start) {
                    violations.push(self.overlap(requirement, producer));
                }
            }
        }
    }

    /// The first of some producers that would break a requirement, with those beside it that may overlap it.
    fn nearest_threats<'order>(
        &self,
        requirement: &Requirement,
        producers: impl Iterator<Item = &'order Producer>,
    ) -> Vec<&'order Producer> {
        let network = self.checker.network;
        let mut threats = producers.skip_while(|producer| !producer.threatens(requirement, network));
        let Some(first) = threats.next() else { return Vec::new() };
        let alike = threats.take_while(|producer| !first.excludes(producer, network));
        [first].into_iter().chain(alike).collect()
    }

    fn overlap(&self, requirement: &Requirement, producer: &Producer) -> Violation {
        let network = self.checker.network;
        let message = format!(
            "{} must come before {}, but may overlap it: {} while {} requires {}",
            network.label_name(requirement.label),
            network.label_name(producer.label),
            self.deed(producer),
            owner_name(network, requirement.label),
            network.labels[requirement.label.index()].text
        );
        self.violation(message, &[requirement.label, producer.label])
    }
}
