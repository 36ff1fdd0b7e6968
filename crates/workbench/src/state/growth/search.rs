//! One search for a path, looked at after any number of its samples: recorded with the plan, or run by the core.

use std::sync::Arc;

use link::{GrowthStanding, WantedPlanner};
use motion::{GrowthStep, GrowthTrace, PlannerKind};
use nalgebra::Point2;
use snapshot::ContentKey;

/// A search for the path of a leg.
#[derive(Clone, Debug)]
pub struct Search {
    /// The planner; `None` for the search that planned the leg.
    pub planner: Option<PlannerKind>,
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    Recorded(Arc<GrowthTrace>),
    /// One that the core runs.
    Running(Box<Running>),
    /// There is none, for this reason.
    Refused(String),
}

/// A search that the core runs, as far as it has answered.
#[derive(Clone, Debug, Default)]
struct Running {
    search: ContentKey,
    trace: GrowthTrace,
    elapsed_millis: f64,
    is_complete: bool,
}

/// A search as it is after some samples, to be drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// Where the trees begin.
    pub roots_m: Vec<Point2<f64>>,
    /// The edges, each with the number of its tree.
    pub edges: Vec<(usize, Vec<Point2<f64>>)>,
    /// The best path so far.
    pub path_m: Option<Vec<Point2<f64>>>,
    /// The last sample.
    pub sample: Option<LastSample>,
}

/// A sample, to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LastSample {
    pub at_m: Point2<f64>,
    /// The vertex nearest to it.
    pub nearest_m: Point2<f64>,
    /// Whether an obstacle was in its way.
    pub is_blocked: bool,
}

/// What a search has done by some sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// Samples drawn.
    pub samples: u32,
    /// Vertices of all trees, their roots included.
    pub vertices: u32,
    /// Straight pieces of ground that were checked for obstacles.
    pub checks: u32,
    /// The length of the best path, in meters.
    pub length_m: Option<f64>,
}

impl Search {
    pub(super) const fn recorded(trace: Arc<GrowthTrace>) -> Self {
        Self { planner: None, source: Source::Recorded(trace) }
    }

    /// One that the core will answer.
    pub(super) fn awaited(planner: PlannerKind) -> Self {
        Self { planner: Some(planner), source: Source::Running(Box::default()) }
    }

    /// That there is none.
    pub(super) const fn refused(planner: Option<PlannerKind>, reason: String) -> Self {
        Self { planner, source: Source::Refused(reason) }
    }

    /// Returns what to ask the core; `None` if it is not the core that searches.
    pub(super) fn wanted(&self) -> Option<WantedPlanner> {
        let Source::Running(running) = &self.source else { return None };
        Some(WantedPlanner {
            planner: self.planner?,
            held_search: running.search,
            held: running.trace.steps.len() as u32,
        })
    }

    /// Takes what the core answered.
    pub(super) fn take(&mut self, standing: GrowthStanding) {
        let Source::Running(running) = &mut self.source else { return };
        if standing.first as usize > running.trace.steps.len() {
            return;
        }
        if let Some(refusal) = standing.refusal {
            self.source = Source::Refused(refusal);
            return;
        }
        running.search = standing.search;
        running.trace.roots_m = standing.roots_m;
        running.trace.steps.truncate(standing.first as usize);
        running.trace.steps.extend(standing.steps);
        running.elapsed_millis = standing.elapsed_millis;
        running.is_complete = standing.is_complete;
    }

    fn trace(&self) -> Option<&GrowthTrace> {
        match &self.source {
            Source::Recorded(trace) => Some(trace),
            Source::Running(running) => Some(&running.trace),
            Source::Refused(_) => None,
        }
    }

    /// Returns how many trees grow.
    pub(super) fn roots_count(&self) -> usize {
        self.trace().map_or(0, |trace| trace.roots_m.len())
    }

    /// Samples that are known.
    pub fn known(&self) -> u32 {
        self.trace().map_or(0, |trace| trace.steps.len() as u32)
    }

    /// Returns whether all samples of the search are known.
    pub fn is_complete(&self) -> bool {
        match &self.source {
            Source::Running(running) => running.is_complete,
            Source::Recorded(_) | Source::Refused(_) => true,
        }
    }

    /// Returns why there is no search.
    pub fn refusal(&self) -> Option<&str> {
        match &self.source {
            Source::Refused(reason) => Some(reason),
            _ => None,
        }
    }

    /// Milliseconds that the whole search took in the core, once it is over.
    pub fn total_millis(&self) -> Option<f64> {
        match &self.source {
            Source::Running(running) if running.is_complete => Some(running.elapsed_millis),
            _ => None,
        }
    }

    /// Returns what it has done by this many samples.
    pub fn counts(&self, samples: u32) -> Counts {
        let Some(trace) = self.trace() else {
            return Counts { samples: 0, vertices: 0, checks: 0, length_m: None };
        };
        let samples = samples.min(self.known());
        let steps = trace.steps.iter().take(samples as usize);
        Counts {
            samples,
            vertices: (trace.roots_m.len() + trace.grown(samples as usize).count()) as u32,
            checks: steps.map(|step| step.checks).sum(),
            length_m: trace.path_m(samples as usize).map(motion::length_m),
        }
    }

    /// Returns what the last of so many samples did.
    pub fn last(&self, samples: u32) -> Option<&GrowthStep> {
        let last = samples.min(self.known()).checked_sub(1)?;
        self.trace()?.steps.get(last as usize)
    }

    /// The trees after so many samples, to be drawn; vertices that got another parent hang on that.
    pub fn standing(&self, samples: u32) -> Standing {
        let Some(trace) = self.trace() else { return Standing::default() };
        let root = |&point_m: &Point2<f64>| vec![Vertex { parent: None, point_m, curve_m: &[] }];
        let mut trees: Vec<Vec<Vertex<'_>>> = trace.roots_m.iter().map(root).collect();
        for step in trace.steps.iter().take(samples as usize) {
            for &[tree, vertex, parent] in &step.rewired {
                if let Some(vertex) = trees.get_mut(tree as usize).and_then(|it| it.get_mut(vertex as usize))
                {
                    vertex.parent = Some(parent);
                }
            }
            for grown in &step.added {
                let vertex =
                    Vertex { parent: Some(grown.parent), point_m: grown.point_m, curve_m: &grown.curve_m };
                if let Some(tree) = trees.get_mut(grown.tree as usize) {
                    tree.push(vertex);
                }
            }
        }
        let edges = trees.iter().enumerate().flat_map(|(number, tree)| {
            tree.iter().filter_map(move |vertex| {
                let parent = tree.get(vertex.parent? as usize)?;
                let mut way = vec![parent.point_m];
                if vertex.curve_m.is_empty() {
                    way.push(vertex.point_m);
                } else {
                    way.extend(vertex.curve_m);
                }
                Some((number, way))
            })
        });
        Standing {
            edges: edges.collect(),
            roots_m: trace.roots_m.clone(),
            path_m: trace.path_m(samples as usize).map(<[_]>::to_vec),
            sample: self.last(samples).map(|step| LastSample {
                at_m: step.sample_m,
                nearest_m: step.nearest_m,
                is_blocked: step.added.is_empty(),
            }),
        }
    }
}

/// A vertex of a tree as it stands.
struct Vertex<'a> {
    parent: Option<u32>,
    point_m: Point2<f64>,
    /// The way from its first parent, if that was not straight.
    curve_m: &'a [Point2<f64>],
}
