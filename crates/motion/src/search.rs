//! What a path search answers, and the loop that all planners share.

use nalgebra::distance;
use terrain::{ConfigurationSpace, Random};

use crate::kinodynamic::Kinodynamic;
use crate::path::Path;
use crate::query::{Context, Event, Failure, Growth, PlannerKind, Query, Settings, Statistics};
use crate::rrt::Rrt;
use crate::rrt_connect::RrtConnect;
use crate::rrt_star::RrtStar;
use crate::shortcut::{ShortcutSettings, shorten};
use crate::trajectory::{Trajectory, drive_path};
use crate::tree::Tree;

/// A search under way: it holds no reference to the space: each call gets it, and it must be the same.
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

    /// Returns whether further samples can't or shall not change anything: a path is found and the planner doesn't
    /// shorten paths or has had its samples for that, or all samples are used up.
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

    /// Runs to the end, or until `stop` returns `true`; it is called before every sample.
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
