//! How far a resource is used over time (SPEC 11): a line of steps for the earliest schedule, who takes it when, and how
//! far it is used in any schedule of the plan.

use exact::Rational;
use rmpl::program::Change;
use smol_str::{SmolStr, format_smolstr};
use tpn::{LevelCondition, Levels, Network, NodeId, OccurrenceId, Plan, Resource, Supply, UseId};

use super::row::{Item, ProfilePart, RowKind, times};

/// How many rows a profile is high that has levels to tell apart.
const PROFILE_ROWS: usize = 3;

/// The use of one resource over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pub name: SmolStr,
    /// Its number among the resources of the network.
    pub(super) resource: usize,
    /// How much of it there is.
    pub supply: Supply,
    /// How far it is used over all schedules; `None` where the plan does not say.
    pub levels: Option<Levels>,
    /// Who takes of it or gives to it, in textual order.
    pub takers: Vec<Taker>,
    /// From each step's time on, its level is used or left in the earliest schedule; times ascend.
    pub steps: Vec<Step>,
}

/// An activity or a block that takes of a resource or gives to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Taker {
    pub used: UseId,
    /// Whose, if it has a name.
    pub occurrence: Option<OccurrenceId>,
    pub name: SmolStr,
    pub change: Change,
    /// What is counted: of a drive the most that it takes, or the least that it gives.
    pub amount: Rational,
    /// What it asks of the level, if it changes nothing.
    pub level: Option<LevelCondition>,
    /// Its first and its last event.
    pub events: [NodeId; 2],
    /// Its start and end in the earliest schedule, in mission units.
    pub span: [f64; 2],
}

/// A level from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    pub time: f64,
    /// What is used of a reusable resource, or left in a reservoir.
    pub level: Rational,
}

/// Returns whether a resource has a name in the text; the one that keeps the parts of an `unordered` block apart has
/// not.
pub fn is_named(resource: &Resource) -> bool {
    !resource.name.contains('#')
}

/// The profiles of a plan, one for each resource with a name, in the network's order.
pub(super) fn profiles(network: &Network, plan: &Plan) -> Vec<Profile> {
    let named = network.resources.iter().enumerate().filter(|(_, resource)| is_named(resource));
    named.map(|(index, resource)| Profile::new(network, plan, index, resource)).collect()
}

/// The rows of a profile of this number.
pub(super) fn items(number: usize, profile: &Profile) -> Vec<Item> {
    let row = |part| Item {
        kind: RowKind::Profile(ProfilePart { profile: number, part }),
        name: if part == 0 { profile.name.clone() } else { SmolStr::default() },
        key: None,
        depth: 1,
        bars: Vec::new(),
    };
    (0..profile.num_rows()).map(row).collect()
}

impl Profile {
    fn new(network: &Network, plan: &Plan, index: usize, resource: &Resource) -> Self {
        let uses = network.uses.iter().enumerate().filter(|(_, used)| {
            used.resource.index() == index && plan.selected_arcs.get(used.arc.index()) == Some(&true)
        });
        let takers = uses.filter_map(|(at, used)| {
            let events = [used.start, used.end];
            let owner = used.owner.and_then(|owner| network.occurrences.get(owner.index()));
            Some(Taker {
                used: UseId::from_index(at),
                occurrence: used.owner,
                name: owner.map_or_else(
                    || SmolStr::new_static("a block"),
                    |owner| network.readable(&owner.name).into(),
                ),
                change: used.change,
                amount: used.counted(),
                level: used.level,
                events,
                span: earliest(plan, events)?,
            })
        });
        let mut profile = Self {
            name: resource.name.clone(),
            resource: index,
            supply: resource.supply,
            levels: plan.levels.get(index).copied(),
            takers: takers.collect(),
            steps: Vec::new(),
        };
        profile.steps = profile.steps();
        profile
    }

    /// Puts it to the windows of `plan`, which selects the same.
    pub(super) fn retime(&mut self, plan: &Plan) {
        for taker in &mut self.takers {
            if let Some(span) = earliest(plan, taker.events) {
                taker.span = span;
            }
        }
        self.steps = self.steps();
    }

    /// Returns how many rows it is high: one where the resource is only in use or not.
    pub fn num_rows(&self) -> usize {
        match self.supply {
            Supply::Reusable { capacity } if capacity <= Rational::ONE => 1,
            _ => PROFILE_ROWS,
        }
    }

    /// Returns what is used or left at a time of the earliest schedule.
    pub fn level_at(&self, time: f64) -> Rational {
        let after = self.steps.partition_point(|step| step.time <= time);
        after.checked_sub(1).map_or_else(|| self.supply.initial_level(), |at| self.steps[at].level)
    }

    /// Returns who takes of it or gives to it while this time of the earliest schedule passes.
    pub fn takers_at(&self, time: f64) -> impl Iterator<Item = &Taker> {
        self.takers.iter().filter(move |taker| taker.span[0] <= time && time < taker.span[1])
    }

    /// The numbers that the drawing reaches from and to: what is possible, and all levels.
    pub fn range(&self) -> [Rational; 2] {
        let [low, high] = match self.supply {
            Supply::Reusable { capacity } => [Rational::ZERO, capacity],
            Supply::Reservoir { least, greatest, .. } => [least, greatest],
        };
        let of_plan = match self.levels {
            Some(Levels::Peak(peak)) => [peak, peak],
            Some(Levels::Range { low, high }) => [low, high],
            None => [self.supply.initial_level(), self.supply.initial_level()],
        };
        let asked = self.conditions().map(|(_, condition)| condition.bound);
        let levels = self.steps.iter().map(|step| step.level).chain(of_plan).chain(asked);
        levels.fold([low, high], |[low, high], level| [low.min(level), high.max(level)])
    }

    /// Returns what is asked of its level, and by whom.
    pub fn conditions(&self) -> impl Iterator<Item = (&Taker, LevelCondition)> {
        self.takers.iter().filter_map(|taker| Some((taker, taker.level?)))
    }

    /// The plan's extremes over all schedules, and what they leave, as two short lines.
    pub fn summary(&self) -> [SmolStr; 2] {
        match (self.supply, self.levels) {
            (Supply::Reusable { capacity }, Some(Levels::Peak(peak))) => {
                let spare = capacity.checked_sub(peak).filter(|spare| spare.is_positive());
                [
                    format_smolstr!("peak {} of {}", peak.readable(), capacity.readable()),
                    spare.map_or_else(
                        || SmolStr::new_static("none to spare"),
                        |spare| format_smolstr!("{} to spare", spare.readable()),
                    ),
                ]
            }
            (Supply::Reservoir { least, greatest, .. }, Some(Levels::Range { low, high })) => [
                format_smolstr!("from {} to {}", low.readable(), high.readable()),
                format_smolstr!("allowed {} to {}", least.readable(), greatest.readable()),
            ],
            (Supply::Reusable { capacity }, _) => {
                [format_smolstr!("capacity {}", capacity.readable()), SmolStr::default()]
            }
            (Supply::Reservoir { least, greatest, .. }, _) => [
                format_smolstr!("allowed {} to {}", least.readable(), greatest.readable()),
                SmolStr::default(),
            ],
        }
    }

    /// Its level at a time and who takes of it then, in lines.
    pub fn words(&self, time: f64) -> Vec<String> {
        let level = self.level_at(time).readable();
        let first = match self.supply {
            Supply::Reusable { capacity } => format!("{level} of {} used", capacity.readable()),
            Supply::Reservoir { .. } => format!("level {level}"),
        };
        let mut lines = vec![first];
        lines.extend(self.takers_at(time).map(Taker::words));
        lines
    }

    /// The levels of the earliest schedule, as far as they can be added exactly.
    fn steps(&self) -> Vec<Step> {
        let mut changes: Vec<(f64, bool, Rational)> = Vec::new();
        for taker in self.takers.iter().filter(|taker| taker.level.is_none()) {
            let (start, end) = (taker.span[0], taker.span[1]);
            let less = taker.amount.checked_neg().unwrap_or_default();
            match taker.change {
                // What ends at an instant is over before what starts there begins.
                Change::Uses if start < end => {
                    changes.extend([(start, true, taker.amount), (end, false, less)]);
                }
                Change::Uses => {}
                Change::Consumes => changes.push((start, true, less)),
                Change::Produces => changes.push((end, false, taker.amount)),
            }
        }
        changes.sort_by(|left, right| left.0.total_cmp(&right.0).then(left.1.cmp(&right.1)));
        let mut steps: Vec<Step> = Vec::new();
        let mut level = self.supply.initial_level();
        for (time, _, change) in changes {
            let Some(changed) = level.checked_add(change) else { break };
            level = changed;
            match steps.last_mut().filter(|last| last.time >= time) {
                Some(last) => last.level = level,
                None => steps.push(Step { time, level }),
            }
        }
        steps
    }
}

impl Taker {
    /// Returns what it does, in words.
    pub fn words(&self) -> String {
        let amount = self.amount.readable();
        if let Some(LevelCondition { order, bound }) = self.level {
            return format!("{} requires {} {}", self.name, order.symbol(), bound.readable());
        }
        match self.change {
            Change::Uses => format!("{} uses {amount}", self.name),
            Change::Consumes => format!("{} consumes {amount} at start", self.name),
            Change::Produces => format!("{} produces {amount} at end", self.name),
        }
    }
}

fn earliest(plan: &Plan, events: [NodeId; 2]) -> Option<[f64; 2]> {
    times(plan, events).map(|[start, end]| [start[0], end[0]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taker(name: &str, change: Change, amount: i64, span: [f64; 2]) -> Taker {
        Taker {
            used: UseId(0),
            occurrence: None,
            name: name.into(),
            change,
            amount: amount.into(),
            level: None,
            events: [NodeId(0); 2],
            span,
        }
    }

    #[test]
    fn a_condition_on_a_level_moves_nothing_and_is_told() {
        let condition = LevelCondition { order: rmpl::program::Order::AtLeast, bound: 12.into() };
        let asking = Taker { level: Some(condition), ..taker("Survey#1", Change::Consumes, 0, [2.0, 6.0]) };
        let supply = Supply::Reservoir { least: 0.into(), greatest: 10.into(), level: 8.into() };
        let profile = profile(supply, None, vec![asking, taker("Drive#1", Change::Consumes, 3, [1.0, 4.0])]);
        assert_eq!(profile.steps, [Step { time: 1.0, level: 5.into() }]);
        assert_eq!(profile.range(), [0.into(), 12.into()]);
        assert_eq!(profile.words(3.0)[1], "Survey#1 requires >= 12");
        assert_eq!(profile.conditions().count(), 1);
    }

    fn profile(supply: Supply, levels: Option<Levels>, takers: Vec<Taker>) -> Profile {
        let mut profile =
            Profile { name: "R".into(), resource: 0, supply, levels, takers, steps: Vec::new() };
        profile.steps = profile.steps();
        profile
    }

    fn levels(profile: &Profile) -> Vec<(f64, i64)> {
        profile.steps.iter().map(|step| (step.time, step.level.floor())).collect()
    }

    #[test]
    fn what_ends_where_another_begins_does_not_overlap_it() {
        let supply = Supply::Reusable { capacity: 3.into() };
        let takers = vec![
            taker("A", Change::Uses, 2, [0.0, 5.0]),
            taker("B", Change::Uses, 2, [5.0, 9.0]),
            taker("C", Change::Uses, 1, [3.0, 7.0]),
            taker("D", Change::Uses, 3, [4.0, 4.0]),
        ];
        let profile = profile(supply, Some(Levels::Peak(3.into())), takers);
        assert_eq!(levels(&profile), [(0.0, 2), (3.0, 3), (5.0, 3), (7.0, 2), (9.0, 0)]);
        let names: Vec<&str> = profile.takers_at(5.0).map(|taker| taker.name.as_str()).collect();
        assert_eq!(names, ["B", "C"]);
        assert_eq!(profile.summary(), ["peak 3 of 3", "none to spare"]);
        assert_eq!(profile.words(6.0), ["3 of 3 used", "B uses 2", "C uses 1"]);
        assert_eq!(profile.range(), [0.into(), 3.into()]);
    }

    #[test]
    fn a_reservoir_falls_where_a_consumer_starts_and_rises_where_a_producer_ends() {
        let supply = Supply::Reservoir { least: 0.into(), greatest: 100.into(), level: 60.into() };
        let takers = vec![
            taker("Drive#1", Change::Consumes, 50, [2.0, 8.0]),
            taker("Charge#1", Change::Produces, 70, [8.0, 20.0]),
            taker("Drive#2", Change::Consumes, 50, [20.0, 30.0]),
        ];
        let range = Levels::Range { low: 10.into(), high: 80.into() };
        let profile = profile(supply, Some(range), takers);
        assert_eq!(levels(&profile), [(2.0, 10), (20.0, 30)], "at one instant both happen");
        assert_eq!(profile.level_at(1.0), 60.into());
        assert_eq!(profile.words(10.0), ["level 10", "Charge#1 produces 70 at end"]);
        assert_eq!(profile.summary(), ["from 10 to 80", "allowed 0 to 100"]);
    }
}
