//! What an event does when it is placed next in an instant, and whether the rules of SPEC 10.2, 10.3 and 11 let it.

use std::collections::BTreeSet;

use tpn::{LabelId, NodeId};

use super::{Instant, Placed, Search, Subject};
use crate::amounts::{ScaledSupply, Taken, list, user_name};
use crate::state::{Producer, owner_name};
use crate::{Rule, departure};

/// Why an event cannot be placed next.
pub(super) struct Refusal {
    pub(super) rule: Rule,
    pub(super) message: String,
    pub(super) intervals: Vec<String>,
}

impl Search<'_> {
    /// Places an event, if what is placed lets it be next.
    pub(super) fn place(&self, instant: &Instant, place: usize, placed: &mut Placed) -> Result<(), Refusal> {
        let node = instant.nodes[place];
        for &subject in &self.subjects[node.index()] {
            match subject {
                Subject::State(index) => {
                    placed.holding[index] = self.change(index, node, placed)?;
                }
                Subject::Resource(index) => match self.shared[index].supply {
                    ScaledSupply::Reusable { capacity } => self.take(index, capacity, node, placed)?,
                    ScaledSupply::Reservoir { least, greatest, level } => {
                        self.move_level(index, [least, greatest, level], node, placed)?;
                    }
                },
            }
        }
        placed.has_come[place] = true;
        Ok(())
    }

    /// Returns what an event does to a state and requires of it; which producers hold after it.
    fn change(&self, index: usize, node: NodeId, placed: &Placed) -> Result<Vec<LabelId>, Refusal> {
        let (network, state) = (self.network(), &self.states[index]);
        let has_started = |start: NodeId| self.is_over(placed, start);
        let has_ended = |end: NodeId| end == node || self.is_over(placed, end);
        let starting = || state.producers.iter().filter(|it| it.start == node);
        for producer in starting() {
            let overlaps = |other: &&Producer| {
                let goes_on = has_started(other.start) && !has_ended(other.end);
                let begins_too = other.start == node && other.end != node && producer.end != node;
                other.label != producer.label && (goes_on || begins_too) && other.excludes(producer, network)
            };
            if let Some(other) = state.producers.iter().find(overlaps) {
                let names = [other.label, producer.label];
                let message = format!(
                    "{} starts before {} ends",
                    network.label_name(producer.label),
                    network.label_name(other.label)
                );
                return Err(self.refusal(message, &names));
            }
            let breaks = state
                .requirements
                .iter()
                .find(|it| has_started(it.start) && !has_ended(it.end) && producer.threatens(it, network));
            if let Some(requirement) = breaks {
                let names = [requirement.label, producer.label];
                let message = format!(
                    "{} starts before {} ends, which requires {}",
                    network.label_name(producer.label),
                    owner_name(network, requirement.label),
                    network.labels[requirement.label.index()].text
                );
                return Err(self.refusal(message, &names));
            }
        }
        // Before what starts with this event.
        let becomes_ready = |producer: &&Producer| {
            let is_free = |other: &Producer| {
                other.label == producer.label
                    || !has_started(other.start)
                    || has_ended(other.end)
                    || !other.excludes(producer, network)
            };
            producer.ready == node && state.producers.iter().all(is_free)
        };
        let ready = state.producers.iter().filter(becomes_ready).map(|it| it.label);
        let holding: BTreeSet<LabelId> = placed.holding[index].iter().copied().chain(ready).collect();
        let producers = || state.producers.iter().filter(|it| holding.contains(&it.label));
        for moving in starting().filter(|it| self.movements.contains(&it.label)) {
            self.check_departure(moving, producers())?;
        }
        let ends_it = |holding: &Producer| {
            starting().any(|it| {
                let is_touching = it.end == node && holding.ready == node;
                it.label != holding.label && it.excludes(holding, network) && !is_touching
            })
        };
        let later: Vec<&Producer> = producers().filter(|it| !ends_it(it)).collect();
        for requirement in state.requirements.iter().filter(|it| it.start == node) {
            let holds = |it: &&Producer| it.supports(requirement, network);
            let is_met = if requirement.end == node {
                producers().any(|it| holds(&it))
            } else {
                later.iter().any(holds)
            };
            if !is_met {
                let message = format!(
                    "{} requires {}, which does not hold then",
                    owner_name(network, requirement.label),
                    network.labels[requirement.label.index()].text
                );
                return Err(self.refusal(message, &[requirement.label]));
            }
        }
        Ok(later.into_iter().map(|it| it.label).collect())
    }

    /// A movement takes as long as it does from where a producer right before it leaves the vehicle.
    fn check_departure<'state>(
        &self,
        moving: &Producer,
        before: impl Iterator<Item = &'state Producer>,
    ) -> Result<(), Refusal> {
        let time = |node: NodeId| self.schedule.time(node);
        let duration = time(moving.end).checked_sub(time(moving.start));
        let before: Vec<LabelId> = before.map(|it| it.label).filter(|&it| it != moving.label).collect();
        let has_time = |&before: &LabelId| {
            let known = departure::known(self.network(), moving.label, before);
            known.is_none_or(|known| known.least.is_some() && duration >= known.least)
        };
        if before.is_empty() || before.iter().any(has_time) {
            return Ok(());
        }
        let name = |label: LabelId| self.network().label_name(label);
        let message = format!(
            "{} starts too early to drive there from the end of {}",
            name(moving.label),
            name(before[0])
        );
        Err(self.refusal(message, &[moving.label, before[0]]))
    }

    /// An event begins uses of a reusable resource, or is one.
    fn take(&self, index: usize, capacity: i128, node: NodeId, placed: &Placed) -> Result<(), Refusal> {
        let shared = &self.shared[index];
        let goes_on =
            |it: &&Taken| self.is_over(placed, it.start) && it.end != node && !self.is_over(placed, it.end);
        let running: Vec<Taken> = shared.uses.iter().filter(goes_on).copied().collect();
        let starting = || shared.uses.iter().filter(|it| it.start == node);
        // What is one event counts beside what continues, and each for itself.
        let momentary = starting().filter(|it| it.end == node && !running.is_empty());
        let lasting: Vec<Taken> = starting().filter(|it| it.end != node).copied().collect();
        let beside = momentary.map(|it| vec![*it]).chain([lasting]).filter(|it| !it.is_empty());
        for more in beside {
            let together: Vec<Taken> = running.iter().chain(&more).copied().collect();
            let sum: i128 = together.iter().map(|it| it.amount).sum();
            if sum > capacity {
                let message = format!(
                    "{} use {} together: {} of {}",
                    list(self.network(), shared, &together),
                    shared.name(self.network()),
                    shared.show(sum),
                    shared.show(capacity)
                );
                return Err(self.refusal_of_uses(message, &together));
            }
        }
        Ok(())
    }

    /// An event changes the level of a reservoir.
    fn move_level(
        &self,
        index: usize,
        [least, greatest, level]: [i128; 3],
        node: NodeId,
        placed: &Placed,
    ) -> Result<(), Refusal> {
        let shared = &self.shared[index];
        let add = |[low, high]: [i128; 2], [less, more]: [i128; 2]| [low + less, high + more];
        let happened = shared.uses.iter().filter(|it| self.is_over(placed, it.moment()));
        let before = happened.map(Taken::changes).fold([level; 2], add);
        let happening = shared.uses.iter().filter(|it| it.moment() == node);
        let after = happening.map(Taken::changes).fold(before, add);
        for condition in shared.uses.iter().filter(|it| it.level.is_some()) {
            let has_started = condition.start == node || self.is_over(placed, condition.start);
            let is_momentary = condition.start == condition.end;
            let is_asked = if is_momentary {
                condition.start == node
            } else {
                has_started && !self.is_over(placed, condition.end)
            };
            let level = (if is_momentary { before } else { after })[usize::from(condition.is_production)];
            if is_asked && !condition.allows(level) {
                let network = self.network();
                let message = format!(
                    "{} requires {}, but the level is {} then",
                    user_name(network, condition.used),
                    network.uses[condition.used.index()].level_text(&network.resources).unwrap_or_default(),
                    shared.show(level)
                );
                return Err(self.refusal_of_uses(message, &[*condition]));
            }
        }
        let [low, high] = after;
        let (level, wrong) = if low < least {
            (low, format!("below {}", shared.show(least)))
        } else if high > greatest {
            (high, format!("above {}", shared.show(greatest)))
        } else {
            return Ok(());
        };
        let own: Vec<Taken> = shared.uses.iter().filter(|it| it.moment() == node).copied().collect();
        let message = format!(
            "{} would be at {}, {wrong}, after {}",
            shared.name(self.network()),
            shared.show(level),
            list(self.network(), shared, &own)
        );
        Err(self.refusal_of_uses(message, &own))
    }

    fn refusal(&self, message: String, labels: &[LabelId]) -> Refusal {
        let intervals = labels.iter().map(|&label| self.network().label_name(label)).collect();
        Refusal { rule: Rule::State, message, intervals }
    }

    fn refusal_of_uses(&self, message: String, uses: &[Taken]) -> Refusal {
        let intervals = uses.iter().map(|it| self.network().use_name(it.used)).collect();
        Refusal { rule: Rule::Resource, message, intervals }
    }
}
