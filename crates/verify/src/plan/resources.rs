//! The check of resources (SPEC 11): no schedule of the plan uses more than there is, and the plan tells how much.

use tpn::{Levels, Network, NodeId, Plan};

use super::Checker;
use crate::amounts::{ScaledSupply, Shared, Taken, is_selected, list, user_name};
use crate::antichain::heaviest_antichain;
use crate::entailment::{Precedence, Span};
use crate::{Rule, Violation};

/// Orderings of uses join two selected uses of one resource.
pub(super) fn check_use_orderings(network: &Network, plan: &Plan, violations: &mut Vec<Violation>) {
    for ordering in &plan.uses_ordered {
        let [first, then] = [ordering.first, ordering.then];
        let names = vec![network.use_name(first), network.use_name(then)];
        let is_of_one = network.uses[first.index()].resource == network.uses[then.index()].resource;
        let wrong = if first == then {
            "a resource use cannot be ordered with itself"
        } else if !is_of_one {
            "an ordering must join uses of the same resource"
        } else if !is_selected(network, plan, first) || !is_selected(network, plan, then) {
            "an ordering joins resource uses that the plan does not select"
        } else {
            continue;
        };
        let message = format!("{wrong}: {} and {}", names[0], names[1]);
        violations.push(Violation::new(Rule::Resource, message).with_intervals(names));
    }
}

/// A condition on a level (SPEC 17) that some schedule does not keep.
struct Broken {
    condition: Taken,
    /// The level that it may meet.
    level: i128,
    /// What takes the level there; nothing of what holds before the start.
    by: Option<Taken>,
}

impl Checker<'_> {
    /// The criteria of SPEC 11 for every resource, and what the plan says of them.
    ///
    /// Amounts are the network's alone: once paths are inserted, they include what is counted per metre, with the minimum and
    /// the maximum that drives along these paths take. The worst case takes whichever is worse for the level.
    pub(super) fn check_resources(&self, violations: &mut Vec<Violation>) {
        let network = self.network;
        let Some(all) = Shared::all(network, self.plan) else {
            let message =
                "the amounts are too large, or their denominators too different, to be added exactly";
            violations.push(Violation::new(Rule::Form, message));
            return;
        };
        if self.plan.levels.len() != all.len() {
            let message = format!(
                "the plan lists {} resources, but the mission has {}",
                self.plan.levels.len(),
                all.len()
            );
            violations.push(Violation::new(Rule::Resource, message));
        }
        for shared in &all {
            let backward = shared.uses.iter().map(|it| Span { start: it.start, end: it.end });
            if let Some(span) = backward.into_iter().find(|span| !self.is_forward(*span)) {
                violations.push(self.backward(span));
                continue;
            }
            let levels = match shared.supply {
                ScaledSupply::Reusable { capacity } => self.check_reusable(shared, capacity, violations),
                ScaledSupply::Reservoir { least, greatest, level } => {
                    self.check_reservoir(shared, [least, greatest, level], violations)
                }
            };
            self.check_levels(shared, levels, violations);
        }
    }

    fn violation_of(&self, message: String, uses: &[Taken]) -> Violation {
        let names = uses.iter().map(|it| self.network.use_name(it.used)).collect();
        Violation::new(Rule::Resource, message).with_intervals(names)
    }

    /// The greatest amount of uses of which no two are ordered (Policella et al. 2004). Returns it.
    fn check_reusable(
        &self,
        shared: &Shared,
        capacity: i128,
        violations: &mut Vec<Violation>,
    ) -> Option<Levels> {
        let spans: Vec<Span> = shared.uses.iter().map(|it| Span { start: it.start, end: it.end }).collect();
        let weights: Vec<i128> = shared.uses.iter().map(|it| it.amount).collect();
        let (peak, together) = heaviest_antichain(&weights, &Precedence::new(&self.entailment, &spans));
        if peak > capacity {
            let mut together: Vec<Taken> = together.into_iter().map(|index| shared.uses[index]).collect();
            together.sort_by_key(|it| it.used);
            let message = format!(
                "{} may use {} at the same time: {} of {}",
                list(self.network, shared, &together),
                shared.name(self.network),
                shared.show(peak),
                shared.show(capacity)
            );
            violations.push(self.violation_of(message, &together));
        }
        shared.unscaled(peak).map(Levels::Peak)
    }

    /// The least level after each consumption and the greatest after each production (Laborie 2003). Returns the least
    /// and the greatest of them and of the level at the start.
    fn check_reservoir(
        &self,
        shared: &Shared,
        [least, greatest, level]: [i128; 3],
        violations: &mut Vec<Violation>,
    ) -> Option<Levels> {
        let (conditions, changes): (Vec<Taken>, Vec<Taken>) =
            shared.uses.iter().copied().partition(|it| it.level.is_some());
        let alone = |event: NodeId| Span { start: event, end: event };
        let moments = changes.iter().chain(&conditions).map(|it| alone(it.moment()));
        let spans: Vec<Span> = moments.chain(conditions.iter().map(|it| alone(it.end))).collect();
        let order = Precedence::new(&self.entailment, &spans);
        // The worst case after an event counts all that may have happened in its own direction, and of the other direction
        // only what must have.
        let worst = |index: usize, is_production: bool, left_out: Option<NodeId>| {
            let mut reached = level;
            for (other, another) in changes.iter().enumerate() {
                let happens_before = other == index || order.is_before(other, index);
                let happens_after = other == index || order.is_before(index, other);
                let is_counted = if left_out == Some(another.moment()) {
                    false
                } else if another.is_production == is_production {
                    !happens_after || happens_before
                } else {
                    happens_before
                };
                if is_counted {
                    let [least, most] = another.changes();
                    reached += if is_production { most } else { least };
                }
            }
            reached
        };
        let after: Vec<i128> = (changes.iter().enumerate())
            .map(|(index, event)| worst(index, event.is_production, None))
            .collect();
        let broken = (conditions.iter().enumerate()).filter_map(|(number, &condition)| {
            let (start, end) = (changes.len() + number, changes.len() + conditions.len() + number);
            if condition.start == condition.end {
                // Just before its event: what happens at that comes later.
                let before = worst(start, condition.is_production, Some(condition.start));
                let is_broken = !condition.allows(before);
                return is_broken.then_some(Broken { condition, level: before, by: None });
            }
            let is_broken = |&index: &usize| {
                let (event, moment) = (&changes[index], changes[index].moment());
                let is_over = moment != condition.start && order.is_before(index, start);
                let is_later = moment != condition.end && order.is_before(end, index);
                event.is_production == condition.is_production
                    && !is_over
                    && !is_later
                    && !condition.allows(after[index])
            };
            let by = (0..changes.len()).find(is_broken)?;
            Some(Broken { condition, level: after[by], by: Some(changes[by]) })
        });
        violations.extend(broken.map(|broken| self.broken_condition(shared, &broken)));
        self.check_range(shared, changes.into_iter().zip(after), [least, greatest, level], violations)
    }

    /// The levels after changes stay in the range. Returns the least and the greatest of them and of the level at the start.
    fn check_range(
        &self,
        shared: &Shared,
        changes: impl Iterator<Item = (Taken, i128)>,
        [least, greatest, level]: [i128; 3],
        violations: &mut Vec<Violation>,
    ) -> Option<Levels> {
        let (mut low, mut high) = (level, level);
        for (event, reached) in changes {
            let name = shared.name(self.network);
            let user = user_name(self.network, event.used);
            if event.is_production {
                high = high.max(reached);
                if reached > greatest {
                    let message = format!(
                        "when {user} has produced {}, {name} may reach {}, but its maximum is {}",
                        shared.show_amount(&event),
                        shared.show(reached),
                        shared.show(greatest)
                    );
                    violations.push(self.violation_of(message, &[event]));
                }
            } else {
                low = low.min(reached);
                if reached < least {
                    let message = format!(
                        "when {user} consumes {}, {name} may fall to {}, but its minimum is {}",
                        shared.show_amount(&event),
                        shared.show(reached),
                        shared.show(least)
                    );
                    violations.push(self.violation_of(message, &[event]));
                }
            }
        }
        Some(Levels::Range { low: shared.unscaled(low)?, high: shared.unscaled(high)? })
    }

    fn broken_condition(&self, shared: &Shared, broken: &Broken) -> Violation {
        let Broken { condition, level, by } = broken;
        let requires = self.network.uses[condition.used.index()].level_text(&self.network.resources);
        let when = by.map_or_else(
            || "at its start".to_owned(),
            |by| format!("after {}", user_name(self.network, by.used)),
        );
        let message = format!(
            "{} requires {}, but the level may be {} {when}",
            user_name(self.network, condition.used),
            requires.unwrap_or_default(),
            shared.show(*level)
        );
        self.violation_of(message, &[*condition])
    }

    fn check_levels(&self, shared: &Shared, levels: Option<Levels>, violations: &mut Vec<Violation>) {
        let stated = self.plan.levels.get(shared.resource.index()).copied();
        if stated.is_none() || stated == levels {
            return;
        }
        let message = format!(
            "the plan says that {} {}, but it {}",
            shared.name(self.network),
            show(stated),
            show(levels)
        );
        violations.push(Violation::new(Rule::Resource, message));
    }
}

fn show(levels: Option<Levels>) -> String {
    match levels {
        Some(Levels::Peak(peak)) => format!("is used up to {peak} at a time"),
        Some(Levels::Range { low, high }) => format!("stays within {low} and {high}"),
        None => "exceeds what can be represented exactly".to_owned(),
    }
}
