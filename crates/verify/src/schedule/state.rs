//! State that lasts in a schedule (SPEC 10.2): what rules 1 and 2 and movements forbid whatever the order within instants.

use exact::{Bound, Time};
use tpn::LabelId;

use super::Schedule;
use crate::departure;
use crate::state::{self, Producer, Requirement, State, owner_name};
use crate::{Rule, Violation};

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
                let message =
                    format!("{} starts too early to drive there from the end of {}", names[0], names[1]);
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
                    "{} and {} both set {variable} at {}",
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
        for requirement in &state.requirements {
            let threats = state.producers.iter().filter(|it| {
                it.threatens(requirement, self.network) && self.time(it.start) < self.time(requirement.end)
            });
            let mut latest = [None; 2];
            for threat in threats {
                let end = Some((self.time(threat.end), threat.label));
                if end > latest[0] {
                    latest = [end, latest[0]];
                } else if end > latest[1] {
                    latest[1] = end;
                }
            }
            if !state.producers.iter().any(|it| self.may_support(it, requirement, latest)) {
                violations.push(self.unsupported(requirement, latest[0].map(|(_, label)| label)));
            }
        }
    }

    /// Returns whether a producer makes a requirement hold in some order of each instant: what threatens the
    /// requirement and starts before it ends comes before the producer. `latest` are the threats with the latest two
    /// ends.
    fn may_support(
        &self,
        producer: &Producer,
        requirement: &Requirement,
        latest: [Option<(Time, LabelId)>; 2],
    ) -> bool {
        let is_ready = self.time(producer.ready) <= self.time(requirement.start);
        let other = latest.into_iter().flatten().find(|&(_, label)| label != producer.label);
        is_ready
            && producer.supports(requirement, self.network)
            && other.is_none_or(|(end, _)| end <= self.time(producer.start))
    }

    fn unsupported(&self, requirement: &Requirement, threat: Option<LabelId>) -> Violation {
        let network = self.network;
        let text = &network.labels[requirement.label.index()].text;
        let [from, to] = [requirement.start, requirement.end].map(|node| Bound::Finite(self.time(node)));
        let mut names = vec![network.label_name(requirement.label)];
        let reason = match threat {
            Some(threat) => {
                names.push(network.label_name(threat));
                format!("{} contradicts it", names[1])
            }
            None => "nothing supports it".to_owned(),
        };
        let owner = owner_name(network, requirement.label);
        let message = format!("{owner} requires {text} from {from} to {to}, and {reason}");
        Violation::new(Rule::State, message).with_intervals(names)
    }
}
