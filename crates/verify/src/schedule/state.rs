//! State that lasts in a schedule (SPEC 10.2): rules 1 and 2 with every time known.
//!
//! Only producers without length that happen at one instant leave their order open; the schedule is accepted if some
//! order of them keeps every rule.

use std::collections::{BTreeMap, BTreeSet};

use exact::{Bound, Time};
use tpn::LabelId;

use super::Schedule;
use crate::departure;
use crate::state::{self, Producer, Requirement, State, owner_name};
use crate::{Rule, Violation};

/// How a producer can carry a requirement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Support {
    No,
    /// It does, however ties are decided.
    Always,
    /// It does if it is the last of the producers of its instant.
    IfLast,
}

impl Schedule<'_> {
    pub(super) fn check_states(&self, violations: &mut Vec<Violation>) {
        for state in state::selected(self.network, self.plan) {
            self.check_changes(&state, violations);
            self.check_requirements(&state, violations);
            self.check_departures(&state, violations);
        }
    }

    /// Movements take as long as they do from where a producer leaves the vehicle that may be the last one before them.
    fn check_departures(&self, state: &State, violations: &mut Vec<Violation>) {
        let arrivals = departure::arrivals(self.network, self.plan);
        for moving in state.producers.iter().filter(|it| arrivals.contains(&it.label)) {
            let start = self.time(moving.start);
            let precedes = |one: &Producer, other: &Producer| {
                one.is_initial || self.time(one.end) <= self.time(other.start)
            };
            let earlier: Vec<&Producer> = (state.producers.iter())
                .filter(|it| it.label != moving.label && precedes(it, moving))
                .collect();
            // What has no length may be on either side of what happens at its instant.
            let may_be_last = |one: &&&Producer| {
                earlier.iter().all(|other| {
                    let is_later = precedes(one, other) && !precedes(other, one);
                    let is_instant = self.time(other.start) == start && self.time(moving.end) == start;
                    other.label == one.label || !is_later || is_instant
                })
            };
            let duration = self.time(moving.end).checked_sub(start);
            let has_time = |before: &&Producer| {
                let known = departure::known(self.network, moving.label, before.label);
                known.is_none_or(|known| known.least.is_some() && duration >= known.least)
            };
            let candidates: Vec<&Producer> = earlier.iter().filter(may_be_last).copied().collect();
            if !candidates.is_empty() && !candidates.iter().any(has_time) {
                let mut names = vec![self.network.label_name(moving.label)];
                names.extend(candidates.iter().map(|it| self.network.label_name(it.label)));
                let message = format!("{} has not the time it takes from where {} ends", names[0], names[1]);
                violations.push(Violation::new(Rule::State, message).with_intervals(names));
            }
        }
    }

    /// Rule 2: of two producers that exclude each other one ends no later than the other starts.
    fn check_changes(&self, state: &State, violations: &mut Vec<Violation>) {
        let mut producers: Vec<&Producer> = state.producers.iter().collect();
        producers.sort_by_key(|it| (self.time(it.start), self.time(it.end), it.label));
        for (position, earlier) in producers.iter().enumerate() {
            let end = self.time(earlier.end);
            // What starts later than this ends starts even later from here on.
            let overlapping =
                producers[position + 1..].iter().take_while(|later| self.time(later.start) < end);
            for later in overlapping.filter(|later| later.excludes(earlier, self.network)) {
                let names = [earlier.label, later.label].map(|label| self.network.label_name(label));
                let variable = &self.network.variables[state.variable.index()].name;
                let message = format!(
                    "{} and {} are both about {variable} at {}",
                    names[0],
                    names[1],
                    Bound::Finite(self.time(later.start))
                );
                violations.push(Violation::new(Rule::State, message).with_intervals(names.to_vec()));
            }
        }
    }

    /// Rule 1: each requirement has a producer that makes it hold from its start to its end.
    fn check_requirements(&self, state: &State, violations: &mut Vec<Violation>) {
        // By instant: which producers may be the last of it, for each requirement that rests on it.
        let mut last: BTreeMap<Time, Vec<(LabelId, BTreeSet<LabelId>)>> = BTreeMap::new();
        for requirement in &state.requirements {
            let threats: Vec<&Producer> = (state.producers.iter())
                .filter(|it| {
                    it.threatens(requirement, self.network)
                        && self.time(it.start) < self.time(requirement.end)
                })
                .collect();
            let mut latest = [None; 2];
            for threat in &threats {
                let end = Some((self.time(threat.end), threat.label));
                if end > latest[0] {
                    latest = [end, latest[0]];
                } else if end > latest[1] {
                    latest[1] = end;
                }
            }
            let supports: Vec<(&Producer, Support)> = (state.producers.iter())
                .map(|it| (it, self.support(it, requirement, &threats, latest)))
                .filter(|&(_, support)| support != Support::No)
                .collect();
            if supports.iter().any(|&(_, support)| support == Support::Always) {
                continue;
            }
            let candidates: BTreeSet<LabelId> = supports.iter().map(|(it, _)| it.label).collect();
            match supports.first() {
                // All of them are at the last instant at which anything threatens the requirement.
                Some((producer, _)) => {
                    last.entry(self.time(producer.start)).or_default().push((requirement.label, candidates));
                }
                None => violations.push(self.unsupported(requirement, latest[0].map(|(_, label)| label))),
            }
        }
        for (time, requirements) in last {
            let mut common = requirements[0].1.clone();
            for (_, candidates) in &requirements[1..] {
                common.retain(|label| candidates.contains(label));
            }
            if common.is_empty() {
                let labels = requirements.iter().map(|&(label, _)| label);
                let names: Vec<String> = labels.map(|label| self.network.label_name(label)).collect();
                let variable = &self.network.variables[state.variable.index()].name;
                let message = format!(
                    "{} need different last values of {variable} at {}",
                    names.join(" and "),
                    Bound::Finite(time)
                );
                violations.push(Violation::new(Rule::State, message).with_intervals(names));
            }
        }
    }

    /// Whether a producer can carry a requirement: what threatens it and starts before it ends comes before the producer.
    /// `latest` are the threats with the latest two ends.
    fn support(
        &self,
        producer: &Producer,
        requirement: &Requirement,
        threats: &[&Producer],
        latest: [Option<(Time, LabelId)>; 2],
    ) -> Support {
        let is_ready = self.time(producer.ready) <= self.time(requirement.start);
        if !is_ready || !producer.supports(requirement, self.network) {
            return Support::No;
        }
        let start = self.time(producer.start);
        let other = latest.into_iter().flatten().find(|&(_, label)| label != producer.label);
        if other.is_some_and(|(end, _)| end > start) {
            return Support::No;
        }
        // Those at the same instant, without length as the producer itself, may come before or after it.
        let is_tied = |threat: &&Producer| {
            threat.label != producer.label
                && !threat.is_initial
                && self.time(producer.end) <= self.time(threat.start)
                && self.time(threat.end) <= start
        };
        match (threats.iter().any(is_tied), producer.is_initial) {
            (false, _) => Support::Always,
            // The initial value is before all others.
            (true, true) => Support::No,
            (true, false) => Support::IfLast,
        }
    }

    fn unsupported(&self, requirement: &Requirement, threat: Option<LabelId>) -> Violation {
        let network = self.network;
        let text = &network.labels[requirement.label.index()].text;
        let [from, to] = [requirement.start, requirement.end].map(|node| Bound::Finite(self.time(node)));
        let mut names = vec![network.label_name(requirement.label)];
        let reason = match threat {
            Some(threat) => {
                names.push(network.label_name(threat));
                format!("{} stands against it", names[1])
            }
            None => "nothing makes it hold".to_owned(),
        };
        let owner = owner_name(network, requirement.label);
        let message = format!("{owner} requires {text} from {from} to {to}, and {reason}");
        Violation::new(Rule::State, message).with_intervals(names)
    }
}
