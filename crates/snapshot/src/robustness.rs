//! How robust a plan is: what is left to chance, and what many runs with chance came to (Monte Carlo).
//!
//! Run number i of a seed is the same run whoever makes it, and tallies hold only whole numbers: however the runs are
//! shared out, the sum is the same.

use std::collections::BTreeMap;

use exact::Time;
use executive::model_based::wilson_interval;
use executive::world::natures_ranges;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use tpn::{Network, OccurrenceKind};

/// What is left to chance. Activities and conditions are named by occurrence (`Drill#2`) or, for all their occurrences,
/// without the count (`Drill`, `Tell(LIGHT)`).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Uncertainty {
    /// How long activities take, and other durations that the environment chooses: those are brought into their ranges.
    pub durations: BTreeMap<SmolStr, Distribution>,
    /// Conditions that may come late.
    pub late: BTreeMap<SmolStr, Incident>,
    /// Conditions that may be withdrawn.
    pub withdrawn: BTreeMap<SmolStr, Incident>,
    /// What is taken for activities that `durations` does not name.
    pub others: Others,
    /// Whether components fail by chance while control programs run.
    pub faults: Faults,
    /// Whether vehicles drive.
    pub traverses: Traverses,
    /// What vehicles that drive meet and the map does not show.
    pub rocks: Rocks,
    /// Whether the environment chooses its durations so as to break the plan, and ends of ranges where it cannot.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub adversary: bool,
}

impl Uncertainty {
    /// Returns whether runs can differ from the plan at all: with nothing named, and everything else as the plan wants
    /// it, each run is the plan itself. Components can fail only where the mission `runs_programs`.
    pub fn leaves_something_to_chance(&self, runs_programs: bool) -> bool {
        let is_named = !self.durations.is_empty() || !self.late.is_empty() || !self.withdrawn.is_empty();
        let is_driven = self.traverses == Traverses::Driven;
        // What the environment chooses it chooses against the plan.
        let fails = runs_programs && self.faults == Faults::ByChance;
        is_named || is_driven || fails || self.adversary || self.others == Others::Uniform
    }
}

/// Where the durations of traverses come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Traverses {
    /// They are drawn as those of other activities are, between the path at full speed and the upper bound.
    #[default]
    Drawn,
    /// Vehicles drive in simulation, past rocks and with noise in what they see; that takes far longer.
    Driven,
}

/// Rocks that lie about a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Rocks {
    /// At most so many for each traverse; any number up to it is equally likely.
    pub most: u32,
    /// The least and the greatest radius in meters, all between them equally likely.
    pub radius: [f64; 2],
    /// At most so far from the path to its sides, in meters.
    pub aside: f64,
}

impl Default for Rocks {
    fn default() -> Self {
        Self { most: 0, radius: [0.3, 1.0], aside: 2.0 }
    }
}

impl Rocks {
    /// Returns whether they can be drawn.
    pub fn is_sound(&self) -> bool {
        let [least, greatest] = self.radius;
        let is_length = |length: f64| (0.0..1e6).contains(&length);
        is_length(least) && is_length(greatest) && least <= greatest && is_length(self.aside)
    }
}

/// How long the activities take that nothing is said about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Others {
    /// Anything between their bounds, all equally likely, if both are finite and the plan does not end them itself. In a
    /// mission that says which durations the environment chooses, these alone; all others are as the plan wants.
    #[default]
    Uniform,
    /// As long as the plan wants.
    Planned,
}

/// Whether components fail by chance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Faults {
    /// With the probabilities of the plant's model.
    #[default]
    ByChance,
    Never,
}

/// A random time, in mission units. Draws are multiples of a thousandth of a unit above the least value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// Always the same.
    Fixed(Time),
    /// From the first to the second, all equally likely.
    Uniform(Time, Time),
    /// From the first to the third, the second most likely.
    Triangular(Time, Time, Time),
    /// With this mean and standard deviation; never below 0.
    Normal(Time, Time),
}

/// Something that may happen to a condition.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Incident {
    /// How likely it is, from 0 to 1.
    pub probability: f64,
    /// When the condition comes, or goes, if it does.
    pub at: Distribution,
}

/// What the runs are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobustnessSettings {
    pub runs: u64,
    pub seed: u64,
    /// What is left to chance.
    #[serde(with = "crate::json_text")]
    pub uncertainty: Uncertainty,
}

/// How some runs went. Tallies of different runs add up.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// How many runs there were.
    pub runs: u64,
    /// How many reached the mission's end.
    pub succeeded: u64,
    /// How many of those had to plan again.
    pub succeeded_by_replanning: u64,
    /// The events that broke plans.
    pub breaks: BTreeMap<SmolStr, Breaks>,
    /// How much of its window each event used, by event.
    pub slack: BTreeMap<SmolStr, SlackUsed>,
    /// When the successful runs ended, in thousandths of a unit, summed, and the earliest and the latest.
    pub end_sum: i64,
    /// The earliest end, in thousandths of a unit.
    pub end_least: Option<i64>,
    pub end_most: Option<i64>,
}

/// What an event broke.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Breaks {
    /// How often it could not be kept.
    pub violations: u64,
    /// After how many of those there was no plan any more.
    pub stops: u64,
    /// An example, in words: that of the run with the least number.
    pub example: String,
    /// The number of that run.
    pub example_run: u64,
}

/// How far into its window an event came: 0 at the earliest moment, 1000 at the latest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SlackUsed {
    /// In how many runs it happened while the first plan held.
    pub count: u64,
    /// The thousandths, summed.
    pub sum_permille: u64,
    pub most_permille: u64,
}

/// What is known of a plan's robustness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robustness {
    /// What was asked for.
    pub settings: RobustnessSettings,
    /// What the runs made so far came to.
    pub tally: Tally,
}

impl Tally {
    /// Adds the runs of `other`, which are different ones.
    pub fn merge(&mut self, other: &Self) {
        self.runs += other.runs;
        self.succeeded += other.succeeded;
        self.succeeded_by_replanning += other.succeeded_by_replanning;
        for (event, breaks) in &other.breaks {
            let mine = self.breaks.entry(event.clone()).or_default();
            if mine.violations == 0 || (breaks.violations > 0 && breaks.example_run < mine.example_run) {
                (mine.example, mine.example_run) = (breaks.example.clone(), breaks.example_run);
            }
            mine.violations += breaks.violations;
            mine.stops += breaks.stops;
        }
        for (event, used) in &other.slack {
            let mine = self.slack.entry(event.clone()).or_default();
            mine.count += used.count;
            mine.sum_permille += used.sum_permille;
            mine.most_permille = mine.most_permille.max(used.most_permille);
        }
        self.end_sum = self.end_sum.saturating_add(other.end_sum);
        self.end_least = self.end_least.into_iter().chain(other.end_least).min();
        self.end_most = self.end_most.into_iter().chain(other.end_most).max();
    }

    /// The share of runs that reached the end; 0 without any run.
    pub fn probability(&self) -> f64 {
        if self.runs == 0 { 0.0 } else { self.succeeded as f64 / self.runs as f64 }
    }

    /// Its 95 % confidence interval (Wilson).
    pub fn interval(&self) -> (f64, f64) {
        wilson_interval(self.succeeded, self.runs)
    }

    /// The events that broke plans, those after which most runs stopped first.
    pub fn worst_events(&self) -> Vec<(&SmolStr, &Breaks)> {
        let mut events: Vec<_> = self.breaks.iter().collect();
        events.sort_by_key(|(name, breaks)| (std::cmp::Reverse((breaks.stops, breaks.violations)), *name));
        events
    }

    /// The events that used most of their windows on average, with the mean and greatest share from 0 to 1.
    pub fn tightest_events(&self) -> Vec<(&SmolStr, f64, f64)> {
        let mut events: Vec<(&SmolStr, f64, f64)> = self
            .slack
            .iter()
            .filter(|(_, used)| used.count > 0)
            .map(|(name, used)| {
                let mean = used.sum_permille as f64 / used.count as f64 / 1000.0;
                (name, mean, used.most_permille as f64 / 1000.0)
            })
            .collect();
        events.sort_by(|left, right| right.1.total_cmp(&left.1).then(left.0.cmp(right.0)));
        events
    }
}

impl Robustness {
    /// Returns whether all runs have been made.
    pub const fn is_complete(&self) -> bool {
        self.tally.runs >= self.settings.runs
    }
}

impl Uncertainty {
    /// A name of whose times it says something that is not a distribution.
    pub fn unsound(&self) -> Option<&SmolStr> {
        let durations = self.durations.iter();
        let incidents = self.late.iter().chain(&self.withdrawn).map(|(name, incident)| (name, &incident.at));
        durations.chain(incidents).find(|(_, distribution)| !distribution.is_sound()).map(|(name, _)| name)
    }

    /// Returns what is wrong with it for the mission of `network`, if something is.
    pub fn problem(&self, network: &Network) -> Option<String> {
        let unknown = self.unknown_names(network);
        if !unknown.is_empty() {
            return Some(format!("unknown activity or condition {}", unknown.join(", ")));
        }
        if let Some(name) = self.unsound() {
            return Some(format!(
                "the distribution of {name} is invalid: its numbers must not decrease, and must be at least 0"
            ));
        }
        let mut incidents = self.late.iter().chain(&self.withdrawn);
        if let Some((name, it)) = incidents.find(|(_, it)| !(0.0..=1.0).contains(&it.probability)) {
            return Some(format!("the probability of {name} must be from 0 to 1, not {}", it.probability));
        }
        let rocks = "the lengths of rocks must be at least 0, and the minimum radius must come first";
        (!self.rocks.is_sound()).then(|| rocks.to_owned())
    }

    /// The names in it that nothing in `network` has.
    pub fn unknown_names(&self, network: &Network) -> Vec<SmolStr> {
        let is_known = |name: &SmolStr, kind: OccurrenceKind| {
            network.occurrences.iter().any(|occurrence| {
                occurrence.kind == kind
                    && (occurrence.name == *name
                        || occurrence.activity == *name
                        || base(&occurrence.name) == *name)
            })
        };
        let is_natures = |name: &SmolStr| {
            natures_ranges(network)
                .any(|(it, _)| it.name == *name || it.activity == *name || base(&it.name) == *name)
        };
        let activities = self.durations.keys();
        let activities =
            activities.filter(|name| !is_known(name, OccurrenceKind::Primitive) && !is_natures(name));
        let conditions = self
            .late
            .keys()
            .chain(self.withdrawn.keys())
            .filter(|name| !is_known(name, OccurrenceKind::Assertion));
        activities.chain(conditions).cloned().collect()
    }
}

impl Distribution {
    /// Returns what it draws is this and whole parts of a unit.
    pub fn least(self) -> Time {
        match self {
            Self::Fixed(least) | Self::Uniform(least, _) | Self::Triangular(least, ..) => least,
            Self::Normal(..) => Time::ZERO,
        }
    }

    /// Returns whether it can be drawn from: in order, and not below 0.
    pub fn is_sound(&self) -> bool {
        match *self {
            Self::Fixed(time) => !time.is_negative(),
            Self::Uniform(least, most) => !least.is_negative() && least <= most,
            Self::Triangular(least, likely, most) => {
                !least.is_negative() && least <= likely && likely <= most
            }
            Self::Normal(mean, deviation) => !mean.is_negative() && !deviation.is_negative(),
        }
    }
}

/// The name without its count.
pub fn base(name: &str) -> &str {
    name.rsplit_once('#').map_or(name, |(base, _)| base)
}
