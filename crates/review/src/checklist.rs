//! The checklist of a review: its lines by section, each with its status and the place that it leads to.

use exact::{Bound, Rational, Time};
use rmpl::Span;
use serde::{Deserialize, Serialize};
use tpn::{Levels, NodeId, OccurrenceId, Supply, Window};

use super::alternatives::Alternative;
use super::flight_rule::Finding;
use super::rules::FlightRules;

/// A mission, reviewed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Review {
    /// What was reviewed: see [`content_hash`](crate::content_hash).
    pub content_hash: String,
    /// The plan that was found: see [`plan_hash`](crate::plan_hash); empty without one.
    pub plan_hash: String,
    /// What it is held against: see [`Review::judge`].
    pub rules: FlightRules,
    /// What times are counted in: `min` or `s`.
    pub unit: String,
    /// The worst status of any line.
    pub status: Status,
    /// Whether there is a plan, and whether the independent checker agrees.
    pub plan: Vec<Line>,
    /// The choices that the plan makes, in textual order.
    pub choices: Vec<ChoiceReview>,
    /// The conditions that activities need, in textual order.
    pub causal_links: Vec<LinkReview>,
    /// The pairs of intervals that must not overlap.
    pub conflicts: Vec<ConflictReview>,
    /// What keeps its value, and the movements of vehicles.
    pub states: Vec<Line>,
    /// The resources with their margins.
    pub resources: Vec<ResourceReview>,
    /// Activities of one vehicle that may overlap, although the mission does not say that they can.
    pub overlaps: Vec<Line>,
    /// Declared durations of which the plan can use only a part.
    pub durations: Vec<Line>,
    /// The events, those with the least slack first.
    pub events: Vec<EventReview>,
    /// The traverses, in order of departure.
    pub traverses: Vec<TraverseReview>,
    /// Vehicles that come too near each other.
    pub separation_violations: Vec<Line>,
    /// Whether activities of the mission run control programs, whose components can fail by chance.
    pub runs_programs: bool,
    /// What runs with chance came to, if any were made.
    pub robustness: Option<Line>,
    /// The digest of these runs, with their settings; an approval signs it.
    pub runs: Option<String>,
    /// What was found of the rules of the mission, by what they say: see [`evaluate`](crate::flight_rule::evaluate).
    pub findings: Vec<Finding>,
    /// The rules of the mission, each held or not.
    pub mission_rules: Vec<Line>,
    /// What is wrong with the text, or could be.
    pub warnings: Vec<Line>,
}

/// The status of a line of a review.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// There is nothing to hold it against: it says how things are.
    Information,
    /// As it should be.
    Passed,
    /// Someone should look at it.
    Attention,
    /// Not as it should be.
    Failed,
}

impl Status {
    /// The word for it in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Information => "information",
            Self::Passed => "passed",
            Self::Attention => "attention",
            Self::Failed => "failed",
        }
    }
}

/// One line of a review.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// What the flight rules make of `checked`.
    pub status: Status,
    /// Its status without the flight rules.
    pub checked: Status,
    /// What it says, in one sentence.
    pub text: String,
    /// What it is held against, and where that comes from.
    pub criterion: Option<String>,
    /// The place in the text that it leads to, if it has one.
    pub span: Option<Span>,
    /// The line of that place, from 1.
    pub line_number: Option<u32>,
    /// What it is about, by the names of all output: events, intervals, activities, decisions, vehicles.
    pub names: Vec<String>,
    /// The events of the network that it is about.
    pub nodes: Vec<NodeId>,
    /// Where in the network it is, with what is before and after it: another place is another line, even with the same
    /// words. Empty for a line that is about no place.
    pub place: String,
    /// Whether it can only be accepted until a date: it is about a flight rule that the plan violates, and that may be waived.
    #[serde(default)]
    pub needs_waiver: bool,
}

impl Line {
    /// A line that is about nothing in particular.
    pub const fn new(status: Status, text: String) -> Self {
        Self {
            status,
            checked: status,
            text,
            criterion: None,
            span: None,
            line_number: None,
            names: Vec::new(),
            nodes: Vec::new(),
            place: String::new(),
            needs_waiver: false,
        }
    }
}

/// A choice of the plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChoiceReview {
    /// Which alternative was taken.
    pub line: Line,
    /// The decision: `D1`.
    pub name: String,
    /// The alternatives, in textual order.
    pub alternatives: Vec<Alternative>,
}

/// A condition that an activity needs, and the assertion that carries it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinkReview {
    /// What carries what, and with which margin.
    pub line: Line,
    /// The requirement.
    pub ask: String,
    /// The assertion.
    pub tell: String,
    /// How long the condition holds before it is needed.
    pub lead: TimeRange,
    /// How long the condition outlasts the need.
    pub margin: TimeRange,
    /// Whether the condition is a state, which lasts until it is changed.
    pub is_lasting: bool,
}

/// Two intervals that must not overlap, or two uses of a resource that must not come together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConflictReview {
    /// Which comes first.
    pub line: Line,
    /// The interval that comes first.
    pub first: String,
    /// The interval that follows.
    pub then: String,
    /// From the end of the first to the start of the other.
    pub gap: TimeRange,
    /// Whether planning had to put them in order; otherwise the program's own bounds do.
    pub is_added: bool,
    /// Whether these are uses of a resource, which may follow each other at once.
    pub is_of_uses: bool,
}

/// A resource, and how much of it a plan leaves in every schedule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResourceReview {
    /// How far it is used, and what is left.
    pub line: Line,
    pub name: String,
    /// How much of it there is.
    pub supply: Supply,
    /// How far the plan uses it, over all schedules, and whatever its drives take.
    pub levels: Levels,
    /// What stays free of a reusable resource, and above the minimum level of a reservoir.
    pub spare: Rational,
    /// What stays free below the maximum level of a reservoir.
    pub room: Option<Rational>,
}

/// When an event may happen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventReview {
    /// The event with its window.
    pub line: Line,
    /// Its name: `Group-Wait#1.start`.
    pub name: String,
    /// When it may happen.
    pub window: Window,
    /// How much later than its earliest time it may happen.
    pub slack: Bound,
}

/// A traverse of the plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraverseReview {
    /// Length, duration, clearance and slope.
    pub line: Line,
    pub occurrence: OccurrenceId,
    /// Its name: `Group-Traverse-Path#1`.
    pub name: String,
    /// The vehicles, the leader first.
    pub vehicles: Vec<String>,
    /// The places it leads to, in order.
    pub places: Vec<String>,
    /// Along the map, in meters.
    pub length_m: f64,
    /// How long it may take, in mission units.
    pub duration: TimeRange,
    /// The least distance from the vehicle's rim to an obstacle, in meters; `None` without any obstacle.
    pub clearance_m: Option<f64>,
    /// The steepest slope along the path, in radians.
    pub slope_max_rad: f64,
    /// What the vehicles can climb, in radians; `None` in the air.
    pub slope_limit_rad: Option<f64>,
    /// Whether it may end later than the plan counts on, or not at all.
    #[serde(default)]
    pub may_be_late: bool,
}

/// How long something takes in the schedules of a plan, in mission units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TimeRange {
    /// In every schedule at least this.
    pub least: Time,
    /// In every schedule at most this.
    pub greatest: Bound,
}

impl std::fmt::Display for TimeRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "[{}, {}]", self.least.readable(), self.greatest.readable())
    }
}

/// A part of a review.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Section {
    /// [`Review::plan`].
    Plan,
    /// [`Review::choices`].
    Choices,
    /// [`Review::causal_links`].
    CausalLinks,
    /// [`Review::conflicts`].
    Conflicts,
    /// [`Review::states`].
    States,
    /// [`Review::resources`].
    Resources,
    /// [`Review::overlaps`].
    Overlaps,
    /// [`Review::durations`].
    Durations,
    /// [`Review::events`].
    Events,
    /// [`Review::traverses`].
    Traverses,
    /// [`Review::separation_violations`].
    SeparationViolations,
    /// [`Review::mission_rules`].
    MissionRules,
    /// [`Review::robustness`].
    Robustness,
    /// [`Review::warnings`].
    Warnings,
}

impl Section {
    /// All, in the order in which they are read.
    pub const ALL: [Self; 14] = [
        Self::Plan,
        Self::MissionRules,
        Self::Choices,
        Self::CausalLinks,
        Self::Conflicts,
        Self::States,
        Self::Resources,
        Self::Overlaps,
        Self::Durations,
        Self::Events,
        Self::Traverses,
        Self::SeparationViolations,
        Self::Robustness,
        Self::Warnings,
    ];

    /// The heading over the section.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Plan => "Plan",
            Self::Choices => "Choices",
            Self::CausalLinks => "Causal links",
            Self::Conflicts => "Threats and orderings",
            Self::States => "States and vehicles",
            Self::Resources => "Resources",
            Self::Overlaps => "Activities that may overlap",
            Self::Durations => "Durations narrowed by the plan",
            Self::Events => "Windows and slack",
            Self::Traverses => "Traverses",
            Self::SeparationViolations => "Conflicts between vehicles",
            Self::MissionRules => "Mission rules",
            Self::Robustness => "Robustness",
            Self::Warnings => "Warnings in the text",
        }
    }
}

impl Review {
    /// The lines of a section, in order.
    pub fn lines(&self, section: Section) -> Vec<&Line> {
        match section {
            Section::Plan => self.plan.iter().collect(),
            Section::Choices => self.choices.iter().map(|it| &it.line).collect(),
            Section::CausalLinks => self.causal_links.iter().map(|it| &it.line).collect(),
            Section::Conflicts => self.conflicts.iter().map(|it| &it.line).collect(),
            Section::States => self.states.iter().collect(),
            Section::Resources => self.resources.iter().map(|it| &it.line).collect(),
            Section::Overlaps => self.overlaps.iter().collect(),
            Section::Durations => self.durations.iter().collect(),
            Section::Events => self.events.iter().map(|it| &it.line).collect(),
            Section::Traverses => self.traverses.iter().map(|it| &it.line).collect(),
            Section::SeparationViolations => self.separation_violations.iter().collect(),
            Section::MissionRules => self.mission_rules.iter().collect(),
            Section::Robustness => self.robustness.iter().collect(),
            Section::Warnings => self.warnings.iter().collect(),
        }
    }

    /// Returns whether there is a plan to say anything about.
    pub fn is_planned(&self) -> bool {
        !self.events.is_empty()
    }

    /// The worst status of a section's lines. A section without lines has passed only where finding nothing says that all
    /// is well; where there was nothing to look at, it is information.
    pub fn section_status(&self, section: Section) -> Status {
        let worst = self.lines(section).into_iter().map(|line| line.status).max();
        let is_passed = match section {
            Section::Warnings => true,
            Section::Conflicts | Section::Durations | Section::SeparationViolations => self.is_planned(),
            Section::Plan
            | Section::Choices
            | Section::CausalLinks
            | Section::States
            | Section::Resources
            | Section::Overlaps
            | Section::Events
            | Section::Traverses
            | Section::MissionRules
            | Section::Robustness => false,
        };
        worst.unwrap_or(if is_passed { Status::Passed } else { Status::Information })
    }

    /// Returns what a section without lines says, as the line that has passed.
    pub fn settled(&self, section: Section) -> Option<Line> {
        let is_settled = self.is_planned()
            && self.lines(section).is_empty()
            && self.section_status(section) == Status::Passed;
        is_settled.then(|| Line::new(Status::Passed, self.nothing(section).trim_end_matches('.').to_owned()))
    }

    /// Returns what a section without lines says: that there is nothing to find fault with, or no plan to look at.
    pub fn nothing(&self, section: Section) -> &'static str {
        match section {
            Section::Warnings => "The text has no errors and no warnings.",
            Section::MissionRules => "There are no mission rules.",
            _ if !self.is_planned() => "There is no plan.",
            Section::Plan | Section::Events => "Nothing to check.",
            Section::Choices => "The plan has no choice to make.",
            Section::CausalLinks => "No activity requires a condition.",
            Section::Conflicts => "No two conditions of the plan conflict, so there is no threat.",
            Section::States => "The plan does not use states, and no vehicle moves.",
            Section::Resources => "No resource is used.",
            Section::Overlaps => "No vehicle has more than one activity.",
            Section::Durations => "The plan allows the full declared range of each duration on its own.",
            Section::Traverses => "No vehicle drives.",
            Section::SeparationViolations => "No two vehicles come too close to each other.",
            Section::Robustness => "No Monte Carlo runs.",
        }
    }

    /// Returns how many lines have each status: passed, attention, failed. What is information is counted apart.
    pub fn counts(&self) -> [usize; 3] {
        [Status::Passed, Status::Attention, Status::Failed].map(|status| self.count(status))
    }

    /// Returns how many lines have this status.
    pub fn count(&self, status: Status) -> usize {
        let lines = Section::ALL.iter().flat_map(|&section| self.lines(section));
        lines.filter(|line| line.status == status).count()
    }
}
