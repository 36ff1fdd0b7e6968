//! What a path search is asked, what the planners work with, and what they say of each sample.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use terrain::{Collision, ConfigurationSpace, GridFrame, Random};

use crate::trajectory::DriveLimits;
use crate::vehicle::VEHICLE_MODELS;

/// The path planners by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PlannerKind {
    /// One tree from the start (`LaValle` 1998, SPEC 7.2).
    Rrt,
    /// A tree from each end, each reaching for the other (Kuffner and `LaValle` 2000).
    RrtConnect,
    /// RRT* with informed sampling: continues to shorten its path.
    RrtStar,
    /// An RRT of motions within the limits of a skid-steer vehicle, at rest at both ends.
    Kinodynamic,
}

impl PlannerKind {
    /// All of them, the plainest first.
    pub const ALL: [Self; 4] = [Self::Rrt, Self::RrtConnect, Self::RrtStar, Self::Kinodynamic];
}

/// Where from and where to, in meters.
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
    /// The longest edge in meters (ε).
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

    /// The length of edges that suits a map: a 25th of its longer side, in meters.
    ///
    /// RRT* only compares paths through vertices within one edge of each other. With edges far below the radius that makes
    /// it asymptotically optimal (Karaman and Frazzoli 2011), a tree has too few such neighbors to shorten anything.
    pub fn step_across_m(frame: &GridFrame) -> f64 {
        f64::from(frame.width.max(frame.height)) * frame.cell_size_m / 25.0
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
                        "the vehicle can't be at the {end}: part of it would be {}",
                        state.describe()
                    )
                }
            };
        match self {
            Self::StartInCollision(collision) => place(formatter, "start", collision),
            Self::GoalInCollision(collision) => place(formatter, "goal", collision),
            Self::GoalEnclosed => write!(formatter, "no path: obstacles surround the goal"),
            Self::NotFound { samples } => write!(formatter, "no path found; samples tried: {samples}"),
            Self::Stopped { samples } => {
                write!(formatter, "stopped; no path found; samples tried: {samples}")
            }
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
        /// The length of the path in meters.
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

    /// Returns whether an edge is free, counted.
    pub(crate) fn is_edge_free(&mut self, from_m: Point2<f64>, to_m: Point2<f64>) -> bool {
        let free = self.is_free(from_m, to_m);
        self.statistics.blocked_edges += u32::from(!free);
        free
    }

    /// Returns whether a straight piece of ground is free, counted as a check.
    pub(crate) fn is_free(&mut self, from_m: Point2<f64>, to_m: Point2<f64>) -> bool {
        self.statistics.collision_checks += 1;
        self.space.is_segment_free(from_m, to_m)
    }
}
