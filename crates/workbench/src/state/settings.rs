//! What is remembered between runs: appearance, how to plan, and what each panel shows.

use std::collections::BTreeSet;

use kirk::Search as SearchKind;
use layout::timeline::{ChartOptions, Grouping};
use link::{Source, Update};
use serde::{Deserialize, Serialize};
use snapshot::Goal;

use crate::effect::Effect;
use crate::state::window::Window;

/// The stops of lessons that were answered correctly.
pub type Learned = BTreeSet<String>;

/// The user's settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Light, dark, or as the system has it.
    pub theme: ThemeChoice,
    /// How large text and everything with it is; 1 is the designed size.
    pub text_scale: f32,
    /// How to plan. What to plan belongs to the mission and is not remembered.
    pub plan: PlanSettings,
    /// What each panel shows.
    pub views: Views,
    /// Who comments and approves.
    pub reviewer: String,
    /// In which role.
    pub reviewer_role: String,
    /// When missions start, as it was last given for a schedule with dates.
    pub epoch: String,
    /// The stops of lessons whose questions were answered rightly: `negative-cycle/2`.
    pub learned: Learned,
    /// How many predictions were made in lessons, and how many of them were right.
    pub predictions: [u32; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            text_scale: 1.0,
            plan: PlanSettings::default(),
            views: Views::default(),
            reviewer: String::new(),
            reviewer_role: String::new(),
            epoch: String::new(),
            learned: Learned::default(),
            predictions: [0; 2],
        }
    }
}

/// How small and how large text can be.
pub const TEXT_SCALES: [f32; 2] = [0.6, 2.5];
/// How little and how much heights are exaggerated.
pub const HEIGHT_SCALES: [f32; 2] = [1.0, 5.0];

/// What can be asked of the settings.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingsCommand {
    SetGoal(Goal),
    /// How to search.
    SetSearch(SearchKind),
    /// Seeds path planning.
    SetSeed(u64),
    /// Whether the search is recorded.
    SetTrace(bool),
    /// What panels show.
    SetViews(Box<Views>),
    /// Light, dark, or as the system has it.
    SetTheme(ThemeChoice),
    /// How large text is; 1 is the designed size.
    SetTextScale(f32),
    /// When missions start, as a date; empty if that is not known.
    SetEpoch(String),
}

impl Settings {
    /// Does what a command asks for.
    pub(crate) fn apply(&mut self, command: SettingsCommand, window: &mut Window) {
        match command {
            SettingsCommand::SetGoal(goal) => self.plan.goal = goal,
            SettingsCommand::SetSearch(search) => self.plan.search = Some(search),
            SettingsCommand::SetSeed(seed) => self.plan.seed = seed,
            SettingsCommand::SetTrace(trace) => self.plan.trace = trace,
            SettingsCommand::SetEpoch(epoch) => self.epoch = epoch,
            SettingsCommand::SetViews(views) => self.views = *views,
            SettingsCommand::SetTheme(theme) => {
                self.theme = theme;
                window.ask(Effect::Restyle);
            }
            SettingsCommand::SetTextScale(scale) => {
                let [least, most] = TEXT_SCALES;
                self.text_scale = ((scale * 10.0).round() / 10.0).clamp(least, most);
                window.ask(Effect::Restyle);
            }
        }
    }

    /// The same with every number where it can be used: what was kept may have been damaged, or written by another
    /// version.
    #[must_use]
    pub fn checked(mut self) -> Self {
        self.text_scale = within(self.text_scale, TEXT_SCALES, Self::default().text_scale);
        let heights = &mut self.views.terrain.height_scale;
        *heights = within(*heights, HEIGHT_SCALES, TerrainView::default().height_scale);
        let (sun, usual) = (&mut self.views.terrain.sun, SunView::default());
        sun.azimuth_deg = within(sun.azimuth_deg, SUN_AZIMUTHS_DEG, usual.azimuth_deg);
        sun.height_deg = within(sun.height_deg, SUN_HEIGHTS_DEG, usual.height_deg);
        self
    }
}

fn within(number: f32, [least, most]: [f32; 2], otherwise: f32) -> f32 {
    if number.is_finite() { number.clamp(least, most) } else { otherwise }
}

/// Which theme the user wants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ThemeChoice {
    /// What the system has, also when that changes.
    #[default]
    System,
    /// Light on dark.
    Dark,
    /// Dark on light.
    Light,
}

/// What and how to plan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlanSettings {
    #[serde(skip)]
    pub goal: Goal,
    /// Which search plans, and is recorded; if no one chose one, each is the one that suits.
    pub search: Option<SearchKind>,
    /// Seeds path planning.
    pub seed: u64,
    /// Whether the search is recorded for stepping through it.
    pub trace: bool,
}

impl PlanSettings {
    /// Returns what the core is asked to plan: the text of `revision`, in this way.
    pub fn update(&self, revision: u64, source: impl Into<Source>) -> Update {
        Update {
            revision,
            source: source.into(),
            goal: self.goal.clone(),
            search: self.planner(),
            seed: self.seed,
            trace: self.trace.then(|| self.recorded()),
        }
    }

    /// The search that plans; if no one chose one, the fastest.
    pub fn planner(&self) -> SearchKind {
        self.search.unwrap_or_default()
    }

    /// The search that is recorded where one is; if no one chose one, the paper's, whose steps are the easiest to follow.
    pub fn recorded(&self) -> SearchKind {
        self.search.unwrap_or(SearchKind::Chronological)
    }
}

/// What each panel shows. A panel changes its part with [`SettingsCommand::SetViews`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Views {
    /// The mission text.
    pub editor: EditorView,
    pub network: NetworkView,
    pub timeline: TimelineView,
    /// The plan's tables.
    pub plan: PlanView,
    pub terrain: TerrainView,
}

/// How the mission text is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct EditorView {
    /// Whether long lines are broken into rows of the panel's width.
    pub wraps: bool,
}

/// What the network shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct NetworkView {
    /// Bounds on the arcs.
    pub bounds: bool,
    /// Asked and told conditions on the arcs.
    pub labels: bool,
    /// The names of events and activities.
    pub names: bool,
    /// The windows of selected events.
    pub windows: bool,
    pub links: bool,
    /// Orderings that resolve threats.
    pub orderings: bool,
    /// Whether what the plan does not select is drawn.
    pub unselected: bool,
    /// Boxes around activities and blocks.
    pub structure: bool,
    /// A named band for every parallel branch.
    pub lanes: bool,
    /// What has happened at the time shown, and what is under way.
    pub now: bool,
    /// Problems of the text at their places.
    pub problems: bool,
    /// The small overview.
    pub minimap: bool,
}

impl NetworkView {
    /// The parts of a drawing that it shows.
    pub const fn parts(&self) -> layout::Parts {
        layout::Parts {
            names: self.names,
            bounds: self.bounds,
            conditions: self.labels,
            unselected: self.unselected,
            structure: self.structure,
            lanes: self.lanes,
        }
    }
}

impl Default for NetworkView {
    fn default() -> Self {
        Self {
            bounds: true,
            labels: true,
            names: true,
            windows: false,
            links: true,
            orderings: true,
            unselected: true,
            structure: false,
            lanes: false,
            now: true,
            problems: true,
            minimap: true,
        }
    }
}

/// What the timeline shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct TimelineView {
    /// All causal links and orderings between bars; otherwise only those of what is selected or pointed at.
    pub links: bool,
    /// Conditions as tracks, one for each variable that is known only where it is asserted.
    pub conditions: bool,
    /// What variables that keep their values are from when to when.
    pub states: bool,
    /// How far resources are used.
    pub resources: bool,
    /// Delays as bars of their own.
    pub delays: bool,
    /// In a review, where bars were in the plan that was last approved.
    pub approved: bool,
    /// In a run, where bars were in the plan that it began with.
    pub planned: bool,
    /// By what the bars are grouped.
    pub grouping: Grouping,
}

impl TimelineView {
    /// Returns what of it a chart shows.
    pub const fn chart(&self) -> ChartOptions {
        ChartOptions {
            conditions: self.conditions,
            states: self.states,
            resources: self.resources,
            delays: self.delays,
            grouping: self.grouping,
        }
    }
}

impl Default for TimelineView {
    fn default() -> Self {
        Self {
            links: false,
            conditions: true,
            states: true,
            resources: true,
            delays: false,
            approved: true,
            planned: true,
            grouping: Grouping::default(),
        }
    }
}

/// What the plan panel shows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlanView {
    /// By what the windows are sorted.
    pub sort: WindowSort,
    /// Whether the order is reversed.
    pub descending: bool,
    /// Whether the vertices of planned paths are listed among the events.
    pub path_points: bool,
}

/// The columns of the table of windows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindowSort {
    /// By earliest time, then latest, then name.
    #[default]
    Earliest,
    /// By latest time.
    Latest,
    Slack,
    /// By the name of the event.
    Event,
}

/// What the terrain shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TerrainView {
    /// Names of places and vehicles.
    pub names: bool,
    /// Planned paths.
    pub paths: bool,
    /// The search trees that found them.
    pub trees: bool,
    pub obstacles: bool,
    /// What laser range finders see, in a run.
    pub rays: bool,
    /// Lines of sight that conditions ask for.
    pub sights: bool,
    /// Contour lines.
    pub contours: bool,
    /// A grid in mission coordinates.
    pub grid: bool,
    /// How much room the vehicle has to the nearest obstacle.
    pub clearance: bool,
    /// Nothing that is not data: no ground detail, shadows, tracks and sky.
    pub data_only: bool,
    /// What the colors of the ground mean.
    pub coloring: Coloring,
    /// How much heights are exaggerated; 1 is true to scale.
    pub height_scale: f32,
    pub sun: SunView,
    /// How much is drawn that costs time.
    pub effects: Effects,
}

/// Where the light of the terrain comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SunView {
    /// Whether the sun goes by the mission's clock, once the start date is known.
    pub follows_clock: bool,
    /// Clockwise from north.
    pub azimuth_deg: f32,
    /// Over the horizon.
    pub height_deg: f32,
}

/// The least and the greatest direction that the sun can be set to, clockwise from north in degrees.
pub const SUN_AZIMUTHS_DEG: [f32; 2] = [0.0, 360.0];
/// The least and the greatest height of the sun over the horizon, in degrees.
pub const SUN_HEIGHTS_DEG: [f32; 2] = [5.0, 90.0];

impl Default for SunView {
    fn default() -> Self {
        // From the north-west, from where people take hills for hills on maps.
        Self { follows_clock: true, azimuth_deg: 310.0, height_deg: 45.0 }
    }
}

/// How much of the terrain is drawn that costs time and says nothing about the mission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effects {
    /// All of it, and less where frames are slow.
    #[default]
    Automatic,
    /// All of it, however slow.
    Full,
    /// No grain of the ground, no shadows of rocks, and fewer pixels.
    Reduced,
}

/// What the colors of the ground mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coloring {
    /// As it would look.
    #[default]
    Natural,
    Height,
    Slope,
}

impl Default for TerrainView {
    fn default() -> Self {
        Self {
            names: true,
            paths: true,
            trees: false,
            obstacles: true,
            rays: true,
            sights: true,
            contours: true,
            data_only: false,
            grid: false,
            clearance: false,
            coloring: Coloring::Natural,
            height_scale: 2.0,
            sun: SunView::default(),
            effects: Effects::default(),
        }
    }
}
