//! What a path search is asked, what it answers, and the loop that all planners share.

use nalgebra::{Point2, distance};
use serde::{Deserialize, Serialize};
use terrain::{Collision, ConfigurationSpace, Random};

use crate::kinodynamic::Kinodynamic;
use crate::path::Path;
use crate::rrt::Rrt;
use crate::rrt_connect::RrtConnect;
use crate::rrt_star::RrtStar;
use crate::shortcut::{ShortcutSettings, shorten};
use crate::trajectory::{DriveLimits, Trajectory, drive_path};
use crate::tree::Tree;
use crate::vehicle::VEHICLE_MODELS;

/// The path planners by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PlannerKind {
    /// One tree from the start (`LaValle` 1998, SPEC 7.2).
    Rrt,
    /// A tree from each end, each reaching for the other (Kuffner and `LaValle` 2000).
    RrtConnect,
    /// RRT* with informed sampling: goes on to shorten its path.
    RrtStar,
    /// An RRT of motions within the limits of a skid-steer vehicle, at rest at both ends.
    Kinodynamic,
}

impl PlannerKind {
    /// All of them, the plainest first.
    pub const ALL: [Self; 4] = [Self::Rrt, Self::RrtConnect, Self::RrtStar, Self::Kinodynamic];
}

/// Where from and where to, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Query {
    /// Where the path starts, exactly.
    pub start_m: Point2<f64>,
    /// Where it ends, exactly.
    pub goal_m: Point2<f64>,
}

/// How a search goes about it. The same settings on the same query give the same path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    pub planner: PlannerKind,
    /// The longest edge in metres (ε).
    pub step_m: f64,
    /// The probability with which the goal is the sample (p).
    pub goal_bias: f64,
    /// How many samples are drawn at most (N).
    pub max_samples: u32,
    /// How many samples RRT* draws after its first path to shorten it.
    pub improving_samples: u32,
    /// What the vehicle of the kinodynamic planner can do.
    pub limits: DriveLimits,
    /// Where random choices come from.
    pub seed: u64,
}

impl Settings {
    /// Settings for a planner: edges of 6 m, goal bias 0.05, at most 50,000 samples, 3,000 to improve, an ATRV, seed 1.
    pub fn of(planner: PlannerKind) -> Self {
        Self {
            planner,
            step_m: 6.0,
            goal_bias: 0.05,
            max_samples: 50_000,
            improving_samples: 3_000,
            limits: DriveLimits::of(&VEHICLE_MODELS[0]),
            seed: 1,
        }
    }
}

/// Why there is no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Failure {
    /// The vehicle can't be at the start.
    StartInCollision(Collision),
    /// The vehicle can't be at the goal.
    GoalInCollision(Collision),
    /// Obstacles close off the goal from the start: it is proved that there is no path.
    GoalEnclosed,
    /// None was found, which proves nothing.
    NotFound {
        /// The number of samples drawn.
        samples: u32,
    },
    /// The caller stopped the search.
    Stopped {
        /// The number of samples drawn till then.
        samples: u32,
    },
}

impl std::fmt::Display for Failure {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let place =
            |formatter: &mut std::fmt::Formatter<'_>, end: &str, collision: &Collision| match collision {
                Collision::OutsideMap => write!(formatter, "the {end} is outside the map"),
                Collision::Cell { state, .. } => {
                    write!(
                        formatter,
                        "the vehicle can't be at the {end}: some of it would be {}",
                        state.describe()
                    )
                }
            };
        match self {
            Self::StartInCollision(collision) => place(formatter, "start", collision),
            Self::GoalInCollision(collision) => place(formatter, "goal", collision),
            Self::GoalEnclosed => write!(formatter, "obstacles close off the goal: there is no path"),
            Self::NotFound { samples } => write!(formatter, "no path found in {samples} samples"),
            Self::Stopped { samples } => write!(formatter, "stopped after {samples} samples without a path"),
        }
    }
}

/// What a search has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statistics {
    /// Samples drawn.
    pub samples: u32,
    /// Vertices of all trees.
    pub vertices: u32,
    /// Edges tried that were not free.
    pub blocked_edges: u32,
    /// Straight pieces of ground that were checked for obstacles: edges, and the steps of simulated motions.
    pub collision_checks: u32,
    /// Samples drawn when the first path was found.
    pub samples_to_first_path: Option<u32>,
}

/// What one sample did, for display.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    pub sample_m: Point2<f64>,
    /// The tree that was grown toward it.
    pub tree: u32,
    /// The vertex of that tree which was nearest to the sample.
    pub nearest: u32,
    /// What came of it.
    pub growth: Growth,
}

/// What came of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Growth {
    /// An obstacle was in the way between this vertex and the sample.
    Blocked {
        /// The nearest vertex.
        vertex: u32,
    },
    /// A vertex was added.
    Grew {
        /// The new vertex.
        vertex: u32,
    },
    /// A vertex was added and a first or shorter path found.
    Found {
        /// The new vertex.
        vertex: u32,
        /// The length of the path in metres.
        length_m: f64,
    },
}

/// What the planners work with.
pub(crate) struct Context<'a> {
    pub(crate) space: &'a ConfigurationSpace,
    pub(crate) query: Query,
    pub(crate) settings: Settings,
    pub(crate) random: &'a mut Random,
    pub(crate) statistics: &'a mut Statistics,
}

impl Context<'_> {
    /// A sample: the goal with the probability of the goal bias, otherwise anywhere in the box of the free places.
    pub(crate) fn sample(&mut self) -> Point2<f64> {
        if self.random.unit() < self.settings.goal_bias {
            return self.query.goal_m;
        }
        self.uniform_sample()
    }

    pub(crate) fn uniform_sample(&mut self) -> Point2<f64> {
        let [low, high] = self.space.free_box_m();
        Point2::new(self.random.range(low.x, high.x), self.random.range(low.y, high.y))
    }

    /// Whether an edge is free, counted.
    pub(crate) fn is_edge_free(&mut self, from_m: Point2<f64>, to_m: Point2<f64>) -> bool {
        let free = self.is_free(from_m, to_m);
        self.statistics.blocked_edges += u32::from(!free);
        free
    }

    /// Whether a straight piece of ground is free, counted as a check.
    pub(crate) fn is_free(&mut self, from_m: Point2<f64>, to_m: Point2<f64>) -> bool {
        self.statistics.collision_checks += 1;
        self.space.is_segment_free(from_m, to_m)
    }
}

/// A search under way: it holds no reference to the space, which each call gets anew and which must be the same.
#[derive(Clone, Debug)]
pub struct Search {
    query: Query,
    settings: Settings,
    random: Random,
    statistics: Statistics,
    planner: Planner,
}

#[derive(Clone, Debug)]
enum Planner {
    Rrt(Rrt),
    RrtConnect(RrtConnect),
    RrtStar(RrtStar),
    Kinodynamic(Kinodynamic),
}

/// What a search came to.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchResult {
    /// The path as found, or why there is none.
    pub path: Result<Path, Failure>,
    /// The motion along the path, from the kinodynamic planner.
    pub trajectory: Option<Trajectory>,
    /// The trees that were grown; none when an end was in collision or the goal enclosed.
    pub trees: Vec<Tree>,
    pub statistics: Statistics,
    /// The seed of the search: [`trace`](crate::trace()) with it shows how the trees grew.
    pub seed: u64,
}

impl Search {
    /// Starts a search, or says at once why there is no path.
    pub fn new(space: &ConfigurationSpace, query: Query, settings: Settings) -> Result<Self, Failure> {
        if let Some(collision) = space.collision_at(query.start_m) {
            return Err(Failure::StartInCollision(collision));
        }
        if let Some(collision) = space.collision_at(query.goal_m) {
            return Err(Failure::GoalInCollision(collision));
        }
        if space.are_separated(query.start_m, query.goal_m) {
            return Err(Failure::GoalEnclosed);
        }
        let planner = match settings.planner {
            PlannerKind::Rrt => Planner::Rrt(Rrt::new(query)),
            PlannerKind::RrtConnect => Planner::RrtConnect(RrtConnect::new(query)),
            PlannerKind::RrtStar => Planner::RrtStar(RrtStar::new(query)),
            PlannerKind::Kinodynamic => Planner::Kinodynamic(Kinodynamic::new(query)),
        };
        let random = Random::from_seed(settings.seed);
        Ok(Self { query, settings, random, statistics: Statistics::default(), planner })
    }

    /// Draws one sample and grows a tree toward it.
    pub fn step(&mut self, space: &ConfigurationSpace) -> Event {
        self.statistics.samples += 1;
        let mut context = Context {
            space,
            query: self.query,
            settings: self.settings,
            random: &mut self.random,
            statistics: &mut self.statistics,
        };
        let event = match &mut self.planner {
            Planner::Rrt(planner) => planner.step(&mut context),
            Planner::RrtConnect(planner) => planner.step(&mut context),
            Planner::RrtStar(planner) => planner.step(&mut context),
            Planner::Kinodynamic(planner) => planner.step(&mut context),
        };
        if let Growth::Found { .. } = event.growth
            && self.statistics.samples_to_first_path.is_none()
        {
            self.statistics.samples_to_first_path = Some(self.statistics.samples);
        }
        event
    }

    /// Whether further samples can't or shall not change anything: a path is found and the planner doesn't shorten
    /// paths or has had its samples for that, or all samples are used up.
    pub fn is_finished(&self) -> bool {
        let Statistics { samples, samples_to_first_path, .. } = self.statistics;
        let satisfied = samples_to_first_path.is_some_and(|first| match &self.planner {
            Planner::RrtStar(planner) => {
                let straight = distance(&self.query.start_m, &self.query.goal_m);
                samples - first >= self.settings.improving_samples
                    || planner.length_m().is_some_and(|length| length <= straight * (1.0 + 1e-9))
            }
            _ => true,
        });
        satisfied || samples >= self.settings.max_samples
    }

    /// The best path so far.
    pub fn path(&self) -> Option<Path> {
        match &self.planner {
            Planner::Rrt(planner) => planner.path(),
            Planner::RrtConnect(planner) => planner.path(),
            Planner::RrtStar(planner) => planner.path(),
            Planner::Kinodynamic(planner) => planner.path(),
        }
    }

    /// The motion along the path, when the planner is kinodynamic and has found one.
    pub fn trajectory(&self) -> Option<Trajectory> {
        match &self.planner {
            Planner::Kinodynamic(planner) => planner.trajectory(),
            _ => None,
        }
    }

    /// The trees as they stand.
    pub fn trees(&self) -> Vec<&Tree> {
        match &self.planner {
            Planner::Rrt(planner) => vec![planner.tree()],
            Planner::RrtConnect(planner) => planner.trees().iter().collect(),
            Planner::RrtStar(planner) => vec![planner.tree()],
            Planner::Kinodynamic(planner) => vec![planner.tree()],
        }
    }

    /// Counts so far.
    pub fn statistics(&self) -> Statistics {
        let vertices = self.trees().iter().map(|tree| tree.vertices.len() as u32).sum();
        Statistics { vertices, ..self.statistics }
    }

    /// Runs to the end, or until `stop` says so; it is asked before every sample.
    pub fn run(
        mut self,
        space: &ConfigurationSpace,
        stop: &mut dyn FnMut(&Statistics) -> bool,
    ) -> SearchResult {
        let mut stopped = false;
        while !self.is_finished() && !stopped {
            stopped = stop(&self.statistics);
            if !stopped {
                self.step(space);
            }
        }
        let samples = self.statistics.samples;
        let path = self.path().ok_or_else(|| {
            if stopped {
                Failure::Stopped { samples }
            } else if space.are_separated_finely(self.query.start_m, self.query.goal_m) {
                Failure::GoalEnclosed
            } else {
                Failure::NotFound { samples }
            }
        });
        let statistics = self.statistics();
        let trajectory = self.trajectory();
        let trees = match self.planner {
            Planner::Rrt(planner) => vec![planner.into_tree()],
            Planner::RrtConnect(planner) => planner.into_trees().into(),
            Planner::RrtStar(planner) => vec![planner.into_tree()],
            Planner::Kinodynamic(planner) => vec![planner.into_tree()],
        };
        SearchResult { path, trajectory, trees, statistics, seed: self.settings.seed }
    }
}

impl SearchResult {
    /// Shortens the path, if there is one. A motion is replaced by driving its shortened path with a stop at each corner
    /// where that is quicker.
    pub fn shorten(&mut self, space: &ConfigurationSpace, settings: &Settings, shortcut: &ShortcutSettings) {
        let Ok(path) = &mut self.path else { return };
        let short = shorten(space, path, shortcut);
        if let Some(found) = &mut self.trajectory {
            let heading_rad = found.states.first().map_or(0.0, |first| first.state.heading_rad);
            let driven = drive_path(&short, heading_rad, &settings.limits);
            if driven.duration_s() < found.duration_s() {
                *found = driven;
            }
            *path = found.path();
        } else {
            *path = short;
        }
    }
}

/// Finds a path and, if `shortcut` is given, shortens it ([`SearchResult::shorten`]).
pub fn find_path(
    space: &ConfigurationSpace,
    query: Query,
    settings: &Settings,
    shortcut: Option<&ShortcutSettings>,
    stop: &mut dyn FnMut(&Statistics) -> bool,
) -> SearchResult {
    let mut result = match Search::new(space, query, *settings) {
        Ok(search) => search.run(space, stop),
        Err(failure) => {
            return SearchResult {
                path: Err(failure),
                trajectory: None,
                trees: Vec::new(),
                statistics: Statistics::default(),
                seed: settings.seed,
            };
        }
    };
    if let Some(shortcut) = shortcut {
        result.shorten(space, settings, shortcut);
    }
    result
}
