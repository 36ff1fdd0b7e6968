//! What the simulated world does that the plan does not decide: how long activities really take, and when conditions
//! really begin and end.

use std::collections::BTreeMap;

use exact::{Overflow, Rational, Time};
use rmpl::program::LabelMode;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use smol_str::SmolStr;
use tpn::{Network, NodeId, Occurrence, OccurrenceKind, ValueId};

/// Something that goes otherwise than planned. Times and durations are in mission units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Disturbance {
    /// An activity takes this long, or another duration that the environment chooses, whatever its bounds say.
    Duration {
        /// The occurrence, such as `Group-Transmit#1`; `delay#1` where the environment chooses that.
        activity: SmolStr,
        duration: Time,
    },
    /// A vehicle drives at a share of its greatest speed: its traverses take longer by that much.
    Slow {
        /// The traverse, such as `Group-Traverse-Path#1`.
        activity: SmolStr,
        /// The share, above 0 and at most 1.
        factor: Rational,
    },
    /// A condition ends at this time, if it holds then; one that has not started by then never does.
    Withdrawn {
        /// The assertion, such as `Tell(PATH1=OK)#1`.
        condition: SmolStr,
        at: Time,
    },
    /// A component of the plant fails, or comes into another mode, while an activity's control program runs.
    Fault {
        /// The activity, such as `Insert#1`.
        activity: SmolStr,
        /// At the end of this step, from 1.
        step: u32,
        component: SmolStr,
        /// The mode it is in from then on.
        mode: SmolStr,
    },
    /// A condition begins no earlier than this.
    Late {
        /// The assertion.
        condition: SmolStr,
        /// When it begins.
        at: Time,
    },
    /// A variable that lasts has another value from a time on, until something changes it. While an activity changes it,
    /// nothing comes of this. A running assertion of another value ends.
    State {
        variable: SmolStr,
        /// One of its values.
        value: SmolStr,
        at: Time,
    },
    /// A reservoir is at another level at a time.
    Level {
        resource: SmolStr,
        /// The level, within the reservoir's range.
        level: Rational,
        at: Time,
    },
    /// Something stands in the world from a time on that is not on the map. Vehicles see it when it is in their range.
    Obstacle {
        at: Time,
        /// Meters east.
        x: f64,
        /// Meters north.
        y: f64,
        /// Meters.
        radius: f64,
        /// Whether it lies below the plane of range finders, so that only sonars hear it.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        low: bool,
    },
    /// A vehicle drives at most at a share of its traverse's greatest speed for a time; at a share of 0 it stands.
    VehicleSlow {
        vehicle: SmolStr,
        /// The share, from 0 to 1.
        factor: Rational,
        from: Time,
        until: Time,
    },
}

impl Disturbance {
    /// The occurrence that it is about, if it is about one.
    pub const fn occurrence(&self) -> Option<&SmolStr> {
        match self {
            Self::Duration { activity, .. } | Self::Slow { activity, .. } | Self::Fault { activity, .. } => {
                Some(activity)
            }
            Self::Withdrawn { condition, .. } | Self::Late { condition, .. } => Some(condition),
            Self::State { .. } | Self::Level { .. } | Self::Obstacle { .. } | Self::VehicleSlow { .. } => {
                None
            }
        }
    }

    /// Returns what is wrong with its numbers, if something is: times and durations are not negative, and shares are
    /// shares.
    pub fn problem(&self) -> Option<&'static str> {
        let is_share = |share: Rational| !share.is_negative() && share <= Rational::ONE;
        match self {
            Self::Duration { duration, .. } if duration.is_negative() => {
                Some("a duration must not be negative")
            }
            Self::Slow { factor, .. } if !is_share(*factor) || factor.is_zero() => {
                Some("the fraction of the maximum speed must be greater than 0 and at most 1")
            }
            Self::VehicleSlow { factor, .. } if !is_share(*factor) => {
                Some("the fraction of the maximum speed must be from 0 to 1")
            }
            Self::VehicleSlow { from, until, .. } if from > until => {
                Some("`until` must not be before `from`")
            }
            _ if self.since().is_some_and(Time::is_negative) => {
                Some("a disturbance cannot happen before the mission starts, at 0")
            }
            Self::Obstacle { radius, .. } if *radius <= 0.0 => {
                Some("the radius of an obstacle must be greater than 0")
            }
            _ => None,
        }
    }

    /// From when on it counts, if it is not about all of an occurrence.
    pub const fn since(&self) -> Option<Time> {
        match self {
            Self::Withdrawn { at, .. }
            | Self::Late { at, .. }
            | Self::State { at, .. }
            | Self::Level { at, .. }
            | Self::Obstacle { at, .. }
            | Self::VehicleSlow { from: at, .. } => Some(*at),
            Self::Duration { .. } | Self::Slow { .. } | Self::Fault { .. } => None,
        }
    }

    /// The vehicle that it is about, if it is about one.
    pub const fn vehicle(&self) -> Option<&SmolStr> {
        match self {
            Self::VehicleSlow { vehicle, .. } => Some(vehicle),
            _ => None,
        }
    }
}

/// What one run of a plan is, as a file holds it: `{"disturbances": […]}`. Other members are not looked at, so that the
/// log of a run can be given as the script of the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Script {
    /// What goes otherwise than planned, in any order; of two of a kind about one thing the later counts.
    #[serde(deserialize_with = "sound")]
    pub disturbances: Vec<Disturbance>,
    /// Whether the environment chooses durations so as to break the plan, and ends of ranges where it cannot.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub adversary: bool,
    /// Seeds what is drawn in the run; otherwise the seed of the paths does. The paths stay those of their own seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run_seed: Option<u64>,
    /// The durations that nature chooses, by occurrence, within their ranges; those that are not listed are drawn.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub nature: BTreeMap<SmolStr, Time>,
    /// A schedule of the plan, by event: the first plan of the run is executed at these times. An activity that has both of
    /// its events here is not driven or run, but takes as long as they say. Events that are not listed come as early as they
    /// may.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub schedule: BTreeMap<SmolStr, Time>,
}

impl Script {
    /// Returns what is wrong with its numbers, if something is.
    pub fn problem(&self) -> Option<&'static str> {
        let times = self.nature.values().chain(self.schedule.values());
        let mut problems = self.disturbances.iter().map(Disturbance::problem);
        let is_before =
            || times.clone().any(|time| time.is_negative()).then_some("a time must not be negative");
        problems.find_map(|problem| problem).or_else(is_before)
    }
}

/// Reads disturbances and refuses those that mean nothing.
fn sound<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Disturbance>, D::Error> {
    let disturbances = Vec::<Disturbance>::deserialize(deserializer)?;
    for (disturbance, number) in disturbances.iter().zip(1..) {
        if let Some(problem) = disturbance.problem() {
            return Err(D::Error::custom(format!("disturbance {number}: {problem}")));
        }
    }
    Ok(disturbances)
}

/// Durations of slow drives are rounded up to whole parts of a unit, so many of which are one.
const SLOW_PARTS: u32 = 60_000;

/// The world of one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    durations: BTreeMap<SmolStr, Time>,
    slow: BTreeMap<SmolStr, Rational>,
    withdrawn: BTreeMap<SmolStr, Time>,
    late: BTreeMap<SmolStr, Time>,
    /// In order of time.
    changes: Vec<WorldChange>,
    /// How long the environment makes things take.
    chosen: BTreeMap<SmolStr, Time>,
    is_adversary: bool,
    /// When the events of the first plan happen.
    schedule: BTreeMap<SmolStr, Time>,
}

/// What the world makes of a variable that lasts or of a reservoir.
#[derive(Clone, Debug, PartialEq)]
pub enum WorldChange {
    /// A variable has this value.
    State { at: Time, variable: SmolStr, value: SmolStr },
    /// A reservoir is at this level.
    Level {
        at: Time,
        /// The reservoir.
        resource: SmolStr,
        level: Rational,
    },
}

impl WorldChange {
    /// When it happens.
    pub const fn at(&self) -> Time {
        match self {
            Self::State { at, .. } | Self::Level { at, .. } => *at,
        }
    }
}

impl World {
    /// A world in which everything else goes as planned. Of two disturbances of a kind of one occurrence the later
    /// counts.
    pub fn new(disturbances: &[Disturbance]) -> Self {
        let mut world = Self::default();
        for disturbance in disturbances {
            match disturbance.clone() {
                Disturbance::Duration { activity, duration } => {
                    world.durations.insert(activity, duration);
                }
                Disturbance::Slow { activity, factor } => {
                    world.slow.insert(activity, factor);
                }
                Disturbance::Withdrawn { condition, at } => {
                    world.withdrawn.insert(condition, at);
                }
                Disturbance::Late { condition, at } => {
                    world.late.insert(condition, at);
                }
                Disturbance::State { variable, value, at } => {
                    world.changes.push(WorldChange::State { at, variable, value });
                }
                Disturbance::Level { resource, level, at } => {
                    world.changes.push(WorldChange::Level { at, resource, level });
                }
                // The simulation of drives takes in what vehicles meet, and that of control programs what components do.
                Disturbance::Obstacle { .. }
                | Disturbance::VehicleSlow { .. }
                | Disturbance::Fault { .. } => {}
            }
        }
        world.changes.sort_by_key(WorldChange::at);
        world
    }

    /// Returns what it makes of states and levels, in order of time.
    pub fn changes(&self) -> &[WorldChange] {
        &self.changes
    }

    /// The same world, in which the environment chooses these durations where it may choose: those of other occurrences
    /// of which it chooses are the least that they may be. What is outside a range is brought inside.
    #[must_use]
    pub fn with_chosen(mut self, chosen: BTreeMap<SmolStr, Time>) -> Self {
        self.chosen = chosen;
        self
    }

    /// The same world, in which the environment makes a plan fail that can be made to: one that is not controllable. Of
    /// others it chooses the durations as it would otherwise.
    #[must_use]
    pub const fn with_adversary(mut self) -> Self {
        self.is_adversary = true;
        self
    }

    /// The same world, in which the first plan is executed by a schedule: see [`Script::schedule`].
    #[must_use]
    pub fn with_schedule(mut self, schedule: BTreeMap<SmolStr, Time>) -> Self {
        self.schedule = schedule;
        self
    }

    /// When each node of the first plan is to happen at the earliest; nothing without a schedule.
    pub(crate) fn scheduled(&self, network: &Network) -> Vec<Option<Time>> {
        if self.schedule.is_empty() {
            return Vec::new();
        }
        let time = |index: usize| {
            let events = network.nodes[index].events.iter().map(|&event| network.event_name(event));
            let named = tpn::plan_json::node_name(network, NodeId::from_index(index));
            events.chain([named]).find_map(|name| self.schedule.get(name.as_str()).copied())
        };
        (0..network.nodes.len()).map(time).collect()
    }

    /// Returns how long the schedule lets an occurrence take, if it has both of its events.
    fn scheduled_duration(
        &self,
        network: &Network,
        occurrence: &Occurrence,
    ) -> Result<Option<Time>, Overflow> {
        if self.schedule.is_empty() {
            return Ok(None);
        }
        let is_natures = || occurrence.arc.is_some_and(|arc| network.arcs[arc.index()].is_contingent);
        if occurrence.kind != OccurrenceKind::Primitive && !is_natures() {
            return Ok(None);
        }
        let time = |end: &str| self.schedule.get(format!("{}.{end}", occurrence.name).as_str()).copied();
        let Some((start, end)) = time("start").zip(time("end")) else { return Ok(None) };
        end.checked_sub(start).ok_or(Overflow).map(Some)
    }

    /// Returns whether the environment is to make plans fail.
    pub const fn is_adversary(&self) -> bool {
        self.is_adversary
    }

    /// Returns how long the environment makes something take that takes from `lower` to `upper`.
    pub fn chosen(&self, occurrence: &Occurrence, [lower, upper]: [Time; 2]) -> Time {
        self.chosen.get(&occurrence.name).map_or(lower, |&chosen| chosen.min(upper).max(lower))
    }

    /// Returns how long ending an activity early takes, between the ends of a range.
    pub fn abort_time(&self, occurrence: &Occurrence, [lower, upper]: [Time; 2]) -> Time {
        let chosen = self.chosen.get(&abort_name(occurrence));
        chosen.map_or(lower, |&chosen| chosen.min(upper).max(lower))
    }

    /// Returns how long an occurrence really takes, where that is not for the executive to decide.
    pub fn duration(&self, network: &Network, occurrence: &Occurrence) -> Result<Option<Time>, Overflow> {
        if let Some(&duration) = self.durations.get(&occurrence.name) {
            return Ok(Some(duration));
        }
        if let Some(duration) = self.scheduled_duration(network, occurrence)? {
            return Ok(Some(duration));
        }
        if occurrence.kind != OccurrenceKind::Primitive {
            return Ok(None);
        }
        let Some(factor) = self.slow.get(&occurrence.name).filter(|factor| factor.is_positive()) else {
            return Ok(None);
        };
        let exact = min_drive(network, occurrence)?.checked_div(*factor).ok_or(Overflow)?;
        // Shares of any kind would make the ticks of a run finer without end.
        let whole = exact.integer_parts(SLOW_PARTS).and_then(|parts| Time::new(parts, i64::from(SLOW_PARTS)));
        let up = |whole: Time| {
            if whole < exact { whole.checked_add(Time::new(1, i64::from(SLOW_PARTS))?) } else { Some(whole) }
        };
        Ok(Some(whole.and_then(up).unwrap_or(exact)))
    }

    /// All times and durations that it brings into a run of `network`: ticks must be fine enough for them.
    pub fn times(&self, network: &Network) -> Result<Vec<Time>, Overflow> {
        let absolute = self.durations.values().chain(self.withdrawn.values()).chain(self.late.values());
        let absolute = absolute.chain(self.chosen.values()).chain(self.schedule.values());
        let slow = network.occurrences.iter().filter(|occurrence| self.slow.contains_key(&occurrence.name));
        let slow = slow.filter_map(|occurrence| self.duration(network, occurrence).transpose());
        let changes = self.changes.iter().map(|change| Ok(change.at()));
        absolute.map(|&time| Ok(time)).chain(changes).chain(slow).collect()
    }

    /// When a condition is withdrawn.
    pub fn withdrawn_at(&self, occurrence: &Occurrence) -> Option<Time> {
        self.withdrawn.get(&occurrence.name).copied()
    }

    /// When the world first gives a variable that an assertion keeps, from `since` on, another value.
    pub fn overridden_at(&self, network: &Network, occurrence: &Occurrence, since: Time) -> Option<Time> {
        let arc = &network.arcs[occurrence.arc?.index()];
        let is_other = |change: &&WorldChange| {
            let WorldChange::State { at, variable, value } = change else { return false };
            *at > since
                && arc.labels.iter().any(|label| {
                    let literal = &network.labels[label.index()].literal;
                    let of = &network.variables[literal.variable.index()];
                    let given = of.values.iter().position(|known| known == value).map(ValueId::from_index);
                    of.is_lasting
                        && of.name == *variable
                        && network.labels[label.index()].mode == LabelMode::Tell
                        && given.is_some_and(|given| !literal.values.contains(given))
                })
        };
        self.changes.iter().find(is_other).map(WorldChange::at)
    }

    /// Before when a condition does not begin.
    pub fn begins_at(&self, occurrence: &Occurrence) -> Option<Time> {
        self.late.get(&occurrence.name).copied()
    }

    /// The names of disturbances that are about nothing in `network`.
    pub fn unknown(network: &Network, disturbances: &[Disturbance]) -> Vec<SmolStr> {
        disturbances
            .iter()
            .filter_map(Disturbance::occurrence)
            .filter(|&name| !network.occurrences.iter().any(|occurrence| occurrence.name == *name))
            .cloned()
            .collect()
    }
}

/// The name under which the environment's choice is kept of how long ending an activity early takes.
pub fn abort_name(occurrence: &Occurrence) -> SmolStr {
    smol_str::format_smolstr!("{}.abort", occurrence.name)
}

/// The durations that the environment chooses in `network`, with their ranges: of activities, assertions and delays, in
/// textual order. Those that the mission reads as ordinary are among them.
pub fn natures_ranges(network: &Network) -> impl Iterator<Item = (&Occurrence, [Time; 2])> {
    network.occurrences.iter().filter_map(|occurrence| {
        let arc = &network.arcs[occurrence.arc?.index()];
        let upper = arc.upper.finite().filter(|_| arc.is_contingent)?;
        Some((occurrence, [arc.lower.min(upper), upper]))
    })
}

/// The least time for a traverse: its path at full speed, or its lower bound where it has none.
pub fn min_drive(network: &Network, occurrence: &Occurrence) -> Result<Time, Overflow> {
    let own = occurrence.arc.map_or(Time::ZERO, |arc| network.arcs[arc.index()].lower);
    let pieces = network
        .arcs
        .iter()
        .filter(|arc| arc.kind == tpn::ArcKind::Path)
        .filter(|arc| {
            arc.occurrence.is_some_and(|id| network.occurrences[id.index()].name == occurrence.name)
        })
        .map(|arc| arc.lower);
    let pieces = Time::checked_sum(pieces).ok_or(Overflow)?;
    Ok(if pieces.is_positive() { pieces } else { own })
}
