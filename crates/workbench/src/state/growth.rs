//! The search for the path of one leg, sample by sample: the trees growing from both ends.
//!
//! It is the recorded search that planned the leg, or another planner's on the same ground from the same seed. That one
//! is run on the spot: it is deterministic, and to go back is to run it again up to an earlier sample.

use std::sync::Arc;

use mission::Snapshot;
use motion::{GrowthTrace, PlannerKind, Query, Search, Settings};
use rmpl::program::{ObstacleShape, World};
use smol_str::SmolStr;
use terrain::{ConfigurationSpace, Obstacle, Terrain};
use tpn::OccurrenceId;

use crate::state::Selection;

/// The growth that is looked at, if one is.
#[derive(Clone, Debug)]
pub struct Growth {
    /// The planner whose search is shown; `None` for the search that planned the leg.
    pub planner: Option<PlannerKind>,
    /// Whether samples are drawn by themselves.
    pub is_playing: bool,
    shown: Option<Shown>,
    elapsed_samples: f64,
}

/// A search under way.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The traverse.
    pub occurrence: OccurrenceId,
    /// Its name, by which it is found again in another network.
    pub name: SmolStr,
    /// The leg, from 0.
    pub leg: usize,
    /// The places of the traverse, as many as its legs: where each leads.
    pub goals: Vec<SmolStr>,
    /// Samples that the whole search draws.
    pub total: u32,
    walk: Walk,
}

/// A search that can be looked at after any number of samples.
#[derive(Clone, Debug)]
enum Walk {
    /// The recorded one, and how many samples of it are looked at.
    Recorded(Arc<GrowthTrace>, u32),
    /// One that is run on the spot.
    Run(Box<Run>),
    /// There is none, for this reason.
    Refused(String),
}

/// A search that is run on the spot.
#[derive(Clone, Debug)]
struct Run {
    search: Search,
    last: Option<motion::Event>,
    query: Query,
    settings: Settings,
    space: Arc<ConfigurationSpace>,
}

/// A search as it stands after some samples, to be drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// Where the trees begin.
    pub roots_m: Vec<[f64; 2]>,
    /// The edges, each with the number of its tree.
    pub edges: Vec<(usize, Vec<[f64; 2]>)>,
    /// The best path so far.
    pub path_m: Option<Vec<[f64; 2]>>,
    /// The last sample, and whether an obstacle was in its way.
    pub sample: Option<([f64; 2], bool)>,
}

/// What can be asked of the growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrowthCommand {
    /// Shows the growth for the selected traverse, or the first one; hides it if it is shown.
    Toggle,
    /// Hides it.
    Close,
    /// Another leg of the traverse, from 0.
    ChooseLeg(usize),
    /// Another planner; `None` for the search that planned the leg.
    ChoosePlanner(Option<PlannerKind>),
    /// To this number of samples.
    GoTo(u32),
    /// So many samples more, or fewer if negative.
    Step(i64),
    /// Lets samples be drawn by themselves, or stops.
    TogglePlaying,
}

/// What a growth is made from.
#[derive(Clone, Copy)]
pub struct GrowthInput<'a> {
    /// The mission.
    pub snapshot: &'a Snapshot,
    /// Its ground.
    pub map: &'a Terrain,
    /// What is selected.
    pub selection: &'a Selection,
    /// The seed of path planning.
    pub seed: u64,
}

/// Seconds that a whole search takes to play at rate 1, and the least and greatest number of samples a second.
const PLAY_SECS: f64 = 8.0;
const SAMPLES_PER_SEC: [f64; 2] = [6.0, 600.0];
/// Samples after which a search that finds nothing is given up here.
const MOST_SAMPLES: u32 = 20_000;

impl Default for Growth {
    fn default() -> Self {
        Self { planner: None, is_playing: false, shown: None, elapsed_samples: 0.0 }
    }
}

impl Growth {
    /// What is looked at.
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// Does what `command` asks for; without a mission and its ground there is nothing to show.
    pub fn apply(&mut self, command: GrowthCommand, input: Option<GrowthInput<'_>>) {
        let Some(input) = input else {
            self.close();
            return;
        };
        match command {
            GrowthCommand::Close => self.close(),
            GrowthCommand::Toggle if self.shown.is_some() => self.close(),
            GrowthCommand::Toggle => {
                let network = input.snapshot.network.as_deref();
                let selected = network.and_then(|network| input.selection.occurrence(network));
                let traverses = &input.snapshot.traverses;
                let traverse =
                    traverses.iter().find(|it| Some(it.occurrence) == selected).or(traverses.first());
                if let Some(traverse) = traverse {
                    self.shown = self.start(&input, traverse, 0);
                }
            }
            GrowthCommand::ChooseLeg(leg) => self.restart(&input, leg),
            GrowthCommand::ChoosePlanner(planner) => {
                self.planner = planner;
                let leg = self.shown.as_ref().map_or(0, |shown| shown.leg);
                self.restart(&input, leg);
            }
            GrowthCommand::GoTo(samples) => {
                if let Some(shown) = &mut self.shown {
                    shown.go_to(samples);
                }
            }
            GrowthCommand::Step(samples) => {
                if let Some(shown) = &mut self.shown {
                    let target = i64::from(shown.samples()).saturating_add(samples).max(0);
                    shown.go_to(u32::try_from(target).unwrap_or(u32::MAX));
                }
            }
            GrowthCommand::TogglePlaying => self.toggle_playing(),
        }
    }

    /// Looks at the same leg of another snapshot, at the same number of samples; nothing if it is gone.
    pub fn follow(&mut self, input: Option<GrowthInput<'_>>) {
        let Some(before) = &self.shown else { return };
        let (leg, samples, name) = (before.leg, before.samples(), before.name.clone());
        let traverse = input.and_then(|input| Some((input, named_traverse(input.snapshot, &name)?)));
        let Some((input, traverse)) = traverse else {
            self.close();
            return;
        };
        self.shown = self.start(&input, traverse, leg);
        if let Some(shown) = &mut self.shown {
            shown.go_to(samples);
        }
    }

    /// Lets `seconds` go by. Answers whether more samples were drawn.
    pub fn advance(&mut self, seconds: f64, rate: f64) -> bool {
        let Some(shown) = self.shown.as_mut().filter(|_| self.is_playing) else { return false };
        let [least, greatest] = SAMPLES_PER_SEC;
        let per_second = (f64::from(shown.total) / PLAY_SECS).clamp(least, greatest);
        self.elapsed_samples += seconds * rate * per_second;
        let samples = self.elapsed_samples as u32;
        if samples == 0 {
            return false;
        }
        self.elapsed_samples -= f64::from(samples);
        shown.go_to(shown.samples() + samples);
        self.is_playing = shown.samples() < shown.total;
        true
    }

    fn close(&mut self) {
        self.shown = None;
        self.is_playing = false;
    }

    fn toggle_playing(&mut self) {
        self.elapsed_samples = 0.0;
        if let Some(shown) = &mut self.shown {
            if !self.is_playing && shown.samples() >= shown.total {
                shown.go_to(0);
            }
            self.is_playing = !self.is_playing && shown.total > 0;
        }
    }

    fn restart(&mut self, input: &GrowthInput<'_>, leg: usize) {
        let Some(name) = self.shown.as_ref().map(|shown| shown.name.clone()) else { return };
        if let Some(traverse) = named_traverse(input.snapshot, &name) {
            self.is_playing = false;
            self.shown = self.start(input, traverse, leg);
        }
    }

    fn start(&self, input: &GrowthInput<'_>, traverse: &mission::Traverse, leg: usize) -> Option<Shown> {
        let leg = leg.min(traverse.legs.len().checked_sub(1)?);
        let way = &traverse.legs[leg];
        let walk = match self.planner {
            None => Walk::Recorded(Arc::clone(&way.growth), 0),
            Some(planner) => run(input, traverse, way, planner)?,
        };
        let network = input.snapshot.network.as_deref()?;
        let mut shown = Shown {
            occurrence: traverse.occurrence,
            name: network.occurrences.get(traverse.occurrence.index())?.name.clone(),
            leg,
            goals: traverse.legs.iter().map(|leg| leg.to.clone()).collect(),
            total: 0,
            walk,
        };
        shown.go_to(u32::MAX);
        shown.total = shown.samples();
        shown.go_to(0);
        Some(shown)
    }
}

/// Another planner's search for a leg.
fn run(
    input: &GrowthInput<'_>,
    traverse: &mission::Traverse,
    leg: &mission::Leg,
    planner: PlannerKind,
) -> Option<Walk> {
    let query = Query { start_m: *leg.points_m.first()?, goal_m: *leg.points_m.last()? };
    let world = &input.snapshot.program.world;
    let vehicle = world.vehicles.get(*traverse.vehicles.first()? as usize)?;
    let model = motion::vehicle_model(&vehicle.model.text)?;
    let space = Arc::new(model.configuration_space(input.map, &obstacles(world)));
    let settings = Settings {
        seed: input.seed,
        greatest_samples: MOST_SAMPLES,
        limits: motion::DriveLimits::of(model),
        ..Settings::of(planner)
    };
    Some(match Search::new(&space, query, settings) {
        Ok(search) => Walk::Run(Box::new(Run { search, last: None, query, settings, space })),
        Err(failure) => Walk::Refused(failure.to_string()),
    })
}

impl Shown {
    /// Samples drawn so far.
    pub fn samples(&self) -> u32 {
        match &self.walk {
            Walk::Recorded(_, samples) => *samples,
            Walk::Run(run) => run.search.statistics().samples,
            Walk::Refused(_) => 0,
        }
    }

    /// Why there is no search.
    pub fn refusal(&self) -> Option<&str> {
        match &self.walk {
            Walk::Refused(reason) => Some(reason),
            _ => None,
        }
    }

    /// Vertices of all trees.
    pub fn vertices(&self) -> u32 {
        match &self.walk {
            Walk::Recorded(trace, samples) => {
                (trace.roots_m.len() + trace.grown(*samples as usize).count()) as u32
            }
            Walk::Run(run) => run.search.statistics().vertices,
            Walk::Refused(_) => 0,
        }
    }

    /// The length of the best path so far in metres.
    pub fn length_m(&self) -> Option<f64> {
        match &self.walk {
            Walk::Recorded(trace, samples) => {
                trace.path_m(*samples as usize).map(mission::traverse::length_m)
            }
            Walk::Run(run) => run.search.path().map(|path| path.length_m()),
            Walk::Refused(_) => None,
        }
    }

    /// The search as it stands, to be drawn.
    pub fn standing(&self) -> Standing {
        match &self.walk {
            Walk::Recorded(trace, samples) => recorded(trace, *samples as usize),
            Walk::Run(run) => run.standing(),
            Walk::Refused(_) => Standing::default(),
        }
    }

    /// Goes to a number of samples, or to the end.
    fn go_to(&mut self, samples: u32) {
        match &mut self.walk {
            Walk::Recorded(trace, at) => *at = samples.min(trace.steps.len() as u32),
            Walk::Run(run) => run.go_to(samples),
            Walk::Refused(_) => {}
        }
    }
}

impl Run {
    fn go_to(&mut self, samples: u32) {
        if samples < self.search.statistics().samples
            && let Ok(search) = Search::new(&self.space, self.query, self.settings)
        {
            (self.search, self.last) = (search, None);
        }
        let mut drawn = self.search.statistics().samples;
        while drawn < samples && !self.search.is_finished() {
            self.last = Some(self.search.step(&self.space));
            drawn += 1;
        }
    }

    fn standing(&self) -> Standing {
        let mut standing = Standing {
            path_m: self.search.path().map(|path| path.points_m),
            sample: self
                .last
                .map(|event| (event.sample_m, matches!(event.growth, motion::Growth::Blocked { .. }))),
            ..Standing::default()
        };
        for (number, tree) in self.search.trees().into_iter().enumerate() {
            for (index, vertex) in tree.vertices.iter().enumerate() {
                let parent = vertex.parent.and_then(|parent| tree.vertices.get(parent as usize));
                let Some(parent) = parent else {
                    standing.roots_m.push(vertex.point_m);
                    continue;
                };
                let mut way = vec![parent.point_m];
                match tree.curves.get(index).filter(|curve| !curve.is_empty()) {
                    Some(curve) => way.extend(curve),
                    None => way.push(vertex.point_m),
                }
                standing.edges.push((number, way));
            }
        }
        standing
    }
}

fn recorded(trace: &GrowthTrace, samples: usize) -> Standing {
    let last = samples.checked_sub(1).and_then(|last| trace.steps.get(last));
    Standing {
        roots_m: trace.roots_m.clone(),
        edges: trace
            .grown(samples)
            .map(|grown| (grown.tree as usize, vec![grown.from_m, grown.point_m]))
            .collect(),
        path_m: trace.path_m(samples).map(<[_]>::to_vec),
        sample: last.map(|step| (step.sample_m, step.added.is_empty())),
    }
}

/// The obstacles of a world for path planning.
pub fn obstacles(world: &World) -> Vec<Obstacle> {
    world
        .obstacles
        .iter()
        .map(|obstacle| match &obstacle.shape {
            ObstacleShape::Circle { center_m, radius_m } => {
                Obstacle::Circle { center_m: *center_m, radius_m: *radius_m }
            }
            ObstacleShape::Polygon { corners_m } => Obstacle::Polygon { corners_m: corners_m.clone() },
        })
        .collect()
}

/// The name of a planner on screen; `None` is the search that planned the leg.
pub const fn planner_title(planner: Option<PlannerKind>) -> &'static str {
    match planner {
        None => "As planned",
        Some(PlannerKind::Rrt) => "RRT",
        Some(PlannerKind::RrtConnect) => "RRT-Connect",
        Some(PlannerKind::RrtStar) => "RRT*",
        Some(PlannerKind::Kinodynamic) => "Kinodynamic RRT",
    }
}

fn named_traverse<'a>(snapshot: &'a Snapshot, name: &str) -> Option<&'a mission::Traverse> {
    let network = snapshot.network.as_deref()?;
    snapshot
        .traverses
        .iter()
        .find(|it| network.occurrences.get(it.occurrence.index()).is_some_and(|found| found.name == name))
}
